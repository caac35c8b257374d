//! A plant, alone or with a co-pilot in it, stepped from Python.

use crate::action::{from_python, to_python};
use crate::arbitration::Rule;
use crate::errors::Kind;
use crate::models::{IntentModel, ValueModel};
use crate::picture::picture;
use cohelm::action::{Action, ActionSpace};
use cohelm::cockpit::{Cockpit, Silence, Tick};
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
use std::collections::BTreeMap;
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

/// The plants there are: name → what it is.
#[pyfunction]
#[pyo3(name = "plants")]
pub fn plant_names() -> BTreeMap<&'static str, &'static str> {
    plants().entries().iter().map(|entry| (entry.name, entry.summary)).collect()
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
pub struct Help {
    task: Task,
    rule: Py<Rule>,
    inference: Inference,
    silence: Silence,
    values: Option<Py<ValueModel>>,
    intent: Option<Py<IntentModel>>,
}

/// [`Help`] as it is pickled; inference and answer to silence as JSON.
type PickledHelp = (Py<Rule>, String, String, Option<Py<ValueModel>>, Option<Py<IntentModel>>);
/// Plant, options as JSON, help, and seed and requests of the episode if one has begun.
type Pickled = (String, String, Option<PickledHelp>, Option<(u64, Vec<Py<PyAny>>)>);

/// Asks for what somebody else asks for.
pub struct Relay(pub Option<Action>);

impl Pilot for Relay {
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
        let (inference, silence) = (word("inference", inference)?, word("answer to silence", silence)?);
        let help = rule.map(|rule| Help { task: task.clone(), rule, inference, silence, values, intent });
        Self::of(task, help)
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
                let tick = cockpit.tick(plant.as_mut(), &mut Relay(asked));
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
                    cockpit.tick(plant.as_mut(), &mut Relay(*asked));
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

    /// What a pickle holds: plant and options, what its cockpits are made of, and seed and requests of the episode.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Pickled)> {
        let py = slf.py();
        let make = slf.get_type().getattr("_unpickled")?;
        let mut world = slf.borrow_mut();
        let text = |value: serde_json::Result<String>| value.map_err(|error| Kind::Run.error(error));
        let options = text(serde_json::to_string(&world.task.options))?;
        let help = match world.help.as_ref().map(|help| help.clone_ref(py)) {
            None => None,
            Some(Help { rule, inference, silence, values, intent, .. }) => Some((
                rule,
                text(serde_json::to_string(&inference))?,
                text(serde_json::to_string(&silence))?,
                values,
                intent,
            )),
        };
        let space = world.plant.get_mut().space().clone();
        let asked = |asked: &Option<Action>| to_python(py, &space, *asked);
        let asked = world.asked.iter().map(asked).collect::<PyResult<Vec<_>>>()?;
        Ok((make, (world.task.plant.clone(), options, help, world.begun.then_some((world.seed, asked)))))
    }

    /// The world that was pickled as this: its episode is flown again up to where it was.
    #[staticmethod]
    #[allow(clippy::needless_pass_by_value, reason = "they come from Python")]
    fn _unpickled(
        plant: &str,
        options_json: &str,
        help: Option<PickledHelp>,
        flight: Option<(u64, Vec<Bound<'_, PyAny>>)>,
    ) -> PyResult<Self> {
        let wrong =
            |error: serde_json::Error| Kind::Option.error(format!("this is no pickled World: {error}"));
        let task = Task { plant: plant.into(), options: serde_json::from_str(options_json).map_err(wrong)? };
        let help = match help {
            None => None,
            Some((rule, inference, silence, values, intent)) => {
                let inference = serde_json::from_str(&inference).map_err(wrong)?;
                let silence = serde_json::from_str(&silence).map_err(wrong)?;
                Some(Help { task: task.clone(), rule, inference, silence, values, intent })
            }
        };
        let mut world = Self::of(task, help)?;
        if let Some((seed, asked)) = flight {
            world.reset(seed)?;
            let space = world.plant.get_mut().space().clone();
            for asked in asked {
                world.advance(from_python(&space, Some(&asked))?);
            }
        }
        Ok(world)
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
    fn of(task: Task, help: Option<Help>) -> PyResult<Self> {
        let plant = plants().make(&task).map_err(|error| Kind::Option.error(error))?;
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

    /// One tick, of which nobody wants to know more than that it was.
    fn advance(&mut self, asked: Option<Action>) {
        let plant = self.plant.get_mut();
        let step = match self.cockpit.get_mut() {
            None => plant.step(asked),
            Some(cockpit) => cockpit.tick(plant.as_mut(), &mut Relay(asked)).step,
        };
        self.over = step.ending.is_some();
        self.asked.push(asked);
    }

    /// Plant and options.
    pub fn task(&self) -> &Task {
        &self.task
    }

    /// The plant as it is now.
    pub fn plant(&mut self) -> &dyn Plant {
        &**self.plant.get_mut()
    }

    /// What it was made of: plant and options, and what its cockpits are made of.
    pub fn recipe(&self, py: Python<'_>) -> (Task, Option<Help>) {
        (self.task.clone(), self.help.as_ref().map(|help| help.clone_ref(py)))
    }

    fn copied_plant(&mut self) -> PyResult<Box<dyn Plant>> {
        let copy = self.plant.get_mut().snapshot();
        copy.ok_or_else(|| Kind::Option.error("this plant cannot be copied"))
    }
}

impl Help {
    fn clone_ref(&self, py: Python<'_>) -> Self {
        Self {
            task: self.task.clone(),
            rule: self.rule.clone_ref(py),
            inference: self.inference,
            silence: self.silence,
            values: self.values.as_ref().map(|values| values.clone_ref(py)),
            intent: self.intent.as_ref().map(|intent| intent.clone_ref(py)),
        }
    }

    /// A cockpit for an episode of a plant; an error if its models are for another.
    pub fn cockpit(&self, plant: &dyn Plant) -> PyResult<Cockpit> {
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
            fits(model, &self.task, plant)?;
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
        fits(model, &self.task, plant)?;
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

/// Refuses a model that was trained for another plant, or for other actions or another state of it. (Two plants may have both
/// alike: the drone and the arm on axes do.)
pub fn fits(model: &cohelm_copilot::Model, task: &Task, plant: &dyn Plant) -> PyResult<()> {
    let card = model.card();
    let version = plants().entry(task).map_err(|error| Kind::Option.error(error))?.version;
    if (&card.task.plant, card.plant_version) != (&task.plant, version) {
        return Err(Kind::Model.error(format!(
            "the model {:?} was trained for {} of version {}, and this is {} of version {version}; use a model of this plant",
            card.name, card.task.plant, card.plant_version, task.plant
        )));
    }
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
    if let ActionSpace::Axes { low, .. } = space {
        let row = |action: &Action| (0..low.len()).map(|axis| action.axis(axis)).collect();
        let rows: Vec<Vec<f32>> = tick.values.candidates().iter().map(row).collect();
        let rows = PyArray2::from_vec2(py, &rows).map_err(|error| Kind::Array.error(error))?;
        record.set_item("candidates", rows)?;
    }
    record.set_item("allowed", PyArray1::from_slice(py, tick.allowed))?;
    record.set_item("executed", to_python(py, space, tick.executed)?)?;
    record.set_item("intervened", tick.intervention.map(|intervention| intervention.effective))?;
    record.set_item("opposed", tick.intervention.map(|intervention| intervention.opposed))
}
