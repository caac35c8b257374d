//! The tables that every report of a measure needs: its numbers in each condition, and the conditions compared.

use super::{Align, Table as Printed};
use crate::analysis::Outcome;
use crate::apa;
use crate::measures::{Measure, Range};
use crate::statistics::{PairOfConditions, Table, Undefined, describe};
use crate::text::Text;

/// Mean with 95 % interval, standard deviation, median, quartiles and interquartile mean of a measure in each condition.
pub fn summary(measure: &Measure<'_>, table: &Table) -> Printed {
    let heads =
        ["Mode", "n", "Mean", "95\u{202f}% interval", "SD", "Median", "Quartiles", "IQM"].map(Text::from);
    let mut rows = Vec::new();
    for (condition, column) in table.conditions().iter().zip(table.columns()) {
        let mut row = vec![Text::from(condition.as_str())];
        match describe(&column) {
            Ok(s) => row.extend(
                [
                    s.n.to_string(),
                    measure.write(s.mean),
                    s.mean_ci95.map_or_else(dash, |ci| ends(measure, ci.low, ci.high)),
                    s.sd.map_or_else(dash, |sd| measure.write(sd)),
                    measure.write(s.median),
                    ends(measure, s.q1, s.q3),
                    measure.write(s.iqm),
                ]
                .map(Text::from),
            ),
            Err(why) => row.push(apa::undefined(&why)),
        }
        rows.push(row);
    }
    Printed {
        caption: Text::from(format!("{} in each mode, over participants.", measure.title())),
        columns: columns(heads),
        rows,
        notes: vec![Text::from(format!(
            "Interval: Student’s t{}. SD: between participants. IQM: mean of the values between the quartiles.",
            if measure.range == Range::Unit { ", cut off where no value can lie" } else { "" }
        ))],
    }
}

/// Differences between conditions, tested within participants.
pub fn pairs(measure: &Measure<'_>, compared: &[PairOfConditions]) -> Printed {
    let equivalence = compared.iter().any(|c| c.equivalence.is_some());
    let mut heads = ["Modes", "Difference", "95\u{202f}% interval"].map(Text::from).to_vec();
    heads.extend([
        Text::new().em("t"),
        Text::new().em("p").plain(" (Holm)"),
        Text::from("Wilcoxon ").em("p"),
        Text::new().em("d").plain(" [95\u{202f}%]"),
    ]);
    heads.extend(equivalence.then(|| Text::from("TOST ").em("p")));
    let rows = compared.iter().map(|pair| {
        let mut row = vec![Text::from(format!("{} − {}", pair.first, pair.second))];
        row.extend(differences(measure, pair));
        row.push(pair.wilcoxon.as_ref().map_or_else(|_| Text::from(dash()), |w| bare_p(w.p)));
        row.push(pair.effect.as_ref().map_or_else(
            |_| Text::from(dash()),
            |d| {
                Text::from(format!(
                    "{} {}",
                    apa::number(d.estimate, 2),
                    brackets(d.interval.low, d.interval.high)
                ))
            },
        ));
        row.extend(
            pair.equivalence
                .as_ref()
                .map(|t| t.as_ref().map_or_else(|_| Text::from(dash()), |t| bare_p(t.p))),
        );
        row
    });
    let unit = measure.difference_unit().trim();
    let unit = if unit.is_empty() { String::new() } else { format!(", in percentage {unit}") };
    Printed {
        caption: Text::from(format!(
            "{}: differences between modes within participants{unit}.",
            measure.title()
        )),
        columns: columns(heads),
        rows: rows.collect(),
        notes: vec![Text::from(
            "Paired t tests, p adjusted by Holm over the pairs of this table. d: mean difference over the root mean square \
                        of both standard deviations, with its bootstrap interval. –: no test exists, see the text.",
        )],
    }
}

fn differences(measure: &Measure<'_>, pair: &PairOfConditions) -> [Text; 4] {
    match &pair.t {
        Ok(t) => [
            Text::from(measure.difference(t.mean_difference)),
            Text::from(format!(
                "[{}, {}]",
                measure.difference_end(t.ci95.low),
                measure.difference_end(t.ci95.high)
            )),
            Text::from(apa::number(t.t, 2)),
            pair.p_holm.map_or_else(|| Text::from(dash()), bare_p),
        ],
        Err(_) => [dash(), dash(), dash(), dash()].map(Text::from),
    }
}

/// A row an outcome: is there any difference between the conditions, by three tests.
pub fn any_difference(outcomes: &[&Outcome], caption: &str) -> Printed {
    let one = |letter: &str| Text::new().em(letter);
    let heads = vec![
        Text::from("Measure"),
        Text::from("Modes"),
        one("F").plain(" within"),
        one("p"),
        Text::from("η").lowered("p").raised("2"),
        Text::from("Friedman χ").raised("2"),
        one("p"),
        one("F").plain(" one-way (the paper’s)"),
        one("p"),
    ];
    let mut reasons: Vec<String> = Vec::new();
    let rows = outcomes.iter().map(|outcome| difference_row(outcome, &mut reasons)).collect();
    let mut notes = vec![Text::from(
        "Within: repeated-measures ANOVA, degrees of freedom and p after Greenhouse and Geisser from three modes on. Friedman: \
         needs three modes. One-way: takes the modes for different people. p values are not adjusted over the rows.",
    )];
    let numbered = |(i, why): (usize, &String)| {
        Text::new().raised(letter(i)).plain(format!(" {}.", crate::text::capitalised(why)))
    };
    notes.extend(reasons.iter().enumerate().map(numbered));
    Printed { caption: Text::from(caption), columns: columns(heads), rows, notes }
}

