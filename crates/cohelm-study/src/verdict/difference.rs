//! "One condition is higher (or lower) than another."

use super::{Comparison, Judgement, LEVEL, Verdict};
use crate::apa;
use crate::statistics::{
    Paired, PairedT, Table, Undefined, bootstrap, effect_sizes, mean, one_way, paired_t, wilcoxon,
};
use crate::text::Text;
use std::collections::BTreeMap;

/// Which way a claimed difference points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// The condition has more of the measure than the one it is held against.
    Higher,
    /// It has less.
    Lower,
}

impl Direction {
    fn sign(self) -> f64 {
        match self {
            Direction::Higher => 1.0,
            Direction::Lower => -1.0,
        }
    }
}

/// Judges "in this measure, the condition is higher (lower) than the other, by more than `margin`".
///
/// Reproduces if the paired t test over participants' values finds a difference in that direction (two-sided p below
/// [`LEVEL`]) and, for a positive margin, the whole 95 % interval lies beyond it. Does not if the test finds none or the
/// opposite. The paper's one-way ANOVA and Wilcoxon's test are reported beside and decide nothing. A difference that is
/// the same in everybody needs no test.
pub fn difference_in_direction(comparison: &Comparison<'_>, direction: Direction, margin: f64) -> Judgement {
    judge(comparison, direction, margin).unwrap_or_else(|why| Judgement::cannot(&why))
}

fn judge(comparison: &Comparison<'_>, direction: Direction, margin: f64) -> Result<Judgement, Undefined> {
    if !(margin >= 0.0 && margin.is_finite()) {
        return Err(Undefined::OutOfRange {
            name: "the margin",
            expected: "zero or more",
            found: margin.to_string(),
        });
    }
    let pairs = comparison.pairs()?;
    let means = comparison.means(&pairs)?;
    let difference = mean(&pairs.differences())?;
    let mut numbers = BTreeMap::from([
        ("mean".to_owned(), means.0),
        ("mean_against".to_owned(), means.1),
        ("difference".to_owned(), difference),
        ("margin".to_owned(), margin),
    ]);
    let beyond = |value: f64| value * direction.sign() > margin;
    let headline = Text::from(comparison.headline(means)).plain(" ");
    let values = Text::from(comparison.values(means));
    let (reproduces, ours, sentence) = match paired_t(&pairs) {
        Ok(test) => {
            let nearest = if direction == Direction::Higher { test.ci95.low } else { test.ci95.high };
            let claimed_way = test.p < LEVEL && test.t * direction.sign() > 0.0;
            let reproduces = claimed_way && (margin == 0.0 || beyond(nearest));
            numbers.extend([
                ("t".to_owned(), test.t),
                ("p".to_owned(), test.p),
                ("df".to_owned(), test.df as f64),
            ]);
            let finding =
                finding(comparison, &test, claimed_way, (margin > 0.0).then_some((margin, reproduces)));
            let sentence = finding.plain(" ").then(beside(comparison, &pairs, &mut numbers));
            (reproduces, values.plain("; ").then(apa::p_value(test.p)), sentence)
        }
        Err(Undefined::NoErrorVariation | Undefined::NoDifference) => {
            let written = comparison.measure.write_difference(difference);
            let sentence =
                format!("The difference is {written} in every one of {} participants.", pairs.len());
            (beyond(difference), values, Text::from(sentence))
        }
        Err(why) => return Err(why),
    };
    let verdict = if reproduces { Verdict::Reproduces } else { Verdict::DoesNot };
    Ok(Judgement { verdict, ours, sentence: headline.then(sentence), numbers })
}

