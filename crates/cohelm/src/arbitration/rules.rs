//! The rules, one short type each: formula, source, and what it does at its extremes.

use super::{Arbiter, Pick, Stage};
use serde::{Deserialize, Serialize};

/// A rule with its parameters, as options, files and records name it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "rule", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Rule {
    /// Human alone: [`HumanAlone`].
    Hic,
    /// Robot alone: [`RobotAlone`].
    Robot,
    /// Linear arbitration: [`Linear`].
    Lasc,
    /// Minimal intervention, Eqs. 3–4: [`MinimalIntervention`].
    Misc,
    /// Constant tolerance: [`ConstantTolerance`].
    Tolerance {
        /// α: 0 allows only a best action, 1 every action.
        alpha: f64,
    },
    /// Minimal intervention with a regret threshold: [`RegretThreshold`].
    MiscR {
        /// Regret allowed, in median ranges of the values.
        kappa: f64,
    },
}

/// The regret that MISC-R allows unless told otherwise: smaller corrects more, larger lets more through.
pub const DEFAULT_KAPPA: f64 = 0.7;

/// Why a rule cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RuleError {
    /// α outside [0, 1].
    #[error("the tolerance α must lie in [0, 1] (0: only a best action, 1: every action), got {0}")]
    Alpha(f64),
    /// κ negative or not finite.
    #[error("the regret κ must be a finite number of at least 0 (usual: 0.5 to 1.5), got {0}")]
    Kappa(f64),
    /// The value model does not say how large its ranges are.
    #[error("MISC-R needs the median range of the values from the model's card, a positive number; got {0}")]
    MedianRange(f64),
}

impl Rule {
    /// The rule, ready to decide. `median_range` is the median over states of max Q − min Q from the value model's
    /// card; only MISC-R asks for it.
    pub fn arbiter(&self, median_range: f64) -> Result<Box<dyn Arbiter>, RuleError> {
        Ok(match *self {
            Self::Hic => Box::new(HumanAlone),
            Self::Robot => Box::new(RobotAlone),
            Self::Lasc => Box::new(Linear),
            Self::Misc => Box::new(MinimalIntervention),
            Self::Tolerance { alpha } if (0.0..=1.0).contains(&alpha) => {
                Box::new(ConstantTolerance { alpha })
            }
            Self::Tolerance { alpha } => return Err(RuleError::Alpha(alpha)),
            Self::MiscR { kappa } if !(kappa.is_finite() && kappa >= 0.0) => {
                return Err(RuleError::Kappa(kappa));
            }
            Self::MiscR { .. } if !(median_range.is_finite() && median_range > 0.0) => {
                return Err(RuleError::MedianRange(median_range));
            }
            Self::MiscR { kappa } => Box::new(RegretThreshold { epsilon: kappa * median_range }),
        })
    }

    /// The word for it in options, files and tables.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Hic => "hic",
            Self::Robot => "robot",
            Self::Lasc => "lasc",
            Self::Misc => "misc",
            Self::Tolerance { .. } => "tolerance",
            Self::MiscR { .. } => "misc-r",
        }
    }
}

/// The person flies (HIC): what is asked is carried out; with no input nothing changes.
#[derive(Clone, Copy, Debug)]
pub struct HumanAlone;

impl Arbiter for HumanAlone {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        allowed.fill(true);
        if stage.likeness.is_some() { Pick::Asked } else { Pick::Nothing }
    }
}

/// The robot flies to the goal it infers, whatever is asked.
#[derive(Clone, Copy, Debug)]
pub struct RobotAlone;

impl Arbiter for RobotAlone {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        allowed[stage.values.best()] = true;
        Pick::Candidate(stage.values.best())
    }
}

/// Linear arbitration (LASC, Section IV): c · robot + (1 − c) · human. Where no fused action exists it is a switch:
/// the robot's if c > 0.5, otherwise the person's. c = 0: the person; c = 1: the robot.
#[derive(Clone, Copy, Debug)]
pub struct Linear;

impl Arbiter for Linear {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        allowed[stage.values.best()] = true;
        let robot = stage.values.best();
        if stage.likeness.is_some() {
            Pick::Blend { robot, weight: stage.confidence }
        } else {
            Pick::Candidate(robot)
        }
    }
}

/// Minimal intervention (MISC, Eqs. 3–4): among the actions with Q′(s, a) ≥ c · Q′(s, a_max) the most similar to what
/// was asked. c = 0: whatever was asked; c = 1: only a best action; all values equal: whatever was asked.
#[derive(Clone, Copy, Debug)]
pub struct MinimalIntervention;

impl Arbiter for MinimalIntervention {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        share_of_best(f64::from(stage.confidence), stage, allowed)
    }
}

/// Constant tolerance (Reddy et al. 2018): the same with Q′(s, a) ≥ (1 − α) · Q′(s, a_max), whatever the confidence.
/// α = 0: only a best action; α = 1: whatever was asked.
#[derive(Clone, Copy, Debug)]
pub struct ConstantTolerance {
    /// In [0, 1].
    pub alpha: f64,
}

impl Arbiter for ConstantTolerance {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        share_of_best(1.0 - self.alpha, stage, allowed)
    }
}

/// Minimal intervention with a regret threshold (MISC-R, ours): among the actions with max Q − Q(s, a) ≤ ε the most
/// similar to what was asked. It steps in only where a bad action costs something, which Q′ divides away. ε = 0: only a
/// best action; ε → ∞: whatever was asked.
#[derive(Clone, Copy, Debug)]
pub struct RegretThreshold {
    /// Regret allowed, in the values' units, at least 0: κ · median range.
    pub epsilon: f64,
}

impl Arbiter for RegretThreshold {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        most_alike_of(stage, allowed, |i| stage.values.regret(i) <= self.epsilon)
    }
}

fn share_of_best(share: f64, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
    let values = stage.values;
    let least = share * values.range();
    // At a share of 1 rounding must not let in an action that is a hair worse than the best.
    most_alike_of(stage, allowed, |i| {
        values.regret(i) == 0.0 || (share < 1.0 && values.above_worst(i) >= least)
    })
}

fn most_alike_of(stage: &Stage<'_>, allowed: &mut [bool], allows: impl Fn(usize) -> bool) -> Pick {
    for (i, allowed) in allowed.iter_mut().enumerate() {
        *allowed = allows(i);
    }
    Pick::Candidate(stage.most_alike(allowed))
}
