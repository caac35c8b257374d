//! Models with random weights: they fly badly, and use every function that trained ones use.

use cohelm::plant::Plant;
use cohelm::random::Draws;
use cohelm::registry::Task;
use cohelm_copilot::encode::{INTENT_VERSION, IntentEncoder, VALUES_VERSION, ValueEncoder};
use cohelm_copilot::model::IntentNetworks;
use cohelm_copilot::outputs::Outputs;
use cohelm_copilot::search::Search;
use cohelm_copilot::{Card, Kind, Model, TrainedWith, ValueNetwork};
use cohelm_nn::critic::Critic;
use cohelm_nn::goal_head;
use cohelm_nn::lstm::{Lstm, LstmShape};
use cohelm_nn::mlp::{Head, Mlp, MlpShape};
use std::error::Error;

/// A value model and an intent model for a task, or none if its plant has no actions. The sizes are those of shipped models.
pub fn random_models(
    task: &Task,
    version: u32,
    plant: &dyn Plant,
) -> Result<Option<[Model; 2]>, Box<dyn Error>> {
    let view = plant.view();
    let (state, goals) = (view.state.len(), view.goals.len());
    let mut draws = Draws::new(17);
    let mut uniform = || draws.unit() as f32;

    let inputs = ValueEncoder::new(state, 0).len();
    let values: ValueNetwork =
        match (Outputs::of(plant.space()), Search::shape(plant.space(), inputs, &[64, 64])) {
            (Some(outputs), _) => {
                let shape = MlpShape::new(inputs, &[128, 128], Head::Dueling(outputs.len()))?;
                (&Mlp::new(&shape, &mut uniform)).into()
            }
            (None, Some(shape)) => (&Critic::new(&shape, &mut uniform)).into(),
            (None, None) => return Ok(None),
        };

    let Some(encoder) = IntentEncoder::new(plant.space(), state, goals) else { return Ok(None) };
    let mut lstm = |inputs, outputs| -> Result<Lstm, Box<dyn Error>> {
        Ok(Lstm::new(LstmShape::new(inputs, 64, outputs)?, &mut uniform))
    };
    let regression = lstm(encoder.without_goals(), 2)?;
    let calibrated = lstm(encoder.with_goals(), goal_head::OUTPUTS)?;

    let card = |kind, encoder_version, median_range| Card {
        name: "random".into(),
        kind,
        variant: None,
        task: task.clone(),
        plant_version: version,
        space: plant.space().clone(),
        state,
        goals,
        goal_spread: None,
        encoder_version,
        sees_asked: false,
        free_outputs: false,
        seed: 17,
        options: serde_json::json!({}),
        trained_with: TrainedWith { cohelm: env!("CARGO_PKG_VERSION").into(), kernel: "none".into() },
        median_range,
        scores: serde_json::json!({}),
    };
    Ok(Some([
        Model::of_values(&card(Kind::Values, VALUES_VERSION, Some(0.1)), &values)?,
        Model::of_intent(
            &card(Kind::Intent, INTENT_VERSION, None),
            &IntentNetworks { regression, calibrated },
        )?,
    ]))
}
