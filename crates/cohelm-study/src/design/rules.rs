//! What is declared in advance: the primary outcome, who is left out and why, and where participants come from.

use super::{Item, Words};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The one outcome that the study is about.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Primary {
    /// The measure: a column of the data, such as "success", or a score, such as "nasa-tlx/overall".
    pub measure: String,
    /// The conditions that are compared, at least two. Default: all that have the measure.
    #[serde(default)]
    pub conditions: Vec<String>,
    /// What is expected, in a sentence; the report quotes it.
    pub hypothesis: Option<String>,
    /// Largest probability of an error of the first kind, 0.001 to 0.2. Default: 0.05.
    #[serde(default = "one_in_twenty")]
    pub alpha: f64,
}

/// What shows whether a participant attends.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", default, deny_unknown_fields)]
pub struct Attention {
    /// Items with a given answer ("choose 7 here"), each put into a questionnaire.
    pub checks: Vec<AttentionCheck>,
    /// Seconds that the page may be hidden during a flight before the flight counts as flown without attention.
    /// Default: no limit.
    pub hidden_at_most_s: Option<f64>,
}

/// An item whose answer the text gives.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct AttentionCheck {
    /// Into which questionnaire it is put, as its last item but one.
    pub questionnaire: String,
    /// The item; a scale, a choice or a number.
    pub item: Item,
    /// The answer that shows attention: a point of the scale, or the value of a choice.
    pub right: RightAnswer,
}

/// The answer that an attention check asks for.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(untagged, expecting = "expected a number, or the value of a choice")]
pub enum RightAnswer {
    /// A point of a scale.
    Number(f64),
    /// The value of a choice.
    Value(String),
}

/// Who is left out of the confirmatory analysis. A participant who breaks any of these is left out; one who did not
/// finish, withdrew, tested or was simulated is in no analysis anyway.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", default, deny_unknown_fields)]
pub struct ExclusionRules {
    /// Left out if more attention checks failed than this. Default: no rule.
    pub failed_checks_over: Option<u32>,
    /// Left out if more than this share of the ticks of their measured flights came late, 0 to 1. Default: no rule.
    pub late_ticks_over: Option<f64>,
    /// Left out if more than this share of their measured flights was flown without attention, 0 to 1. Default: no rule.
    pub inattentive_flights_over: Option<f64>,
    /// Left out if more of their measured flights than this were interrupted. Default: no rule.
    pub interrupted_flights_over: Option<u32>,
    /// Left out if more than this share of their measured flights was flown without a single key, 0 to 1; not applied to
    /// conditions under rule robot. Default: no rule.
    pub silent_flights_over: Option<f64>,
    /// Left out if the quiz was still wrong at its last attempt. Default: false.
    pub failed_quiz: bool,
    /// What happens when a device cannot keep the plant's rate of ticks. Default: warn.
    pub slow_device: OnSlowDevice,
}

/// What happens when the last attempt at the quiz failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OnFailedQuiz {
    /// The right answers are explained by the hints, and the participant goes on; it is recorded.
    #[default]
    GoOn,
    /// The study ends for the participant, who is excluded and thanked.
    Exclude,
}

/// What happens when a device cannot keep the plant's rate of ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OnSlowDevice {
    /// The participant is told so and may go on; it is recorded.
    #[default]
    Warn,
    /// The participant is told so and cannot go on with this device.
    Refuse,
}

/// The panel that sends participants and takes them back.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Panel {
    /// Parameters of the address by which participants come that are stored, such as ["PROLIFIC_PID", "STUDY_ID",
    /// "SESSION_ID"].
    pub parameters: Vec<String>,
    /// The one of them that tells participants apart: who comes again with the same value goes on where they were.
    pub participant: String,
    /// Where participants go at the end; {code} and {NAME} of a parameter are filled in.
    pub completed: Option<String>,
    /// Where they go who did not consent.
    pub declined: Option<String>,
    /// Where they go whom the design excluded on the way, as by the quiz.
    pub screened_out: Option<String>,
    /// What the button that leads there says. Default: "Back to the panel".
    #[serde(default)]
    pub button: Words,
}

fn one_in_twenty() -> f64 {
    0.05
}
