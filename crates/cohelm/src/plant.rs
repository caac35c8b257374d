//! What is steered.

use crate::action::{Action, ActionSpace, Effect};
use crate::scene::{Pose, Scene};
use crate::tape::Tape;
use serde::{Deserialize, Serialize};

/// A goal that the pilot may have: a landing pad, an object to reach.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// Names the goal for the whole episode, whatever others appear or vanish. Never
    /// [`IMAGINED`](crate::intent::IMAGINED).
    pub id: u32,
    /// Where it is, in the plant's normalised units.
    pub position: [f32; 2],
}

/// What pilot and co-pilot may see at one tick. Which goal is the pilot's own is not among it: a co-pilot that gets
/// nothing but a `View` cannot peek.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Ticks since the episode began.
    pub tick: u32,
    /// The state vector, finite, in normalised units (about −1 to 1).
    pub state: &'a [f32],
    /// Where the plant is, in the same units as the goals' positions.
    pub position: [f32; 2],
    /// How the switches stand, one bit each; 0 in spaces without switches.
    pub switches: u8,
    /// The goals of the moment, at most [`MAX_GOALS`](crate::intent::MAX_GOALS), in an order that does not depend on
    /// which is the pilot's.
    pub goals: &'a [Goal],
}

impl View<'_> {
    /// Index of the goal nearest to the plant (Euclidean, the first of equals); 0 when there is none.
    pub fn nearest_goal(&self) -> usize {
        nearest(self.goals, self.position)
    }
}

/// Index of the goal nearest to a position (Euclidean, the first of equals); 0 when there is none.
pub fn nearest(goals: &[Goal], position: [f32; 2]) -> usize {
    let mut best = (0, f32::INFINITY);
    for (index, goal) in goals.iter().enumerate() {
        let (dx, dy) = (goal.position[0] - position[0], goal.position[1] - position[1]);
        let squared = dx * dx + dy * dy;
        if squared < best.1 {
            best = (index, squared);
        }
    }
    best.0
}

/// What the pilot wants from some tick on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wish {
    /// The first tick at which it does.
    pub from: u32,
    /// The id of the goal.
    pub goal: u32,
}

/// How an episode ended: exactly one of these, and an event, never a threshold on the return.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// At the pilot's own goal.
    Goal,
    /// Well-behaved, but somewhere else than at the pilot's goal.
    Elsewhere,
    /// Crashed or otherwise broken.
    Crash,
    /// Left the space it may be in.
    OutOfBounds,
    /// The time ran out: a truncation, after which values go on.
    TimeLimit,
    /// Stopped from outside before any of the above: a truncation.
    Abandoned,
}

impl Ending {
    /// True if the world itself ended the episode, so that no value lies beyond it; false for a truncation.
    pub fn is_terminal(self) -> bool {
        !matches!(self, Self::TimeLimit | Self::Abandoned)
    }

    /// All endings, in the order of tables.
    pub const ALL: [Self; 6] =
        [Self::Goal, Self::Elsewhere, Self::Crash, Self::OutOfBounds, Self::TimeLimit, Self::Abandoned];

    /// The word for it in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Goal => "goal",
            Self::Elsewhere => "elsewhere",
            Self::Crash => "crash",
            Self::OutOfBounds => "out-of-bounds",
            Self::TimeLimit => "time-limit",
            Self::Abandoned => "abandoned",
        }
    }
}

/// What one tick of the plant brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Reward for the pilot's own goal, in the plant's units.
    pub reward: f64,
    /// How the episode ended, if it did.
    pub ending: Option<Ending>,
}

/// Something that is steered, one action a tick.
///
/// A plant is deterministic: the seed given to [`reset`](Plant::reset) fixes everything random about the episode, and
/// equal actions then give equal bits; where it is elsewhere and cannot be, its [`tape`](Plant::tape) is what a record
/// keeps. No method fails: actions are checked against [`space`](Plant::space) before
/// they get here.
pub trait Plant: Send {
    /// Begins the episode of a seed.
    fn reset(&mut self, seed: u64);

