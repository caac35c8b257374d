//! `cohelm train`: a co-pilot from nothing, values first, then intent.

use super::evaluate::threads;
use crate::output::{Format, table};
use crate::rig;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use cohelm::human::Population;
use cohelm::plant::Plant;
use cohelm::registry::Task;
use cohelm_copilot::Model;
use cohelm_learn::{IntentOptions, Job, Profile, Progress, TrainedIntent, TrainedValues, ValueOptions};
use cohelm_learn::{train_intent, train_values};
use indicatif::{ProgressBar, ProgressStyle};
use serde::de::DeserializeOwned;
use serde_json::json;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Trains a co-pilot: values by double DQN, then intent from flights with simulated pilots.
#[derive(Args)]
pub struct Train {
    /// What to train; values and then intent unless given.
    what: Option<What>,
    /// The plant.
    #[arg(long, default_value = "flag-lander")]
    task: String,
    /// An option of the plant, NAME=VALUE; may be given again.
    #[arg(long = "option", value_name = "NAME=VALUE")]
    options: Vec<String>,
    /// Options of value training to begin with.
    #[arg(long, value_enum, default_value_t = Preset::Default)]
    preset: Preset,
    /// Changes an option of value training, NAME=JSON; may be given again.
    #[arg(long = "values", value_name = "NAME=JSON")]
    value_options: Vec<String>,
    /// Changes an option of intent training, NAME=JSON; may be given again.
    #[arg(long = "intent", value_name = "NAME=JSON")]
    intent_options: Vec<String>,
    /// The value model to train intent for; the one just trained, or the shipped one, unless given.
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Fixes everything random: the same seed gives the same weights on one kind of CPU.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads, which change nothing but the time; 0 for one a core.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// What the model is called; after the task unless given.
    #[arg(long)]
    name: Option<String>,
    /// Where models and cards are written, and checkpoints while training runs.
    #[arg(long, default_value = "trained", value_name = "FOLDER")]
    out: PathBuf,
    /// Say where the time went.
    #[arg(long)]
    profile: bool,
    #[command(flatten)]
    format: Format,
}

/// What to train.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// What every action is worth.
    Values,
    /// Which goal the pilot wants.
    Intent,
}

/// Where the options of value training begin.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Preset {
    /// What it needed to land.
    Default,
    /// Algorithm 1 as printed, repaired only where it must be.
    Paper,
}

impl Train {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        let task = rig::task(&self.task, &self.options)?;
        let plants = rig::plants();
        let plant = plants.make(&task)?;
        let name = self.name.clone().unwrap_or_else(|| usual_name(&task));
        let variant = (self.preset == Preset::Paper).then_some("paper");
        let job = Job {
            plants: &plants,
            task: &task,
            seed: self.seed,
            threads: threads(self.threads),
            checkpoints: Some(&self.out),
            name: &name,
            variant,
        };
        std::fs::create_dir_all(&self.out)
            .with_context(|| format!("cannot make the folder {}", self.out.display()))?;
        let values = match self.what {
            Some(What::Intent) => None,
            _ => Some(self.values(&job)?),
        };
        let wants_intent = self.what != Some(What::Values) && plant.view().goals.len() > 1;
        let intent = if wants_intent {
            Some(self.intent(&job, values.as_ref().map(|trained| &trained.model))?)
        } else {
            None
        };
        self.report(values.as_ref(), intent.as_ref());
        Ok(ExitCode::SUCCESS)
    }
}

impl Train {
    fn values(&self, job: &Job<'_>) -> Result<TrainedValues> {
        let preset = match self.preset {
            Preset::Default => ValueOptions::default(),
            Preset::Paper => ValueOptions::paper(),
        };
        let options: ValueOptions = changed(&preset, &self.value_options)?;
        let bar = self.bar();
        let trained = train_values(job, &options, Some(&pilots), &mut |progress| show(&bar, progress))?;
        bar.finish_and_clear();
        self.write(&trained.model)?;
        Ok(trained)
    }

