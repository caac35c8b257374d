//! How a setting stands: means over people, with intervals that draw people anew within each population.

use super::Setting;
use crate::experiment::Flown;
use cohelm::human::Population;
use cohelm_study::statistics::bootstrap::{Bootstrapped, Options, bootstrap};
use cohelm_study::statistics::{Interval, Undefined};
use serde::Serialize;

/// Measures that are compared, by key; success and what was replaced are what the figure shows.
pub const MEASURES: [&str; 8] =
    ["success", "crash", "elsewhere", "steps", "ticks_with_command", "replaced", "interventions", "opposed"];
/// Index of success among them.
pub(super) const SUCCESS: usize = 0;
/// Index of how much of what was asked was replaced.
pub(super) const REPLACED: usize = 5;

/// Resamples of an interval; deterministic, and enough for two digits.
const OPTIONS: Options = Options { resamples: 2_000, level: 0.95, seed: 0 };

/// One person's means under one setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Unit {
    /// The kind of people.
    pub population: Population,
    /// Number of the participant within it.
    pub participant: usize,
    /// The mean of each of [`MEASURES`] over the person's episodes that have a value; 0 where none has, as a share of no
    /// commands is no intervention.
    pub means: [f64; MEASURES.len()],
}

/// How a setting stands.
#[derive(Clone, Debug, Serialize)]
pub struct Stand {
    /// The setting.
    pub setting: Setting,
    pub(super) units: Vec<Unit>,
}

impl Unit {
    /// The means of one person's episodes.
    pub fn of(population: Population, flown: &[Flown]) -> Self {
        let mean = |key: &str| {
            let values: Vec<f64> = flown.iter().filter_map(|flown| flown.measures.value(key)).collect();
            if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
        };
        let participant = flown.first().map_or(0, |flown| flown.participant);
        Self { population, participant, means: MEASURES.map(mean) }
    }
}

impl Stand {
    /// The mean of a measure over populations and their people, who are as many in each.
    ///
    /// # Panics
    /// If there is no such measure among [`MEASURES`].
    pub fn mean(&self, key: &str) -> f64 {
        let measure = MEASURES.iter().position(|known| *known == key).expect("one of MEASURES");
        self.mean_of(measure, &(0..self.units.len()).collect::<Vec<_>>())
    }

    pub(super) fn mean_of(&self, measure: usize, chosen: &[usize]) -> f64 {
        chosen.iter().map(|&unit| self.units[unit].means[measure]).sum::<f64>() / chosen.len() as f64
    }

    /// The mean of each of [`MEASURES`] with its interval.
    pub(super) fn estimates(&self) -> Result<Vec<Bootstrapped>, Undefined> {
        let strata = self.strata();
        let interval = |measure| bootstrap(&strata, |chosen| Some(self.mean_of(measure, chosen)), OPTIONS);
        (0..MEASURES.len()).map(interval).collect()
    }

    /// Interval of how much more of a measure this has than another, over the same people.
    pub(super) fn more_than(&self, other: &Self, measure: usize) -> Result<Interval, Undefined> {
        let more = |chosen: &[usize]| Some(self.mean_of(measure, chosen) - other.mean_of(measure, chosen));
        Ok(bootstrap(&self.strata(), more, OPTIONS)?.interval)
    }

    /// Interval of any statistic of the people drawn.
    pub(super) fn resampled(
        &self,
        statistic: impl Fn(&[usize]) -> Option<f64>,
    ) -> Result<Bootstrapped, Undefined> {
        bootstrap(&self.strata(), statistic, OPTIONS)
    }

    /// The same among some populations alone.
    pub(super) fn among(&self, populations: &[Population]) -> Self {
        let units = self.units.iter().filter(|unit| populations.contains(&unit.population)).cloned();
        Self { setting: self.setting, units: units.collect() }
    }

    /// How many people there are of each population.
    fn strata(&self) -> Vec<usize> {
        self.units.chunk_by(|a, b| a.population == b.population).map(<[Unit]>::len).collect()
    }
}
