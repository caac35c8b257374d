//! Flying recorded episodes again and comparing every bit.

use std::fmt;
use std::io::Read;

use super::{Flight, Flights, RecordingError};
use crate::gymnasium::{GymnasiumLander, TIME_LIMIT};

/// What came of flying a file again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Episodes in the file.
    pub flights: usize,
    /// Steps of all episodes.
    pub steps: usize,
    /// Episodes of which every bit agrees.
    pub identical: usize,
    /// The first disagreement of the first episode that has one.
    pub first_difference: Option<Difference>,
}

/// Where a flight leaves its recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Number of the episode in the file, from 1: its line.
    pub flight: usize,
    /// Its seed.
    pub seed: u64,
    /// 0 for what `reset` returned, then the number of the step.
    pub step: usize,
    /// Which number.
    pub place: Place,
    /// What the file has; 0 and 1 for false and true.
    pub recorded: f64,
    /// What was computed.
    pub computed: f64,
}

/// Which number of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Height of the ground, counted from 0.
    Terrain(usize),
    /// Entry of the observation, counted from 0.
    Observation(usize),
    /// The reward.
    Reward,
    /// Whether the step ended the episode.
    Terminated,
    /// Whether the time limit cut it off.
    Truncated,
    /// The environment options of the line are refused.
    Options,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Place::Terrain(index) => write!(f, "terrain[{index}]"),
            Place::Observation(index) => write!(f, "observation[{index}]"),
            Place::Reward => write!(f, "reward"),
            Place::Terminated => write!(f, "terminated"),
            Place::Truncated => write!(f, "truncated"),
            Place::Options => write!(f, "options"),
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Difference { flight, seed, step, place, recorded, computed } = self;
        write!(
            f,
            "flight {flight} (seed {seed}), step {step}, {place}: recorded {recorded:?}, computed {computed:?}"
        )
    }
}

/// Flies every episode of a file again.
pub fn verify(reader: impl Read) -> Result<Report, RecordingError> {
    let mut report = Report::default();
    for flight in Flights::new(reader)? {
        report.add(&flight?);
    }
    Ok(report)
}

impl Report {
    /// Flies one more episode again.
    pub fn add(&mut self, flight: &Flight) {
        self.flights += 1;
        self.steps += flight.actions.len();
        match difference(flight) {
            None => self.identical += 1,
            Some((step, place, recorded, computed)) => {
                let difference =
                    Difference { flight: self.flights, seed: flight.seed, step, place, recorded, computed };
                self.first_difference.get_or_insert(difference);
            }
        }
    }

    /// Whether all episodes, and at least one, agree in every bit.
    pub fn all_identical(&self) -> bool {
        self.flights > 0 && self.identical == self.flights
    }
}

type Found = (usize, Place, f64, f64);

/// The first disagreement of a flight, in the order in which Gymnasium computes.
fn difference(flight: &Flight) -> Option<Found> {
    let Ok(mut lander) = GymnasiumLander::new(flight.options) else {
        return Some((0, Place::Options, 1.0, 0.0));
    };
    let first = lander.reset(flight.seed);
    let at = |step: usize| move |(place, recorded, computed)| (step, place, recorded, computed);
    if let Some(found) = first_of(Place::Terrain, &flight.terrain, lander.heights())
        .or_else(|| first_of(Place::Observation, &flight.observations[0], &first.map(f64::from)))
    {
        return Some(at(0)(found));
    }
    let last = flight.actions.len();
    for (step, action) in (1..).zip(&flight.actions) {
        let outcome = lander.step(*action);
        let truth = |value: bool| f64::from(u8::from(value));
        let ends = (step == last && flight.terminated, step == last && flight.truncated);
        let terminal = outcome.ending.is_some_and(|ending| ending.is_terminal());
        let found =
            first_of(Place::Observation, &flight.observations[step], &outcome.observation.map(f64::from))
                .or_else(|| first_of(|_| Place::Reward, &[flight.rewards[step - 1]], &[outcome.reward]))
                .or_else(|| first_of(|_| Place::Terminated, &[truth(ends.0)], &[truth(terminal)]))
                .or_else(|| {
                    let cut_off = lander.ticks() >= TIME_LIMIT;
                    first_of(|_| Place::Truncated, &[truth(ends.1)], &[truth(cut_off)])
                });
        if let Some(found) = found {
            return Some(at(step)(found));
        }
    }
    None
}

/// The first pair with different bits.
fn first_of(place: impl Fn(usize) -> Place, recorded: &[f64], computed: &[f64]) -> Option<(Place, f64, f64)> {
    let mut pairs = recorded.iter().zip(computed).enumerate();
    let (index, (recorded, computed)) = pairs.find(|(_, (a, b))| a.to_bits() != b.to_bits())?;
    Some((place(index), *recorded, *computed))
}
