//! A person, simulated, at the keys of a world.

use crate::action::to_python;
use crate::errors::Kind;
use crate::training::person;
use crate::world::{World, plants};
use cohelm::action::ActionSpace;
use cohelm::human::{Person, Population};
use cohelm::pilot::Pilot;
use cohelm::registry::Task;
use pyo3::prelude::*;
use sync_wrapper::SyncWrapper;

/// A model of a person at the keys of a world. A copy, or a pickle, is the same person before an episode.
#[pyclass(module = "cohelm")]
pub struct SimulatedPilot {
    pilot: SyncWrapper<Box<dyn Pilot>>,
    space: ActionSpace,
    task: Task,
    who: Person,
    begun: bool,
}

#[pymethods]
impl SimulatedPilot {
    /// Participant `index` of those that `seed` draws from a population.
    #[new]
    #[pyo3(signature = (world, *, population="ordinary", seed=1, index=0))]
    fn new(world: &World, population: &str, seed: u64, index: u64) -> PyResult<Self> {
        let population: Population = population.parse().map_err(|error| Kind::Option.error(error))?;
        Self::of(world.task().clone(), Person { population, seed, index })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, PickledPilot)> {
        let pilot = slf.borrow();
        let options = serde_json::to_string(&pilot.task.options).map_err(|error| Kind::Run.error(error))?;
        let Person { population, seed, index } = pilot.who;
        let made = (pilot.task.plant.clone(), options, population.to_string(), seed, index);
        Ok((slf.get_type().getattr("_unpickled")?, made))
    }

    /// The pilot that was pickled as this.
    #[staticmethod]
    fn _unpickled(
        plant: &str,
        options_json: &str,
        population: &str,
        seed: u64,
        index: u64,
    ) -> PyResult<Self> {
        let wrong =
            |error: serde_json::Error| Kind::Option.error(format!("this is no pickled pilot: {error}"));
        let task = Task { plant: plant.into(), options: serde_json::from_str(options_json).map_err(wrong)? };
        let population: Population = population.parse().map_err(|error| Kind::Option.error(error))?;
        Self::of(task, Person { population, seed, index })
    }

    /// Begins an episode; whatever is random about the pilot comes from the seed.
    fn reset(&mut self, seed: u64) {
        self.begun = true;
        self.pilot.get_mut().begin(seed);
    }

    /// What it asks for in the world as it is now.
    fn ask(&mut self, py: Python<'_>, world: &mut World) -> PyResult<Py<PyAny>> {
        if !self.begun {
            return Err(Kind::Closed.error("no episode of this pilot has begun: call reset(seed) first"));
        }
        let plant = world.plant();
        if self.space != *plant.space() {
            return Err(Kind::Action.error("this pilot was made for another world's actions"));
        }
        let asked = self.pilot.get_mut().ask(&plant.view(), plant.pilot_goal());
        to_python(py, &self.space, asked)
    }

    /// Keys pressed since the episode began.
    #[getter]
    fn key_presses(&mut self) -> u32 {
        self.pilot.get_mut().key_presses()
    }
}

/// Plant, options as JSON, population, seed and index.
type PickledPilot = (String, String, String, u64, u64);

impl SimulatedPilot {
    fn of(task: Task, who: Person) -> PyResult<Self> {
        let plants = plants();
        let plant = plants.make(&task).map_err(|error| Kind::Option.error(error))?;
        let pilot = person(&plants, &task, plant.as_ref(), who).map_err(|error| Kind::Option.error(error))?;
        let space = plant.space().clone();
        Ok(Self { pilot: SyncWrapper::new(pilot), space, task, who, begun: false })
    }
}
