//! A plant, alone or with a co-pilot in it, stepped from Python.

use crate::action::{from_python, to_python};
use crate::arbitration::Rule;
use crate::errors::Kind;
use crate::models::{IntentModel, ValueModel};
use crate::picture::picture;
use crate::training::person;
use cohelm::action::{Action, ActionSpace};
use cohelm::cockpit::{Cockpit, Silence, Tick};
use cohelm::human::{Person, Population};
use cohelm::intent::{
    Evidence, Head, Inference, IntentModel as CoreIntent, NearestGoal, Product, Told, ValueIntent,
};
use cohelm::pilot::Pilot;
use cohelm::plant::{Plant, View};
use cohelm::registry::{Plants, Task};
use cohelm::value::{NoOpinion, ValueModel as CoreValues};
use cohelm_copilot::Card;
use cohelm_copilot::intent::{ImaginedIntent, NetworkIntent};
use cohelm_copilot::model::{IntentNetworks, Network};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::sync::Arc;
use sync_wrapper::SyncWrapper;

/// The plants there are.
pub fn plants() -> Plants {
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    plants.register(cohelm_drone::entry());
    plants.register(cohelm_arm::entry());
    plants.register(cohelm::point::entry());
    plants
}

/// Reads a word of ours, such as an inference, or says which there are.
fn word<T: DeserializeOwned>(what: &str, word: &str) -> PyResult<T> {
    serde_json::from_value(Value::from(word))
        .map_err(|error| Kind::Option.error(format!("{word:?} is no {what}: {error}")))
}

/// A plant with, perhaps, a co-pilot.
#[pyclass(module = "cohelm")]
pub struct World {
    /// (Python may look at a class from any thread; what is only ever borrowed exclusively needs no lock.)
    plant: SyncWrapper<Box<dyn Plant>>,
    help: Option<Help>,
    cockpit: SyncWrapper<Option<Cockpit>>,
    begun: bool,
    over: bool,
    /// Seed and requests of this episode, from which a copy with a co-pilot is made. (A cockpit cannot be copied, but the
    /// same requests give the same bits.)
    seed: u64,
    asked: Vec<Option<Action>>,
    task: Task,
}

/// What a cockpit is made of, anew for each episode.
struct Help {
    rule: Py<Rule>,
    inference: Inference,
    silence: Silence,
    values: Option<Py<ValueModel>>,
    intent: Option<Py<IntentModel>>,
}

/// Asks for what it was told to ask for.
struct Told(Option<Action>);

impl Pilot for Told {
    fn begin(&mut self, _seed: u64) {}

    fn ask(&mut self, _view: &View<'_>, _goal: usize) -> Option<Action> {
        self.0
    }
}

