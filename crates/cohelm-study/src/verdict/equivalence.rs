//! "Two conditions are the same."

use super::{Comparison, Judgement, LEVEL, Verdict};
use crate::apa;
use crate::statistics::{Undefined, mean, paired_t, tost};
use crate::text::Text;
use std::collections::BTreeMap;

/// Judges "in this measure, both conditions are the same up to ± `bound`".
///
/// Reproduces if two one-sided paired t tests reject every difference beyond the bound (p below [`LEVEL`]). Does not if
/// the conditions differ significantly and are not equivalent. If neither is shown, the data are too few to tell: a large
/// p of a difference test, on which the paper rests its sameness, is no proof of it. A difference that is the same in
/// everybody needs no test.
pub fn equivalent_within(comparison: &Comparison<'_>, bound: f64) -> Judgement {
    judge(comparison, bound).unwrap_or_else(|why| Judgement::cannot(&why))
}

fn judge(comparison: &Comparison<'_>, bound: f64) -> Result<Judgement, Undefined> {
    let pairs = comparison.pairs()?;
    let means = comparison.means(&pairs)?;
    let difference = mean(&pairs.differences())?;
    let mut numbers = BTreeMap::from([
        ("mean".to_owned(), means.0),
        ("mean_against".to_owned(), means.1),
        ("difference".to_owned(), difference),
        ("bound".to_owned(), bound),
    ]);
    let measure = comparison.measure;
    let headline = Text::from(comparison.headline(means)).plain(" ");
    let values = Text::from(comparison.values(means));
    let written = measure.write_difference(difference);
    let same = match tost(&pairs, bound) {
        Ok(same) => same,
        Err(Undefined::NoErrorVariation | Undefined::NoDifference) => {
            let verdict = if difference.abs() < bound { Verdict::Reproduces } else { Verdict::DoesNot };
            let text = format!("The difference is {written} in every one of {} participants.", pairs.len());
            return Ok(Judgement { verdict, ours: values, sentence: headline.plain(text), numbers });
        }
        Err(why) => return Err(why),
    };
    let differ = paired_t(&pairs)?;
    numbers.extend([
        ("tost_p".to_owned(), same.p),
        ("t".to_owned(), differ.t),
        ("p".to_owned(), differ.p),
        ("df".to_owned(), differ.df as f64),
    ]);
    let bound = measure.write_difference(bound);
    let (verdict, meaning) = match (same.p < LEVEL, differ.p < LEVEL) {
        (true, false) => (Verdict::Reproduces, format!("They are equivalent within ±{bound}")),
        (true, true) => (Verdict::Reproduces, format!("They differ, but by less than ±{bound}")),
        (false, true) => (Verdict::DoesNot, format!("They differ, and are not equivalent within ±{bound}")),
        (false, false) => (
            Verdict::CannotBeJudged("neither a difference nor equivalence is shown".to_owned()),
            format!(
                "Neither a difference nor equivalence within ±{bound} is shown: it takes more participants or episodes to tell"
            ),
        ),
    };
    let sentence = Text::from(format!("{meaning}: the difference is {written}, "))
        .then(apa::tost(&same, |end| measure.difference_end(end), measure.difference_unit()))
        .plain("; the test of a difference gives ")
        .then(apa::paired_t(&differ))
        .plain(".");
    Ok(Judgement {
        verdict,
        ours: values.plain("; TOST ").then(apa::p_value(same.p)),
        sentence: headline.then(sentence),
        numbers,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::measure;
    use crate::statistics::Table;

    const LASC: [f64; 6] = [0.85, 0.9, 0.875, 0.8, 0.925, 0.85];

    fn same_success(differences: [f64; 6], bound: f64) -> Judgement {
        let names = (0..6).map(|i| format!("P{i}")).collect();
        let rows = LASC.iter().zip(differences).map(|(l, d)| vec![l + d, *l]).collect();
        let table = Table::complete(names, vec!["MISC".into(), "LASC".into()], rows).unwrap();
        let success = measure("success").unwrap();
        equivalent_within(
            &Comparison { table: &table, measure: success, condition: "MISC", against: "LASC" },
            bound,
        )
    }

    #[test]
    fn data_flip_the_verdict() {
        let close = same_success([0.01, -0.01, 0.0, 0.01, -0.02, 0.0], 0.05);
        assert_eq!(close.verdict, Verdict::Reproduces);
        let sentence = close.sentence.to_string().replace('\u{a0}', " ");
        let beginning = "Success rate: MISC 86.5\u{202f}%, LASC 86.7\u{202f}%. They are equivalent within ±5.0 points: the \
                         difference is −0.2 points, TOST p < .001, 90\u{202f}% CI [−1.1, 0.8] points; the test of a";
        assert!(sentence.starts_with(beginning), "{sentence}");
        let apart = same_success([0.08, 0.1, 0.09, 0.11, 0.07, 0.1], 0.05);
        assert_eq!(apart.verdict, Verdict::DoesNot);
        let unclear = same_success([0.1, -0.1, 0.05, -0.07, 0.12, -0.02], 0.05);
        assert!(matches!(unclear.verdict, Verdict::CannotBeJudged(_)));
        assert!(unclear.numbers["p"] > 0.05, "the paper would have called this the same");
        let small = same_success([0.02, 0.03, 0.02, 0.03, 0.02, 0.025], 0.05);
        assert_eq!(small.verdict, Verdict::Reproduces);
        assert!(small.sentence.to_string().contains("They differ, but by less than ±5.0"));
    }

    #[test]
    fn everybody_alike_needs_no_test() {
        assert_eq!(same_success([0.0; 6], 0.05).verdict, Verdict::Reproduces);
        assert_eq!(same_success([0.0625; 6], 0.05).verdict, Verdict::DoesNot);
        assert!(same_success([0.0; 6], 0.05).sentence.to_string().contains("in every one of 6 participants"));
    }

    #[test]
    fn a_senseless_bound_cannot_be_judged() {
        assert!(matches!(
            same_success([0.01, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0).verdict,
            Verdict::CannotBeJudged(_)
        ));
    }
}
