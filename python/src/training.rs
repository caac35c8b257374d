//! Training and the paper's experiment, run from Python. Ctrl-C stops a training between two rounds.

use crate::errors::Kind;
use crate::models::{IntentModel, ValueModel};
use crate::world::plants;
use cohelm::human::{Person, Population};
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::{Kind as ModelKind, shipped};
use cohelm_lab::experiment::{Experiment, Rig};
use cohelm_lab::reproduce::conditions;
use cohelm_lab::results::{Results, participant_keys};
use cohelm_learn::{IntentOptions, Job, Progress, ValueOptions};
use pyo3::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// The draw of pilots that intent learns from; no participant of an experiment comes from it.
const TRAINING_PILOTS: u64 = 0x7261_696e;

/// A job as Python describes it, in JSON: plant, options of the plant, seed, threads, name, and what is to differ from the
/// preset.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Order {
    plant: String,
    #[serde(default)]
    options: Map<String, Value>,
    #[serde(default)]
    preset: Option<String>,
    #[serde(default)]
    changes: Map<String, Value>,
    #[serde(default)]
    seed: u64,
    #[serde(default)]
    threads: usize,
    name: String,
    #[serde(default)]
    checkpoints: Option<PathBuf>,
}

/// Trains values from nothing; gives the model and its evaluation as JSON.
#[pyfunction]
#[pyo3(signature = (order_json, progress=None))]
pub fn train_values(
    py: Python<'_>,
    order_json: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<(ValueModel, String)> {
    let order = order(order_json)?;
    let (plants, task) = (plants(), order.task());
    let space = plants.make(&task).map_err(|error| Kind::Option.error(error))?.space().clone();
    let entry = plants.entry(&task).map_err(|error| Kind::Option.error(error))?;
    let preset = order.preset.as_deref().unwrap_or_else(|| ValueOptions::usual_preset(entry, &space));
    let usual = ValueOptions::preset(preset).map_err(|error| Kind::Option.error(error))?;
    let options: ValueOptions = changed(&usual, &order.changes)?;
    let trained = with_watch(py, progress, |watch| {
        let job = order.job(&plants, &task, ValueOptions::variant(preset, entry));
        let pilots = |plant: &dyn Plant, number: u64| pilot(&plants, &task, plant, number);
        cohelm_learn::train_values(&job, &options, Some(&pilots), watch)
    })?;
    let report = json!({ "validation": trained.validation, "profile": trained.profile });
    Ok((ValueModel::of(trained.model), report.to_string()))
}

/// Trains intent for a value model; gives the model and its scores as JSON.
#[pyfunction]
#[pyo3(signature = (order_json, values, progress=None))]
pub fn train_intent(
    py: Python<'_>,
    order_json: &str,
    values: &ValueModel,
    progress: Option<Py<PyAny>>,
) -> PyResult<(IntentModel, String)> {
    let order = order(order_json)?;
    let options: IntentOptions = changed(&IntentOptions::default(), &order.changes)?;
    let of_ours = || {
        Kind::Model.error("intent is trained for a value model of ours, which flies the training's flights")
    };
    let values = values.trained().ok_or_else(of_ours)?.clone();
    let trained = with_watch(py, progress, |watch| {
        let (plants, task) = (plants(), order.task());
        let pilots = |plant: &dyn Plant, number: u64| pilot(&plants, &task, plant, number);
        cohelm_learn::train_intent(&order.job(&plants, &task, None), &values, &options, &pilots, watch)
    })?;
    let report = json!({ "scores": trained.scores, "closed_loop": trained.closed_loop });
    Ok((IntentModel { model: trained.model }, report.to_string()))
}

/// The paper's experiment with simulated pilots: JSON of one row a participant and condition.
#[pyfunction]
#[pyo3(signature = (*, seed=1, participants=10, episodes=40, population="ordinary", actions="switches", threads=0))]
pub fn reproduce(
    py: Python<'_>,
    seed: u64,
    participants: usize,
    episodes: usize,
    population: &str,
    actions: &str,
    threads: usize,
) -> PyResult<String> {
    if participants == 0 || episodes == 0 {
        return Err(Kind::Option.error("an experiment needs at least one participant and one episode"));
    }
    let population: Population = population.parse().map_err(|error| Kind::Option.error(error))?;
    let task = Task::new("flag-lander").with("actions", actions);
    let plants = plants();
    let space = plants.make(&task).map_err(|error| Kind::Option.error(error))?.space().clone();
    let (models, _) = shipped::models();
    let usual = |kind| {
        let model = models.newest_for(kind, &task, &space);
        model
            .map(|model| model.hash().to_string())
            .ok_or_else(|| Kind::Model.error("no shipped model has these actions"))
    };
    let experiment = Experiment {
        values: Some(usual(ModelKind::Values)?),
        intent: Some(usual(ModelKind::Intent)?),
        task: task.clone(),
        seed,
        participants,
        episodes,
        conditions: conditions(),
        pilot: format!("simulated {population}"),
    };
    let rows = py.detach(|| {
        let people = |plant: &dyn Plant, seed: u64, index: usize| {
            person(&plants, &task, plant, Person { population, seed, index: index as u64 })
        };
        let rig = Rig { plants: &plants, models: &models, pilots: &people, threads };
        let flown = experiment.run(&rig)?;
        let results = Results { conditions: &experiment.conditions, participants, flown: &flown };
        Ok::<_, cohelm_lab::experiment::ExperimentError>(rows_of(&results))
    });
    rows.map(|rows| Value::from(rows).to_string()).map_err(|error| Kind::Run.error(error))
}

fn rows_of(results: &Results<'_>) -> Vec<Value> {
    let mut rows = Vec::new();
    for participant in 0..results.participants {
        for (index, condition) in results.conditions.iter().enumerate() {
            let mut row = Map::new();
            row.insert("participant".into(), Results::name_of(participant).into());
            row.insert("condition".into(), condition.name.clone().into());
            for key in participant_keys() {
                row.insert(key.into(), json!(results.participant_mean(key, participant, index)));
            }
            rows.push(row.into());
        }
    }
    rows
}

impl Order {
    fn task(&self) -> Task {
        Task { plant: self.plant.clone(), options: Value::Object(self.options.clone()) }
    }

    fn job<'a>(
        &'a self,
        plants: &'a cohelm::registry::Plants,
        task: &'a Task,
        variant: Option<&'a str>,
    ) -> Job<'a> {
        let cores = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        Job {
            plants,
            task,
            seed: self.seed,
            threads: NonZeroUsize::new(self.threads).unwrap_or(cores),
            checkpoints: self.checkpoints.as_deref(),
            name: &self.name,
            variant,
        }
    }
}

