//! What several rules do: allow some candidates, and take of them the one that is most like what was asked.

use super::{Pick, Stage};

impl Stage<'_> {
    /// Eq. 4 over the whole allowed set: the most alike, then the higher value, then the lower index. With nothing
    /// asked, or nothing allowed, the best candidate.
    pub fn most_alike(&self, allowed: &[bool]) -> usize {
        self.most_alike_where(|i| allowed[i]).unwrap_or(self.values.best())
    }

    /// The same over the candidates that are not left out; `None` if nothing is asked or all are.
    pub fn most_alike_but(&self, left_out: &[bool]) -> Option<usize> {
        self.most_alike_where(|i| !left_out[i])
    }

    /// The candidate that is what was asked, or the most like it; `None` if nothing is asked.
    pub fn candidate_asked(&self) -> Option<usize> {
        self.most_alike_where(|_| true)
    }

    /// Σ_g p(g) · Q_g(s, a) of a candidate; Q(s, a) for the inferred goal where no values for every goal are at hand, or
    /// the belief is about other goals.
    pub fn expected_value(&self, candidate: usize) -> f64 {
        let probabilities = self.belief.probabilities();
        match self.of_goals {
            Some(of_goals) if of_goals.goals() == probabilities.len() => {
                let weighed =
                    |(goal, &p): (usize, &f32)| f64::from(p) * f64::from(of_goals.of(goal)[candidate]);
                probabilities.iter().enumerate().map(weighed).sum()
            }
            _ => self.values.values()[candidate].into(),
        }
    }

    fn most_alike_where(&self, counts: impl Fn(usize) -> bool) -> Option<usize> {
        let likeness = self.likeness?;
        let better = |a: usize, b: usize| {
            let by_value = || self.values.values()[a] > self.values.values()[b];
            likeness[a] > likeness[b] || (likeness[a] == likeness[b] && by_value())
        };
        let candidates = (0..likeness.len()).filter(|&i| counts(i));
        candidates.reduce(|best, i| if better(i, best) { i } else { best })
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
