//! A study's data in two shapes: as they were stored, and as they are analysed.
//!
//! [`StudyRecords`] is what a store holds of a study: the design, each participant's log of events, each flight's record
//! and the models it names. Everything else follows from it. `cohelm-lab` flies every record again and makes the
//! [`Dataset`]: who took part, what was measured of each flight, what was answered. Tables, tests, reports and exports read
//! the data set only.

mod assemble;

pub use assemble::Flown;

use crate::design::Design;
use crate::session::Logged;
use cohelm::plant::Ending;
use serde_json::Value;
use std::collections::BTreeMap;

/// What a store holds of a study. Its order is the store's: participants and flights by number.
#[derive(Clone, Debug)]
pub struct StudyRecords {
    /// The design as the participants flew it.
    pub design: Design,
    /// Everyone who was ever invited, but for those who withdrew and whose data were deleted.
    pub participants: Vec<ParticipantRecord>,
    /// Every flight that was begun.
    pub trials: Vec<TrialRecord>,
    /// Every model that a flight names: SHA-256 in hexadecimal, file.
    pub models: Vec<(String, Vec<u8>)>,
    /// The program that wrote this, as `cohelm 0.1.0`.
    pub program: String,
}

/// A participant as stored.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticipantRecord {
    /// Number in the store; never shown.
    pub id: i64,
    /// What the participant is called in every table.
    pub code: String,
    /// What happened, in order; empty for a participant who withdrew, of whom nothing else is left.
    pub events: Vec<Logged>,
}

/// A flight as stored.
#[derive(Clone, Debug, PartialEq)]
pub struct TrialRecord {
    /// Number of the participant in the store.
    pub participant: i64,
    /// The step it belongs to, as `block-1/flight-3`.
    pub step: String,
    /// Number of the episode in the store.
    pub episode: i64,
    /// The record (`.cohelm`), unpacked; `None` if the flight was never finished.
    pub record: Option<Vec<u8>>,
    /// The program that followed it.
    pub program: String,
}

/// A study's data as they are analysed.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// The design.
    pub design: Design,
    /// Everyone, in the order of the store.
    pub participants: Vec<Person>,
    /// Every flight, in the order of participants and then of flying.
    pub trials: Vec<Trial>,
    /// Every answer, in the order of participants and then of asking.
    pub answers: Vec<Answer>,
    /// Every score of a questionnaire, in the same order.
    pub scores: Vec<Score>,
    /// The program that wrote the records.
    pub program: String,
}

/// How far a participant came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Invited, and never consented.
    Invited,
    /// Declined to take part.
    Declined,
    /// Consented, and not through.
    UnderWay,
    /// Through to the end.
    Completed,
    /// Withdrew; no data are left.
    Withdrawn,
}

impl Progress {
    /// The word for it in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Invited => "invited",
            Self::Declined => "declined",
            Self::UnderWay => "under-way",
            Self::Completed => "completed",
            Self::Withdrawn => "withdrawn",
        }
    }

    /// All words, in the order of a participant's way.
    pub const WORDS: [&str; 5] = ["invited", "declined", "under-way", "completed", "withdrawn"];
}

/// A participant.
#[derive(Clone, Debug, PartialEq)]
pub struct Person {
    /// What the participant is called in every table.
    pub code: String,
    /// How far it went.
    pub progress: Progress,
    /// A trial run by the researchers, never analysed.
    pub test: bool,
    /// A simulated participant: never analysed together with people, never presented as one.
    pub simulated: bool,
    /// Why the data are left out of the analyses, if they are.
    pub excluded: Option<String>,
    /// Language the participant read.
    pub language: Option<String>,
    /// Which order of conditions, as an index into the design's cells.
    pub cell: Option<usize>,
    /// Indices of the conditions in the order flown.
    pub order: Vec<usize>,
    /// From consent to the last event, in minutes, breaks and absences included.
    pub minutes: Option<f64>,
    /// Times a flight was interrupted in the air.
    pub interruptions: u32,
}

