//! Puts the built page (`web/dist`) into the program. Runs no npm: without that folder the program is built without a
//! page and says so when it is asked for one.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../../web/dist");
    // Of a folder that is missing, cargo watches the appearance.
    println!("cargo::rerun-if-changed={}", root.display());
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    let mut list = String::from("&[\n");
    for file in files {
        let name = file.strip_prefix(&root).expect("it was found there").to_string_lossy().replace('\\', "/");
        let file = fs::canonicalize(&file).expect("it was just listed");
        println!("cargo::rerun-if-changed={}", file.display());
        writeln!(list, "    (\"/{name}\", include_bytes!({:?})),", file.display().to_string())
            .expect("memory");
    }
    list.push_str("]\n");
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("page.in");
    fs::write(out, list).expect("the folder for build outputs can be written");
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        if path.is_dir() { collect(&path, files) } else { files.push(path) }
    }
}
