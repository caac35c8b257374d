//! A participant of the pilot study in a test: answers go through `accept`, flights are told as the server tells them.

use super::super::*;
use crate::design::schedule::assign;
use crate::design::{AnswerKind, ResolvedModels};
use serde_json::{Map, json};

/// The shipped pilot study.
pub fn pilot() -> Design {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../studies/pilot.toml");
    Design::from_toml(&std::fs::read_to_string(path).expect("shipped with the project")).expect("well-formed")
}

pub struct Walk {
    pub design: Design,
    pub resolved: Resolved,
    pub log: Vec<Logged>,
    pub session: Session,
}

impl Walk {
    pub fn invited(simulated: bool) -> Self {
        Self::of(pilot(), simulated, &[])
    }

    pub fn of(design: Design, simulated: bool, panel: &[(&str, &str)]) -> Self {
        let panel = panel.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
        let event = Event::Invited { test: false, simulated, language: None, panel, note: None };
        let log = vec![Logged { seq: 1, at_ms: 1000, event }];
        let session = Session::fold(&design, &log).expect("an invitation folds");
        let resolved =
            Resolved { plant_version: 1, models: vec![ResolvedModels::default(); design.conditions.len()] };
        Self { design, resolved, log, session }
    }

    pub fn append(&mut self, event: Event) {
        let logged = Logged { seq: self.session.next_seq(), at_ms: 1000 * self.log.len() as i64, event };
        self.session.push(&self.design, &logged).unwrap_or_else(|error| panic!("{error}: {logged:?}"));
        self.log.push(logged);
    }

    pub fn answer(&mut self, step: &str, data: Value) -> Result<(), AnswerError> {
        let events = self.session.accept(&self.design, step, &data)?;
        events.into_iter().for_each(|event| self.append(event));
        Ok(())
    }

    pub fn assign(&mut self, entropy: u64) {
        let given = assign(&self.design, &[], entropy);
        let design = self.design.hash();
        self.append(Event::Assigned { cell: given.cell, order: given.order, seed: given.seed, design });
    }

    pub fn shown(&self) -> Vec<ShownStep> {
        self.session.shown(&self.design, &self.resolved).expect("every condition is resolved")
    }

    fn place(&self) -> (String, u32) {
        let step = self.session.current().expect("there is a step").id.clone();
        let attempt = self.session.attempt(&step);
        (step, attempt)
    }

    pub fn begin(&mut self) {
        let (step, attempt) = self.place();
        self.append(Event::FlightBegun {
            step,
            attempt,
            episode: self.log.len() as i64,
            clock_offset_ms: None,
        });
    }

    pub fn end(&mut self, ending: Ending, ticks: u32) {
        let (step, attempt) = self.place();
        self.append(Event::FlightEnded { step, attempt, episode: self.log.len() as i64, ending, ticks });
    }

    pub fn fly(&mut self, ending: Ending) {
        self.begin();
        self.end(ending, 120);
    }

    /// Does the current step, whatever it is, as somebody would who answers everything.
    pub fn step(&mut self) {
        let step = self.session.current().expect("there is a step").clone();
        if step.flight().is_some()
            && self.session.flight(&step.id).is_none_or(|flight| flight.ended.is_none())
        {
            self.fly(Ending::Goal);
        }
        let data = match &step.kind {
            StepKind::Consent => json!({ "agreed": true }),
            StepKind::Quiz => json!({ "goal": "own-flags", "landed": "rests" }),
            StepKind::Questionnaire { instrument, .. } => self.middle_of(instrument),
            _ => json!({}),
        };
        self.answer(&step.id, data).expect("it is answered in full");
        if self.session.wants_assignment() {
            self.assign(7);
        }
    }

    /// The middle of every scale: a test needs an answer of the right form, nobody's opinion.
    fn middle_of(&self, instrument: &str) -> Value {
        let middle = |item: &crate::design::Item| match &item.answer {
            AnswerKind::Scale(scale) => json!(scale.least + scale.step * ((scale.points() / 2) as f64)),
            _ => Value::Null,
        };
        let items = self.design.items_of(instrument);
        items.iter().map(|item| (item.id.clone(), middle(item))).collect::<Map<_, _>>().into()
    }

    pub fn up_to(&mut self, step: &str) {
        while self.session.current().expect("the step is ahead").id != step {
            self.step();
        }
    }

    pub fn finish(&mut self) {
        self.up_to("thanks");
    }

    /// One thing that may happen next: mostly a step, now and then something from outside.
    pub fn wander(&mut self, choice: u8) {
        let by = || "desk".to_owned();
        match choice {
            0..=9 => self.append(Event::Opened { tab: format!("tab {choice}"), client: json!({}) }),
            10..=15 => self.append(Event::Note { text: "hm".to_owned(), by: by() }),
            16..=20 => self.append(Event::LanguageChosen { language: "de".to_owned() }),
            21..=23 => self.append(Event::Excluded { reason: "asleep".to_owned(), by: by() }),
            24..=60 => self.append(Event::Reinstated { by: by() }),
            61..=100 => self.in_the_air(choice),
            _ if self.session.current().is_some_and(|step| step.id != "thanks") => self.step(),
            _ => {}
        }
    }

    /// What may happen to the flight that is current, if there is one.
    fn in_the_air(&mut self, choice: u8) {
        let is_to_fly = self.session.current_key().is_some();
        if !is_to_fly {
            return;
        }
        let (step, attempt) = self.place();
        match choice % 4 {
            0 => self.begin(),
            1 => {
                self.append(Event::FlightInterrupted { step, attempt, tick: 9, reason: "reload".to_owned() })
            }
            2 => {
                let source = "server".to_owned();
                self.append(Event::FlightResumed { step, attempt, tick: 9, source, away_ms: 800 });
            }
            _ => {
                let reason = "tick 3 differs".to_owned();
                self.append(Event::FlightRefused { step, attempt, episode: 1, reason });
            }
        }
    }
}