    fn intent(&self, job: &Job<'_>, trained: Option<&Model>) -> Result<TrainedIntent> {
        let options: IntentOptions = changed(&IntentOptions::default(), &self.intent_options)?;
        let values = match (&self.model, trained) {
            (Some(file), _) => rig::model(file)?,
            (None, Some(model)) => model.clone(),
            (None, None) => {
                let models = rig::models(&[])?;
                let plant = job.plant()?;
                rig::model_for(&models, cohelm_copilot::Kind::Values, job.task, plant.space())?.clone()
            }
        };
        let bar = self.bar();
        let trained = train_intent(job, &values, &options, &pilots, &mut |progress| show(&bar, progress))?;
        bar.finish_and_clear();
        self.write(&trained.model)?;
        Ok(trained)
    }

    fn bar(&self) -> ProgressBar {
        if !self.format.shows_progress() {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::new(1);
        let style = ProgressStyle::with_template("{prefix:28} {wide_bar} {percent:>3} %  {msg}");
        bar.set_style(style.expect("the template is fixed"));
        bar
    }

    fn write(&self, model: &Model) -> Result<()> {
        let card = model.card();
        let stem = format!("{}.{}", card.name, card.kind.word());
        write_whole(&self.out.join(format!("{stem}.safetensors")), model.bytes())?;
        let text = serde_json::to_string_pretty(card)? + "\n";
        write_whole(&self.out.join(format!("{stem}.card.json")), text.as_bytes())
    }

    fn report(&self, values: Option<&TrainedValues>, intent: Option<&TrainedIntent>) {
        let report = json!({
            "folder": self.out,
            "values": values.map(|trained| json!({
                "hash": trained.model.hash(), "card": trained.model.card(), "validation": trained.validation,
                "profile": trained.profile,
            })),
            "intent": intent.map(|trained| json!({
                "hash": trained.model.hash(), "scores": trained.scores, "closed_loop": trained.closed_loop,
                "profile": trained.profile,
            })),
        });
        self.format.print(&report, |_| {
            let mut parts = Vec::new();
            parts.extend(values.map(|trained| values_text(trained, self.profile)));
            parts.extend(intent.map(|trained| intent_text(trained, self.profile)));
            parts.push(format!("written to {}", self.out.display()));
            parts.join("\n\n")
        });
    }
}

/// Simulated people to learn from: ordinary ones, of another draw than any participant.
fn pilots(plant: &dyn Plant, number: u64) -> Result<Box<dyn cohelm::pilot::Pilot>, String> {
    rig::simulated_person(plant, Population::Ordinary, rig::TRAINING_PILOTS, number)
}

/// What a model for a task is called: the plant, and its actions if it has several sets.
fn usual_name(task: &Task) -> String {
    match task.options.get("actions").and_then(|actions| actions.as_str()) {
        Some(actions) => format!("{}-{actions}", task.plant),
        None if task.plant == "flag-lander" => "flag-lander-switches".into(),
        None => task.plant.clone(),
    }
}

/// Options with some of them changed, each NAME=JSON.
fn changed<Options: serde::Serialize + DeserializeOwned>(
    preset: &Options,
    changes: &[String],
) -> Result<Options> {
    let mut options = serde_json::to_value(preset)?;
    for change in changes {
        let Some((name, value)) = change.split_once('=') else {
            bail!("an option is written NAME=JSON, got {change:?}");
        };
        let known =
            options.as_object().map_or(String::new(), |o| o.keys().cloned().collect::<Vec<_>>().join(", "));
        let slot = options
            .get_mut(name)
            .with_context(|| format!("no option is called {name:?}; there are: {known}"))?;
        *slot = serde_json::from_str(value)
            .with_context(|| format!("the value of {name} is no JSON: {value:?}"))?;
    }
    serde_json::from_value(options).context("an option has a value that it cannot have")
}

/// Shows progress; training is never stopped from here.
fn show(bar: &ProgressBar, progress: &Progress) -> ControlFlow<()> {
    let numbers = progress.numbers.iter().map(|(name, value)| format!("{name} {value:.3}"));
    bar.set_prefix(progress.stage.clone());
    bar.set_length(progress.total);
    bar.set_position(progress.done);
    bar.set_message(numbers.collect::<Vec<_>>().join(", "));
    ControlFlow::Continue(())
}

/// Writes a file all at once: after a kill at any moment it is the old one or the new one.
fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let beside = path.with_extension("part");
    std::fs::write(&beside, bytes).with_context(|| format!("cannot write {}", beside.display()))?;
    std::fs::rename(&beside, path).with_context(|| format!("cannot write {}", path.display()))
}

