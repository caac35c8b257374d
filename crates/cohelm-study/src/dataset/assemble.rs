//! From stored records to a data set: everything but the measuring, which takes plants and models.

use super::{
    Answer, Dataset, Measured, ParticipantRecord, Person, Progress, Score, StudyRecords, Trial, TrialRecord,
};
use crate::design::Design;
use crate::design::timeline::{Step, StepKind};
use crate::questionnaires;
use crate::session::{Event, Logged, Session, Status};
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};

/// What flying a record again gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Flown {
    /// Seed of terrain, goal and start.
    pub seed: u64,
    /// What was measured, or why nothing could be.
    pub measured: Result<Measured, String>,
}

impl Dataset {
    /// Puts a data set together. `flown` has what flying each of `records.trials` again gave, in their order; `None` for a
    /// flight that has no record.
    ///
    /// A log that cannot be read excludes its participant and says why; nothing is dropped in silence.
    pub fn assemble(records: &StudyRecords, flown: Vec<Option<Flown>>) -> Self {
        let mut dataset = Dataset {
            design: records.design.clone(),
            participants: Vec::new(),
            trials: Vec::new(),
            answers: Vec::new(),
            scores: Vec::new(),
            program: records.program.clone(),
        };
        let mut flights: HashMap<i64, Vec<(&TrialRecord, Option<Flown>)>> = HashMap::new();
        for (trial, flown) in records.trials.iter().zip(flown) {
            flights.entry(trial.participant).or_default().push((trial, flown));
        }
        for record in &records.participants {
            dataset.add(record, flights.remove(&record.id).unwrap_or_default());
        }
        dataset
    }

    fn add(&mut self, record: &ParticipantRecord, flights: Vec<(&TrialRecord, Option<Flown>)>) {
        let participant = self.participants.len();
        match Session::fold(&self.design, &record.events) {
            _ if record.events.is_empty() => {
                self.participants.push(unread(record, Progress::Withdrawn, None))
            }
            Ok(session) => {
                self.participants.push(person(&self.design, record, &session));
                let way = Way { design: &self.design, session: &session, participant };
                self.answers.extend(way.answers());
                self.scores.extend(way.scores());
                self.trials.extend(way.trials(flights, &record.events));
            }
            Err(error) => {
                let why = format!("the log of events cannot be read: {error}");
                self.participants.push(unread(record, Progress::UnderWay, Some(why)));
            }
        }
    }
}

/// A participant of whom no session is left, or none can be made.
fn unread(record: &ParticipantRecord, progress: Progress, excluded: Option<String>) -> Person {
    let (mut test, mut simulated) = (false, false);
    if let Some(Logged { event: Event::Invited { test: t, simulated: s, .. }, .. }) = record.events.first() {
        (test, simulated) = (*t, *s);
    }
    Person {
        code: record.code.clone(),
        progress,
        test,
        simulated,
        excluded,
        language: None,
        cell: None,
        order: Vec::new(),
        minutes: None,
        interruptions: 0,
    }
}

fn person(design: &Design, record: &ParticipantRecord, session: &Session) -> Person {
    let assignment = session.assignment();
    let interrupted = |logged: &&Logged| matches!(logged.event, Event::FlightInterrupted { .. });
    let until_ms = session.completed_ms().unwrap_or(session.last_ms());
    Person {
        code: record.code.clone(),
        progress: progress(session),
        test: session.is_test(),
        simulated: session.is_simulated(),
        excluded: excluded(design, session),
        language: Some(session.language().to_owned()),
        cell: assignment.map(|given| given.cell),
        order: assignment.map_or_else(Vec::new, |given| given.order.clone()),
        // A clock that was set back gives no time at all rather than a negative one.
        minutes: session
            .consented_ms()
            .map(|from_ms| (until_ms - from_ms) as f64 / 60_000.0)
            .filter(|m| *m >= 0.0),
        interruptions: record.events.iter().filter(interrupted).count() as u32,
    }
}

fn progress(session: &Session) -> Progress {
    match session.status() {
        Status::Withdrawn => Progress::Withdrawn,
        Status::Declined => Progress::Declined,
        Status::Completed => Progress::Completed,
        Status::Invited => Progress::Invited,
        Status::Excluded if session.code().is_some() => Progress::Completed,
        Status::Excluded if session.assignment().is_none() => Progress::Invited,
        Status::UnderWay | Status::Excluded => Progress::UnderWay,
    }
}

/// Why the participant is left out: a researcher's reason, or the rules of the design that were broken. Who did not
/// finish is out in any case, so the rules are asked of those who did.
fn excluded(design: &Design, session: &Session) -> Option<String> {
    if let Some((reason, by)) = session.excluded() {
        return Some(if by == "design" { reason.to_owned() } else { format!("{reason} (by {by})") });
    }
    let breaches = if session.code().is_some() { session.breaches(design) } else { Vec::new() };
    let words: Vec<String> = breaches.iter().map(|breach| breach.words()).collect();
    (!words.is_empty()).then(|| words.join("; "))
}

