//! From a log to a session, event by event. Every prefix of a log folds.

use super::{Done, Event, FlightState, Logged, Remark, Session, Telemetry, Times};
use crate::design::Design;
use crate::design::schedule::Assignment;
use crate::design::timeline::steps;
use std::collections::BTreeMap;

/// Why a log is no session's: it was damaged, belongs to another design, or an event was appended that
/// [`Session::accept`] did not allow.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FoldError {
    /// There is no event.
    #[error("a participant's log begins with `invited`, got no event at all")]
    Empty,
    /// The first event is another, or a later one is this again.
    #[error("event {seq}: `invited` is the first event and no other, got `{got}`")]
    NotInvited {
        /// Its number.
        seq: u32,
        /// Its word.
        got: &'static str,
    },
    /// A number is missing or there twice.
    #[error("expected event {expected} next, got {got}: events are missing or in the wrong order")]
    Gap {
        /// What comes next.
        expected: u32,
        /// What came.
        got: u32,
    },
    /// The participant goes through another version of the study's file.
    #[error(
        "the participant goes through the design {theirs}, got {given}: fold with the file they began with"
    )]
    OtherDesign {
        /// Hash of theirs.
        theirs: String,
        /// Hash of the one given.
        given: String,
    },
    /// The order is none of the design's.
    #[error("event {seq}: {order:?} is no order of {conditions} conditions")]
    NoOrder {
        /// The event's number.
        seq: u32,
        /// What it says.
        order: Vec<usize>,
        /// How many conditions there are.
        conditions: usize,
    },
    /// Something that cannot happen at this place.
    #[error("event {seq}: `{event}` of {step:?} cannot happen here; the participant is at {current:?}")]
    OutOfPlace {
        /// The event's number.
        seq: u32,
        /// Its word.
        event: &'static str,
        /// The step it names, if any.
        step: String,
        /// The step the participant is at.
        current: String,
    },
}

impl Session {
    /// Where a log leaves the participant.
    pub fn fold(design: &Design, log: &[Logged]) -> Result<Self, FoldError> {
        let (first, later) = log.split_first().ok_or(FoldError::Empty)?;
        let mut session = Self::begin(design, first)?;
        later.iter().try_for_each(|logged| session.push(design, logged))?;
        Ok(session)
    }

    /// The session after its first event.
    pub fn begin(design: &Design, first: &Logged) -> Result<Self, FoldError> {
        if first.seq != 1 {
            return Err(FoldError::Gap { expected: 1, got: first.seq });
        }
        let Event::Invited { test, simulated, language, panel, note } = &first.event else {
            return Err(FoldError::NotInvited { seq: first.seq, got: first.event.word() });
        };
        let as_listed = Assignment { cell: 0, order: (0..design.conditions.len()).collect(), seed: 0 };
        let remark =
            |text: &String| Remark { text: text.clone(), by: "invitation".to_owned(), at_ms: first.at_ms };
        Ok(Self {
            test: *test,
            simulated: *simulated,
            language: language.clone().unwrap_or_else(|| design.first_language().to_owned()),
            panel: panel.clone(),
            assignment: None,
            steps: steps(design, &as_listed),
            place: 0,
            done: BTreeMap::new(),
            quiz_missed: 0,
            flights: BTreeMap::new(),
            tab: None,
            code: None,
            excluded: None,
            withdrawn: false,
            declined: false,
            remarks: note.iter().map(remark).collect(),
            times: Times { invited_ms: first.at_ms, last_ms: first.at_ms, ..Times::default() },
            seq: 1,
        })
    }

    /// The session after one more event. After an error it is as it was.
    pub fn push(&mut self, design: &Design, logged: &Logged) -> Result<(), FoldError> {
        if logged.seq != self.next_seq() {
            return Err(FoldError::Gap { expected: self.next_seq(), got: logged.seq });
        }
        self.apply(design, logged)?;
        self.seq = logged.seq;
        self.times.last_ms = logged.at_ms;
        Ok(())
    }

    fn apply(&mut self, design: &Design, logged: &Logged) -> Result<(), FoldError> {
        match &logged.event {
            Event::Invited { .. } => {
                return Err(FoldError::NotInvited { seq: logged.seq, got: logged.event.word() });
            }
            Event::Assigned { .. } => self.take_order(design, logged)?,
            Event::Opened { tab, .. } | Event::TakenOver { tab } => self.tab = Some(tab.clone()),
            Event::LanguageChosen { language } => self.language.clone_from(language),
            Event::StepDone { .. } => self.finish_step(logged)?,
            Event::QuizMissed { .. } => self.quiz_missed += 1,
            Event::Declined => self.declined = true,
            Event::Completed { code } => self.complete(logged, code)?,
            Event::Excluded { reason, by } => self.excluded = Some((reason.clone(), by.clone())),
            Event::Reinstated { .. } => self.excluded = None,
            Event::Withdrawn { .. } => self.withdrawn = true,
            Event::Note { text, by } => {
                self.remarks.push(Remark { text: text.clone(), by: by.clone(), at_ms: logged.at_ms });
            }
            Event::FlightBegun { .. }
            | Event::FlightInterrupted { .. }
            | Event::FlightResumed { .. }
            | Event::FlightEnded { .. }
            | Event::FlightRefused { .. }
            | Event::FlightNoted { .. } => self.note_flight(logged)?,
        }
        Ok(())
    }

