//! The rules alone: values, confidence and what was asked go in, the choice comes out. For whoever has a robot and a
//! critic of their own.

use crate::errors::Kind;
use cohelm::action::{Action, blend_axis, distance_between};
use cohelm::arbitration::{Arbiter, GoalValues, Likeness, Pick, Rule as CoreRule, RuleError, Stage};
use cohelm::intent::{Belief, MAX_GOALS};
use cohelm::value::ActionValues;
use numpy::ndarray::{ArrayView2, ArrayView3, Axis};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// Most candidate actions of one decision.
const MOST_CANDIDATES: usize = 1 << 16;

/// A rule of arbitration with its parameters.
#[pyclass(module = "cohelm._native", frozen)]
pub struct Rule {
    rule: CoreRule,
    median_range: Option<f64>,
    arbiter: Box<dyn Arbiter>,
}

impl Rule {
    fn of(rule: CoreRule, median_range: Option<f64>) -> PyResult<Self> {
        // Without a model's card the regret is meant in the values' own units.
        let arbiter = rule.arbiter(median_range.unwrap_or(1.0)).map_err(|error| Kind::Option.error(error))?;
        Ok(Self { rule, median_range, arbiter })
    }

    /// The rule for a cockpit.
    pub fn rule(&self) -> CoreRule {
        self.rule
    }
}

#[pymethods]
impl Rule {
    #[new]
    #[pyo3(signature = (name, parameters, *, median_range=None))]
    fn new(name: &str, parameters: BTreeMap<String, f64>, median_range: Option<f64>) -> PyResult<Self> {
        let usual = CoreRule::named(name);
        let rule = parameters.iter().try_fold(usual, |rule, (name, &value)| Ok(rule?.with(name, value)));
        let rule = rule.and_then(|rule| rule).map_err(|error: RuleError| Kind::Option.error(error))?;
        Self::of(rule, median_range)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Pickled)> {
        let rule = serde_json::to_string(&slf.get().rule).map_err(|error| Kind::Run.error(error))?;
        Ok((slf.get_type().getattr("_unpickled")?, (rule, slf.get().median_range)))
    }

    /// The rule that was pickled as this.
    #[staticmethod]
    fn _unpickled(rule: &str, median_range: Option<f64>) -> PyResult<Self> {
        let rule = serde_json::from_str(rule)
            .map_err(|error| Kind::Option.error(format!("this is no pickled Rule: {error}")))?;
        Self::of(rule, median_range)
    }

