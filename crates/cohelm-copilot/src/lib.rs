//! Trained co-pilots: networks that infer intent and estimate values, their cards, and cockpits made of them.
//!
//! | module | what it explains |
//! |---|---|
//! | [`card`] | what a model says of itself: plant, versions, seed, scores |
//! | [`model`] | a model file: its bytes, its hash, its card, its networks |
//! | [`models`] | a set of models, found by hash |
//! | [`outputs`] | which network output stands for which command |
//! | [`axes`] | how a critic sees an action on axes |
//! | [`search`] | the candidates of a decision on axes |
//! | [`encode`] | what the networks see; every encoding has a version that belongs to the model |
//! | [`values`] | a network as a [`ValueModel`](cohelm::value::ValueModel) |
//! | [`intent`] | networks as an [`IntentModel`](cohelm::intent::IntentModel) |
//! | [`mod@cockpit`] | the cockpit that a setup describes |
//! | `shipped` | the models that come with the program (feature `shipped`) |
//!
//! This crate trains nothing, names no plant, touches no file and runs in the page as well. Inside a tick it allocates
//! nothing and nothing fails.
#![forbid(unsafe_code)]

pub mod axes;
pub mod card;
pub mod cockpit;
pub mod encode;
pub mod intent;
pub mod model;
pub mod models;
pub mod outputs;
pub mod search;
#[cfg(feature = "shipped")]
pub mod shipped;
pub mod values;

pub use card::{Card, Kind, TrainedWith};
pub use cockpit::{CockpitError, cockpit};
pub use model::{Model, ModelError, Network, ValueNetwork};
pub use models::Models;
