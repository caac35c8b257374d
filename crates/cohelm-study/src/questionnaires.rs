//! Questionnaires that are built in, and how every questionnaire is scored.
//!
//! A built-in one is a file of `questionnaires/` beside this one, in the same form as a study's own, with where it is
//! from and on which terms. Answers are never made up: a score without all of its answers is missing.

use crate::design::{AnswerKind, Design, Item, Words};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;
use std::sync::LazyLock;

/// A questionnaire, built in or a study's own.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Questionnaire {
    /// By which conditions name it; small letters, digits and hyphens.
    pub name: String,
    /// What participants read as its heading. Best neutral.
    pub title: Words,
    /// Read above the items.
    #[serde(default)]
    pub intro: Words,
    /// Where it is from, for the report. Default: made for this study.
    pub source: Option<String>,
    /// On which terms it may be used, for the report.
    pub terms: Option<String>,
    /// Whether every scale is a score of its own too, under its item's name. Default: false.
    #[serde(default)]
    pub each_item: bool,
    /// Whether the mean of all scales is a score, "overall". Default: true.
    #[serde(default = "yes")]
    pub overall: bool,
    /// The items.
    pub items: Vec<Item>,
}

fn yes() -> bool {
    true
}

/// The files, in the order of lists.
const FILES: [&str; 4] = [
    include_str!("questionnaires/paper-survey.toml"),
    include_str!("questionnaires/nasa-tlx.toml"),
    include_str!("questionnaires/trust.toml"),
    include_str!("questionnaires/agency.toml"),
];

static BUILT_IN: LazyLock<Vec<Questionnaire>> = LazyLock::new(|| {
    let read = |file: &str| toml::from_str(file).expect("a test reads every built-in questionnaire");
    FILES.iter().map(|file| read(file)).collect()
});

/// The built-in questionnaires.
pub fn built_in() -> &'static [Questionnaire] {
    &BUILT_IN
}

/// The built-in questionnaire of a name.
pub fn instrument(name: &str) -> Option<&'static Questionnaire> {
    BUILT_IN.iter().find(|known| known.name == name)
}

/// The questionnaire that a design means by a name: its own first.
pub fn find<'a>(design: &'a Design, name: &str) -> Option<&'a Questionnaire> {
    design.questionnaires.iter().find(|own| own.name == name).or_else(|| instrument(name))
}

impl Questionnaire {
    /// The names of its scores, in order.
    pub fn scores(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        let each = self.scales().filter(|_| self.each_item).map(|(item, _)| item.id.clone());
        let parts = self.scales().filter_map(|(item, _)| item.subscale.clone());
        let overall = self.overall.then(|| "overall".to_owned());
        for name in each.chain(parts).chain(overall) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// Each score: the mean of its scales, reversed ones turned round. `None` if one of them was not answered.
    pub fn score(&self, answers: &Value) -> Vec<(String, Option<f64>)> {
        let score = |name: String| {
            let value = self.mean(&name, answers);
            (name, value)
        };
        self.scores().into_iter().map(score).collect()
    }

    fn mean(&self, score: &str, answers: &Value) -> Option<f64> {
        let belongs = |item: &Item| {
            score == "overall"
                || item.subscale.as_deref() == Some(score)
                || (self.each_item && item.id == score)
        };
        let parts: Vec<_> = self.scales().filter(|(item, _)| belongs(item)).collect();
        let mut sum = 0.0;
        for (item, scale) in &parts {
            let answer = answers.get(&item.id).and_then(Value::as_f64).filter(|answer| scale.has(*answer))?;
            sum += if item.reversed { scale.turned(answer) } else { answer };
        }
        (!parts.is_empty()).then(|| sum / parts.len() as f64)
    }

    /// Lowest and highest value that a score can take, if all its scales agree on them.
    pub fn range(&self, score: &str) -> Option<(f64, f64)> {
        let belongs = |item: &Item| {
            score == "overall"
                || item.subscale.as_deref() == Some(score)
                || (self.each_item && item.id == score)
        };
        let mut ranges =
            self.scales().filter(|(item, _)| belongs(item)).map(|(_, scale)| (scale.least, scale.most));
        let first = ranges.next()?;
        ranges.all(|range| range == first).then_some(first)
    }

    fn scales(&self) -> impl Iterator<Item = (&Item, &crate::design::Scale)> {
        self.items.iter().filter_map(|item| match &item.answer {
            AnswerKind::Scale(scale) => Some((item, scale)),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests;
