//! What training says while it runs, and where its time went.

use serde::Serialize;
use std::ops::ControlFlow;
use std::time::Duration;

/// How far training is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Progress {
    /// What is being done, such as `values` or `intent, round 2: flying`.
    pub stage: String,
    /// Units of it that are done.
    pub done: u64,
    /// Units of it altogether.
    pub total: u64,
    /// The last numbers of the learning curve, by name.
    pub numbers: Vec<(&'static str, f64)>,
}

/// Sees progress and may stop training, which then leaves its checkpoint behind.
pub type Watch<'a> = &'a mut dyn FnMut(&Progress) -> ControlFlow<()>;

/// Where the time of value training went. Collecting runs beside learning where there are two threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Profile {
    /// Altogether, by the clock.
    pub wall: Duration,
    /// Flying the worlds.
    pub collect: Duration,
    /// All updates.
    pub learn: Duration,
    /// Of that: drawing batches from the memory.
    pub sample: Duration,
    /// Of that: forward and backward passes.
    pub gradients: Duration,
    /// Of that: optimiser and target network.
    pub optimise: Duration,
    /// Flying fresh episodes to compare checkpoints.
    pub validate: Duration,
    /// Writing checkpoints.
    pub save: Duration,
    /// Making the transitions before the checkpoint again, after an interruption.
    pub resume: Duration,
}
