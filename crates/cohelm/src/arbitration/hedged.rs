//! Minimal intervention by hedged regret (MISC-H). Formula: of the a with max E − E(a) ≤ k · median range the most similar to
//! a_h, where E(a) = Σ_g p(g) · Q_g(s, a), and k is κ while the person has their way and `release` · κ at the tick after an
//! intervention. Source: ours; `docs/compare.md` has what it brings. At κ = 0 only an action that is best on average over
//! the goals, as κ grows whatever is asked; at `release` = 1 without hysteresis, with one goal that is MISC-R.

use super::choose::most_alike_of;
use super::{Arbiter, Needs, Pick, Stage};

/// MISC-R with two changes: what is good for another goal that is still likely costs less, and who has been corrected is
/// not let go before the command is clearly good again.
///
/// With nothing asked the robot flies to the likeliest goal, not to the average of several, between which it would hover.
#[derive(Clone, Copy, Debug)]
pub struct HedgedRegret {
    /// Regret allowed, in the values' units, at least 0: κ · median range.
    pub epsilon: f64,
    /// Share of it that is allowed at the tick after an intervention, in [0, 1]; less holds on longer.
    pub release: f64,
}

impl Arbiter for HedgedRegret {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        let best = (0..allowed.len()).map(|i| stage.expected_value(i)).fold(f64::NEG_INFINITY, f64::max);
        let intervened = stage.last.is_some_and(|last| last.intervened);
        let most = if intervened { self.release * self.epsilon } else { self.epsilon };
        let flown = stage.likeness.is_none().then(|| stage.values.best());
        most_alike_of(stage, allowed, |i| {
            flown.map_or(best - stage.expected_value(i) <= most, |flown| i == flown)
        })
    }

    fn needs(&self) -> Needs {
        Needs { every_goal: true, ..Needs::default() }
    }
}
