//! The smallest plant: a point that is pushed along two axes and comes to rest at one of two goals.
//!
//! It is here to show, in one screen, all that a plant needs; tests carry it through tick, store, replay and page.

use crate::action::{Action, ActionSpace};
use crate::human::{Axis, Plan, Seen, Skill};
use crate::keys::{NoControl, control_named};
use crate::plant::{Ending, Goal, Plant, Step, View};
use crate::random::Draws;
use crate::registry::PlantEntry;
use crate::scene::{Part, Pose, Role, Scene, Shape};
use crate::value::{ActionValues, ValueModel};

/// Seconds a tick lasts.
const TICK_S: f32 = 0.02;
/// Units a second squared at full push: more is livelier.
const PUSH: f32 = 2.0;
/// Share of the speed lost in a second: more is easier to stop.
const DRAG: f32 = 1.0;
/// Ticks an episode may last.
const LIMIT: u32 = 500;
/// How near and how slow (units, units a second) counts as being there.
const REACH: f32 = 0.1;

/// A point in the square from −1 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    space: ActionSpace,
    tick: u32,
    state: [f32; 4],
    push: [f32; 2],
    goals: [Goal; 2],
    wanted: usize,
}

impl Point {
    /// The point of seed 0.
    pub fn new() -> Self {
        let names = vec!["x".into(), "y".into()];
        let space = ActionSpace::Axes { names, low: vec![-1.0; 2], high: vec![1.0; 2] };
        let goals = [0, 1].map(|id| Goal { id, position: [0.0; 2] });
        let mut point = Self { space, tick: 0, state: [0.0; 4], push: [0.0; 2], goals, wanted: 0 };
        point.reset(0);
        point
    }

    fn ending(&self) -> Option<Ending> {
        let [x, y, vx, vy] = self.state;
        let at = |goal: &Goal| libm::hypotf(goal.position[0] - x, goal.position[1] - y) < REACH;
        let rests = libm::hypotf(vx, vy) < REACH;
        if rests && self.goals.iter().any(at) {
            return Some(if at(&self.goals[self.wanted]) { Ending::Goal } else { Ending::Elsewhere });
        }
        let out = x.abs() > 1.0 || y.abs() > 1.0;
        let late = (self.tick >= LIMIT).then_some(Ending::TimeLimit);
        if out { Some(Ending::OutOfBounds) } else { late }
    }
}

impl Default for Point {
    fn default() -> Self {
        Self::new()
    }
}

impl Plant for Point {
    fn reset(&mut self, seed: u64) {
        let mut draws = Draws::new(seed);
        self.goals[0].position = [draws.uniform(-0.8, -0.2) as f32, 0.6];
        self.goals[1].position = [draws.uniform(0.2, 0.8) as f32, 0.6];
        self.wanted = draws.below(2);
        (self.tick, self.state, self.push) = (0, [0.0, -0.7, 0.0, 0.0], [0.0; 2]);
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        self.push = executed.map_or([0.0; 2], |action| [action.axis(0), action.axis(1)]);
        for i in 0..2 {
            self.state[2 + i] += (PUSH * self.push[i] - DRAG * self.state[2 + i]) * TICK_S;
            self.state[i] += self.state[2 + i] * TICK_S;
        }
        self.tick += 1;
        let ending = self.ending();
        Step { reward: f64::from(u8::from(ending == Some(Ending::Goal))), ending }
    }

    fn view(&self) -> View<'_> {
        let position = [self.state[0], self.state[1]];
        View { tick: self.tick, state: &self.state, position, switches: 0, goals: &self.goals }
    }

    fn pilot_goal(&self) -> usize {
        self.wanted
    }

    fn space(&self) -> &ActionSpace {
        &self.space
    }

    fn limit_ticks(&self) -> Option<u32> {
        Some(LIMIT)
    }

    fn scene(&self) -> Scene {
        let disc = |center, radius| vec![Shape::Disc { center, radius }];
        let goal =
            |goal: &Goal| Part { role: Role::Goal, goal: Some(goal.id), shapes: disc(goal.position, REACH) };
        let body = Part { role: Role::Body, goal: None, shapes: disc([0.0; 2], 0.04) };
        let fixed = self.goals.iter().map(goal).collect();
        Scene {
            bounds: [-1.0, -1.0, 1.0, 1.0],
            fixed,
            movable: vec![body],
            origin: [0.0; 2],
            scale: [1.0; 2],
        }
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        poses.clear();
        poses.push(Pose { x: self.state[0], y: self.state[1], angle_rad: 0.0, strength: 1.0 });
    }

    fn snapshot(&self) -> Option<Box<dyn Plant>> {
        Some(Box::new(self.clone()))
    }

    fn set_pilot_goal(&mut self, goal: usize) -> bool {
        let known = goal < self.goals.len();
        if known {
            self.wanted = goal;
        }
        known
    }
}