#[pymethods]
impl World {
    #[new]
    #[pyo3(signature = (plant, options_json="{}", *, rule=None, inference="nearest", silence="best", values=None, intent=None))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        plant: &str,
        options_json: &str,
        rule: Option<Py<Rule>>,
        inference: &str,
        silence: &str,
        values: Option<Py<ValueModel>>,
        intent: Option<Py<IntentModel>>,
    ) -> PyResult<Self> {
        let options = serde_json::from_str(options_json).map_err(|error| Kind::Option.error(error))?;
        let task = Task { plant: plant.into(), options };
        let plant = plants().make(&task).map_err(|error| Kind::Option.error(error))?;
        let (inference, silence) = (word("inference", inference)?, word("answer to silence", silence)?);
        let help = rule.map(|rule| Help { rule, inference, silence, values, intent });
        // Made once here, so that what does not fit is said before the first episode.
        let cockpit = help.as_ref().map(|help| help.cockpit(plant.as_ref())).transpose()?;
        Ok(Self {
            plant: SyncWrapper::new(plant),
            help,
            cockpit: SyncWrapper::new(cockpit),
            begun: false,
            over: false,
            seed: 0,
            asked: Vec::new(),
            task,
        })
    }

    /// Begins the episode of a seed.
    fn reset(&mut self, seed: u64) -> PyResult<()> {
        let plant = self.plant.get_mut();
        plant.reset(seed);
        let mut cockpit = self.help.as_ref().map(|help| help.cockpit(plant.as_ref())).transpose()?;
        if let Some(cockpit) = &mut cockpit {
            cockpit.begin();
        }
        self.cockpit = SyncWrapper::new(cockpit);
        (self.begun, self.over, self.seed) = (true, false, seed);
        self.asked.clear();
        Ok(())
    }

    /// One tick with what is asked (None for nothing): the record of every stage.
    #[pyo3(signature = (asked=None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        asked: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        if !self.begun || self.over {
            let why = if self.over { "the episode is over" } else { "no episode has begun" };
            return Err(Kind::Closed.error(format!("{why}: call reset(seed) first")));
        }
        let plant = self.plant.get_mut();
        let asked = from_python(plant.space(), asked)?;
        let record = PyDict::new(py);
        let step = match self.cockpit.get_mut() {
            None => {
                record.set_item("asked", to_python(py, plant.space(), asked)?)?;
                record.set_item("executed", to_python(py, plant.space(), asked)?)?;
                plant.step(asked)
            }
            Some(cockpit) => {
                let space = plant.space().clone();
                let tick = cockpit.tick(plant.as_mut(), &mut Told(asked));
                describe(py, &record, &space, &tick)?;
                tick.step
            }
        };
        self.over = step.ending.is_some();
        self.asked.push(asked);
        record.set_item("reward", step.reward)?;
        record.set_item("ending", step.ending.map(|ending| ending.word()))?;
        record.set_item("terminated", step.ending.is_some_and(|ending| ending.is_terminal()))?;
        Ok(record)
    }

    /// The state vector, float32.
    fn state<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, self.plant.get_mut().view().state)
    }

    /// Where the plant is, in the units of the goals.
    fn position(&mut self) -> [f32; 2] {
        self.plant.get_mut().view().position
    }

    /// Positions of the goals: goals × 2, float32.
    fn goals<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let goals: Vec<Vec<f32>> =
            self.plant.get_mut().view().goals.iter().map(|goal| goal.position.to_vec()).collect();
        PyArray2::from_vec2(py, &goals).map_err(|error| Kind::Array.error(error))
    }

    /// Index of the pilot's own goal.
    #[getter]
    fn pilot_goal(&mut self) -> usize {
        self.plant.get_mut().pilot_goal()
    }

    /// Ticks since the episode began.
    #[getter]
    fn ticks(&mut self) -> u32 {
        self.plant.get_mut().view().tick
    }

    /// Ticks a second in real time.
    #[getter]
    fn ticks_per_second(&mut self) -> f64 {
        self.plant.get_mut().ticks_per_second()
    }

    /// Labels of the commands; empty for axes.
    #[getter]
    fn commands(&mut self) -> Vec<String> {
        let space = self.plant.get_mut().space();
        (0..space.commands()).map(|command| space.label(Action::Command(command as u8))).collect()
    }

    /// Names, lower and upper bounds of the axes; None for commands.
    #[getter]
    fn axes(&mut self) -> Option<(Vec<String>, Vec<f32>, Vec<f32>)> {
        match self.plant.get_mut().space() {
            ActionSpace::Axes { names, low, high } => Some((names.clone(), low.clone(), high.clone())),
            _ => None,
        }
    }

    /// f(a, asked) of Eq. 4 for every pair of commands: commands × commands, float32.
    fn similarity<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let commands = 0..self.plant.get_mut().space().commands() as u8;
        let plant = self.plant.get_mut();
        let row = |a| {
            commands
                .clone()
                .map(|asked| plant.similarity(Action::Command(a), Action::Command(asked)))
                .collect()
        };
        let rows: Vec<Vec<f32>> = commands.clone().map(row).collect();
        PyArray2::from_vec2(py, &rows).map_err(|error| Kind::Array.error(error))
    }

    /// What a hand-made controller would do for a goal; None if it would do nothing or there is none.
    #[pyo3(signature = (goal=None))]
    fn teacher(&mut self, py: Python<'_>, goal: Option<usize>) -> PyResult<Py<PyAny>> {
        let plant = self.plant.get_mut();
        let action = plant.teacher(goal.unwrap_or(plant.pilot_goal()));
        to_python(py, plant.space(), action)
    }

    /// A copy that goes on with the same bits. One with a co-pilot in it flies the episode again up to here, which takes
    /// some microseconds a tick.
    fn snapshot(&mut self, py: Python<'_>) -> PyResult<Self> {
        let help = self.help.as_ref().map(|help| help.clone_ref(py));
        let (plant, cockpit) = match help.as_ref().filter(|_| self.begun) {
            None => (self.copied_plant()?, None),
            Some(help) => {
                let mut plant = plants().make(&self.task).map_err(|error| Kind::Option.error(error))?;
                plant.reset(self.seed);
                let mut cockpit = help.cockpit(plant.as_ref())?;
                cockpit.begin();
                for asked in &self.asked {
                    cockpit.tick(plant.as_mut(), &mut Told(*asked));
                }
                (plant, Some(cockpit))
            }
        };
        Ok(Self {
            plant: SyncWrapper::new(plant),
            help,
            cockpit: SyncWrapper::new(cockpit),
            begun: self.begun,
            over: self.over,
            seed: self.seed,
            asked: self.asked.clone(),
            task: self.task.clone(),
        })
    }

    fn __copy__(&mut self, py: Python<'_>) -> PyResult<Self> {
        self.snapshot(py)
    }

    fn __deepcopy__(&mut self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.snapshot(py)
    }

    /// What it looks like: height × width × 3, uint8.
    #[pyo3(signature = (width=600, height=450))]
    fn render<'py>(
        &mut self,
        py: Python<'py>,
        width: u32,
        height: u32,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        picture(py, self.plant.get_mut().as_ref(), [width, height])
    }
}

