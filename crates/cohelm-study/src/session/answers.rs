//! Whether answers fit their items.

use super::AnswerProblem;
use crate::design::{AnswerKind, Choice, Item};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The answers with every item in them, `null` for what was not answered; or what is wrong, by item. Who is simulated
/// answers nothing, even what is required.
pub(super) fn check_items(
    items: &[Item],
    data: &Value,
    simulated: bool,
) -> Result<Value, BTreeMap<String, AnswerProblem>> {
    let none = Map::new();
    let given = data.as_object().unwrap_or(&none);
    let unknown = given.keys().filter(|id| !items.iter().any(|item| item.id == **id));
    let mut problems: BTreeMap<String, AnswerProblem> =
        unknown.map(|id| (id.clone(), AnswerProblem::NoItem)).collect();
    let mut answers = Map::new();
    for item in items {
        let answer = given.get(&item.id).cloned().unwrap_or(Value::Null);
        if let Some(problem) = problem(item, &answer, simulated) {
            problems.insert(item.id.clone(), problem);
        }
        answers.insert(item.id.clone(), answer);
    }
    if problems.is_empty() { Ok(Value::Object(answers)) } else { Err(problems) }
}

fn problem(item: &Item, answer: &Value, simulated: bool) -> Option<AnswerProblem> {
    if is_nothing(answer) {
        return (item.required && !simulated).then_some(AnswerProblem::Missing);
    }
    match &item.answer {
        AnswerKind::Scale(scale) => number(answer, |number| scale.has(number)),
        AnswerKind::Number { least, most, .. } => number(answer, |number| {
            least.is_none_or(|least| number >= least) && most.is_none_or(|most| number <= most)
        }),
        AnswerKind::Choice(choices) => chosen(answer, choices),
        AnswerKind::Many(choices) => match answer.as_array() {
            Some(several) => several.iter().find_map(|one| chosen(one, choices)),
            None => Some(AnswerProblem::WrongKind),
        },
        AnswerKind::Text { most_chars } => match answer.as_str() {
            Some(text) => (text.chars().count() > *most_chars as usize).then_some(AnswerProblem::TooLong),
            None => Some(AnswerProblem::WrongKind),
        },
    }
}

/// Nothing, an empty text, nothing of several.
fn is_nothing(answer: &Value) -> bool {
    match answer {
        Value::Null => true,
        Value::String(text) => text.trim().is_empty(),
        Value::Array(several) => several.is_empty(),
        _ => false,
    }
}

fn number(answer: &Value, is_allowed: impl Fn(f64) -> bool) -> Option<AnswerProblem> {
    match answer.as_f64() {
        Some(number) => (!is_allowed(number)).then_some(AnswerProblem::OutOfRange),
        None => Some(AnswerProblem::WrongKind),
    }
}

fn chosen(answer: &Value, choices: &[Choice]) -> Option<AnswerProblem> {
    match answer.as_str() {
        Some(value) => {
            (!choices.iter().any(|choice| choice.value == value)).then_some(AnswerProblem::NoChoice)
        }
        None => Some(AnswerProblem::WrongKind),
    }
}
