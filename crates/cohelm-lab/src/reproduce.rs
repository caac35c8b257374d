//! The paper's experiment with simulated pilots: its conditions, its claims beside ours, its figures.
//!
//! Nothing here is tuned until a claim comes true; the verdicts are computed ([`cohelm_study::verdict`]).

mod claims;
mod figures;
mod report;
pub mod sensitivity;
#[cfg(test)]
mod tests;

pub use claims::{Trained, claims};
pub use figures::{figure_2a, figure_2b, figure_2c, looks};
pub use report::{Setting, document};

use crate::experiment::Condition;
use cohelm::arbitration::{DEFAULT_KAPPA, Rule};
use cohelm::intent::Inference;

/// α of the constant tolerance that the paper's reference \[9\] is represented by: Q′ ≥ 0.6 · Q′max.
pub const TOLERANCE: f64 = 0.4;

/// Names of the conditions, as files use them.
pub mod name {
    /// Human alone.
    pub const HIC: &str = "hic";
    /// Linear arbitration with the paper's confidence.
    pub const LASC: &str = "lasc";
    /// Minimal intervention with the paper's confidence.
    pub const MISC: &str = "misc";
    /// Linear arbitration with the peaked confidence.
    pub const LASC_PEAKED: &str = "lasc-peaked";
    /// Minimal intervention with the peaked confidence.
    pub const MISC_PEAKED: &str = "misc-peaked";
    /// Constant tolerance.
    pub const TOLERANCE: &str = "tolerance";
    /// Minimal intervention with a regret threshold.
    pub const MISC_R: &str = "misc-r";
    /// The robot alone, told the goal.
    pub const ROBOT: &str = "robot";
}

/// The conditions, in the order of tables and figures.
///
/// All helped ones take the same goal, that nearest to the position the network predicts, so that they differ in
/// confidence and rule alone. The robot alone is told the goal: it shows what the values can do.
pub fn conditions() -> Vec<Condition> {
    let (paper, peaked) = (Inference::InverseDistance, Inference::Softmax);
    vec![
        Condition::new(name::HIC, "HIC", Rule::Hic, paper),
        Condition::new(name::LASC, "LASC", Rule::Lasc, paper),
        Condition::new(name::MISC, "MISC", Rule::Misc, paper),
        Condition::new(name::LASC_PEAKED, "LASC, peaked c", Rule::Lasc, peaked),
        Condition::new(name::MISC_PEAKED, "MISC, peaked c", Rule::Misc, peaked),
        Condition::new(name::TOLERANCE, "Q′ ≥ 0.6 Q′max", Rule::Tolerance { alpha: TOLERANCE }, paper),
        Condition::new(name::MISC_R, "MISC-R", Rule::MiscR { kappa: DEFAULT_KAPPA }, paper),
        Condition::new(name::ROBOT, "Robot, goal known", Rule::Robot, Inference::Known),
    ]
}
