//! Lists the model files of the folder `models/` for [`shipped`](src/shipped.rs). A folder that is empty or missing
//! makes an empty list, never a failed build: that a model is missing is the business of the command that needs it.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let folder = Path::new(&variable("CARGO_MANIFEST_DIR")?).join("../../models");
    println!("cargo::rerun-if-changed={}", folder.display());
    let listed = if env::var_os("CARGO_FEATURE_SHIPPED").is_some() { models(&folder) } else { Vec::new() };
    let lines = listed.iter().map(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        format!("    ({name:?}, include_bytes!({path:?})),\n")
    });
    let list = format!("&[\n{}]\n", lines.collect::<String>());
    fs::write(Path::new(&variable("OUT_DIR")?).join("shipped_models.in"), list)
}

fn variable(name: &str) -> io::Result<String> {
    env::var(name).map_err(|error| io::Error::other(format!("{name}: {error}")))
}

/// Absolute paths of all model files, sorted by name.
fn models(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let paths = entries.flatten().map(|entry| entry.path());
    let models = paths.filter(|path| path.extension().is_some_and(|extension| extension == "safetensors"));
    let mut models: Vec<PathBuf> = models.filter_map(|path| path.canonicalize().ok()).collect();
    models.sort();
    models
}
