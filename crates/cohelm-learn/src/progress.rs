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

/// Where the time of value training went. Two parts of it run at the same time where there are two threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Profile {
    /// Altogether, by the clock.
    pub wall: Duration,
    /// Flying the worlds, by the clock.
    pub collect: Duration,
    /// All updates, by the clock.
    pub learn: Duration,
    /// First half of the updates: drawing batches, and what the values should be.
    pub prepare: Duration,
    /// Second half of the updates, at the same time: forward and backward pass, optimiser.
    pub train: Duration,
    /// Flying fresh episodes to compare checkpoints, by the clock.
    pub validate: Duration,
    /// Writing checkpoints, by the clock.
    pub save: Duration,
    /// Making the transitions before a checkpoint again after an interruption, by the clock.
    pub resume: Duration,
}
