//! An experiment: participants × conditions × episodes, flown by simulated pilots.
//!
//! Every condition flies the same episodes: the seed of terrain, goal and start depends on participant and number alone.

use crate::episode::{EpisodeMeasures, Tally};
use crate::parallel;
use cohelm::arbitration::Rule;
use cohelm::cockpit::{Cockpit, Silence, Tick};
use cohelm::flight::fly;
use cohelm::intent::Inference;
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::random::mix_seed;
use cohelm::registry::{Plants, Task, TaskError};
use cohelm::trajectory::{MAX_SEED, Setup, Trajectory};
use cohelm_copilot::{CockpitError, Models, cockpit};
use serde::Serialize;

/// A way to fly: one column of the tables.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Condition {
    /// Its name in files, such as `misc-softmax`.
    pub name: String,
    /// Its name in tables and figures.
    pub label: String,
    /// The rule of arbitration.
    pub rule: Rule,
    /// Where the belief about the goal comes from.
    pub inference: Inference,
}

impl Condition {
    /// A condition of that name and label.
    pub fn new(name: &str, label: &str, rule: Rule, inference: Inference) -> Self {
        Self { name: name.into(), label: label.into(), rule, inference }
    }
}

/// What an experiment is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Experiment {
    /// Plant and options.
    pub task: Task,
    /// Hash of the value model, if a network gives the values.
    pub values: Option<String>,
    /// Hash of the intent model, if a network infers the goal.
    pub intent: Option<String>,
    /// Fixes participants, episodes and everything else.
    pub seed: u64,
    /// How many participants.
    pub participants: usize,
    /// How many episodes each flies in each condition.
    pub episodes: usize,
    /// The conditions.
    pub conditions: Vec<Condition>,
    /// What the pilots are called in records.
    pub pilot: String,
}

/// Makes participant `index` of the draw that `seed` fixes, for a plant; or says why it cannot.
pub type MakePilot<'a> = &'a (dyn Fn(&dyn Plant, u64, usize) -> Result<Box<dyn Pilot>, String> + Sync);

/// Why an experiment cannot be flown.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// There is no such plant.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// A model is missing or does not fit.
    #[error(transparent)]
    Cockpit(#[from] CockpitError),
    /// No intent model has the variant that is asked for.
    #[error("no intent model for this plant is of the variant {asked:?}; there are: {known}")]
    NoVariant {
        /// What was asked for.
        asked: String,
        /// The variants that there are.
        known: String,
    },
    /// A pilot could not be made.
    #[error("a simulated pilot could not be made: {0}")]
    Pilot(String),
}

/// What an experiment runs with.
#[derive(Clone, Copy)]
pub struct Rig<'a> {
    /// The plants there are.
    pub plants: &'a Plants,
    /// The models there are.
    pub models: &'a Models,
    /// Makes the participants.
    pub pilots: MakePilot<'a>,
    /// Worker threads; 0 for one a core.
    pub threads: usize,
}

/// One flown episode.
#[derive(Clone, Debug)]
pub struct Flown {
    /// Number of the participant, from 0.
    pub participant: usize,
    /// Index of the condition.
    pub condition: usize,
    /// Number of the episode within participant and condition, from 0.
    pub episode: usize,
    /// What was measured.
    pub measures: EpisodeMeasures,
    /// The record.
    pub trajectory: Trajectory,
}

impl Experiment {
    /// Flies it all; the order is by participant, then condition, then episode, whatever the number of threads.
    pub fn run(&self, rig: &Rig<'_>) -> Result<Vec<Flown>, ExperimentError> {
        self.check(rig)?;
        let jobs = self.participants * self.conditions.len() * self.episodes;
        let flown = parallel::run(jobs, rig.threads, |index| self.fly(rig, index));
        flown.into_iter().collect()
    }

    /// Makes one cockpit for every condition, so that what is missing is said before the first episode.
    fn check(&self, rig: &Rig<'_>) -> Result<(), ExperimentError> {
        self.conditions.iter().try_for_each(|condition| self.seat(rig, condition, 0).map(|_| ()))
    }

    fn seat(
        &self,
        rig: &Rig<'_>,
        condition: &Condition,
        seed: u64,
    ) -> Result<(Setup, Box<dyn Plant>, Cockpit), ExperimentError> {
        let mut plant = rig.plants.make(&self.task)?;
        plant.reset(seed);
        let setup = Setup {
            task: self.task.clone(),
            plant_version: rig.plants.entry(&self.task)?.version,
            seed,
            rule: condition.rule,
            inference: condition.inference,
            silence: Silence::Best,
            time_scale: 1.0,
            values: self.values.clone(),
            intent: condition.inference.head().and(self.intent.clone()),
            pilot: self.pilot.clone(),
        };
        let cockpit = cockpit(&setup, plant.as_ref(), rig.plants, rig.models)?;
        Ok((setup, plant, cockpit))
    }

    fn fly(&self, rig: &Rig<'_>, index: usize) -> Result<Flown, ExperimentError> {
        let episode = index % self.episodes;
        let condition = index / self.episodes % self.conditions.len();
        let participant = index / self.episodes / self.conditions.len();
        let seed = self.episode_seed(participant, episode);
        let (setup, mut plant, mut cockpit) = self.seat(rig, &self.conditions[condition], seed)?;
        let mut pilot =
            (rig.pilots)(plant.as_ref(), self.seed, participant).map_err(ExperimentError::Pilot)?;
        let pilot_seed = mix_seed(seed, condition as u64);
        let mut tally = Tally::default();
        pilot.begin(pilot_seed);
        let mut note = |tick: &Tick<'_>, plant: &dyn Plant| tally.note(tick, plant);
        let trajectory = fly(setup, plant.as_mut(), &mut cockpit, pilot.as_mut(), &mut note);
        let measures = tally.finish(pilot.key_presses(), plant.ticks_per_second());
        Ok(Flown { participant, condition, episode, measures, trajectory })
    }

    fn episode_seed(&self, participant: usize, episode: usize) -> u64 {
        mix_seed(mix_seed(self.seed, participant as u64), episode as u64) % MAX_SEED
    }
}
