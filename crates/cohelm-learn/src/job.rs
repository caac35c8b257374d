//! What is to be trained on, and why training may fail.

use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::{Plants, Task, TaskError};
use cohelm_copilot::ModelError;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Makes the simulated pilot of a number: the same person for the same number. The plant tells the actions there are.
pub type PilotFactory<'a> = &'a (dyn Fn(&dyn Plant, u64) -> Result<Box<dyn Pilot>, String> + Sync);

/// What to train on and with what: shared by all kinds of training.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The plants there are.
    pub plants: &'a Plants,
    /// Which of them, with which options.
    pub task: &'a Task,
    /// Fixes everything random: the same seed gives the same weights on one kind of CPU.
    pub seed: u64,
    /// Threads to use. The weights do not depend on it.
    pub threads: NonZeroUsize,
    /// Where checkpoints are kept; `None` for nowhere. A training that finds one of its own there goes on from it.
    pub checkpoints: Option<&'a Path>,
    /// What the model will be called; see [`Card::name`](cohelm_copilot::Card::name).
    pub name: &'a str,
    /// See [`Card::variant`](cohelm_copilot::Card::variant).
    pub variant: Option<&'a str>,
}

impl Job<'_> {
    /// Makes the plant.
    pub fn plant(&self) -> Result<Box<dyn Plant>, TaskError> {
        self.plants.make(self.task)
    }
}

/// Why training failed.
#[derive(Debug, thiserror::Error)]
pub enum LearnError {
    /// There is no such plant.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// It has no actions.
    #[error(
        "the plant {0:?} has no actions that values can be learnt for: it needs a list of commands, or one to four axes that \
         each go from a finite number of at most 0 to one of at least 0"
    )]
    NoActions(String),
    /// The options contradict each other or the plant.
    #[error("option {option:?}: {reason}")]
    Option {
        /// Which one.
        option: &'static str,
        /// What is wrong and what to try.
        reason: String,
    },
    /// A pilot could not be made.
    #[error("a simulated pilot could not be made: {0}")]
    Pilot(String),
    /// The weights became infinite or not a number.
    #[error("training diverged after {updates} updates: lower the learning rate")]
    Diverged {
        /// Updates done.
        updates: u64,
    },
    /// The callback asked to stop. If there is a checkpoint, training goes on from it the next time.
    #[error("training was stopped")]
    Stopped,
    /// The result is no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model or card could not be written.
    #[error("{}: {reason}", .path.display())]
    Write {
        /// Which file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A checkpoint could not be written or read.
    #[error("checkpoint {}: {reason}", .path.display())]
    Checkpoint {
        /// Which file.
        path: PathBuf,
        /// What is wrong and what to try.
        reason: String,
    },
}