    fn take_order(&mut self, design: &Design, logged: &Logged) -> Result<(), FoldError> {
        let Event::Assigned { cell, order, seed, design: theirs } = &logged.event else { return Ok(()) };
        if !self.wants_assignment() {
            return Err(self.out_of_place(logged));
        }
        if *theirs != design.hash() {
            return Err(FoldError::OtherDesign { theirs: theirs.clone(), given: design.hash() });
        }
        let conditions = design.conditions.len();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        if !sorted.iter().copied().eq(0..conditions) {
            return Err(FoldError::NoOrder { seq: logged.seq, order: order.clone(), conditions });
        }
        let assignment = Assignment { cell: *cell, order: order.clone(), seed: *seed };
        self.steps = steps(design, &assignment);
        self.assignment = Some(assignment);
        Ok(())
    }

    fn finish_step(&mut self, logged: &Logged) -> Result<(), FoldError> {
        let Event::StepDone { step, data, page_ms } = &logged.event else { return Ok(()) };
        let current = self.steps.get(self.place);
        let is_current = current.is_some_and(|current| current.id == *step && current.flight().is_none());
        let is_in_order = self.assignment.is_some() || step == "consent";
        if !is_current || !is_in_order || self.place + 1 == self.steps.len() {
            return Err(self.out_of_place(logged));
        }
        if step == "consent" {
            self.times.consented_ms = Some(logged.at_ms);
        }
        self.done.insert(step.clone(), Done { data: data.clone(), page_ms: *page_ms, at_ms: logged.at_ms });
        self.place += 1;
        Ok(())
    }

    fn complete(&mut self, logged: &Logged, code: &str) -> Result<(), FoldError> {
        if self.place + 1 != self.steps.len() || self.assignment.is_none() {
            return Err(self.out_of_place(logged));
        }
        self.code = Some(code.to_owned());
        self.times.completed_ms = Some(logged.at_ms);
        Ok(())
    }

    fn note_flight(&mut self, logged: &Logged) -> Result<(), FoldError> {
        let step = logged.event.step().unwrap_or_default();
        let current = self.steps.get(self.place).filter(|_| self.assignment.is_some());
        if !current.is_some_and(|current| current.id == step && current.flight().is_some()) {
            return Err(self.out_of_place(logged));
        }
        let new = FlightState { attempt: 1, ..FlightState::default() };
        let mut flight = self.flights.get(step).cloned().unwrap_or(new);
        if !flight.take(&logged.event) {
            return Err(self.out_of_place(logged));
        }
        let is_done = flight.ended.is_some() && flight.telemetry.is_some();
        self.flights.insert(step.to_owned(), flight);
        self.place += usize::from(is_done);
        Ok(())
    }

    fn out_of_place(&self, logged: &Logged) -> FoldError {
        FoldError::OutOfPlace {
            seq: logged.seq,
            event: logged.event.word(),
            step: logged.event.step().unwrap_or_default().to_owned(),
            current: self.steps.get(self.place).map(|step| step.id.clone()).unwrap_or_default(),
        }
    }
}

impl FlightState {
    /// Takes in an event of this flight; false if it cannot happen now.
    fn take(&mut self, event: &Event) -> bool {
        let (Event::FlightBegun { attempt, .. }
        | Event::FlightInterrupted { attempt, .. }
        | Event::FlightResumed { attempt, .. }
        | Event::FlightEnded { attempt, .. }
        | Event::FlightRefused { attempt, .. }
        | Event::FlightNoted { attempt, .. }) = event
        else {
            return false;
        };
        let is_over = self.ended.is_some();
        if *attempt != self.attempt || is_over != matches!(event, Event::FlightNoted { .. }) {
            return false;
        }
        match event {
            Event::FlightBegun { episode, .. } => self.episode = Some(*episode),
            Event::FlightInterrupted { .. } => self.interruptions += 1,
            Event::FlightEnded { episode, ending, ticks, .. } => {
                self.episode = Some(*episode);
                self.ended = Some((*ending, *ticks));
            }
            Event::FlightRefused { .. } => *self = Self { attempt: self.attempt + 1, ..Self::default() },
            Event::FlightNoted { telemetry, .. } => self.telemetry = Some(Telemetry::read(telemetry)),
            _ => {}
        }
        true
    }
}
