//! What was seen of a plant that is elsewhere and cannot be simulated, tick by tick.
//!
//! Where a plant is a machine or another program, seed and key log do not give its states back. So its states are
//! recorded: the [`Tape`] of an episode stands in for the physics when its decisions are checked, and when it is watched
//! again. Everything on a tape was checked where it came in: sizes are bounded and numbers are finite, so that nothing
//! that reads one can fail inside a tick.

mod bytes;
mod sound;

pub(crate) use bytes::{put_tape, read_tape};

use crate::action::{Action, ActionSpace};
use crate::plant::{Ending, Goal, Plant, Step, View};
use crate::registry::{PlantEntry, Plants, Task};
use crate::scene::{Pose, Scene};
use serde::{Deserialize, Serialize};

/// The name under which setups know every plant that is elsewhere; its own name is the option `name`.
pub const PLANT: &str = "external";
/// Version of that plant in setups: of the protocol, not of what is elsewhere.
pub const VERSION: u32 = 1;
/// Most numbers of a state.
pub const MAX_STATE: usize = 64;
/// Most parts that move.
pub const MAX_MOVABLE: usize = 64;
/// Most bytes of a tape: an hour of a small plant at 50 Hz, minutes of the largest.
pub const MAX_TAPE: usize = 32 * 1024 * 1024;
/// Largest magnitude of a state's or position's number. They should lie within about −1 to 1; a network that is given
/// far larger ones gives no finite values.
pub const MAX_MAGNITUDE: f32 = 1000.0;

/// What a plant that is elsewhere says of itself before an episode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Described {
    /// Its own name.
    pub name: String,
    /// Ticks a second, 1 to 200.
    pub ticks_per_second: f64,
    /// The actions it takes.
    pub space: ActionSpace,
    /// What to draw.
    pub scene: Scene,
    /// The id of the pilot's own goal.
    pub pilot_goal: u32,
}

/// What was seen after a tick, or before the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// The state vector.
    pub state: Vec<f32>,
    /// Where the plant is, in the goals' units.
    pub position: [f32; 2],
    /// How its switches stand, one bit each.
    pub switches: u8,
    /// The goals of the moment.
    pub goals: Vec<Goal>,
    /// Where the movable parts are.
    pub poses: Vec<Pose>,
    /// What the tick brought.
    pub reward: f64,
    /// How it ended the episode, if it did.
    pub ending: Option<Ending>,
}

/// Why something does not go on a tape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TapeError {
    /// A number or a count is out of bounds.
    #[error("{what} must be {expected}, got {found}")]
    Bounds {
        /// Which.
        what: String,
        /// What it may be.
        expected: String,
        /// What it is.
        found: String,
    },
    /// The tape has an end.
    #[error("the record is full: it may have {MAX_TAPE} bytes")]
    Full,
    /// The episode had ended.
    #[error("the episode ended with {}; nothing follows", .0.word())]
    Over(Ending),
}

/// The description of a plant and all that was seen of it in one episode.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape {
    about: Described,
    seen: Vec<Seen>,
    size: usize,
    lost: Option<String>,
}

impl Tape {
    /// Begins with what was seen before the first tick.
    pub fn new(about: Described, first: Seen) -> Result<Self, TapeError> {
        sound::description(&about)?;
        sound::seen(&about, &first)?;
        let size = bytes::size_of(&first);
        Ok(Self { about, seen: vec![first], size, lost: None })
    }

    /// Adds what was seen after the next tick; there stays room for its being lost. On an error nothing has changed.
    pub fn push(&mut self, seen: Seen) -> Result<(), TapeError> {
        let room = bytes::size_of(&seen);
        self.add(seen, room)
    }

    fn add(&mut self, seen: Seen, room: usize) -> Result<(), TapeError> {
        sound::seen(&self.about, &seen)?;
        let states = self.last().state.len();
        if seen.state.len() != states {
            return Err(sound::wrong("the state", format!("{states} numbers as before"), seen.state.len()));
        }
        if let Some(ending) = self.last().ending {
            return Err(TapeError::Over(ending));
        }
        let size = self.size + bytes::size_of(&seen);
        if size + room > MAX_TAPE {
            return Err(TapeError::Full);
        }
        self.size = size;
        self.seen.push(seen);
        Ok(())
    }

