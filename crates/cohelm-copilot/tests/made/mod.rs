//! Models with random weights: as good as trained ones for everything but flying.
#![allow(dead_code, reason = "each test file uses its part")]

use cohelm::random::Draws;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::encode::{INTENT_VERSION, IntentEncoder, VALUES_VERSION, ValueEncoder};
use cohelm_copilot::model::IntentNetworks;
use cohelm_copilot::outputs::Outputs;
use cohelm_copilot::search::Search;
use cohelm_copilot::{Card, Kind, Model, TrainedWith};
use cohelm_nn::critic::Critic;
use cohelm_nn::goal_head;
use cohelm_nn::lstm::{Lstm, LstmShape};
use cohelm_nn::mlp::{Head, Mlp, MlpShape};
use serde_json::json;

pub fn plants() -> Plants {
    let mut plants = Plants::default();
    plants.register(cohelm_lander::flags::entry());
    plants.register(cohelm::point::entry());
    plants
}

pub fn task() -> Task {
    Task::new("flag-lander")
}

pub fn card(kind: Kind, task: &Task) -> Card {
    let plant = plants().make(task).unwrap();
    Card {
        name: "random".into(),
        kind,
        variant: None,
        task: task.clone(),
        plant_version: plants().entry(task).unwrap().version,
        space: plant.space().clone(),
        state: plant.view().state.len(),
        goals: plant.view().goals.len(),
        goal_spread: None,
        encoder_version: if kind == Kind::Values { VALUES_VERSION } else { INTENT_VERSION },
        sees_asked: false,
        free_outputs: false,
        seed: 0,
        options: json!({}),
        trained_with: TrainedWith { cohelm: "0".into(), kernel: "none".into() },
        median_range: Some(0.3),
        scores: json!({}),
    }
}

pub fn values_network(card: &Card, seed: u64) -> Mlp {
    let outputs = Outputs::of(&card.space).unwrap();
    let inputs = ValueEncoder::new(card.state, if card.sees_asked { outputs.commands() } else { 0 }).len();
    let shape = MlpShape::new(inputs, &[64, 64], Head::Dueling(outputs.len())).unwrap();
    let mut draws = Draws::new(seed);
    Mlp::new(&shape, || draws.unit() as f32)
}

pub fn values(seed: u64) -> Model {
    let card = card(Kind::Values, &task());
    Model::of_values(&card, &values_network(&card, seed)).unwrap()
}

pub fn axes_task() -> Task {
    task().with("actions", "continuous")
}

pub fn critic(card: &Card, seed: u64) -> Critic {
    let inputs = ValueEncoder::new(card.state, 0).len();
    let shape = Search::shape(&card.space, inputs, &[64, 64]).unwrap();
    let mut draws = Draws::new(seed);
    Critic::new(&shape, || draws.unit() as f32)
}

pub fn values_on_axes(seed: u64) -> Model {
    let card = card(Kind::Values, &axes_task());
    Model::of_values(&card, &critic(&card, seed)).unwrap()
}

pub fn intent_on_axes(seed: u64) -> Model {
    let card = card(Kind::Intent, &axes_task());
    Model::of_intent(&card, &intent_networks(&card, seed)).unwrap()
}

pub fn intent_networks(card: &Card, seed: u64) -> IntentNetworks {
    let encoder = IntentEncoder::new(&card.space, card.state, card.goals).unwrap();
    let mut draws = Draws::new(seed);
    let mut lstm =
        |input, output| Lstm::new(LstmShape::new(input, 64, output).unwrap(), || draws.unit() as f32);
    IntentNetworks {
        regression: lstm(encoder.without_goals(), 2),
        calibrated: lstm(encoder.with_goals(), goal_head::OUTPUTS),
    }
}

pub fn intent(seed: u64) -> Model {
    let card = card(Kind::Intent, &task());
    Model::of_intent(&card, &intent_networks(&card, seed)).unwrap()
}

/// Intent that knows no goals.
pub fn imagining(seed: u64) -> Model {
    let card = Card { goals: 0, goal_spread: Some(0.4), ..card(Kind::Intent, &task()) };
    Model::of_intent(&card, &intent_networks(&card, seed)).unwrap()
}

pub fn imagining_on_axes(seed: u64) -> Model {
    let card = Card { goals: 0, goal_spread: Some(0.4), ..card(Kind::Intent, &axes_task()) };
    Model::of_intent(&card, &intent_networks(&card, seed)).unwrap()
}
