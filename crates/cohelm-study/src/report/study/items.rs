//! Answers to single items, summed up: numbers by mean and range, choices by counts, words not at all.

use super::Study;
use crate::apa;
use crate::dataset::Answer;
use crate::design::{AnswerKind, Item};
use crate::report::{Align, Table};
use crate::statistics::describe;
use crate::text::Text;
use serde_json::Value;

/// A table of items with how many answered and what; items in words are left out, and no table remains where nobody
/// answered.
pub(super) fn table(
    study: &Study<'_>,
    caption: &str,
    items: &[&Item],
    is_about: impl Fn(&Answer) -> bool,
) -> Option<Table> {
    let language = study.data.design.first_language();
    let given = |item: &Item| -> Vec<&Value> {
        let answers = study.data.answers.iter().filter(|answer| is_about(answer) && answer.item == item.id);
        answers.map(|answer| &answer.value).filter(|value| !value.is_null()).collect()
    };
    let row = |item: &&Item| {
        let given = given(item);
        let summed_up = sum_up(item, &given, language)?;
        let cells = [item.text.read("en", language).replace("**", ""), given.len().to_string(), summed_up];
        Some(cells.into_iter().map(Text::from).collect::<Vec<_>>())
    };
    let rows: Vec<Vec<Text>> = items.iter().filter_map(row).collect();
    let heads = [("Item", Align::Left), ("n", Align::Right), ("Answers", Align::Left)];
    (!rows.is_empty()).then(|| Table {
        caption: Text::from(caption),
        columns: heads.into_iter().map(|(head, align)| (Text::from(head), align)).collect(),
        rows,
        notes: Vec::new(),
    })
}

/// What was answered, in a few words; `None` if nobody did, or in words.
fn sum_up(item: &Item, given: &[&Value], language: &str) -> Option<String> {
    match &item.answer {
        AnswerKind::Text { .. } => None,
        _ if given.is_empty() => None,
        AnswerKind::Scale(_) | AnswerKind::Number { .. } => {
            let numbers: Vec<f64> = given.iter().filter_map(|value| value.as_f64()).collect();
            let s = describe(&numbers).ok()?;
            let sd = s.sd.map_or_else(String::new, |sd| format!(" (SD {})", apa::number(sd, 1)));
            Some(format!("mean {}{sd}, {} to {}", apa::number(s.mean, 1), short(s.min), short(s.max)))
        }
        AnswerKind::Choice(choices) | AnswerKind::Many(choices) => {
            let chosen = |value: &Value, choice: &str| match value {
                Value::Array(several) => several.iter().any(|one| one == choice),
                one => one == choice,
            };
            let counted = choices.iter().map(|choice| {
                let count = given.iter().filter(|value| chosen(value, &choice.value)).count();
                format!("{} {count}", choice.text.read("en", language))
            });
            Some(counted.collect::<Vec<_>>().join(" · "))
        }
    }
}

/// A number without needless decimals.
fn short(number: f64) -> String {
    apa::number(number, if number.fract() == 0.0 { 0 } else { 1 })
}
