//! What finished, as tables.

use super::SweepError;
use super::description::Planned;
use super::folder::{Folder, Ran};
use super::job::Work;
use crate::results::participant_keys;
use cohelm_study::csv::{Cell, Csv};
use cohelm_study::measures::{self, OF_A_PARTICIPANT, OF_AN_EPISODE};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// A job that finished.
#[derive(Clone, Debug)]
pub struct Finished {
    /// Its place in the sweep.
    pub planned: Planned,
    /// Its outcome.
    pub outcome: Value,
    /// Where it ran.
    pub ran: Option<Ran>,
}

/// Measures of a training's fresh flights, on which the robot flies alone and is told the goal: key and meaning.
pub(super) const OF_A_TRAINING: [(&str, &str); 7] = [
    ("landed", "Share of fresh episodes that ended at the goal."),
    ("crashed", "Share of fresh episodes that ended in a crash."),
    ("elsewhere", "Share of fresh episodes that ended elsewhere."),
    ("out_of_bounds", "Share of fresh episodes that left the space."),
    ("timed_out", "Share of fresh episodes that ran out of time."),
    ("mean_steps", "Mean steps of fresh episodes that ended at the goal."),
    ("mean_return", "Mean sum of rewards of fresh episodes."),
];

impl Finished {
    /// Those of the planned jobs that have finished, in the order of the plan.
    pub fn all(folder: &Folder) -> Result<Vec<Self>, SweepError> {
        let mut all = Vec::new();
        for planned in folder.planned()? {
            if let Some(outcome) = folder.outcome(&planned.hash)? {
                let ran = folder.ran(&planned.hash);
                all.push(Self { planned, outcome, ran });
            }
        }
        if all.is_empty() { Err(SweepError::Nothing) } else { Ok(all) }
    }

    /// Whether it flew; otherwise it trained.
    pub fn flew(&self) -> bool {
        matches!(self.planned.job.work, Work::Fly(_))
    }

    /// The episodes of a job that flew.
    pub fn episodes(&self) -> &[Value] {
        self.outcome["episodes"].as_array().map_or(&[], Vec::as_slice)
    }

