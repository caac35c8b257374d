//! Constant tolerance. Formula: of the a with Q′(s, a) ≥ (1 − α) · Q′(s, a_max) the most similar to a_h, whatever the
//! confidence. Source: Reddy, Dragan and Levine 2018, "Shared autonomy via deep reinforcement learning", Section 3.2. At
//! α = 0 only a best action, at α = 1 whatever is asked.

use super::choose::share_of_best;
use super::{Arbiter, Pick, Stage};

/// Constant tolerance (Reddy et al. 2018): Q′(s, a) ≥ (1 − α) · Q′(s, a_max), whatever the confidence.
#[derive(Clone, Copy, Debug)]
pub struct ConstantTolerance {
    /// In [0, 1].
    pub alpha: f64,
}

impl Arbiter for ConstantTolerance {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        share_of_best(1.0 - self.alpha, stage, allowed)
    }
}
