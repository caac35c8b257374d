//! The bench of rules: every rule, tuned by at most nine settings on the same episodes, flown by simulated people of kinds and
//! seeds that tuning never saw.
//!
//! Success alone is no merit: the robot alone has most of it. So that success is read against how much of what the person
//! asked was replaced, with the line of constant tolerances (Reddy et al. 2018), which anybody can draw by one
//! number, as what a rule has to beat. What loses is said by the same numbers as what wins.

mod bench;
mod curve;
mod held_out;
mod report;
mod settings;
mod stand;
#[cfg(test)]
mod tests;
mod tuning;

pub use bench::{Bench, Budget, Compared, Comparison, Entered};
pub use curve::{Against, Curve, Margin};
pub use held_out::{Draw, HeldOut};
pub use report::{Making, document, files};
pub use settings::{SETTINGS, Setting, contenders, robots, tolerances};
pub use stand::{MEASURES, Stand};
pub use tuning::{Tried, WEIGHT_OF_REPLACED};

use crate::experiment::ExperimentError;
use cohelm_study::export::ExportError;
use cohelm_study::figures::FigureError;
use cohelm_study::statistics::Undefined;

/// Why there is no comparison.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// The flights cannot be flown.
    #[error(transparent)]
    Flights(#[from] ExperimentError),
    /// A number has no interval: too few participants.
    #[error("an interval over participants cannot be had: {0}")]
    Statistics(#[from] Undefined),
    /// A figure cannot be drawn.
    #[error("the figure cannot be drawn: {0}")]
    Figure(#[from] FigureError),
    /// A table cannot be written.
    #[error("a table cannot be written: {0}")]
    Table(#[from] ExportError),
    /// No plant to compare on.
    #[error(
        "no plant here has a simulated person, values and an intent model for the same actions; name models with --model"
    )]
    NoBench,
}
