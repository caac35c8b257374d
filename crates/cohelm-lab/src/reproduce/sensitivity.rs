//! The reproduction again under other circumstances: does a verdict hang on the pilots, the actions or the robot?

use super::claims::{Trained, claims};
use super::name;
use crate::results::Results;
use cohelm_study::csv::{Cell, Csv};
use cohelm_study::measures::measure;
use cohelm_study::report::{Align, Block, Document, Table};
use cohelm_study::text::Text;
use serde::Serialize;

/// One other circumstance, flown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Variation {
    /// What is different, in a few words.
    pub name: String,
    /// Mean of each measure in each condition: measure key, condition name, mean.
    pub means: Vec<(String, String, f64)>,
    /// The verdict on each claim, in the words of the report.
    pub verdicts: Vec<(String, String)>,
}

/// Measures of the table.
const MEASURES: [&str; 5] = ["success", "crash", "steps", "ticks_with_command", "nominal_interventions"];
/// Conditions of the table.
const SHOWN: [&str; 7] =
    [name::HIC, name::LASC, name::MISC, name::LASC_PEAKED, name::MISC_PEAKED, name::TOLERANCE, name::MISC_R];

impl Variation {
    /// What the results of a variation come to.
    pub fn of(name: &str, results: &Results<'_>, trained: Trained<'_>) -> Self {
        let mean = |key: &&str, condition: &&str| {
            let mean = results.mean(key, results.condition(condition)?)?;
            Some((key.to_string(), condition.to_string(), mean))
        };
        let means =
            MEASURES.iter().flat_map(|key| SHOWN.iter().filter_map(move |condition| mean(key, condition)));
        let judged = claims(results, trained);
        let verdicts = judged.iter().map(|row| (row.claim.to_string(), row.judgement.verdict.words()));
        Self { name: name.into(), means: means.collect(), verdicts: verdicts.collect() }
    }

    fn mean(&self, key: &str, condition: &str) -> Option<f64> {
        let of = |(k, c, _): &&(String, String, f64)| k == key && c == condition;
        self.means.iter().find(of).map(|(_, _, mean)| *mean)
    }
}

/// A row a variation, measure and condition.
pub fn csv(variations: &[Variation]) -> Csv {
    let mut csv = Csv::new(["variation", "measure", "condition", "mean"]);
    for variation in variations {
        for (key, condition, mean) in &variation.means {
            let names = [variation.name.as_str(), key.as_str(), condition.as_str()].map(Cell::from);
            csv.push(names.into_iter().chain([Cell::from(*mean)]));
        }
    }
    csv
}

/// The report of all variations.
pub fn document(variations: &[Variation], participants: usize, episodes: usize) -> Document {
    let mut document = Document::new("How far the verdicts hang on the circumstances");
    document.lead = Text::from(format!(
        "The reproduction again, {participants} simulated participants, {episodes} episodes each in every condition, under \
         other pilots, actions, endings and robots."
    ));
    document.push(Block::warning(
        "The pilots are simulated",
        "No person flew here; no questionnaire was answered.",
    ));
    document.push(Block::heading("Verdicts"));
    document.push(Block::Table(verdict_table(variations)));
    for key in MEASURES {
        let measure = measure(key).expect("the table names defined measures");
        document.push(Block::heading(measure.title()));
        let columns = SHOWN.iter().map(|name| (Text::from(*name), Align::Right));
        let row = |variation: &Variation| {
            let cell = |condition: &&str| {
                variation.mean(key, condition).map_or("–".into(), |mean| measure.write(mean))
            };
            let cells = SHOWN.iter().map(cell).map(Text::from);
            std::iter::once(Text::from(variation.name.as_str())).chain(cells).collect()
        };
        document.push(Block::Table(Table {
            caption: Text::from(format!("{}, mean over participants.", measure.title())),
            columns: std::iter::once((Text::from("Variation"), Align::Left)).chain(columns).collect(),
            rows: variations.iter().map(row).collect(),
            notes: Vec::new(),
        }));
    }
    document
}

fn verdict_table(variations: &[Variation]) -> Table {
    let claims: Vec<&str> = variations
        .first()
        .map_or(Vec::new(), |first| first.verdicts.iter().map(|(claim, _)| claim.as_str()).collect());
    let number = |i: usize| (Text::from(format!("{}", i + 1)), Align::Left);
    let row = |variation: &Variation| {
        let cells = variation.verdicts.iter().map(|(_, verdict)| Text::from(verdict.as_str()));
        std::iter::once(Text::from(variation.name.as_str())).chain(cells).collect()
    };
    let legend = claims.iter().enumerate().map(|(i, claim)| Text::from(format!("{}: {claim}", i + 1)));
    Table {
        caption: Text::from("The verdict on each claim."),
        columns: std::iter::once((Text::from("Variation"), Align::Left))
            .chain((0..claims.len()).map(number))
            .collect(),
        rows: variations.iter().map(row).collect(),
        notes: legend.collect(),
    }
}
