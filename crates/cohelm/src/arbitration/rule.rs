//! A rule by its name, with its parameters.

use super::{
    ActIfBetter, Arbiter, ConstantTolerance, HedgedRegret, Hindsight, HumanAlone, LineGraph, Linear,
    MinimalIntervention, RegretThreshold, RobotAlone, SafeNearest, Threshold,
};
use core::fmt;
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
    /// Line-graph blend: [`LineGraph`].
    LineGraph {
        /// Confidence up to which the person alone flies.
        start: f64,
        /// Confidence from which the robot has its largest weight.
        full: f64,
        /// The robot's largest weight.
        most: f64,
    },
    /// Take over above a confidence: [`Threshold`].
    Threshold {
        /// The confidence.
        confidence: f64,
    },
    /// QMDP over the goals: [`Hindsight`].
    Hindsight {
        /// What a unit of similarity to what is asked is worth, in median ranges of the values; 0 is plain QMDP.
        likeness: f64,
    },
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
    /// MISC-R, hedged over the goals and with hysteresis: [`HedgedRegret`].
    MiscH {
        /// Regret allowed, in median ranges of the values.
        kappa: f64,
        /// Share of it allowed at the tick after an intervention.
        release: f64,
    },
    /// Act only if better for every goal: [`ActIfBetter`].
    Ida,
    /// The nearest action that flights ahead find safe: [`SafeNearest`].
    SafeNearest {
        /// Ticks for which an action is thought to be held.
        hold: u32,
        /// Ticks flown ahead.
        horizon: u32,
    },
}

/// The regret that MISC-R allows unless told otherwise: smaller corrects more, larger lets more through.
pub const DEFAULT_KAPPA: f64 = 0.7;

/// Most ticks that a rule may fly ahead: ten seconds at 50 Hz, beyond which a tick of the loop would last too long.
pub const MOST_AHEAD: u32 = 500;

/// Why a rule cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RuleError {
    /// No rule of that name.
    #[error("no rule is called {name:?}; there are: {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// The words there are.
        known: String,
    },
    /// The rule has no such parameter.
    #[error("the rule {rule} has no {name}{}", if .known.is_empty() { "; it has no parameters".into() } else { format!("; it has: {}", .known) })]
    NoParameter {
        /// The rule's word.
        rule: &'static str,
        /// What was given.
        name: String,
        /// The parameters it has.
        known: String,
    },
    /// α outside [0, 1].
    #[error("the tolerance α must lie in [0, 1] (0: only a best action, 1: every action), got {0}")]
    Alpha(f64),
    /// κ negative or not finite.
    #[error(
        "the regret κ must be a finite number of at least 0 (usual: 0.5 to 1.5 for commands, 0.1 to 0.5 for axes), got {0}"
    )]
    Kappa(f64),
    /// Another parameter is out of its range.
    #[error("the parameter {name} of rule {rule} must be {expected}, got {got}")]
    Parameter {
        /// The rule's word.
        rule: &'static str,
        /// The parameter.
        name: &'static str,
        /// Its range, in words.
        expected: &'static str,
        /// What came.
        got: f64,
    },
    /// The value model does not say how large its ranges are.
    #[error(
        "{rule} needs the median range of the values from the model's card, a positive number; got {got}"
    )]
    MedianRange {
        /// The rule's word.
        rule: &'static str,
        /// What came.
        got: f64,
    },
}

impl Rule {
    /// Every rule with its usual parameters, in the order of tables.
    pub const USUAL: [Self; 12] = [
        Self::Hic,
        Self::Robot,
        Self::Lasc,
        Self::LineGraph { start: 0.2, full: 0.8, most: 1.0 },
        Self::Threshold { confidence: 0.6 },
        Self::Hindsight { likeness: 0.0 },
        Self::Misc,
        Self::Tolerance { alpha: 0.4 },
        Self::MiscR { kappa: DEFAULT_KAPPA },
        Self::MiscH { kappa: 1.25, release: 0.5 },
        Self::Ida,
        Self::SafeNearest { hold: 10, horizon: 80 },
    ];

