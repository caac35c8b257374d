//! The setup and the cockpit of an episode elsewhere.

use super::words::Wish;
use cohelm::action::ActionSpace;
use cohelm::arbitration::Rule;
use cohelm::cockpit::{Cockpit, Silence};
use cohelm::intent::{Head, Inference};
use cohelm::plant::Plant;
use cohelm::tape;
use cohelm::trajectory::Setup;
use cohelm_copilot::cockpit::fits;
use cohelm_copilot::{Kind, Model, Models, cockpit};
use cohelm_external::External;

/// The setup that a wish means for a plant, with the newest models that fit it by their cards, and its cockpit.
///
/// Without values that fit the person flies alone, whatever was wished: no rule knows better then. When nothing is asked
/// nothing is carried out, whatever the rule: a machine moves only while somebody holds on.
///
/// A switch stays as it was set, so letting go of one is to ask for *off*: a request like any other, for which a rule may
/// carry out something else, such as *on*. Letting go must stop a machine, so whoever flies switches flies alone.
pub fn crew(wish: Wish, plant: &External, models: &Models) -> Result<(Setup, Cockpit), String> {
    let mut setup = Setup {
        task: tape::task(plant.name()),
        plant_version: tape::VERSION,
        seed: wish.seed,
        rule: wish.rule,
        inference: Inference::Nearest,
        silence: Silence::Nothing,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: "person".into(),
    };
    if !has_switches(plant) {
        setup.values = newest(Kind::Values, &setup, plant, models);
    }
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

/// Why a plant without values is flown alone, for people.
pub fn why_alone(plant: &External) -> &'static str {
    if has_switches(plant) {
        "this plant has switches, which stay as they were set; it is flown without a co-pilot, since one could keep them on \
         when they are let go of"
    } else {
        "no values fit this plant, so there is no co-pilot"
    }
}

fn has_switches(plant: &dyn Plant) -> bool {
    matches!(plant.space(), ActionSpace::Switches { .. })
}

/// The hash of the newest model that was trained for the plant of exactly this name, and fits it.
fn newest(kind: Kind, setup: &Setup, plant: &dyn Plant, models: &Models) -> Option<String> {
    let fitting = |model: &&Model| {
        let card = model.card();
        card.kind == kind && card.task == setup.task && fits(card, setup, plant).is_ok()
    };
    models.iter().rev().find(fitting).map(|model| model.hash().to_owned())
}
