//! What time does: learning within the blocks, and from the first block to the last.

use super::{Quantity, Source};
use crate::dataset::{Dataset, Trial};
use crate::statistics::{
    Interval, Paired, PairedT, RepeatedMeasures, Table, Undefined, describe, holm, paired_t,
    repeated_measures,
};

/// How a quantity changed over the flights of a condition.
#[derive(Debug, Clone)]
pub struct Learning {
    /// Index of the condition.
    pub condition: usize,
    /// The quantity's key.
    pub key: String,
    /// Change over ten measured flights, over participants: each one's least-squares slope, tested against zero.
    pub slope: Result<PairedT, Undefined>,
    /// p after Holm's adjustment over the conditions.
    pub p_holm: Option<f64>,
    /// The course: mean over participants of groups of consecutive flights, practice included.
    pub course: Vec<Stretch>,
}

/// Some consecutive flights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Middle of the flights' numbers; practice flights have numbers up to 0, the first measured one has 1.
    pub flight: f64,
    /// Mean over participants.
    pub mean: f64,
    /// Its 95 % interval; `None` for one participant.
    pub interval: Option<Interval>,
}

/// Points a course has at most of practice, and of measured flights.
const MOST_POINTS: usize = 8;

/// How a flight measure changed within the block of each condition.
pub fn learning(dataset: &Dataset, quantity: &Quantity) -> Vec<Learning> {
    let conditions = 0..dataset.design.conditions.len();
    let mut learnt: Vec<Learning> =
        conditions.map(|condition| within_block(dataset, quantity, condition)).collect();
    let p_values: Vec<Option<f64>> = learnt.iter().map(|l| l.slope.as_ref().ok().map(|t| t.p)).collect();
    learnt.iter_mut().zip(holm(&p_values)).for_each(|(learning, adjusted)| learning.p_holm = adjusted);
    learnt
}

fn within_block(dataset: &Dataset, quantity: &Quantity, condition: usize) -> Learning {
    let people = dataset.analysed();
    let slopes: Vec<f64> = people
        .iter()
        .filter_map(|&person| {
            let flights = dataset.flights(person, condition, false);
            slope(&flights.filter_map(|trial| point(trial, quantity)).collect::<Vec<_>>())
        })
        .map(|slope| 10.0 * slope)
        .collect();
    let against_zero = Paired::new(&slopes, &vec![0.0; slopes.len()]);
    Learning {
        condition,
        key: quantity.key.clone(),
        slope: against_zero.and_then(|pairs| paired_t(&pairs)),
        p_holm: None,
        course: course(dataset, quantity, condition),
    }
}

/// A flight's number and value; practice counts up to 0.
fn point(trial: &Trial, quantity: &Quantity) -> Option<(f64, f64)> {
    let value = *trial.measured.as_ref().ok()?.values.get(quantity.key.as_str())?;
    Some((f64::from(trial.number), value))
}

/// Least-squares slope; `None` for fewer than three points or a single number.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / n, sum.1 + point.1 / n));
    let (products, squares) = points.iter().fold((0.0, 0.0), |sum, point| {
        let dx = point.0 - x;
        (sum.0 + dx * (point.1 - y), sum.1 + dx * dx)
    });
    (points.len() >= 3 && squares > 0.0).then(|| products / squares)
}

fn course(dataset: &Dataset, quantity: &Quantity, condition: usize) -> Vec<Stretch> {
    let plan = &dataset.design.conditions[condition];
    let practice = stretches(dataset, quantity, (condition, true, plan.practice_episodes));
    practice
        .into_iter()
        .chain(stretches(dataset, quantity, (condition, false, plan.measured_episodes)))
        .collect()
}

