//! What tuning may try: as many settings for every rule at most, a rule with nothing to set being tried with every
//! confidence there is.

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

/// Every rule with the settings that tuning may try, in the order of tables.
pub fn contenders() -> Vec<Vec<Setting>> {
    let calibrated = |rule| Setting::new(rule, Head::Calibrated);
    let by_head = |rule| Head::ALL.map(|head| Setting::new(rule, head)).to_vec();
    let of = |rules: Vec<Rule>| rules.into_iter().map(calibrated).collect();
    let settings = |rule: Rule| -> Vec<Setting> {
        match rule {
            Rule::Hic => vec![calibrated(rule)],
            Rule::Robot | Rule::Lasc | Rule::Misc | Rule::Ida => by_head(rule),
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
                let kappas = [0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 1.0, 1.25, 1.5];
                of(kappas.map(|kappa| Rule::MiscR { kappa }).into())
            }
            Rule::MiscH { .. } => [1.0, 1.25, 1.5]
                .into_iter()
                .flat_map(|kappa| [0.25, 0.5, 1.0].map(|release| calibrated(Rule::MiscH { kappa, release })))
                .collect(),
            // Two only: a flight costs thirty times that of any other rule.
            Rule::SafeNearest { .. } => {
                of([5, 20].map(|hold| Rule::SafeNearest { hold, horizon: 40 }).into())
            }
        }
    };
    Rule::USUAL.into_iter().map(settings).collect()
}

/// Constant tolerances from the robot's best action alone to whatever is asked: the line that a rule has to beat.
pub fn tolerances() -> Vec<Setting> {
    let of = |tenth| Setting::new(Rule::Tolerance { alpha: tenths(tenth) }, Head::Calibrated);
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
        let all = contenders();
        for (settings, usual) in all.iter().zip(Rule::USUAL) {
            assert!((1..=SETTINGS).contains(&settings.len()), "{usual:?}");
            assert!(settings.iter().all(|setting| setting.rule.word() == usual.word()));
            assert!(settings.iter().all(|setting| setting.rule.arbiter(1.0).is_ok()));
        }
        assert_eq!(all.len(), Rule::USUAL.len());
    }
}
