//! ARCHITECTURE.md says what depends on what; the manifests must agree.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The code map: for each crate, which of ours it depends on.
fn map() -> BTreeMap<String, BTreeSet<String>> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("| `cohelm"));
    let cells = |row: &str| row.split('|').map(|cell| cell.trim().to_string()).collect::<Vec<_>>();
    let mut map: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for row in rows.map(cells) {
        let names = row[4].split('`').skip(1).step_by(2).map(String::from).collect();
        map.insert(row[1].trim_matches('`').into(), names);
    }
    let everything: BTreeSet<String> =
        map.keys().filter(|name| !["cohelm-page", "cohelm-cli"].contains(&name.as_str())).cloned().collect();
    map.insert("cohelm-cli".into(), everything);
    map
}

/// What a manifest's `[dependencies]` (not those of tests) names of ours.
fn dependencies(manifest: &Path) -> BTreeSet<String> {
    let text = fs::read_to_string(manifest).unwrap();
    let section = text.split("\n[").find(|section| section.starts_with("dependencies]")).unwrap_or("");
    let names = section.lines().filter_map(|line| line.split(['.', ' ', '=']).next());
    names.filter(|name| name.starts_with("cohelm")).map(String::from).collect()
}

#[test]
fn the_code_map_agrees_with_the_manifests() {
    let folders = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let manifests: BTreeMap<String, BTreeSet<String>> = folders
        .map(|path| {
            (path.file_name().unwrap().to_string_lossy().into(), dependencies(&path.join("Cargo.toml")))
        })
        .collect();
    assert_eq!(manifests, map());
}

#[test]
fn the_code_map_names_every_folder() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let is_ours = |name: &str| !name.starts_with('.') && !["target", "node_modules"].contains(&name);
    for entry in fs::read_dir(root()).unwrap().map(Result::unwrap) {
        let name = entry.file_name().to_string_lossy().to_string();
        let tracked = entry.path().is_dir() && is_ours(&name) && !name.starts_with("reproduce");
        assert!(!tracked || text.contains(&format!("`{name}/`")), "ARCHITECTURE.md does not name {name}/");
    }
}

#[test]
fn the_architecture_stays_within_one_reading() {
    let lines = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap().lines().count();
    assert!(lines <= 150, "ARCHITECTURE.md has {lines} lines; at most 150 are promised");
}

/// Versions by package, from a Cargo.lock.
fn locked(lock: &str) -> BTreeMap<String, BTreeSet<String>> {
    let text = fs::read_to_string(root().join(lock)).unwrap();
    let mut versions: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in text.split("[[package]]\n").skip(1) {
        let value = |line: Option<&str>| line.and_then(|line| line.split('"').nth(1)).unwrap().to_string();
        let mut lines = package.lines();
        versions.entry(value(lines.next())).or_default().insert(value(lines.next()));
    }
    versions
}

/// A job of a sweep that the binary planned and a Python worker runs names the sources and the one Cargo.lock.
#[test]
fn the_python_package_is_built_from_the_versions_that_the_binary_is_built_from() {
    let (binary, package) = (locked("Cargo.lock"), locked("python/Cargo.lock"));
    assert!(package.contains_key("libm") && binary.contains_key("libm"));
    for (name, versions) in package {
        let known = binary.get(&name).is_none_or(|known| versions.is_subset(known));
        assert!(known, "{name}: python/Cargo.lock has {versions:?}, Cargo.lock {:?}", binary[&name]);
    }
}

/// The crates that bring an entry for a registry, found in their sources: a new plant is held to it without being named here.
fn plants() -> BTreeSet<String> {
    let is_plant =
        |name: &String| !mentions(&root().join("crates").join(name).join("src"), "-> PlantEntry").is_empty();
    // The point is the loop's own, the smallest plant for its tests.
    map().into_keys().filter(|name| name != "cohelm" && is_plant(name)).collect()
}

#[test]
fn only_the_binary_and_the_page_name_a_plant() {
    let plants = plants();
    for known in ["cohelm-arm", "cohelm-drone", "cohelm-lander"] {
        assert!(plants.contains(known), "{known} is a plant, found only {plants:?}");
    }
    for (name, needs) in map() {
        let may = ["cohelm-cli", "cohelm-page"].contains(&name.as_str());
        let named: Vec<_> = needs.intersection(&plants).collect();
        assert!(may || named.is_empty(), "{name} must not depend on a plant, and depends on {named:?}");
    }
}

/// A dependency is not the only way to know a plant.
#[test]
fn the_loop_studies_server_and_learning_speak_of_no_plants_crate() {
    for name in ["cohelm", "cohelm-study", "cohelm-server", "cohelm-lab", "cohelm-copilot", "cohelm-learn"] {
        for plant in plants() {
            let word = plant.replace('-', "_") + "::";
            let found = mentions(&root().join("crates").join(name).join("src"), &word);
            assert!(found.is_empty(), "{name} must not know {plant}: {found:?}");
        }
    }
}

/// Sources below a folder, those of tests aside, that hold a word.
fn mentions(folder: &Path, word: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let is_test = path.file_stem().is_some_and(|stem| stem == "tests" || stem == "testing");
        if path.is_dir() && !is_test {
            found.extend(mentions(&path, word));
        } else if path.extension().is_some_and(|kind| kind == "rs") && !is_test {
            let text = fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("");
            if code.contains(word) {
                found.push(path);
            }
        }
    }
    found
}
