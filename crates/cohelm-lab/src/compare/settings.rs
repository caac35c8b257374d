//! What tuning may try: as many settings for every rule at most.
//!
//! The heads of the inference differ in how well they guess, and that is no merit of a rule. So the robot alone is tried with
//! every head, and all rules that ask for no more than the goal get the head with which it does best, the line of tolerances
//! too. To a rule that asks how sure the co-pilot is (c) the head is a parameter, because the heads mean different things by it.

use cohelm::arbitration::Rule;
use cohelm::intent::{Head, Inference};
use serde::Serialize;

/// Most settings of one rule.
pub const SETTINGS: usize = 9;

/// A rule with its parameters, and where the belief about the goal comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setting {
    /// The rule.
    pub rule: Rule,
    /// The inference.
    pub inference: Inference,
}

impl Setting {
    fn new(rule: Rule, head: Head) -> Self {
        Self { rule, inference: head.into() }
    }
}

fn by_head(rule: Rule) -> Vec<Setting> {
    Head::ALL.map(|head| Setting::new(rule, head)).to_vec()
}

/// The robot alone with every head: by this the head is chosen.
pub fn robots() -> Vec<Setting> {
    by_head(Rule::Robot)
}

/// Every rule with the settings that tuning may try, in the order of tables; `head` is that of rules that ask for no more than
/// the goal.
pub fn contenders(head: Head) -> Vec<Vec<Setting>> {
    let with_head = |rule| Setting::new(rule, head);
    let of = |rules: Vec<Rule>| rules.into_iter().map(with_head).collect();
    let settings = |rule: Rule| -> Vec<Setting> {
        match rule {
            Rule::Hic | Rule::Ida => vec![with_head(rule)],
            Rule::Robot => robots(),
            Rule::Lasc | Rule::Misc => by_head(rule),
            Rule::LineGraph { .. } => [(0.0, 0.5), (0.2, 0.8), (0.4, 0.9)]
                .into_iter()
                .flat_map(|(start, full)| by_head(Rule::LineGraph { start, full, most: 1.0 }))
                .collect(),
            Rule::Threshold { .. } => [0.4, 0.6, 0.8]
                .into_iter()
                .flat_map(|confidence| by_head(Rule::Threshold { confidence }))
                .collect(),
            Rule::Hindsight { .. } => {
                let worth = [0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.5];
                of(worth.map(|likeness| Rule::Hindsight { likeness }).into())
            }
            Rule::Tolerance { .. } => {
                of((1..10).map(|tenth| Rule::Tolerance { alpha: tenths(tenth) }).collect())
            }
            Rule::MiscR { .. } => {
                let kappas = [0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8];
                of(kappas.map(|kappa| Rule::MiscR { kappa }).into())
            }
            Rule::MiscH { .. } => [0.6, 1.0, 1.5]
                .into_iter()
                .flat_map(|kappa| [0.25, 0.5, 0.75].map(|release| with_head(Rule::MiscH { kappa, release })))
                .collect(),
            // Two only, because its flights cost many times those of any other rule.
            Rule::SafeNearest { .. } => {
                of([5, 20].map(|hold| Rule::SafeNearest { hold, horizon: 40 }).into())
            }
        }
    };
    Rule::USUAL.into_iter().map(settings).collect()
}

/// Constant tolerances from the robot's best action alone to whatever is asked: the line that a rule has to beat.
pub fn tolerances(head: Head) -> Vec<Setting> {
    let of = |tenth| Setting::new(Rule::Tolerance { alpha: tenths(tenth) }, head);
    (0..=10).map(of).collect()
}

fn tenths(count: u32) -> f64 {
    f64::from(count) / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_is_tried_with_no_more_settings_than_the_others() {
        let all = contenders(Head::Softmax);
        for (settings, usual) in all.iter().zip(Rule::USUAL) {
            assert!((1..=SETTINGS).contains(&settings.len()), "{usual:?}");
            assert!(settings.iter().all(|setting| setting.rule.word() == usual.word()));
            assert!(settings.iter().all(|setting| setting.rule.arbiter(1.0).is_ok()));
        }
        assert_eq!(all.len(), Rule::USUAL.len());
    }
}
