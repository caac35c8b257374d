//! Which goal explains best what is asked: inference by the values of every goal.
//!
//! The pilot is taken to choose nearly rationally for its goal (Boltzmann-rational; Dragan & Srinivasa 2013, Javdani et
//! al. 2015, 2018): p(a | s, g) ∝ exp(β (Q_g(s, a) − max Q_g)), β counted in the values' median range. At every decision of
//! the pilot the belief is multiplied by that likelihood, raised to a weight. A decision is a tick at which something else
//! is asked than at the tick before: a key that is held for ten ticks is one and not ten. (With every tick counted, the
//! belief in the pilot's own goal was worse than none: the surprise rose above that of a uniform one.) At every tick a
//! little of the belief is spread over all goals: the pilot may have changed its mind.
//!
//! Only effects count: commands that would leave the plant set alike are one action with the best of their values. A
//! silent tick says nothing: under a rule that helps, silence would otherwise count as consent to whatever the co-pilot
//! does. A goal that appears gets the share 1/n; one that vanishes leaves its mass to the others.

use super::{Belief, IntentModel, MAX_GOALS};
use crate::action::{Action, ActionSpace, Effect};
use crate::plant::{Goal, View};
use crate::value::ValueModel;

/// How much what is asked says about the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// β: how surely the better action is chosen, where actions differ by the values' median range. 0: what is asked says
    /// nothing. Beyond 5 one wrong key outweighs a second of flight.
    pub rationality: f64,
    /// Power to which a decision's likelihood is raised, from 0 to 1. 1: decisions depend on nothing but state and goal,
    /// and one slip of a finger counts in full. Low: slow to believe anything.
    pub weight: f64,
    /// Probability, a tick, that the pilot wants another goal from now on, above 0 and at most 1. Low: a changed mind is
    /// noticed late. High: nothing is ever known for long.
    pub change: f64,
}

impl Default for Evidence {
    /// Chosen on simulated pilots for training, by the surprise (−ln p) at the pilot's goal; see `docs/intent.md`.
    fn default() -> Self {
        Self { rationality: 2.0, weight: 0.1, change: 0.005 }
    }
}

/// Why there is no inference by values.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum EvidenceError {
    /// A parameter is out of its range.
    #[error("{what} must be {range}, got {got}")]
    Parameter {
        /// Which.
        what: &'static str,
        /// What it may be.
        range: &'static str,
        /// What came.
        got: f64,
    },
    /// The scale of the values is not known.
    #[error(
        "inference by values needs their median range, got {0}; take values with a card that has it, or another inference"
    )]
    NoScale(f64),
}

/// Infers the goal from the values of what is asked.
pub struct ValueIntent {
    values: Box<dyn ValueModel>,
    space: ActionSpace,
    per_unit: f64,
    evidence: Evidence,
    posterior: Posterior,
    candidates: Vec<Action>,
    of_goal: Vec<f32>,
    before: Option<Action>,
}

impl ValueIntent {
    /// From values of its own (those of the cockpit are asked for one goal only) over a plant's actions. `median_range` is
    /// the values' usual max Q − min Q, the unit in which β counts.
    pub fn new(
        values: Box<dyn ValueModel>,
        space: &ActionSpace,
        median_range: f64,
        evidence: Evidence,
    ) -> Result<Self, EvidenceError> {
        let Evidence { rationality, weight, change } = evidence;
        let wrong = |what, range, got| Err(EvidenceError::Parameter { what, range, got });
        if !(0.0..=1e3).contains(&rationality) {
            return wrong("the rationality β", "from 0 to 1000", rationality);
        }
        if !(0.0..=1.0).contains(&weight) {
            return wrong("the weight of a decision", "from 0 to 1", weight);
        }
        if !(change > 0.0 && change <= 1.0) {
            return wrong("the probability of a change of mind", "above 0 and at most 1", change);
        }
        if !(median_range.is_finite() && median_range > 0.0) {
            return Err(EvidenceError::NoScale(median_range));
        }
        let per_unit = rationality / median_range;
        let (candidates, of_goal) = (Vec::new(), Vec::new());
        let (space, posterior) = (space.clone(), Posterior::default());
        Ok(Self { values, space, per_unit, evidence, posterior, candidates, of_goal, before: None })
    }

    /// What can be done, the same for every goal. Commands are; candidates on axes are looked for around the best of one goal,
    /// so that those of every goal are taken together: with those of one alone, that goal would look like any other's.
    fn gather(&mut self, view: &View<'_>, asked: Action) {
        self.candidates.clear();
        let goals = if self.space.commands() == 0 { view.goals.len() } else { 1 };
        for goal in 0..goals {
            self.candidates.extend_from_slice(self.values.estimate(view, goal, Some(asked)).candidates());
        }
    }

    /// The logarithm of how likely what is asked is for each goal, over the same candidates; `None` if it says nothing.
    fn likelihoods(&mut self, view: &View<'_>, asked: Action) -> Option<[f64; MAX_GOALS]> {
        self.gather(view, asked);
        let mut logs = [0.0; MAX_GOALS];
        for (goal, log) in logs.iter_mut().enumerate().take(view.goals.len()) {
            self.values.assess(view, goal, &self.candidates, Some(asked), &mut self.of_goal);
            let choice = Choice {
                candidates: &self.candidates,
                values: &self.of_goal,
                space: &self.space,
                switches: view.switches,
                per_unit: self.per_unit,
            };
            *log = self.evidence.weight * choice.likelihood(asked)?;
        }
        Some(logs)
    }
}

