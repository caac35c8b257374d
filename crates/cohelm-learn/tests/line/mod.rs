//! A plant that learns in a second: a place on a line and a goal at each end.
#![allow(dead_code, reason = "each test file uses its part")]

use cohelm::action::{Action, ActionSpace, Push};
use cohelm::pilot::Pilot;
use cohelm::plant::{Ending, Goal, Mirror, Plant, Step, View};
use cohelm::random::Draws;
use cohelm::registry::{PlantEntry, Plants, Task};
use cohelm::scene::{Pose, Scene};
use cohelm_learn::{IntentOptions, Job, ValueOptions};
use std::num::NonZeroUsize;
use std::path::Path;

/// Places on either side of the middle.
const HALF: i32 = 8;
/// Ticks an episode may last.
const LIMIT: u32 = 60;

pub struct Line {
    /// Commands to stay and to go; or an axis that goes one place if it is beyond half.
    space: ActionSpace,
    tick: u32,
    place: i32,
    wanted: usize,
    state: [f32; 2],
}

const GOALS: [Goal; 2] = [Goal { id: 0, position: [-1.0, 0.0] }, Goal { id: 1, position: [1.0, 0.0] }];

impl Line {
    pub fn new() -> Self {
        let push = |forwards| Some(Push { axis: 0, forwards });
        let names = ["stay", "left", "right"].map(String::from).to_vec();
        let space = ActionSpace::Single { names, pushes: vec![None, push(false), push(true)] };
        Self { space, tick: 0, place: 0, wanted: 0, state: [0.0; 2] }
    }

    pub fn with_an_axis() -> Self {
        let space = ActionSpace::Axes { names: vec!["push".into()], low: vec![-1.0], high: vec![1.0] };
        Self { space, ..Self::new() }
    }

    fn begin(&mut self, seed: u64, difficulty: f64) {
        self.wanted = Draws::new(seed).below(2);
        let end = if self.wanted == 0 { 1 - HALF } else { HALF - 1 };
        self.place = (f64::from(end) * (1.0 - difficulty)) as i32;
        self.tick = 0;
        self.see();
    }

    fn see(&mut self) {
        self.state = [self.place as f32 / HALF as f32, 1.0];
    }
}

impl Plant for Line {
    fn reset(&mut self, seed: u64) {
        self.begin(seed, 1.0);
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        self.place += match executed {
            Some(Action::Command(1)) => -1,
            Some(Action::Command(2)) => 1,
            Some(Action::Axes([push, ..])) => i32::from(push > 0.5) - i32::from(push < -0.5),
            _ => 0,
        };
        self.tick += 1;
        self.see();
        let at = if self.place == -HALF { Some(0) } else { (self.place == HALF).then_some(1) };
        let late = (self.tick >= LIMIT).then_some(Ending::TimeLimit);
        let ending = at.map(|at| if at == self.wanted { Ending::Goal } else { Ending::Elsewhere }).or(late);
        let worth = match ending {
            Some(Ending::Goal) => 1.0,
            Some(Ending::Elsewhere) => -1.0,
            _ => -0.01,
        };
        Step { reward: worth, ending }
    }

    fn view(&self) -> View<'_> {
        View {
            tick: self.tick,
            state: &self.state,
            position: [self.state[0], 0.0],
            switches: 0,
            goals: &GOALS,
        }
    }

    fn pilot_goal(&self) -> usize {
        self.wanted
    }

    fn space(&self) -> &ActionSpace {
        &self.space
    }

    fn scene(&self) -> Scene {
        let bounds = [-1.0, -1.0, 1.0, 1.0];
        Scene { bounds, fixed: vec![], movable: vec![], origin: [0.0; 2], scale: [1.0; 2] }
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        poses.clear();
    }

    fn reset_near_goal(&mut self, seed: u64, difficulty: f64) -> bool {
        self.begin(seed, difficulty);
        true
    }

    fn mirror(&self) -> Option<Mirror> {
        let state = vec![(0, -1.0), (1, 1.0)];
        Some(Mirror { state, position: [-1.0, 1.0], commands: vec![0, 2, 1], axes: vec![(0, -1.0)] })
    }

    fn teacher(&mut self, goal: usize) -> Option<Action> {
        Some(match self.space {
            ActionSpace::Axes { .. } => Action::axes(&[2.0 * goal as f32 - 1.0]),
            _ => Action::Command(1 + goal as u8),
        })
    }
}

pub fn entry() -> PlantEntry {
    PlantEntry {
        name: "line",
        version: 1,
        summary: "a line with a goal at each end",
        make: |options| {
            let axis = options.get("actions").is_some();
            Ok(Box::new(if axis { Line::with_an_axis() } else { Line::new() }))
        },
        values: None,
        skill: None,
        actions: &[],
        preset: "default",
    }
}

/// Asks for the way to its goal, and now and then for something else.
pub struct Walker {
    draws: Draws,
    mistakes: f64,
    axis: bool,
}

impl Pilot for Walker {
    fn begin(&mut self, seed: u64) {
        self.draws = Draws::new(seed);
    }

    fn ask(&mut self, _view: &View<'_>, goal: usize) -> Option<Action> {
        let command = match self.draws.chance(self.mistakes) {
            true => Some(self.draws.below(3) as u8),
            false => self.draws.chance(0.7).then_some(1 + goal as u8),
        };
        let push = |command| Action::axes(&[[0.0, -1.0, 1.0][usize::from(command)]]);
        command.map(|command| if self.axis { push(command) } else { Action::Command(command) })
    }
}

pub fn walker(plant: &dyn Plant, number: u64) -> Result<Box<dyn Pilot>, String> {
    let mistakes = 0.1 + 0.02 * (number % 10) as f64;
    Ok(Box::new(Walker { draws: Draws::new(number), mistakes, axis: plant.space().commands() == 0 }))
}

/// What every test needs to stay alive.
pub struct Bench {
    pub plants: Plants,
    pub task: Task,
}

impl Bench {
    pub fn new() -> Self {
        let mut plants = Plants::default();
        plants.register(entry());
        Self { plants, task: Task::new("line") }
    }

    /// The same line, gone along by an axis.
    pub fn with_an_axis() -> Self {
        Self { task: Task::new("line").with("actions", "axis"), ..Self::new() }
    }

    pub fn job<'a>(&'a self, seed: u64, threads: usize, checkpoints: Option<&'a Path>) -> Job<'a> {
        let threads = NonZeroUsize::new(threads).expect("at least one");
        let (plants, task) = (&self.plants, &self.task);
        Job { plants, task, seed, threads, checkpoints, name: "line", variant: None }
    }
}

/// Options that learn the line in a second.
pub fn small() -> ValueOptions {
    ValueOptions {
        steps: 8_000,
        worlds: 4,
        hidden: vec![16],
        batch: 32,
        memory: 5_000,
        warm_up: 500,
        learning_rate: [3e-3, 3e-4],
        discount: 0.95,
        advantage: 0.5,
        validation_episodes: 20,
        validations: 2,
        ..ValueOptions::default()
    }
}

/// Options that learn intent on the line in a second.
pub fn small_intent() -> IntentOptions {
    IntentOptions {
        pilots: 6,
        first_episodes: 30,
        rounds: 1,
        round_episodes: 45,
        cells: 8,
        epochs: 8,
        batch: 8,
        learning_rate: 1e-2,
        test_pilots: 3,
        test_episodes: 6,
        ..IntentOptions::default()
    }
}
