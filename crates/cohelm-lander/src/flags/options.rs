//! The options of the flag task, as a record, a study file or a command line gives them.

use super::actions::ActionSet;
use super::layout::{MOST_PADS, PADS, widest};
use crate::craft::Settings;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What a landing at another pad than the pilot's does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Elsewhere {
    /// Ends the episode.
    #[default]
    End,
    /// Nothing: the flight goes on until it lands at the goal or fails, the paper's literal reading.
    Continue,
}

/// How the flag task is flown. What is left out has its default.
///
/// ```
/// use cohelm_lander::flags::FlagOptions;
/// let options: FlagOptions = serde_json::from_str(r#"{"elsewhere": "continue", "limit": 600}"#)?;
/// assert_eq!(options, FlagOptions { limit: 600, ..options });
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FlagOptions {
    /// Which actions there are: `switches` (default), `main-side`, `gymnasium` or `continuous`.
    pub actions: ActionSet,
    /// Whether landing elsewhere ends the episode: `end` (default) or `continue`.
    pub elsewhere: Elsewhere,
    /// Ticks after which the time is up; 1000 as in Gymnasium. Training uses 600, so that hovering fills less of its
    /// memory.
    pub limit: u32,
    /// Weight of the shaping reward, 0 to 10. 1 is Gymnasium's shaping over 100; 0.5 (default) trains more reliably
    /// without a teacher; 0 leaves only costs and endings, and then training mostly learns to hover.
    pub shaping: f64,
    /// How many pads there are, 1 to 4; 3 as in the paper. Four are at most 2.2 units wide, by their half.
    pub pads: u32,
    /// The tick from which on one of the pads is a goal that was none before; which one is drawn, and it is never what the
    /// pilot wants at first. Without it all pads are goals from the beginning.
    pub appears_at: Option<u32>,
    /// The tick from which on one of the goals is none any more, drawn from those that are there; whose goal it was wants
    /// another from then on, each as likely. Without it none vanishes.
    pub vanishes_at: Option<u32>,
    /// The first and the last tick, 90000 at most, between which the pilot changes its mind once, at a tick that is drawn:
    /// from then on it wants another of the goals of that moment, each as likely. Success is judged on the goal at the end.
    /// Without it the pilot knows what it wants.
    pub changes_mind: Option<[u32; 2]>,
    /// Half the width of a pad, 0.8 to 2.5 world units; 1.5 by default. The legs of a standing craft span about 1.8.
    pub pad_half_width: f64,
    /// Rounds of the velocity solver in a tick, 10 to 1000; 180 as in Gymnasium. 60 is about twice as fast, gives other bits
    /// and trains pilots that land as well with 180; below, contacts grow soft.
    pub velocity_iterations: u32,
    /// Rounds of the position solver in a tick, 1 to 1000; 60 as in Gymnasium, 20 with 60 velocity iterations.
    pub position_iterations: u32,
}

impl Default for FlagOptions {
    fn default() -> Self {
        Self {
            actions: ActionSet::default(),
            elsewhere: Elsewhere::default(),
            limit: 1000,
            shaping: 0.5,
            pads: PADS as u32,
            appears_at: None,
            vanishes_at: None,
            changes_mind: None,
            pad_half_width: 1.5,
            velocity_iterations: Settings::EXACT.velocity_iterations,
            position_iterations: Settings::EXACT.position_iterations,
        }
    }
}

/// Why options cannot be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OptionsError {
    /// Not an object at all.
    #[error("expected an object with options, got {got}; try {{}} for the defaults")]
    NoObject {
        /// What came.
        got: String,
    },
    /// An option that does not exist, or of the wrong kind.
    #[error("option {option:?} cannot be {got}: {reason}")]
    Option {
        /// Its name.
        option: String,
        /// What came.
        got: String,
        /// What was expected.
        reason: String,
    },
    /// A number that is too small or too large.
    #[error("expected option {option:?} from {least} to {most}, got {got}; try {usual}")]
    Range {
        /// Its name.
        option: &'static str,
        /// The smallest value it may have.
        least: f64,
        /// The largest value it may have.
        most: f64,
        /// What came.
        got: f64,
        /// Its default.
        usual: f64,
    },
    /// What Gymnasium's lander refuses.
    #[error(transparent)]
    Gymnasium(#[from] crate::gymnasium::OptionError),
}

impl FlagOptions {
    /// Reads and checks them.
    pub fn from_json(value: &Value) -> Result<Self, OptionsError> {
        let options: Self = read(value)?;
        options.check().map(|()| options)
    }

    /// The settings of the physics.
    pub fn settings(&self) -> Settings {
        Settings {
            velocity_iterations: self.velocity_iterations,
            position_iterations: self.position_iterations,
            ..Settings::EXACT
        }
    }

    pub(crate) fn check(&self) -> Result<(), OptionsError> {
        let usual = Self::default();
        in_range("limit", self.limit.into(), [1.0, MOST_TICKS], usual.limit.into())?;
        in_range("shaping", self.shaping, [0.0, 10.0], usual.shaping)?;
        in_range("pad_half_width", self.pad_half_width, [0.8, 2.5], usual.pad_half_width)?;
        self.check_pads()?;
        self.check_mind()?;
        iterations_in_range(&self.settings())
    }