fn difference_row(outcome: &Outcome, reasons: &mut Vec<String>) -> Vec<Text> {
    let mut row =
        vec![Text::from(outcome.quantity.measure().title()), Text::from(outcome.names().len().to_string())];
    let degrees = |a: f64, b: f64| {
        let decimals = usize::from(a.fract() != 0.0 || b.fract() != 0.0);
        format!("({},\u{a0}{})", apa::number(a, decimals), apa::number(b, decimals))
    };
    let ratio = |df: String, f: f64| Text::from(format!("{df}\u{a0}{}", apa::number(f, 2)));
    match &outcome.anova {
        Ok(test) => {
            let epsilon = test.sphericity.as_ref().map_or(1.0, |s| s.epsilon);
            let p = test.sphericity.as_ref().map_or(test.p, |s| s.p_corrected);
            let df = degrees(epsilon * test.df_effect as f64, epsilon * test.df_error as f64);
            row.extend([ratio(df, test.f), bare_p(p), Text::from(apa::fraction(test.partial_eta2, 2))]);
        }
        Err(why) => row.extend([footnote(why, reasons), Text::from(dash()), Text::from(dash())]),
    }
    match &outcome.friedman {
        _ if outcome.names().len() == 2 => row.extend([dash(), dash()].map(Text::from)),
        Ok(test) => row.extend([Text::from(apa::number(test.chi2, 2)), bare_p(test.p)]),
        Err(why) => row.extend([footnote(why, reasons), Text::from(dash())]),
    }
    match &outcome.one_way {
        Ok(test) => {
            let df = degrees(test.df_between as f64, test.df_within as f64);
            row.extend([ratio(df, test.f), bare_p(test.p)]);
        }
        Err(why) => row.extend([footnote(why, reasons), Text::from(dash())]),
    }
    row
}

/// A dash with a raised letter that leads to the reason below the table.
fn footnote(why: &Undefined, reasons: &mut Vec<String>) -> Text {
    let why = why.to_string();
    let index = reasons.iter().position(|known| *known == why).unwrap_or_else(|| {
        reasons.push(why);
        reasons.len() - 1
    });
    Text::from(dash()).raised(letter(index))
}

/// a, b, c, …; beyond z the reasons share the last.
fn letter(index: usize) -> String {
    char::from(b'a' + index.min(25) as u8).to_string()
}

fn columns(heads: impl IntoIterator<Item = Text>) -> Vec<(Text, Align)> {
    let align = |i: usize| if i == 0 { Align::Left } else { Align::Right };
    heads.into_iter().enumerate().map(|(i, head)| (head, align(i))).collect()
}

/// An interval; Student's t knows nothing of the ends of a scale, so of a share it is cut off there.
fn ends(measure: &Measure<'_>, low: f64, high: f64) -> String {
    let (low, high) = if measure.range == Range::Unit { (low.max(0.0), high.min(1.0)) } else { (low, high) };
    format!("[{}, {}]", measure.write(low), measure.write(high))
}

fn brackets(low: f64, high: f64) -> String {
    format!("[{}, {}]", apa::number(low, 2), apa::number(high, 2))
}

/// A p value without its letter, which the head of the column has.
fn bare_p(p: f64) -> Text {
    let text = apa::p_value(p).to_string();
    Text::from(text.trim_start_matches(['p', '\u{a0}', '=']).to_owned())
}

fn dash() -> String {
    "–".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::measure;
    use crate::statistics::{bootstrap, pairwise};

    fn table(rows: Vec<Vec<f64>>) -> Table {
        let names = |prefix: &str, count: usize| (1..=count).map(|i| format!("{prefix}{i}")).collect();
        Table::complete(names("P", rows.len()), names("M", 2), rows).unwrap()
    }

    fn texts(printed: &Printed) -> Vec<Vec<String>> {
        printed.rows.iter().map(|row| row.iter().map(Text::to_string).collect()).collect()
    }

    #[test]
    fn a_row_a_condition_with_shares_as_percent() {
        let printed = summary(measure("success").unwrap(), &table(vec![vec![0.5, 0.75], vec![0.7, 0.75]]));
        let expected = ["M1", "2", "60.0\u{202f}%", "[0.0\u{202f}%, 100.0\u{202f}%]", "14.1\u{202f}%"];
        assert_eq!(texts(&printed)[0][..5], expected);
        assert_eq!(printed.columns.len(), texts(&printed)[1].len());
    }

    #[test]
    fn pairs_are_written_or_dashed() {
        let options = bootstrap::Options { resamples: 100, ..Default::default() };
        let steps = measure("steps").unwrap();
        let differing = table(vec![vec![1.0, 2.0], vec![2.0, 2.5], vec![4.0, 4.2], vec![3.0, 5.0]]);
        let printed = pairs(steps, &pairwise(&differing, Some(0.5), options));
        let row = &texts(&printed)[0];
        assert_eq!(row.len(), printed.columns.len());
        assert_eq!(row[..5], ["M1 − M2", "−0.9", "[−2.2, 0.3]", "−2.34", ".10"]);
        let same = pairs(steps, &pairwise(&table(vec![vec![1.0, 1.0], vec![2.0, 2.0]]), None, options));
        assert_eq!(texts(&same)[0][1..5], ["–", "–", "–", "–"]);
    }

    #[test]
    fn nobody_measured_gets_a_reason() {
        let printed = summary(measure("steps").unwrap(), &table(vec![]));
        assert_eq!(texts(&printed)[0][1], "[no test: a summary needs one or more values, and there are 0]");
    }
}