/// One participant's way through the design.
struct Way<'a> {
    design: &'a Design,
    session: &'a Session,
    participant: usize,
}

impl Way<'_> {
    /// The condition that a step is about: that of its block.
    fn condition(&self, step: &Step) -> Option<usize> {
        let block = step.block()?;
        self.session.assignment()?.order.get(block.checked_sub(1)?).copied()
    }

    fn answers(&self) -> Vec<Answer> {
        let answers = self.session.answered().flat_map(|(step, done)| {
            let given = done.data.as_object().into_iter().flatten();
            given.map(|(item, value)| Answer {
                participant: self.participant,
                step: step.id.clone(),
                condition: self.condition(step),
                item: item.clone(),
                value: value.clone(),
            })
        });
        answers.collect()
    }

    fn scores(&self) -> Vec<Score> {
        let mut scores = Vec::new();
        for (step, done) in self.session.answered() {
            let StepKind::Questionnaire { instrument, .. } = &step.kind else { continue };
            let Some(questionnaire) = questionnaires::find(self.design, instrument) else { continue };
            scores.extend(questionnaire.score(&done.data).into_iter().map(|(scale, score)| Score {
                participant: self.participant,
                condition: self.condition(step),
                instrument: instrument.clone(),
                scale,
                score,
            }));
        }
        scores
    }

    fn trials(&self, flights: Vec<(&TrialRecord, Option<Flown>)>, events: &[Logged]) -> Vec<Trial> {
        let mut attempts: HashMap<&str, u32> = HashMap::new();
        let places: HashMap<&str, usize> =
            self.session.steps().iter().enumerate().map(|(i, step)| (step.id.as_str(), i)).collect();
        let mut trials: Vec<(usize, Trial)> = Vec::new();
        for (record, flown) in flights {
            let Some(&index) = places.get(record.step.as_str()) else { continue };
            let Some(place) = self.session.steps()[index].flight() else { continue };
            let attempt = attempts.entry(record.step.as_str()).and_modify(|n| *n += 1).or_insert(1);
            let state = self.session.flight(&record.step);
            let ended = state.is_some_and(|s| s.ended.is_some() && s.episode == Some(record.episode));
            let trial = Trial {
                participant: self.participant,
                block: place.block,
                condition: place.condition,
                practice: place.practice,
                number: place.number,
                attempt: *attempt,
                episode: record.episode,
                seed: flown.as_ref().map(|flown| flown.seed),
                counts: ended && flown.is_some(),
                interruptions: if ended { state.map_or(0, |state| state.interruptions) } else { 0 },
                telemetry: if ended { telemetry(events, &record.step) } else { BTreeMap::new() },
                measured: flown
                    .map_or_else(|| Err("the flight was not finished".to_owned()), |flown| flown.measured),
            };
            trials.push((index, trial));
        }
        trials.sort_by_key(|(index, trial)| (*index, trial.attempt));
        trials.into_iter().map(|(_, trial)| trial).collect()
    }
}

/// What the page told of a step's last attempt, its numbers flattened: `{"a": {"b": 1}}` is `a_b`.
fn telemetry(events: &[Logged], step: &str) -> BTreeMap<String, f64> {
    let noted = events.iter().rev().find_map(|logged| match &logged.event {
        Event::FlightNoted { step: of, telemetry, .. } if of == step => Some(telemetry),
        _ => None,
    });
    let mut numbers = BTreeMap::new();
    if let Some(noted) = noted {
        flatten(String::new(), noted, &mut numbers);
    }
    numbers
}

fn flatten(name: String, value: &Value, numbers: &mut BTreeMap<String, f64>) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let name = if name.is_empty() { key.clone() } else { format!("{name}_{key}") };
                flatten(name, value, numbers);
            }
        }
        Value::Number(number) => numbers.extend(number.as_f64().map(|number| (name, number))),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_telemetry_lie_flat_and_the_last_attempt_counts() {
        let noted = |seq, telemetry| Logged {
            seq,
            at_ms: 0,
            event: Event::FlightNoted { step: "block-1/flight-1".into(), attempt: 1, telemetry },
        };
        let events = [
            noted(1, serde_json::json!({ "late_ticks": 9 })),
            noted(
                2,
                serde_json::json!({ "late_ticks": 2, "key_to_tick_ms": { "p95": 21.5 }, "inputs": ["keyboard"] }),
            ),
        ];
        let found = telemetry(&events, "block-1/flight-1");
        assert_eq!(
            found.into_iter().collect::<Vec<_>>(),
            [("key_to_tick_ms_p95".to_owned(), 21.5), ("late_ticks".to_owned(), 2.0)]
        );
        assert!(telemetry(&events, "block-1/flight-2").is_empty());
    }
}
