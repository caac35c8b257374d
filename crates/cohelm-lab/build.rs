//! Names the sources that have a part in the bits of a job of a sweep, so that two builds of one version can be told
//! apart: `COHELM_SOURCES` is a SHA-256 of the project's crates and of Cargo.lock, the same on every machine.

use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::{env, fs};

/// They start jobs, show or keep what came of them; nothing of them is in it.
const NO_PART: [&str; 3] = ["cohelm-cli", "cohelm-page", "cohelm-server"];
/// Hexadecimal digits that are kept: enough for two builds never to share them by chance.
const DIGITS: usize = 16;

fn main() {
    let this = env::var("CARGO_MANIFEST_DIR").expect("cargo sets it");
    let crates = Path::new(&this).parent().expect("a crate lies in a folder");
    let mut files = Vec::new();
    for member in members(crates) {
        for part in ["Cargo.toml", "src"] {
            let part = member.join(part);
            println!("cargo::rerun-if-changed={}", part.display());
            collect(part, &mut files);
        }
    }
    // Not there where the crates are used from elsewhere than this project's folder.
    let lock = crates.join("../Cargo.lock");
    println!("cargo::rerun-if-changed={}", lock.display());
    collect(lock, &mut files);
    println!("cargo::rustc-env=COHELM_SOURCES={:.DIGITS$}", digest(crates, files));
}

fn members(crates: &Path) -> Vec<PathBuf> {
    let named = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.starts_with("cohelm") && !NO_PART.contains(&name.as_str())
    };
    fs::read_dir(crates).expect("it lies there").flatten().map(|entry| entry.path()).filter(named).collect()
}

/// This file, or the files in this folder, without what editors leave behind.
fn collect(path: PathBuf, files: &mut Vec<PathBuf>) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if name.starts_with('.') || name.ends_with('~') {
    } else if path.is_file() {
        files.push(path);
    } else if let Ok(entries) = fs::read_dir(&path) {
        entries.flatten().for_each(|entry| collect(entry.path(), files));
    }
}

/// Of names and contents in the order of the names; line ends count as one letter, however git writes them here.
fn digest(crates: &Path, files: Vec<PathBuf>) -> String {
    let named = |path: PathBuf| {
        let name = path.strip_prefix(crates).unwrap_or(&path).to_string_lossy().replace('\\', "/");
        (name, path)
    };
    let mut files: Vec<(String, PathBuf)> = files.into_iter().map(named).collect();
    files.sort();
    let mut all = Sha256::new();
    for (name, path) in files {
        let mut content = fs::read(&path).expect("it was just listed");
        content.retain(|&byte| byte != b'\r');
        all.update(format!("{name}\n{}\n", content.len()));
        all.update(content);
    }
    all.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
