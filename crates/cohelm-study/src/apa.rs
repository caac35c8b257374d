//! Statistics as one reports them, after the seventh edition of the APA manual: *F*(1, 18) = 8.65, *p* = .009.

use crate::statistics::{
    Friedman, Interval, OneWay, PairedT, RepeatedMeasures, Tost, Undefined, Wilcoxon, WilcoxonMethod,
    bootstrap,
};
use crate::text::Text;

/// A number with fixed decimals and a true minus sign; never "−0.00".
pub fn number(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let zero = digits.bytes().all(|b| matches!(b, b'0' | b'.'));
    if value < 0.0 && !zero { format!("−{digits}") } else { digits }
}

/// A number that cannot exceed one, without the leading zero: `.83`, `−.20`, `1.00`.
pub fn fraction(value: f64, decimals: usize) -> String {
    let text = number(value, decimals);
    match text.strip_prefix("−0.").or(text.strip_prefix("0.")) {
        Some(digits) if value < 0.0 && text.starts_with('−') => format!("−.{digits}"),
        Some(digits) => format!(".{digits}"),
        None => text,
    }
}

/// A share as percent with one decimal: `85.5 %` with a narrow space.
pub fn percent(share: f64, decimals: usize) -> String {
    format!("{}\u{202f}%", number(100.0 * share, decimals))
}

/// *p* = .012, *p* = .83, *p* < .001: two decimals above .10, three below.
pub fn p_value(p: f64) -> Text {
    let text = if p < 0.001 {
        unbroken(" < .001")
    } else if p > 0.995 {
        unbroken(" > .99")
    } else {
        unbroken(&format!(" = {}", fraction(p, if p < 0.0995 { 3 } else { 2 })))
    };
    Text::new().em("p").plain(text)
}

/// `95 % CI [−1.20, 3.40]`, ends written by `write`, with `unit` behind.
pub fn interval(interval: &Interval, write: impl Fn(f64) -> String, unit: &str) -> String {
    let level = number(interval.level * 100.0, 0);
    unbroken(&format!("{level}\u{202f}% CI [{}, {}]{unit}", write(interval.low), write(interval.high)))
}

/// *F*(1, 18) = 8.65, *p* = .009, η² = .32.
pub fn one_way(test: &OneWay) -> Text {
    f_ratio(test.f, &test.df_between.to_string(), &test.df_within.to_string(), test.p)
        .plain(", η")
        .raised("2")
        .plain(equals(fraction(test.eta2, 2)))
}

/// *F*(2, 18) = 5.31, *p* = .015, ηp² = .37; with Greenhouse–Geisser's degrees of freedom and p from three conditions on.
pub fn repeated_measures(test: &RepeatedMeasures) -> Text {
    let text = match &test.sphericity {
        None => f_ratio(test.f, &test.df_effect.to_string(), &test.df_error.to_string(), test.p),
        Some(s) => {
            let df = |df: usize| number(s.epsilon * df as f64, 2);
            f_ratio(test.f, &df(test.df_effect), &df(test.df_error), s.p_corrected)
                .plain(format!(" (Greenhouse–Geisser ε{})", equals(fraction(s.epsilon, 2))))
        }
    };
    text.plain(", η").lowered("p").raised("2").plain(equals(fraction(test.partial_eta2, 2)))
}

fn f_ratio(f: f64, df1: &str, df2: &str, p: f64) -> Text {
    Text::new()
        .em("F")
        .plain(unbroken(&format!("({df1}, {df2}) = {}", number(f, 2))))
        .plain(", ")
        .then(p_value(p))
}

/// *t*(9) = 2.31, *p* = .046.
pub fn paired_t(test: &PairedT) -> Text {
    let t = unbroken(&format!("({}) = {}", test.df, number(test.t, 2)));
    Text::new().em("t").plain(t).plain(", ").then(p_value(test.p))
}

