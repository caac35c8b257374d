//! What a study's data say: the declared primary outcome, everything else, and what could spoil both.
//!
//! Every number here is computed over participants' values, one a condition; nobody who is left out is in any of them.
//! The primary outcome of the design stands apart. All others are exploratory: their p values are adjusted within a measure
//! (Holm) and not over measures.

mod course;
mod outcome;
mod quantity;
mod time;

pub use course::{Learning, OrderEffect, Stretch, learning, order_effect};
pub use outcome::Outcome;
pub use quantity::{Quantity, Source};
pub use time::{Calibration, Ribbon, calibrations, ribbons};

use crate::dataset::{Dataset, LeftOut};
use crate::statistics::bootstrap;

/// How an analysis is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// How bootstrap intervals are drawn.
    pub bootstrap: bootstrap::Options,
}

impl Default for Options {
    fn default() -> Self {
        Options { bootstrap: bootstrap::Options { resamples: 5_000, ..bootstrap::Options::default() } }
    }
}

/// Everything a report says of a study.
#[derive(Debug, Clone)]
pub struct Analysis {
    /// The declared primary outcome; or why there is none, such as a measure that does not exist.
    pub primary: Result<Outcome, String>,
    /// All other outcomes, in the order of the measures and then of the questionnaires.
    pub exploratory: Vec<Outcome>,
    /// How the primary measure, or success if that is no measure of flights, changed within the blocks.
    pub learning: Vec<Learning>,
    /// Whether it changed from the first block to the last.
    pub order: OrderEffect,
    /// Where participants went who are not analysed, with how many.
    pub left_out: Vec<(LeftOut, usize)>,
}

/// Flight measures that are tested besides the primary one, by key.
const EXPLORED: [&str; 22] = [
    "success",
    "crash",
    "elsewhere",
    "out_of_bounds",
    "time_limit",
    "steps",
    "steps_of_successes",
    "ticks_with_command",
    "key_presses",
    "commands_per_second",
    "interventions",
    "nominal_interventions",
    "opposed",
    "reversals",
    "repeats",
    "goal_accuracy",
    "goal_right_midway",
    "wrong_interventions",
    "time_to_correct",
    "mean_confidence",
    "brier",
    "calibration_error",
];

impl Analysis {
    /// Analyses a data set.
    pub fn of(dataset: &Dataset, options: Options) -> Self {
        let declared = &dataset.design.primary;
        let primary = Quantity::named(dataset, &declared.measure)
            .map(|quantity| Outcome::of(dataset, quantity, &primary_conditions(dataset), options));
        let compared = primary.as_ref().map_or(0, |outcome| outcome.conditions.len());
        // The primary measure is explored too where it was declared for some of the modes only.
        let others = explored(dataset).into_iter().filter(|quantity| {
            quantity.key != declared.measure || quantity.conditions(dataset).len() > compared
        });
        let exploratory = others
            .map(|quantity| {
                let conditions = quantity.conditions(dataset);
                Outcome::of(dataset, quantity, &conditions, options)
            })
            .collect();
        let followed = followed(dataset);
        Analysis {
            primary,
            exploratory,
            learning: learning(dataset, &followed),
            order: order_effect(dataset, &followed),
            left_out: left_out(dataset),
        }
    }

    /// The outcome of a measure, primary or exploratory.
    pub fn outcome(&self, key: &str) -> Option<&Outcome> {
        self.primary.iter().chain(&self.exploratory).find(|outcome| outcome.quantity.key == key)
    }
}

/// The conditions that the design compares; those it does not name are left out, and none named means all that have the
/// measure.
fn primary_conditions(dataset: &Dataset) -> Vec<usize> {
    let declared = &dataset.design.primary;
    if declared.conditions.is_empty() {
        return Quantity::named(dataset, &declared.measure)
            .map_or_else(|_| Vec::new(), |quantity| quantity.conditions(dataset));
    }
    let index =
        |name: &String| dataset.design.conditions.iter().position(|condition| condition.name == *name);
    declared.conditions.iter().filter_map(index).collect()
}

fn explored(dataset: &Dataset) -> Vec<Quantity> {
    let flights = EXPLORED.iter().filter_map(|key| Quantity::of_flights(key));
    flights.chain(Quantity::scores(dataset)).collect()
}

/// The flight measure whose course is looked at: the primary one if it is of flights, otherwise success.
fn followed(dataset: &Dataset) -> Quantity {
    let declared = Quantity::of_flights(&dataset.design.primary.measure);
    let success = || Quantity::of_flights("success").expect("success is a defined measure");
    declared.filter(|quantity| quantity.key != "calibration_error").unwrap_or_else(success)
}

fn left_out(dataset: &Dataset) -> Vec<(LeftOut, usize)> {
    let mut counts = std::collections::BTreeMap::new();
    for reason in (0..dataset.participants.len()).filter_map(|i| dataset.left_out(i)) {
        *counts.entry(reason).or_insert(0) += 1;
    }
    counts.into_iter().collect()
}
