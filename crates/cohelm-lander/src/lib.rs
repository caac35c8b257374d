//! Lunar Lander as a plant: physics, terrain, flags, observation, reward.
//!
//! Knows no co-pilot, no network and no clock; the flag task draws only random numbers from seeds it was given.
#![forbid(unsafe_code)]

pub mod craft;
pub mod flags;
pub mod gymnasium;
mod physics;
pub mod random;
#[cfg(feature = "recording")]
pub mod recording;
