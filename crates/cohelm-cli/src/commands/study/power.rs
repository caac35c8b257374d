//! `cohelm study power`: how many participants it takes to see an effect.

use super::data::Source;
use super::dry_run::Crowd;
use super::shelf::Shelf;
use crate::commands::reproduce::write;
use crate::numbers::whole;
use crate::output::{Format, table};
use crate::rig;
use anyhow::{Context, Result, anyhow, bail};
use clap::{Args, ValueEnum};
use cohelm::human::Population;
use cohelm_lab::study::dataset;
use cohelm_study::analysis::Quantity;
use cohelm_study::dataset::Dataset;
use cohelm_study::design::Design;
use cohelm_study::measures::{Measure, Unit};
use cohelm_study::power::{Answered, Assumption, Question, Test, document};
use serde_json::json;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Draws a study many times with few and with many participants, and says from how many on its test finds the effect.
///
/// The effect is stated (--effect, --sd, --correlation), in the measure's unit, or taken from simulated participants
/// (--simulated, or --from a dry run). Simulated participants are not people: what they show is a guess at best.
#[derive(Args)]
pub struct Power {
    /// The study's file.
    file: PathBuf,
    /// A measure, such as success, or a score, such as nasa-tlx/overall; may be given again. The primary outcome unless
    /// given.
    #[arg(long = "measure", value_name = "MEASURE")]
    measures: Vec<String>,
    /// The two conditions to compare, first − second; the first two of the primary outcome unless given.
    #[arg(long, num_args = 2, value_names = ["FIRST", "SECOND"])]
    conditions: Vec<String>,
    /// The mean difference between the two conditions.
    #[arg(long, value_name = "DIFFERENCE", requires = "sd", conflicts_with_all = ["simulated", "from"])]
    effect: Option<f64>,
    /// The standard deviation between participants, within a condition.
    #[arg(long, requires = "effect")]
    sd: Option<f64>,
    /// The correlation between a participant's two values, −1 to 1.
    #[arg(long, default_value_t = 0.5)]
    correlation: f64,
    /// Take the effect from so many simulated participants, who fly the study first.
    #[arg(long, value_name = "PARTICIPANTS", value_parser = whole::<usize>)]
    simulated: Option<usize>,
    /// Take the effect from a database or archive of simulated participants.
    #[arg(long, value_name = "FILE|URL", conflicts_with = "simulated")]
    from: Option<OsString>,
    /// The test that will be carried out.
    #[arg(long, value_enum, default_value_t = TestName::PairedT)]
    test: TestName,
    /// Level of significance; the design's unless given.
    #[arg(long)]
    alpha: Option<f64>,
    /// The largest number of participants to ask about.
    #[arg(long, default_value_t = 60, value_parser = whole::<usize>)]
    most: usize,
    /// Studies drawn for each number of participants.
    #[arg(long, default_value_t = 2_000, value_parser = whole::<usize>)]
    draws: usize,
    /// Fixes what is drawn.
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    seed: u64,
    /// A folder for a report with the curves; not written unless given.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    #[command(flatten)]
    format: Format,
}

/// The tests.
#[derive(Clone, Copy, ValueEnum)]
enum TestName {
    /// Paired t test.
    PairedT,
    /// Wilcoxon's signed-rank test.
    Wilcoxon,
}

/// Where the effect comes from.
enum Effect {
    Stated { effect: f64, sd: f64, correlation: f64 },
    Simulated(Box<Dataset>),
}

