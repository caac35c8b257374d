//! Minimal intervention by regret (MISC-R). Formula: of the a with max Q − Q(s, a) ≤ κ · median range the most similar to
//! a_h. Source: ours; see `docs/arbitration.md`. At κ = 0 only a best action, as κ grows whatever is asked.

use super::choose::most_alike_of;
use super::{Arbiter, Pick, Stage};

/// Minimal intervention with a regret threshold (MISC-R, ours): among the actions with max Q − Q(s, a) ≤ ε the most
/// similar to what was asked. It steps in only where a bad action costs something, which Q′ divides away.
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
