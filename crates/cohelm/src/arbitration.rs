//! Which action reaches the plant (Section III-C): candidates, values and similarities go in, a choice comes out.

mod act_if_better;
mod blend;
mod choose;
mod hedged;
mod hindsight;
mod human_alone;
mod line_graph;
mod linear;
mod minimal;
mod regret;
mod robot_alone;
mod rule;
mod safe_nearest;
mod stage;
mod threshold;
mod tolerance;

pub use act_if_better::ActIfBetter;
pub use hedged::HedgedRegret;
pub use hindsight::Hindsight;
pub use human_alone::HumanAlone;
pub use line_graph::LineGraph;
pub use linear::Linear;
pub use minimal::MinimalIntervention;
pub use regret::RegretThreshold;
pub use robot_alone::RobotAlone;
pub use rule::{DEFAULT_KAPPA, MOST_AHEAD, Rule, RuleError};
pub use safe_nearest::{FLIGHTS, SafeNearest};
pub use stage::{GoalValues, Last, Likeness, LookAhead, Stage};
pub use threshold::Threshold;
pub use tolerance::ConstantTolerance;

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

/// What a rule has to be told beyond the values for the inferred goal. It costs time, so that only who says so gets it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// The values of the candidates for every goal: [`Stage::of_goals`].
    pub every_goal: bool,
    /// Flights ahead in a copy of the plant: [`Stage::ahead`]. A plant that cannot be copied is refused such a rule
    /// where the cockpit is made.
    pub look_ahead: bool,
}

/// A rule of arbitration. A pure function of its stage; it fills `allowed` with one entry a candidate (A_threshold of
/// Eq. 3), which comes in all false.
pub trait Arbiter: Send + Sync {
    /// Chooses.
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick;

    /// What it has to be told; nothing more than everybody is, unless it says so.
    fn needs(&self) -> Needs {
        Needs::default()
    }
}
