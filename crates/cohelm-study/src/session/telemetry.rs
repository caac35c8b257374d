//! What the page measures beside a flight.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What the page measures beside a flight. Everything may be missing; what is not named here is kept in the log.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Telemetry {
    /// Ticks that began more than half a tick late.
    pub late_ticks: Option<u32>,
    /// Pictures that were left out.
    pub dropped_frames: Option<u32>,
    /// How long the page was hidden meanwhile.
    pub hidden_ms: Option<f64>,
    /// Key and button presses; sticks count once when they leave their rest.
    pub presses: Option<u32>,
    /// The page's clock minus the server's.
    pub clock_offset_ms: Option<f64>,
    /// From a key to the tick that acts on it, median.
    pub latency_ms: Option<f64>,
}

impl Telemetry {
    /// What can be read of it; a field of the wrong type counts as missing, since no flight is lost over its telemetry.
    pub fn read(value: &Value) -> Self {
        let number = |key: &str| value.get(key).and_then(Value::as_f64).filter(|number| number.is_finite());
        let count =
            |key: &str| number(key).filter(|number| (0.0..4e9).contains(number)).map(|number| number as u32);
        Self {
            late_ticks: count("late_ticks"),
            dropped_frames: count("dropped_frames"),
            hidden_ms: number("hidden_ms"),
            presses: count("presses"),
            clock_offset_ms: number("clock_offset_ms"),
            latency_ms: number("latency_ms"),
        }
    }
}
