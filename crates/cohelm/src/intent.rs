//! Which goal the pilot wants, and how sure that is (Section III-A).

mod bayesian;
mod product;

pub use bayesian::{Evidence, EvidenceError, ValueIntent};
pub use product::Product;

use crate::action::Action;
use crate::plant::{Goal, View, Wish, nearest};
use serde::{Deserialize, Serialize};

/// Most goals there can be at one moment.
pub const MAX_GOALS: usize = 8;

/// The id of a goal that is imagined; no plant's goal may have it.
pub const IMAGINED: u32 = u32::MAX;

/// What the co-pilot believes about the pilot's goal.
///
/// Probabilities are those of the goals of the moment, in their order; they sum to one unless there is no goal at all. A
/// co-pilot that knows no goals imagines one: then it is the only goal there is for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief {
    probabilities: [f32; MAX_GOALS],
    goals: usize,
    /// Index of the goal that is taken for the pilot's.
    pub goal: usize,
    /// c of Eq. 1, in [0, 1].
    pub confidence: f32,
    imagined: Option<Goal>,
}

impl Belief {
    /// From probabilities of the goals, in their order: the goal is the likeliest (the first of equals), the
    /// confidence is Eq. 1, the largest minus the smallest probability; with one goal only it is 1.
    pub fn from_probabilities(probabilities: &[f32]) -> Self {
        let goals = probabilities.len().min(MAX_GOALS);
        let mut kept = [0.0; MAX_GOALS];
        kept[..goals].copy_from_slice(&probabilities[..goals]);
        let goal = (1..goals).fold(0, |best, i| if kept[i] > kept[best] { i } else { best });
        let smallest = kept[..goals].iter().copied().fold(f32::INFINITY, f32::min);
        let confidence = if goals == 1 { 1.0 } else { (kept[goal] - smallest).clamp(0.0, 1.0) };
        Self { probabilities: kept, goals, goal, confidence, imagined: None }
    }

    /// Nothing known yet: all goals as likely, c = 0, and one of them taken for the pilot's until more is known.
    pub fn unknown(goals: usize, taken: usize) -> Self {
        let goals = goals.min(MAX_GOALS);
        let mut probabilities = [0.0; MAX_GOALS];
        probabilities[..goals].fill(1.0 / goals.max(1) as f32);
        Self { probabilities, goals, goal: taken, confidence: 0.0, imagined: None }
    }

    /// The goal is known for certain, c = 1.
    pub fn certain(goals: usize, goal: usize) -> Self {
        let goals = goals.min(MAX_GOALS);
        let mut probabilities = [0.0; MAX_GOALS];
        probabilities[goal.min(MAX_GOALS - 1)] = 1.0;
        Self { probabilities, goals, goal, confidence: 1.0, imagined: None }
    }

    /// A goal at `position` is imagined, by a co-pilot that knows of none. What is not finite is taken for nothing known.
    pub fn imagined(position: [f32; 2], confidence: f32) -> Self {
        let finite = position.iter().all(|at| at.is_finite()) && confidence.is_finite();
        let mut belief = Self::certain(1, 0);
        belief.confidence = if finite { confidence.clamp(0.0, 1.0) } else { 0.0 };
        belief.imagined = finite.then_some(Goal { id: IMAGINED, position });
        belief
    }

    /// The goal that is imagined, by a co-pilot that knows of none.
    pub fn imagined_goal(&self) -> Option<&Goal> {
        self.imagined.as_ref()
    }

    /// Index, among the plant's own goals, of the one that this belief comes to: the goal that is taken for the pilot's,
    /// or the one nearest to where a goal is imagined. For judges and for who looks on.
    pub fn goal_among(&self, goals: &[Goal]) -> usize {
        self.imagined.map_or(self.goal, |goal| nearest(goals, goal.position))
    }

    /// p(g | a_h) of every goal, in their order.
    pub fn probabilities(&self) -> &[f32] {
        &self.probabilities[..self.goals]
    }
}

/// How a network's output becomes a belief.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Head {
    /// The paper's: probabilities proportional to the inverse distance between goal and predicted position.
    InverseDistance,
    /// Probabilities proportional to exp(−distance / 0.15): peaked.
    Softmax,
    /// The calibrated head: a predicted position with a spread, trained so that the probabilities are true ones.
    Calibrated,
}