impl IntentModel for ValueIntent {
    fn begin(&mut self) {
        self.posterior = Posterior::default();
        self.before = None;
    }

    fn infer(&mut self, view: &View<'_>, asked: Option<Action>) -> Belief {
        let goals = &view.goals[..view.goals.len().min(MAX_GOALS)];
        let view = &View { goals, ..*view };
        self.posterior.follow(goals);
        self.posterior.spread(self.evidence.change);
        let decided = asked != std::mem::replace(&mut self.before, asked);
        if goals.len() > 1 && decided {
            if let Some(logs) = asked.and_then(|asked| self.likelihoods(view, asked)) {
                self.posterior.weigh(&logs);
            }
        }
        self.posterior.belief(view.nearest_goal())
    }
}

/// What a pilot of one goal can choose from.
struct Choice<'a> {
    candidates: &'a [Action],
    values: &'a [f32],
    space: &'a ActionSpace,
    switches: u8,
    per_unit: f64,
}

impl Choice<'_> {
    /// ln p(a | s, g), up to a number that is the same for all goals; `None` if `asked` is not among the candidates or a
    /// value is not finite.
    fn likelihood(&self, asked: Action) -> Option<f64> {
        let best = self.values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let excess = |value: f32| self.per_unit * (f64::from(value) - f64::from(best));
        if !self.values.iter().all(|value| value.is_finite()) {
            return None;
        }
        if self.space.commands() == 0 {
            let own = self.candidates.iter().position(|&candidate| candidate == asked)?;
            let sum: f64 = self.values.iter().map(|&value| libm::exp(excess(value))).sum();
            return Some(excess(self.values[own]) - libm::log(sum));
        }
        let (mut own, mut sum) = (None, 0.0);
        let wanted = self.space.effect(Some(asked), self.switches);
        for first in (0..self.candidates.len()).filter(|&index| self.is_first_of_its_effect(index)) {
            let alike =
                (first..self.candidates.len()).filter(|&other| self.effect(other) == self.effect(first));
            let value = alike.map(|index| self.values[index]).fold(f32::NEG_INFINITY, f32::max);
            sum += libm::exp(excess(value));
            if self.effect(first) == wanted {
                own = Some(excess(value));
            }
        }
        own.map(|own| own - libm::log(sum))
    }

    fn effect(&self, index: usize) -> Effect {
        self.space.effect(Some(self.candidates[index]), self.switches)
    }

    fn is_first_of_its_effect(&self, index: usize) -> bool {
        (0..index).all(|before| self.effect(before) != self.effect(index))
    }
}

/// How probable each goal is, by its id.
#[derive(Clone, Copy, Debug, Default)]
struct Posterior {
    ids: [u32; MAX_GOALS],
    probabilities: [f64; MAX_GOALS],
    goals: usize,
}

impl Posterior {
    fn probability(&self, id: u32) -> Option<f64> {
        (0..self.goals).find(|&i| self.ids[i] == id).map(|i| self.probabilities[i])
    }

    /// The goals of the moment: new ones get 1/n each, those that were there share the rest as they did before.
    fn follow(&mut self, goals: &[Goal]) {
        let before = *self;
        let share = 1.0 / goals.len().max(1) as f64;
        let known = || goals.iter().filter_map(|goal| before.probability(goal.id));
        let (kept, new) = (known().sum::<f64>(), goals.len() - known().count());
        let rest = 1.0 - share * new as f64;
        self.goals = goals.len();
        for (i, goal) in goals.iter().enumerate() {
            self.ids[i] = goal.id;
            self.probabilities[i] = match before.probability(goal.id) {
                Some(p) if kept > 0.0 => p / kept * rest,
                _ => share,
            };
        }
    }

    /// With a small probability the pilot wants another goal from now on.
    fn spread(&mut self, change: f64) {
        let share = change / self.goals.max(1) as f64;
        for p in &mut self.probabilities[..self.goals] {
            *p = (1.0 - change) * *p + share;
        }
    }

    /// Bayes' rule. No probability is 0 after [`spread`](Self::spread), and the largest factor is 1: the sum is above 0.
    fn weigh(&mut self, logs: &[f64; MAX_GOALS]) {
        let largest = logs[..self.goals].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let probabilities = &mut self.probabilities[..self.goals];
        for (p, log) in probabilities.iter_mut().zip(logs) {
            *p *= libm::exp(log - largest);
        }
        let sum: f64 = probabilities.iter().sum();
        probabilities.iter_mut().for_each(|p| *p /= sum);
    }

    /// As a belief; while all goals are as likely, `nearest` is taken.
    fn belief(&self, nearest: usize) -> Belief {
        let probabilities = self.probabilities.map(|p| p as f32);
        let probabilities = &probabilities[..self.goals];
        let belief = Belief::from_probabilities(probabilities);
        let differ = probabilities.iter().any(|p| (p - probabilities[0]).abs() > 1e-6);
        if differ || self.goals == 1 { belief } else { Belief::unknown(self.goals, nearest) }
    }
}
