//! One participant's session: a fold over an append-only log of events.
//!
//! The log is the truth, the design says what each event means, and [`Session`] is where the two leave the participant:
//! what was done, what comes next. [`Session::accept`] says which events an answer of the page becomes; whoever keeps the
//! log appends them and folds again. Knows no clock and no store: times come with the events.

pub mod accept;
mod answers;
pub mod event;
pub mod exclusion;
mod fold;
pub mod telemetry;

pub use accept::{AnswerError, AnswerProblem};
pub use event::{Event, Logged};
pub use exclusion::Breach;
pub use fold::FoldError;
pub use telemetry::Telemetry;

use crate::design::schedule::Assignment;
use crate::design::timeline::{self, ShownStep, Situation, Step, StepKind, Unresolved};
use crate::design::{Design, Resolved, estimate};
use cohelm::plant::Ending;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Where a participant stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Has a link, has not consented.
    Invited,
    /// Has consented, is not through.
    UnderWay,
    /// Is through.
    Completed,
    /// Was left out, by the design or a person. Nothing more is asked of them.
    Excluded,
    /// Wanted their data deleted.
    Withdrawn,
    /// Did not consent.
    Declined,
}

impl Status {
    /// The word for it in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Invited => "invited",
            Self::UnderWay => "under-way",
            Self::Completed => "completed",
            Self::Excluded => "excluded",
            Self::Withdrawn => "withdrawn",
            Self::Declined => "declined",
        }
    }
}

/// What is known of a flight of the session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlightState {
    /// From 1; one more than were refused.
    pub attempt: u32,
    /// The episode's number, once it was begun.
    pub episode: Option<i64>,
    /// How this attempt ended and after how many ticks, once it did.
    pub ended: Option<(Ending, u32)>,
    /// What the page measured beside it, once it said so.
    pub telemetry: Option<Telemetry>,
    /// How often this attempt was interrupted.
    pub interruptions: u32,
}

/// Something that was answered.
#[derive(Clone, Debug, PartialEq)]
pub struct Done {
    /// What was answered.
    pub data: Value,
    /// Milliseconds that the page showed it.
    pub page_ms: Option<f64>,
    /// When, by the server's clock.
    pub at_ms: i64,
}

/// A note about the participant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Remark {
    /// What it says.
    pub text: String,
    /// Whose it is.
    pub by: String,
    /// When, by the server's clock.
    pub at_ms: i64,
}

/// A participant's session.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    test: bool,
    simulated: bool,
    language: String,
    panel: BTreeMap<String, String>,
    assignment: Option<Assignment>,
    steps: Vec<Step>,
    place: usize,
    done: BTreeMap<String, Done>,
    quiz_missed: u32,
    flights: BTreeMap<String, FlightState>,
    tab: Option<String>,
    code: Option<String>,
    excluded: Option<(String, String)>,
    withdrawn: bool,
    declined: bool,
    remarks: Vec<Remark>,
    times: Times,
    seq: u32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Times {
    invited_ms: i64,
    consented_ms: Option<i64>,
    completed_ms: Option<i64>,
    last_ms: i64,
}

impl Session {
    /// Where the participant stands.
    pub fn status(&self) -> Status {
        match self {
            _ if self.withdrawn => Status::Withdrawn,
            _ if self.excluded.is_some() => Status::Excluded,
            _ if self.declined => Status::Declined,
            _ if self.code.is_some() => Status::Completed,
            _ if self.assignment.is_some() => Status::UnderWay,
            _ => Status::Invited,
        }
    }

    /// The step the participant is at; none if nothing more is asked of them. After completion it is `thanks`.
    pub fn current(&self) -> Option<&Step> {
        match self.status() {
            Status::Invited | Status::UnderWay | Status::Completed => self.steps.get(self.place),
            Status::Excluded | Status::Withdrawn | Status::Declined => None,
        }
    }

    /// Every step, first to last. Before consent the order is not settled; only their number and `consent` mean anything.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// How many steps are done.
    pub fn place(&self) -> usize {
        self.place
    }

    /// The order and seed that were given at consent.
    pub fn assignment(&self) -> Option<&Assignment> {
        self.assignment.as_ref()
    }

    /// Whether consent was given and an order is still to be assigned: whoever stores the consent appends
    /// [`Event::Assigned`] in the same transaction.
    pub fn wants_assignment(&self) -> bool {
        self.assignment.is_none() && self.done.contains_key("consent")
    }

    /// Someone of the team tries the study.
    pub fn is_test(&self) -> bool {
        self.test
    }

    /// A program walks through.
    pub fn is_simulated(&self) -> bool {
        self.simulated
    }

    /// Whether the session belongs into an analysis: completed, by a person who was no tester.
    pub fn counts(&self) -> bool {
        self.status() == Status::Completed && !self.test && !self.simulated
    }

    /// Code of the language that the participant reads.
    pub fn language(&self) -> &str {
        &self.language
    }

    /// What the panel's address said.
    pub fn panel(&self) -> &BTreeMap<String, String> {
        &self.panel
    }

    /// The live tab, if a page was opened.
    pub fn live_tab(&self) -> Option<&str> {
        self.tab.as_deref()
    }

    /// The code of completion, once complete.
    pub fn code(&self) -> Option<&str> {
        self.code.as_deref()
    }

