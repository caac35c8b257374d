//! What every action is worth for a goal (Section III-B).

use crate::action::{Action, ActionSpace};
use crate::plant::View;

/// Candidate actions with their values: at least one, as many of each, all finite.
///
/// ```
/// use cohelm::{action::Action, value::ActionValues};
/// let commands = vec![Action::Command(0), Action::Command(1)];
/// let values = ActionValues::new(commands, vec![-1.0, 3.0])?;
/// assert_eq!((values.best(), values.above_worst(1)), (1, 4.0));
/// # Ok::<(), cohelm::value::ValueError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ActionValues {
    candidates: Vec<Action>,
    values: Vec<f32>,
    worst: f32,
    best: usize,
}

/// Why a list of values is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ValueError {
    /// There are no candidates.
    #[error("expected the value of at least one action, got none; a plant needs at least one action")]
    Empty,
    /// Lengths differ.
    #[error("expected one value for each of {candidates} candidate actions, got {values}")]
    Length {
        /// Candidates there are.
        candidates: usize,
        /// Values that came.
        values: usize,
    },
    /// A value is infinite or not a number.
    #[error(
        "the value of action {index} is {value}; values must be finite: check the model's weights and the state"
    )]
    NotFinite {
        /// Where it stands.
        index: usize,
        /// What it is.
        value: f32,
    },
}

impl ActionValues {
    /// Values of candidates, in the same order.
    pub fn new(candidates: Vec<Action>, values: Vec<f32>) -> Result<Self, ValueError> {
        let mut made = Self { values: Vec::with_capacity(values.len()), candidates, worst: 0.0, best: 0 };
        made.refill(&values)?;
        Ok(made)
    }

    /// Equal values for all: no opinion, which lets the person through under every rule of minimal intervention.
    pub fn equal(candidates: Vec<Action>) -> Result<Self, ValueError> {
        let values = vec![0.0; candidates.len()];
        Self::new(candidates, values)
    }

    /// A place to [copy](Self::copy_from) values to: no candidates yet, which no value model ever gives.
    pub(crate) fn none_yet() -> Self {
        Self { candidates: Vec::new(), values: Vec::new(), worst: 0.0, best: 0 }
    }

    /// New values for the same candidates, without allocating. On an error nothing has changed.
    pub fn refill(&mut self, values: &[f32]) -> Result<(), ValueError> {
        if self.candidates.is_empty() {
            return Err(ValueError::Empty);
        }
        if values.len() != self.candidates.len() {
            return Err(ValueError::Length { candidates: self.candidates.len(), values: values.len() });
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(ValueError::NotFinite { index, value: values[index] });
        }
        self.values.clear();
        self.values.extend_from_slice(values);
        self.worst = values.iter().copied().fold(f32::INFINITY, f32::min);
        self.best = (1..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best });
        Ok(())
    }

    /// Becomes equal to `other`, without allocating once there is room.
    pub fn copy_from(&mut self, other: &Self) {
        self.candidates.clear();
        self.candidates.extend_from_slice(&other.candidates);
        self.values.clear();
        self.values.extend_from_slice(&other.values);
        (self.worst, self.best) = (other.worst, other.best);
    }

    /// Replaces the candidate at `index`, whose value the next [`refill`](Self::refill) will give: how a person's own
    /// action gets among sampled ones. Ignored beyond the end.
    pub fn set_candidate(&mut self, index: usize, action: Action) {
        if let Some(candidate) = self.candidates.get_mut(index) {
            *candidate = action;
        }
    }

    /// The candidate actions.
    pub fn candidates(&self) -> &[Action] {
        &self.candidates
    }

    /// Q(s, a) of every candidate, in the model's units.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Index of the candidate with the highest value, the first of equals: a_max.
    pub fn best(&self) -> usize {
        self.best
    }

    /// Q′(s, a) = Q(s, a) − min Q of Eq. 3, never negative. In f64, so that subtraction loses no bit that counts.
    pub fn above_worst(&self, index: usize) -> f64 {
        f64::from(self.values[index]) - f64::from(self.worst)
    }

    /// How much worse than the best a candidate is, never negative, in the values' own units.
    pub fn regret(&self, index: usize) -> f64 {
        f64::from(self.values[self.best]) - f64::from(self.values[index])
    }

    /// max Q − min Q.
    pub fn range(&self) -> f64 {
        self.above_worst(self.best)
    }
}

/// Estimates what actions are worth.
///
/// What it says depends on the arguments alone, so that whoever looks ahead may ask about situations that never come.
pub trait ValueModel: Send {
    /// Values of candidate actions in the situation seen, for the goal of that index, knowing what was asked.
    fn estimate(&mut self, view: &View<'_>, goal: usize, asked: Option<Action>) -> &ActionValues;

    /// Values of given actions there: clears `values` and fills it with a finite number for each of `actions`, which
    /// are of the plant's space. For the candidates of [`estimate`](Self::estimate), with the same goal and request, they
    /// are the same bits. An action that the model knows nothing of is worth 0.
    fn assess(
        &mut self,
        view: &View<'_>,
        goal: usize,
        actions: &[Action],
        asked: Option<Action>,
        values: &mut Vec<f32>,
    );
}

/// No co-pilot's values: all commands are worth the same. For axes, the only candidate is what was asked.
#[derive(Clone, Debug)]
pub struct NoOpinion {
    values: ActionValues,
}

impl NoOpinion {
    /// No opinion about the actions of a space.
    pub fn new(space: &ActionSpace) -> Self {
        let commands = (0..space.commands()).map(|index| Action::Command(index as u8));
        let mut candidates: Vec<Action> = commands.collect();
        if candidates.is_empty() {
            candidates.push(Action::Axes([0.0; 4]));
        }
        let zeros = vec![0.0; candidates.len()];
        Self { values: ActionValues { candidates, values: zeros, worst: 0.0, best: 0 } }
    }
}

impl ValueModel for NoOpinion {
    fn estimate(&mut self, _view: &View<'_>, _goal: usize, asked: Option<Action>) -> &ActionValues {
        if let Some(action @ Action::Axes(_)) = asked {
            self.values.set_candidate(0, action);
        }
        &self.values
    }

    fn assess(
        &mut self,
        _view: &View<'_>,
        _goal: usize,
        actions: &[Action],
        _asked: Option<Action>,
        values: &mut Vec<f32>,
    ) {
        values.clear();
        values.resize(actions.len(), 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three() -> Vec<Action> {
        (0..3).map(Action::Command).collect()
    }

    #[test]
    fn what_is_not_finite_is_refused_where_values_are_made() {
        let error = ActionValues::new(three(), vec![0.0, f32::NAN, 1.0]).unwrap_err();
        assert!(matches!(error, ValueError::NotFinite { index: 1, .. }), "{error}");
        assert_eq!(ActionValues::new(vec![], vec![]), Err(ValueError::Empty));
        assert_eq!(
            ActionValues::new(three(), vec![1.0]),
            Err(ValueError::Length { candidates: 3, values: 1 })
        );
    }

    #[test]
    fn a_refused_refill_changes_nothing() {
        let mut values = ActionValues::new(three(), vec![1.0, 5.0, 2.0]).unwrap();
        let before = values.clone();
        assert!(values.refill(&[f32::INFINITY, 0.0, 0.0]).is_err());
        assert_eq!(values, before);
    }
}
