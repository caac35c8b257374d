//! The versions of the study's file: the one that is run now, and those that participants began with earlier.

use crate::hangar::Hangar;
use crate::store::StoreError;
use cohelm::registry::{Plants, TaskError};
use cohelm_copilot::{Kind, Models};
use cohelm_study::design::{Condition, Design, DesignError, ModelChoice, Resolved, ResolvedModels};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Why a study cannot be run with these plants and models.
#[derive(Debug, thiserror::Error)]
pub enum ResolveError {
    /// There is no such plant.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// No model does what a condition asks for.
    #[error(
        "condition {condition:?} needs a model of {} for {plant}, and there is none; train one with `cohelm train` and name it with --model",
        kind.word()
    )]
    NoModel {
        /// Which condition.
        condition: String,
        /// What the model is to give.
        kind: Kind,
        /// The plant.
        plant: String,
    },
}

/// Looks up what a design leaves to the program: the plant's version and the models of each condition.
pub fn resolve(design: &Design, plants: &Plants, models: &Models) -> Result<Resolved, ResolveError> {
    let task = &design.task.task;
    let entry = plants.entry(task)?;
    let plant = plants.make(task)?;
    let usual = || models.newest_for(Kind::Values, task, plant.space()).map(|model| model.hash().to_owned());
    let of = |condition: &Condition| {
        let none = |kind| ResolveError::NoModel {
            condition: condition.name.clone(),
            kind,
            plant: task.plant.clone(),
        };
        let values = match &design.task.values {
            ModelChoice::Shipped => usual(),
            ModelChoice::Hash(hash) => Some(hash.clone()),
        };
        if values.is_none() && entry.values.is_none() && condition.rule != cohelm::arbitration::Rule::Hic {
            return Err(none(Kind::Values));
        }
        let intent = match (condition.inference.head(), &design.task.intent) {
            (None, _) => None,
            (Some(_), ModelChoice::Hash(hash)) => Some(hash.clone()),
            (Some(_), ModelChoice::Shipped) => {
                let usual = models.newest_intent(condition.inference, task, plant.space());
                Some(usual.ok_or_else(|| none(Kind::Intent))?.hash().to_owned())
            }
        };
        Ok(ResolvedModels { values, intent })
    };
    let models = design.conditions.iter().map(of).collect::<Result<_, _>>()?;
    Ok(Resolved { plant_version: entry.version, models })
}

/// One version of the file, with what it leaves to the program.
pub struct Edition {
    /// SHA-256 of the file.
    pub hash: String,
    /// What it says.
    pub design: Design,
    /// Plant and models.
    pub resolved: Resolved,
}

/// Why a participant's version of the file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum EditionError {
    /// It is not stored.
    #[error("the study's file of hash {0} is not in the database")]
    Missing(String),
    /// This program does not understand it.
    #[error("the study's file of hash {hash} cannot be read by this version: {error}")]
    Design {
        /// Which file.
        hash: String,
        /// What is wrong with it.
        error: DesignError,
    },
    /// It cannot be flown here.
    #[error(transparent)]
    Resolve(#[from] ResolveError),
    /// The database failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// The versions that were asked for, at hand.
#[derive(Default)]
pub struct Designs {
    known: Mutex<HashMap<String, Arc<Edition>>>,
}

impl Designs {
    /// Adds a version.
    pub fn add(&self, edition: Edition) -> Arc<Edition> {
        let edition = Arc::new(edition);
        // A panic elsewhere leaves the map a map, here and below.
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.insert(edition.hash.clone(), edition.clone());
        edition
    }

    /// The version of this hash, from the database if it is not at hand.
    pub async fn of(&self, hash: &str, hangar: &Hangar) -> Result<Arc<Edition>, EditionError> {
        let at_hand = self.known.lock().unwrap_or_else(PoisonError::into_inner).get(hash).cloned();
        if let Some(edition) = at_hand {
            return Ok(edition);
        }
        let stored = hangar.store().study(hash).await?;
        let stored = stored.ok_or_else(|| EditionError::Missing(hash.into()))?;
        let design = Design::from_toml(&stored.text)
            .map_err(|error| EditionError::Design { hash: hash.into(), error })?;
        let resolved = resolve(&design, hangar.plants(), hangar.models())?;
        Ok(self.add(Edition { hash: hash.into(), design, resolved }))
    }
}
