//! What can happen to a participant: the events of an append-only log. Nothing in it is ever changed.

use cohelm::plant::Ending;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// An event with its place in the participant's log.
///
/// ```
/// use cohelm_study::session::Logged;
/// let logged: Logged = serde_json::from_str(
///     r#"{"seq": 4, "at_ms": 1767225600000, "event": "step-done", "step": "consent", "data": {"agreed": true}}"#)?;
/// assert_eq!(logged.seq, 4);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Logged {
    /// From 1, without gaps.
    pub seq: u32,
    /// By the server's clock, in ms since 1970; a clock that is set back makes it go back too.
    pub at_ms: i64,
    /// What happened.
    #[serde(flatten)]
    pub event: Event,
}

/// What can happen to a participant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Event {
    /// The first of every log: a link was made, or someone came by the open one.
    Invited {
        /// Someone of the team tries the study; never analysed.
        test: bool,
        /// A program walks through; never presented as a person.
        simulated: bool,
        /// The language to begin with, if it was chosen for them.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        language: Option<String>,
        /// What the panel's address said.
        #[serde(default)]
        panel: BTreeMap<String, String>,
        /// The experimenter's note.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        note: Option<String>,
    },
    /// At consent: the order of conditions, and the seed of everything random about the session.
    Assigned {
        /// Index into [`crate::design::schedule::cells`].
        cell: usize,
        /// The conditions in the order flown.
        order: Vec<usize>,
        /// At most 2⁵³.
        seed: u64,
        /// SHA-256 of the study's file that this participant goes through.
        design: String,
    },
    /// A page was opened; its tab is the live one from now on.
    Opened {
        /// Chosen by the tab.
        tab: String,
        /// Class of browser, screen, refresh rate; no address.
        #[serde(default)]
        client: Value,
    },
    /// Another tab became the live one.
    TakenOver {
        /// The new one.
        tab: String,
    },
    /// The participant chose a language.
    LanguageChosen {
        /// Its code.
        language: String,
    },
    /// A step was done: consent, form, quiz, questionnaire, break, …
    StepDone {
        /// Its id.
        step: String,
        /// What was answered.
        #[serde(default)]
        data: Value,
        /// Milliseconds that the page showed it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        page_ms: Option<f64>,
    },
    /// An attempt at the quiz failed.
    QuizMissed {
        /// The questions that were answered wrongly.
        wrong: Vec<String>,
    },
    /// The participant did not consent. Nothing else is stored of them.
    Declined,
    /// A flight is in the air.
    FlightBegun {
        /// The flight's step.
        step: String,
        /// From 1.
        attempt: u32,
        /// The episode's number in the store.
        episode: i64,
        /// The page's clock minus the server's.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        clock_offset_ms: Option<f64>,
    },
    /// The page went away or lost its flight in the air.
    FlightInterrupted {
        /// The flight's step.
        step: String,
        /// From 1.
        attempt: u32,
        /// Ticks flown before.
        tick: u32,
        /// What happened, in a word or two.
        reason: String,
    },
    /// It goes on.
    FlightResumed {
        /// The flight's step.
        step: String,
        /// From 1.
        attempt: u32,
        /// The tick from which it goes on.
        tick: u32,
        /// Whose log it goes on from: `page` or `server`.
        source: String,
        /// How long it stood still.
        away_ms: i64,
    },
    /// It is over, and its record is stored.
    FlightEnded {
        /// The flight's step.
        step: String,
        /// From 1.
        attempt: u32,
        /// The episode's number in the store.
        episode: i64,
        /// How it ended.
        ending: Ending,
        /// Ticks flown.
        ticks: u32,
    },
    /// Its log does not give what the page said: it is flown again.
    FlightRefused {
        /// The flight's step.
        step: String,
        /// From 1.
        attempt: u32,
        /// The episode's number in the store.
        episode: i64,
        /// What differs.
        reason: String,
    },
    /// What the page measured beside the flight; see [`super::Telemetry`].
    FlightNoted {
        /// The flight's step.
        step: String,
        /// From 1.
        attempt: u32,
        /// Late ticks, dropped drawing, hidden time, latencies.
        #[serde(default)]
        telemetry: Value,
    },
    /// Everything is done.
    Completed {
        /// The code the participant is shown.
        code: String,
    },
    /// Left out, by a person or by the design.
    Excluded {
        /// Why.
        reason: String,
        /// `design`, or who did it.
        by: String,
    },
    /// Taken in again.
    Reinstated {
        /// Who did it.
        by: String,
    },
    /// The participant wants their data deleted.
    Withdrawn {
        /// Who did it.
        by: String,
    },
    /// The experimenter's note.
    Note {
        /// What it says.
        text: String,
        /// Whose it is.
        by: String,
    },
}

impl Event {
    /// The step it is about, if it is about one.
    pub fn step(&self) -> Option<&str> {
        match self {
            Self::StepDone { step, .. }
            | Self::FlightBegun { step, .. }
            | Self::FlightInterrupted { step, .. }
            | Self::FlightResumed { step, .. }
            | Self::FlightEnded { step, .. }
            | Self::FlightRefused { step, .. }
            | Self::FlightNoted { step, .. } => Some(step),
            _ => None,
        }
    }

    /// Its word in the log.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Invited { .. } => "invited",
            Self::Assigned { .. } => "assigned",
            Self::Opened { .. } => "opened",
            Self::TakenOver { .. } => "taken-over",
            Self::LanguageChosen { .. } => "language-chosen",
            Self::StepDone { .. } => "step-done",
            Self::QuizMissed { .. } => "quiz-missed",
            Self::Declined => "declined",
            Self::FlightBegun { .. } => "flight-begun",
            Self::FlightInterrupted { .. } => "flight-interrupted",
            Self::FlightResumed { .. } => "flight-resumed",
            Self::FlightEnded { .. } => "flight-ended",
            Self::FlightRefused { .. } => "flight-refused",
            Self::FlightNoted { .. } => "flight-noted",
            Self::Completed { .. } => "completed",
            Self::Excluded { .. } => "excluded",
            Self::Reinstated { .. } => "reinstated",
            Self::Withdrawn { .. } => "withdrawn",
            Self::Note { .. } => "note",
        }
    }
}
