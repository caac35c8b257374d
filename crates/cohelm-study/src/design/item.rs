//! One question of a form or questionnaire.

use super::Words;
use super::text::described_by;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One question of a form or questionnaire.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "ItemTable")]
pub struct Item {
    /// Names the answer in every table; small letters, digits and hyphens.
    pub id: String,
    /// The question.
    pub text: Words,
    /// Whether the participant may not leave it out.
    pub required: bool,
    /// How it is answered.
    pub answer: AnswerKind,
    /// A scale on which a high answer means little of what is measured: it is turned round before it is scored.
    pub reversed: bool,
    /// To which score of its questionnaire it belongs; without one, to the overall score.
    pub subscale: Option<String>,
}

/// How an item is answered.
#[derive(Clone, Debug, PartialEq)]
pub enum AnswerKind {
    /// A number on a scale with a word at each end. Nothing is chosen beforehand.
    Scale(Scale),
    /// One of several.
    Choice(Vec<Choice>),
    /// Any of several.
    Many(Vec<Choice>),
    /// A number.
    Number {
        /// The smallest allowed.
        least: Option<f64>,
        /// The largest allowed.
        most: Option<f64>,
        /// Printed behind it.
        unit: Option<Words>,
    },
    /// Free text.
    Text {
        /// Most characters.
        most_chars: u32,
    },
}

/// A scale with a word at each end.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// The number at the left end.
    pub least: f64,
    /// The number at the right end.
    pub most: f64,
    /// Between neighbours.
    pub step: f64,
    /// At the left end.
    pub left: Words,
    /// At the right end.
    pub right: Words,
    /// A word for every point; empty if only the ends have one.
    pub labels: Vec<Words>,
}

/// One of the answers to choose from. A bare text is its own value.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(from = "ChoiceTable")]
pub struct Choice {
    /// What is stored.
    pub value: String,
    /// What is read.
    pub text: Words,
}

/// A choice as the file gives it.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a text, or a table { value = \"…\", text = … }")]
enum ChoiceTable {
    /// A text that is its own value.
    Plain(String),
    /// What is stored, and what is read.
    Named(NamedChoice),
}

/// What is stored, and what is read.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct NamedChoice {
    /// What is stored.
    value: String,
    /// What is read.
    text: Words,
}

impl From<ChoiceTable> for Choice {
    fn from(table: ChoiceTable) -> Self {
        match table {
            ChoiceTable::Plain(text) => Self { value: text.clone(), text: Words::Same(text) },
            ChoiceTable::Named(NamedChoice { value, text }) => Self { value, text },
        }
    }
}

/// How an item is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ItemKind {
    /// A number on a scale with a word at each end; nothing is chosen beforehand.
    Scale,
    /// One of several.
    Choice,
    /// Any of several.
    Many,
    /// A number.
    Number,
    /// Free text.
    Text,
}

/// One question of a form or questionnaire. Which keys an item has depends on its `kind`.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct ItemTable {
    /// Names the answer in every table; small letters, digits, hyphens and underscores.
    id: String,
    /// How it is answered.
    kind: ItemKind,
    /// The question.
    text: Words,
    /// Whether the participant may not leave it out. Default: false.
    #[serde(default)]
    required: bool,
    /// scale: the number at the left end, default 0. number: the smallest allowed.
    least: Option<f64>,
    /// scale: the number at the right end, default 10. number: the largest allowed.
    most: Option<f64>,
    /// scale: between neighbours. Default: 1.
    step: Option<f64>,
    /// scale: the word at the left end.
    left: Option<Words>,
    /// scale: the word at the right end.
    right: Option<Words>,
    /// scale: a word for every point, from left to right. Default: only the ends have words.
    #[serde(default)]
    labels: Vec<Words>,
    /// choice and many: the answers, each a text or { value = "…", text = … }.
    #[serde(default)]
    choices: Vec<Choice>,
    /// number: printed behind it.
    unit: Option<Words>,
    /// text: most characters, 1 to 10000. Default: 1000.
    most_chars: Option<u32>,
    /// scale: a high answer means little of what is measured, so it is turned round before it is scored. Default: false.
    #[serde(default)]
    reversed: bool,
    /// scale: the score of its questionnaire to which it belongs. Default: the overall score.
    subscale: Option<String>,
}

impl TryFrom<ItemTable> for Item {
    type Error = String;

    fn try_from(table: ItemTable) -> Result<Self, String> {
        table.refuse_keys_of_other_kinds()?;
        let ItemTable { id, text, required, reversed, subscale, .. } = &table;
        let (id, text, required) = (id.clone(), text.clone(), *required);
        let (reversed, subscale) = (*reversed, subscale.clone());
        Ok(Self { id, text, required, reversed, subscale, answer: table.answer()? })
    }
}

