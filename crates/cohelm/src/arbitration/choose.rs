//! What several rules do: allow some candidates, and take of them the one that is most like what was asked.

use super::{Pick, Stage};

impl Stage<'_> {
    /// Eq. 4 over the whole allowed set: the most alike, then the higher value, then the lower index. With nothing
    /// asked, or nothing allowed, the best candidate.
    pub fn most_alike(&self, allowed: &[bool]) -> usize {
        let Some(likeness) = self.likeness else { return self.values.best() };
        let better = |a: usize, b: usize| {
            let by_value = || self.values.values()[a] > self.values.values()[b];
            likeness[a] > likeness[b] || (likeness[a] == likeness[b] && by_value())
        };
        let candidates = (0..allowed.len()).filter(|&i| allowed[i]);
        candidates.reduce(|best, i| if better(i, best) { i } else { best }).unwrap_or(self.values.best())
    }
}

/// Of the candidates that `allows` lets in the one that is most like what was asked.
pub(super) fn most_alike_of(stage: &Stage<'_>, allowed: &mut [bool], allows: impl Fn(usize) -> bool) -> Pick {
    for (i, allowed) in allowed.iter_mut().enumerate() {
        *allowed = allows(i);
    }
    Pick::Candidate(stage.most_alike(allowed))
}

/// The same of those with Q′(s, a) ≥ share · Q′(s, a_max).
pub(super) fn share_of_best(share: f64, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
    let values = stage.values;
    let least = share * values.range();
    // At a share of 1 rounding must not let in an action that is a hair worse than the best.
    most_alike_of(stage, allowed, |i| {
        values.regret(i) == 0.0 || (share < 1.0 && values.above_worst(i) >= least)
    })
}
