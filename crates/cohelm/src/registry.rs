//! Plants by name. Whoever puts a program together registers them; nobody else names one.

use crate::action::ActionSpace;
use crate::human::{HumanPilot, MakeSkill, ParticipantError, Person, participant};
use crate::plant::Plant;
use crate::value::ValueModel;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Which plant, with which options: what a record, a study file or a command line says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// The plant's name.
    pub plant: String,
    /// The plant's own options; an object. Options left out have the plant's defaults.
    #[serde(default = "no_options")]
    pub options: Value,
}

fn no_options() -> Value {
    Value::Object(serde_json::Map::new())
}

impl Task {
    /// A plant with its default options.
    pub fn new(plant: &str) -> Self {
        Self { plant: plant.into(), options: no_options() }
    }

    /// The same with one option set.
    pub fn with(mut self, option: &str, value: impl Into<Value>) -> Self {
        if let Value::Object(options) = &mut self.options {
            options.insert(option.into(), value.into());
        }
        self
    }
}

/// How to make a plant.
#[derive(Clone)]
pub struct PlantEntry {
    /// Its name.
    pub name: &'static str,
    /// Changes whenever equal seeds and actions no longer give equal bits.
    pub version: u32,
    /// One sentence.
    pub summary: &'static str,
    /// Makes one from its options, or says what is wrong with them.
    pub make: fn(&Value) -> Result<Box<dyn Plant>, String>,
    /// Hand-made values, for a plant that needs no training.
    pub values: Option<fn() -> Box<dyn ValueModel>>,
    /// What a person who has practised tries to do at its keys; `None` where there are no simulated people.
    pub skill: Option<MakeSkill>,
    /// The sets of actions to offer where people choose, the usual one first; empty if there is only one.
    pub actions: &'static [OfferedActions],
    /// Name of the preset of value training that suits its rewards: `default` where a good episode is worth about 1 to 3.
    pub preset: &'static str,
}

/// A set of actions that a plant can be steered with: options of the plant, and what people call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OfferedActions {
    /// A short word, which names the set in addresses and in the names of models.
    pub name: &'static str,
    /// What people read.
    pub label: &'static str,
    /// The option of the plant that chooses the set.
    pub option: &'static str,
    /// The option's value: JSON, or else the text itself.
    pub value: &'static str,
}

impl OfferedActions {
    /// A set that is chosen by its name with the plant's option `actions`.
    pub const fn named(name: &'static str, label: &'static str) -> Self {
        Self { name, label, option: "actions", value: name }
    }

    /// The options that choose the set: an object.
    pub fn options(&self) -> Value {
        let value = serde_json::from_str(self.value).unwrap_or_else(|_| self.value.into());
        Value::Object([(self.option.to_string(), value)].into_iter().collect())
    }
}

impl PlantEntry {
    /// A simulated person who steers it with these actions.
    pub fn participant(&self, space: &ActionSpace, who: Person) -> Result<HumanPilot, ParticipantError> {
        let skill = self.skill.ok_or(ParticipantError::NoSkill { plant: self.name })?;
        participant(skill, space, who)
    }
}

/// The plants a program knows.
#[derive(Clone, Default)]
pub struct Plants {
    entries: Vec<PlantEntry>,
}

/// Why there is no such plant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TaskError {
    /// No plant of that name.
    #[error("no plant is called {name:?}; there are: {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// Its options are wrong.
    #[error("the options of plant {plant:?} are wrong: {reason}")]
    Options {
        /// Which plant.
        plant: String,
        /// What is wrong.
        reason: String,
    },
}

impl Plants {
    /// Adds a plant; a later one of the same name replaces the earlier.
    pub fn register(&mut self, entry: PlantEntry) {
        self.entries.retain(|known| known.name != entry.name);
        self.entries.push(entry);
    }

    /// All of them, in the order of registration.
    pub fn entries(&self) -> &[PlantEntry] {
        &self.entries
    }

    /// The entry of a task's plant.
    pub fn entry(&self, task: &Task) -> Result<&PlantEntry, TaskError> {
        self.entries.iter().find(|entry| entry.name == task.plant).ok_or_else(|| TaskError::Unknown {
            name: task.plant.clone(),
            known: self.entries.iter().map(|entry| entry.name).collect::<Vec<_>>().join(", "),
        })
    }

    /// The plant of a task.
    pub fn make(&self, task: &Task) -> Result<Box<dyn Plant>, TaskError> {
        (self.entry(task)?.make)(&task.options)
            .map_err(|reason| TaskError::Options { plant: task.plant.clone(), reason })
    }
}
