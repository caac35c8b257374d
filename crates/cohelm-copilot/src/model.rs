//! A model file: its bytes, its hash, its card and its networks.

use crate::axes::AxesEncoder;
use crate::card::{Card, Kind};
use crate::encode::{INTENT_VERSION, IntentEncoder, VALUES_VERSION, ValueEncoder};
use crate::outputs::Outputs;
use cohelm::action::ActionSpace;
use cohelm::intent::MAX_GOALS;
use cohelm_nn::critic::Critic;
use cohelm_nn::goal_head;
use cohelm_nn::lstm::Lstm;
use cohelm_nn::mlp::Mlp;
use cohelm_nn::weights::{TensorFile, WeightsError};
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Key of the card among a file's metadata.
pub const CARD_KEY: &str = "card";
/// Prefix of the tensors of a value network.
const VALUES_PREFIX: &str = "values.";
/// Prefix of the tensors of the intent network that predicts a position.
const REGRESSION_PREFIX: &str = "regression.";
/// Prefix of the tensors of the intent network that compares the goals.
const CALIBRATED_PREFIX: &str = "calibrated.";
/// Weights beyond this are none that training gives, and would let values overflow.
const LARGEST_WEIGHT: f32 = 1e4;
/// What a space needs to have values.
const NO_ACTIONS: &str = "it needs a list of commands, or axes";
/// What axes need to have values.
const NO_CRITIC: &str = "one to four of them, each from a finite number of at most 0 to one of at least 0, and values that \
                         do not take what is asked as input";

/// A model, cheap to clone.
#[derive(Clone, Debug)]
pub struct Model {
    hash: String,
    card: Arc<Card>,
    network: Network,
    bytes: Arc<[u8]>,
}

/// The networks of a model.
#[derive(Clone, Debug)]
pub enum Network {
    /// Values of actions.
    Values(ValueNetwork),
    /// The pilot's goal.
    Intent(Arc<IntentNetworks>),
}

/// What estimates values, by the kind of action.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueNetwork {
    /// Of every command at once.
    Commands(Arc<Mlp>),
    /// Of any action on axes.
    Axes(Arc<Critic>),
}

impl From<&Mlp> for ValueNetwork {
    fn from(network: &Mlp) -> Self {
        Self::Commands(Arc::new(network.clone()))
    }
}

impl From<&Critic> for ValueNetwork {
    fn from(critic: &Critic) -> Self {
        Self::Axes(Arc::new(critic.clone()))
    }
}

impl From<&Self> for ValueNetwork {
    fn from(network: &Self) -> Self {
        network.clone()
    }
}

impl ValueNetwork {
    fn save(&self, file: &mut TensorFile) {
        match self {
            Self::Commands(network) => network.save(file, VALUES_PREFIX),
            Self::Axes(critic) => critic.save(file, VALUES_PREFIX),
        }
    }
}

/// The two networks that infer intent. They learn from the same flights; only the calibrated one sees where the goals
/// are, so that the other stays the paper's.
#[derive(Clone, Debug, PartialEq)]
pub struct IntentNetworks {
    /// Predicts the position of the pilot's goal: outputs x and y.
    pub regression: Lstm,
    /// Predicts position and spread: outputs x, y and ln σ ([`goal_head`]).
    pub calibrated: Lstm,
}