    /// The rule of that word with its usual parameters.
    pub fn named(word: &str) -> Result<Self, RuleError> {
        Self::USUAL.into_iter().find(|rule| rule.word() == word).ok_or_else(|| RuleError::Unknown {
            name: word.into(),
            known: Self::USUAL.map(|rule| rule.word()).join(", "),
        })
    }

    /// The rule, ready to decide. `median_range` is the median over states of max Q − min Q from the value model's
    /// card; only rules that measure in it ask for it.
    pub fn arbiter(&self, median_range: f64) -> Result<Box<dyn Arbiter>, RuleError> {
        self.check(median_range)?;
        Ok(match *self {
            Self::Hic => Box::new(HumanAlone),
            Self::Robot => Box::new(RobotAlone),
            Self::Lasc => Box::new(Linear),
            Self::LineGraph { start, full, most } => Box::new(LineGraph { start, full, most }),
            Self::Threshold { confidence } => Box::new(Threshold { confidence }),
            Self::Hindsight { likeness: 0.0 } => Box::new(Hindsight { worth_of_likeness: 0.0 }),
            Self::Hindsight { likeness } => {
                Box::new(Hindsight { worth_of_likeness: likeness * median_range })
            }
            Self::Misc => Box::new(MinimalIntervention),
            Self::Tolerance { alpha } => Box::new(ConstantTolerance { alpha }),
            Self::MiscR { kappa } => Box::new(RegretThreshold { epsilon: kappa * median_range }),
            Self::MiscH { kappa, release } => {
                Box::new(HedgedRegret { epsilon: kappa * median_range, release })
            }
            Self::Ida => Box::new(ActIfBetter),
            Self::SafeNearest { hold, horizon } => Box::new(SafeNearest { hold, horizon }),
        })
    }

    /// The word for it in options, files and tables.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Hic => "hic",
            Self::Robot => "robot",
            Self::Lasc => "lasc",
            Self::LineGraph { .. } => "line-graph",
            Self::Threshold { .. } => "threshold",
            Self::Hindsight { .. } => "hindsight",
            Self::Misc => "misc",
            Self::Tolerance { .. } => "tolerance",
            Self::MiscR { .. } => "misc-r",
            Self::MiscH { .. } => "misc-h",
            Self::Ida => "ida",
            Self::SafeNearest { .. } => "safe-nearest",
        }
    }

    /// Its parameters by name, in the order of tables.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Hic | Self::Robot | Self::Lasc | Self::Misc | Self::Ida => vec![],
            Self::LineGraph { start, full, most } => vec![("start", start), ("full", full), ("most", most)],
            Self::Threshold { confidence } => vec![("confidence", confidence)],
            Self::Hindsight { likeness } => vec![("likeness", likeness)],
            Self::Tolerance { alpha } => vec![("alpha", alpha)],
            Self::MiscR { kappa } => vec![("kappa", kappa)],
            Self::MiscH { kappa, release } => vec![("kappa", kappa), ("release", release)],
            Self::SafeNearest { hold, horizon } => {
                vec![("hold", hold.into()), ("horizon", horizon.into())]
            }
        }
    }

    /// The same rule with one parameter set.
    pub fn with(mut self, name: &str, value: f64) -> Result<Self, RuleError> {
        match (&mut self, name) {
            (Self::LineGraph { start, .. }, "start") => *start = value,
            (Self::LineGraph { full, .. }, "full") => *full = value,
            (Self::LineGraph { most, .. }, "most") => *most = value,
            (Self::Threshold { confidence }, "confidence") => *confidence = value,
            (Self::Hindsight { likeness }, "likeness") => *likeness = value,
            (Self::Tolerance { alpha }, "alpha") => *alpha = value,
            (Self::MiscR { kappa } | Self::MiscH { kappa, .. }, "kappa") => *kappa = value,
            (Self::MiscH { release, .. }, "release") => *release = value,
            (Self::SafeNearest { hold, .. }, "hold") => *hold = ticks("safe-nearest", "hold", value)?,
            (Self::SafeNearest { horizon, .. }, "horizon") => {
                *horizon = ticks("safe-nearest", "horizon", value)?;
            }
            _ => return Err(self.no_parameter(name)),
        }
        Ok(self)
    }

    fn no_parameter(&self, name: &str) -> RuleError {
        let known: Vec<&str> = self.parameters().into_iter().map(|(name, _)| name).collect();
        RuleError::NoParameter { rule: self.word(), name: name.into(), known: known.join(", ") }
    }

    fn check(&self, median_range: f64) -> Result<(), RuleError> {
        let rule = self.word();
        let wrong = |name, expected, got| Err(RuleError::Parameter { rule, name, expected, got });
        let share = |name, value: f64| match (0.0..=1.0).contains(&value) {
            true => Ok(()),
            false => wrong(name, "a number in [0, 1]", value),
        };
        match *self {
            Self::Tolerance { alpha } if !(0.0..=1.0).contains(&alpha) => Err(RuleError::Alpha(alpha)),
            Self::MiscR { kappa } | Self::MiscH { kappa, .. } if !(kappa.is_finite() && kappa >= 0.0) => {
                Err(RuleError::Kappa(kappa))
            }
            Self::MiscH { release, .. } => {
                share("release", release)?;
                positive(rule, median_range)
            }
            Self::LineGraph { start, full, most } => {
                share("start", start)?;
                share("full", full)?;
                share("most", most)?;
                if full < start { wrong("full", "at least as large as start", full) } else { Ok(()) }
            }
            Self::Threshold { confidence } => share("confidence", confidence),
            Self::Hindsight { likeness } if !(likeness.is_finite() && likeness >= 0.0) => {
                wrong("likeness", "a finite number of at least 0 (usual: 0 to 2)", likeness)
            }
            Self::SafeNearest { hold, .. } if hold > MOST_AHEAD => wrong("hold", AHEAD, hold.into()),
            Self::SafeNearest { horizon, .. } if horizon > MOST_AHEAD => {
                wrong("horizon", AHEAD, horizon.into())
            }
            Self::MiscR { .. } => positive(rule, median_range),
            Self::Hindsight { likeness } if likeness > 0.0 => positive(rule, median_range),
            _ => Ok(()),
        }
    }
}

