//! Whatever is wrong with what the program is given: an exit code that is not 0, one line that says what is wrong, and
//! never a panic.

mod program;

use flate2::{Compression, write::GzEncoder};
use program::{cohelm, file, folder, in_project, run};
use std::fs;
use std::io::Write;
use std::net::TcpListener;
use std::path::Path;

/// Runs a command that must be refused in one line of the program's own, which must hold every word. The line is
/// returned.
#[track_caller]
fn refused(arguments: &[&str], words: &[&str]) -> String {
    refused_in(folder().path(), arguments, words)
}

#[track_caller]
fn refused_in(folder: &Path, arguments: &[&str], words: &[&str]) -> String {
    let (ran, said) = (run(folder, arguments), format!("cohelm {}", arguments.join(" ")));
    assert!(!ran.stderr.contains("panicked"), "{said}: {}", ran.stderr);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(1), ""), "{said}: {}", ran.stderr);
    let lines: Vec<&str> = ran.stderr.lines().collect();
    assert!(lines.len() == 1 && lines[0].starts_with("cohelm: "), "{said}: {lines:?}");
    for word in words {
        assert!(lines[0].contains(word), "{said}: {word:?} is not in {lines:?}");
    }
    lines[0].into()
}

/// Runs a command line that is none: exit code 2, and the line that begins the answer holds every word.
#[track_caller]
fn no_command_line(arguments: &[&str], words: &[&str]) {
    let (ran, said) = (run(folder().path(), arguments), format!("cohelm {}", arguments.join(" ")));
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{said}: {}", ran.stderr);
    let first = ran.stderr.lines().next().unwrap_or_default();
    assert!(first.starts_with("error: "), "{said}: {}", ran.stderr);
    for word in words {
        assert!(first.contains(word), "{said}: {word:?} is not in {first:?}");
    }
}

