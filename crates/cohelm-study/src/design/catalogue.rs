//! What a design needs to know of plants and models, which this crate does not.

use super::{Condition, Design};
use cohelm::registry::Task;

/// Who knows plants and models: asked whether a design can be flown.
pub trait Catalogue {
    /// Whether there is such a plant with such options, and what estimates need to know of it.
    fn check_task(&self, task: &Task) -> Result<PlantFacts, String>;

    /// Whether a condition can be flown on the design's task: its rule, its models.
    fn check_condition(&self, design: &Design, condition: &Condition) -> Result<(), String>;
}

/// What estimates of time, and advice, need to know of a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantFacts {
    /// Ticks a second at time scale 1.
    pub ticks_per_second: f64,
    /// Ticks after which a flight ends in any case, if it does.
    pub limit_ticks: Option<u32>,
    /// Whether its actions are on axes.
    pub axes: bool,
}

/// The plant and models of a design as found: what a flight's setup names besides the design.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Resolved {
    /// Version of the plant.
    pub plant_version: u32,
    /// The models of each condition, in the order of [`Design::conditions`].
    pub models: Vec<ResolvedModels>,
}

/// The models of one condition.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ResolvedModels {
    /// SHA-256 of the value model's file, in hexadecimal, if a network gives the values. For a condition that learns:
    /// the model of the moment.
    pub values: Option<String>,
    /// SHA-256 of the intent model's file, in hexadecimal, if a network infers the goal.
    pub intent: Option<String>,
}
