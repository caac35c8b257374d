//! Attention, exclusion and the panel: what concerns who takes part.

use super::Check;
use crate::design::{AnswerKind, AttentionCheck, RightAnswer};
use crate::questionnaires;

impl Check<'_> {
    pub(super) fn people(&mut self) {
        self.attention();
        self.exclusion();
        self.panel();
        let minutes = self.design.drop_out_after_minutes;
        let message = format!("expected 5 to 10080 minutes, got {minutes}");
        self.want((5..=10_080).contains(&minutes), "drop-out-after-minutes", message);
        let is_code_byte = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-';
        let is_code = |code: &String| (4..=40).contains(&code.len()) && code.bytes().all(is_code_byte);
        let holds = self.design.completion_code.as_ref().is_none_or(is_code);
        self.want(holds, "completion-code", "expected 4 to 40 letters, digits or hyphens");
    }

    fn attention(&mut self) {
        let attention = &self.design.attention;
        let holds = attention.hidden_at_most_s.is_none_or(|seconds| seconds.is_finite() && seconds >= 0.0);
        self.want(holds, "attention.hidden-at-most-s", "expected 0 or more seconds");
        for (index, check) in attention.checks.iter().enumerate() {
            self.attention_check(&format!("attention.checks[{index}]"), check);
        }
    }

    fn attention_check(&mut self, path: &str, check: &AttentionCheck) {
        self.name_of_questionnaire(&check.questionnaire, &format!("{path}.questionnaire"));
        self.want_name(&check.item.id, &format!("{path}.item.id"));
        let clash = questionnaires::find(self.design, &check.questionnaire)
            .is_some_and(|found| found.items.iter().any(|item| item.id == check.item.id));
        self.want(
            !clash,
            format!("{path}.item.id"),
            format!("the questionnaire has an item {:?} already", check.item.id),
        );
        let asked = self.design.conditions.iter().flat_map(|condition| &condition.questionnaires);
        let is_asked = asked.chain(&self.design.end_questionnaires).any(|name| *name == check.questionnaire);
        let message = format!("{:?} is asked nowhere, so the check would never be seen", check.questionnaire);
        self.want(is_asked, format!("{path}.questionnaire"), message);
        let holds = match (&check.right, &check.item.answer) {
            (RightAnswer::Number(right), AnswerKind::Scale(scale)) => scale.has(*right),
            (RightAnswer::Number(right), AnswerKind::Number { least, most, .. }) => {
                least.is_none_or(|least| *right >= least) && most.is_none_or(|most| *right <= most)
            }
            (RightAnswer::Value(right), AnswerKind::Choice(choices)) => {
                choices.iter().any(|choice| choice.value == *right)
            }
            _ => false,
        };
        self.want(holds, format!("{path}.right"), "expected a point of the scale, or the value of a choice");
    }

    fn exclusion(&mut self) {
        let rules = &self.design.exclusion;
        self.want_share(rules.late_ticks_over, "exclusion.late-ticks-over");
        self.want_share(rules.inattentive_flights_over, "exclusion.inattentive-flights-over");
        self.want_share(rules.silent_flights_over, "exclusion.silent-flights-over");
        let can_be_seen =
            rules.inattentive_flights_over.is_none() || self.design.attention.hidden_at_most_s.is_some();
        let message =
            "needs `hidden-at-most-s` under [attention], which says what counts as flown without attention";
        self.want(can_be_seen, "exclusion.inattentive-flights-over", message);
        let can_fail = rules.failed_checks_over.is_none() || !self.design.attention.checks.is_empty();
        let message = "needs at least one of `checks` under [attention]";
        self.want(can_fail, "exclusion.failed-checks-over", message);
        let has_quiz = !rules.failed_quiz || self.design.quiz.is_some();
        self.want(has_quiz, "exclusion.failed-quiz", "needs a [quiz]");
    }

    fn panel(&mut self) {
        let Some(panel) = &self.design.panel else { return };
        let holds = self.design.open_link != Some(false);
        self.want(
            holds,
            "open-link",
            "a panel sends participants to the open link; leave the key out or say true",
        );
        let knows = panel.parameters.contains(&panel.participant);
        let message =
            format!("{:?} is none of the parameters: {}", panel.participant, panel.parameters.join(", "));
        self.want(knows, "panel.participant", message);
        for (index, name) in panel.parameters.iter().enumerate() {
            let is_name = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'-';
            let holds = (1..=64).contains(&name.len()) && name.bytes().all(is_name) && name != "code";
            let message = format!(
                "expected 1 to 64 letters, digits, underscores or hyphens, and not \"code\", got {name:?}"
            );
            self.want(holds, format!("panel.parameters[{index}]"), message);
        }
        for (address, key) in [
            (&panel.completed, "completed"),
            (&panel.declined, "declined"),
            (&panel.screened_out, "screened-out"),
        ] {
            if let Some(address) = address {
                self.address(address, &format!("panel.{key}"), &panel.parameters);
            }
        }
    }

    fn address(&mut self, address: &str, path: &str, parameters: &[String]) {
        let is_safe = address.starts_with("https://") && !address.contains(char::is_whitespace);
        self.want(is_safe, path, format!("expected an https address without spaces, got {address:?}"));
        for part in address.split('{').skip(1) {
            let name = part.split('}').next().unwrap_or_default();
            let holds =
                part.contains('}') && (name == "code" || parameters.iter().any(|known| known == name));
            let message = format!("{{{name}}} is neither {{code}} nor one of the parameters in braces");
            self.want(holds, path, message);
        }
    }
}