    /// The plant was lost: it stays as it was last seen, and the episode is abandoned at this tick.
    pub fn lose(&mut self, why: &str) {
        self.seen.push(Seen { reward: 0.0, ending: Some(Ending::Abandoned), ..self.last().clone() });
        self.lost = Some(why.chars().take(bytes::MAX_REASON).collect());
    }

    /// For how many ticks like the last there is room.
    pub fn room(&self) -> usize {
        (MAX_TAPE - self.size.min(MAX_TAPE)) / bytes::size_of(self.last())
    }

    /// What the plant says of itself.
    pub fn about(&self) -> &Described {
        &self.about
    }

    /// What was seen: before the first tick, and after each.
    pub fn seen(&self) -> &[Seen] {
        &self.seen
    }

    /// What was seen last.
    pub fn last(&self) -> &Seen {
        &self.seen[self.seen.len() - 1]
    }

    /// Why the plant was lost, if it was.
    pub fn lost(&self) -> Option<&str> {
        self.lost.as_deref()
    }
}

/// A tape as a plant: whatever is carried out, it goes the way it went.
#[derive(Clone, Debug, PartialEq)]
pub struct Taped {
    tape: Tape,
    at: usize,
}

impl Taped {
    /// At the tape's beginning.
    pub fn new(tape: Tape) -> Self {
        Self { tape, at: 0 }
    }

    /// The tape.
    pub fn tape(&self) -> &Tape {
        &self.tape
    }

    /// Lengthens the tape, by what was seen or by a loss, and goes on to its new end. Once the episode has ended it stays.
    pub fn grow(&mut self, seen: Result<Seen, String>) -> Step {
        if let Some(ending) = self.tape.last().ending {
            return Step { reward: 0.0, ending: Some(ending) };
        }
        let grown = seen.and_then(|seen| self.tape.push(seen).map_err(|error| error.to_string()));
        if let Err(why) = grown {
            self.tape.lose(&why);
        }
        self.at = self.tape.seen.len() - 1;
        self.now_step()
    }

    fn now(&self) -> &Seen {
        &self.tape.seen[self.at]
    }

    fn now_step(&self) -> Step {
        Step { reward: self.now().reward, ending: self.now().ending }
    }
}

impl Plant for Taped {
    fn reset(&mut self, _seed: u64) {
        self.at = 0;
    }

    fn step(&mut self, _executed: Option<Action>) -> Step {
        if self.at + 1 == self.tape.seen.len() {
            return Step { reward: 0.0, ending: Some(Ending::Abandoned) };
        }
        self.at += 1;
        self.now_step()
    }

    fn view(&self) -> View<'_> {
        let Seen { state, position, switches, goals, .. } = self.now();
        View { tick: self.at as u32, state, position: *position, switches: *switches, goals }
    }

    fn pilot_goal(&self) -> usize {
        let own = self.tape.about.pilot_goal;
        self.now().goals.iter().position(|goal| goal.id == own).unwrap_or(0)
    }

    fn space(&self) -> &ActionSpace {
        &self.tape.about.space
    }

    fn ticks_per_second(&self) -> f64 {
        self.tape.about.ticks_per_second
    }

    fn scene(&self) -> Scene {
        self.tape.about.scene.clone()
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        poses.clone_from(&self.now().poses);
    }

    fn tape(&self) -> Option<&Tape> {
        Some(&self.tape)
    }
}

/// Whether a plant may be driven at so many ticks a second: 1 to 200.
pub fn check_rate(ticks_per_second: f64) -> Result<(), TapeError> {
    sound::rate(ticks_per_second)
}

/// The task of a plant that is elsewhere and goes by that name.
pub fn task(name: &str) -> Task {
    Task::new(PLANT).with("name", name)
}

/// The registry in which cockpits for such plants are made. It makes none itself: there is no plant without its other
/// end.
pub fn plants() -> Plants {
    let mut plants = Plants::default();
    plants.register(PlantEntry {
        name: PLANT,
        version: VERSION,
        summary: "A plant that is elsewhere: a machine, or another program.",
        make: |_| Err("it is elsewhere and cannot be made here; fly it with `cohelm fly --external`".into()),
        values: None,
        skill: None,
        actions: &[],
        preset: "default",
    });
    plants
}

#[cfg(test)]
mod tests;
