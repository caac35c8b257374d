//! `cohelm intents`: every inference on the same flights, and how long each takes to follow a changed mind.

use crate::numbers::whole;
use crate::output::{Format, table};
use crate::rig;
use anyhow::{Result, bail};
use clap::Args;
use cohelm::arbitration::{DEFAULT_KAPPA, Rule};
use cohelm::human::{Person, Population};
use cohelm::intent::Inference;
use cohelm::plant::Plant;
use cohelm_copilot::Kind;
use cohelm_lab::experiment::Rig;
use cohelm_lab::intents::{IntentRow, IntentTrial};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

/// Flies the same episodes under MISC and MISC-R with every inference, by simulated pilots, and scores what was believed.
#[derive(Args)]
pub struct Intents {
    /// The plant.
    #[arg(long, default_value = "flag-lander")]
    task: String,
    /// An option of the plant, NAME=VALUE; may be given again. With changes_mind=[60,120] the lander's pilots change their
    /// mind in mid-flight.
    #[arg(long = "option", value_name = "NAME=VALUE")]
    options: Vec<String>,
    /// More models, files or folders, beside the shipped ones; the newest that fits is taken.
    #[arg(long = "model", value_name = "PATH")]
    models: Vec<PathBuf>,
    /// A variant of intent models, such as changing, for the inferences that it serves; the others have the usual one.
    #[arg(long)]
    variant: Option<String>,
    /// What kind of simulated people fly.
    #[arg(long, default_value = "ordinary")]
    population: Population,
    /// Simulated participants.
    #[arg(long, default_value_t = 10, value_parser = whole::<usize>)]
    participants: usize,
    /// Episodes of each participant with every inference under every rule.
    #[arg(long, default_value_t = 20, value_parser = whole::<usize>)]
    episodes: usize,
    /// Fixes participants, episodes and everything else.
    #[arg(long, default_value_t = 0, value_parser = whole::<u64>)]
    seed: u64,
    /// Threads; 0 for one a core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>)]
    threads: usize,
    #[command(flatten)]
    format: Format,
}

impl Intents {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        if self.participants == 0 || self.episodes == 0 {
            bail!("at least one participant and one episode are needed");
        }
        let (plants, task) = (rig::plants(), rig::task(&self.task, &self.options)?);
        let plant = plants.make(&task)?;
        let models = rig::models(&self.models)?;
        rig::model_for(&models, Kind::Values, &task, plant.space())?;
        let able = |inference: &Inference| {
            inference.head().is_none() || models.newest_intent(*inference, &task, plant.space()).is_some()
        };
        let trial = IntentTrial {
            task: task.clone(),
            seed: self.seed,
            participants: self.participants,
            episodes: self.episodes,
            rules: vec![Rule::Misc, Rule::MiscR { kappa: DEFAULT_KAPPA }],
            inferences: Inference::ALL.into_iter().filter(able).collect(),
            variant: self.variant,
        };
        let pilots = |plant: &dyn Plant, seed: u64, index: usize| {
            let who = Person { population: self.population, seed, index: index as u64 };
            rig::simulated_person(&plants, &task, plant, who)
        };
        let rig = Rig { plants: &plants, models: &models, pilots: &pilots, threads: self.threads };
        let rows = trial.run(&rig)?;
        self.format.print(&json!({ "trial": trial, "rows": rows }), |_| text(&rows));
        Ok(ExitCode::SUCCESS)
    }
}

fn text(rows: &[IntentRow]) -> String {
    let mut text = table(&HEAD, &rows.iter().map(cells).collect::<Vec<_>>());
    let after: Vec<Vec<String>> = rows.iter().filter_map(cells_after).collect();
    if !after.is_empty() {
        text += "\n\nAfter the pilot changed its mind, until the inference followed (10 ticks in a row) or the end\n\n";
        text += &table(&HEAD_AFTER, &after);
    }
    text
}

const HEAD: [&str; 11] = [
    "rule, inference",
    "success",
    "elsewhere",
    "crash",
    "intervention",
    "right",
    "midway",
    "at end",
    "mean c",
    "calibration error",
    "flights",
];
const HEAD_AFTER: [&str; 6] =
    ["rule, inference", "followed", "median ticks", "intervention", "opposed", "flights"];

fn name(row: &IntentRow) -> String {
    format!("{}, {}", row.rule.word(), row.inference.word())
}

fn share(share: f64) -> String {
    format!("{share:.3}")
}

fn cells(row: &IntentRow) -> Vec<String> {
    let of_flights = [row.success, row.elsewhere, row.crash, row.interventions];
    let of_belief = [row.right, row.right_midway, row.right_at_end, row.confidence];
    let error = row.calibration_error.map_or("–".into(), share);
    let numbers = of_flights.into_iter().chain(of_belief).map(share);
    [name(row)].into_iter().chain(numbers).chain([error, row.flights.to_string()]).collect()
}

fn cells_after(row: &IntentRow) -> Option<Vec<String>> {
    let after = row.after_change.as_ref()?;
    let ticks = after.median_ticks.map_or("–".into(), |ticks| format!("{ticks:.0}"));
    let (interventions, opposed) = (share(after.interventions), share(after.opposed));
    Some(vec![name(row), share(after.followed), ticks, interventions, opposed, after.flights.to_string()])
}