/// Groups of flights of a condition: which condition, whether practice, how many there are.
fn stretches(
    dataset: &Dataset,
    quantity: &Quantity,
    (condition, practice, count): (usize, bool, u32),
) -> Vec<Stretch> {
    let length = count.div_ceil(MOST_POINTS as u32).max(1);
    let shift = if practice { f64::from(count) } else { 0.0 };
    let groups = (0..count.div_ceil(length)).filter_map(|group| {
        let (first, last) = (group * length + 1, ((group + 1) * length).min(count));
        let mean_of = |person: usize| {
            let values: Vec<f64> = dataset
                .flights(person, condition, practice)
                .filter(|trial| (first..=last).contains(&trial.number))
                .filter_map(|trial| Some(point(trial, quantity)?.1))
                .collect();
            crate::statistics::mean(&values).ok()
        };
        let means: Vec<f64> = dataset.analysed().into_iter().filter_map(mean_of).collect();
        let summary = describe(&means).ok()?;
        let flight = f64::from(first + last) / 2.0 - shift;
        Some(Stretch { flight, mean: summary.mean, interval: summary.mean_ci95 })
    });
    groups.collect()
}

/// Whether a quantity changed from the first block to the last, whatever was flown in it.
#[derive(Debug, Clone)]
pub struct OrderEffect {
    /// The quantity's key.
    pub key: String,
    /// Participants × positions.
    pub table: Table,
    /// Repeated-measures ANOVA over the positions.
    pub anova: Result<RepeatedMeasures, Undefined>,
    /// Whether conditions and positions can be told apart: not everyone flew one order.
    pub separable: bool,
}

/// Compares a flight measure between the positions in the order flown.
pub fn order_effect(dataset: &Dataset, quantity: &Quantity) -> OrderEffect {
    let people = dataset.analysed();
    let positions = dataset.design.conditions.len();
    let value = |person: usize, position: usize| {
        let condition = *dataset.participants[person].order.get(position)?;
        debug_assert_eq!(quantity.source, Source::Flights);
        quantity.value(dataset, person, condition)
    };
    let rows = people.iter().map(|&person| (0..positions).map(|position| value(person, position)).collect());
    let codes = people.iter().map(|&person| dataset.participants[person].code.clone()).collect();
    let names: Vec<String> = (1..=positions).map(ordinal).collect();
    let table =
        Table::listwise(codes, names.clone(), rows.collect()).map(|made| made.table).unwrap_or_else(|_| {
            Table::complete(Vec::new(), names, Vec::new()).expect("a table without rows fits any names")
        });
    let mut orders: Vec<&[usize]> =
        people.iter().map(|&p| dataset.participants[p].order.as_slice()).collect();
    orders.sort_unstable();
    orders.dedup();
    OrderEffect {
        key: quantity.key.clone(),
        anova: repeated_measures(&table),
        table,
        separable: orders.len() > 1,
    }
}

fn ordinal(number: usize) -> String {
    let ending = match (number % 10, number % 100) {
        (1, n) if n != 11 => "st",
        (2, n) if n != 12 => "nd",
        (3, n) if n != 13 => "rd",
        _ => "th",
    };
    format!("{number}{ending}")
}

#[cfg(test)]
mod tests {
    use super::*;

    // numpy.polyfit([1, 2, 3, 5], [1, 0, 1, 1], 1)[0] = 0.08571428571…
    #[test]
    fn slope_as_numpy_fits_it() {
        let fitted = slope(&[(1.0, 1.0), (2.0, 0.0), (3.0, 1.0), (5.0, 1.0)]).unwrap();
        assert!((fitted - 0.085_714_285_714_285_71).abs() < 1e-14, "{fitted}");
        assert_eq!(slope(&[(1.0, 1.0), (2.0, 0.0)]), None);
        assert_eq!(slope(&[(1.0, 1.0); 4]), None);
    }

    #[test]
    fn ordinals() {
        assert_eq!(
            [1, 2, 3, 4, 11, 12, 21].map(ordinal),
            ["1st", "2nd", "3rd", "4th", "11th", "12th", "21st"]
        );
    }
}
