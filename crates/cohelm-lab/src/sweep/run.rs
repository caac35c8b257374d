//! One job, from record to record.

use super::job::{Code, Flights, Job, Training, Work, canonical};
use super::{Description, SweepError};
use crate::episode::EpisodeMeasures;
use crate::experiment::{Condition, Experiment, Flown, Rig};
use crate::results::participant_keys;
use cohelm::human::{Person, Population};
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::{Model, Models};
use cohelm_learn::{ValueOptions, evaluate, train_values};
use serde_json::{Map, Value, json};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;

/// Marks the draw that a training's pilots come from, so that no participant of a sweep is among them.
const TRAINING_PILOTS: u64 = 0x7261_696e;

/// What a worker works with.
#[derive(Clone, Copy)]
pub struct Lab<'a> {
    /// The plants there are.
    pub plants: &'a Plants,
    /// The models there are; a job names some of them.
    pub models: &'a Models,
}

impl Lab<'_> {
    /// A simulated person at the keys of a task's plant, or why there is none.
    fn person(&self, task: &Task, plant: &dyn Plant, who: Person) -> Result<Box<dyn Pilot>, String> {
        let entry = self.plants.entry(task).map_err(|error| error.to_string())?;
        let pilot = entry.participant(plant.space(), who).map_err(|error| error.to_string())?;
        Ok(Box::new(pilot))
    }
}

/// What came of a job.
#[derive(Clone, Debug)]
pub struct Done {
    /// The outcome: one line of JSON with the job and what was measured. It says nothing of time or place, so the same job
    /// has the same bytes everywhere.
    pub record: String,
    /// The model, if the job trained one.
    pub model: Option<Model>,
}

/// Runs a job on the thread that asks.
pub fn run_job(job: &Job, lab: &Lab<'_>) -> Result<Done, SweepError> {
    let here = Code::of(&job.work, lab.plants)?;
    if here != job.code {
        return Err(SweepError::Code { planned: job.code.to_string(), here: here.to_string() });
    }
    let (outcome, model) = match &job.work {
        Work::Fly(flights) => (flights.fly(lab)?, None),
        Work::TrainValues(training) => training.train(lab).map(|(outcome, model)| (outcome, Some(model)))?,
    };
    Ok(Done { record: canonical(&json!({ "job": job, "outcome": outcome })) + "\n", model })
}

impl Flights {
    /// The experiment that the job is: one participant, one condition.
    pub(super) fn experiment(&self) -> Experiment {
        Experiment {
            task: self.task.clone(),
            values: self.values.clone(),
            intent: self.intent.clone(),
            seed: self.seed,
            participants: 1,
            episodes: self.episodes,
            conditions: vec![Condition::new(self.rule.word(), self.rule.word(), self.rule, self.head)],
            pilot: format!("simulated {}", self.pilot),
        }
    }

    fn fly(&self, lab: &Lab<'_>) -> Result<Value, SweepError> {
        let person = |plant: &dyn Plant, seed: u64, index: usize| {
            lab.person(&self.task, plant, Person { population: self.pilot, seed, index: index as u64 })
        };
        let rig = Rig { plants: lab.plants, models: lab.models, pilots: &person, threads: 1 };
        let episodes: Vec<Value> = self.experiment().run(&rig)?.iter().map(row).collect();
        Ok(json!({ "episodes": episodes }))
    }
}

/// An episode in a record: its seed, how it ended, and every measure that it has.
fn row(flown: &Flown) -> Value {
    let EpisodeMeasures { ending, .. } = flown.measures;
    let mut row = Map::new();
    row.insert("seed".into(), flown.trajectory.setup.seed.into());
    row.insert("ending".into(), ending.word().into());
    row.extend(participant_keys().map(|key| (key.to_string(), json!(flown.measures.value(key)))));
    row.into()
}

impl Training {
    /// The options of training, or what is wrong with them.
    pub(super) fn options(&self) -> Result<ValueOptions, SweepError> {
        let mut options = serde_json::to_value(ValueOptions::preset(&self.preset)?)?;
        let known =
            options.as_object().map_or(String::new(), |o| o.keys().cloned().collect::<Vec<_>>().join(", "));
        for (name, value) in &self.changes {
            let unknown =
                || Description::wrong("[train]", format!("no option is called {name:?}; there are: {known}"));
            *options.get_mut(name).ok_or_else(unknown)? = value.clone();
        }
        serde_json::from_value(options).map_err(|error| {
            Description::wrong("[train]", format!("an option cannot have this value: {error}"))
        })
    }

    fn train(&self, lab: &Lab<'_>) -> Result<(Value, Model), SweepError> {
        let pilots = |plant: &dyn Plant, number: u64| {
            let population = Population::Ordinary;
            lab.person(&self.task, plant, Person { population, seed: TRAINING_PILOTS, index: number })
        };
        let job = cohelm_learn::Job {
            plants: lab.plants,
            task: &self.task,
            seed: self.seed,
            threads: NonZeroUsize::MIN,
            checkpoints: None,
            name: &self.task.plant,
            variant: Some("sweep"),
        };
        let trained =
            train_values(&job, &self.options()?, Some(&pilots), &mut |_| ControlFlow::Continue(()))?;
        let fresh = evaluate(&job, &trained.model, self.seed, self.episodes)?;
        let outcome =
            json!({ "model": trained.model.hash(), "validation": trained.validation, "fresh": fresh });
        Ok((outcome, trained.model))
    }
}
