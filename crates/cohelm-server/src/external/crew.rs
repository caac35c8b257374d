//! The setup and the cockpit of an episode elsewhere.

use super::words::Wish;
use cohelm::arbitration::Rule;
use cohelm::cockpit::{Cockpit, Silence};
use cohelm::intent::{Head, Inference};
use cohelm::plant::Plant;
use cohelm::tape;
use cohelm::trajectory::{MAX_SEED, Setup};
use cohelm_copilot::cockpit::fits;
use cohelm_copilot::{Kind, Model, Models, cockpit};
use cohelm_external::External;

/// The setup that a wish means for a plant, with the newest models that fit it by their cards, and its cockpit.
///
/// Without values that fit the person flies alone, whatever was wished: no rule knows better then. When nothing is asked nothing is carried out, whatever the rule: a machine moves only while somebody holds on.
pub fn crew(wish: Wish, plant: &External, models: &Models) -> Result<(Setup, Cockpit), String> {
    let mut setup = Setup {
        task: tape::task(plant.name()),
        plant_version: tape::VERSION,
        seed: wish.seed.min(MAX_SEED),
        rule: wish.rule,
        inference: Inference::Nearest,
        silence: Silence::Nothing,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: "person".into(),
    };
    setup.values = newest(Kind::Values, &setup, plant, models);
    if setup.values.is_none() {
        setup.rule = Rule::Hic;
    }
    setup.intent = newest(Kind::Intent, &setup, plant, models);
    if setup.intent.is_some() {
        setup.inference = Head::Calibrated.into();
    }
    let cockpit = cockpit(&setup, plant, &tape::plants(), models).map_err(|error| error.to_string())?;
    Ok((setup, cockpit))
}

/// The hash of the newest model that was trained for the plant of exactly this name, and fits it.
fn newest(kind: Kind, setup: &Setup, plant: &dyn Plant, models: &Models) -> Option<String> {
    let fitting = |model: &&Model| {
        let card = model.card();
        card.kind == kind && card.task == setup.task && fits(card, setup, plant).is_ok()
    };
    models.iter().rev().find(fitting).map(|model| model.hash().to_owned())
}
