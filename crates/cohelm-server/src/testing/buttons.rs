//! The point steered by five buttons, so that networks can assist, and networks for it.

use cohelm::action::{Action, ActionSpace, Push};
use cohelm::plant::{Plant, Step, View};
use cohelm::point::Point;
use cohelm::registry::{PlantEntry, Task};
use cohelm::scene::{Pose, Scene};
use cohelm_copilot::encode::{VALUES_VERSION, ValueEncoder};
use cohelm_copilot::{Card, Model};
use cohelm_nn::mlp::{Head, Mlp, MlpShape};
use serde_json::json;

const NAMES: [&str; 5] = ["nothing", "left", "right", "down", "up"];
const PUSHES: [[f32; 2]; 5] = [[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];

struct Buttons {
    point: Point,
    space: ActionSpace,
}

impl Buttons {
    fn new() -> Self {
        let push =
            |i: usize| (i > 0).then(|| Push { axis: (i as u8 - 1) / 2, forwards: [2, 4].contains(&i) });
        let names = NAMES.map(String::from).to_vec();
        let space = ActionSpace::Single { names, pushes: (0..5).map(push).collect() };
        Self { point: Point::new(), space }
    }
}

impl Plant for Buttons {
    fn reset(&mut self, seed: u64) {
        self.point.reset(seed);
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        let command = executed.and_then(|action| action.command()).unwrap_or(0);
        self.point.step(Some(Action::axes(&PUSHES[command])))
    }

    fn view(&self) -> View<'_> {
        self.point.view()
    }

    fn pilot_goal(&self) -> usize {
        self.point.pilot_goal()
    }

    fn space(&self) -> &ActionSpace {
        &self.space
    }

    fn scene(&self) -> Scene {
        self.point.scene()
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        self.point.poses(poses);
    }
}

pub fn entry() -> PlantEntry {
    PlantEntry {
        name: "buttons",
        version: 3,
        summary: "The point with buttons.",
        make: |_| Ok(Box::new(Buttons::new())),
        values: None,
        skill: None,
        actions: &[],
        preset: "default",
    }
}

/// A value network for the buttons; other numbers give other weights.
pub fn model(number: u32) -> Model {
    model_for(number, Task::new("buttons"), entry().version)
}

/// The same for buttons that go by another name.
pub fn model_for(number: u32, task: Task, plant_version: u32) -> Model {
    let plant = Buttons::new();
    // As JSON, which leaves out what a card need not say.
    let card: Card = serde_json::from_value(json!({
        "name": format!("buttons-{number}"),
        "kind": "values",
        "task": task,
        "plant_version": plant_version,
        "space": plant.space,
        "state": plant.view().state.len(),
        "goals": 2,
        "encoder_version": VALUES_VERSION,
        "seed": number,
        "options": {},
        "trained_with": { "cohelm": "0.1.0", "kernel": "none" },
        "median_range": 1.0,
        "scores": {},
    }))
    .unwrap();
    let inputs = ValueEncoder::new(card.state, 0).len();
    let mut network = Mlp::zeros(&MlpShape::new(inputs, &[8], Head::Plain(NAMES.len())).unwrap());
    for (i, weight) in network.params_mut().iter_mut().enumerate() {
        *weight = ((i as f32 + 1.0) * (number as f32 + 1.0) * 0.7).sin();
    }
    Model::of_values(&card, &network).unwrap()
}