    /// Carries out one action, or nothing at all, for one tick.
    fn step(&mut self, executed: Option<Action>) -> Step;

    /// What may be seen now.
    fn view(&self) -> View<'_>;

    /// Index among the goals of the moment of the pilot's own; 0 when there is none. Asked at every tick, for a pilot may
    /// change its mind. Only pilots and judges may ask; the co-pilot never.
    fn pilot_goal(&self) -> usize;

    /// Which goal the pilot will want from which tick on, as far as the episode that was just reset fixes it: for
    /// whoever is told it. A pilot that never changes its mind has one wish.
    fn wishes(&self) -> Vec<Wish> {
        let goal = self.view().goals.get(self.pilot_goal()).map(|goal| goal.id);
        goal.into_iter().map(|goal| Wish { from: 0, goal }).collect()
    }

    /// The actions there are.
    fn space(&self) -> &ActionSpace;

    /// Ticks a second in real time (at time scale 1).
    fn ticks_per_second(&self) -> f64 {
        50.0
    }

    /// After how many ticks an episode is over in any case; `None` if it may last for ever.
    fn limit_ticks(&self) -> Option<u32> {
        None
    }

    /// How much `action` is like what was `asked`: f of Eq. 4.
    fn similarity(&self, action: Action, asked: Action) -> f32 {
        self.space().similarity(action, asked)
    }

    /// What carrying out `action` now would leave the plant set to.
    fn effect(&self, action: Option<Action>) -> Effect {
        self.space().effect(action, self.view().switches)
    }

    /// The shapes to draw, fixed for the episode.
    fn scene(&self) -> Scene;

    /// Where the movable shapes are now: clears `poses` and fills it.
    fn poses(&self, poses: &mut Vec<Pose>);

    /// Optional: an independent copy that goes on with the same bits.
    fn snapshot(&self) -> Option<Box<dyn Plant>> {
        None
    }

    /// Optional: what was seen of a plant that is elsewhere, where seed and actions do not give its states back.
    fn tape(&self) -> Option<&Tape> {
        None
    }

    /// Optional: from now on the goal of that index among those of the moment is the pilot's own. Returns false, having
    /// done nothing, if the plant cannot or has no such goal. Who looks ahead in a copy makes the inferred goal the
    /// pilot's there, so that how the copy fares cannot tell which is the pilot's in truth.
    fn set_pilot_goal(&mut self, _goal: usize) -> bool {
        false
    }

    /// Optional: begins the episode of a seed from a start of the given difficulty, from 0 (at the goal already) to 1
    /// (wide). Returns false, having done nothing, if the plant cannot.
    fn reset_near_goal(&mut self, _seed: u64, _difficulty: f64) -> bool {
        false
    }

    /// Optional: the symmetry that turns one transition into another as true.
    fn mirror(&self) -> Option<Mirror> {
        None
    }

    /// Optional: what a hand-made controller would do for the goal of that index, as a baseline or a demonstrator.
    fn teacher(&mut self, _goal: usize) -> Option<Action> {
        None
    }
}

/// A symmetry of a plant: the mirrored state has component `state[i].0` of the original at place i, times
/// `state[i].1`; positions are multiplied by `position`; command c becomes `commands[c]`; the mirrored action has axis
/// `axes[i].0` of the original at place i, times `axes[i].1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    /// For each component of the mirrored state: where it comes from, and its sign.
    pub state: Vec<(usize, f32)>,
    /// Signs of the two position coordinates.
    pub position: [f32; 2],
    /// The mirrored command of each command; empty for a space of axes.
    pub commands: Vec<u8>,
    /// For each axis of the mirrored action: where it comes from, and its sign; empty for a space of commands.
    pub axes: Vec<(usize, f32)>,
}
