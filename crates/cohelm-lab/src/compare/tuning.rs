//! Which setting a rule enters with: the best of those it may try, by one number, on people and seeds of their own.

use super::Setting;
use super::stand::Stand;
use serde::Serialize;

/// What replacing all that is asked costs in success when settings are chosen: success − ½ · replaced. At 0 every rule would be
/// tuned towards the robot alone, at 1 towards the person alone.
pub const WEIGHT_OF_REPLACED: f64 = 0.5;

/// A setting that was tried, and how it did.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// The setting.
    pub setting: Setting,
    /// Success rate among those who were flown in tuning.
    pub success: f64,
    /// How much of what was asked was replaced.
    pub replaced: f64,
    /// Success − ½ · replaced.
    pub score: f64,
}

impl Tried {
    pub(super) fn of(stand: &Stand) -> Self {
        let (success, replaced) = (stand.mean("success"), stand.mean("replaced"));
        let score = success - WEIGHT_OF_REPLACED * replaced;
        Self { setting: stand.setting, success, replaced, score }
    }
}

/// Index of the best; the first of equals.
pub(super) fn best(tried: &[Tried]) -> usize {
    (1..tried.len()).fold(0, |best, i| if tried[i].score > tried[best].score { i } else { best })
}