/// Why a participant is not analysed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LeftOut {
    /// A trial run by the researchers.
    Test,
    /// Simulated, in a study that people took part in.
    Simulated,
    /// Never consented.
    NeverBegan,
    /// Declined.
    Declined,
    /// Withdrew.
    Withdrawn,
    /// Excluded by a researcher or a rule of the design.
    Excluded,
    /// Not through.
    Unfinished,
}

impl LeftOut {
    /// The word for it in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Test => "test",
            Self::Simulated => "simulated",
            Self::NeverBegan => "never-began",
            Self::Declined => "declined",
            Self::Withdrawn => "withdrawn",
            Self::Excluded => "excluded",
            Self::Unfinished => "unfinished",
        }
    }
}

/// A flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Index of the participant.
    pub participant: usize,
    /// Which block, from 1: the position of its condition in the order flown.
    pub block: usize,
    /// Index of the condition.
    pub condition: usize,
    /// Whether it was practice.
    pub practice: bool,
    /// Number among the practice or measured flights of the block, from 1.
    pub number: u32,
    /// Which attempt at the step, from 1.
    pub attempt: u32,
    /// Number of the episode in the store.
    pub episode: i64,
    /// Seed of terrain, goal and start; `None` if the flight was never finished.
    pub seed: Option<u64>,
    /// Whether it is the attempt that counts: the last one, and finished.
    pub counts: bool,
    /// Times it was interrupted in the air.
    pub interruptions: u32,
    /// What the page told of its own running, by name; only numbers.
    pub telemetry: BTreeMap<String, f64>,
    /// What was measured, or why nothing could be.
    pub measured: Result<Measured, String>,
}

/// What was measured of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// How it ended.
    pub ending: Ending,
    /// By the key of [`crate::measures`]; a measure without a value is not there, truths are 0 or 1.
    pub values: BTreeMap<&'static str, f64>,
    /// Authority over time: the flight in [`crate::measures::PARTS`] equal parts.
    pub parts: Vec<Part>,
    /// Calibration: the ticks in [`crate::measures::CLASSES`] equal classes of the confidence.
    pub classes: Vec<Class>,
}

/// The ticks of one part of a flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    /// Ticks.
    pub ticks: u32,
    /// Of these, with a command of the pilot.
    pub commands: u32,
    /// Of these, with a command that took effect as asked.
    pub as_asked: u32,
    /// Ticks at which the inferred goal was the pilot's own.
    pub goal_right: u32,
    /// Sum of c over the ticks.
    pub confidence: f64,
}

/// The ticks of one class of the confidence.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Class {
    /// Ticks.
    pub ticks: u32,
    /// Of these, with the inferred goal the pilot's own.
    pub goal_right: u32,
    /// Sum of c over the ticks.
    pub confidence: f64,
}

/// An answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Index of the participant.
    pub participant: usize,
    /// The step, as `block-1/questionnaire/nasa-tlx`.
    pub step: String,
    /// Index of the condition it was asked about, if about one.
    pub condition: Option<usize>,
    /// The item.
    pub item: String,
    /// The answer as it was given; null if the item was left out.
    pub value: Value,
}

/// A score of a questionnaire.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Index of the participant.
    pub participant: usize,
    /// Index of the condition it was asked about, if about one.
    pub condition: Option<usize>,
    /// The questionnaire.
    pub instrument: String,
    /// The score's name within it.
    pub scale: String,
    /// The score; `None` if too little was answered.
    pub score: Option<f64>,
}

impl Dataset {
    /// Whether everyone who took part is simulated: nothing here was done by a person.
    pub fn simulated(&self) -> bool {
        !self.has_people() && self.participants.iter().any(|person| person.simulated)
    }

    fn has_people(&self) -> bool {
        // Of who withdrew not even this is left; and nobody has taken part by being invited or declining.
        let took_part = |person: &Person| matches!(person.progress, Progress::UnderWay | Progress::Completed);
        self.participants.iter().any(|person| !person.simulated && !person.test && took_part(person))
    }