/// Hand-made values: how near a push would bring the point to where it should brake, over nine pushes and the asked.
struct PointValues(ActionValues);

impl PointValues {
    fn new() -> Self {
        let push = |i: usize| Action::axes(&[(i % 3) as f32 - 1.0, (i / 3) as f32 - 1.0]);
        let candidates = (0..10).map(|i| push(i.min(8))).collect();
        Self(ActionValues::equal(candidates).expect("ten candidates are not none"))
    }
}

impl ValueModel for PointValues {
    fn estimate(&mut self, view: &View<'_>, goal: usize, asked: Option<Action>) -> &ActionValues {
        self.0.set_candidate(9, asked.unwrap_or(Action::Axes([0.0; 4])));
        let ideal = ideal_push(view, goal);
        let mut values = [0.0; 10];
        for (value, candidate) in values.iter_mut().zip(self.0.candidates()) {
            *value = nearness(*candidate, ideal);
        }
        self.0.refill(&values).expect("a finite state has finite values");
        &self.0
    }

    fn assess(
        &mut self,
        view: &View<'_>,
        goal: usize,
        actions: &[Action],
        _asked: Option<Action>,
        values: &mut Vec<f32>,
    ) {
        let ideal = ideal_push(view, goal);
        values.clear();
        values.extend(actions.iter().map(|&action| nearness(action, ideal)));
    }
}

/// The push that brings the point to the goal without shooting past it.
fn ideal_push(view: &View<'_>, goal: usize) -> [f32; 2] {
    let wanted = view.goals.get(goal).map_or(view.position, |goal| goal.position);
    [0, 1].map(|i| (10.0 * (wanted[i] - view.position[i]) - 6.0 * view.state[2 + i]).clamp(-1.0, 1.0))
}

fn nearness(push: Action, ideal: [f32; 2]) -> f32 {
    -libm::hypotf(push.axis(0) - ideal[0], push.axis(1) - ideal[1])
}

/// What a person tries to do: go towards the goal, slower the nearer.
struct Pushing(Plan);

impl Pushing {
    fn new(space: &ActionSpace) -> Result<Self, NoControl> {
        let axis = |name, minus, plus| -> Result<Axis, NoControl> {
            let (minus, plus) = (control_named(space, minus, minus)?, control_named(space, plus, plus)?);
            Ok(Axis { name, plus: Some(plus), minus: Some(minus), release: 0.3, droppable: true })
        };
        let axes = vec![axis("x", "x −", "x +")?, axis("y", "y −", "y +")?];
        Ok(Self(Plan { axes, moving: vec![0, 1, 2, 3], judged: vec![2, 3], shown: vec![] }))
    }
}

impl Skill for Pushing {
    fn plan(&self) -> &Plan {
        &self.0
    }

    fn errors(&self, seen: &Seen<'_>, errors: &mut [f64]) {
        for (i, error) in errors.iter_mut().enumerate() {
            let wanted_speed = (seen.goal[i] - seen.state[i]).clamp(-0.6, 0.6);
            *error = (wanted_speed - seen.state[2 + i]) / 0.05;
        }
    }
}

/// The point's entry in a registry, under the name `point`.
pub fn entry() -> PlantEntry {
    PlantEntry {
        name: "point",
        version: 1,
        summary: "A point on a plane and two goals: the smallest plant, for trying things out.",
        make: |options| match options.as_object() {
            Some(options) if options.is_empty() => Ok(Box::new(Point::new())),
            _ => Err(format!("the point has no options, got {options}")),
        },
        values: Some(|| Box::new(PointValues::new())),
        skill: Some(|space, _| Ok(Box::new(Pushing::new(space).map_err(|error| error.to_string())?))),
        actions: &[],
        preset: "default",
    }
}
