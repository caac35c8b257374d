//! Algorithm 1 live: puts the learner of `cohelm-learn` into the server's place for one.

use crate::rig;
use anyhow::{Context, Result};
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::Trajectory;
use cohelm_copilot::{Kind, Model, Models};
use cohelm_learn::{LiveLearner, LiveOptions};
use cohelm_server::learn::{Learner, Lessons, kept};
use cohelm_server::store::Store;

/// Fixes the learner's own flights and its batches.
const SEED: u64 = 0;

struct Live {
    plants: Plants,
    learner: LiveLearner,
}

/// A learner of a task that goes on from the values that were kept last, or else from the shipped ones.
pub async fn lessons(task: &Task, plants: &Plants, models: &Models, store: &dyn Store) -> Result<Lessons> {
    let plant = plants.make(task)?;
    let shipped = rig::model_for(models, Kind::Values, task, plant.space())?.clone();
    let current = match kept(store, &task.plant).await? {
        Some(hash) => {
            let bytes =
                store.model(&hash).await?.context("the values that were kept are not in the database")?;
            Model::from_bytes(&bytes)?
        }
        None => shipped.clone(),
    };
    let learner = LiveLearner::new(plants, &current, LiveOptions::default(), SEED)?;
    Ok(Lessons { learner: Box::new(Live { plants: plants.clone(), learner }), current, shipped })
}

impl Learner for Live {
    fn learn(&mut self, flown: &Trajectory) -> Option<Vec<u8>> {
        match self.learner.learn(flown) {
            Ok(model) => Some(model.bytes().to_vec()),
            Err(error) => {
                tracing::warn!(%error, "an episode taught nothing");
                None
            }
        }
    }

    fn return_to(&mut self, model: &Model) {
        match LiveLearner::new(&self.plants, model, LiveOptions::default(), SEED) {
            Ok(learner) => self.learner = learner,
            Err(error) => tracing::error!(%error, "the learner cannot return"),
        }
    }
}