/// Bytes of no format.
fn garbage() -> Vec<u8> {
    (0..3000_u32).map(|index| (index.wrapping_mul(2_654_435_761) >> 24) as u8).collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// A file of the project without its second half.
fn half(path: &str) -> Vec<u8> {
    let bytes = fs::read(in_project(path)).unwrap();
    bytes[..bytes.len() / 2].to_vec()
}

#[test]
fn fixtures_that_are_none() {
    let folder = folder();
    let flights = half("crates/cohelm-lander/tests/data/gymnasium_flights.jsonl.gz");
    let statistics = half("crates/cohelm-study/tests/data/statistics.json");
    let cases: [(&str, Vec<u8>, &str, &str); 8] = [
        ("empty", vec![], "no episode", "not JSON"),
        ("gzip-of-nothing", gzip(b""), "no episode", "not JSON"),
        ("garbage", garbage(), "line 1", "not JSON"),
        ("gzip-of-garbage", gzip(&garbage()), "line 1", "not JSON"),
        ("json-of-something", b"{}".to_vec(), "line 1", "no recording"),
        ("null", b"null\n".to_vec(), "line 1", "no recording"),
        ("half-of-the-flights", flights, "incomplete", "not JSON"),
        ("half-of-the-statistics", statistics, "line 1", "not JSON"),
    ];
    for (name, bytes, flights, statistics) in cases {
        file(&folder, name, &bytes);
        refused_in(folder.path(), &["verify", "flights", name], &[name, flights]);
        refused_in(folder.path(), &["verify", "statistics", name], &[name, statistics]);
    }
    for kind in ["flights", "statistics"] {
        refused(&["verify", kind, "missing"], &["missing"]);
        refused(&["verify", kind, "."], &[".", "irectory"]);
    }
}

#[test]
fn one_bad_fixture_among_good_ones_is_not_overlooked() {
    let folder = folder();
    file(&folder, "garbage", &garbage());
    let good = in_project("crates/cohelm-study/tests/data/statistics.json");
    refused_in(folder.path(), &["verify", "statistics", good.to_str().unwrap(), "garbage"], &["garbage"]);
}

#[test]
fn models_that_are_none() {
    let folder = folder();
    // Tensors, but of no model: numbers that were recorded from PyTorch.
    let foreign = fs::read(in_project("crates/cohelm-nn/tests/data/pytorch.safetensors")).unwrap();
    file(&folder, "empty", b"");
    file(&folder, "garbage", &garbage());
    file(&folder, "truncated", &foreign[..foreign.len() / 2]);
    file(&folder, "foreign", &foreign);
    for name in ["empty", "garbage", "truncated", "foreign", "missing"] {
        let commands: [&[&str]; 4] = [
            &["evaluate", "--model", name],
            &["reproduce", "--model", name],
            &["train", "intent", "--model", name],
            &["fly", "--port", "0", "--model", name],
        ];
        for command in commands {
            refused_in(folder.path(), command, &[name, "model"]);
        }
    }
}

#[test]
fn databases_that_are_none() {
    let folder = folder();
    file(&folder, "garbage", &garbage());
    // Made with Python: sqlite3.connect("foreign.sqlite"), page_size 512, create table shopping(item text).
    let foreign = in_project("crates/cohelm-cli/tests/data/foreign.sqlite");
    fs::copy(foreign, folder.path().join("foreign")).unwrap();
    for name in ["garbage", "foreign"] {
        let before = fs::read(folder.path().join(name)).unwrap();
        for command in [&["episodes"][..], &["verify", "episodes"], &["fly", "--port", "0"]] {
            let arguments = [command, &["--database", name]].concat();
            refused_in(folder.path(), &arguments, &[name, "no database of cohelm"]);
        }
        assert!(fs::read(folder.path().join(name)).unwrap() == before, "{name} was changed");
    }
    refused(&["episodes", "--database", "missing"], &["there is no database missing"]);
    refused(&["verify", "episodes", "--database", "missing"], &["there is no database missing"]);
    let line = refused(&["fly", "--port", "0", "--database", "."], &["database"]);
    assert_eq!(line.matches("the database .").count(), 1, "{line}");
    refused(&["fly", "--port", "0", "--database", "no/such/x.db"], &["there is no folder no/such"]);
    refused(&["study", "restore", "missing", "to.db"], &["there is no backup missing", "study backup"]);
    refused_in(
        folder.path(),
        &["study", "check", "garbage"],
        &["garbage is no text", "a study's file, in TOML"],
    );
    let line =
        refused(&["train", "intent", "--from", "missing", "--out", "."], &["there is no database missing"]);
    assert!(!line.contains('"'), "a name in the form of a debugger: {line}");
}

#[test]
fn a_port_in_use() {
    let taken = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let folder = folder();
    refused_in(folder.path(), &["fly", "--port", &port], &[&port, "in use"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "it left a file behind");
}

#[test]
fn plants_options_and_populations_that_there_are_not() {
    refused(&["evaluate", "--task", "kite"], &["kite", "flag-lander"]);
    refused(&["train", "--task", "kite"], &["kite", "flag-lander"]);
    refused(&["evaluate", "--option", "actions"], &["NAME=VALUE", "actions"]);
    refused(&["evaluate", "--option", "sails=3"], &["sails", "actions"]);
    refused(&["evaluate", "--option", "actions=flaps"], &["flaps", "main-side"]);
    refused(&["evaluate", "--option", "pad_half_width=-1"], &["pad_half_width", "-1"]);
    refused(&["reproduce", "--actions", "flaps"], &["flaps", "main-side"]);
    refused(&["train", "--preset", "magic"], &["magic", "paper"]);
    refused(&["train", "--values", "magic=1"], &["magic", "steps"]);
    refused(&["train", "--values", "steps=many"], &["steps", "many"]);
    refused(&["train", "--values", "steps=-5"], &["-5"]);
    refused(&["train", "--values", "steps=0"], &["steps", "at least 1"]);
    refused(&["train", "--values", "discount=-3"], &["discount", "(0, 1]"]);
    refused(&["train", "--values", "batch=0"], &["batch", "at least 1"]);
    refused(&["train", "--ship", "missing.json"], &["missing.json"]);
    no_command_line(&["reproduce", "--population", "martians"], &["martians", "ordinary"]);
    no_command_line(&["train", "sails"], &["sails"]);
}

#[test]
fn numbers_that_cannot_be() {
    no_command_line(&["fly", "--port", "70000"], &["70000", "65535"]);
    for arguments in [
        ["fly", "--port", "-1"],
        ["evaluate", "--episodes", "-1"],
        ["evaluate", "--seed", "-1"],
        ["reproduce", "--participants", "-1"],
        ["reproduce", "--seed", "-1"],
        ["train", "--threads", "-1"],
        ["episodes", "--limit", "-1"],
    ] {
        no_command_line(&arguments, &["-1", "expected a whole number from 0 to"]);
    }
    no_command_line(&["bench", "serve", "--participants", "-1"], &["-1", "whole number"]);
    refused(&["bench", "serve", "--participants", "0"], &["at least one participant"]);
    refused(&["bench", "serve", "--bound", "-1"], &["-1", "positive"]);
    no_command_line(&["evaluate", "--episodes", "3.5"], &["3.5"]);
    no_command_line(&["reproduce", "--seed", "99999999999999999999999"], &["99999999999999999999999"]);
    refused(&["compare", "--participants", "1"], &["--participants must be at least 2, got 1"]);
    refused(&["compare", "--episodes", "0"], &["--episodes must be at least 1, got 0"]);
    let pilot = in_project("studies/pilot.toml");
    let power = ["study", "power", pilot.to_str().unwrap(), "--effect", "20", "--sd", "25"];
    refused(&power, &["success is a share of one", "0.2 for 20 percentage points", "got 20 and 25"]);
    refused(&["reproduce", "--participants", "0"], &["at least one participant"]);
    refused(&["reproduce", "--episodes", "0"], &["at least one"]);
    refused(&["evaluate", "--episodes", "0"], &["at least one"]);
    refused(&["bench", "lander", "--runs", "0"], &["at least one"]);
    refused(&["bench", "lander", "--steps", "0"], &["at least one"]);
    refused(&["bench", "nets", "--runs", "0"], &["at least one"]);
}

#[test]
fn commands_that_there_are_not() {
    no_command_line(&["fyl"], &["fyl"]);
    no_command_line(&["verify", "everything"], &["everything"]);
    no_command_line(&["fly", "--sails"], &["--sails"]);
}

#[test]
fn a_python_that_has_no_gymnasium() {
    let bench = ["bench", "lander", "--steps", "9", "--gymnasium"];
    refused(&[&bench[..], &["no-python"]].concat(), &["cannot run no-python"]);
    // Ends with a failure and says nothing, whatever it is given.
    refused(&[&bench[..], &["false"]].concat(), &["false cannot fly Gymnasium's lander", "1.4.0"]);
}

#[test]
fn a_reason_is_told_once() {
    let folder = folder();
    file(&folder, "garbage", &garbage());
    for arguments in [
        &["verify", "flights", "garbage"][..],
        &["verify", "statistics", "garbage"],
        &["evaluate", "--model", "garbage"],
    ] {
        let line = refused_in(folder.path(), arguments, &[]);
        let reason = line.rsplit(": ").next().unwrap();
        assert_eq!(line.matches(reason).count(), 1, "{line}");
    }
}

#[test]
fn what_is_refused_leaves_no_folder() {
    for arguments in [&["reproduce", "--actions", "flaps"][..], &["train", "--values", "steps=0"]] {
        let folder = folder();
        refused_in(folder.path(), arguments, &[]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{arguments:?}");
    }
}

#[test]
fn a_folder_that_may_not_be_written() {
    let folder = folder();
    file(&folder, "occupied", b"a file where a folder should be made");
    refused_in(folder.path(), &["reproduce", "--out", "occupied"], &["occupied"]);
    refused_in(folder.path(), &["train", "--out", "occupied"], &["occupied"]);
}

/// A reader that goes away, as `head` does, is nobody's fault.
#[test]
fn a_reader_that_goes_away() {
    let mut child = cohelm(folder().path(), ["bench", "nets", "--runs", "1"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(!String::from_utf8_lossy(&output.stderr).contains("panicked"), "{output:?}");
}
