//! Verdicts on claims, computed from the data by a rule fixed beforehand and never written by hand.
//!
//! Each kind of claim has its judge: a difference in a direction ([`difference_in_direction`]), sameness within a bound
//! ([`equivalent_within`]), something true of everybody ([`every_participant`]). Judgements of the same claim under several
//! settings are joined by [`under_settings`], claims made of parts by [`each_part_holds`], and what only people can say by
//! [`needs_people`]. A judge returns the verdict, the numbers it used and the sentence to print; it never fails: what
//! cannot be tested [cannot be judged](Verdict::CannotBeJudged), with the reason.

mod difference;
mod equivalence;
mod participants;

pub use difference::{Direction, difference_in_direction};
pub use equivalence::equivalent_within;
pub use participants::{Limit, every_participant};

use crate::measures::Measure;
use crate::statistics::{Paired, Table, Undefined, mean};
use crate::text::{Text, capitalised};
use serde::Serialize;
use std::collections::BTreeMap;

/// Results with p below this count as significant, as in the paper.
pub const LEVEL: f64 = 0.05;

/// What our data say of a claim.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "verdict", content = "because", rename_all = "snake_case")]
pub enum Verdict {
    /// Our data show it too.
    Reproduces,
    /// Our data show the opposite, or nothing of the kind.
    DoesNot,
    /// Our data show it under a condition, which completes the sentence "only if …".
    OnlyIf(String),
    /// Our data cannot tell, for this reason.
    CannotBeJudged(String),
}

impl Verdict {
    /// The verdict in words.
    pub fn words(&self) -> String {
        match self {
            Verdict::Reproduces => "Reproduces".to_owned(),
            Verdict::DoesNot => "Does not reproduce".to_owned(),
            Verdict::OnlyIf(condition) => format!("Only if {condition}"),
            Verdict::CannotBeJudged(_) => "Cannot be judged".to_owned(),
        }
    }
}

/// A verdict with its grounds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judgement {
    /// The verdict.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// Our numbers in a few words, to stand beside the paper's.
    pub ours: Text,
    /// The grounds in full sentences, as one reports them.
    pub sentence: Text,
    /// Every number the verdict rests on, by name.
    pub numbers: BTreeMap<String, f64>,
}

impl Judgement {
    fn cannot(why: &Undefined) -> Self {
        let why = why.to_string();
        Judgement {
            ours: Text::from("–"),
            sentence: Text::from(format!("{}.", capitalised(&why))),
            verdict: Verdict::CannotBeJudged(why),
            numbers: BTreeMap::new(),
        }
    }
}

/// Two conditions of a table, compared in one measure.
#[derive(Debug, Clone, Copy)]
pub struct Comparison<'a> {
    /// Every participant's value under every condition.
    pub table: &'a Table,
    /// What the values are.
    pub measure: &'a Measure<'a>,
    /// The condition that the claim is about.
    pub condition: &'a str,
    /// The one it is held against.
    pub against: &'a str,
}

impl Comparison<'_> {
    fn pairs(&self) -> Result<Paired, Undefined> {
        self.table.pair_named(self.condition, self.against)
    }

    /// Both means, condition first.
    fn means(&self, pairs: &Paired) -> Result<(f64, f64), Undefined> {
        Ok((mean(pairs.a())?, mean(pairs.b())?))
    }

    /// "MISC 238.2, LASC 245.0"
    fn values(&self, means: (f64, f64)) -> String {
        let (value, other) = (self.measure.write(means.0), self.measure.write(means.1));
        format!("{} {value}, {} {other}", self.condition, self.against)
    }

    /// "Steps: MISC 238.2, LASC 245.0."
    fn headline(&self, means: (f64, f64)) -> String {
        format!("{}: {}.", self.measure.title(), self.values(means))
    }
}

/// Joins judgements of one claim under several settings. Each setting completes the sentence "only if …".
///
/// Reproduces if it does under all settings that can be judged, does not if under none; otherwise only if the settings
/// under which it does are taken.
pub fn under_settings(settings: Vec<(String, Judgement)>) -> Judgement {
    let judged = |j: &Judgement| !matches!(j.verdict, Verdict::CannotBeJudged(_));
    let total = settings.iter().filter(|(_, j)| judged(j)).count();
    let holding: Vec<&(String, Judgement)> = settings
        .iter()
        .filter(|(_, j)| matches!(j.verdict, Verdict::Reproduces | Verdict::OnlyIf(_)))
        .collect();
    let unconditional = holding.iter().filter(|(_, j)| j.verdict == Verdict::Reproduces).count();
    let verdict = if total == 0 {
        let reasons = settings.iter().filter_map(|(_, j)| match &j.verdict {
            Verdict::CannotBeJudged(why) => Some(why.as_str()),
            _ => None,
        });
        Verdict::CannotBeJudged(reasons.take(1).collect::<String>())
    } else if holding.is_empty() {
        Verdict::DoesNot
    } else if unconditional == total {
        Verdict::Reproduces
    } else {
        Verdict::OnlyIf(
            holding.iter().map(|(setting, j)| condition(setting, j)).collect::<Vec<_>>().join(" or "),
        )
    };
    let ours = joined(&settings, |j| &j.ours);
    let sentence = joined(&settings, |j| &j.sentence);
    let numbers = settings
        .iter()
        .flat_map(|(setting, j)| {
            j.numbers.iter().map(move |(name, value)| (format!("{setting}: {name}"), *value))
        })
        .collect();
    Judgement { verdict, ours, sentence, numbers }
}

fn condition(setting: &str, judgement: &Judgement) -> String {
    match &judgement.verdict {
        Verdict::OnlyIf(further) => format!("{setting} and {further}"),
        _ => setting.to_owned(),
    }
}