/// The range of a number of ticks, in words.
const AHEAD: &str = "a whole number of ticks from 0 to 500";

fn ticks(rule: &'static str, name: &'static str, value: f64) -> Result<u32, RuleError> {
    if (0.0..=f64::from(MOST_AHEAD)).contains(&value) && libm::floor(value) == value {
        Ok(value as u32)
    } else {
        Err(RuleError::Parameter { rule, name, expected: AHEAD, got: value })
    }
}

fn positive(rule: &'static str, median_range: f64) -> Result<(), RuleError> {
    if median_range.is_finite() && median_range > 0.0 {
        Ok(())
    } else {
        Err(RuleError::MedianRange { rule, got: median_range })
    }
}

/// A few words for people: `constant tolerance, α = 0.6`.
impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hic => write!(f, "human alone"),
            Self::Robot => write!(f, "robot alone"),
            Self::Lasc => write!(f, "linear arbitration"),
            Self::LineGraph { start, full, most } => {
                write!(f, "line-graph blend from {start} to {full}, at most {most}")
            }
            Self::Threshold { confidence } => write!(f, "take over above c = {confidence}"),
            Self::Hindsight { likeness } => write!(f, "hindsight optimisation, likeness worth {likeness}"),
            Self::Misc => write!(f, "minimal intervention"),
            Self::Tolerance { alpha } => write!(f, "constant tolerance, α = {alpha}"),
            Self::MiscR { kappa } => write!(f, "minimal intervention by regret, κ = {kappa}"),
            Self::MiscH { kappa, release } => {
                write!(f, "minimal intervention by hedged regret, κ = {kappa}, released at {release} of it")
            }
            Self::Ida => write!(f, "act only if better for every goal"),
            Self::SafeNearest { hold, horizon } => {
                write!(f, "safe-nearest, held {hold} of {horizon} ticks ahead")
            }
        }
    }
}
