//! The cockpit that a setup describes.

use crate::card::{Card, Kind};
use crate::intent::{ImaginedIntent, NetworkIntent};
use crate::model::{IntentNetworks, Model, Network};
use crate::models::Models;
use crate::values::NetworkValues;
use cohelm::arbitration::RuleError;
use cohelm::cockpit::Cockpit;
use cohelm::intent::{
    Evidence, EvidenceError, Head, Inference, IntentModel, NearestGoal, Product, Told, ValueIntent,
};
use cohelm::plant::Plant;
use cohelm::registry::{Plants, TaskError};
use cohelm::trajectory::Setup;
use cohelm::value::{NoOpinion, ValueModel};
use std::sync::Arc;

/// Why there is no cockpit for a setup.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CockpitError {
    /// There is no such plant.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// The plant is of another version than the setup says.
    #[error(
        "the setup is for version {setup} of {plant:?}, this program has version {known}: its bits would differ"
    )]
    SetupVersion {
        /// The plant.
        plant: String,
        /// Version in the setup.
        setup: u32,
        /// Version of this program.
        known: u32,
    },
    /// The rule cannot be built.
    #[error(transparent)]
    Rule(#[from] RuleError),
    /// The rule looks ahead in a copy of the plant, and there is none.
    #[error(
        "the rule {rule} looks ahead in a copy of the plant that flies to the inferred goal, and {plant:?} cannot be copied or \
         given a goal; choose a rule that does not, such as misc-r"
    )]
    NoCopy {
        /// The rule.
        rule: &'static str,
        /// The plant.
        plant: String,
    },
    /// A model is not at hand.
    #[error("there is no {} model with the hash {hash}; add the file it was read from", .kind.word())]
    NoModel {
        /// What was looked for.
        kind: Kind,
        /// Its hash.
        hash: String,
    },
    /// A model of another kind has that hash.
    #[error("the model {name:?} is for {}, but a model for {} is needed", .found.word(), .needed.word())]
    WrongKind {
        /// The model's name.
        name: String,
        /// What it is for.
        found: Kind,
        /// What it should be for.
        needed: Kind,
    },
    /// The inference by values cannot be made.
    #[error(transparent)]
    Evidence(#[from] EvidenceError),
    /// The inference asks values and there are none.
    #[error("inference {:?} asks what every goal would make a pilot do; name a value model", .inference.word())]
    NoValues {
        /// What was to be inferred how.
        inference: Inference,
    },
    /// The intent model knows goals and should not, or the other way round.
    #[error(
        "the model {name:?} does not serve the inference {:?}: {}", .inference.word(),
        if inference.hides_goals() { "it was trained seeing the goals; use a variant that imagines one" }
        else { "it was trained without seeing goals; use it with `imagined`" }
    )]
    WrongInference {
        /// The model's name.
        name: String,
        /// What was to be inferred how.
        inference: Inference,
    },
    /// The inference needs a network and the setup names none.
    #[error("inference {:?} needs an intent model; name one, or infer the nearest goal", .inference.word())]
    NoIntent {
        /// What was to be inferred how.
        inference: Inference,
    },
    /// A model was trained on another plant.
    #[error("the model {name:?} was trained on the plant {trained:?}; it cannot fly {plant:?}")]
    WrongPlant {
        /// The model's name.
        name: String,
        /// What it was trained on.
        trained: String,
        /// What it should fly.
        plant: String,
    },
    /// A model was trained on another version of the plant.
    #[error(
        "the model {name:?} was trained on version {trained} of {plant:?}, this is version {known}: train it again"
    )]
    PlantVersion {
        /// The model's name.
        name: String,
        /// The plant.
        plant: String,
        /// Version it was trained on.
        trained: u32,
        /// Version of this program.
        known: u32,
    },
    /// A model knows other actions or another state.
    #[error(
        "the model {name:?} does not fit this plant: its {part} differs; use the model trained with these options"
    )]
    WrongShape {
        /// The model's name.
        name: String,
        /// What differs.
        part: &'static str,
    },
}

/// The cockpit that a setup describes. Values come from the network of that hash; without one, from the plant's entry
/// if it has hand-made ones, otherwise there is no opinion. Models are checked against plant, version and actions; how
/// many goals there are may differ from training, and change.
///
/// `plant` is one made from the setup's task; its state does not matter. Only [`Inference::Known`] looks at the pilot's
/// goals, and it does so here, in the episode of the setup's seed, not in the loop.
pub fn cockpit(
    setup: &Setup,
    plant: &dyn Plant,
    plants: &Plants,
    models: &Models,
) -> Result<Cockpit, CockpitError> {
    let entry = plants.entry(&setup.task)?;
    if entry.version != setup.plant_version {
        let plant = setup.task.plant.clone();
        return Err(CockpitError::SetupVersion { plant, setup: setup.plant_version, known: entry.version });
    }
    let fitting = Fitting { setup, plant, plants, models, hand_made: entry.values };
    let (values, median_range) = match fitting.estimator()? {
        Some(estimator) => estimator,
        None => (Box::new(NoOpinion::new(plant.space())) as Box<dyn ValueModel>, f64::NAN),
    };
    let arbiter = setup.rule.arbiter(median_range)?;
    if arbiter.needs().look_ahead && !can_look_ahead(plant) {
        let plant = setup.task.plant.clone();
        return Err(CockpitError::NoCopy { rule: setup.rule.word(), plant });
    }
    let cockpit = Cockpit::new(fitting.intent()?, values, arbiter).with_silence(setup.silence);
    Ok(if setup.inference.hides_goals() { cockpit.with_goals_hidden() } else { cockpit })
}

