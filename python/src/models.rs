//! Models: ours, read from files; and values from somewhere else.

use crate::action::Actions;
use crate::errors::Kind;
use crate::world::{World, fits, plants};
use cohelm::action::Action;
use cohelm::plant::View;
use cohelm::registry::Task;
use cohelm::value::{ActionValues, ValueModel as CoreValues};
use cohelm_copilot::encode::ValueEncoder;
use cohelm_copilot::model::{Network, ValueNetwork};
use cohelm_copilot::values::NetworkValues;
use cohelm_copilot::{Kind as ModelKind, Model, shipped as shipped_models};
use cohelm_nn::critic::{CriticScratch, Feature};
use cohelm_nn::lstm::LstmState;
use cohelm_nn::mlp::MlpScratch;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::PathBuf;
use std::sync::Arc;

/// What every action is worth for a goal.
#[pyclass(module = "cohelm", frozen)]
pub struct ValueModel {
    source: Source,
}

#[derive(Clone)]
enum Source {
    Trained(Model),
    Layers(Arc<Layers>),
}

/// Adds a network's outputs for one row of inputs.
type Forward<'a> = Box<dyn FnMut(&[f32], &mut Vec<f32>) + 'a>;

/// A network of dense layers with ReLU between them, whose inputs are ours: state, then the goal relative to the plant.
struct Layers {
    layers: Vec<Dense>,
}

struct Dense {
    weights: Vec<f32>,
    bias: Vec<f32>,
}

impl ValueModel {
    /// The values for a cockpit over so many commands and numbers of state, and their median range.
    pub fn values(&self, state: usize, commands: usize) -> PyResult<(Box<dyn CoreValues>, f64)> {
        match &self.source {
            Source::Trained(model) => {
                let Network::Values(network) = model.network() else {
                    return Err(wrong_kind(model, ModelKind::Values));
                };
                let values = NetworkValues::new(model.card(), network.clone());
                let values =
                    values.ok_or_else(|| Kind::Model.error("the model's action space has no commands"))?;
                Ok((Box::new(values), model.card().median_range.unwrap_or(f64::NAN)))
            }
            Source::Layers(layers) => {
                let encoder = ValueEncoder::new(state, 0);
                layers.check(encoder.len(), commands)?;
                let candidates = (0..commands).map(|command| Action::Command(command as u8)).collect();
                let values = ActionValues::equal(candidates).map_err(|error| Kind::Model.error(error))?;
                let input = vec![0.0; encoder.len()];
                Ok((Box::new(LayeredValues { layers: layers.clone(), encoder, input, values }), f64::NAN))
            }
        }
    }

    /// The model, if it is one of ours.
    pub fn trained(&self) -> Option<&Model> {
        match &self.source {
            Source::Trained(model) => Some(model),
            Source::Layers(_) => None,
        }
    }

    /// One of ours.
    pub fn of(model: Model) -> Self {
        Self { source: Source::Trained(model) }
    }
}