    /// Why and by whom the participant is excluded, if they are.
    pub fn excluded(&self) -> Option<(&str, &str)> {
        self.excluded.as_ref().map(|(reason, by)| (reason.as_str(), by.as_str()))
    }

    /// Notes, first to last.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// How often the quiz was failed.
    pub fn quiz_missed(&self) -> u32 {
        self.quiz_missed
    }

    /// What was answered at a step, if it is done and no flight.
    pub fn done(&self, step: &str) -> Option<&Done> {
        self.done.get(step)
    }

    /// What is known of a flight's step.
    pub fn flight(&self, step: &str) -> Option<&FlightState> {
        self.flights.get(step)
    }

    /// The attempt that a flight's step is at, from 1.
    pub fn attempt(&self, step: &str) -> u32 {
        self.flights.get(step).map_or(1, |flight| flight.attempt)
    }

    /// The key of the flight that may be flown now, if the current step is one that was not flown yet.
    pub fn current_key(&self) -> Option<String> {
        let step = self.current().filter(|step| step.flight().is_some())?;
        let flown = self.flights.get(&step.id).is_some_and(|flight| flight.ended.is_some());
        if flown { None } else { self.key_of(step) }
    }

    /// The flight's step, done or current, whose last attempt has this key: where a page that comes back belongs.
    pub fn step_of_key(&self, key: &str) -> Option<&Step> {
        let begun = self.steps.iter().take(self.place + 1).filter(|step| step.flight().is_some());
        begun.rev().find(|step| self.key_of(step).as_deref() == Some(key))
    }

    fn key_of(&self, step: &Step) -> Option<String> {
        let assignment = self.assignment.as_ref()?;
        Some(timeline::flight_key(assignment, step, self.attempt(&step.id)))
    }

    /// The number that the next event must have.
    pub fn next_seq(&self) -> u32 {
        self.seq + 1
    }

    /// When the link was made, by the server's clock.
    pub fn invited_ms(&self) -> i64 {
        self.times.invited_ms
    }

    /// When consent was given.
    pub fn consented_ms(&self) -> Option<i64> {
        self.times.consented_ms
    }

    /// When everything was done.
    pub fn completed_ms(&self) -> Option<i64> {
        self.times.completed_ms
    }

    /// When the last event happened.
    pub fn last_ms(&self) -> i64 {
        self.times.last_ms
    }

    /// Minutes that the remaining steps take, estimated.
    pub fn minutes_left(&self, design: &Design) -> f64 {
        let left = if self.current().is_some() { &self.steps[self.place..] } else { &[] };
        estimate::minutes(design, left)
    }

    /// What the page needs: the steps that remain, the current one first. Before consent that is consent alone; for whom
    /// nothing more is asked of, nothing.
    pub fn shown(&self, design: &Design, resolved: &Resolved) -> Result<Vec<ShownStep>, Unresolved> {
        if self.current().is_none() {
            return Ok(Vec::new());
        }
        let unsettled = Assignment { cell: 0, order: Vec::new(), seed: 0 };
        let (assignment, last) = match &self.assignment {
            Some(assignment) => (assignment, self.steps.len()),
            None => (&unsettled, (self.place + 1).min(1)),
        };
        let remaining = self.steps.get(self.place..last).unwrap_or_default();
        let show = |step| timeline::show(design, resolved, step, &self.situation(design, assignment, step));
        remaining.iter().map(show).collect()
    }

    fn situation<'a>(&'a self, design: &Design, assignment: &'a Assignment, step: &Step) -> Situation<'a> {
        let flight = self.flights.get(&step.id);
        Situation {
            language: &self.language,
            assignment,
            attempt: self.attempt(&step.id),
            flown: flight.and_then(|flight| flight.ended).map(|(ending, _)| ending),
            quiz_attempts: self.quiz_attempts_left(design),
            code: self.code(),
            return_address: self.return_address(design),
        }
    }

    fn quiz_attempts_left(&self, design: &Design) -> u32 {
        design.quiz.as_ref().map_or(0, |quiz| quiz.attempts.saturating_sub(self.quiz_missed))
    }

    /// Where the panel wants the participant back, given how the session ended; filled in. None while it goes on, and
    /// without a panel.
    pub fn return_address(&self, design: &Design) -> Option<String> {
        let panel = design.panel.as_ref()?;
        let address = match self.status() {
            Status::Completed => panel.completed.as_ref(),
            Status::Declined => panel.declined.as_ref(),
            Status::Excluded => panel.screened_out.as_ref(),
            Status::Invited | Status::UnderWay | Status::Withdrawn => None,
        }?;
        Some(accept::filled_in(address, self.code(), &self.panel))
    }

    /// The forms, quizzes and questionnaires that are done, in order, each with its answers.
    pub fn answered(&self) -> impl Iterator<Item = (&Step, &Done)> {
        let asks = |kind: &StepKind| {
            matches!(kind, StepKind::Demographics | StepKind::Quiz | StepKind::Questionnaire { .. })
        };
        self.steps
            .iter()
            .filter(move |step| asks(&step.kind))
            .filter_map(|step| Some((step, self.done.get(&step.id)?)))
    }
}

#[cfg(test)]
mod tests;
