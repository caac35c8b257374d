//! What happens within the flights: authority over time, and how far the confidence can be trusted.

use crate::dataset::{Class, Dataset, Measured, Part, added, calibration_error};
use crate::measures::PARTS;
use crate::statistics::{Summary, describe};

/// A share over the parts of the flight in a condition, over participants.
#[derive(Debug, Clone, PartialEq)]
pub struct Ribbon {
    /// Index of the condition.
    pub condition: usize,
    /// For each part that has a value: its middle (0 to 1 of the flight) and the summary over participants.
    pub points: Vec<(f64, Summary)>,
}

/// How a share, given as count and total of a part, runs over the flight in each condition. A participant's share is
/// that of all ticks of all measured flights in that part.
pub fn ribbons(dataset: &Dataset, share: impl Fn(&Part) -> (u32, u32)) -> Vec<Ribbon> {
    let people = dataset.analysed();
    let of_part = |condition: usize, part: usize| {
        let shares: Vec<f64> = people
            .iter()
            .filter_map(|&person| {
                let counts =
                    measured(dataset, person, condition).filter_map(|m| m.parts.get(part)).map(&share);
                let (count, of) = counts.fold((0, 0), |sum, (count, of)| (sum.0 + count, sum.1 + of));
                (of > 0).then(|| f64::from(count) / f64::from(of))
            })
            .collect();
        describe(&shares).ok().map(|summary| ((part as f64 + 0.5) / PARTS as f64, summary))
    };
    let ribbon =
        |condition| Ribbon { condition, points: (0..PARTS).filter_map(|p| of_part(condition, p)).collect() };
    (0..dataset.design.conditions.len()).map(ribbon).collect()
}

/// The confidence of a condition against how often the inferred goal was right.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Index of the condition.
    pub condition: usize,
    /// All ticks of all participants, in classes of the confidence.
    pub classes: Vec<Class>,
    /// Expected calibration error over all of them; `None` without a tick.
    pub error: Option<f64>,
}

/// Calibration of each condition in which a goal was inferred, over the ticks of everyone who is analysed.
pub fn calibrations(dataset: &Dataset) -> Vec<Calibration> {
    use cohelm::intent::Inference;
    let people = dataset.analysed();
    let inferred = |c: &usize| dataset.design.conditions[*c].inference != Inference::Known;
    let of = |condition: usize| {
        let flights = people.iter().flat_map(|&person| measured(dataset, person, condition));
        let classes = added(flights.map(|measured| measured.classes.as_slice()));
        let error = calibration_error(std::iter::once(classes.as_slice()));
        Calibration { condition, classes, error }
    };
    (0..dataset.design.conditions.len()).filter(inferred).map(of).collect()
}

fn measured(dataset: &Dataset, person: usize, condition: usize) -> impl Iterator<Item = &Measured> {
    dataset.flights(person, condition, false).filter_map(|trial| trial.measured.as_ref().ok())
}