/// "Within participants the difference of −6.8, 95 % CI [−11.9, −1.7], is significant and in the claimed direction,
/// *t*(9) = −3.01, *p* = .015." `margin` is the claimed one, if any, with whether the interval lies beyond it.
fn finding(
    comparison: &Comparison<'_>,
    test: &PairedT,
    claimed_way: bool,
    margin: Option<(f64, bool)>,
) -> Text {
    let measure = comparison.measure;
    let asked = |margin: f64| measure.write_difference(margin);
    let found = match (claimed_way, margin) {
        (false, _) if test.p < LEVEL => "is significant, but in the opposite direction".to_owned(),
        (false, _) => "is not significant".to_owned(),
        (true, None) => "is significant and in the claimed direction".to_owned(),
        (true, Some((margin, true))) => {
            format!("is significant, in the claimed direction and beyond the {} asked for", asked(margin))
        }
        (true, Some((margin, false))) => {
            format!(
                "is significant and in the claimed direction, but not beyond the {} asked for",
                asked(margin)
            )
        }
    };
    let difference = measure.write_difference(test.mean_difference);
    let interval = apa::interval(&test.ci95, |end| measure.difference_end(end), measure.difference_unit());
    Text::from(format!("Within participants the difference of {difference}, {interval}, {found}, "))
        .then(apa::paired_t(test))
        .plain(".")
}

/// Effect size, Wilcoxon's test and the paper's one-way ANOVA, as far as they exist.
fn beside(comparison: &Comparison<'_>, pairs: &Paired, numbers: &mut BTreeMap<String, f64>) -> Text {
    let mut parts = Vec::new();
    if let Ok(d) = bootstrap::effect_size(pairs, bootstrap::Options::default()) {
        numbers.insert("d_av".to_owned(), d.estimate);
        parts.push(Text::from("Effect size ").then(apa::effect_size(&d)));
    } else if let Ok(d) = effect_sizes(pairs) {
        numbers.insert("d_av".to_owned(), d.d_av);
    }
    if let Ok(w) = wilcoxon(&pairs.snapped()) {
        numbers.insert("wilcoxon_p".to_owned(), w.p);
        parts.push(Text::from("Wilcoxon ").then(apa::wilcoxon(&w)));
    }
    if let Ok(f) = two_columns(comparison).and_then(|table| one_way(&table)) {
        numbers.extend([("one_way_f".to_owned(), f.f), ("one_way_p".to_owned(), f.p)]);
        parts.push(Text::from("one-way ANOVA as in the paper ").then(apa::one_way(&f)));
    }
    let count = parts.len();
    parts
        .into_iter()
        .enumerate()
        .fold(Text::new(), |text, (i, part)| text.then(part).plain(if i + 1 == count { "." } else { "; " }))
}

