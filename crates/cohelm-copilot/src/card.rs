//! What a model says of itself.

use crate::outputs::Outputs;
use cohelm::action::ActionSpace;
use cohelm::intent::Inference;
use cohelm::registry::Task;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What a model is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Estimates what every command is worth.
    Values,
    /// Infers the pilot's goal.
    Intent,
}

impl Kind {
    /// The word for it in options, files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Values => "values",
            Self::Intent => "intent",
        }
    }
}

/// A model card. The whole of it lies inside the model's file; a copy beside the file is for people.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Card {
    /// What the model is called, such as `flag-lander-switches`.
    pub name: String,
    /// What it is for.
    pub kind: Kind,
    /// What makes it another than the usual model of its plant and actions, such as `paper` or `sees-asked`. A variant
    /// is used only where it is asked for.
    #[serde(default)]
    pub variant: Option<String>,
    /// The plant it was trained on, with its options.
    pub task: Task,
    /// Version of that plant; on another version it may fly worse, so it is refused there.
    pub plant_version: u32,
    /// The actions it knows. A plant with others is refused.
    pub space: ActionSpace,
    /// Numbers in the plant's state.
    pub state: usize,
    /// Goals that its networks see; 0 for intent that knows no goals and imagines one.
    pub goals: usize,
    /// How far, by its standard deviation along an axis, the pilots' goals lay from their mean in training, in normalised
    /// units: the spread of somebody who knows nothing. Intent that knows no goals only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal_spread: Option<f64>,
    /// Version of what its networks see ([`encode`](crate::encode)).
    pub encoder_version: u32,
    /// True if the values take what is asked as input, as a sentence of the paper has it.
    #[serde(default)]
    pub sees_asked: bool,
    /// True if a switch space has one output a command, so that ties between commands of equal effect are broken by
    /// noise; see [`outputs`](crate::outputs).
    #[serde(default)]
    pub free_outputs: bool,
    /// The seed it was trained from.
    pub seed: u64,
    /// What trained it: every option with its value.
    pub options: Value,
    /// The program and the arithmetic that trained it.
    pub trained_with: TrainedWith,
    /// Median over states of max Q − min Q, in the values' units; what the κ of MISC-R multiplies. Values only.
    #[serde(default)]
    pub median_range: Option<f64>,
    /// How well it does, by whatever it was measured.
    pub scores: Value,
}

impl Card {
    /// True if an intent model can serve this inference: a goal is imagined by networks that know none, and all other
    /// inferences compare goals.
    pub fn serves(&self, inference: Inference) -> bool {
        (self.goals == 0) == inference.hides_goals()
    }

    /// Which network output stands for which command; `None` if its space has no commands.
    pub fn outputs(&self) -> Option<Outputs> {
        if self.free_outputs { Outputs::free(&self.space) } else { Outputs::of(&self.space) }
    }
}

/// The same seed gives the same weights where these are the same.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainedWith {
    /// Version of cohelm.
    pub cohelm: String,
    /// Kind of GEMM kernel, which depends on the CPU.
    pub kernel: String,
}