    /// The job's number for a measure: the mean over its episodes that have one, or the training's.
    pub fn value(&self, key: &str) -> Option<f64> {
        if !self.flew() {
            return self.outcome["fresh"][key].as_f64();
        }
        let values: Vec<f64> = self.episodes().iter().filter_map(|episode| episode[key].as_f64()).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}

/// A row a job: its place in the grid, its models, and its measures.
pub fn by_job(finished: &[Finished]) -> Csv {
    let axes = axes(finished);
    let measures = measures(finished);
    let identity = ["job", "kind", "condition", "stratum"];
    let names = axes.iter().map(String::as_str).chain(["episodes", "model"]).chain(measures.iter().copied());
    let mut csv = Csv::new(identity.into_iter().chain(names));
    for one in finished {
        let kind = if one.flew() { "fly" } else { "train-values" };
        let planned = &one.planned;
        let identity = [&planned.hash, kind, &planned.condition, &planned.stratum].map(Cell::from);
        let places =
            axes.iter().map(|axis| planned.axes.get(axis).map_or(Cell::Empty, |at| Cell::from(at.as_str())));
        let episodes = if one.flew() { Cell::from(one.episodes().len()) } else { Cell::Empty };
        let model = one.outcome["model"].as_str().map_or(Cell::Empty, Cell::from);
        let numbers = measures.iter().map(|key| Cell::from(one.value(key)));
        csv.push(identity.into_iter().chain(places).chain([episodes, model]).chain(numbers));
    }
    csv
}

/// A row an episode.
pub fn by_episode(finished: &[Finished]) -> Csv {
    let keys: Vec<&str> = participant_keys().collect();
    let identity = ["job", "condition", "stratum", "episode", "seed", "ending"];
    let mut csv = Csv::new(identity.into_iter().chain(keys.iter().copied()));
    for one in finished {
        let planned = &one.planned;
        for (number, episode) in one.episodes().iter().enumerate() {
            let identity = [
                Cell::from(planned.hash.as_str()),
                Cell::from(planned.condition.as_str()),
                Cell::from(planned.stratum.as_str()),
                Cell::from(number + 1),
                episode["seed"].as_i64().map_or(Cell::Empty, Cell::from),
                episode["ending"].as_str().map_or(Cell::Empty, Cell::from),
            ];
            csv.push(identity.into_iter().chain(keys.iter().map(|key| Cell::from(episode[key].as_f64()))));
        }
    }
    csv
}

/// A row a job: which executor, node and worker ran it, when, how long, at which attempt.
pub fn where_it_ran(finished: &[Finished]) -> Csv {
    let mut csv = Csv::new(["job", "executor", "node", "worker", "begun_ms", "seconds", "attempt"]);
    for ran in finished.iter().filter_map(|one| one.ran.as_ref()) {
        let words = [&ran.hash, &ran.executor, &ran.node, &ran.worker].map(|word| Cell::from(word.as_str()));
        csv.push(words.into_iter().chain([ran.begun_ms.into(), ran.seconds.into(), ran.attempt.into()]));
    }
    csv
}

/// What the columns of the tables mean.
pub fn dictionary() -> Csv {
    let episodes = OF_A_PARTICIPANT.iter().chain(&OF_AN_EPISODE).copied().collect::<Vec<_>>();
    let mut csv = measures::dictionary(&episodes);
    for (key, meaning) in IDENTITY.into_iter().chain(OF_A_TRAINING) {
        csv.push([key, meaning].map(Cell::from));
    }
    csv
}

/// Columns that measure nothing.
const IDENTITY: [(&str, &str); 13] = [
    ("job", "SHA-256 of the job: everything its outcome depends on."),
    ("kind", "fly or train-values."),
    ("condition", "What is compared: rule, head and models, or preset and options of training."),
    ("stratum", "What it is compared on: pilots and options of the plant. Intervals are drawn within."),
    ("episodes", "How many episodes the job flew."),
    ("episode", "Number of the episode within its job, from 1."),
    ("seed", "Of the job, or of the episode."),
    ("model", "SHA-256 of the model that the job trained."),
    ("executor", "local or ray."),
    ("node", "The machine, or the node of a cluster."),
    ("worker", "The thread or process."),
    ("begun_ms", "When the job began, milliseconds since 1970."),
    ("attempt", "1 unless attempts before were lost with their worker."),
];

/// Jobs, seconds of work and jobs that an earlier attempt lost, by executor and node.
pub fn nodes(finished: &[Finished]) -> BTreeMap<(String, String), (usize, f64, usize)> {
    let mut nodes = BTreeMap::new();
    for ran in finished.iter().filter_map(|one| one.ran.as_ref()) {
        let node = nodes.entry((ran.executor.clone(), ran.node.clone())).or_insert((0, 0.0, 0));
        *node = (node.0 + 1, node.1 + ran.seconds, node.2 + usize::from(ran.attempt > 1));
    }
    nodes
}

fn axes(finished: &[Finished]) -> BTreeSet<String> {
    finished.iter().flat_map(|one| one.planned.axes.keys().cloned()).collect()
}

fn measures(finished: &[Finished]) -> Vec<&'static str> {
    let flown = finished.iter().any(Finished::flew).then(participant_keys).into_iter().flatten();
    let trained = finished
        .iter()
        .any(|one| !one.flew())
        .then_some(OF_A_TRAINING.map(|(key, _)| key))
        .into_iter()
        .flatten();
    let known: Vec<&str> = flown.collect();
    let more: Vec<&str> = trained.filter(|key| !known.contains(key)).collect();
    known.into_iter().chain(more).collect()
}