fn values_text(trained: &TrainedValues, profile: bool) -> String {
    let card = trained.model.card();
    let range = card.median_range.unwrap_or(f64::NAN);
    let landed = 100.0 * trained.validation.landed;
    let seconds = trained.profile.wall.as_secs_f64();
    let summary = format!(
        "values of {}: {landed:.1} % of {} validation episodes ended at the goal; median range of Q {range:.3}; {seconds:.1} s",
        card.name, trained.validation.episodes
    );
    if profile { format!("{summary}\n{}", profile_text(&trained.profile)) } else { summary }
}

fn profile_text(profile: &Profile) -> String {
    let parts = [
        ("collecting", profile.collect),
        ("updates", profile.learn),
        ("  preparing batches", profile.prepare),
        ("  training", profile.train),
        ("validating", profile.validate),
        ("saving", profile.save),
        ("resuming", profile.resume),
    ];
    let rows: Vec<Vec<String>> = parts
        .iter()
        .map(|(name, time)| vec![name.to_string(), format!("{:.2}", time.as_secs_f64())])
        .collect();
    table(&["where the time went", "s"], &rows)
}

fn intent_text(trained: &TrainedIntent, profile: bool) -> String {
    let number = |value: f64| format!("{value:.3}");
    let mut rows = Vec::new();
    for head in &trained.scores {
        for score in head.by_time.iter().chain([&head.all]) {
            let whole = std::ptr::eq(score, &head.all);
            let span = match score.to {
                _ if whole => "all".into(),
                Some(to) => format!("{}–{to}", score.from),
                None => format!("{}–", score.from),
            };
            let numbers = [score.accuracy, score.confidence, score.calibration_error].map(number);
            rows.push(
                [vec![head.head.word().into(), span, score.ticks.to_string()], numbers.to_vec()].concat(),
            );
        }
    }
    let by_time =
        table(&["intent: head", "ticks since start", "n", "accuracy", "mean c", "calibration error"], &rows);
    let rows: Vec<Vec<String>> = trained
        .closed_loop
        .iter()
        .map(|flown| {
            let numbers = [flown.landed, flown.elsewhere, flown.right_midway, flown.right_at_end].map(number);
            [vec![flown.head.word().into(), flown.episodes.to_string()], numbers.to_vec()].concat()
        })
        .collect();
    let head = ["in the loop, new pilots: head", "n", "goal", "elsewhere", "right midway", "right at end"];
    let time = trained.profile.wall.as_secs_f64();
    let summary = format!("{by_time}\n\n{}\n\nintent took {time:.1} s", table(&head, &rows));
    let parts =
        [trained.profile.fly, trained.profile.fit, trained.profile.score].map(|part| part.as_secs_f64());
    let [fly, fit, score] = parts;
    if profile {
        format!("{summary}: flying {fly:.1}, fitting {fit:.1}, scoring {score:.1}")
    } else {
        summary
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_change_by_name_and_unknown_names_list_the_known() {
        let options = changed(&ValueOptions::default(), &["steps=1000".into()]).unwrap();
        assert_eq!(options.steps, 1000);
        let error = changed(&ValueOptions::default(), &["stepz=1".into()]).unwrap_err();
        assert!(error.to_string().contains("stepz") && error.to_string().contains("steps"), "{error}");
        assert!(changed(&ValueOptions::default(), &["steps=many".into()]).is_err());
    }

    #[test]
    fn models_are_named_after_plant_and_actions() {
        assert_eq!(usual_name(&Task::new("flag-lander")), "flag-lander-switches");
        assert_eq!(
            usual_name(&Task::new("flag-lander").with("actions", "main-side")),
            "flag-lander-main-side"
        );
        assert_eq!(usual_name(&Task::new("gymnasium-lander")), "gymnasium-lander");
    }
}
