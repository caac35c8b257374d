//! `cargo run -p cohelm-study --example study -- FOLDER [simulated|few]`
//!
//! Writes the report of a study that never took place, from invented numbers: to look at while changing how it is set.
//! `simulated` marks the participants as simulated, `few` leaves three of them. Beside it
//! stand a report of power and the tables of the export.

mod invented;

use cohelm_study::analysis::{Options, Quantity};
use cohelm_study::dataset::Dataset;
use cohelm_study::export::write_folder;
use cohelm_study::measures::measure;
use cohelm_study::power::{Answered, Assumption, Question, document};
use cohelm_study::report::{Document, study_report};
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
    let files = study_report(&dataset, &Options::default()).files("report");
    for (name, bytes) in files.into_iter().chain(power(&dataset)?.files("power")) {
        let path = Path::new(&folder).join(name);
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
        std::fs::write(path, bytes)?;
    }
    write_folder(&Path::new(&folder).join("data"), &dataset)?;
    Ok(())
}

/// Power for a stated effect on success, and for what the invented participants show of steps.
fn power(dataset: &Dataset) -> Outcome<Document> {
    let stated = Assumption::Stated { effect: 0.1, sd: 0.13, correlation: 0.3 };
    let steps = Quantity::of_flights("ticks_with_command").ok_or("no such measure")?;
    let shown = Assumption::of(dataset, &steps, 1, 2);
    let questions = [("success", stated), ("ticks_with_command", shown)];
    let mut answers = Vec::new();
    for (key, assumption) in questions {
        let measure = *measure(key).ok_or("no such measure")?;
        let conditions = ("misc".to_owned(), "lasc".to_owned());
        let curve = Question { draws: 1000, ..Question::new(assumption) }.answer()?;
        answers.push(Answered { measure, conditions, curve });
    }
    Ok(document("Power, from invented numbers", &answers)?)
}
