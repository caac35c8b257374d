//! The record of an episode: what fixes it, what was asked and carried out at each tick, how it ended.
//!
//! The key log (or, for a simulated pilot, what was asked) with the [`Setup`] is the truth; states, beliefs and values
//! follow from it and are not stored. Two [`Digests`] of all their bits are, so that a replay can be told exact.

mod bytes;

pub(crate) use bytes::Reader;
pub use bytes::{
    FORMAT_VERSION, MAX_BYTES, MAX_EVENTS, MAX_TICKS, TAPED_FORMAT_VERSION, TrajectoryError, put_event,
    read_events,
};

use crate::action::Action;
use crate::arbitration::Rule;
use crate::cockpit::{Silence, Tick};
use crate::intent::Inference;
use crate::keys::KeyEvent;
use crate::plant::{Ending, Plant, Step};
use crate::registry::{Plants, Task, TaskError};
use crate::tape::{self, Tape, Taped};
use serde::{Deserialize, Serialize};

/// Everything that fixes an episode but the pilot's requests.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// Plant and its options.
    pub task: Task,
    /// Version of the plant; another version's bits may differ.
    pub plant_version: u32,
    /// Fixes everything random about the episode; at most 2⁵³, so that every language reads it from JSON.
    pub seed: u64,
    /// The rule of arbitration.
    pub rule: Rule,
    /// Where the belief about the goal comes from.
    pub inference: Inference,
    /// What is carried out when nothing is asked.
    #[serde(default)]
    pub silence: Silence,
    /// How fast the world went for the pilot: 1 is real time, 0.5 half as fast. Changes no bit.
    pub time_scale: f64,
    /// SHA-256 of the value model's file, in hexadecimal; `None` if no network gave the values.
    pub values: Option<String>,
    /// SHA-256 of the intent model's file, in hexadecimal; `None` if no network inferred the goal.
    pub intent: Option<String>,
    /// `person`, or the name of a simulated pilot.
    pub pilot: String,
}

impl Setup {
    /// The version of the bytes of this episode's record.
    pub fn format(&self) -> u8 {
        if self.task.plant == tape::PLANT { TAPED_FORMAT_VERSION } else { FORMAT_VERSION }
    }
}

/// The largest seed of a [`Setup`].
pub const MAX_SEED: u64 = 1 << 53;

/// Digests of all bits of an episode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Digests {
    /// Of every state, reward and ending: equal physics.
    pub plant: u64,
    /// Of every belief, value and executed action: equal decisions.
    pub decisions: u64,
}

/// A finished episode.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// What fixed it.
    pub setup: Setup,
    /// What was asked at each tick.
    pub asked: Vec<Option<Action>>,
    /// What was carried out at each tick; as many as were asked.
    pub executed: Vec<Option<Action>>,
    /// The person's keys; empty for a simulated pilot.
    pub keys: Vec<KeyEvent>,
    /// How it ended.
    pub ending: Ending,
    /// Digests of everything that is not stored.
    pub digests: Digests,
    /// What was seen of the plant, if it was elsewhere.
    pub tape: Option<Tape>,
}

/// Collects a trajectory tick by tick.
#[derive(Clone, Debug)]
pub struct Recorder {
    asked: Vec<Option<Action>>,
    executed: Vec<Option<Action>>,
    digests: Digests,
    ending: Option<Ending>,
}

impl Recorder {
    /// Begins with a plant that was just reset.
    pub fn new(plant: &dyn Plant) -> Self {
        let digests = Digests { plant: digest_of_state(FNV_OFFSET, plant), decisions: FNV_OFFSET };
        Self { asked: Vec::new(), executed: Vec::new(), digests, ending: None }
    }

    /// Notes one tick and where it left the plant.
    pub fn note(&mut self, tick: &Tick<'_>, plant: &dyn Plant) {
        self.asked.push(tick.asked);
        self.executed.push(tick.executed);
        self.digests.decisions = digest_of_decision(self.digests.decisions, tick);
        self.digests.plant = digest_of_step(self.digests.plant, plant, &tick.step);
        self.ending = tick.step.ending;
    }

    /// The digests so far.
    pub fn digests(&self) -> Digests {
        self.digests
    }

    /// Ticks so far.
    pub fn ticks(&self) -> usize {
        self.asked.len()
    }

    /// How the episode ended, if it did.
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    /// The trajectory; an episode that had not ended is abandoned.
    pub fn finish(self, setup: Setup, keys: Vec<KeyEvent>) -> Trajectory {
        let Self { asked, executed, digests, ending } = self;
        Trajectory {
            setup,
            asked,
            executed,
            keys,
            ending: ending.unwrap_or(Ending::Abandoned),
            digests,
            tape: None,
        }
    }
}

impl Trajectory {
    /// Ticks the episode lasted.
    pub fn ticks(&self) -> usize {
        self.asked.len()
    }

    /// What flies the episode again, and the registry that knows it: the plant of its task, or the tape of what was seen
    /// of a plant that was elsewhere.
    pub fn plant(&self, plants: &Plants) -> Result<(Box<dyn Plant>, Plants), TaskError> {
        match &self.tape {
            Some(tape) => Ok((Box::new(Taped::new(tape.clone())), tape::plants())),
            None => Ok((plants.make(&self.setup.task)?, plants.clone())),
        }
    }
}

/// The digest of the plant's part of a trajectory, from what was carried out alone.
pub(crate) fn plant_digest(plant: &mut dyn Plant, executed: &[Option<Action>]) -> (u64, Option<Ending>) {
    let mut digest = digest_of_state(FNV_OFFSET, plant);
    let mut ending = None;
    for &action in executed {
        let step = plant.step(action);
        digest = digest_of_step(digest, plant, &step);
        ending = step.ending;
    }
    (digest, ending)
}

const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a over 32-bit words: enough to tell that bits differ; it guards against accidents, not against forgery.
fn mix(digest: u64, word: u32) -> u64 {
    (digest ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23)
}

fn digest_of_state(digest: u64, plant: &dyn Plant) -> u64 {
    let view = plant.view();
    let goals =
        view.goals.iter().flat_map(|goal| [goal.id, goal.position[0].to_bits(), goal.position[1].to_bits()]);
    view.state.iter().map(|x| x.to_bits()).chain(goals).fold(digest, mix)
}

fn digest_of_step(digest: u64, plant: &dyn Plant, step: &Step) -> u64 {
    let reward = step.reward.to_bits();
    let ending = step.ending.map_or(u32::MAX, |ending| ending as u32);
    [reward as u32, (reward >> 32) as u32, ending].into_iter().fold(digest_of_state(digest, plant), mix)
}

fn digest_of_decision(digest: u64, tick: &Tick<'_>) -> u64 {
    let values = tick.values.values().iter().map(|value| value.to_bits());
    let belief = tick.belief.probabilities().iter().map(|p| p.to_bits());
    let imagined = tick.belief.imagined_goal().into_iter().flat_map(|goal| goal.position.map(f32::to_bits));
    let belief = belief.chain([tick.belief.goal as u32, tick.belief.confidence.to_bits()]);
    let words = values.chain(belief).chain(imagined);
    let executed = match tick.executed {
        None => [u32::MAX; 4],
        Some(Action::Command(command)) => [u32::from(command), 0, 0, 0],
        Some(Action::Axes(axes)) => axes.map(f32::to_bits),
    };
    words.chain(executed).fold(digest, mix)
}