impl World {
    fn copied_plant(&mut self) -> PyResult<Box<dyn Plant>> {
        let copy = self.plant.get_mut().snapshot();
        copy.ok_or_else(|| Kind::Option.error("this plant cannot be copied"))
    }
}

impl Help {
    fn clone_ref(&self, py: Python<'_>) -> Self {
        Self {
            rule: self.rule.clone_ref(py),
            inference: self.inference,
            silence: self.silence,
            values: self.values.as_ref().map(|values| values.clone_ref(py)),
            intent: self.intent.as_ref().map(|intent| intent.clone_ref(py)),
        }
    }

    fn cockpit(&self, plant: &dyn Plant) -> PyResult<Cockpit> {
        let (values, median_range) = match self.estimator(plant)? {
            Some(estimator) => estimator,
            None => (Box::new(NoOpinion::new(plant.space())) as Box<dyn CoreValues>, f64::NAN),
        };
        let arbiter =
            self.rule.get().rule().arbiter(median_range).map_err(|error| Kind::Option.error(error))?;
        let cockpit = Cockpit::new(self.intent(plant)?, values, arbiter).with_silence(self.silence);
        Ok(if self.inference.hides_goals() { cockpit.with_goals_hidden() } else { cockpit })
    }

    /// The values and their median range, if there are any.
    fn estimator(&self, plant: &dyn Plant) -> PyResult<Option<(Box<dyn CoreValues>, f64)>> {
        let Some(values) = &self.values else { return Ok(None) };
        if let Some(model) = values.get().trained() {
            fits(model, plant)?;
        }
        values.get().values(plant.view().state.len(), plant.space().commands()).map(Some)
    }

    fn intent(&self, plant: &dyn Plant) -> PyResult<Box<dyn CoreIntent>> {
        Ok(match self.inference {
            Inference::Nearest => Box::new(NearestGoal),
            Inference::Known => Box::new(Told::new(plant.wishes())),
            Inference::InverseDistance | Inference::Softmax | Inference::Calibrated => {
                Box::new(self.network(plant)?)
            }
            Inference::Bayesian => Box::new(self.by_values(plant)?),
            Inference::CalibratedBayesian => {
                Box::new(Product::new(Box::new(self.network(plant)?), Box::new(self.by_values(plant)?)))
            }
            Inference::Imagined => {
                let (card, networks) = self.networks(plant)?;
                let imagined = ImaginedIntent::new(card, networks.clone());
                Box::new(imagined.ok_or_else(|| Kind::Model.error("the card tells no spread of the goals"))?)
            }
        })
    }