/// *W* = 12, *p* = .13 (exact), *r* = −.42.
pub fn wilcoxon(test: &Wilcoxon) -> Text {
    let decimals = if test.w.fract() == 0.0 { 0 } else { 1 };
    let how = match test.method {
        WilcoxonMethod::Exact => "exact",
        WilcoxonMethod::Permutation => "exact, with ties",
        WilcoxonMethod::Normal => "normal approximation",
    };
    Text::new()
        .em("W")
        .plain(equals(number(test.w, decimals)))
        .plain(", ")
        .then(p_value(test.p))
        .plain(format!(" ({how}), "))
        .em("r")
        .plain(equals(fraction(test.rank_biserial, 2)))
}

/// χ²(2) = 9.50, *p* = .009, Kendall's *W* = .40.
pub fn friedman(test: &Friedman) -> Text {
    Text::from("χ")
        .raised("2")
        .plain(unbroken(&format!("({}) = {}", test.df, number(test.chi2, 2))))
        .plain(", ")
        .then(p_value(test.p))
        .plain(", Kendall’s ")
        .em("W")
        .plain(equals(fraction(test.kendall_w, 2)))
}

/// TOST *p* = .012, 90 % CI [−2.1, 1.3] points.
pub fn tost(test: &Tost, write: impl Fn(f64) -> String, unit: &str) -> Text {
    Text::from("TOST ").then(p_value(test.p)).plain(", ").plain(interval(&test.ci90, write, unit))
}

/// *d*av = 0.45, 95 % CI [0.10, 0.90].
pub fn effect_size(d_av: &bootstrap::Bootstrapped) -> Text {
    Text::new().em("d").lowered("av").plain(equals(number(d_av.estimate, 2))).plain(", ").plain(interval(
        &d_av.interval,
        |end| number(end, 2),
        "",
    ))
}

/// What to print where a test does not exist: the reason in brackets.
pub fn undefined(why: &Undefined) -> Text {
    Text::from(format!("[no test: {why}]"))
}

fn equals(value: String) -> String {
    format!("\u{a0}=\u{a0}{value}")
}

/// A statistic is not to be torn apart at the end of a line.
fn unbroken(text: &str) -> String {
    text.replace(' ', "\u{a0}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{Sphericity, Table, repeated_measures as rm};

    /// Plain text with ordinary spaces.
    fn words(text: Text) -> String {
        text.to_string().replace('\u{a0}', " ")
    }

    #[test]
    fn the_papers_own_numbers() {
        let test = |f, p| OneWay { f, p, df_between: 1, df_within: 18, eta2: 0.3246 };
        assert_eq!(words(one_way(&test(8.65, 0.0087))), "F(1, 18) = 8.65, p = .009, η² = .32");
        assert!(words(one_way(&test(0.05, 0.8265))).contains("F(1, 18) = 0.05, p = .83"));
    }

    #[test]
    fn p_values_at_their_ends() {
        let p = |p| words(p_value(p));
        assert_eq!([p(0.0), p(0.0004), p(0.001), p(0.0996)], ["p < .001", "p < .001", "p = .001", "p = .10"]);
        assert_eq!([p(0.05), p(0.994), p(1.0)], ["p = .050", "p = .99", "p > .99"]);
    }

    #[test]
    fn numbers_have_true_signs_and_no_negative_zero() {
        assert_eq!([number(-1.256, 2), number(-0.001, 2), fraction(-0.2, 2)], ["−1.26", "0.00", "−.20"]);
        assert_eq!(
            [fraction(1.0, 2), fraction(0.0, 2), percent(0.8555, 1)],
            ["1.00", ".00", "85.5\u{202f}%"]
        );
    }

    #[test]
    fn corrected_degrees_of_freedom_from_three_conditions_on() {
        let names = |n: usize| (0..n).map(|i| i.to_string()).collect();
        let rows = vec![vec![1.0, 2.0, 4.0], vec![2.0, 2.5, 3.0], vec![1.5, 3.0, 4.5], vec![1.0, 1.0, 3.5]];
        let mut test = rm(&Table::complete(names(4), names(3), rows).unwrap()).unwrap();
        test.sphericity = Some(Sphericity { epsilon: 0.75, ..test.sphericity.unwrap() });
        let text = words(repeated_measures(&test));
        assert!(
            text.starts_with("F(1.50, 4.50) = ") && text.contains("(Greenhouse–Geisser ε = .75), ηp² = ."),
            "{text}"
        );
    }
}