    /// The rule's word.
    #[getter]
    fn name(&self) -> &'static str {
        self.rule.word()
    }

    fn __repr__(&self) -> String {
        let parameters = self.rule.parameters().into_iter().map(|(name, value)| format!(", {name}={value}"));
        format!("Rule('{}'{})", self.rule.word(), parameters.collect::<String>())
    }

    /// The index that each row of values is decided for; −1 where nothing is carried out.
    ///
    /// `values`: rows × actions; `confidence`: a number a row; `asked`: an index a row, −1 for nothing; `similarity`:
    /// actions × actions, f(a, asked); `goals`: values, rows × goals × actions, and probabilities, rows × goals, for the
    /// rules that need them.
    #[pyo3(signature = (values, confidence, asked, similarity, goals=None))]
    fn decide_rows<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray2<'py, f32>,
        confidence: PyReadonlyArray1<'py, f32>,
        asked: PyReadonlyArray1<'py, i64>,
        similarity: PyReadonlyArray2<'py, f32>,
        goals: Option<OfGoals<'py>>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let (values, confidence, asked) = (values.as_array(), confidence.as_array(), asked.as_array());
        let (rows, actions) = values.dim();
        check_sizes(rows, actions, [confidence.len(), asked.len()])?;
        let similarity = similarity.as_array();
        if similarity.dim() != (actions, actions) {
            let message =
                format!("expected similarities of shape ({actions}, {actions}), got {:?}", similarity.dim());
            return Err(Kind::Array.error(message));
        }
        let goals = self.of_goals(&goals, rows, actions)?;
        let candidates = (0..actions).map(|index| Action::axes(&[index as f32])).collect();
        let mut desk = Desk::new(candidates)?;
        let mut decided = Vec::with_capacity(rows);
        for row in 0..rows {
            let asked = index_of(asked[row], actions)?;
            let likeness =
                asked.map(|asked| move |index: usize| (similarity[[index, asked]], index == asked));
            desk.of_goals(&goals, row)?;
            let pick =
                desk.decide(self.arbiter.as_ref(), &values.row(row).to_vec(), confidence[row], likeness)?;
            decided.push(match pick {
                Pick::Nothing => -1,
                Pick::Asked => asked.map_or(-1, |asked| asked as i64),
                Pick::Candidate(index) => index as i64,
                Pick::Blend { robot, weight } if weight > 0.5 => robot as i64,
                Pick::Blend { robot, .. } => asked.unwrap_or(robot) as i64,
            });
        }
        Ok(PyArray1::from_vec(py, decided))
    }

    /// The action that is carried out, of sampled candidates: `candidates` × dimensions with a value each; `asked` a
    /// vector, or None for nothing. Similarity is minus the Euclidean distance.
    #[pyo3(signature = (values, candidates, confidence, asked=None, goals=None))]
    fn decide_among<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray1<'py, f32>,
        candidates: PyReadonlyArray2<'py, f32>,
        confidence: f32,
        asked: Option<PyReadonlyArray1<'py, f32>>,
        goals: Option<OfGoals<'py>>,
    ) -> PyResult<Option<Bound<'py, PyArray1<f32>>>> {
        let (values, candidates) = (values.as_array().to_vec(), candidates.as_array());
        let (count, dimensions) = candidates.dim();
        check_sizes(1, count, [1, 1])?;
        let asked = asked.map(|asked| asked.as_array().to_vec());
        if asked
            .as_ref()
            .is_some_and(|asked| asked.len() != dimensions || !asked.iter().all(|x| x.is_finite()))
        {
            return Err(Kind::Array.error(format!("expected {dimensions} finite numbers to be asked for")));
        }
        let rows: Vec<Vec<f32>> = candidates.rows().into_iter().map(|row| row.to_vec()).collect();
        let mut desk = Desk::new((0..count).map(|index| Action::axes(&[index as f32])).collect())?;
        let goals = self.of_goals(&goals, 1, count)?;
        desk.of_goals(&goals, 0)?;
        let likeness = asked
            .as_ref()
            .map(|asked| |index: usize| (-distance_between(&rows[index], asked), rows[index] == *asked));
        let pick = desk.decide(self.arbiter.as_ref(), &values, confidence, likeness)?;
        let chosen = match pick {
            Pick::Nothing => None,
            Pick::Asked => asked,
            Pick::Candidate(index) => Some(rows[index].clone()),
            Pick::Blend { robot, weight } => Some(match asked {
                Some(asked) => blend(&rows[robot], &asked, weight),
                None => rows[robot].clone(),
            }),
        };
        Ok(chosen.map(|chosen| PyArray1::from_vec(py, chosen)))
    }
}

/// What a rule is pickled as: its JSON, and the median range of its values.
type Pickled = (String, Option<f64>);

/// Values for every goal, rows × goals × actions, and the goals' probabilities, rows × goals.
type OfGoals<'py> = (PyReadonlyArray3<'py, f32>, PyReadonlyArray2<'py, f32>);
/// The same as views.
type GoalRows<'a> = Option<(ArrayView3<'a, f32>, ArrayView2<'a, f32>)>;

impl Rule {
    /// What is given about the goals, if it is what the rule needs.
    fn of_goals<'a>(
        &self,
        goals: &'a Option<OfGoals<'_>>,
        rows: usize,
        actions: usize,
    ) -> PyResult<GoalRows<'a>> {
        let (word, needs) = (self.rule.word(), self.arbiter.needs());
        if needs.look_ahead {
            return Err(Kind::Option.error(format!(
                "the rule {word} looks ahead in a copy of the plant, and there is none here; fly it in a World"
            )));
        }
        let Some((values, probabilities)) = goals else {
            return match needs.every_goal {
                true => Err(Kind::Option.error(format!(
                    "the rule {word} needs the values for every goal and how likely each is: goal_values and probabilities"
                ))),
                false => Ok(None),
            };
        };
        let (values, probabilities) = (values.as_array(), probabilities.as_array());
        let count = probabilities.dim().1;
        if values.dim() != (rows, count, actions) || probabilities.dim().0 != rows {
            return Err(Kind::Array.error(format!(
                "expected goal_values of shape ({rows}, goals, {actions}) and probabilities of ({rows}, goals), got {:?} and {:?}",
                values.dim(),
                probabilities.dim()
            )));
        }
        if !(1..=MAX_GOALS).contains(&count) {
            return Err(Kind::Array.error(format!("expected 1 to {MAX_GOALS} goals, got {count}")));
        }
        if let Some(p) = probabilities.iter().find(|p| !(0.0..=1.0).contains(*p)) {
            return Err(Kind::Array.error(format!("a probability lies in [0, 1], got {p}")));
        }
        Ok(Some((values, probabilities)))
    }
}

