//! Tests in sentences.

use crate::analysis::{Outcome, Quantity};
use crate::apa;
use crate::statistics::{PairOfConditions, PairedT, mean};
use crate::text::{Text, capitalised};

/// "A, B and C".
pub(super) fn listed<T: AsRef<str>>(names: &[T]) -> String {
    match names {
        [] => "nothing".to_owned(),
        [one] => one.as_ref().to_owned(),
        [first @ .., last] => {
            let first: Vec<&str> = first.iter().map(AsRef::as_ref).collect();
            format!("{} and {}", first.join(", "), last.as_ref())
        }
    }
}

/// "The success rate differed between hic, lasc and misc, F(…) = …", or, of two modes, which has more: the test within
/// participants, in words.
pub(super) fn difference(outcome: &Outcome, alpha: f64) -> Text {
    if let [pair] = outcome.pairs.as_slice() {
        return two(outcome, pair, alpha);
    }
    let name = name_of(&outcome.quantity);
    let modes = listed(outcome.names());
    match &outcome.anova {
        Ok(test) => {
            let p = test.sphericity.as_ref().map_or(test.p, |s| s.p_corrected);
            let verb = if p < alpha { "differed" } else { "did not differ significantly" };
            Text::from(format!("{} {verb} between {modes}, ", capitalised(&name)))
                .then(apa::repeated_measures(test))
                .plain(".")
        }
        Err(why) => Text::from(format!(
            "Whether {name} differed between {modes} cannot be tested by analysis of variance: {why}."
        )),
    }
}

fn two(outcome: &Outcome, pair: &PairOfConditions, alpha: f64) -> Text {
    let (measure, name) = (outcome.quantity.measure(), name_of(&outcome.quantity));
    let means: Vec<f64> = outcome.table.columns().iter().filter_map(|column| mean(column).ok()).collect();
    let (Ok(t), [first, second]) = (&pair.t, means.as_slice()) else {
        let why = pair.t.as_ref().err().map_or_else(String::new, ToString::to_string);
        let modes = listed(outcome.names());
        return Text::from(format!("Whether {name} differed between {modes} cannot be tested: {why}."));
    };
    let (more, less, high, low) = if first >= second {
        (&pair.first, &pair.second, first, second)
    } else {
        (&pair.second, &pair.first, second, first)
    };
    let by = measure.write_difference(t.mean_difference.abs());
    // The sentence names the larger first, so the statistic has to be that of larger minus smaller.
    let t = PairedT { t: t.t.abs(), ..*t };
    let opening = if t.p < alpha {
        format!(
            "{} {} higher under {more}",
            capitalised(&name),
            if is_plural(&name) { "were" } else { "was" }
        )
    } else {
        format!("{} did not differ significantly between {more}", capitalised(&name))
    };
    let joint = if t.p < alpha { "than under" } else { "and" };
    Text::from(format!(
        "{opening} ({}) {joint} {less} ({}), a difference of {by}, ",
        measure.write(*high),
        measure.write(*low)
    ))
    .then(apa::paired_t(&t))
    .plain(".")
}

fn is_plural(name: &str) -> bool {
    !name.starts_with("the ")
}

/// A quantity within a sentence: "the success rate", "steps", "the score nasa-tlx".
pub(super) fn name_of(quantity: &Quantity) -> String {
    let name = &quantity.name;
    let plural = name.ends_with('s') || name.starts_with("ticks") || name.starts_with("steps");
    let score = matches!(quantity.source, crate::analysis::Source::Score { .. });
    if plural && !score { name.clone() } else { format!("the {name}") }
}

/// The test that ranks, as one reports it; nothing for two modes, where Wilcoxon's test stands in its place.
pub(super) fn friedman(outcome: &Outcome) -> Text {
    match &outcome.friedman {
        _ if outcome.names().len() == 2 => Text::new(),
        Ok(test) => Text::from(" Friedman’s test of the ranks: ").then(apa::friedman(test)).plain("."),
        Err(why) => Text::from(format!(" No test of the ranks: {why}.")),
    }
}

/// The paper's test, named as such.
pub(super) fn one_way(outcome: &Outcome) -> Text {
    match &outcome.one_way {
        Ok(test) => {
            Text::from(" The paper’s test, a one-way ANOVA that takes the modes for different people: ")
                .then(apa::one_way(test))
                .plain(".")
        }
        Err(why) => Text::from(format!(" The paper’s one-way ANOVA does not exist here: {why}.")),
    }
}

/// A pair of conditions in a sentence.
pub(super) fn pair(outcome: &Outcome, pair: &PairOfConditions, alpha: f64) -> Text {
    let measure = outcome.quantity.measure();
    let names = format!("{} − {}", pair.first, pair.second);
    let text = match &pair.t {
        Ok(t) => {
            let interval =
                apa::interval(&t.ci95, |end| measure.difference_end(end), measure.difference_unit());
            let text = Text::new()
                .strong(names)
                .plain(format!(": {}, {interval}, ", measure.write_difference(t.mean_difference)))
                .then(apa::paired_t(t));
            let text = match pair.p_holm.filter(|p| *p != t.p) {
                Some(p) => text.plain(" (adjusted by Holm: ").then(apa::p_value(p)).plain(")"),
                None => text,
            };
            match &pair.effect {
                Ok(effect) => text.plain(", ").then(apa::effect_size(effect)),
                Err(_) => text,
            }
        }
        Err(why) => Text::new().strong(names).plain(format!(": no paired t test, since {why}")),
    };
    let text = match &pair.wilcoxon {
        Ok(test) => text.plain("; Wilcoxon: ").then(apa::wilcoxon(test)),
        Err(_) => text,
    };
    equivalence(outcome, pair, alpha, text.plain("."))
}

fn equivalence(outcome: &Outcome, pair: &PairOfConditions, alpha: f64, text: Text) -> Text {
    let measure = outcome.quantity.measure();
    match (&pair.equivalence, outcome.bound) {
        (Some(Ok(test)), Some(bound)) => {
            let verdict = if test.p < alpha { "The two are equivalent" } else { "Equivalence is not shown" };
            text.plain(format!(" {verdict} within ±{}: ", measure.write_difference(bound)))
                .then(apa::tost(test, |end| measure.difference_end(end), measure.difference_unit()))
                .plain(".")
        }
        (Some(Err(why)), _) => text.plain(format!(" Equivalence cannot be tested: {why}.")),
        _ => text,
    }
}

/// Who has a gap and is in no test of this quantity.
pub(super) fn gaps(outcome: &Outcome) -> Option<Text> {
    if outcome.left_out.is_empty() {
        return None;
    }
    Some(Text::from(format!(
        "Not in these tests, since a value is missing in at least one mode: {}.",
        listed(&outcome.left_out)
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_read_as_sentences_do() {
        assert_eq!(listed(&["a"]), "a");
        assert_eq!(listed(&["a", "b"]), "a and b");
        assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
    }

    #[test]
    fn quantities_have_their_article() {
        let named = |key: &str| name_of(&Quantity::of_flights(key).unwrap());
        assert_eq!((named("success"), named("steps")), ("the success rate".into(), "steps".into()));
        assert_eq!(named("brier"), "the Brier score of the confidence");
    }
}