impl Power {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        let shelf = Shelf::new(&[])?;
        let (design, _) = shelf.design(&self.file)?;
        let names = if self.measures.is_empty() {
            vec![design.primary.measure.clone()]
        } else {
            self.measures.clone()
        };
        let conditions = self.conditions(&design)?;
        let effect = self.assumed(&design, shelf)?;
        let quantities = names.iter().map(|name| quantity(&design, name)).collect::<Result<Vec<_>>>()?;
        let answers = quantities
            .iter()
            .map(|quantity| self.answer(&design, quantity, conditions, &effect))
            .collect::<Result<Vec<_>>>()?;
        if let Some(out) = &self.out {
            let title = format!("Power of the study {}", design.name);
            for (name, bytes) in document(&title, &answers)?.files("power") {
                write(&out.join(name), &bytes)?;
            }
        }
        let simulated = matches!(effect, Effect::Simulated(_));
        self.print(&answers, simulated);
        Ok(ExitCode::SUCCESS)
    }

    /// Indices of the two conditions.
    fn conditions(&self, design: &Design) -> Result<[usize; 2]> {
        let all: Vec<String> = design.conditions.iter().map(|condition| condition.name.clone()).collect();
        let declared = if design.primary.conditions.len() >= 2 { &design.primary.conditions } else { &all };
        let wanted = if self.conditions.is_empty() { declared } else { &self.conditions };
        let index = |name: &String| {
            let found = all.iter().position(|known| known == name);
            found.with_context(|| format!("there is no condition {name:?}; there are: {}", all.join(", ")))
        };
        match wanted.as_slice() {
            [first, second, ..] if first != second => Ok([index(first)?, index(second)?]),
            _ => bail!("power is about two different conditions; name them with --conditions FIRST SECOND"),
        }
    }

    fn assumed(&self, design: &Design, shelf: Shelf) -> Result<Effect> {
        if let (Some(effect), Some(sd)) = (self.effect, self.sd) {
            return Ok(Effect::Stated { effect, sd, correlation: self.correlation });
        }
        let records = match (&self.from, self.simulated) {
            (Some(from), _) => Source { from, study: Some(&design.name) }.records()?,
            (None, Some(participants)) => {
                let crowd = Crowd {
                    participants,
                    seed: self.seed,
                    population: Population::Ordinary,
                    shows_progress: self.format.shows_progress(),
                };
                crowd.walk(design, shelf, None)?.1
            }
            (None, None) => bail!(
                "which effect? State it with --effect and --sd, or let --simulated participants fly (people are needed \
                 to know it)"
            ),
        };
        let data = dataset(&records, &rig::plants(), 0)?;
        if !data.simulated() {
            bail!(
                "people took part in that study: power computed from the effect that was found says nothing new"
            );
        }
        Ok(Effect::Simulated(Box::new(data)))
    }

    fn answer<'a>(
        &self,
        design: &Design,
        quantity: &'a Quantity,
        conditions: [usize; 2],
        effect: &Effect,
    ) -> Result<Answered<'a>> {
        if let &Effect::Stated { effect, sd, .. } = effect {
            possible(&quantity.measure(), effect, sd)?;
        }
        let assumption = match effect {
            &Effect::Stated { effect, sd, correlation } => Assumption::Stated { effect, sd, correlation },
            Effect::Simulated(data) => simulated(data, quantity, conditions)?,
        };
        let test = match self.test {
            TestName::PairedT => Test::PairedT,
            TestName::Wilcoxon => Test::Wilcoxon,
        };
        let alpha = self.alpha.unwrap_or(design.primary.alpha);
        let question =
            Question { assumption, test, alpha, most: self.most, draws: self.draws, seed: self.seed };
        let [first, second] = conditions.map(|index| design.conditions[index].name.clone());
        let curve = question.answer().with_context(|| quantity.key.clone())?;
        Ok(Answered { measure: quantity.measure(), conditions: (first, second), curve })
    }

    fn print(&self, answers: &[Answered<'_>], simulated: bool) {
        let about = |answer: &Answered<'_>| {
            let (first, second) = &answer.conditions;
            json!({
                "measure": answer.measure.key, "conditions": [first, second], "curve": answer.curve,
                "participants_80": answer.curve.smallest(0.8), "participants_90": answer.curve.smallest(0.9),
            })
        };
        let report = json!({
            "simulated_pilots": simulated, "answers": answers.iter().map(about).collect::<Vec<_>>(),
            "folder": self.out,
        });
        self.format.print(&report, |_| self.text(answers, simulated));
    }

    fn text(&self, answers: &[Answered<'_>], simulated: bool) -> String {
        let enough = |answer: &Answered<'_>, target| {
            answer.curve.smallest(target).map_or(format!("> {}", self.most), |n| n.to_string())
        };
        let row = |answer: &Answered<'_>| {
            let (first, second) = &answer.conditions;
            let d_z = answer.curve.d_z.map_or("–".into(), |d_z| format!("{d_z:.2}"));
            vec![
                answer.measure.title(),
                format!("{first} − {second}"),
                d_z,
                enough(answer, 0.8),
                enough(answer, 0.9),
            ]
        };
        let rows: Vec<Vec<String>> = answers.iter().map(row).collect();
        let head = ["measure", "difference", "effect d_z", "n for 80 %", "n for 90 %"];
        let assumed = match answers.first().map(|answer| &answer.curve.question.assumption) {
            Some(Assumption::Stated { effect, sd, correlation }) => format!(
                "Assumed: a mean difference of {effect}, a standard deviation between participants of {sd}, a correlation \
                 of {correlation} between a participant's two values."
            ),
            Some(Assumption::Simulated { first, .. }) => format!(
                "Assumed: what {} simulated participants showed, spread between them included. Simulated participants are \
                 not people: their spread is that of a model's traits, and the number of people needed may be quite \
                 another.",
                first.len()
            ),
            None => String::new(),
        };
        let test = answers.first().map_or(String::new(), |answer| {
            let question = &answer.curve.question;
            format!(
                "{}, α = {}, {} studies drawn for each number",
                question.test.name(),
                question.alpha,
                question.draws
            )
        });
        let written =
            self.out.as_ref().map_or(String::new(), |out| format!("\nwritten to {}", out.display()));
        let warning = if simulated { "The participants are simulated.\n" } else { "" };
        format!("{warning}{assumed}\n{test}\n\n{}{written}", table(&head, &rows))
    }
}