#[pymethods]
impl ValueModel {
    /// Reads a model's file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        read(path, ModelKind::Values).map(Self::of)
    }

    /// Reads the bytes of a model's file.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        of_kind(parsed(bytes)?, ModelKind::Values).map(Self::of)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>,))> {
        let (class, py) = (slf.get_type(), slf.py());
        match &slf.get().source {
            Source::Trained(model) => {
                Ok((class.getattr("from_bytes")?, (PyBytes::new(py, model.bytes()).into_any(),)))
            }
            Source::Layers(layers) => {
                let layers: Vec<_> =
                    layers.layers.iter().map(|layer| layer.arrays(py)).collect::<PyResult<_>>()?;
                Ok((class.getattr("from_layers")?, (layers.into_pyobject(py)?,)))
            }
        }
    }

    /// Values from a network trained elsewhere: (weights of outputs × inputs, bias of outputs) of each layer, ReLU between
    /// them. Its inputs are the plant's state and the goal relative to the plant (x, y); its outputs the commands.
    #[staticmethod]
    fn from_layers(layers: Vec<(PyReadonlyArray2<'_, f32>, PyReadonlyArray1<'_, f32>)>) -> PyResult<Self> {
        let dense = |(weights, bias): &(PyReadonlyArray2<'_, f32>, PyReadonlyArray1<'_, f32>)| {
            let (weights, bias) = (weights.as_array(), bias.as_array());
            let finite = weights.iter().chain(bias.iter()).all(|weight| weight.is_finite());
            if weights.nrows() != bias.len() || weights.ncols() == 0 || bias.is_empty() || !finite {
                let message = format!(
                    "a layer is finite weights (outputs, inputs) and a bias (outputs,), got {:?} and {:?}",
                    weights.dim(),
                    bias.dim()
                );
                return Err(Kind::Array.error(message));
            }
            Ok((Dense { weights: weights.iter().copied().collect(), bias: bias.to_vec() }, weights.ncols()))
        };
        let layers: Vec<(Dense, usize)> = layers.iter().map(dense).collect::<PyResult<_>>()?;
        for pair in layers.windows(2) {
            if pair[0].0.bias.len() != pair[1].1 {
                let message = format!(
                    "a layer of {} inputs follows one of {} outputs",
                    pair[1].1,
                    pair[0].0.bias.len()
                );
                return Err(Kind::Array.error(message));
            }
        }
        if layers.is_empty() {
            return Err(Kind::Array.error("a network has at least one layer"));
        }
        let layers = layers.into_iter().map(|(dense, _)| dense).collect();
        Ok(Self { source: Source::Layers(Arc::new(Layers { layers })) })
    }

    /// SHA-256 of the file, by which records name the model; None for one from elsewhere.
    #[getter]
    fn hash(&self) -> Option<&str> {
        self.trained().map(Model::hash)
    }

    /// The model's card as JSON; None for one from elsewhere.
    #[getter]
    fn card_json(&self) -> PyResult<Option<String>> {
        self.trained().map(card_json).transpose()
    }

    /// The bytes of the model's file.
    fn to_bytes(&self) -> PyResult<&[u8]> {
        let model = self
            .trained()
            .ok_or_else(|| Kind::Model.error("a network from elsewhere has no file of ours"))?;
        Ok(model.bytes())
    }

    /// What actions are worth in a world as it is now: indices of commands (int64, actions) or rows of axes (float32,
    /// actions × axes); for a goal, the pilot's own unless given.
    #[pyo3(signature = (world, actions, *, goal=None))]
    fn assess<'py>(
        &self,
        py: Python<'py>,
        world: &mut World,
        actions: &Bound<'py, PyAny>,
        goal: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let (task, _) = world.recipe(py);
        let plant = world.plant();
        if let Some(model) = self.trained() {
            fits(model, &task, plant)?;
        }
        let (view, goal) = (plant.view(), goal.unwrap_or(plant.pilot_goal()));
        if goal >= view.goals.len() {
            let message =
                format!("expected a goal from 0 to {}, got {goal}", view.goals.len().saturating_sub(1));
            return Err(Kind::Option.error(message));
        }
        let mut read = vec![None; actions.len()?];
        Actions { space: plant.space(), worlds: read.len() }.read(actions, &mut read)?;
        let asked: Vec<Action> = read.iter().copied().flatten().collect();
        if asked.len() != read.len() {
            return Err(Kind::Action.error("nothing has no value: only what can be carried out"));
        }
        let (mut values, mut worth) =
            (self.values(view.state.len(), plant.space().commands())?.0, Vec::new());
        values.assess(&view, goal, &asked, None, &mut worth);
        Ok(PyArray1::from_vec(py, worth))
    }

    /// The network's outputs for rows of inputs (float32, rows × inputs): what PyTorch gives with the same weights. Those of
    /// a critic of actions on axes are w(s), one number a feature, and then V(s).
    fn forward<'py>(
        &self,
        py: Python<'py>,
        inputs: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let (rows, width) = inputs.as_array().dim();
        let network: (usize, Forward<'_>) = match &self.source {
            Source::Layers(layers) => {
                (layers.inputs(), Box::new(|row, outputs| outputs.extend(layers.forward(row))))
            }
            Source::Trained(model) => match model.network() {
                Network::Values(ValueNetwork::Commands(network)) => {
                    let mut scratch = MlpScratch::new(network.shape());
                    let forward = move |row: &[f32], outputs: &mut Vec<f32>| {
                        outputs.extend_from_slice(network.forward(row, &mut scratch));
                    };
                    (network.shape().input(), Box::new(forward))
                }
                Network::Values(ValueNetwork::Axes(critic)) => {
                    let mut scratch = CriticScratch::new(critic.shape());
                    let look = move |row: &[f32], outputs: &mut Vec<f32>| {
                        critic.look(row, &mut scratch);
                        outputs.extend_from_slice(scratch.outputs());
                    };
                    (critic.shape().input(), Box::new(look))
                }
                Network::Intent(_) => return Err(wrong_kind(model, ModelKind::Values)),
            },
        };
        let (expected, mut forward) = network;
        expect_inputs(expected, width)?;
        let mut outputs = Vec::new();
        for row in inputs.as_array().rows() {
            forward(&row.to_vec(), &mut outputs);
        }
        let columns = outputs.len().checked_div(rows).unwrap_or(0);
        PyArray1::from_vec(py, outputs).reshape([rows, columns])
    }

    /// What a critic of actions on axes makes of encoded actions, φ (float32, rows × features), for rows of the numbers that
    /// encode an action (float32, rows × encoded).
    fn embed<'py>(
        &self,
        py: Python<'py>,
        encoded: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let Some(Network::Values(ValueNetwork::Axes(critic))) = self.trained().map(Model::network) else {
            return Err(Kind::Model.error("only a critic of actions on axes embeds actions; see forward"));
        };
        let encoded = encoded.as_array();
        expect_inputs(critic.shape().action(), encoded.ncols())?;
        let width = critic.shape().width();
        let mut features = vec![0.0; encoded.nrows() * width];
        for (row, features) in encoded.rows().into_iter().zip(features.chunks_exact_mut(width)) {
            let action: Vec<Feature> = row.iter().copied().enumerate().collect();
            critic.embed(&action, features);
        }
        PyArray1::from_vec(py, features).reshape([encoded.nrows(), width])
    }
}

