//! `cohelm train`: a co-pilot from nothing, values first, then intent.

mod flown;

use self::flown::Flown;
use super::evaluate::threads;
use crate::numbers::whole;
use crate::output::{Format, in_folder, table};
use crate::rig;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use cohelm::action::ActionSpace;
use cohelm::human::{Person, Population};
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::{PlantEntry, Plants, Task};
use cohelm_copilot::Model;
use cohelm_learn::ship::{Recipe, Yard, ship, write_model};
use cohelm_learn::{
    IntentOfPeople, IntentOptions, Job, Profile, Progress, RecordedFlight, TrainedIntent, TrainedValues,
    ValueOptions, train_intent, train_intent_from, train_values,
};
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
    /// Options of value training to begin with: default, axes (the usual one for actions on axes), paper, sees-asked or
    /// gymnasium (the usual one for gymnasium-lander).
    #[arg(long)]
    preset: Option<String>,
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
    #[arg(long, default_value_t = 0, value_parser = whole::<u64>)]
    seed: u64,
    /// Threads, which change nothing but the time; 0 for one a core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>)]
    threads: usize,
    /// What the model is called; after the task unless given.
    #[arg(long)]
    name: Option<String>,
    /// Where models and cards are written, and checkpoints while training runs.
    #[arg(long, default_value = "trained", value_name = "FOLDER")]
    out: PathBuf,
    /// Train intent on the flights of people: databases of flights, each one participant, or archives of studies, each
    /// with its participants. Every fifth participant is held out.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    from: Vec<PathBuf>,
    /// Make all shipped models again, as the recipes in this file say.
    #[arg(long, value_name = "RECIPES", num_args = 0..=1, default_missing_value = "models/recipes.json")]
    ship: Option<PathBuf>,
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

impl Train {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        if let Some(recipes) = &self.ship {
            return self.ship(recipes);
        }
        let task = rig::task(&self.task, &self.options)?;
        let plants = rig::plants();
        let (plant, entry) = (plants.make(&task)?, plants.entry(&task)?);
        let name = self.name.clone().unwrap_or_else(|| usual_name(&task, entry));
        let preset = self.preset_name(entry, plant.space());
        let variant = ValueOptions::variant(preset, entry);
        let job = Job {
            plants: &plants,
            task: &task,
            seed: self.seed,
            threads: threads(self.threads),
            checkpoints: Some(&self.out),
            name: &name,
            variant,
        };
        in_folder(&self.out, || self.train(&job))
    }

    fn train(&self, job: &Job<'_>) -> Result<ExitCode> {
        if !self.from.is_empty() {
            return self.intent_of_people(job);
        }
        let plant = job.plant()?;
        let values = match self.what {
            Some(What::Intent) => None,
            _ => Some(self.values(job)?),
        };
        let wants_intent = self.what != Some(What::Values) && plant.view().goals.len() > 1;
        let intent = if wants_intent {
            Some(self.intent(job, values.as_ref().map(|trained| &trained.model))?)
        } else {
            None
        };
        self.report(values.as_ref(), intent.as_ref());
        Ok(ExitCode::SUCCESS)
    }
}

impl Train {
    fn values(&self, job: &Job<'_>) -> Result<TrainedValues> {
        let preset =
            ValueOptions::preset(self.preset_name(job.plants.entry(job.task)?, job.plant()?.space()))?;
        let options: ValueOptions = changed(&preset, &self.value_options)?;
        let bar = self.bar();
        if self.format.shows_progress() {
            eprintln!(
                "checkpoints lie in {}: after Ctrl-C the same command goes on from there",
                self.out.display()
            );
        }
        let pilots = |plant: &dyn Plant, number: u64| pilots(job.plants, job.task, plant, number);
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
        let pilots = |plant: &dyn Plant, number: u64| pilots(job.plants, job.task, plant, number);
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
        Ok(write_model(&self.out.join(format!("{}.{}.safetensors", card.name, card.kind.word())), model)?)
    }

    fn preset_name<'a>(&'a self, entry: &'a PlantEntry, space: &ActionSpace) -> &'a str {
        self.preset.as_deref().unwrap_or_else(|| ValueOptions::usual_preset(entry, space))
    }

