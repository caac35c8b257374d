//! `cargo run -p cohelm-study --example study -- FOLDER [simulated|few]`
//!
//! Writes the report of a study that never took place, from invented numbers: to look at while changing how it is set.
//! `simulated` marks the participants as simulated, `few` leaves three of them.

mod invented;

use cohelm_study::analysis::Options;
use cohelm_study::report::study_report;
use std::path::Path;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("say where to write: study FOLDER [simulated|few]")?;
    let mut dataset = invented::dataset()?;
    match arguments.next().as_deref() {
        Some("simulated") => invented::simulate(&mut dataset),
        Some("few") => invented::leave(&mut dataset, 3),
        _ => {}
    }
    for (name, bytes) in study_report(&dataset, &Options::default()).files("report") {
        let path = Path::new(&folder).join(name);
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
        std::fs::write(path, bytes)?;
    }
    Ok(())
}