/// Which goal the pilot wants.
#[pyclass(module = "cohelm", frozen)]
pub struct IntentModel {
    /// The model.
    pub model: Model,
}

#[pymethods]
impl IntentModel {
    /// Reads the bytes of a model's file.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        Ok(Self { model: of_kind(parsed(bytes)?, ModelKind::Intent)? })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let bytes = PyBytes::new(slf.py(), slf.get().model.bytes());
        Ok((slf.get_type().getattr("from_bytes")?, (bytes,)))
    }

    /// The outputs of one of its two networks, `"regression"` (x, y) or `"calibrated"` (x, y, ln σ), over the ticks of one
    /// sequence (float32, ticks × inputs), from a state of zeros: what PyTorch's LSTM gives with the same weights.
    fn forward<'py>(
        &self,
        py: Python<'py>,
        network: &str,
        inputs: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let Network::Intent(networks) = self.model.network() else {
            return Err(wrong_kind(&self.model, ModelKind::Intent));
        };
        let network = match network {
            "regression" => &networks.regression,
            "calibrated" => &networks.calibrated,
            _ => {
                let message = format!("a network is \"regression\" or \"calibrated\", got {network:?}");
                return Err(Kind::Option.error(message));
            }
        };
        let inputs = inputs.as_array();
        expect_inputs(network.shape().input(), inputs.ncols())?;
        let mut state = LstmState::new(network.shape());
        let mut outputs = Vec::new();
        for row in inputs.rows() {
            outputs.extend_from_slice(network.step(&row.to_vec(), &mut state));
        }
        PyArray1::from_vec(py, outputs).reshape([inputs.nrows(), network.shape().output()])
    }

    /// Reads a model's file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        Ok(Self { model: read(path, ModelKind::Intent)? })
    }

    /// SHA-256 of the file, by which records name the model.
    #[getter]
    fn hash(&self) -> &str {
        self.model.hash()
    }

    /// The model's card as JSON.
    #[getter]
    fn card_json(&self) -> PyResult<String> {
        card_json(&self.model)
    }

    /// The bytes of the model's file.
    fn to_bytes(&self) -> &[u8] {
        self.model.bytes()
    }
}

/// The models that come with the package: name → ValueModel or IntentModel.
#[pyfunction]
pub fn shipped<'py>(py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
    let (models, _) = shipped_models::models();
    let all = PyDict::new(py);
    for model in models.iter() {
        let name = format!("{}.{}", model.card().name, model.card().kind.word());
        match model.card().kind {
            ModelKind::Values => all.set_item(name, Py::new(py, ValueModel::of(model.clone()))?)?,
            ModelKind::Intent => all.set_item(name, Py::new(py, IntentModel { model: model.clone() })?)?,
        }
    }
    Ok(all)
}

/// The models among them that are meant for a plant with these options, unless others are named: of values, and of intent
/// (if a goal is to be imagined, one that was trained without seeing goals).
#[pyfunction]
#[pyo3(signature = (plant, options_json, *, imagined=false))]
pub fn shipped_for(
    plant: &str,
    options_json: &str,
    imagined: bool,
) -> PyResult<(Option<ValueModel>, Option<IntentModel>)> {
    let options = serde_json::from_str(options_json).map_err(|error| Kind::Option.error(error))?;
    let task = Task { plant: plant.into(), options };
    let plant = plants().make(&task).map_err(|error| Kind::Option.error(error))?;
    let (models, _) = shipped_models::models();
    let usual = |kind| models.newest_for(kind, &task, plant.space()).cloned();
    let imagines = |model: &&Model| {
        let card = model.card();
        card.kind == ModelKind::Intent
            && card.task.plant == task.plant
            && card.space == *plant.space()
            && card.goals == 0
    };
    let intent =
        if imagined { models.iter().rev().find(imagines).cloned() } else { usual(ModelKind::Intent) };
    Ok((usual(ModelKind::Values).map(ValueModel::of), intent.map(|model| IntentModel { model })))
}