    fn check_pads(&self) -> Result<(), OptionsError> {
        let Self { pads, appears_at, vanishes_at, .. } = *self;
        in_range("pads", pads.into(), [1.0, MOST_PADS as f64], PADS as f64)?;
        in_range("pad_half_width", self.pad_half_width, [0.8, f64::min(2.5, widest(pads as usize))], 1.5)?;
        let late = appears_at.is_some_and(|appears| vanishes_at.is_none_or(|vanishes| appears > vanishes));
        let needed = 1 + u32::from(appears_at.is_some())
            .max(u32::from(vanishes_at.is_some()) + u32::from(late && vanishes_at.is_some()));
        if pads < needed {
            let reason = format!("one goal has to be left at every tick, which takes {needed} pads");
            let option = if appears_at.is_some() { "appears_at" } else { "vanishes_at" };
            return Err(OptionsError::Option {
                option: option.into(),
                got: format!("given with {pads} pads"),
                reason,
            });
        }
        Ok(())
    }

    fn check_mind(&self) -> Result<(), OptionsError> {
        let Some([from, to]) = self.changes_mind else { return Ok(()) };
        let reason = if from > to {
            "the first tick must not come after the last; try [40, 120]".into()
        } else if f64::from(to) > MOST_TICKS {
            format!("no episode is longer than {MOST_TICKS} ticks; try [40, 120]")
        } else {
            return Ok(());
        };
        Err(OptionsError::Option { option: "changes_mind".into(), got: format!("[{from}, {to}]"), reason })
    }
}

/// The longest episode that may be asked for: half an hour at 50 ticks a second.
pub(crate) const MOST_TICKS: f64 = 90_000.0;

/// Refuses numbers of solver rounds that make no sense.
pub(crate) fn iterations_in_range(settings: &Settings) -> Result<(), OptionsError> {
    let Settings { velocity_iterations, position_iterations, .. } = *settings;
    let usual = Settings::EXACT;
    in_range(
        "velocity_iterations",
        velocity_iterations.into(),
        [10.0, 1000.0],
        usual.velocity_iterations.into(),
    )?;
    in_range(
        "position_iterations",
        position_iterations.into(),
        [1.0, 1000.0],
        usual.position_iterations.into(),
    )
}

/// Refuses a number outside of its bounds (and one that is none).
pub(crate) fn in_range(
    option: &'static str,
    got: f64,
    [least, most]: [f64; 2],
    usual: f64,
) -> Result<(), OptionsError> {
    if (least..=most).contains(&got) {
        Ok(())
    } else {
        Err(OptionsError::Range { option, least, most, got, usual })
    }
}

/// Reads options whose every field has a default, and says which one is wrong.
pub(crate) fn read<T: DeserializeOwned>(value: &Value) -> Result<T, OptionsError> {
    let Value::Object(fields) = value else { return Err(OptionsError::NoObject { got: value.to_string() }) };
    for (option, got) in fields {
        let alone = Value::Object([(option.clone(), got.clone())].into_iter().collect());
        if let Err(error) = T::deserialize(&alone) {
            return Err(OptionsError::Option {
                option: option.clone(),
                got: got.to_string(),
                reason: error.to_string(),
            });
        }
    }
    T::deserialize(value).map_err(|error| OptionsError::NoObject { got: error.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    fn refusal(value: Value) -> String {
        FlagOptions::from_json(&value).expect_err("must be refused").to_string()
    }

    #[test]
    fn no_options_are_the_defaults_and_defaults_survive_json() {
        assert_eq!(FlagOptions::from_json(&json!({})), Ok(FlagOptions::default()));
        let written = serde_json::to_value(FlagOptions::default()).expect("plain data");
        assert_eq!(FlagOptions::from_json(&written), Ok(FlagOptions::default()));
    }

    #[test]
    fn a_refusal_says_what_was_expected_what_came_and_what_to_try() {
        for (value, words) in [
            (json!([]), ["expected an object", "got []", "try {}"]),
            (json!({"colour": 1}), ["\"colour\"", "1", "expected one of `actions`"]),
            (json!({"actions": "joystick"}), ["\"actions\"", "joystick", "`main-side`"]),
            (json!({"limit": 1.5}), ["\"limit\"", "1.5", "expected u32"]),
            (json!({"limit": 0}), ["from 1 to 90000", "got 0", "try 1000"]),
            (json!({"shaping": -1.0}), ["\"shaping\" from 0", "got -1", "try 0.5"]),
            (json!({"pad_half_width": 4}), ["to 2.5", "got 4", "try 1.5"]),
            (json!({"pad_half_width": 2.3, "pads": 4}), ["to 2.2", "got 2.3", "try 1.5"]),
            (json!({"pads": 9}), ["from 1 to 4", "got 9", "try 3"]),
            (json!({"pads": 1, "vanishes_at": 9}), ["\"vanishes_at\"", "with 1 pads", "takes 2 pads"]),
            (json!({"pads": 2, "vanishes_at": 9, "appears_at": 20}), ["\"appears_at\"", "2 pads", "3 pads"]),
            (json!({"changes_mind": [9, 5]}), ["\"changes_mind\"", "[9, 5]", "try [40, 120]"]),
            (
                json!({"changes_mind": [0, u32::MAX]}),
                ["\"changes_mind\"", "[0, 4294967295]", "90000 ticks; try [40, 120]"],
            ),
            (
                json!({"changes_mind": [0, 90_001]}),
                ["\"changes_mind\"", "[0, 90001]", "longer than 90000 ticks"],
            ),
            (json!({"velocity_iterations": 0}), ["from 10", "got 0", "try 180"]),
        ] {
            let message = refusal(value);
            for word in words {
                assert!(message.contains(word), "{message:?} lacks {word:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn whatever_json_comes_is_read_or_refused(text in ".{0,40}", key in "[a-z_]{0,20}", number in any::<f64>()) {
            for value in [json!(text), json!({key.as_str(): text}), json!({key.as_str(): number}), json!({"shaping": number})] {
                if let Ok(options) = FlagOptions::from_json(&value) {
                    prop_assert!((0.0..=10.0).contains(&options.shaping));
                }
            }
        }
    }
}
