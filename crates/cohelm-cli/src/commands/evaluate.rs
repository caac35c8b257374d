//! `cohelm evaluate`: how well the values fly when the goal is known.

use crate::numbers::whole;
use crate::output::{Format, table};
use crate::rig;
use anyhow::{Result, bail};
use clap::Args;
use cohelm_copilot::Kind;
use cohelm_learn::{Job, evaluate};
use serde_json::json;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Flies fresh episodes with the goal known and counts how they end.
#[derive(Args)]
pub struct Evaluate {
    /// The plant.
    #[arg(long, default_value = "flag-lander")]
    task: String,
    /// An option of the plant, NAME=VALUE; may be given again.
    #[arg(long = "option", value_name = "NAME=VALUE")]
    options: Vec<String>,
    /// A value model's file; the shipped one for the task unless given.
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Fresh episodes to fly.
    #[arg(long, default_value_t = 300, value_parser = whole::<usize>)]
    episodes: usize,
    /// Another seed names another set of episodes.
    #[arg(long, default_value_t = 0, value_parser = whole::<u64>)]
    seed: u64,
    /// Threads; 0 for one a core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>)]
    threads: usize,
    #[command(flatten)]
    format: Format,
}

impl Evaluate {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        if self.episodes == 0 {
            bail!("at least one episode is needed");
        }
        let (plants, task) = (rig::plants(), rig::task(&self.task, &self.options)?);
        let plant = plants.make(&task)?;
        let models = rig::models(self.model.as_slice())?;
        let model = match &self.model {
            Some(file) => rig::model(file)?,
            None => rig::model_for(&models, Kind::Values, &task, plant.space())?.clone(),
        };
        let threads = threads(self.threads);
        let job = Job {
            plants: &plants,
            task: &task,
            seed: self.seed,
            threads,
            checkpoints: None,
            name: &model.card().name,
            variant: None,
        };
        let flown = evaluate(&job, &model, self.seed, self.episodes)?;
        let report = json!({ "model": model.card().name, "hash": model.hash(), "seed": self.seed, "evaluation": flown });
        self.format.print(&report, |_| {
            let share = |share: f64| format!("{:.1} %", 100.0 * share);
            let head = ["model", "episodes", "goal", "elsewhere", "crash", "out", "time", "steps", "return"];
            let steps = flown.mean_steps.map_or("–".into(), |steps| format!("{steps:.0}"));
            let row = vec![
                model.card().name.clone(),
                flown.episodes.to_string(),
                share(flown.landed),
                share(flown.elsewhere),
                share(flown.crashed),
                share(flown.out_of_bounds),
                share(flown.timed_out),
                steps,
                format!("{:.2}", flown.mean_return),
            ];
            table(&head, &[row])
        });
        Ok(ExitCode::SUCCESS)
    }
}

/// How many threads a request means: 0 for one a core.
pub fn threads(wanted: usize) -> NonZeroUsize {
    let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    NonZeroUsize::new(wanted).unwrap_or_else(cores)
}