/// Weights and bias of a layer.
type Arrays<'py> = (Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<f32>>);

impl Dense {
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Arrays<'py>> {
        let outputs = self.bias.len();
        let weights =
            PyArray1::from_slice(py, &self.weights).reshape([outputs, self.weights.len() / outputs])?;
        Ok((weights, PyArray1::from_slice(py, &self.bias)))
    }
}

impl Layers {
    fn inputs(&self) -> usize {
        self.layers[0].weights.len() / self.layers[0].bias.len()
    }

    fn check(&self, inputs: usize, commands: usize) -> PyResult<()> {
        let outputs = self.layers[self.layers.len() - 1].bias.len();
        if (self.inputs(), outputs) == (inputs, commands) {
            return Ok(());
        }
        let found = format!("the network has {} inputs and {outputs} outputs", self.inputs());
        Err(Kind::Model.error(format!("{found}; this task needs {inputs} and {commands}")))
    }

    fn forward(&self, input: &[f32]) -> Vec<f32> {
        let last = self.layers.len() - 1;
        self.layers.iter().enumerate().fold(input.to_vec(), |input, (index, layer)| {
            let row = |(weights, bias): (&[f32], &f32)| {
                let sum = weights.iter().zip(&input).fold(*bias, |sum, (weight, x)| sum + weight * x);
                if index < last { sum.max(0.0) } else { sum }
            };
            layer.weights.chunks_exact(input.len()).zip(&layer.bias).map(row).collect()
        })
    }
}

struct LayeredValues {
    layers: Arc<Layers>,
    encoder: ValueEncoder,
    input: Vec<f32>,
    values: ActionValues,
}

impl LayeredValues {
    /// Q of every command. Values that overflowed are no opinion, as with our own networks: the person passes through.
    fn of_commands(&mut self, view: &View<'_>, goal: usize, asked: Option<Action>) -> Vec<f32> {
        self.encoder.encode(view, goal, asked, &mut self.input);
        let mut values = self.layers.forward(&self.input);
        if !values.iter().all(|value| value.is_finite()) {
            values.fill(0.0);
        }
        values
    }
}

impl CoreValues for LayeredValues {
    fn estimate(&mut self, view: &View<'_>, goal: usize, asked: Option<Action>) -> &ActionValues {
        let values = self.of_commands(view, goal, asked);
        let filled = self.values.refill(&values);
        debug_assert!(filled.is_ok(), "one finite value for each command");
        &self.values
    }

    fn assess(
        &mut self,
        view: &View<'_>,
        goal: usize,
        actions: &[Action],
        asked: Option<Action>,
        values: &mut Vec<f32>,
    ) {
        let of_commands = self.of_commands(view, goal, asked);
        let value = |action: &Action| action.command().and_then(|command| of_commands.get(command).copied());
        values.clear();
        values.extend(actions.iter().map(|action| value(action).unwrap_or(0.0)));
    }
}

fn expect_inputs(expected: usize, found: usize) -> PyResult<()> {
    if expected == found {
        Ok(())
    } else {
        Err(Kind::Array.error(format!("expected rows of {expected} inputs, got {found}")))
    }
}

fn parsed(bytes: &[u8]) -> PyResult<Model> {
    Model::from_bytes(bytes).map_err(|error| Kind::Model.error(format!("these bytes are no model: {error}")))
}

fn of_kind(model: Model, kind: ModelKind) -> PyResult<Model> {
    if model.card().kind == kind { Ok(model) } else { Err(wrong_kind(&model, kind)) }
}

fn read(path: PathBuf, kind: ModelKind) -> PyResult<Model> {
    let bytes = std::fs::read(&path)
        .map_err(|error| Kind::Model.error(format!("cannot read the model {}: {error}", path.display())))?;
    let model = Model::from_bytes(&bytes)
        .map_err(|error| Kind::Model.error(format!("{} is no model: {error}", path.display())))?;
    of_kind(model, kind)
}

fn wrong_kind(model: &Model, needed: ModelKind) -> PyErr {
    let (name, found) = (&model.card().name, model.card().kind.word());
    Kind::Model
        .error(format!("the model {name:?} is for {found}, but a model for {} is needed", needed.word()))
}

fn card_json(model: &Model) -> PyResult<String> {
    serde_json::to_string(model.card()).map_err(|error| Kind::Model.error(error))
}
