//! What a rule may know of one tick.

use crate::action::Action;
use crate::intent::Belief;
use crate::value::ActionValues;
use core::fmt;

/// How a candidate compares with what was asked; greater is more alike.
///
/// Similarity decides (Eq. 4). The paper leaves ties open: ours go to the same label, then to the same effect.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Likeness {
    /// f(a, a_h) of Eq. 4.
    pub similarity: f32,
    /// True if it is the very action that was asked.
    pub same_label: bool,
    /// True if the plant could not tell it from what was asked.
    pub same_effect: bool,
}

/// What a rule may know of one tick. Nothing in it depends on which goal is the pilot's, except through what the pilot
/// asks.
#[derive(Clone, Copy)]
pub struct Stage<'a> {
    /// The candidates and their values for the inferred goal.
    pub values: &'a ActionValues,
    /// For each candidate its likeness to what was asked; `None` if nothing is asked.
    pub likeness: Option<&'a [Likeness]>,
    /// The probabilities of the goals, the inferred one, and c of Eq. 1.
    pub belief: &'a Belief,
    /// The candidates' values for every goal, if the rule [needs](super::Needs) them and there are goals.
    pub of_goals: Option<GoalValues<'a>>,
    /// Flights ahead, if the rule [needs](super::Needs) them and the plant can be copied.
    pub ahead: Option<&'a dyn LookAhead>,
    /// What was asked and carried out at the tick before; `None` at the first.
    pub last: Option<Last>,
}

/// What was asked and carried out at the tick before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Last {
    /// What the pilot asked for.
    pub asked: Option<Action>,
    /// What reached the plant.
    pub executed: Option<Action>,
    /// True if that left the plant set otherwise than what was asked would have; false if nothing was asked.
    pub intervened: bool,
}

/// Looks ahead in copies of the plant, flown from now on. It tells whether the plant stays whole, never where it comes to
/// rest: that would say which goal is the pilot's.
///
/// Flights are flown when they are asked for, so that who looks at the likeliest candidate first pays for few.
pub trait LookAhead {
    /// True if the plant neither crashes nor leaves its bounds within `horizon` ticks when the candidate of that index
    /// is carried out for `hold` ticks and then the robot's best action for the inferred goal.
    fn is_safe(&self, candidate: usize, hold: u32, horizon: u32) -> bool;
}

/// The values of the same candidates for every goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalValues<'a> {
    values: &'a [f32],
    candidates: usize,
}

impl<'a> GoalValues<'a> {
    /// Values of `candidates` actions for one goal after the other, all finite; `None` if there are none, or not as many
    /// for each goal.
    pub fn new(values: &'a [f32], candidates: usize) -> Option<Self> {
        let whole = candidates > 0 && !values.is_empty() && values.len() % candidates == 0;
        let finite = values.iter().all(|value| value.is_finite());
        (whole && finite).then_some(Self { values, candidates })
    }

    /// How many goals there are, at least one.
    pub fn goals(&self) -> usize {
        self.values.len() / self.candidates
    }

    /// Q_g(s, a) of every candidate for the goal of that index.
    ///
    /// # Panics
    /// If there is no such goal.
    pub fn of(&self, goal: usize) -> &'a [f32] {
        &self.values[goal * self.candidates..][..self.candidates]
    }

    /// How much worse than the best a candidate is for a goal, never negative, in the values' own units.
    pub fn regret(&self, goal: usize, candidate: usize) -> f64 {
        let values = self.of(goal);
        let best = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        f64::from(best) - f64::from(values[candidate])
    }
}

impl<'a> Stage<'a> {
    /// A tick of which no more is known than values, what is asked and the belief.
    pub fn new(values: &'a ActionValues, likeness: Option<&'a [Likeness]>, belief: &'a Belief) -> Self {
        Self { values, likeness, belief, of_goals: None, ahead: None, last: None }
    }

    /// c of Eq. 1.
    pub fn confidence(&self) -> f32 {
        self.belief.confidence
    }
}

impl fmt::Debug for Stage<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stage")
            .field("values", self.values)
            .field("likeness", &self.likeness)
            .field("belief", self.belief)
            .field("of_goals", &self.of_goals)
            .field("looks_ahead", &self.ahead.is_some())
            .field("last", &self.last)
            .finish()
    }
}
