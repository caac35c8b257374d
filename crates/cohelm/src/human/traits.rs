//! What tells one participant from another: the numbers behind a pilot, and the ranges they are drawn from.

use crate::random::Draws;
use serde::{Deserialize, Serialize};

/// The parameters of one simulated person. Ticks are the plant's (1/50 s for the lander).
///
/// The ranges in which ordinary participants lie are those of [`Ranges::ORDINARY`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Traits {
    /// Ticks between what happens and what is done about it. Low: superhuman; high: every correction comes too late
    /// and swings the plant.
    pub delay_ticks: u32,
    /// Mean number of ticks that attention stays on one axis. Low: both axes are tended, with short taps; high: one is
    /// forgotten while the other is tended.
    pub dwell_ticks: f64,
    /// Ticks for which a pressed key stays down at least. Low: fine taps; high: every press is a kick.
    pub hold_ticks: u32,
    /// Probability that a press hits another key.
    pub wrong_key: f64,
    /// A speed judged by eye is seen as this many times the true one. Below 1 everything seems slower than it is.
    pub speed_gain: f64,
    /// Relative error of a judged speed (standard deviation), wandering slowly: see [`NOISE_MEMORY`].
    pub speed_noise: f64,
    /// Factor on the average person's dead bands. Low: presses at everything; high: lets things drift.
    pub dead_band: f64,
    /// Probability that a droppable key is let go when attention leaves its axis.
    pub drop_key: f64,
    /// Share of the delay over which what was seen is carried forward in a straight line, places and speeds alike. 0:
    /// flies by what was; 1: by what would be now if it had gone on as it went.
    pub prediction: f64,
    /// Probability that attention goes to the worst axis when it moves; otherwise to the next in turn.
    pub urgency: f64,
    /// How hard help that gets in the way is fought: shrinks the dead bands and makes the pilot hit its key again.
    pub resist: f64,
    /// How far a flight that goes well is left alone: widens the dead bands.
    pub trust: f64,
    /// Ticks for which a key is held at most until it was *seen* working; 0 for a pilot that does not insist.
    pub insist_ticks: u32,
}

/// How much of the error in judging a speed is still there a tick later: a first-order autoregression, so that an error
/// lasts for about 1/(1 − 0.97) = 33 ticks. Nearer 0 it averages out within a reaction delay and costs nothing.
pub const NOISE_MEMORY: f64 = 0.97;

/// Attention stays at least this many ticks.
pub const SHORTEST_DWELL_TICKS: f64 = 8.0;

/// Why these are not the traits of a pilot.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a pilot's {name} is {value}; expected {expected}")]
pub struct TraitError {
    /// Which one.
    pub name: &'static str,
    /// What it is.
    pub value: f64,
    /// What it may be.
    pub expected: &'static str,
}

/// The longest delay, hold or insistence that is believed, in ticks: more is a mistake in the units.
const LONGEST_TICKS: u32 = 1000;

impl Traits {
    /// Says what is wrong, if anything is.
    pub fn check(&self) -> Result<(), TraitError> {
        let ticks = [
            ("delay_ticks", self.delay_ticks),
            ("hold_ticks", self.hold_ticks),
            ("insist_ticks", self.insist_ticks),
        ];
        let shares = [
            ("wrong_key", self.wrong_key),
            ("drop_key", self.drop_key),
            ("prediction", self.prediction),
            ("urgency", self.urgency),
        ];
        let factors = [
            ("dwell_ticks", self.dwell_ticks),
            ("speed_gain", self.speed_gain),
            ("speed_noise", self.speed_noise),
            ("dead_band", self.dead_band),
            ("resist", self.resist),
            ("trust", self.trust),
        ];
        let in_ticks = |&(name, value): &(_, u32)| {
            let wrong = value > LONGEST_TICKS;
            wrong.then_some(TraitError { name, value: value.into(), expected: "at most 1000 ticks" })
        };
        let in_share = |&(name, value): &(_, f64)| {
            let wrong = !(0.0..=1.0).contains(&value);
            wrong.then_some(TraitError { name, value, expected: "a number from 0 to 1" })
        };
        let in_factor = |&(name, value): &(_, f64)| {
            let wrong = !(0.0..=1000.0).contains(&value);
            wrong.then_some(TraitError { name, value, expected: "a number from 0 to 1000" })
        };
        let wrong = ticks.iter().find_map(in_ticks);
        let wrong = wrong.or_else(|| shares.iter().find_map(in_share));
        wrong.or_else(|| factors.iter().find_map(in_factor)).map_or(Ok(()), Err)
    }
}

/// From where to where each trait of a population goes, both ends included; uniform between.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs, reason = "each field is the range of the trait of the same name")]
pub struct Ranges {
    pub delay_ticks: [u32; 2],
    pub dwell_ticks: [f64; 2],
    pub hold_ticks: [u32; 2],
    pub wrong_key: [f64; 2],
    pub speed_gain: [f64; 2],
    pub speed_noise: [f64; 2],
    pub dead_band: [f64; 2],
    pub drop_key: [f64; 2],
    pub prediction: [f64; 2],
    pub urgency: [f64; 2],
    pub resist: [f64; 2],
    pub trust: [f64; 2],
    pub insist_ticks: [u32; 2],
}

impl Ranges {
    /// Ordinary participants at 50 ticks a second: reaction times of 160 to 300 ms, attention of 0.3 to 1 s.
    pub const ORDINARY: Self = Self {
        delay_ticks: [8, 15],
        dwell_ticks: [15.0, 50.0],
        hold_ticks: [3, 6],
        wrong_key: [0.01, 0.06],
        speed_gain: [0.4, 1.0],
        speed_noise: [0.2, 0.2],
        dead_band: [0.8, 1.5],
        drop_key: [0.2, 0.7],
        prediction: [0.2, 0.8],
        urgency: [0.3, 0.9],
        resist: [0.3, 1.0],
        trust: [0.3, 1.0],
        insist_ticks: [0, 0],
    };

    /// Draws one participant: one draw a trait, in a fixed order and whatever the ranges are, so that the same stream
    /// makes the same person in every population but for the traits that the population changes.
    pub fn draw(&self, draws: &mut Draws) -> Traits {
        let mut ticks = |[low, high]: [u32; 2]| low + draws.below((high - low) as usize + 1) as u32;
        let (delay_ticks, hold_ticks, insist_ticks) =
            (ticks(self.delay_ticks), ticks(self.hold_ticks), ticks(self.insist_ticks));
        let mut between = |[low, high]: [f64; 2]| draws.uniform(low, high);
        Traits {
            delay_ticks,
            dwell_ticks: between(self.dwell_ticks),
            hold_ticks,
            wrong_key: between(self.wrong_key),
            speed_gain: between(self.speed_gain),
            speed_noise: between(self.speed_noise),
            dead_band: between(self.dead_band),
            drop_key: between(self.drop_key),
            prediction: between(self.prediction),
            urgency: between(self.urgency),
            resist: between(self.resist),
            trust: between(self.trust),
            insist_ticks,
        }
    }
}
