//! The session as the page gets it, and what a simulated participant answers.

use super::VisitError;
use super::planned::Planned;
use cohelm_study::design::timeline::{ShownContent, ShownStep};
use cohelm_study::session::Status;
use serde::Deserialize;
use serde_json::{Value, json};

/// Where the participant is.
#[derive(Debug, Deserialize)]
pub(super) struct Place {
    pub status: Status,
    /// What remains, the current step first.
    pub steps: Vec<ShownStep>,
    pub participant: Who,
}

/// Who the participant is to the server.
#[derive(Debug, Deserialize)]
pub(super) struct Who {
    pub code: String,
    pub simulated: bool,
}

impl Place {
    pub fn read(json: Value) -> Result<Self, VisitError> {
        serde_json::from_value(json)
            .map_err(|error| VisitError::Unclear(format!("the session cannot be read: {error}")))
    }
}

/// What is posted for a step. Consent is given, since without it nothing more could be tried; what a person would be
/// asked stays unanswered.
pub(super) fn answer(content: &ShownContent) -> Value {
    match content {
        ShownContent::Consent { .. } => json!({ "agreed": true }),
        ShownContent::Device { .. } => json!({ "ok": true }),
        _ => json!({}),
    }
}

/// What is posted beside a flight. There is no display and no clock of its own, so that most of what a page measures is
/// not there to be measured.
pub(super) fn telemetry(flight: &Planned) -> Value {
    json!({ "ticks": flight.ticks(), "presses": flight.presses })
}