    /// Why a participant is not analysed; `None` if it is.
    ///
    /// Simulated participants are analysed only where no person took part.
    pub fn left_out(&self, participant: usize) -> Option<LeftOut> {
        let person = &self.participants[participant];
        match person {
            Person { simulated: true, .. } if self.has_people() => Some(LeftOut::Simulated),
            Person { test: true, simulated: false, .. } => Some(LeftOut::Test),
            Person { progress: Progress::Withdrawn, .. } => Some(LeftOut::Withdrawn),
            Person { progress: Progress::Invited, .. } => Some(LeftOut::NeverBegan),
            Person { progress: Progress::Declined, .. } => Some(LeftOut::Declined),
            Person { excluded: Some(_), .. } => Some(LeftOut::Excluded),
            Person { progress: Progress::UnderWay, .. } => Some(LeftOut::Unfinished),
            Person { progress: Progress::Completed, .. } => None,
        }
    }

    /// Indices of the participants that are analysed.
    pub fn analysed(&self) -> Vec<usize> {
        (0..self.participants.len()).filter(|&i| self.left_out(i).is_none()).collect()
    }

    /// The flights of a participant in a condition that count, practice or measured, in order.
    pub fn flights(
        &self,
        participant: usize,
        condition: usize,
        practice: bool,
    ) -> impl Iterator<Item = &Trial> {
        self.trials.iter().filter(move |trial| {
            trial.counts
                && trial.practice == practice
                && (trial.participant, trial.condition) == (participant, condition)
        })
    }

    /// A participant's value of a measure in a condition: the mean over the measured flights that have one; the
    /// calibration error over all their ticks.
    pub fn value(&self, key: &str, participant: usize, condition: usize) -> Option<f64> {
        let measured =
            self.flights(participant, condition, false).filter_map(|trial| trial.measured.as_ref().ok());
        if key == "calibration_error" {
            return calibration_error(measured.map(|measured| measured.classes.as_slice()));
        }
        let (sum, count) = measured
            .filter_map(|measured| measured.values.get(key))
            .fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }

    /// A participant's score in a condition, or asked at the end.
    pub fn score(
        &self,
        participant: usize,
        condition: Option<usize>,
        instrument: &str,
        scale: &str,
    ) -> Option<f64> {
        let wanted = |score: &&Score| {
            (score.participant, score.condition) == (participant, condition)
                && (score.instrument.as_str(), score.scale.as_str()) == (instrument, scale)
        };
        self.scores.iter().find(wanted)?.score
    }
}

/// Expected calibration error of classes added up over flights; `None` without a tick.
pub fn calibration_error<'a>(flights: impl Iterator<Item = &'a [Class]>) -> Option<f64> {
    let classes = added(flights);
    let ticks: u32 = classes.iter().map(|class| class.ticks).sum();
    let off = |class: &Class| (class.confidence - f64::from(class.goal_right)).abs();
    (ticks > 0).then(|| classes.iter().map(off).sum::<f64>() / f64::from(ticks))
}

/// Classes added up over flights.
pub fn added<'a>(flights: impl Iterator<Item = &'a [Class]>) -> Vec<Class> {
    let mut sums = vec![Class::default(); crate::measures::CLASSES];
    for classes in flights {
        for (sum, class) in sums.iter_mut().zip(classes) {
            sum.ticks += class.ticks;
            sum.goal_right += class.goal_right;
            sum.confidence += class.confidence;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calibration_error_by_hand() {
        let mut classes = vec![Class::default(); crate::measures::CLASSES];
        classes[9] = Class { ticks: 8, goal_right: 6, confidence: 7.6 };
        classes[2] = Class { ticks: 2, goal_right: 1, confidence: 0.5 };
        // |0.95 − 0.75| · 0.8 + |0.25 − 0.5| · 0.2
        let error = calibration_error([classes.as_slice()].into_iter()).unwrap();
        assert!((error - 0.21).abs() < 1e-12, "{error}");
        let twice = calibration_error([classes.as_slice(), classes.as_slice()].into_iter()).unwrap();
        assert!((twice - 0.21).abs() < 1e-12);
        assert_eq!(calibration_error(std::iter::empty()), None);
    }
}
