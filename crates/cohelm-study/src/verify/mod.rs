//! Holding our numbers against recordings of other people's libraries.

mod lenient_json;
mod recording;

pub use recording::{Difference, Report, VerifyError, statistics};