impl ItemTable {
    /// A key that the kind does not know would be ignored in silence, and its author would believe otherwise.
    fn refuse_keys_of_other_kinds(&self) -> Result<(), String> {
        use ItemKind::{Choice, Many, Number, Scale, Text};
        let present: [(&str, bool, &[ItemKind]); 11] = [
            ("least", self.least.is_some(), &[Scale, Number]),
            ("most", self.most.is_some(), &[Scale, Number]),
            ("step", self.step.is_some(), &[Scale]),
            ("left", self.left.is_some(), &[Scale]),
            ("right", self.right.is_some(), &[Scale]),
            ("labels", !self.labels.is_empty(), &[Scale]),
            ("choices", !self.choices.is_empty(), &[Choice, Many]),
            ("unit", self.unit.is_some(), &[Number]),
            ("most-chars", self.most_chars.is_some(), &[Text]),
            ("reversed", self.reversed, &[Scale]),
            ("subscale", self.subscale.is_some(), &[Scale]),
        ];
        match present.iter().find(|(_, given, kinds)| *given && !kinds.contains(&self.kind)) {
            Some((key, _, _)) => {
                Err(format!("item {:?}: `{key}` means nothing for the kind {}", self.id, word(self.kind)))
            }
            None => Ok(()),
        }
    }

    fn answer(self) -> Result<AnswerKind, String> {
        match self.kind {
            ItemKind::Scale => self.scale().map(AnswerKind::Scale),
            ItemKind::Choice => Ok(AnswerKind::Choice(self.some_choices()?)),
            ItemKind::Many => Ok(AnswerKind::Many(self.some_choices()?)),
            ItemKind::Number => {
                Ok(AnswerKind::Number { least: self.least, most: self.most, unit: self.unit })
            }
            ItemKind::Text => self.free_text(),
        }
    }

    fn scale(self) -> Result<Scale, String> {
        let (least, most) = (self.least.unwrap_or(0.0), self.most.unwrap_or(10.0));
        let step = self.step.unwrap_or(1.0);
        let scale = Scale {
            least,
            most,
            step,
            left: self.left.unwrap_or_default(),
            right: self.right.unwrap_or_default(),
            labels: self.labels,
        };
        scale.check().map_err(|reason| format!("item {:?}: {reason}", self.id))?;
        Ok(scale)
    }

    fn some_choices(self) -> Result<Vec<Choice>, String> {
        if self.choices.len() < 2 {
            return Err(format!("item {:?}: a {} needs at least two `choices`", self.id, word(self.kind)));
        }
        let mut values: Vec<&str> = self.choices.iter().map(|choice| choice.value.as_str()).collect();
        values.sort_unstable();
        match values.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(format!("item {:?}: the choice {:?} is there twice", self.id, pair[0])),
            None => Ok(self.choices),
        }
    }

    fn free_text(self) -> Result<AnswerKind, String> {
        match self.most_chars.unwrap_or(1000) {
            most_chars @ 1..=10_000 => Ok(AnswerKind::Text { most_chars }),
            other => Err(format!("item {:?}: `most-chars` must lie in 1 to 10000, got {other}", self.id)),
        }
    }
}

fn word(kind: ItemKind) -> &'static str {
    match kind {
        ItemKind::Scale => "scale",
        ItemKind::Choice => "choice",
        ItemKind::Many => "many",
        ItemKind::Number => "number",
        ItemKind::Text => "text",
    }
}

impl Scale {
    /// How many points it has.
    pub fn points(&self) -> usize {
        ((self.most - self.least) / self.step).round() as usize + 1
    }

    /// The answer as it is scored: turned round for a reversed item.
    pub fn turned(&self, answer: f64) -> f64 {
        self.least + self.most - answer
    }

    /// Whether a number is one of its points.
    pub fn has(&self, answer: f64) -> bool {
        let steps = (answer - self.least) / self.step;
        answer >= self.least && answer <= self.most && (steps - steps.round()).abs() < 1e-6
    }

    fn check(&self) -> Result<(), String> {
        let (least, most, step) = (self.least, self.most, self.step);
        if !(least.is_finite() && most.is_finite() && least < most) {
            return Err(format!("a scale goes from `least` to a larger `most`, got {least} to {most}"));
        }
        let steps = (most - least) / step;
        if !(step.is_finite() && step > 0.0 && (steps - steps.round()).abs() < 1e-6 && steps <= 1000.0) {
            return Err(format!(
                "`step` must divide {least} to {most} into at most 1000 equal parts, got {step}"
            ));
        }
        if !(self.labels.is_empty() || self.labels.len() == self.points()) {
            let (labels, points) = (self.labels.len(), self.points());
            return Err(format!("a scale of {points} points has {points} `labels` or none, got {labels}"));
        }
        Ok(())
    }
}

described_by!(Item, ItemTable);
described_by!(Choice, ChoiceTable);
