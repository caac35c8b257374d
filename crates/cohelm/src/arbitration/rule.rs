//! A rule by its name, with its parameters.

use super::{
    Arbiter, ConstantTolerance, HumanAlone, Linear, MinimalIntervention, RegretThreshold, RobotAlone,
};
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