/// Where one decision after the other is made, without allocating anew.
struct Desk {
    belief: Belief,
    of_goals: Vec<f32>,
    values: ActionValues,
    likeness: Vec<Likeness>,
    allowed: Vec<bool>,
}

impl Desk {
    fn new(candidates: Vec<Action>) -> PyResult<Self> {
        let allowed = vec![false; candidates.len()];
        let values = ActionValues::equal(candidates).map_err(|error| Kind::Array.error(error))?;
        let belief = Belief::unknown(1, 0);
        Ok(Self { belief, of_goals: Vec::new(), values, likeness: Vec::new(), allowed })
    }

    /// Takes one row of what is given about the goals.
    fn of_goals(&mut self, goals: &GoalRows<'_>, row: usize) -> PyResult<()> {
        let Some((values, probabilities)) = goals else { return Ok(()) };
        self.of_goals.clear();
        self.of_goals.extend(values.index_axis(Axis(0), row).iter());
        if !self.of_goals.iter().all(|value| value.is_finite()) {
            return Err(Kind::Array.error("goal_values must be finite"));
        }
        self.belief = Belief::from_probabilities(&probabilities.row(row).to_vec());
        Ok(())
    }

    fn decide(
        &mut self,
        arbiter: &dyn Arbiter,
        values: &[f32],
        confidence: f32,
        likeness: Option<impl Fn(usize) -> (f32, bool)>,
    ) -> PyResult<Pick> {
        if !(0.0..=1.0).contains(&confidence) {
            return Err(Kind::Array.error(format!("a confidence lies in [0, 1], got {confidence}")));
        }
        self.values.refill(values).map_err(|error| Kind::Array.error(error))?;
        self.likeness.clear();
        if let Some(likeness) = &likeness {
            self.likeness.extend((0..values.len()).map(|index| {
                let (similarity, same) = likeness(index);
                Likeness { similarity, same_label: same, same_effect: same }
            }));
        }
        if self.likeness.iter().any(|likeness| !likeness.similarity.is_finite()) {
            return Err(Kind::Array.error("similarities must be finite"));
        }
        self.allowed.fill(false);
        let likeness = likeness.is_some().then_some(self.likeness.as_slice());
        self.belief.confidence = confidence;
        let mut stage = Stage::new(&self.values, likeness, &self.belief);
        stage.of_goals = GoalValues::new(&self.of_goals, values.len());
        Ok(arbiter.decide(&stage, &mut self.allowed))
    }
}

fn check_sizes(rows: usize, actions: usize, others: [usize; 2]) -> PyResult<()> {
    if actions == 0 || actions > MOST_CANDIDATES {
        return Err(
            Kind::Array.error(format!("expected values of 1 to {MOST_CANDIDATES} actions, got {actions}"))
        );
    }
    match others.iter().find(|&&length| length != rows) {
        Some(length) => {
            Err(Kind::Array.error(format!("expected one number for each of {rows} rows, got {length}")))
        }
        None => Ok(()),
    }
}

fn index_of(asked: i64, actions: usize) -> PyResult<Option<usize>> {
    match usize::try_from(asked) {
        Ok(index) if index < actions => Ok(Some(index)),
        _ if asked == -1 => Ok(None),
        _ => Err(Kind::Action
            .error(format!("expected an action from 0 to {}, or −1 for nothing, got {asked}", actions - 1))),
    }
}

/// The same sum as in a cockpit, on any number of axes.
fn blend(robot: &[f32], asked: &[f32], weight: f32) -> Vec<f32> {
    robot.iter().zip(asked).map(|(&robot, &asked)| blend_axis(robot, asked, weight)).collect()
}
