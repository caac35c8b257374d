//! Which plants there are, and what flies an episode.

use crate::page::PageError;
use cohelm::cockpit::Cockpit;
use cohelm::plant::Plant;
use cohelm::registry::Plants;
use cohelm::trajectory::{MAX_SEED, Setup};
use cohelm_copilot::{Models, cockpit};

/// The plants that the page can fly.
pub fn plants() -> Plants {
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    plants.register(cohelm::point::entry());
    plants
}

/// What flies an episode.
pub struct Crew {
    /// The plant, reset to the seed.
    pub plant: Box<dyn Plant>,
    /// The cockpit of rule, inference and models.
    pub cockpit: Cockpit,
    /// Median over states of max Q − min Q, in the values' units, from the value model's card; hand-made values have none.
    pub median_range: Option<f64>,
}

impl Crew {
    /// The plant and the cockpit of a setup.
    pub fn of(setup: &Setup, plants: &Plants, models: &Models) -> Result<Self, PageError> {
        if setup.seed > MAX_SEED {
            return Err(PageError::Seed(setup.seed));
        }
        let mut plant = plants.make(&setup.task)?;
        plant.reset(setup.seed);
        let cockpit = cockpit(setup, plant.as_ref(), plants, models)?;
        let values = setup.values.as_ref().and_then(|hash| models.get(hash));
        let median_range = values.and_then(|model| model.card().median_range);
        Ok(Self { plant, cockpit, median_range })
    }
}
