//! Lunar Lander as a plant: physics, terrain, flags, observation, reward.
//!
//! Knows no co-pilot, no network and no clock; the flag task draws only random numbers from seeds it was given.
#![forbid(unsafe_code)]

pub mod bench;
pub mod craft;
pub mod flags;
pub mod gymnasium;
pub mod gymnasium_plant;
mod physics;
pub mod pilots;
pub mod random;
#[cfg(feature = "recording")]
pub mod recording;
#[cfg(feature = "lanes")]
pub mod together;

use cohelm::registry::Plants;

/// Makes the lander's plants known: `flag-lander` and `gymnasium-lander`.
pub fn register(plants: &mut Plants) {
    plants.register(flags::entry());
    plants.register(gymnasium_plant::entry());
}
