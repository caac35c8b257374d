//! A job: everything that its outcome depends on, and nothing else.

use super::SweepError;
use cohelm::arbitration::Rule;
use cohelm::human::Population;
use cohelm::intent::Inference;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::model::hash;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::fmt;

/// Names the sources of this program: its build script says of which.
const SOURCES: &str = env!("COHELM_SOURCES");

/// A small record in; its outcome is a small record out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// The code that it is for.
    pub code: Code,
    /// What to do.
    pub work: Work,
}

/// Versions of everything that has a part in the bits of an outcome.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Code {
    /// Version of cohelm.
    pub cohelm: String,
    /// Names the sources that it was built from (hexadecimal): another build of the same version has the same only if
    /// nothing that has a part in a job was changed.
    pub sources: String,
    /// Version of the plant.
    pub plant: u32,
    /// Fingerprint of the control loop's networks.
    pub networks: String,
    /// The arithmetic that the planning machine trains with; for trainings only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kernel: Option<String>,
}

/// What a job does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Work {
    /// One simulated participant flies some episodes under one rule.
    Fly(Flights),
    /// Values are trained from nothing.
    TrainValues(Training),
}

/// One simulated participant's episodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flights {
    /// Plant and options.
    pub task: Task,
    /// Hash of the value model; `None` for a plant that has values of its own.
    pub values: Option<String>,
    /// Hash of the intent model, if a network infers the goal.
    pub intent: Option<String>,
    /// The rule of arbitration.
    pub rule: Rule,
    /// Where the belief about the goal comes from.
    pub head: Inference,
    /// What kind of simulated person flies.
    pub pilot: Population,
    /// Fixes person, terrain, goals and everything else.
    pub seed: u64,
    /// How many.
    pub episodes: usize,
}

/// A training and the fresh flights by which it is judged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Training {
    /// Plant and options.
    pub task: Task,
    /// Which options of training to start from.
    pub preset: String,
    /// Options of training that differ from the preset's.
    pub changes: Map<String, Value>,
    /// Fixes everything random.
    pub seed: u64,
    /// Fresh episodes that the robot alone then flies.
    pub episodes: usize,
}

impl Job {
    /// The job's name: SHA-256 of its JSON with sorted keys. Outcomes are kept under it.
    pub fn hash(&self) -> Result<String, SweepError> {
        Ok(hash(canonical(&serde_json::to_value(self)?).as_bytes()))
    }

    /// The plant and its options.
    pub fn task(&self) -> &Task {
        match &self.work {
            Work::Fly(flights) => &flights.task,
            Work::TrainValues(training) => &training.task,
        }
    }
}

impl Code {
    /// The code of this program, as work on a task sees it.
    pub fn of(work: &Work, plants: &Plants) -> Result<Self, SweepError> {
        let (task, trains) = match work {
            Work::Fly(flights) => (&flights.task, false),
            Work::TrainValues(training) => (&training.task, true),
        };
        Ok(Self {
            cohelm: env!("CARGO_PKG_VERSION").into(),
            sources: SOURCES.into(),
            plant: plants.entry(task)?.version,
            networks: format!("{:016x}", cohelm_nn::fingerprint::EXPECTED),
            kernel: trains.then(cohelm_nn::kernel_name),
        })
    }
}

impl fmt::Display for Code {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cohelm, sources, plant, networks, kernel } = self;
        write!(to, "cohelm {cohelm} (sources {sources}, plant {plant}, networks {networks}")?;
        kernel.iter().try_for_each(|kernel| write!(to, ", trains {kernel}"))?;
        to.write_str(")")
    }
}

/// JSON in one line with sorted keys: equal content has equal text, whatever order a map keeps.
pub(super) fn canonical(value: &Value) -> String {
    match value {
        Value::Object(members) => {
            let mut names: Vec<&String> = members.keys().collect();
            names.sort();
            let member =
                |name: &String| format!("{}:{}", Value::from(name.as_str()), canonical(&members[name]));
            format!("{{{}}}", names.into_iter().map(member).collect::<Vec<_>>().join(","))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(canonical).collect::<Vec<_>>().join(",")),
        other => other.to_string(),
    }
}
