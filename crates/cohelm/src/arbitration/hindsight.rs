//! Hindsight optimisation, QMDP over the goals. Formula: a = argmax Σ_g p(g) · Q_g(s, a) + `likeness` · median range ·
//! f(a, a_h). Source: Javdani, Srinivasa and Bagnell 2015, "Shared autonomy via hindsight optimization"; the second term
//! stands for their cost of departing from what the person does. At `likeness` = 0 it is plain QMDP, to which what is asked
//! matters only through the belief, and so it is with nothing asked; as it grows, something as similar as can be to what is
//! asked is carried out.

use super::{Arbiter, Needs, Pick, Stage};

/// The best action on average over the goals, as if the goal were known at the next tick, and the more like what is asked
/// the dearer departing from it is made.
#[derive(Clone, Copy, Debug)]
pub struct Hindsight {
    /// What a unit of similarity to what is asked is worth, in the values' units, at least 0.
    pub worth_of_likeness: f64,
}

impl Hindsight {
    fn score(&self, stage: &Stage<'_>, candidate: usize) -> f64 {
        let likeness = stage.likeness.map_or(0.0, |likeness| likeness[candidate].similarity.into());
        stage.expected_value(candidate) + self.worth_of_likeness * likeness
    }
}

impl Arbiter for Hindsight {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        // Ties go to what is most like what is asked, so that equal values let the person through.
        let mut highest = f64::NEG_INFINITY;
        for candidate in 0..allowed.len() {
            highest = highest.max(self.score(stage, candidate));
        }
        for (candidate, allowed) in allowed.iter_mut().enumerate() {
            *allowed = self.score(stage, candidate) == highest;
        }
        let alike = stage.likeness.map(|_| stage.most_alike(allowed));
        let first = || allowed.iter().position(|&allowed| allowed);
        Pick::Candidate(alike.or_else(first).unwrap_or(stage.values.best()))
    }

    fn needs(&self) -> Needs {
        Needs { every_goal: true, ..Needs::default() }
    }
}