impl Head {
    /// All heads, in the order of tables.
    pub const ALL: [Self; 3] = [Self::InverseDistance, Self::Softmax, Self::Calibrated];

    /// The word for it in options, files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::InverseDistance => "inverse-distance",
            Self::Softmax => "softmax",
            Self::Calibrated => "calibrated",
        }
    }

    /// The belief that a prediction means. `spread` is the predicted standard deviation, in the units of positions;
    /// only the calibrated head has one.
    pub fn belief(self, goals: &[Goal], predicted: [f32; 2], spread: f32) -> Belief {
        let goals = &goals[..goals.len().min(MAX_GOALS)];
        let mut weights = [0.0; MAX_GOALS];
        for (weight, goal) in weights.iter_mut().zip(goals) {
            *weight = distance(goal.position, predicted);
        }
        let weights = &mut weights[..goals.len()];
        match self {
            Self::InverseDistance => inverse_distances(weights),
            Self::Softmax => softmax_of(weights, |distance| -distance / SOFTMAX_TEMPERATURE),
            Self::Calibrated => {
                let precision = 0.5 / (spread * spread);
                softmax_of(weights, |distance| -distance * distance * precision)
            }
        }
        let mut belief = Belief::from_probabilities(weights);
        if self != Self::Calibrated {
            belief.goal = nearest(goals, predicted);
        }
        belief
    }
}

/// Where the belief about the goal comes from, as options, files and records name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Inference {
    /// From nothing: [`NearestGoal`].
    Nearest,
    /// Told from outside: [`KnownGoal`]. For demonstrations and for measuring values alone.
    Known,
    /// A network under [`Head::InverseDistance`].
    InverseDistance,
    /// A network under [`Head::Softmax`].
    Softmax,
    /// A network under [`Head::Calibrated`].
    Calibrated,
    /// From the values of what is asked: [`ValueIntent`].
    Bayesian,
    /// The product of [`Head::Calibrated`] and [`ValueIntent`]: [`Product`].
    CalibratedBayesian,
    /// A goal is imagined where a network that knows no goals expects it; intent and values never see the plant's goals.
    Imagined,
}

impl Inference {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 8] = [
        Self::Nearest,
        Self::Known,
        Self::InverseDistance,
        Self::Softmax,
        Self::Calibrated,
        Self::Bayesian,
        Self::CalibratedBayesian,
        Self::Imagined,
    ];

    /// The word for it in options, files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Known => "known",
            Self::InverseDistance => "inverse-distance",
            Self::Softmax => "softmax",
            Self::Calibrated => "calibrated",
            Self::Bayesian => "bayesian",
            Self::CalibratedBayesian => "calibrated-bayesian",
            Self::Imagined => "imagined",
        }
    }

    /// The head it needs a network for, if it does; a goal is imagined with the spread of the calibrated one.
    pub fn head(self) -> Option<Head> {
        match self {
            Self::Nearest | Self::Known | Self::Bayesian => None,
            Self::InverseDistance => Some(Head::InverseDistance),
            Self::Softmax => Some(Head::Softmax),
            Self::Calibrated | Self::CalibratedBayesian | Self::Imagined => Some(Head::Calibrated),
        }
    }

    /// True if it asks the values what a pilot of each goal would do, so that there is none without them.
    pub fn asks_values(self) -> bool {
        matches!(self, Self::Bayesian | Self::CalibratedBayesian)
    }

    /// True if the co-pilot is to know no goals.
    pub fn hides_goals(self) -> bool {
        self == Self::Imagined
    }
}

impl From<Head> for Inference {
    fn from(head: Head) -> Self {
        match head {
            Head::InverseDistance => Self::InverseDistance,
            Head::Softmax => Self::Softmax,
            Head::Calibrated => Self::Calibrated,
        }
    }
}

/// Distance, in normalised units, over which the softmax head's probability falls to 1/e: smaller makes the confidence
/// jump between 0 and 1, larger makes it as flat as inverse distances.
pub const SOFTMAX_TEMPERATURE: f32 = 0.15;

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    libm::sqrtf(dx * dx + dy * dy)
}

/// Distances become normalised inverse distances. "Normalised distances" taken literally would give the farthest goal
/// the largest probability, and 1 − d/Σd can never exceed c = 1/2; inverse distances meet both of the paper's extremes.
fn inverse_distances(distances: &mut [f32]) {
    for distance in distances.iter_mut() {
        *distance = 1.0 / distance.max(1e-6);
    }
    normalise(distances);
}

