//! Minimal intervention (MISC). Formula: of the a with Q′(s, a) ≥ c · Q′(s, a_max) the most similar to a_h, where Q′ is Q
//! minus its minimum. Source: the paper, Eqs. 3 and 4. At c = 0 whatever is asked, at c = 1 only a best action; all
//! values equal: whatever is asked.

use super::choose::share_of_best;
use super::{Arbiter, Pick, Stage};

/// Minimal intervention (MISC, Eqs. 3–4): among the actions with Q′(s, a) ≥ c · Q′(s, a_max) the most similar to what
/// was asked.
#[derive(Clone, Copy, Debug)]
pub struct MinimalIntervention;

impl Arbiter for MinimalIntervention {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        share_of_best(f64::from(stage.confidence()), stage, allowed)
    }
}
