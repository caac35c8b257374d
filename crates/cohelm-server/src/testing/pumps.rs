//! The point with two pumps, which stay as they were switched, and values that always prefer them on.

use cohelm::action::{Action, ActionSpace, Push, Switch};
use cohelm::plant::{Plant, Step, View};
use cohelm::point::Point;
use cohelm::registry::Task;
use cohelm::scene::{Pose, Scene};
use cohelm_copilot::encode::{VALUES_VERSION, ValueEncoder};
use cohelm_copilot::{Card, Model};
use cohelm_nn::mlp::{Head, Mlp, MlpShape};
use serde_json::json;

/// The point stays where it is: pumps push nothing.
pub struct Pumps {
    point: Point,
    space: ActionSpace,
    on: u8,
}

impl Pumps {
    pub fn new() -> Self {
        let pump = |i: u8| Switch { name: format!("pump {i}"), push: Push { axis: i, forwards: true } };
        Self { point: Point::new(), space: ActionSpace::Switches { switches: vec![pump(0), pump(1)] }, on: 0 }
    }
}

impl Plant for Pumps {
    fn reset(&mut self, seed: u64) {
        self.point.reset(seed);
        self.on = 0;
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        if let Some(command) = executed.and_then(|action| action.command()) {
            let bit = 1 << (command / 2);
            self.on = if command % 2 == 0 { self.on | bit } else { self.on & !bit };
        }
        self.point.step(None)
    }

    fn view(&self) -> View<'_> {
        View { switches: self.on, ..self.point.view() }
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

/// A value network to which *on* is worth 1 and *off* nothing, whatever it sees.
pub fn model_that_prefers_on(task: Task, plant_version: u32) -> Model {
    let plant = Pumps::new();
    let card: Card = serde_json::from_value(json!({
        "name": "pumps",
        "kind": "values",
        "task": task,
        "plant_version": plant_version,
        "space": plant.space,
        "state": plant.view().state.len(),
        "goals": 2,
        "free_outputs": true,
        "encoder_version": VALUES_VERSION,
        "seed": 1,
        "options": {},
        "trained_with": { "cohelm": "0.1.0", "kernel": "none" },
        "median_range": 1.0,
        "scores": {},
    }))
    .unwrap();
    let inputs = ValueEncoder::new(card.state, 0).len();
    let mut network = Mlp::zeros(&MlpShape::new(inputs, &[8], Head::Plain(4)).unwrap());
    let worth = [1.0, 0.0, 1.0, 0.0];
    let biases = network.params_mut().iter_mut().rev().zip(worth.iter().rev());
    biases.for_each(|(bias, worth)| *bias = *worth);
    Model::of_values(&card, &network).unwrap()
}