/// True if copies of the plant can be flown towards any of its goals, so that they do not tell which is the pilot's.
fn can_look_ahead(plant: &dyn Plant) -> bool {
    let goals = plant.view().goals.len();
    plant.snapshot().is_some_and(|mut copy| goals < 2 || (0..goals).all(|goal| copy.set_pilot_goal(goal)))
}

/// A value model and the median range of its values, NaN where nobody knows it.
type Valued = (Box<dyn ValueModel>, f64);

/// Finds models and holds them against the plant.
struct Fitting<'a> {
    setup: &'a Setup,
    plant: &'a dyn Plant,
    plants: &'a Plants,
    models: &'a Models,
    hand_made: Option<fn() -> Box<dyn ValueModel>>,
}

impl Fitting<'_> {
    /// The values of the setup and their median range, if there are any.
    fn estimator(&self) -> Result<Option<Valued>, CockpitError> {
        match (&self.setup.values, self.hand_made) {
            (Some(hash), _) => self.values(hash).map(Some),
            (None, hand_made) => Ok(hand_made.map(|make| (make(), f64::NAN))),
        }
    }

    fn values(&self, hash: &str) -> Result<Valued, CockpitError> {
        let model = self.model(Kind::Values, hash)?;
        let Network::Values(network) = model.network() else { return Err(wrong_kind(model, Kind::Values)) };
        let values = NetworkValues::new(model.card(), network.clone());
        let values = values.ok_or_else(|| wrong_shape(model.card(), "action space"))?;
        Ok((Box::new(values), model.card().median_range.unwrap_or(f64::NAN)))
    }

    fn intent(&self) -> Result<Box<dyn IntentModel>, CockpitError> {
        Ok(match self.setup.inference {
            Inference::Nearest => Box::new(NearestGoal),
            Inference::Known => Box::new(self.told()?),
            Inference::InverseDistance => Box::new(self.network(Head::InverseDistance)?),
            Inference::Softmax => Box::new(self.network(Head::Softmax)?),
            Inference::Calibrated => Box::new(self.network(Head::Calibrated)?),
            Inference::Bayesian => Box::new(self.by_values()?),
            Inference::CalibratedBayesian => {
                Box::new(Product::new(Box::new(self.network(Head::Calibrated)?), Box::new(self.by_values()?)))
            }
            Inference::Imagined => Box::new(self.imagined()?),
        })
    }

    /// What the pilot of the setup's episode wants, found out in an episode of its own.
    fn told(&self) -> Result<Told, CockpitError> {
        let mut plant = self.plants.make(&self.setup.task)?;
        plant.reset(self.setup.seed);
        Ok(Told::new(plant.wishes()))
    }

    fn network(&self, head: Head) -> Result<NetworkIntent, CockpitError> {
        let (card, networks) = self.networks()?;
        let intent = NetworkIntent::new(card, networks, head);
        intent.ok_or_else(|| wrong_shape(card, "action space"))
    }

    fn imagined(&self) -> Result<ImaginedIntent, CockpitError> {
        let (card, networks) = self.networks()?;
        ImaginedIntent::new(card, networks).ok_or_else(|| wrong_shape(card, "spread of the goals"))
    }

    fn by_values(&self) -> Result<ValueIntent, CockpitError> {
        let inference = self.setup.inference;
        let (values, median_range) = self.estimator()?.ok_or(CockpitError::NoValues { inference })?;
        Ok(ValueIntent::new(values, self.plant.space(), median_range, Evidence::default())?)
    }

    fn networks(&self) -> Result<(&Card, Arc<IntentNetworks>), CockpitError> {
        let inference = self.setup.inference;
        let hash = self.setup.intent.as_ref().ok_or(CockpitError::NoIntent { inference })?;
        let model = self.model(Kind::Intent, hash)?;
        let Network::Intent(networks) = model.network() else { return Err(wrong_kind(model, Kind::Intent)) };
        let card = model.card();
        if !card.serves(inference) {
            return Err(CockpitError::WrongInference { name: card.name.clone(), inference });
        }
        Ok((card, networks.clone()))
    }

    fn model(&self, kind: Kind, hash: &str) -> Result<&Model, CockpitError> {
        let none = || CockpitError::NoModel { kind, hash: hash.into() };
        let model = self.models.get(hash).ok_or_else(none)?;
        let card = model.card();
        if card.kind != kind {
            return Err(wrong_kind(model, kind));
        }
        fits(card, self.setup, self.plant)?;
        Ok(model)
    }
}

/// Whether the model of a card can fly a setup's plant.
pub fn fits(card: &Card, setup: &Setup, plant: &dyn Plant) -> Result<(), CockpitError> {
    let Setup { task, plant_version, .. } = setup;
    let name = || card.name.clone();
    if card.task.plant != task.plant {
        let (trained, plant) = (card.task.plant.clone(), task.plant.clone());
        return Err(CockpitError::WrongPlant { name: name(), trained, plant });
    }
    if card.plant_version != *plant_version {
        let (trained, known, plant) = (card.plant_version, *plant_version, task.plant.clone());
        return Err(CockpitError::PlantVersion { name: name(), plant, trained, known });
    }
    if card.space != *plant.space() {
        return Err(wrong_shape(card, "action space"));
    }
    if card.state != plant.view().state.len() {
        return Err(wrong_shape(card, "state"));
    }
    Ok(())
}

fn wrong_shape(card: &Card, part: &'static str) -> CockpitError {
    CockpitError::WrongShape { name: card.name.clone(), part }
}

fn wrong_kind(model: &Model, needed: Kind) -> CockpitError {
    CockpitError::WrongKind { name: model.card().name.clone(), found: model.card().kind, needed }
}
