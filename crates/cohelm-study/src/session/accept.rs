//! What an answer of the page becomes: events to append, or what is wrong with it.

use super::answers::check_items;
use super::{Event, Session, Status};
use crate::design::schedule::draw;
use crate::design::timeline::{Step, StepKind};
use crate::design::{Design, OnFailedQuiz, Quiz};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Why an answer is not taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnswerError {
    /// No step of this participant has such an id.
    #[error("this session has no step {step:?}")]
    Unknown {
        /// The id.
        step: String,
    },
    /// Another step is first.
    #[error("step {step:?} cannot be answered now; the session is at {current:?}")]
    NotCurrent {
        /// The step that was answered.
        step: String,
        /// The one to answer.
        current: String,
    },
    /// Nothing more is asked of the participant.
    #[error("the session is over: {}", status.word())]
    Over {
        /// How they stand.
        status: Status,
    },
    /// The flight is still to be flown.
    #[error("step {step:?} is a flight that has not ended yet")]
    NotFlown {
        /// The flight's step.
        step: String,
    },
    /// Answers are missing or wrong.
    #[error("some answers are missing or cannot be right")]
    Items {
        /// By item.
        items: BTreeMap<String, AnswerProblem>,
    },
    /// The device cannot keep the plant's rate of ticks, which the design demands.
    #[error("this device is too slow for the study")]
    SlowDevice,
}

impl AnswerError {
    /// What is wrong with which item; empty if that is not the matter.
    pub fn items(&self) -> BTreeMap<String, AnswerProblem> {
        match self {
            Self::Items { items } => items.clone(),
            _ => BTreeMap::new(),
        }
    }
}

/// What is wrong with an answer. The page has a sentence for each in the participant's language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AnswerProblem {
    /// It may not be left out.
    Missing,
    /// It is of another kind than the item asks for.
    WrongKind,
    /// It is below or above what is allowed, or between the points of the scale.
    OutOfRange,
    /// It is none of the choices.
    NoChoice,
    /// It has too many characters.
    TooLong,
    /// There is no such item.
    NoItem,
}

impl Session {
    /// What an answer at a step becomes: the events to append, in one transaction. A step that is done already takes
    /// nothing more and gives no events, so an answer may come twice. After a consent, append [`Event::Assigned`] too.
    ///
    /// | step | data |
    /// |---|---|
    /// | consent | `{"agreed": true}`; `false` declines |
    /// | device | an object; `"ok": false` says that the device cannot keep the rate of ticks |
    /// | form, questionnaire | `{"item": answer, …}`: a number, a choice's value, a list of these, a text; `null` or nothing if it was left out |
    /// | quiz | `{"question": "value of the choice", …}` |
    /// | flight, after its end | [`super::Telemetry`] |
    /// | all others | an object, kept as it is |
    pub fn accept(&self, design: &Design, step: &str, data: &Value) -> Result<Vec<Event>, AnswerError> {
        let index = self.steps().iter().position(|known| known.id == step);
        let index = index.ok_or_else(|| AnswerError::Unknown { step: step.to_owned() })?;
        if index < self.place() {
            return Ok(Vec::new());
        }
        let current = self.current().ok_or(AnswerError::Over { status: self.status() })?;
        if current.id != step || (self.assignment().is_none() && step != "consent") {
            return Err(AnswerError::NotCurrent { step: step.to_owned(), current: current.id.clone() });
        }
        self.take(design, current, data)
    }

    fn take(&self, design: &Design, step: &Step, data: &Value) -> Result<Vec<Event>, AnswerError> {
        match &step.kind {
            StepKind::Consent => self.consent(design, data),
            StepKind::Device => self.device(design, data),
            StepKind::Demographics => self.form(step, &design.demographics, data),
            StepKind::Questionnaire { instrument, .. } => self.form(step, &design.items_of(instrument), data),
            StepKind::Quiz => self.quiz(design, data),
            StepKind::Flight(_) => self.telemetry(step, data),
            StepKind::Instructions | StepKind::Block(_) | StepKind::Break => {
                Ok(vec![done(&step.id, plain(data))])
            }
            StepKind::Debrief => {
                let code = self.completion_code(design);
                Ok(vec![done(&step.id, plain(data)), Event::Completed { code }])
            }
            StepKind::Thanks => Ok(Vec::new()),
        }
    }

    fn consent(&self, design: &Design, data: &Value) -> Result<Vec<Event>, AnswerError> {
        match data.get("agreed").and_then(Value::as_bool) {
            Some(true) => {
                Ok(vec![done("consent", json!({ "agreed": true, "version": design.consent.version }))])
            }
            Some(false) => Ok(vec![Event::Declined]),
            None => Err(one_problem("agreed", AnswerProblem::Missing)),
        }
    }

