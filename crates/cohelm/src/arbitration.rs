//! Which action reaches the plant (Section III-C): candidates, values and similarities go in, a choice comes out.

mod rules;

pub use rules::{
    ConstantTolerance, DEFAULT_KAPPA, HumanAlone, Linear, MinimalIntervention, RegretThreshold, RobotAlone,
    Rule, RuleError,
};

use crate::value::ActionValues;

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

/// What a rule may know of one tick.
#[derive(Clone, Copy, Debug)]
pub struct Stage<'a> {
    /// The candidates and their values for the inferred goal.
    pub values: &'a ActionValues,
    /// For each candidate its likeness to what was asked; `None` if nothing is asked.
    pub likeness: Option<&'a [Likeness]>,
    /// c of Eq. 1.
    pub confidence: f32,
}

/// What a rule chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pick {
    /// Change nothing.
    Nothing,
    /// What was asked, as it was asked.
    Asked,
    /// The candidate of that index.
    Candidate(usize),
    /// The weighted sum of a candidate (the robot's) and what was asked, if the space has one; otherwise the one of
    /// the two that weighs more, and what was asked if they weigh the same.
    Blend {
        /// Index of the robot's candidate.
        robot: usize,
        /// The robot's weight, in [0, 1].
        weight: f32,
    },
}

/// A rule of arbitration. A pure function of its stage; it fills `allowed` with one entry a candidate (A_threshold of
/// Eq. 3), which comes in all false.
pub trait Arbiter: Send + Sync {
    /// Chooses.
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick;
}

impl Stage<'_> {
    /// Eq. 4 over the whole allowed set: the most alike, then the higher value, then the lower index. With nothing
    /// asked, or nothing allowed, the best candidate.
    pub fn most_alike(&self, allowed: &[bool]) -> usize {
        let Some(likeness) = self.likeness else { return self.values.best() };
        let better = |a: usize, b: usize| {
            let by_value = || self.values.values()[a] > self.values.values()[b];
            likeness[a] > likeness[b] || (likeness[a] == likeness[b] && by_value())
        };
        let candidates = (0..allowed.len()).filter(|&i| allowed[i]);
        candidates.reduce(|best, i| if better(i, best) { i } else { best }).unwrap_or(self.values.best())
    }
}