    /// Makes the models of all recipes, beside the file that holds them.
    fn ship(&self, recipes: &Path) -> Result<ExitCode> {
        let text =
            std::fs::read_to_string(recipes).with_context(|| format!("cannot read {}", recipes.display()))?;
        let recipes_of: Vec<Recipe> =
            serde_json::from_str(&text).with_context(|| format!("{} holds no recipes", recipes.display()))?;
        let folder = recipes.parent().unwrap_or(Path::new("."));
        let plants = rig::plants();
        let pilots = |task: &Task, plant: &dyn Plant, number: u64| pilots(&plants, task, plant, number);
        let yard = Yard { plants: &plants, pilots: &pilots, threads: threads(self.threads), folder };
        let bar = self.bar();
        let mut made = Vec::new();
        for recipe in &recipes_of {
            for shipped in ship(&yard, recipe, &mut |progress| show(&bar, progress))? {
                let landed = shipped.fresh.as_ref().map(|fresh| fresh.landed);
                bar.println(format!(
                    "{} {}",
                    shipped.path.display(),
                    landed.map_or(String::new(), |l| format!("{l:.3}"))
                ));
                made.push(
                    json!({ "file": shipped.path, "hash": shipped.model.hash(), "fresh": shipped.fresh }),
                );
            }
        }
        bar.finish_and_clear();
        self.format.print(&made, |made| {
            let rows: Vec<Vec<String>> = made
                .iter()
                .map(|made| {
                    let landed = made["fresh"]["landed"].as_f64();
                    let file = made["file"].as_str().unwrap_or("").to_string();
                    vec![file, landed.map_or("–".into(), |landed| format!("{:.1} %", 100.0 * landed))]
                })
                .collect();
            table(&["model", "goal reached, 300 fresh episodes"], &rows)
        });
        Ok(ExitCode::SUCCESS)
    }

    /// Trains intent on flights of people, one database a participant.
    fn intent_of_people(&self, job: &Job<'_>) -> Result<ExitCode> {
        let options: IntentOptions = changed(&IntentOptions::default(), &self.intent_options)?;
        let flown = Flown::read(&self.from, job.task)?;
        let flights = &flown.flights;
        if flights.is_empty() {
            let files: Vec<String> = self.from.iter().map(|file| file.display().to_string()).collect();
            let left_out = flown.left_out_text();
            bail!(
                "there is no finished flight of a person on {} in {} to learn from (of a study, give the archive that \
                 `cohelm study export` writes){}{left_out}",
                job.task.plant,
                files.join(", "),
                if left_out.is_empty() { "" } else { "; " }
            );
        }
        let recorded: Vec<RecordedFlight<'_>> = flights
            .iter()
            .map(|(participant, trajectory)| RecordedFlight { participant, trajectory })
            .collect();
        let models = rig::models(self.model.as_slice())?;
        let plant = job.plant()?;
        let begin_with = models.newest_for(cohelm_copilot::Kind::Intent, job.task, plant.space());
        let bar = self.bar();
        let trained =
            train_intent_from(job, &recorded, &options, begin_with, &mut |progress| show(&bar, progress))?;
        bar.finish_and_clear();
        self.write(&trained.model)?;
        let report = json!({
            "flights": flights.len(), "left_out": flown.left_out(), "learnt_from": trained.learnt_from, "held_out": trained.held_out,
            "scores": trained.scores, "before": trained.before, "hash": trained.model.hash(),
        });
        self.format.print(&report, |_| {
            let left_out = flown.left_out_text();
            let learnt = people_text(&trained);
            if left_out.is_empty() { learnt } else { format!("{learnt}\n\n{left_out}") }
        });
        Ok(ExitCode::SUCCESS)
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
fn pilots(plants: &Plants, task: &Task, plant: &dyn Plant, number: u64) -> Result<Box<dyn Pilot>, String> {
    let who = Person { population: Population::Ordinary, seed: rig::TRAINING_PILOTS, index: number };
    rig::simulated_person(plants, task, plant, who)
}

/// What a model for a task is called: the plant, and its actions if it has several sets.
fn usual_name(task: &Task, entry: &PlantEntry) -> String {
    let usual = entry.actions.iter().find(|set| set.option == "actions").map(|set| set.name);
    let chosen = task.options.get("actions").and_then(|actions| actions.as_str());
    chosen.or(usual).map_or_else(|| task.plant.clone(), |actions| format!("{}-{actions}", task.plant))
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

fn people_text(trained: &IntentOfPeople) -> String {
    let number = |value: f64| format!("{value:.3}");
    let rows = |scores: &[cohelm_learn::HeadScores], when: &str| -> Vec<Vec<String>> {
        let row = |head: &cohelm_learn::HeadScores| {
            let all = &head.all;
            let numbers = [all.accuracy, all.confidence, all.calibration_error].map(number);
            [vec![head.head.word().into(), when.to_string(), all.ticks.to_string()], numbers.to_vec()]
                .concat()
        };
        scores.iter().map(row).collect()
    };
    let mut all = trained.before.as_deref().map_or(Vec::new(), |before| rows(before, "before"));
    all.extend(rows(&trained.scores, "after"));
    let head = ["held-out participants: head", "", "n", "accuracy", "mean c", "calibration error"];
    let (learnt, held) = (trained.learnt_from.len(), trained.held_out.len());
    let participants = if learnt == 1 { "participant" } else { "participants" };
    format!("learnt from {learnt} {participants}, scored on {held}\n\n{}", table(&head, &all))
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
        let plants = rig::plants();
        let name = |task: Task| usual_name(&task, plants.entry(&task).unwrap());
        assert_eq!(name(Task::new("flag-lander")), "flag-lander-switches");
        assert_eq!(name(Task::new("flag-lander").with("actions", "main-side")), "flag-lander-main-side");
        assert_eq!(name(Task::new("gymnasium-lander")), "gymnasium-lander");
    }
}
