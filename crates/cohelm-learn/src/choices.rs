//! What is chosen at a step, in the numbers that are remembered and learnt from: the output of a network of commands, or
//! an action on axes.

use crate::job::{Job, LearnError};
use crate::mirrored::MirroredChoice;
use crate::options::ValueOptions;
use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Mirror, Plant};
use cohelm::random::Draws;
use cohelm_copilot::axes::AxesEncoder;
use cohelm_copilot::model::ValueNetwork;
use cohelm_copilot::outputs::Outputs;
use cohelm_copilot::search::{GRID, Search};
use cohelm_nn::critic::Critic;
use cohelm_nn::mlp::{Head, Mlp, MlpShape};
use cohelm_nn::weights::{TensorFile, WeightsError};

/// A choice: the number of an output and zeros, or the values of the axes.
pub(crate) type Choice = [f32; 4];

/// How often a random action on axes is one of the grid, which holds what no random number hits: nothing, and the ends.
const FROM_THE_GRID: f64 = 0.5;

/// What there is to choose from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Choices {
    Commands(Outputs),
    Axes { axes: AxesEncoder, grid: Vec<Action> },
}

impl Choices {
    /// Of a plant, under some options.
    pub fn of(job: &Job<'_>, options: &ValueOptions, plant: &dyn Plant) -> Result<Self, LearnError> {
        let (space, none) = (plant.space(), || LearnError::NoActions(job.task.plant.clone()));
        if !matches!(space, ActionSpace::Axes { .. }) {
            let outputs = if options.effective_outputs { Outputs::of(space) } else { Outputs::free(space) };
            return outputs.map(Self::Commands).ok_or_else(none);
        }
        if options.sees_asked {
            let reason = "values of actions on axes do not take what is asked; turn it off".into();
            return Err(LearnError::Option { option: "sees_asked", reason });
        }
        Self::of_axes(space).ok_or_else(none)
    }

    /// Of a model's card.
    pub fn of_card(card: &cohelm_copilot::Card) -> Option<Self> {
        card.outputs().map(Self::Commands).or_else(|| Self::of_axes(&card.space))
    }

    fn of_axes(space: &ActionSpace) -> Option<Self> {
        let axes = AxesEncoder::of(space)?;
        Some(Self::Axes { grid: axes.grid(GRID), axes })
    }

    /// Numbers of a choice that are not always 0.
    pub fn width(&self) -> usize {
        match self {
            Self::Commands(_) => 1,
            Self::Axes { axes, .. } => axes.axes(),
        }
    }

    /// Numbers by which a network is told what is asked, if it takes that: one a command.
    pub fn asked(&self, sees_asked: bool) -> usize {
        match self {
            Self::Commands(outputs) if sees_asked => outputs.commands(),
            _ => 0,
        }
    }

    /// The choice that carrying something out is, given how the switches stand.
    pub fn of_executed(&self, executed: Option<Action>, switches: u8) -> Choice {
        match (self, executed) {
            (Self::Commands(outputs), _) => [outputs.output_of(executed, switches) as f32, 0.0, 0.0, 0.0],
            (Self::Axes { .. }, Some(Action::Axes(axes))) => axes,
            (Self::Axes { .. }, _) => [0.0; 4],
        }
    }

    /// Any action at all.
    pub fn random(&self, draws: &mut Draws) -> Action {
        match self {
            Self::Commands(outputs) => Action::Command(draws.below(outputs.commands()) as u8),
            Self::Axes { grid, .. } if draws.chance(FROM_THE_GRID) => grid[draws.below(grid.len())],
            Self::Axes { axes, .. } => {
                axes.at(core::array::from_fn(|i| if i < axes.axes() { draws.unit() as f32 } else { 0.0 }))
            }
        }
    }

    /// What choices become in a mirror; `None` if it does not tell.
    pub fn mirrored(&self, mirror: &Mirror) -> Option<MirroredChoice> {
        match self {
            Self::Commands(outputs) => {
                let told = mirror.commands.len() == outputs.commands();
                told.then(|| MirroredChoice::outputs(mirror, *outputs))
            }
            Self::Axes { axes, .. } => {
                let told = mirror.axes.len() == axes.axes();
                told.then(|| MirroredChoice::Axes(mirror.axes.clone()))
            }
        }
    }

    /// A network with fresh weights, for inputs of that many numbers.
    pub fn pupil(
        &self,
        input: usize,
        options: &ValueOptions,
        space: &ActionSpace,
        draws: &mut Draws,
    ) -> Result<Pupil, LearnError> {
        let uniform = || draws.unit() as f32;
        let wrong = |reason: String| LearnError::Option { option: "hidden", reason };
        match self {
            Self::Commands(outputs) => {
                let head = if options.dueling { Head::Dueling } else { Head::Plain };
                let shape = MlpShape::new(input, &options.hidden, head(outputs.len()));
                Ok(Pupil::Commands(Mlp::new(&shape.map_err(|error| wrong(error.to_string()))?, uniform)))
            }
            Self::Axes { .. } => {
                let shape = Search::shape(space, input, &options.hidden);
                let shape = shape.ok_or_else(|| wrong("these widths make no critic".into()))?;
                Ok(Pupil::Axes(Critic::new(&shape, uniform)))
            }
        }
    }
}

/// A network that learns.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Pupil {
    Commands(Mlp),
    Axes(Critic),
}

impl Pupil {
    pub fn params(&self) -> &[f32] {
        match self {
            Self::Commands(network) => network.params(),
            Self::Axes(critic) => critic.params(),
        }
    }

    pub fn params_mut(&mut self) -> &mut [f32] {
        match self {
            Self::Commands(network) => network.params_mut(),
            Self::Axes(critic) => critic.params_mut(),
        }
    }

    pub fn save(&self, file: &mut TensorFile, prefix: &str) {
        match self {
            Self::Commands(network) => network.save(file, prefix),
            Self::Axes(critic) => critic.save(file, prefix),
        }
    }

    /// One of the same kind out of a file.
    pub fn load(&self, file: &TensorFile, prefix: &str) -> Result<Self, WeightsError> {
        match self {
            Self::Commands(_) => Mlp::load(file, prefix).map(Self::Commands),
            Self::Axes(_) => Critic::load(file, prefix).map(Self::Axes),
        }
    }

    /// As models have it.
    pub fn to_network(&self) -> ValueNetwork {
        match self {
            Self::Commands(network) => network.into(),
            Self::Axes(critic) => critic.into(),
        }
    }
}

impl From<&ValueNetwork> for Pupil {
    fn from(network: &ValueNetwork) -> Self {
        match network {
            ValueNetwork::Commands(network) => Self::Commands(network.as_ref().clone()),
            ValueNetwork::Axes(critic) => Self::Axes(critic.as_ref().clone()),
        }
    }
}