fn order(json: &str) -> PyResult<Order> {
    serde_json::from_str(json).map_err(|error| Kind::Option.error(error))
}

/// A preset with some options changed; an unknown one is refused.
fn changed<Options: Serialize + DeserializeOwned>(
    preset: &Options,
    changes: &Map<String, Value>,
) -> PyResult<Options> {
    let mut options = serde_json::to_value(preset).map_err(|error| Kind::Option.error(error))?;
    let known =
        options.as_object().map_or(String::new(), |o| o.keys().cloned().collect::<Vec<_>>().join(", "));
    for (name, value) in changes {
        let unknown = || Kind::Option.error(format!("no option is called {name:?}; there are: {known}"));
        *options.get_mut(name).ok_or_else(unknown)? = value.clone();
    }
    serde_json::from_value(options)
        .map_err(|error| Kind::Option.error(format!("an option cannot have this value: {error}")))
}

/// Lets training run without Python's lock; in between Python sees progress, and Ctrl-C.
fn with_watch<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    train: impl FnOnce(&mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<T, cohelm_learn::LearnError> + Send,
) -> PyResult<T> {
    let mut raised: Option<PyErr> = None;
    let trained = py.detach(|| {
        train(&mut |at: &Progress| {
            let told = Python::attach(|py| {
                py.check_signals()?;
                progress
                    .as_ref()
                    .map_or(Ok(()), |tell| tell.call1(py, (&at.stage, at.done, at.total)).map(drop))
            });
            match told {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    raised = Some(error);
                    ControlFlow::Break(())
                }
            }
        })
    });
    match (raised, trained) {
        (Some(error), _) => Err(error),
        (None, trained) => trained.map_err(|error| Kind::Run.error(error)),
    }
}

/// Participant `index` of those that learning meets.
fn pilot(plants: &Plants, task: &Task, plant: &dyn Plant, index: u64) -> Result<Box<dyn Pilot>, String> {
    person(plants, task, plant, Person { population: Population::Ordinary, seed: TRAINING_PILOTS, index })
}

/// A simulated person at the keys of a task's plant.
pub fn person(
    plants: &Plants,
    task: &Task,
    plant: &dyn Plant,
    who: Person,
) -> Result<Box<dyn Pilot>, String> {
    let entry = plants.entry(task).map_err(|error| error.to_string())?;
    let pilot = entry.participant(plant.space(), who).map_err(|error| error.to_string())?;
    Ok(Box::new(pilot))
}