/// Why bytes are no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// They are no file of weights.
    #[error("this is no model: {0}")]
    Weights(#[from] WeightsError),
    /// The card cannot be read.
    #[error("the model's card cannot be read: {0}; train the model again with this version")]
    Card(String),
    /// Something else than a network of this version belongs to it.
    #[error(
        "the model {name:?} was made for inputs of version {found}, this program has version {known}: train it again"
    )]
    EncoderVersion {
        /// The model's name.
        name: String,
        /// Its version.
        found: u32,
        /// The version of this program.
        known: u32,
    },
    /// The networks do not fit the card.
    #[error("the model {name:?} does not fit its own card: {part} should be {expected}, but is {found}")]
    Shape {
        /// The model's name.
        name: String,
        /// What of it.
        part: &'static str,
        /// What the card says.
        expected: usize,
        /// What the weights have.
        found: usize,
    },
    /// Its action space is empty.
    #[error("the model {name:?} is for an action space without actions: {NO_ACTIONS}")]
    NoCommands {
        /// The model's name.
        name: String,
    },
    /// Its axes are none that a critic can see.
    #[error("the model {name:?} is for axes that a critic cannot see: {NO_CRITIC}")]
    Axes {
        /// The model's name.
        name: String,
    },
    /// A weight is far too large.
    #[error("a weight of the model {name:?} is {value}; training gives none beyond ±{LARGEST_WEIGHT}")]
    Weight {
        /// The model's name.
        name: String,
        /// The weight.
        value: f32,
    },
}

impl Model {
    /// Reads a model from a file's bytes, checking everything: whatever is read here can fly.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ModelError> {
        let file = TensorFile::from_bytes(bytes)?;
        let card: Card =
            serde_json::from_str(file.get(CARD_KEY)?).map_err(|error| ModelError::Card(error.to_string()))?;
        let network = match card.kind {
            Kind::Values => Network::Values(values(&file, &card)?),
            Kind::Intent => Network::Intent(Arc::new(intent(&file, &card)?)),
        };
        Ok(Self { hash: hash(bytes), card: Arc::new(card), network, bytes: bytes.into() })
    }

    /// Puts a value network into a model; the result is checked as a file is.
    pub fn of_values(card: &Card, network: impl Into<ValueNetwork>) -> Result<Self, ModelError> {
        let mut file = with_card(card)?;
        network.into().save(&mut file);
        Self::from_bytes(&file.to_bytes()?)
    }

    /// Puts intent networks into a model; the result is checked as a file is.
    pub fn of_intent(card: &Card, networks: &IntentNetworks) -> Result<Self, ModelError> {
        let mut file = with_card(card)?;
        networks.regression.save(&mut file, REGRESSION_PREFIX);
        networks.calibrated.save(&mut file, CALIBRATED_PREFIX);
        Self::from_bytes(&file.to_bytes()?)
    }

    /// The same networks with another card.
    pub fn with_card(&self, card: &Card) -> Result<Self, ModelError> {
        match &self.network {
            Network::Values(network) => Self::of_values(card, network),
            Network::Intent(networks) => Self::of_intent(card, networks),
        }
    }

    /// SHA-256 of the file's bytes, in lower-case hexadecimal: what a record names a model by.
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// The card.
    pub fn card(&self) -> &Card {
        &self.card
    }

    /// The networks.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// The file's bytes, as they were read or as they are to be written.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// SHA-256 of bytes, in lower-case hexadecimal.
pub fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn with_card(card: &Card) -> Result<TensorFile, ModelError> {
    let card = serde_json::to_string(card).map_err(|error| ModelError::Card(error.to_string()))?;
    let mut file = TensorFile::new();
    file.set(CARD_KEY, card);
    Ok(file)
}

fn values(file: &TensorFile, card: &Card) -> Result<ValueNetwork, ModelError> {
    if matches!(card.space, ActionSpace::Axes { .. }) { critic(file, card) } else { of_commands(file, card) }
}

fn critic(file: &TensorFile, card: &Card) -> Result<ValueNetwork, ModelError> {
    let critic = Critic::load(file, VALUES_PREFIX)?;
    let check = Check { file, card };
    check.tensors(&[VALUES_PREFIX])?;
    check.version(VALUES_VERSION)?;
    let axes = AxesEncoder::of(&card.space).ok_or_else(|| ModelError::Axes { name: check.name() })?;
    if card.sees_asked {
        return Err(ModelError::Axes { name: check.name() });
    }
    check.equal("the number of inputs", ValueEncoder::new(card.state, 0).len(), critic.shape().input())?;
    check.equal("the numbers that show an action", axes.len(), critic.shape().action())?;
    check.weights(critic.params())?;
    Ok(ValueNetwork::Axes(Arc::new(critic)))
}