/// The table of the two conditions alone, as the paper's ANOVA compares them.
fn two_columns(comparison: &Comparison<'_>) -> Result<Table, Undefined> {
    let pairs = comparison.pairs()?;
    let rows = pairs.a().iter().zip(pairs.b()).map(|(a, b)| vec![*a, *b]).collect();
    let conditions = vec![comparison.condition.to_owned(), comparison.against.to_owned()];
    Table::complete(comparison.table.participants().to_vec(), conditions, rows)
        .map_err(|_| Undefined::NotFinite)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::measure;

    fn table(misc: &[f64], lasc: &[f64]) -> Table {
        let names = (0..misc.len()).map(|i| format!("P{i}")).collect();
        let rows = misc.iter().zip(lasc).map(|(m, l)| vec![*m, *l]).collect();
        Table::complete(names, vec!["MISC".into(), "LASC".into()], rows).unwrap()
    }

    fn fewer_steps(table: &Table, margin: f64) -> Judgement {
        let steps = measure("steps").unwrap();
        let comparison = Comparison { table, measure: steps, condition: "MISC", against: "LASC" };
        difference_in_direction(&comparison, Direction::Lower, margin)
    }

    const LASC: [f64; 6] = [240.0, 250.0, 235.0, 260.0, 244.0, 238.0];

    #[test]
    fn data_flip_the_verdict() {
        let misc =
            |by: f64| -> Vec<f64> { LASC.iter().enumerate().map(|(i, l)| l + by + (i % 3) as f64).collect() };
        assert_eq!(fewer_steps(&table(&misc(-12.0), &LASC), 0.0).verdict, Verdict::Reproduces);
        assert_eq!(fewer_steps(&table(&misc(-1.0), &LASC), 0.0).verdict, Verdict::DoesNot);
        let opposite = fewer_steps(&table(&misc(9.0), &LASC), 0.0);
        assert_eq!(opposite.verdict, Verdict::DoesNot);
        assert!(opposite.sentence.to_string().contains("is significant, but in the opposite direction, t"));
        assert!(matches!(fewer_steps(&table(&[1.0], &[2.0]), 0.0).verdict, Verdict::CannotBeJudged(_)));
    }

    #[test]
    fn a_margin_must_lie_below_the_whole_interval() {
        let misc: Vec<f64> = LASC.iter().enumerate().map(|(i, l)| l - 12.0 + (i % 3) as f64).collect();
        let table = table(&misc, &LASC);
        assert_eq!(fewer_steps(&table, 5.0).verdict, Verdict::Reproduces);
        assert_eq!(fewer_steps(&table, 10.9).verdict, Verdict::DoesNot);
        assert!(matches!(fewer_steps(&table, -1.0).verdict, Verdict::CannotBeJudged(_)));
        assert!(fewer_steps(&table, 5.0).sentence.to_string().contains("and beyond the 5.0 asked for"));
        assert!(fewer_steps(&table, 10.9).sentence.to_string().contains("but not beyond the 10.9 asked for"));
    }

    #[test]
    fn the_sentence_is_as_one_reports_it() {
        let misc: Vec<f64> = LASC.iter().enumerate().map(|(i, l)| l - 12.0 + (i % 3) as f64).collect();
        let judged = fewer_steps(&table(&misc, &LASC), 0.0);
        let sentence = judged.sentence.to_string().replace('\u{a0}', " ");
        let beginning = "Steps: MISC 233.5, LASC 244.5. Within participants the difference of −11.0, 95\u{202f}% CI \
                         [−11.9, −10.1], is significant and in the claimed direction, t(5) = −30.12, p < .001. Effect \
                         size dav = −1.2";
        assert!(sentence.starts_with(beginning), "{sentence}");
        let end = "Wilcoxon W = 0, p = .031 (exact, with ties), r = −1.00; one-way ANOVA as in the paper F(1, 10) = ";
        assert!(sentence.contains(end), "{sentence}");
        assert_eq!(judged.ours.to_string().replace('\u{a0}', " "), "MISC 233.5, LASC 244.5; p < .001");
        assert!(sentence.ends_with('.'));
        let keys = [
            "d_av",
            "df",
            "difference",
            "margin",
            "mean",
            "mean_against",
            "one_way_f",
            "one_way_p",
            "p",
            "t",
            "wilcoxon_p",
        ];
        assert_eq!(judged.numbers.keys().collect::<Vec<_>>(), keys);
    }

    #[test]
    fn the_same_difference_in_everybody_needs_no_test() {
        let shifted: Vec<f64> = LASC.iter().map(|l| l - 3.0).collect();
        let judged = fewer_steps(&table(&shifted, &LASC), 0.0);
        assert_eq!(judged.verdict, Verdict::Reproduces);
        assert!(
            judged.sentence.to_string().ends_with("The difference is −3.0 in every one of 6 participants.")
        );
        assert_eq!(fewer_steps(&table(&LASC, &LASC), 0.0).verdict, Verdict::DoesNot);
    }

    #[test]
    fn an_unknown_condition_cannot_be_judged() {
        let table = table(&LASC, &LASC);
        let comparison = Comparison {
            table: &table,
            measure: measure("steps").unwrap(),
            condition: "HIC",
            against: "LASC",
        };
        let judged = difference_in_direction(&comparison, Direction::Lower, 0.0);
        assert_eq!(judged.sentence.to_string(), "There is no condition \"HIC\" in the table.");
    }
}
