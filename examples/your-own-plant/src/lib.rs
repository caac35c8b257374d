//! A lift that is to stop at one of three floors: a plant of cohelm, whole, in one file.

use cohelm::action::{Action, ActionSpace, Push};
use cohelm::plant::{Ending, Goal, Plant, Step, View};
use cohelm::random::Draws;
use cohelm::registry::PlantEntry;
use cohelm::scene::{Part, Pose, Role, Scene, Shape};

/// Seconds a tick lasts: twenty a second.
const TICK_S: f32 = 0.05;
/// Units a second squared that the motor gives: more is livelier.
const PULL: f32 = 1.2;
/// Share of the speed lost in a second: more is easier to stop.
const FRICTION: f32 = 0.3;
/// How near (units) and how slow (units a second) counts as standing at a floor.
const NEAR: f32 = 0.06;
const SLOW: f32 = 0.12;
/// Ticks an episode may last: fifteen seconds.
const LIMIT: u32 = 300;
/// Where the floors are; the shaft reaches from −1 to 1.
const FLOORS: [f32; 3] = [-0.7, 0.0, 0.7];

/// The lift.
pub struct Lift {
    space: ActionSpace,
    goals: [Goal; 3],
    wanted: usize,
    tick: u32,
    /// Height, and speed upwards in units a second.
    state: [f32; 2],
}

impl Default for Lift {
    fn default() -> Self {
        let push = |forwards| Some(Push { axis: 0, forwards });
        let names = ["coast", "up", "down"].map(String::from).to_vec();
        let space = ActionSpace::Single { names, pushes: vec![None, push(true), push(false)] };
        let goals = [0, 1, 2].map(|id| Goal { id, position: [0.0, FLOORS[id as usize]] });
        Self { space, goals, wanted: 0, tick: 0, state: [0.0; 2] }
    }
}

impl Lift {
    fn ending(&self) -> Option<Ending> {
        let [height, speed] = self.state;
        let stands = |floor: f32| (height - floor).abs() < NEAR && speed.abs() < SLOW;
        if let Some(floor) = FLOORS.iter().position(|&floor| stands(floor)) {
            return Some(if floor == self.wanted { Ending::Goal } else { Ending::Elsewhere });
        }
        let late = (self.tick >= LIMIT).then_some(Ending::TimeLimit);
        if height.abs() > 1.0 { Some(Ending::Crash) } else { late }
    }
}

impl Plant for Lift {
    fn reset(&mut self, seed: u64) {
        self.reset_near_goal(seed, 1.0);
    }

    /// The nearer to the goal, the easier: training begins there and widens.
    fn reset_near_goal(&mut self, seed: u64, difficulty: f64) -> bool {
        let mut draws = Draws::new(seed);
        self.wanted = draws.below(3);
        let anywhere = draws.uniform(-0.9, 0.9) as f32;
        let goal = FLOORS[self.wanted];
        let height = goal + difficulty as f32 * (anywhere - goal);
        let speed = draws.uniform(-0.5, 0.5) as f32;
        // Fast enough that no episode begins standing at a floor.
        (self.tick, self.state) = (0, [height, speed + SLOW * speed.signum()]);
        true
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        let goal = FLOORS[self.wanted];
        let before = (self.state[0] - goal).abs();
        let pull = match executed.and_then(|action| action.command()) {
            Some(1) => 1.0,
            Some(2) => -1.0,
            _ => 0.0,
        };
        self.state[1] += (PULL * pull - FRICTION * self.state[1]) * TICK_S;
        self.state[0] += self.state[1] * TICK_S;
        self.tick += 1;
        let ending = self.ending();
        let arrived = match ending {
            Some(Ending::Goal) => 1.0,
            Some(Ending::Elsewhere | Ending::Crash) => -1.0,
            _ => 0.0,
        };
        Step { reward: f64::from(arrived + before - (self.state[0] - goal).abs()), ending }
    }

    fn view(&self) -> View<'_> {
        let position = [0.0, self.state[0]];
        View { tick: self.tick, state: &self.state, position, switches: 0, goals: &self.goals }
    }

    fn pilot_goal(&self) -> usize {
        self.wanted
    }

    fn space(&self) -> &ActionSpace {
        &self.space
    }

    fn ticks_per_second(&self) -> f64 {
        f64::from(1.0 / TICK_S)
    }

    fn scene(&self) -> Scene {
        let disc = |at, radius| vec![Shape::Disc { center: [0.0, at], radius }];
        let floor = |goal: &Goal| {
            let shapes = disc(goal.position[1], 1.5 * NEAR);
            Part { role: Role::Goal, goal: Some(goal.id), shapes }
        };
        let cabin = Part { role: Role::Body, goal: None, shapes: disc(0.0, NEAR) };
        let fixed = self.goals.iter().map(floor).collect();
        Scene {
            bounds: [-1.5, -1.0, 1.5, 1.0],
            fixed,
            movable: vec![cabin],
            origin: [0.0; 2],
            scale: [1.0; 2],
        }
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        poses.clear();
        poses.push(Pose { x: 0.0, y: self.state[0], angle_rad: 0.0, strength: 1.0 });
    }
}

/// The lift's entry in a registry.
pub fn entry() -> PlantEntry {
    PlantEntry {
        name: "lift",
        version: 1,
        summary: "A lift that is to stop at one of three floors.",
        make: |options| match options.as_object() {
            Some(options) if options.is_empty() => Ok(Box::new(Lift::default())),
            _ => Err(format!("the lift has no options, got {options}")),
        },
        values: None,
        skill: None,
        actions: &[],
        preset: "default",
    }
}