    fn device(&self, design: &Design, data: &Value) -> Result<Vec<Event>, AnswerError> {
        let is_slow = data.get("ok").and_then(Value::as_bool) == Some(false);
        if is_slow && design.refuses_slow_devices() && !self.is_simulated() {
            return Err(AnswerError::SlowDevice);
        }
        Ok(vec![done("device", plain(data))])
    }

    fn form(
        &self,
        step: &Step,
        items: &[crate::design::Item],
        data: &Value,
    ) -> Result<Vec<Event>, AnswerError> {
        let answers =
            check_items(items, data, self.is_simulated()).map_err(|items| AnswerError::Items { items })?;
        Ok(vec![done(&step.id, answers)])
    }

    fn quiz(&self, design: &Design, data: &Value) -> Result<Vec<Event>, AnswerError> {
        let Some(quiz) = &design.quiz else { return Ok(vec![done("quiz", plain(data))]) };
        let wrong = self.wrong_answers(quiz, data)?;
        let answers = done("quiz", plain(data));
        let is_last = self.quiz_missed() + 1 >= quiz.attempts;
        if wrong.is_empty() {
            return Ok(vec![answers]);
        }
        let missed = Event::QuizMissed { wrong };
        Ok(match quiz.failed {
            _ if !is_last => vec![missed],
            OnFailedQuiz::GoOn => vec![missed, answers],
            OnFailedQuiz::Exclude => {
                let reason = format!("quiz still wrong at attempt {}", quiz.attempts);
                vec![missed, Event::Excluded { reason, by: "design".to_owned() }]
            }
        })
    }

    /// The questions that were answered wrongly. A simulated participant answers nothing, which is not counted as wrong.
    fn wrong_answers(&self, quiz: &Quiz, data: &Value) -> Result<Vec<String>, AnswerError> {
        let answer = |id: &str| data.get(id).filter(|answer| !answer.is_null());
        let unanswered = quiz.questions.iter().filter(|question| answer(&question.id).is_none());
        let missing: BTreeMap<_, _> =
            unanswered.map(|question| (question.id.clone(), AnswerProblem::Missing)).collect();
        if !missing.is_empty() && !self.is_simulated() {
            return Err(AnswerError::Items { items: missing });
        }
        let is_wrong = |question: &&crate::design::QuizQuestion| {
            answer(&question.id).is_some_and(|given| given.as_str() != Some(&question.right))
        };
        Ok(quiz.questions.iter().filter(is_wrong).map(|question| question.id.clone()).collect())
    }

    /// A flight's step is finished by what the page measured beside it.
    fn telemetry(&self, step: &Step, data: &Value) -> Result<Vec<Event>, AnswerError> {
        let flight = self.flight(&step.id).filter(|flight| flight.ended.is_some());
        let flight = flight.ok_or_else(|| AnswerError::NotFlown { step: step.id.clone() })?;
        let telemetry = plain(data);
        Ok(vec![Event::FlightNoted { step: step.id.clone(), attempt: flight.attempt, telemetry }])
    }

    fn completion_code(&self, design: &Design) -> String {
        match (&design.completion_code, self.assignment()) {
            (Some(code), _) => code.clone(),
            (None, Some(assignment)) => code_from(draw(assignment.seed, "completion code", 0)),
            (None, None) => String::new(),
        }
    }
}

fn done(step: &str, data: Value) -> Event {
    Event::StepDone { step: step.to_owned(), data, page_ms: None }
}

/// What a page says beside the point is kept if it is an object.
fn plain(data: &Value) -> Value {
    if data.is_object() { data.clone() } else { Value::Object(Map::new()) }
}

fn one_problem(item: &str, problem: AnswerProblem) -> AnswerError {
    AnswerError::Items { items: [(item.to_owned(), problem)].into() }
}

/// Eight characters that are hard to mistake for one another (Crockford's base 32).
fn code_from(bits: u64) -> String {
    const LETTERS: &[u8; 32] = b"0123456789ABCDEFGHJKMNPQRSTVWXYZ";
    (0..8).map(|place| char::from(LETTERS[(bits >> (5 * place)) as usize % 32])).collect()
}

/// An address with {code} and the panel's {NAME}s filled in, percent-encoded.
pub(super) fn filled_in(address: &str, code: Option<&str>, panel: &BTreeMap<String, String>) -> String {
    let with_code = address.replace("{code}", &percent_encoded(code.unwrap_or_default()));
    panel
        .iter()
        .fold(with_code, |text, (name, value)| text.replace(&format!("{{{name}}}"), &percent_encoded(value)))
}

fn percent_encoded(text: &str) -> String {
    let encode = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    text.bytes().map(encode).collect()
}
