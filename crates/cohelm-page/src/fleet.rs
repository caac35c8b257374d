//! Which plants there are, what flies an episode, and who can be asked to. The only place here that names a plant.

use crate::page::PageError;
use cohelm::action::ActionSpace;
use cohelm::cockpit::Cockpit;
use cohelm::human::{Person, Population};
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::{PlantEntry, Plants};
use cohelm::trajectory::{MAX_SEED, Setup, Trajectory};
use cohelm::value::ValueModel;
use cohelm_copilot::values::NetworkValues;
use cohelm_copilot::{Models, Network, cockpit};

/// The draw that the page's simulated people come from.
const PEOPLE: u64 = 0x0064_6573_6b00;

/// The plants that the page can fly.
pub fn plants() -> Plants {
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    plants.register(cohelm_drone::entry());
    plants.register(cohelm_arm::entry());
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
        Self::with(setup, plants.make(&setup.task)?, plants, models)
    }

    /// The plant and the cockpit that fly a record again.
    pub fn again(record: &Trajectory, plants: &Plants, models: &Models) -> Result<Self, PageError> {
        if record.setup.seed > MAX_SEED {
            return Err(PageError::Seed(record.setup.seed));
        }
        let (plant, plants) = record.plant(plants)?;
        Self::with(&record.setup, plant, &plants, models)
    }

    fn with(
        setup: &Setup,
        mut plant: Box<dyn Plant>,
        plants: &Plants,
        models: &Models,
    ) -> Result<Self, PageError> {
        plant.reset(setup.seed);
        let cockpit = cockpit(setup, plant.as_ref(), plants, models)?;
        let values = setup.values.as_ref().and_then(|hash| models.get(hash));
        let median_range = values.and_then(|model| model.card().median_range);
        Ok(Self { plant, cockpit, median_range })
    }
}

/// Person number `index` of a population, at the keys of a task's actions; refused where no skill is known for them.
pub fn person(
    entry: &PlantEntry,
    space: &ActionSpace,
    population: Population,
    index: u64,
) -> Result<Box<dyn Pilot>, PageError> {
    Ok(Box::new(entry.participant(space, Person { population, seed: PEOPLE, index })?))
}

/// The values that a setup's cockpit has, for a pilot of its own; refused where it has none.
pub fn values_of(setup: &Setup, plants: &Plants, models: &Models) -> Result<Box<dyn ValueModel>, PageError> {
    let values = match &setup.values {
        Some(hash) => trained(hash, models),
        None => plants.entry(&setup.task)?.values.map(|make| make()),
    };
    values.ok_or_else(|| PageError::NoValues(setup.task.plant.clone()))
}

fn trained(hash: &str, models: &Models) -> Option<Box<dyn ValueModel>> {
    let model = models.get(hash)?;
    let Network::Values(network) = model.network() else { return None };
    Some(Box::new(NetworkValues::new(model.card(), network.clone())?))
}
