//! Whether every text can be read, in languages the study names, and names no rule to participants.

use super::Check;
use crate::design::{AnswerKind, Design, Item, Words, defaults};
use crate::questionnaires::Questionnaire;
use cohelm::arbitration::Rule;

/// Every text of a design that participants read, with where it stands.
pub(in crate::design) fn texts(design: &Design) -> Vec<(String, &Words)> {
    let mut texts = Texts { found: Vec::new() };
    texts.add("title", &design.title);
    for (index, condition) in design.conditions.iter().enumerate() {
        texts.add_some(format!("conditions[{index}].label"), condition.label.as_ref());
    }
    texts.add("consent.text", &design.consent.text);
    for (index, page) in design.instructions.pages.iter().enumerate() {
        texts.add(format!("instructions.pages[{index}].title"), &page.title);
        texts.add(format!("instructions.pages[{index}].text"), &page.text);
    }
    texts.add_items("demographics", &design.demographics);
    for (index, question) in design.quiz.iter().flat_map(|quiz| &quiz.questions).enumerate() {
        texts.add(format!("quiz.questions[{index}].text"), &question.text);
        for choice in &question.choices {
            texts.add(format!("quiz.questions[{index}].choices"), &choice.text);
        }
        texts.add_some(
            format!("quiz.questions[{index}].hint"),
            Some(&question.hint).filter(|hint| !hint.is_empty()),
        );
    }
    texts.add("breaks.text", &design.breaks.text);
    for (index, own) in design.questionnaires.iter().enumerate() {
        texts.add_questionnaire(&format!("questionnaires[{index}]"), own);
    }
    for (index, check) in design.attention.checks.iter().enumerate() {
        texts.add_item(&format!("attention.checks[{index}].item"), &check.item);
    }
    texts.add("block-text", &design.block_text);
    texts.add("debrief", &design.debrief);
    let button = design.panel.as_ref().map(|panel| &panel.button).filter(|button| !button.is_empty());
    texts.add_some("panel.button".to_owned(), button);
    texts.found
}

struct Texts<'a> {
    found: Vec<(String, &'a Words)>,
}

impl<'a> Texts<'a> {
    fn add(&mut self, path: impl Into<String>, words: &'a Words) {
        self.found.push((path.into(), words));
    }

    fn add_some(&mut self, path: String, words: Option<&'a Words>) {
        self.found.extend(words.map(|words| (path, words)));
    }

    fn add_questionnaire(&mut self, path: &str, questionnaire: &'a Questionnaire) {
        self.add(format!("{path}.title"), &questionnaire.title);
        let intro = Some(&questionnaire.intro).filter(|intro| !intro.is_empty());
        self.add_some(format!("{path}.intro"), intro);
        self.add_items(&format!("{path}.items"), &questionnaire.items);
    }

    fn add_items(&mut self, path: &str, items: &'a [Item]) {
        for (index, item) in items.iter().enumerate() {
            self.add_item(&format!("{path}[{index}]"), item);
        }
    }

    fn add_item(&mut self, path: &str, item: &'a Item) {
        self.add(format!("{path}.text"), &item.text);
        match &item.answer {
            AnswerKind::Scale(scale) => {
                let ends = [("left", &scale.left), ("right", &scale.right)];
                for (key, words) in ends.into_iter().filter(|(_, words)| !words.is_empty()) {
                    self.add(format!("{path}.{key}"), words);
                }
                for label in &scale.labels {
                    self.add(format!("{path}.labels"), label);
                }
            }
            AnswerKind::Choice(choices) | AnswerKind::Many(choices) => {
                for choice in choices {
                    self.add(format!("{path}.choices"), &choice.text);
                }
            }
            AnswerKind::Number { unit, .. } => self.add_some(format!("{path}.unit"), unit.as_ref()),
            AnswerKind::Text { .. } => {}
        }
    }
}

impl Check<'_> {
    pub(super) fn texts(&mut self) {
        self.languages();
        for (path, words) in texts(self.design) {
            self.text(&path, words);
        }
        for (index, condition) in self.design.conditions.iter().enumerate() {
            if let Some(label) = &condition.label {
                self.label(&format!("conditions[{index}].label"), label);
            }
        }
    }

    fn languages(&mut self) {
        let languages = &self.design.languages;
        self.want(!languages.is_empty(), "languages", "at least one language is needed");
        self.want_unique(languages.iter().map(String::as_str), "languages", "the language");
        for language in languages {
            let is_code = |byte: u8| byte.is_ascii_alphabetic() || byte == b'-';
            let holds = (2..=12).contains(&language.len()) && language.bytes().all(is_code);
            self.want(
                holds,
                "languages",
                format!("expected codes such as \"en\" or \"pt-BR\", got {language:?}"),
            );
        }
    }

    fn text(&mut self, path: &str, words: &Words) {
        if defaults::is_one(words) {
            return;
        }
        let design = self.design;
        let first = design.first_language();
        self.want(
            !words.is_empty() && words.speaks(first),
            path,
            format!("no text in the first language, {first}"),
        );
        if let Words::By(texts) = words {
            for language in texts.keys().filter(|language| !design.languages.contains(language)) {
                let spoken = design.languages.join(", ");
                self.want(false, path, format!("language {language:?} is not among `languages`: {spoken}"));
            }
        }
        for text in words.all() {
            self.want(!has_other_links(text), path, "links in texts lead to https addresses only");
        }
    }

    /// What a participant reads must not tell the rule: it would be believed rather than felt.
    fn label(&mut self, path: &str, label: &Words) {
        const ALSO: [&str; 2] = ["human alone", "autonomy"];
        for text in label.all() {
            let lower = text.to_lowercase();
            let words: Vec<&str> = lower.split(|c: char| !(c.is_alphanumeric() || c == '-')).collect();
            let mut telling = Rule::USUAL.iter().map(|rule| rule.word()).chain(ALSO);
            let tells = telling.find(|telling| {
                words.contains(telling) || (telling.contains(' ') && lower.contains(*telling))
            });
            let message =
                format!("participants would read {text:?}, which names the rule; use a neutral label");
            self.want(tells.is_none(), path, message);
        }
    }
}

fn has_other_links(text: &str) -> bool {
    text.split("](").skip(1).any(|address| !address.starts_with("https://"))
}
