//! The threat list names tests that are there.

use std::path::{Path, PathBuf};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The file and the name of each test in a row of the list, both as they stand there; `…` cuts a name short.
fn named(row: &str) -> Vec<(&str, &str)> {
    let ticked: Vec<&str> = row.split('`').skip(1).step_by(2).collect();
    let mut file = None;
    let mut tests = Vec::new();
    for word in ticked {
        if word.ends_with(".rs") {
            file = Some(word);
        } else if let Some(file) = file.filter(|_| word.contains('_')) {
            tests.push((file, word));
        }
    }
    tests
}

#[test]
fn every_test_that_the_threat_list_names_is_there() {
    let root = Path::new(ROOT);
    let list = std::fs::read_to_string(root.join("../../docs/security.md")).unwrap();
    let mut count = 0;
    for (file, name) in list.lines().filter(|line| line.starts_with('|')).flat_map(named) {
        let path: PathBuf = root.join("src").join(file);
        let source = std::fs::read_to_string(&path).unwrap_or_else(|_| panic!("there is no {file}"));
        let parts: Vec<&str> = name.split('…').filter(|part| !part.is_empty()).collect();
        let found = source
            .lines()
            .filter(|line| line.contains("fn "))
            .any(|line| parts.iter().all(|part| line.contains(part)));
        assert!(found, "{file} has no test {name}");
        count += 1;
    }
    assert!(count > 30, "only {count} were found");
}
