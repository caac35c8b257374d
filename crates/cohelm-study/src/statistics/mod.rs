//! The tests of a within-subject study, in the order in which a report uses them.
//!
//! [`Table`] (participants × conditions) → [`describe`] the columns → is there any difference
//! ([`repeated_measures`], [`friedman`], and the paper's [`one_way`]) → which pairs differ ([`paired_t`],
//! [`wilcoxon`], [`holm`]) → how much ([`effect_sizes`], [`bootstrap`]) → or are they the same ([`tost`]).
//!
//! Every test returns a typed result or [`Undefined`], whose text is the sentence to print; none returns NaN, none
//! panics. All numbers are the same on every machine: the only transcendental functions used are those of the crate
//! `libm`, sums run in source order, and [`bootstrap`] draws from a generator of its own seeded by the caller.
//! Held against pingouin 0.7.0 and SciPy 1.17.1: [`crate::verify::statistics`].

mod anova;
pub mod bootstrap;
mod describe;
mod distribution;
mod friedman;
mod holm;
mod paired;
mod pairwise;
mod special;
mod sphericity;
mod table;
mod wilcoxon;

pub use anova::{OneWay, RepeatedMeasures, one_way, repeated_measures};
pub use describe::{
    Interval, Summary, describe, interquartile_mean, mean, median, quantile, standard_deviation,
};
pub use friedman::{Friedman, friedman};
pub use holm::holm;
pub use paired::{EffectSizes, PairedT, Tost, effect_sizes, paired_t, tost};
pub use pairwise::{PairOfConditions, pairwise};
pub use sphericity::{Mauchly, Sphericity};
pub use table::{Listwise, Paired, Table, TableError};
pub use wilcoxon::{Wilcoxon, WilcoxonMethod, wilcoxon};

/// Why a number cannot be computed from these data. The text is a whole sentence without its full stop.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(tag = "why", rename_all = "snake_case")]
pub enum Undefined {
    /// Too little of something.
    #[error("{what} needs {} {of}, and there {} {found}", at_least(*needed), if *found == 1 { "is" } else { "are" })]
    TooFew {
        /// The test or number asked for.
        what: &'static str,
        /// Of what there is too little, in the plural.
        of: &'static str,
        /// How many it takes.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// All values are equal, so nothing varies.
    #[error("all values are the same, so there is nothing to compare")]
    NoVariation,
    /// The conditions differ, yet by the same amount in everybody: the test statistic would be infinite.
    #[error(
        "the conditions differ by exactly the same amount in every participant, so no test statistic exists"
    )]
    NoErrorVariation,
    /// Nobody's two values differ.
    #[error("both conditions have the same value in every participant")]
    NoDifference,
    /// The covariance of the conditions has no full rank.
    #[error(
        "the conditions are linearly dependent or the participants too few, so sphericity cannot be tested"
    )]
    SingularCovariance,
    /// A value is NaN or infinite, or beyond [`LARGEST_VALUE`].
    #[error("a value is not a finite number, or is beyond 1e100")]
    NotFinite,
    /// Two columns of different length.
    #[error(
        "the two conditions have {a} and {b} values, and a paired test needs the same participants in both"
    )]
    Unpaired {
        /// Values of the first condition.
        a: usize,
        /// Values of the second condition.
        b: usize,
    },
    /// The table has no such condition.
    #[error("there is no condition {condition:?} in the table")]
    NoSuchCondition {
        /// What was asked for.
        condition: String,
    },
    /// A p value, bound or level outside its range.
    #[error("{name} must be {expected}, and is {found}")]
    OutOfRange {
        /// Which argument.
        name: &'static str,
        /// What it must be.
        expected: &'static str,
        /// What it is, as text.
        found: String,
    },
}

fn at_least(count: usize) -> String {
    if count == 1 { "one or more".to_owned() } else { format!("at least {count}") }
}

/// Largest magnitude of a value: far above any measure, and small enough that no sum of squares overflows.
pub const LARGEST_VALUE: f64 = 1e100;

/// Whether a value can be computed with.
fn is_usable(value: f64) -> bool {
    value.abs() <= LARGEST_VALUE
}

/// The spread that rounding alone may leave among values of this magnitude: a smaller one counts as none, as the 1e-17
/// left by averaging ten equal rates would otherwise give t = 1e15.
fn rounding_of(values: impl IntoIterator<Item = f64>) -> f64 {
    1e-13 * values.into_iter().fold(0.0_f64, |m, v| m.max(v.abs()))
}

fn require(what: &'static str, of: &'static str, needed: usize, found: usize) -> Result<(), Undefined> {
    if found < needed { Err(Undefined::TooFew { what, of, needed, found }) } else { Ok(()) }
}

fn require_finite(values: &[f64]) -> Result<(), Undefined> {
    if values.iter().all(|&v| is_usable(v)) { Ok(()) } else { Err(Undefined::NotFinite) }
}
