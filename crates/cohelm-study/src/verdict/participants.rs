//! "It is so for every participant."

use super::{Judgement, Verdict};
use crate::measures::Measure;
use crate::statistics::{Table, Undefined, describe};
use crate::text::Text;
use std::collections::BTreeMap;

/// A limit that every participant's value is claimed to keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// Larger than this.
    Above(f64),
    /// Smaller than this.
    Below(f64),
}

impl Limit {
    fn keeps(self, value: f64) -> bool {
        match self {
            Limit::Above(limit) => value > limit,
            Limit::Below(limit) => value < limit,
        }
    }

    fn value(self) -> f64 {
        match self {
            Limit::Above(limit) | Limit::Below(limit) => limit,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Limit::Above(_) => "above",
            Limit::Below(_) => "below",
        }
    }
}

/// Judges "under this condition, every participant's value keeps the limit".
///
/// Reproduces if every single one does; only if the mean is meant, if not all do but their mean does; otherwise does not.
pub fn every_participant(table: &Table, measure: &Measure, condition: &str, limit: Limit) -> Judgement {
    judge(table, measure, condition, limit).unwrap_or_else(|why| Judgement::cannot(&why))
}

fn judge(table: &Table, measure: &Measure, condition: &str, limit: Limit) -> Result<Judgement, Undefined> {
    let column = table.condition(condition).and_then(|index| table.column(index));
    let values = column.ok_or_else(|| Undefined::NoSuchCondition { condition: condition.to_owned() })?;
    let summary = describe(&values)?;
    let keeping = values.iter().filter(|value| limit.keeps(**value)).count();
    let verdict = if keeping == values.len() {
        Verdict::Reproduces
    } else if limit.keeps(summary.mean) {
        Verdict::OnlyIf("the mean over participants is meant, not each of them".to_owned())
    } else {
        Verdict::DoesNot
    };
    let numbers = BTreeMap::from([
        ("limit".to_owned(), limit.value()),
        ("participants".to_owned(), values.len() as f64),
        ("keeping_the_limit".to_owned(), keeping as f64),
        ("mean".to_owned(), summary.mean),
        ("lowest".to_owned(), summary.min),
        ("highest".to_owned(), summary.max),
    ]);
    let ours = format!("{keeping} of {}; mean {}", values.len(), measure.write(summary.mean));
    let sentence = format!(
        "{} with {condition}: {keeping} of {} participants are {} {}; the mean is {}, the lowest {}, the highest {}.",
        measure.title(),
        values.len(),
        limit.word(),
        measure.write(limit.value()),
        measure.write(summary.mean),
        measure.write(summary.min),
        measure.write(summary.max)
    );
    Ok(Judgement { verdict, ours: Text::from(ours), sentence: Text::from(sentence), numbers })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::measure;

    fn crashes(rates: &[f64]) -> Judgement {
        let names = (0..rates.len()).map(|i| format!("P{i}")).collect();
        let rows = rates.iter().map(|rate| vec![*rate]).collect();
        let table = Table::complete(names, vec!["HIC".into()], rows).unwrap();
        every_participant(&table, measure("crash").unwrap(), "HIC", Limit::Above(0.8))
    }

    #[test]
    fn data_flip_the_verdict() {
        assert_eq!(crashes(&[0.85, 0.9, 0.975]).verdict, Verdict::Reproduces);
        let mean_only = crashes(&[0.8, 0.9, 0.975]);
        assert!(matches!(mean_only.verdict, Verdict::OnlyIf(_)), "exactly 0.8 is not above it");
        let sentence = "Crash rate with HIC: 2 of 3 participants are above 80.0\u{202f}%; the mean is 89.2\u{202f}%, the lowest \
                        80.0\u{202f}%, the highest 97.5\u{202f}%.";
        assert_eq!(mean_only.sentence.to_string(), sentence);
        assert_eq!(crashes(&[0.1, 0.9, 0.2]).verdict, Verdict::DoesNot);
        assert!(matches!(crashes(&[]).verdict, Verdict::CannotBeJudged(_)));
    }

    #[test]
    fn limits_from_above_too() {
        let table = Table::complete(vec!["P".into()], vec!["HIC".into()], vec![vec![0.01]]).unwrap();
        let judged = every_participant(&table, measure("success").unwrap(), "HIC", Limit::Below(0.05));
        assert_eq!(judged.verdict, Verdict::Reproduces);
        let unknown = every_participant(&table, measure("success").unwrap(), "MISC", Limit::Below(0.05));
        assert!(matches!(unknown.verdict, Verdict::CannotBeJudged(_)));
    }
}