/// Each setting on a line of its own.
fn joined(settings: &[(String, Judgement)], of: impl Fn(&Judgement) -> &Text) -> Text {
    settings.iter().enumerate().fold(Text::new(), |text, (i, (setting, judgement))| {
        let text = if i == 0 { text } else { text.line_break() };
        text.strong(format!("If {setting}:")).plain(" ").then(of(judgement).clone())
    })
}

/// A part of a claim that is a fact rather than a measurement, such as what a model was trained from.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What the part is, so that "only if one means …" reads well.
    pub name: String,
    /// Whether it is so, taken from the record that holds the fact.
    pub holds: bool,
    /// What the record says, as a sentence.
    pub evidence: Text,
}

/// Judges a claim made of parts, each of which is so or not.
pub fn each_part_holds(parts: &[Part]) -> Judgement {
    let holding: Vec<&str> = parts.iter().filter(|p| p.holds).map(|p| p.name.as_str()).collect();
    let verdict = if parts.is_empty() {
        Verdict::CannotBeJudged("nothing is known of it".to_owned())
    } else if holding.len() == parts.len() {
        Verdict::Reproduces
    } else if holding.is_empty() {
        Verdict::DoesNot
    } else {
        Verdict::OnlyIf(format!("one means {}", holding.join(" and ")))
    };
    let ours: Vec<String> =
        parts.iter().map(|p| format!("{}: {}", p.name, if p.holds { "yes" } else { "no" })).collect();
    let sentence = parts.iter().enumerate().fold(Text::new(), |text, (i, part)| {
        let text = if i == 0 { text } else { text.plain(" ") };
        text.then(part.evidence.clone())
    });
    let numbers = parts.iter().map(|p| (p.name.clone(), f64::from(u8::from(p.holds)))).collect();
    Judgement { verdict, ours: Text::from(ours.join("; ")), sentence, numbers }
}

/// Judges what only people can say: without a single answer of a person it cannot be judged, whatever simulated pilots do.
pub fn needs_people(answers: usize, judge: impl FnOnce() -> Judgement) -> Judgement {
    if answers > 0 {
        return judge();
    }
    Judgement {
        verdict: Verdict::CannotBeJudged("simulated pilots have no opinions".to_owned()),
        ours: Text::from("no answers"),
        sentence: Text::from(
            "This is about what people felt. Simulated pilots fill in no questionnaire, and none was invented for them.",
        ),
        numbers: BTreeMap::from([("answers".to_owned(), 0.0)]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judgement(verdict: Verdict) -> Judgement {
        Judgement {
            verdict,
            ours: Text::from("o"),
            sentence: Text::from("S."),
            numbers: BTreeMap::from([("p".into(), 0.5)]),
        }
    }

    fn joined_verdict(verdicts: &[Verdict]) -> Verdict {
        let setting = |(i, v): (usize, &Verdict)| (format!("setting {i} is taken"), judgement(v.clone()));
        under_settings(verdicts.iter().enumerate().map(setting).collect()).verdict
    }

    #[test]
    fn settings_join_to_each_verdict() {
        use Verdict::{CannotBeJudged, DoesNot, OnlyIf, Reproduces};
        let cannot = CannotBeJudged("too few".into());
        assert_eq!(joined_verdict(&[Reproduces, Reproduces, cannot.clone()]), Reproduces);
        assert_eq!(joined_verdict(&[DoesNot, cannot.clone()]), DoesNot);
        assert_eq!(joined_verdict(&[DoesNot, Reproduces]), OnlyIf("setting 1 is taken".into()));
        let further = OnlyIf("means are meant".into());
        assert_eq!(joined_verdict(&[further]), OnlyIf("setting 0 is taken and means are meant".into()));
        assert_eq!(joined_verdict(&[cannot.clone(), cannot.clone()]), cannot);
    }

    #[test]
    fn settings_keep_every_number_and_sentence() {
        let both = under_settings(vec![
            ("c is as printed".into(), judgement(Verdict::DoesNot)),
            ("c is peaked".into(), judgement(Verdict::Reproduces)),
        ]);
        assert_eq!(both.sentence.to_string(), "If c is as printed: S.\nIf c is peaked: S.");
        assert_eq!(both.numbers.keys().collect::<Vec<_>>(), ["c is as printed: p", "c is peaked: p"]);
        assert_eq!(both.verdict.words(), "Only if c is peaked");
    }

    #[test]
    fn parts_flip_the_verdict() {
        let judge = |values: bool, intent: bool| {
            let part = |name: &str, holds| Part {
                name: name.into(),
                holds,
                evidence: Text::from("So says the card."),
            };
            each_part_holds(&[part("the values", values), part("the intent", intent)]).verdict
        };
        assert_eq!(judge(true, true), Verdict::Reproduces);
        assert_eq!(judge(true, false), Verdict::OnlyIf("one means the values".into()));
        assert_eq!(judge(false, false), Verdict::DoesNot);
        assert!(matches!(each_part_holds(&[]).verdict, Verdict::CannotBeJudged(_)));
    }

    #[test]
    fn people_are_needed_until_one_has_answered() {
        let judge = || judgement(Verdict::Reproduces);
        assert!(matches!(needs_people(0, judge).verdict, Verdict::CannotBeJudged(_)));
        assert_eq!(needs_people(1, judge).verdict, Verdict::Reproduces);
    }

    #[test]
    fn a_judgement_is_plain_json() {
        let json = serde_json::to_string(&judgement(Verdict::OnlyIf("x".into()))).unwrap();
        assert_eq!(
            json,
            r#"{"verdict":"only_if","because":"x","ours":"o","sentence":"S.","numbers":{"p":0.5}}"#
        );
    }
}
