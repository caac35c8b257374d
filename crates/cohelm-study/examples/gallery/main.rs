//! `cargo run --release -p cohelm-study --example gallery FOLDER`
//!
//! Writes one of every kind of figure and a report with every kind of block, from invented numbers: to look at while
//! changing how they are drawn and set.

mod figures;
mod invented;
mod report;

use std::path::Path;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Outcome<()> {
    let folder = std::env::args().nth(1).ok_or("say where to write: gallery FOLDER")?;
    let folder = Path::new(&folder);
    for (name, figure) in figures::figures()? {
        write(folder, &format!("{name}.svg"), figure.svg().as_bytes())?;
        write(folder, &format!("{name}.png"), &figure.png(2.0))?;
        write(folder, &format!("{name}.csv"), figure.csv().to_string().as_bytes())?;
    }
    for (name, bytes) in report::report()?.files("report") {
        write(folder, &name, &bytes)?;
    }
    Ok(())
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> Outcome<()> {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap_or(folder))?;
    Ok(std::fs::write(path, bytes)?)
}
