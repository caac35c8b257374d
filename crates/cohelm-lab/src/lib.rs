#![forbid(unsafe_code)]
//! Experiments with simulated pilots: evaluate a co-pilot, reproduce the paper, compare every rule, sweep over a grid.
//!
//! Simulated pilots are models, never presented as people. Names no plant and no pilot of its own: whoever runs an
//! experiment hands in how to make them. The same numbers come out for any number of threads.

pub mod compare;
pub mod episode;
pub mod experiment;
pub mod intents;
pub mod parallel;
pub mod reproduce;
pub mod results;
pub mod study;
pub mod sweep;
