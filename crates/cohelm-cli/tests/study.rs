//! `cohelm study` as people use it: checked, tried with simulated participants, exported, reported from another folder.

mod program;

use program::{file, folder, in_project, run};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// A study of a few flights: enough to have something of everything.
const SMALL: &str = r#"
cohelm-study = 1
name = "small"
title = "A small study"
contact = "the one who wrote it"
planned-participants = 2
order = "latin-square"
consent = { version = "1", text = "Do you agree?" }
primary = { measure = "success" }
end-questionnaires = ["paper-survey"]

[task]
plant = "flag-lander"

[[conditions]]
name = "hic"
rule = "hic"
measured-episodes = 2
questionnaires = ["nasa-tlx"]

[[conditions]]
name = "misc"
rule = "misc"
inference = "softmax"
practice-episodes = 1
measured-episodes = 2
questionnaires = ["nasa-tlx"]

[terrain]
seed = 1
"#;

/// Runs a command that must succeed; gives what it printed.
#[track_caller]
fn done(folder: &Path, arguments: &[&str]) -> String {
    let ran = run(folder, arguments);
    assert_eq!(ran.code, Some(0), "cohelm {}: {}{}", arguments.join(" "), ran.stdout, ran.stderr);
    ran.stdout
}

#[track_caller]
fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let ran = run(folder, arguments);
    assert_eq!(
        (ran.code, ran.stdout.as_str()),
        (Some(1), ""),
        "cohelm {}: {}",
        arguments.join(" "),
        ran.stderr
    );
    assert!(ran.stderr.starts_with("cohelm: ") && !ran.stderr.contains("panicked"), "{}", ran.stderr);
    for word in words {
        assert!(ran.stderr.contains(word), "{word:?} is not in {}", ran.stderr);
    }
}

/// Every file of a folder and those below it, with its bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else {
                let name = entry.strip_prefix(folder).unwrap().display().to_string();
                found.insert(name, fs::read(&entry).unwrap());
            }
        }
    }
    found
}

#[test]
fn the_studies_that_come_along_can_be_run() {
    let folder = folder();
    for entry in fs::read_dir(in_project("studies")).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.extension().is_some_and(|extension| extension == "toml") {
            let told = done(folder.path(), &["study", "check", entry.to_str().unwrap()]);
            assert!(
                told.contains("One participant") && told.contains("minutes"),
                "{}: {told}",
                entry.display()
            );
        }
    }
    let schema: Value = serde_json::from_str(&done(folder.path(), &["study", "schema"])).unwrap();
    assert!(schema["properties"]["conditions"].is_object());
}

#[test]
fn what_is_wrong_with_a_file_is_told_with_its_place() {
    let folder = folder();
    file(&folder, "key.toml", SMALL.replace("measured-episodes = 2", "mesured-episodes = 2").as_bytes());
    refused(
        folder.path(),
        &["study", "check", "key.toml"],
        &["key.toml: line ", "column", "measured-episodes"],
    );
    file(&folder, "plant.toml", SMALL.replace("flag-lander", "kite").as_bytes());
    refused(folder.path(), &["study", "check", "plant.toml"], &["plant.toml", "kite", "flag-lander"]);
    file(
        &folder,
        "model.toml",
        SMALL.replace("[task]", &format!("[task]\nvalues = \"{}\"", "0".repeat(64))).as_bytes(),
    );
    refused(folder.path(), &["study", "check", "model.toml"], &["model.toml", "model", "0000"]);
    for command in ["check", "run", "dry-run", "power"] {
        refused(folder.path(), &["study", command, "missing.toml"], &["cannot read missing.toml"]);
    }
}

#[test]
fn a_dry_run_is_exported_and_reported_alike_from_database_backup_and_archive() {
    let folder = folder();
    let here = folder.path();
    file(&folder, "small.toml", SMALL.as_bytes());
    let dry = [
        "study",
        "dry-run",
        "small.toml",
        "--participants",
        "3",
        "--database",
        "dry.db",
        "--out",
        "dry",
        "--json",
    ];
    let summary: Value = serde_json::from_str(&done(here, &dry)).unwrap();
    assert_eq!((&summary["completed"], &summary["flights"]), (&Value::from(3), &Value::from(15)));
    assert_eq!(summary["simulated"], Value::from(true));

    let answers = fs::read_to_string(here.join("dry/answers.csv")).unwrap();
    assert!(answers.lines().count() > 3 * 11, "no item was asked: {answers}");
    let report = fs::read_to_string(here.join("dry/report.html")).unwrap();
    assert!(report.contains("simulated"), "the report does not say that nobody took part");

    done(here, &["study", "backup", "dry.db", "copy.db"]);
    refused(here, &["study", "backup", "dry.db", "copy.db"], &["copy.db"]);
    done(here, &["study", "restore", "copy.db", "again.db"]);
    for (from, out) in [("dry.db", "a"), ("copy.db", "b"), ("dry/small.zip", "c"), ("again.db", "d")] {
        done(here, &["study", "export", from, "--out", out]);
        done(here, &["study", "report", from, "--out", out]);
        let (first, other) = (files(&here.join("dry")), files(&here.join(out)));
        assert_eq!(first.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>(), "{from}");
        for (name, bytes) in first {
            assert!(bytes == other[&name], "{name} from {from} differs");
        }
    }
    done(here, &["verify", "episodes", "--database", "dry.db"]);
}

#[test]
fn power_needs_an_effect_and_says_what_it_assumes() {
    let folder = folder();
    file(&folder, "small.toml", SMALL.as_bytes());
    let power = ["study", "power", "small.toml"];
    refused(folder.path(), &power, &["--effect", "--simulated"]);
    refused(
        folder.path(),
        &[&power[..], &["--effect", "0.2", "--sd", "0.3", "--measure", "bliss"]].concat(),
        &["bliss"],
    );
    refused(
        folder.path(),
        &[&power[..], &["--effect", "0.2", "--sd", "-1"]].concat(),
        &["standard deviation"],
    );
    let stated =
        [&power[..], &["--effect", "0.2", "--sd", "0.25", "--draws", "200", "--out", "power"]].concat();
    let told = done(folder.path(), &stated);
    assert!(told.contains("Assumed: a mean difference of 0.2") && told.contains("hic − misc"), "{told}");
    assert!(folder.path().join("power/power.html").exists());
}

#[test]
fn what_is_no_study_is_refused() {
    let folder = folder();
    file(&folder, "half.zip", b"PK\x03\x04 and no more");
    refused(folder.path(), &["study", "report", "half.zip"], &["half.zip"]);
    refused(folder.path(), &["study", "export", "missing.db"], &["there is no database missing.db"]);
    refused(folder.path(), &["study", "backup", "missing.db", "to.db"], &["missing.db"]);
    refused(folder.path(), &["study", "export", "mysql://somewhere"], &["mysql", "PostgreSQL"]);
    file(&folder, "small.toml", SMALL.as_bytes());
    file(&folder, "secret", b"short\n");
    refused(
        folder.path(),
        &["study", "run", "small.toml", "--port", "0", "--secret-file", "secret"],
        &["secret", "8"],
    );
    refused(
        folder.path(),
        &["study", "run", "small.toml", "--port", "0", "--address", "study.example"],
        &["https://"],
    );
    refused(folder.path(), &["study", "dry-run", "small.toml", "--participants", "0"], &["at least one"]);
    refused(folder.path(), &["verify", "kills", "--rounds", "0"], &["at least one"]);
}
