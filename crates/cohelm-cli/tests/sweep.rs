//! `cohelm sweep`: run, go on, report.

mod program;

use program::{folder, in_project, run};
use serde_json::Value;
use std::fs;
use std::path::Path;

const SMALL: &str = r#"
cohelm-sweep = 1
title = "Two rules"
[fly]
plant = "flag-lander"
rules = ["hic", "misc"]
seeds = { first = 1, count = 3 }
episodes = 2
"#;

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let ran = run(folder, arguments.iter().copied().chain(["--json"]));
    assert_eq!(ran.code, Some(0), "{arguments:?}: {}", ran.stderr);
    serde_json::from_str(&ran.stdout).unwrap()
}

#[test]
fn what_has_finished_does_not_run_again() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("sweep.toml"), SMALL).unwrap();
    let first = json(path, &["sweep", "run", "sweep.toml", "--out", "out"]);
    assert_eq!((&first["jobs"], &first["ran"]), (&6.into(), &6.into()));
    let more = SMALL.replace("count = 3", "count = 4");
    fs::write(path.join("sweep.toml"), more).unwrap();
    let second = json(path, &["sweep", "run", "sweep.toml", "--out", "out", "--threads", "1"]);
    assert_eq!((&second["finished_before"], &second["ran"]), (&6.into(), &2.into()));
    let report = json(path, &["sweep", "report", "out"]);
    for file in report["files"].as_array().unwrap() {
        assert!(path.join("out").join(file.as_str().unwrap()).is_file());
    }
    let text = fs::read_to_string(path.join("out/report.md")).unwrap();
    assert!(text.contains("8 of 8 jobs have finished") && text.contains("this machine"), "{text}");
}

#[test]
fn a_python_without_the_package_is_said_in_words() {
    let folder = folder();
    fs::write(folder.path().join("sweep.toml"), SMALL).unwrap();
    let command = ["sweep", "run", "sweep.toml", "--out", "out", "--executor", "ray", "--python"];
    for (python, words) in [("no-such-python", "cannot start no-such-python"), ("false", "--python")] {
        let ran = run(folder.path(), command.into_iter().chain([python]));
        assert_eq!(ran.code, Some(1));
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
}

#[test]
fn what_is_no_sweep_is_refused_in_words() {
    let folder = folder();
    let path = folder.path();
    for (file, text, words) in [
        ("a.toml", "title = 1".into(), "cannot be read"),
        ("b.toml", SMALL.replace("misc", "mics"), "no rule is called"),
    ] {
        fs::write(path.join(file), text).unwrap();
        let ran = run(path, ["sweep", "run", file, "--out", "out"]);
        assert_eq!(ran.code, Some(1));
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
    let ran = run(path, ["sweep", "report", "nowhere"]);
    assert!(ran.code == Some(1) && ran.stderr.contains("no sweep ran here"), "{}", ran.stderr);
}

#[test]
fn the_example_can_be_planned() {
    let text = fs::read_to_string(in_project("python/examples/sweep.toml")).unwrap();
    let folder = folder();
    let one = text.replace("count = 10", "count = 1").replace("episodes = 20", "episodes = 1");
    fs::write(folder.path().join("sweep.toml"), one).unwrap();
    let ran = json(folder.path(), &["sweep", "run", "sweep.toml", "--out", "out"]);
    // Three rules under two heads and the human alone, each with three kinds of pilots.
    assert_eq!(ran["jobs"], 21);
}