fn of_commands(file: &TensorFile, card: &Card) -> Result<ValueNetwork, ModelError> {
    let network = Mlp::load(file, VALUES_PREFIX)?;
    let check = Check { file, card };
    check.tensors(&[VALUES_PREFIX])?;
    check.version(VALUES_VERSION)?;
    let outputs = check.outputs()?;
    let encoder = ValueEncoder::new(card.state, if card.sees_asked { outputs.commands() } else { 0 });
    check.equal("the number of inputs", encoder.len(), network.shape().input())?;
    check.equal("the number of outputs", outputs.len(), network.shape().outputs())?;
    check.weights(network.params())?;
    Ok(ValueNetwork::Commands(Arc::new(network)))
}

fn intent(file: &TensorFile, card: &Card) -> Result<IntentNetworks, ModelError> {
    let regression = Lstm::load(file, REGRESSION_PREFIX)?;
    let calibrated = Lstm::load(file, CALIBRATED_PREFIX)?;
    let check = Check { file, card };
    check.tensors(&[REGRESSION_PREFIX, CALIBRATED_PREFIX])?;
    check.version(INTENT_VERSION)?;
    if card.goals > MAX_GOALS {
        return Err(check.wrong("the number of goals, at most,", MAX_GOALS, card.goals));
    }
    let encoder = IntentEncoder::new(&card.space, card.state, card.goals);
    let encoder = encoder.ok_or_else(|| ModelError::NoCommands { name: check.name() })?;
    check.equal("the number of inputs", encoder.without_goals(), regression.shape().input())?;
    check.equal("the number of outputs", 2, regression.shape().output())?;
    check.equal("the calibrated head's inputs", encoder.with_goals(), calibrated.shape().input())?;
    check.equal("the calibrated head's outputs", goal_head::OUTPUTS, calibrated.shape().output())?;
    check.weights(regression.params())?;
    check.weights(calibrated.params())?;
    Ok(IntentNetworks { regression, calibrated })
}

/// Holds the parts of a file against its card.
struct Check<'a> {
    file: &'a TensorFile,
    card: &'a Card,
}

impl Check<'_> {
    fn name(&self) -> String {
        self.card.name.clone()
    }

    fn tensors(&self, prefixes: &[&str]) -> Result<(), ModelError> {
        let foreign = self.file.names().find(|name| !prefixes.iter().any(|prefix| name.starts_with(prefix)));
        foreign.map_or(Ok(()), |name| Err(WeightsError::UnexpectedTensor { name: name.into() }.into()))
    }

    fn version(&self, known: u32) -> Result<(), ModelError> {
        let found = self.card.encoder_version;
        if found == known {
            Ok(())
        } else {
            Err(ModelError::EncoderVersion { name: self.name(), found, known })
        }
    }

    fn outputs(&self) -> Result<Outputs, ModelError> {
        self.card.outputs().ok_or_else(|| ModelError::NoCommands { name: self.name() })
    }

    fn equal(&self, part: &'static str, expected: usize, found: usize) -> Result<(), ModelError> {
        if expected == found { Ok(()) } else { Err(self.wrong(part, expected, found)) }
    }

    fn wrong(&self, part: &'static str, expected: usize, found: usize) -> ModelError {
        ModelError::Shape { name: self.name(), part, expected, found }
    }

    fn weights(&self, weights: &[f32]) -> Result<(), ModelError> {
        let large = weights.iter().find(|weight| weight.abs() > LARGEST_WEIGHT);
        large.map_or(Ok(()), |&value| Err(ModelError::Weight { name: self.name(), value }))
    }
}