fn softmax_of(distances: &mut [f32], logit: impl Fn(f32) -> f32) {
    for distance in distances.iter_mut() {
        *distance = logit(*distance);
    }
    let largest = distances.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    for weight in distances.iter_mut() {
        *weight = libm::expf(*weight - largest);
    }
    normalise(distances);
}

fn normalise(weights: &mut [f32]) {
    let sum: f32 = weights.iter().sum();
    for weight in weights.iter_mut() {
        *weight /= sum;
    }
}

/// Infers the pilot's goal from what is seen and asked, tick by tick.
pub trait IntentModel: Send {
    /// Begins an episode: forgets everything.
    fn begin(&mut self);

    /// What to believe now. Called once a tick, with what the pilot asks at this tick.
    fn infer(&mut self, view: &View<'_>, asked: Option<Action>) -> Belief;
}

/// No inference: the nearest goal, with confidence 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct NearestGoal;

impl IntentModel for NearestGoal {
    fn begin(&mut self) {}

    fn infer(&mut self, view: &View<'_>, _asked: Option<Action>) -> Belief {
        Belief::unknown(view.goals.len(), view.nearest_goal())
    }
}

/// The goal is told from outside and certain (c = 1): for measuring values alone, and for demonstrations.
#[derive(Clone, Copy, Debug)]
pub struct KnownGoal(
    /// Index of the goal.
    pub usize,
);

impl IntentModel for KnownGoal {
    fn begin(&mut self) {}

    fn infer(&mut self, view: &View<'_>, _asked: Option<Action>) -> Belief {
        Belief::certain(view.goals.len(), self.0)
    }
}

/// The goal is told from outside and certain (c = 1), whatever the pilot comes to want: [`KnownGoal`] for plants whose
/// goals come and go or whose pilot may change its mind. A goal that is not there is as unknown as any.
#[derive(Clone, Debug)]
pub struct Told {
    wishes: Vec<Wish>,
}

impl Told {
    /// Told what the pilot wants from when on, in the order of time; see [`Plant::wishes`](crate::plant::Plant::wishes).
    pub fn new(wishes: Vec<Wish>) -> Self {
        Self { wishes }
    }
}

impl IntentModel for Told {
    fn begin(&mut self) {}

    fn infer(&mut self, view: &View<'_>, _asked: Option<Action>) -> Belief {
        let wish = self.wishes.iter().rev().find(|wish| wish.from <= view.tick);
        let goal = wish.and_then(|wish| view.goals.iter().position(|goal| goal.id == wish.goal));
        match goal {
            Some(goal) => Belief::certain(view.goals.len(), goal),
            None => Belief::unknown(view.goals.len(), view.nearest_goal()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pads() -> [Goal; 3] {
        [-0.5, 0.0, 0.5].map(|x| Goal { id: (x * 2.0 + 1.0) as u32, position: [x, 0.0] })
    }

    #[test]
    fn the_papers_two_extreme_cases_hold_for_every_head() {
        for head in Head::ALL {
            let sure = head.belief(&pads(), [0.5, 0.0], 0.01);
            assert!(sure.goal == 2 && sure.confidence > 0.9, "{head:?}: {sure:?}");
        }
        let pads = [[-1.0, 0.0], [0.5, 0.866_025_4], [0.5, -0.866_025_4]];
        let pads = pads.map(|position| Goal { id: 0, position });
        for head in Head::ALL {
            assert!(head.belief(&pads, [0.0, 0.0], 1.0).confidence < 1e-5);
        }
    }

    #[test]
    fn probabilities_sum_to_one_and_fall_with_distance() {
        for head in Head::ALL {
            let belief = head.belief(&pads(), [-0.4, 0.1], 0.4);
            let p = belief.probabilities();
            assert!((p.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            assert!(p[0] > p[1] && p[1] > p[2], "{head:?}: {p:?}");
        }
    }

    #[test]
    fn far_predictions_and_tiny_spreads_stay_numbers() {
        for head in Head::ALL {
            let belief = head.belief(&pads(), [1e6, -1e6], 1e-3);
            assert!(belief.probabilities().iter().all(|p| p.is_finite()), "{head:?}: {belief:?}");
        }
    }
}
