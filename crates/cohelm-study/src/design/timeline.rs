//! What one participant goes through, step by step, from consent to thanks.
//!
//! A [`Step`] says what comes where, without texts; [`show`] turns it into what the page needs, in the participant's
//! language. A step's id is its name for ever: events and tables refer to it.

mod setups;
mod show;
mod shown;

pub use setups::{Unresolved, flight_key, flight_seed, setup};
pub use show::{Situation, show};
pub use shown::{
    ShownBreak, ShownChoice, ShownContent, ShownFlight, ShownItem, ShownPage, ShownQuestion, ShownStep,
};

use super::schedule::Assignment;
use super::{Design, Practice};
use serde::{Deserialize, Serialize};

/// One step of a participant's way.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Step {
    /// Names it: `consent`, `block-1/practice-3`, `block-1/flight-3`, `block-1/questionnaire/nasa-tlx`, …
    pub id: String,
    /// What happens.
    pub kind: StepKind,
}

/// What happens in a step.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepKind {
    /// The participant agrees, or does not.
    Consent,
    /// The device shows whether it keeps the rate of ticks.
    Device,
    /// Questions about the participant.
    Demographics,
    /// Pages to read.
    Instructions,
    /// Whether they were understood.
    Quiz,
    /// A block, or its practice in advance, is announced.
    Block(BlockPlace),
    /// A flight.
    Flight(FlightPlace),
    /// A pause.
    Break,
    /// A questionnaire, of a block or at the end.
    Questionnaire {
        /// The block it is about, from 1; none at the end.
        block: Option<usize>,
        /// Its name.
        instrument: String,
    },
    /// The last words, and where to ask.
    Debrief,
    /// Completion code and the way back to the panel. Is never done: the participant stays here.
    Thanks,
}

/// Which flights a block announces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlockPlace {
    /// In the order flown, from 1.
    pub block: usize,
    /// Index into [`Design::conditions`].
    pub condition: usize,
    /// Practice flights that follow at once.
    pub practice: u32,
    /// Measured flights that follow at once, or after the practice.
    pub measured: u32,
}

/// Where a flight stands in the design.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FlightPlace {
    /// In the order flown, from 1.
    pub block: usize,
    /// Index into [`Design::conditions`].
    pub condition: usize,
    /// Whether it is for practice.
    pub practice: bool,
    /// From 1, counted apart for practice and measured flights.
    pub number: u32,
    /// How many there are of its kind in the block.
    pub of: u32,
}

impl Step {
    /// Where the flight stands, if it is one.
    pub fn flight(&self) -> Option<&FlightPlace> {
        match &self.kind {
            StepKind::Flight(place) => Some(place),
            _ => None,
        }
    }

    /// The block it belongs to, from 1, if any.
    pub fn block(&self) -> Option<usize> {
        match &self.kind {
            StepKind::Block(place) => Some(place.block),
            StepKind::Flight(place) => Some(place.block),
            StepKind::Questionnaire { block, .. } => *block,
            StepKind::Break => self.id.strip_prefix("block-")?.split('/').next()?.parse().ok(),
            _ => None,
        }
    }
}

/// Every step of a participant with this order, first to last.
pub fn steps(design: &Design, assignment: &Assignment) -> Vec<Step> {
    let mut way = Way { design, steps: Vec::new() };
    way.before_the_flights();
    if design.practice == Practice::InAdvance {
        way.practice_in_advance(&assignment.order);
    }
    for (place, &condition) in assignment.order.iter().enumerate() {
        way.block(place + 1, condition, place + 1 == assignment.order.len());
    }
    way.after_the_flights();
    way.steps
}

struct Way<'a> {
    design: &'a Design,
    steps: Vec<Step>,
}

impl Way<'_> {
    fn add(&mut self, id: impl Into<String>, kind: StepKind) {
        self.steps.push(Step { id: id.into(), kind });
    }

    fn before_the_flights(&mut self) {
        self.add("consent", StepKind::Consent);
        self.add("device", StepKind::Device);
        if !self.design.demographics.is_empty() {
            self.add("demographics", StepKind::Demographics);
        }
        if !self.design.instructions.pages.is_empty() {
            self.add("instructions", StepKind::Instructions);
        }
        if self.design.quiz.is_some() {
            self.add("quiz", StepKind::Quiz);
        }
    }

    fn practice_in_advance(&mut self, order: &[usize]) {
        for (place, &condition) in order.iter().enumerate() {
            let (block, practice) = (place + 1, self.design.conditions[condition].practice_episodes);
            if practice > 0 {
                let announced = BlockPlace { block, condition, practice, measured: 0 };
                self.add(format!("block-{block}/practice"), StepKind::Block(announced));
                self.flights(FlightPlace { block, condition, practice: true, number: 0, of: practice });
            }
        }
    }

    fn block(&mut self, block: usize, condition: usize, is_last: bool) {
        let plan = &self.design.conditions[condition];
        let here = self.design.practice == Practice::BeforeEach;
        let practice = if here { plan.practice_episodes } else { 0 };
        let measured = plan.measured_episodes;
        self.add(
            format!("block-{block}"),
            StepKind::Block(BlockPlace { block, condition, practice, measured }),
        );
        self.flights(FlightPlace { block, condition, practice: true, number: 0, of: practice });
        self.flights(FlightPlace { block, condition, practice: false, number: 0, of: measured });
        for instrument in &plan.questionnaires {
            let id = format!("block-{block}/questionnaire/{instrument}");
            self.add(id, StepKind::Questionnaire { block: Some(block), instrument: instrument.clone() });
        }
        if self.design.breaks.between_blocks && !is_last {
            self.add(format!("block-{block}/break"), StepKind::Break);
        }
    }

    /// Flights 1 to `place.of`, with the pauses within.
    fn flights(&mut self, place: FlightPlace) {
        let word = if place.practice { "practice" } else { "flight" };
        for number in 1..=place.of {
            let id = format!("block-{}/{word}-{number}", place.block);
            self.add(id, StepKind::Flight(FlightPlace { number, ..place }));
            let pause = self.design.breaks.every_flights.is_some_and(|every| number % every == 0);
            if pause && number < place.of {
                self.add(format!("block-{}/break-after-{word}-{number}", place.block), StepKind::Break);
            }
        }
    }

    fn after_the_flights(&mut self) {
        for instrument in &self.design.end_questionnaires {
            let kind = StepKind::Questionnaire { block: None, instrument: instrument.clone() };
            self.add(format!("end/questionnaire/{instrument}"), kind);
        }
        self.add("debrief", StepKind::Debrief);
        self.add("thanks", StepKind::Thanks);
    }
}
