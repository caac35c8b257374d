//! One quantity, compared between conditions within the participants, by every test that a report prints.

use super::{Options, Quantity};
use crate::dataset::Dataset;
use crate::statistics::bootstrap::{Bootstrapped, stratified_interquartile_mean};
use crate::statistics::{
    Friedman, OneWay, PairOfConditions, RepeatedMeasures, Table, Undefined, friedman, one_way, pairwise,
    repeated_measures,
};
use std::collections::BTreeMap;

/// A quantity with its table and tests. A test that the data do not allow says so in a sentence.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What is compared.
    pub quantity: Quantity,
    /// Indices of the compared conditions.
    pub conditions: Vec<usize>,
    /// One value a participant and condition; participants with a gap are left out.
    pub table: Table,
    /// Codes of participants with a gap.
    pub left_out: Vec<String>,
    /// Everyone who is analysed, gaps and all: `values[condition][participant]`, for figures.
    pub values: Vec<Vec<Option<f64>>>,
    /// Codes of these.
    pub participants: Vec<String>,
    /// Repeated-measures ANOVA, Greenhouse–Geisser from three conditions on.
    pub anova: Result<RepeatedMeasures, Undefined>,
    /// Friedman's test.
    pub friedman: Result<Friedman, Undefined>,
    /// The paper's one-way ANOVA, which takes the conditions for different people.
    pub one_way: Result<OneWay, Undefined>,
    /// Every pair of conditions, Holm-adjusted.
    pub pairs: Vec<PairOfConditions>,
    /// Interquartile mean of each condition, resampled within the orders of conditions.
    pub interquartile_means: Vec<Result<Bootstrapped, Undefined>>,
    /// Largest difference that counts as none, if the design gives one.
    pub bound: Option<f64>,
}

impl Outcome {
    /// Compares a quantity between conditions.
    pub fn of(dataset: &Dataset, quantity: Quantity, conditions: &[usize], options: Options) -> Self {
        let people = dataset.analysed();
        let value = |condition: usize, person: usize| {
            quantity.value(dataset, person, condition).filter(|value| value.is_finite())
        };
        let values: Vec<Vec<Option<f64>>> =
            conditions.iter().map(|&c| people.iter().map(|&person| value(c, person)).collect()).collect();
        let codes: Vec<String> =
            people.iter().map(|&person| dataset.participants[person].code.clone()).collect();
        let (table, left_out) = listwise(dataset, conditions, &codes, &values);
        let bound = dataset.design.equivalence.get(&quantity.key).copied();
        let strata = strata(dataset, &people, &values);
        let iqm = |groups: &Vec<Vec<f64>>| stratified_interquartile_mean(groups, options.bootstrap);
        Outcome {
            conditions: conditions.to_vec(),
            anova: repeated_measures(&table),
            friedman: friedman(&table),
            one_way: one_way(&table),
            pairs: pairwise(&table, bound, options.bootstrap),
            interquartile_means: strata.iter().map(iqm).collect(),
            participants: codes,
            quantity,
            table,
            left_out,
            values,
            bound,
        }
    }

    /// Names of the compared conditions.
    pub fn names(&self) -> &[String] {
        self.table.conditions()
    }
}

/// Codes and names are unique and values finite by then, so that no table is refused; should one be, it is an empty one.
fn listwise(
    dataset: &Dataset,
    conditions: &[usize],
    codes: &[String],
    values: &[Vec<Option<f64>>],
) -> (Table, Vec<String>) {
    let names: Vec<String> = conditions.iter().map(|&c| dataset.design.conditions[c].name.clone()).collect();
    let row = |person: usize| values.iter().map(|column| column[person]).collect();
    let rows = (0..codes.len()).map(row).collect();
    match Table::listwise(codes.to_vec(), names.clone(), rows) {
        Ok(made) => (made.table, made.left_out),
        Err(_) => {
            let empty = Table::complete(Vec::new(), names, Vec::new());
            (empty.expect("a table without rows fits any names"), codes.to_vec())
        }
    }
}

/// The values of each condition, in groups of participants with the same order of conditions.
fn strata(dataset: &Dataset, people: &[usize], values: &[Vec<Option<f64>>]) -> Vec<Vec<Vec<f64>>> {
    let grouped = |column: &Vec<Option<f64>>| {
        let mut groups: BTreeMap<Vec<usize>, Vec<f64>> = BTreeMap::new();
        for (&person, value) in people.iter().zip(column) {
            if let Some(value) = value {
                groups.entry(dataset.participants[person].order.clone()).or_default().push(*value);
            }
        }
        groups.into_values().collect()
    };
    values.iter().map(grouped).collect()
}