/// Shares differ by at most one, and so do they spread: whoever writes percentage points is told.
fn possible(measure: &Measure<'_>, effect: f64, sd: f64) -> Result<()> {
    let wrong = measure.unit == Unit::Share && (effect.abs() > 1.0 || sd > 1.0);
    if wrong {
        bail!(
            "{} is a share of one: --effect lies in −1 to 1 and --sd in 0 to 1 (0.2 for 20 percentage points), got {effect} \
             and {sd}",
            measure.key
        );
    }
    Ok(())
}

/// A measure of flights, or a score of a questionnaire that the design asks.
fn quantity(design: &Design, name: &str) -> Result<Quantity> {
    if let Some(quantity) = Quantity::of_flights(name) {
        return Ok(quantity);
    }
    let asked = |instrument: &str| {
        design
            .conditions
            .iter()
            .any(|condition| condition.questionnaires.iter().any(|asked| asked == instrument))
    };
    match name.split_once('/') {
        Some((instrument, scale)) if asked(instrument) => Ok(Quantity::of_score(design, instrument, scale)),
        _ => Err(anyhow!(
            "there is no measure {name:?}; a measure of flights is meant, such as success or steps, or QUESTIONNAIRE/SCORE \
             of one that is asked after a condition"
        )),
    }
}

/// The values of simulated participants in two conditions.
fn simulated(data: &Dataset, quantity: &Quantity, [first, second]: [usize; 2]) -> Result<Assumption> {
    let values = |condition| {
        let of = |participant: usize| quantity.value(data, participant, condition);
        data.analysed().into_iter().map(of).collect::<Vec<Option<f64>>>()
    };
    let pairs = values(first).into_iter().zip(values(second));
    let (first, second): (Vec<f64>, Vec<f64>) = pairs.filter_map(|(first, second)| first.zip(second)).unzip();
    if first.is_empty() {
        bail!(
            "the simulated participants have no values of {:?} in both conditions; they answer no questionnaire",
            quantity.key
        );
    }
    Ok(Assumption::Simulated { first, second })
}
