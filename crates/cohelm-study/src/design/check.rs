//! What a file must keep to besides its form: names that exist, numbers in their range, texts that can be read.

mod people;
mod texts;

pub(super) use texts::texts;

use super::{Condition, Design, Item};
use crate::measures;
use crate::questionnaires::{self, Questionnaire};
use cohelm::trajectory::MAX_SEED;
use std::collections::BTreeSet;

/// Most flights of a kind in a block.
const MOST_EPISODES: u32 = 500;
/// Most conditions: a Williams square of more has orders that no study fills.
const MOST_CONDITIONS: usize = 26;

/// What is wrong: where (`conditions[1].rule`), and a sentence each.
pub(super) fn complaints(design: &Design) -> Vec<(String, String)> {
    let mut check = Check { design, found: Vec::new() };
    check.head();
    check.conditions();
    check.questionnaires();
    check.before_the_flights();
    check.declared();
    check.people();
    check.texts();
    check.found
}

pub(super) struct Check<'a> {
    design: &'a Design,
    found: Vec<(String, String)>,
}

impl Check<'_> {
    /// Notes a complaint unless something holds.
    fn want(&mut self, holds: bool, path: impl Into<String>, message: impl Into<String>) {
        if !holds {
            self.found.push((path.into(), message.into()));
        }
    }

    fn want_name(&mut self, name: &str, path: &str) {
        let is_name =
            |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-' || byte == b'_';
        let holds = (1..=64).contains(&name.len()) && name.bytes().all(is_name);
        self.want(
            holds,
            path,
            format!("expected 1 to 64 small letters, digits, hyphens or underscores, got {name:?}"),
        );
    }

    fn want_unique<'n>(&mut self, names: impl IntoIterator<Item = &'n str>, path: &str, what: &str) {
        let mut seen = BTreeSet::new();
        for name in names {
            if !seen.insert(name) {
                self.found.push((path.to_owned(), format!("{what} {name:?} is there twice")));
            }
        }
    }

    fn want_share(&mut self, share: Option<f64>, path: &str) {
        let holds = share.is_none_or(|share| (0.0..=1.0).contains(&share));
        self.want(holds, path, format!("a share lies in 0 to 1, got {}", share.unwrap_or_default()));
    }

    fn head(&mut self) {
        let design = self.design;
        self.want(
            design.format == 1,
            "cohelm-study",
            format!("this program reads format 1, got {}", design.format),
        );
        self.want_name(&design.name, "name");
        self.want(
            !design.contact.trim().is_empty(),
            "contact",
            "participants need somebody to ask: a name and an address",
        );
        let planned = design.planned_participants;
        let holds = (1..=100_000).contains(&planned);
        self.want(holds, "planned-participants", format!("expected 1 to 100000, got {planned}"));
        let seed = design.terrain.seed;
        self.want(seed <= MAX_SEED, "terrain.seed", format!("expected at most 2⁵³ = {MAX_SEED}, got {seed}"));
        for (value, path) in [
            (design.timing.flight_s, "timing.flight-s"),
            (design.timing.between_flights_s, "timing.between-flights-s"),
        ] {
            self.want(
                (0.0..=3600.0).contains(&value),
                path,
                format!("expected 0 to 3600 seconds, got {value}"),
            );
        }
    }

    fn conditions(&mut self) {
        let conditions = &self.design.conditions;
        let count = conditions.len();
        let holds = (1..=MOST_CONDITIONS).contains(&count);
        self.want(holds, "conditions", format!("expected 1 to {MOST_CONDITIONS} conditions, got {count}"));
        self.want_unique(
            conditions.iter().map(|condition| condition.name.as_str()),
            "conditions",
            "the condition",
        );
        for (index, condition) in conditions.iter().enumerate() {
            self.condition(&format!("conditions[{index}]"), condition);
        }
    }

    fn condition(&mut self, path: &str, condition: &Condition) {
        self.want_name(&condition.name, &format!("{path}.name"));
        let Condition { practice_episodes: practice, measured_episodes: measured, .. } = *condition;
        let holds = (1..=MOST_EPISODES).contains(&measured);
        self.want(
            holds,
            format!("{path}.measured-episodes"),
            format!("expected 1 to {MOST_EPISODES}, got {measured}"),
        );
        let holds = practice <= MOST_EPISODES;
        self.want(
            holds,
            format!("{path}.practice-episodes"),
            format!("expected at most {MOST_EPISODES}, got {practice}"),
        );
        self.names_of_questionnaires(&condition.questionnaires, &format!("{path}.questionnaires"));
    }

    fn names_of_questionnaires(&mut self, names: &[String], path: &str) {
        self.want_unique(names.iter().map(String::as_str), path, "the questionnaire");
        for name in names {
            self.name_of_questionnaire(name, path);
        }
    }

    fn name_of_questionnaire(&mut self, name: &str, path: &str) {
        let own = self.design.questionnaires.iter().map(|own| own.name.as_str());
        let known: Vec<&str> =
            questionnaires::built_in().iter().map(|known| known.name.as_str()).chain(own).collect();
        if known.contains(&name) {
            return;
        }
        let near = super::read::nearest(name, &known)
            .map_or(String::new(), |near| format!("; did you mean {near:?}?"));
        let known = known.join(", ");
        self.want(false, path, format!("there is no questionnaire {name:?}{near} There are: {known}"));
    }

    fn questionnaires(&mut self) {
        let design = self.design;
        self.names_of_questionnaires(&design.end_questionnaires, "end-questionnaires");
        self.want_unique(
            design.questionnaires.iter().map(|own| own.name.as_str()),
            "questionnaires",
            "the questionnaire",
        );
        for (index, own) in design.questionnaires.iter().enumerate() {
            self.own_questionnaire(&format!("questionnaires[{index}]"), own);
        }
    }

    fn own_questionnaire(&mut self, path: &str, own: &Questionnaire) {
        self.want_name(&own.name, &format!("{path}.name"));
        let is_new = questionnaires::instrument(&own.name).is_none();
        let message = format!("{:?} is built in; give your own another name", own.name);
        self.want(is_new, format!("{path}.name"), message);
        self.want(!own.items.is_empty(), path, "a questionnaire has at least one item");
        self.items(&own.items, &format!("{path}.items"));
        for (index, item) in own.items.iter().enumerate() {
            if let Some(subscale) = &item.subscale {
                let path = format!("{path}.items[{index}].subscale");
                self.want_name(subscale, &path);
                let is_free = subscale != "overall"
                    && !(own.each_item && own.items.iter().any(|item| item.id == *subscale));
                self.want(is_free, path, format!("{subscale:?} is the name of another score"));
            }
        }
    }

    fn items(&mut self, items: &[Item], path: &str) {
        self.want_unique(items.iter().map(|item| item.id.as_str()), path, "the item");
        for (index, item) in items.iter().enumerate() {
            self.want_name(&item.id, &format!("{path}[{index}].id"));
        }
    }

    fn before_the_flights(&mut self) {
        let design = self.design;
        self.want(
            !design.consent.version.trim().is_empty(),
            "consent.version",
            "a consent needs a version, such as \"1\"",
        );
        let minutes = design.consent.minutes.unwrap_or(1.0);
        let message = format!("expected more than 0 minutes, got {minutes}");
        self.want(minutes.is_finite() && minutes > 0.0, "consent.minutes", message);
        self.items(&design.demographics, "demographics");
        self.quiz();
        let breaks = &design.breaks;
        let message = format!("expected at most 3600 seconds, got {}", breaks.at_least_s);
        self.want(breaks.at_least_s <= 3600, "breaks.at-least-s", message);
        let holds = breaks.at_most_s.is_none_or(|most| most >= breaks.at_least_s.max(1));
        self.want(holds, "breaks.at-most-s", "a break lasts at most as long as it lasts at least, or longer");
        self.want(breaks.every_flights != Some(0), "breaks.every-flights", "expected at least 1");
    }

    fn quiz(&mut self) {
        let Some(quiz) = &self.design.quiz else { return };
        let holds = (1..=10).contains(&quiz.attempts);
        self.want(holds, "quiz.attempts", format!("expected 1 to 10, got {}", quiz.attempts));
        self.want(!quiz.questions.is_empty(), "quiz", "a quiz has at least one question");
        self.want_unique(
            quiz.questions.iter().map(|question| question.id.as_str()),
            "quiz.questions",
            "the question",
        );
        for (index, question) in quiz.questions.iter().enumerate() {
            let path = format!("quiz.questions[{index}]");
            self.want_name(&question.id, &format!("{path}.id"));
            let values: Vec<&str> = question.choices.iter().map(|choice| choice.value.as_str()).collect();
            self.want(values.len() >= 2, format!("{path}.choices"), "a question has at least two choices");
            self.want_unique(values.iter().copied(), &format!("{path}.choices"), "the choice");
            let holds = values.contains(&question.right.as_str());
            let message = format!("{:?} is none of the choices: {}", question.right, values.join(", "));
            self.want(holds, format!("{path}.right"), message);
        }
    }

    fn declared(&mut self) {
        let design = self.design;
        let primary = &design.primary;
        self.want_unique(
            primary.conditions.iter().map(String::as_str),
            "primary.conditions",
            "the condition",
        );
        let known: Vec<&str> = design.conditions.iter().map(|condition| condition.name.as_str()).collect();
        for name in primary.conditions.iter().filter(|name| !known.contains(&name.as_str())) {
            let near = super::read::nearest(name, &known)
                .map_or(String::new(), |near| format!("; did you mean {near:?}?"));
            self.want(false, "primary.conditions", format!("there is no condition {name:?}{near}"));
        }
        self.want(
            primary.conditions.len() != 1,
            "primary.conditions",
            "a comparison needs at least two conditions",
        );
        let holds = (0.001..=0.2).contains(&primary.alpha);
        self.want(
            holds,
            "primary.alpha",
            format!("expected 0.001 to 0.2 (usual: 0.05), got {}", primary.alpha),
        );
        self.measure(&primary.measure, "primary.measure");
        for (measure, bound) in &design.equivalence {
            let path = format!("equivalence.{measure}");
            self.measure(measure, &path);
            let message = format!("a bound is a finite number above 0, in the measure's unit, got {bound}");
            self.want(bound.is_finite() && *bound > 0.0, path, message);
        }
    }

    /// A column of the data, or a score of a questionnaire that the compared conditions ask for.
    fn measure(&mut self, key: &str, path: &str) {
        let Some((name, score)) = key.split_once('/') else {
            let known = measures::measure(key).is_some();
            let message = format!(
                "there is no measure {key:?}; docs/measures.md lists them, and scores are QUESTIONNAIRE/SCORE"
            );
            return self.want(known, path, message);
        };
        let Some(found) = questionnaires::find(self.design, name) else {
            return self.name_of_questionnaire(name, path);
        };
        let scores = found.scores();
        let message = format!("{name} has no score {score:?}; it has: {}", scores.join(", "));
        self.want(scores.iter().any(|known| known == score), path, message);
        let asked = self
            .design
            .conditions
            .iter()
            .filter(|condition| condition.questionnaires.iter().any(|own| own == name));
        let message = format!("{name} must be asked after at least two conditions to be compared");
        self.want(asked.count() >= 2, path, message);
    }
}