    fn network(&self, plant: &dyn Plant) -> PyResult<NetworkIntent> {
        let (card, networks) = self.networks(plant)?;
        let head = self.inference.head().unwrap_or(Head::Calibrated);
        let intent = NetworkIntent::new(card, networks.clone(), head);
        intent.ok_or_else(|| Kind::Model.error("the model's action space has no commands"))
    }

    fn networks(&self, plant: &dyn Plant) -> PyResult<(&Card, &Arc<IntentNetworks>)> {
        let word = self.inference.word();
        let none = || Kind::Option.error(format!("inference {word:?} needs an intent model: intent=…"));
        let model = &self.intent.as_ref().ok_or_else(none)?.get().model;
        fits(model, plant)?;
        if !model.card().serves(self.inference) {
            let name = &model.card().name;
            return Err(Kind::Model.error(format!(
                "the model {name:?} does not serve the inference {word:?}: a goal is imagined by networks that were trained \
                 without seeing goals, and by these alone"
            )));
        }
        match model.network() {
            Network::Intent(networks) => Ok((model.card(), networks)),
            Network::Values(_) => Err(Kind::Model.error("the intent model holds no intent network")),
        }
    }

    fn by_values(&self, plant: &dyn Plant) -> PyResult<ValueIntent> {
        let none = || Kind::Option.error("inference by the values needs values: values=…");
        let (values, median_range) = self.estimator(plant)?.ok_or_else(none)?;
        let intent = ValueIntent::new(values, plant.space(), median_range, Evidence::default());
        intent.map_err(|error| Kind::Option.error(error))
    }
}

fn fits(model: &cohelm_copilot::Model, plant: &dyn Plant) -> PyResult<()> {
    let card = model.card();
    if card.space == *plant.space() && card.state == plant.view().state.len() {
        return Ok(());
    }
    Err(Kind::Model.error(format!("the model {:?} does not fit this plant: its actions or state differ; use the model trained with these options", card.name)))
}

fn describe(
    py: Python<'_>,
    record: &Bound<'_, PyDict>,
    space: &ActionSpace,
    tick: &Tick<'_>,
) -> PyResult<()> {
    record.set_item("asked", to_python(py, space, tick.asked)?)?;
    record.set_item("goal", tick.belief.goal)?;
    record.set_item("confidence", tick.belief.confidence)?;
    record.set_item("probabilities", PyArray1::from_slice(py, tick.belief.probabilities()))?;
    record.set_item("values", PyArray1::from_slice(py, tick.values.values()))?;
    record.set_item("allowed", PyArray1::from_slice(py, tick.allowed))?;
    record.set_item("executed", to_python(py, space, tick.executed)?)?;
    record.set_item("intervened", tick.intervention.map(|intervention| intervention.effective))?;
    record.set_item("opposed", tick.intervention.map(|intervention| intervention.opposed))
}

/// A model of a person at the keys of a world.
#[pyclass(module = "cohelm")]
pub struct SimulatedPilot {
    pilot: SyncWrapper<Box<dyn Pilot>>,
    space: ActionSpace,
}

#[pymethods]
impl SimulatedPilot {
    /// Participant `index` of those that `seed` draws from a population.
    #[new]
    #[pyo3(signature = (world, *, population="ordinary", seed=1, index=0))]
    fn new(world: &mut World, population: &str, seed: u64, index: u64) -> PyResult<Self> {
        let population: Population = population.parse().map_err(|error| Kind::Option.error(error))?;
        let plant = world.plant.get_mut();
        let who = Person { population, seed, index };
        let pilot = person(&plants(), &world.task, plant.as_ref(), who);
        let pilot = pilot.map_err(|error| Kind::Option.error(error))?;
        Ok(Self { pilot: SyncWrapper::new(pilot), space: plant.space().clone() })
    }

    /// Begins an episode; whatever is random about the pilot comes from the seed.
    fn reset(&mut self, seed: u64) {
        self.pilot.get_mut().begin(seed);
    }

    /// What it asks for in the world as it is now.
    fn ask(&mut self, py: Python<'_>, world: &mut World) -> PyResult<Py<PyAny>> {
        let plant = world.plant.get_mut();
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
