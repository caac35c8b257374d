//! What whoever shows a flight is told: the opening of an episode, and one report a tick. All of it goes over as JSON.

use crate::action::{Action, ActionSpace};
use crate::arbitration::Rule;
use crate::cockpit::Tick;
use crate::keys::{Control, controls};
use crate::plant::{Ending, Goal, Plant};
use crate::scene::{Pose, Scene};
use crate::trajectory::Setup;
use crate::value::ActionValues;
use serde::Serialize;

/// Everything to know before the first tick.
#[derive(Clone, Debug, Serialize)]
pub struct Opening {
    /// What fixes the episode.
    pub setup: Setup,
    /// Ticks a second at time scale 1.
    pub ticks_per_second: f64,
    /// Ticks of the record; `None` for a flight, whose length nobody knows yet.
    pub ticks: Option<u32>,
    /// What can be pressed, in the order of control numbers.
    pub controls: Vec<Control>,
    /// The id of the person's own goal, to be marked. It goes to the screen and never to the co-pilot.
    pub pilot_goal: Option<u32>,
    /// The goals of the first moment.
    pub goals: Vec<Goal>,
    /// What to draw.
    pub scene: Scene,
    /// Where the movable parts begin.
    pub poses: Vec<Pose>,
}

impl Opening {
    /// Of an episode whose plant was just reset.
    pub fn of(setup: &Setup, plant: &dyn Plant, ticks: Option<u32>) -> Self {
        let goals = plant.view().goals.to_vec();
        Self {
            setup: setup.clone(),
            ticks_per_second: plant.ticks_per_second(),
            ticks,
            controls: controls(plant.space()),
            pilot_goal: goals.get(plant.pilot_goal()).map(|goal| goal.id),
            goals,
            scene: plant.scene(),
            poses: poses(plant),
        }
    }
}

/// One tick, every stage of it, and where it left the plant.
#[derive(Clone, Debug, Serialize)]
pub struct TickReport {
    /// Ticks since the episode began, before this one.
    pub tick: u32,
    /// What was asked.
    pub asked: Option<Named>,
    /// What the co-pilot believed.
    pub belief: BeliefReport,
    /// Every candidate action, in the order of the value model.
    pub candidates: Vec<Candidate>,
    /// The smallest Q′ that the rule allows at this tick; `None` for rules without a threshold.
    pub threshold: Option<f64>,
    /// What was carried out.
    pub executed: Option<Named>,
    /// How that differs from what was asked; `None` if nothing was.
    pub intervention: Option<InterventionReport>,
    /// Reward of the tick, in the plant's units.
    pub reward: f64,
    /// How the episode ended, if it did at this tick.
    pub ending: Option<Ending>,
    /// Only when a record is watched: true if what it says was carried out is not what was carried out now.
    pub differs: bool,
    /// The goals after the tick.
    pub goals: Vec<Goal>,
    /// The id of the person's own goal after the tick: it may have changed its mind. It goes to the screen and never to the
    /// co-pilot.
    pub pilot_goal: Option<u32>,
    /// Where the movable parts are after the tick.
    pub poses: Vec<Pose>,
}

/// An action and what it is called.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Named {
    /// In the plant's words.
    pub label: String,
    /// The index of a command.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<usize>,
    /// The values of the axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<[f32; 4]>,
}

/// A belief about the goal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BeliefReport {
    /// Of every goal, in their order.
    pub probabilities: Vec<f32>,
    /// Index of the goal taken for the pilot's.
    pub goal: usize,
    /// c of Eq. 1.
    pub confidence: f32,
    /// Where a goal is imagined, in the units of the goals' positions, by a co-pilot that knows none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imagined: Option<[f32; 2]>,
}

/// One candidate action.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// Which.
    pub action: Named,
    /// Q(s, a), in the model's units.
    pub value: f32,
    /// Q′(s, a) of Eq. 3: the value above that of the worst.
    pub above_worst: f64,
    /// True if the rule allows it.
    pub allowed: bool,
}

/// How what was carried out differs from what was asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct InterventionReport {
    /// The plant is left set differently.
    pub effective: bool,
    /// Another label.
    pub nominal: bool,
    /// The opposite.
    pub opposed: bool,
}

impl TickReport {
    /// Of a tick of a flight under `rule`, whose values have the given median range, if any is known. Goals and poses come afterwards,
    /// with [`placed`](Self::placed): while the tick is borrowed, so is the flight.
    pub fn of(tick: &Tick<'_>, space: &ActionSpace, rule: &Rule, median_range: Option<f64>) -> Self {
        let candidate = |(index, (&action, &value)): (usize, (&Action, &f32))| Candidate {
            action: Named::of(action, space),
            value,
            above_worst: tick.values.above_worst(index),
            allowed: tick.allowed.get(index).copied().unwrap_or(false),
        };
        let valued = tick.values.candidates().iter().zip(tick.values.values());
        Self {
            tick: tick.tick,
            asked: tick.asked.map(|action| Named::of(action, space)),
            belief: BeliefReport {
                probabilities: tick.belief.probabilities().to_vec(),
                goal: tick.belief.goal,
                confidence: tick.belief.confidence,
                imagined: tick.belief.imagined_goal().map(|goal| goal.position),
            },
            candidates: valued.enumerate().map(candidate).collect(),
            threshold: threshold(rule, tick.belief.confidence, tick.values, median_range),
            executed: tick.executed.map(|action| Named::of(action, space)),
            intervention: tick.intervention.map(|seen| InterventionReport {
                effective: seen.effective,
                nominal: seen.nominal,
                opposed: seen.opposed,
            }),
            reward: tick.step.reward,
            ending: tick.step.ending,
            differs: false,
            goals: Vec::new(),
            pilot_goal: None,
            poses: Vec::new(),
        }
    }

    /// The same with where the tick left the plant.
    pub fn placed(mut self, plant: &dyn Plant) -> Self {
        self.goals = plant.view().goals.to_vec();
        self.pilot_goal = self.goals.get(plant.pilot_goal()).map(|goal| goal.id);
        self.poses = poses(plant);
        self
    }
}

impl Named {
    fn of(action: Action, space: &ActionSpace) -> Self {
        let axes = if let Action::Axes(axes) = action { Some(axes) } else { None };
        Self { label: space.label(action), command: action.command(), axes }
    }
}

/// The smallest Q′ that a rule allows, for the overlay to draw; the rule itself decides by
/// [`Arbiter`](crate::arbitration::Arbiter), and a test holds the two together.
fn threshold(rule: &Rule, confidence: f32, values: &ActionValues, median_range: Option<f64>) -> Option<f64> {
    match *rule {
        Rule::Misc => Some(f64::from(confidence) * values.range()),
        Rule::Tolerance { alpha } => Some((1.0 - alpha) * values.range()),
        Rule::MiscR { kappa } => median_range.map(|median| (values.range() - kappa * median).max(0.0)),
        _ => None,
    }
}

fn poses(plant: &dyn Plant) -> Vec<Pose> {
    let mut poses = Vec::new();
    plant.poses(&mut poses);
    poses
}
