//! What can be flown here: the plants of this program, and models from it and from the database.

use crate::store::{Store, StoreError};
use cohelm::flight::Flight;
use cohelm::plant::Plant;
use cohelm::registry::{Plants, TaskError};
use cohelm::trajectory::{MAX_SEED, Setup};
use cohelm_copilot::{CockpitError, Model, ModelError, Models};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Models from the database that are kept at hand: more saves reading them again where many conditions fly at once,
/// fewer saves memory (some 200 kB each).
const AT_HAND: usize = 32;
/// Longest name of a pilot, and longest hash.
const MAX_NAME: usize = 64;

/// Why an episode cannot be flown here.
#[derive(Debug, thiserror::Error)]
pub enum HangarError {
    /// A number or name of the setup is out of bounds.
    #[error("the setup's {what} must be {expected}, got {found}")]
    Setup {
        /// Which field.
        what: &'static str,
        /// What it may be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// There is no such plant.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// The cockpit cannot be made.
    #[error(transparent)]
    Cockpit(#[from] CockpitError),
    /// A model of the database cannot be read any more.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The database failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Plants and models.
pub struct Hangar {
    plants: Plants,
    models: Models,
    store: Arc<dyn Store>,
    at_hand: Mutex<VecDeque<Model>>,
}

impl Hangar {
    /// The program's plants and models; other models come from the store.
    pub fn new(plants: Plants, models: Models, store: Arc<dyn Store>) -> Self {
        Self { plants, models, store, at_hand: Mutex::default() }
    }

    /// The plants.
    pub fn plants(&self) -> &Plants {
        &self.plants
    }

    /// The program's own models.
    pub fn models(&self) -> &Models {
        &self.models
    }

    /// The database.
    pub fn store(&self) -> &dyn Store {
        self.store.as_ref()
    }

    /// The models that a setup names and that are to be had: what its cockpit is made of.
    pub async fn models_of(&self, setup: &Setup) -> Result<Models, HangarError> {
        let mut needed = Models::new();
        for hash in setup.values.iter().chain(&setup.intent) {
            if let Some(model) = self.model(hash).await? {
                needed.add_model(model);
            }
        }
        Ok(needed)
    }

    /// The model of a hash.
    pub async fn model(&self, hash: &str) -> Result<Option<Model>, HangarError> {
        if let Some(known) = self.models.get(hash) {
            return Ok(Some(known.clone()));
        }
        if let Some(known) = self.lock().iter().find(|model| model.hash() == hash) {
            return Ok(Some(known.clone()));
        }
        let Some(bytes) = self.store.model(hash).await? else { return Ok(None) };
        let model = Model::from_bytes(&bytes)?;
        let mut at_hand = self.lock();
        at_hand.push_back(model.clone());
        if at_hand.len() > AT_HAND {
            at_hand.pop_front();
        }
        Ok(Some(model))
    }

    /// The plant of a setup, checked, and the beginning of its flight.
    pub async fn begin(&self, setup: Setup) -> Result<Flight, HangarError> {
        check(&setup)?;
        let models = self.models_of(&setup).await?;
        let plant = self.plant(&setup)?;
        let cockpit = cohelm_copilot::cockpit(&setup, plant.as_ref(), &self.plants, &models)?;
        Ok(Flight::new(setup, plant, cockpit))
    }

    fn plant(&self, setup: &Setup) -> Result<Box<dyn Plant>, HangarError> {
        Ok(self.plants.make(&setup.task)?)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, VecDeque<Model>> {
        // A panic elsewhere leaves a list of models a list of models.
        self.at_hand.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn check(setup: &Setup) -> Result<(), HangarError> {
    let wrong = |what, expected, found: String| Err(HangarError::Setup { what, expected, found });
    if setup.seed > MAX_SEED {
        return wrong("seed", "at most 2^53", setup.seed.to_string());
    }
    if !(setup.time_scale > 0.0 && setup.time_scale <= 10.0) {
        return wrong("time_scale", "more than 0 and at most 10", setup.time_scale.to_string());
    }
    if setup.pilot.is_empty() || setup.pilot.len() > MAX_NAME {
        return wrong("pilot", "a name of at most 64 bytes", format!("{} bytes", setup.pilot.len()));
    }
    let hashes = setup.values.iter().chain(&setup.intent);
    match hashes.into_iter().find(|hash| !is_hash(hash)) {
        Some(other) => wrong("model", "a SHA-256 of 64 lower-case hexadecimal digits", shorten(other)),
        None => Ok(()),
    }
}

/// True for what a model's hash looks like.
pub fn is_hash(text: &str) -> bool {
    text.len() == MAX_NAME && text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

fn shorten(text: &str) -> String {
    text.chars().take(MAX_NAME).collect()
}
