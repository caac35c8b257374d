//! Analysis of variance over the columns of a table: as one should (repeated measures) and as the paper did (one-way).

use super::describe::{mean_of, sum_of_squares};
use super::distribution::f_upper_tail;
use super::sphericity::{Sphericity, sphericity};
use super::{Table, Undefined, require, rounding_of};
use serde::Serialize;

/// One-way ANOVA: the columns taken for groups of different people.
///
/// The paper's test (its p values are those of df (1, 18) for ten participants in two modes). It ignores that the same
/// people flew every mode and so throws away the strength of that design; reported for comparison, and named as such.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OneWay {
    /// Ratio of the mean squares between and within the columns.
    pub f: f64,
    /// Probability of an F this large if all columns had one mean.
    pub p: f64,
    /// Conditions − 1.
    pub df_between: usize,
    /// Values − conditions.
    pub df_within: usize,
    /// Share of the total variation that lies between columns, η² (here the same as partial η²).
    pub eta2: f64,
}

/// Repeated-measures ANOVA: do the conditions differ within the participants?
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepeatedMeasures {
    /// Ratio of the mean squares of condition and of condition × participant.
    pub f: f64,
    /// Probability of an F this large if all conditions had one mean and sphericity held.
    pub p: f64,
    /// Conditions − 1.
    pub df_effect: usize,
    /// (Conditions − 1)(participants − 1).
    pub df_error: usize,
    /// Generalised η² (Olejnik and Algina 2003): comparable between designs.
    pub generalised_eta2: f64,
    /// Partial η²: share of the variation left when participants' own levels are removed.
    pub partial_eta2: f64,
    /// What is to be corrected for unequal variances of the differences; `None` with two conditions, where it cannot arise.
    pub sphericity: Option<Sphericity>,
}

/// One-way ANOVA of the columns (`scipy.stats.f_oneway`).
///
/// # Errors
/// Fewer than two conditions or participants; no variation within the columns.
pub fn one_way(table: &Table) -> Result<OneWay, Undefined> {
    let parts = Parts::of(table, "a one-way ANOVA")?;
    let (df_between, df_within) = (parts.k - 1, parts.k * (parts.n - 1));
    let within = parts.participants + parts.error;
    let f = parts.f(df_between, within, df_within)?;
    let p = f_upper_tail(f, df_between as f64, df_within as f64);
    Ok(OneWay { f, p, df_between, df_within, eta2: parts.conditions / (parts.conditions + within) })
}

/// Repeated-measures ANOVA of the columns, with Greenhouse–Geisser and Mauchly from three conditions on
/// (`pingouin.rm_anova`).
///
/// # Errors
/// Fewer than two conditions or participants; no variation left once participants' levels are removed.
pub fn repeated_measures(table: &Table) -> Result<RepeatedMeasures, Undefined> {
    let parts = Parts::of(table, "a repeated-measures ANOVA")?;
    let df_effect = parts.k - 1;
    let df_error = df_effect * (parts.n - 1);
    let f = parts.f(df_effect, parts.error, df_error)?;
    Ok(RepeatedMeasures {
        f,
        p: f_upper_tail(f, df_effect as f64, df_error as f64),
        df_effect,
        df_error,
        generalised_eta2: parts.conditions / (parts.conditions + parts.participants + parts.error),
        partial_eta2: parts.conditions / (parts.conditions + parts.error),
        sphericity: (parts.k > 2).then(|| sphericity(table, f)),
    })
}

/// The sums of squares into which a complete table falls.
struct Parts {
    n: usize,
    k: usize,
    conditions: f64,
    participants: f64,
    error: f64,
    /// Sums of squares up to here are what rounding leaves.
    negligible: f64,
}

impl Parts {
    fn of(table: &Table, what: &'static str) -> Result<Self, Undefined> {
        let (n, k) = (table.rows().len(), table.conditions().len());
        require(what, "conditions", 2, k)?;
        require(what, "participants", 2, n)?;
        let row_means: Vec<f64> = table.rows().iter().map(|row| mean_of(row)).collect();
        let column_means: Vec<f64> = table.columns().iter().map(|column| mean_of(column)).collect();
        Ok(Parts {
            n,
            k,
            conditions: n as f64 * sum_of_squares(&column_means),
            participants: k as f64 * sum_of_squares(&row_means),
            error: residual_sum_of_squares(table, &row_means, &column_means),
            negligible: negligible_sum_of_squares(table),
        })
    }

    /// The F ratio of the conditions' mean square to that of `error`.
    fn f(&self, df_effect: usize, error: f64, df_error: usize) -> Result<f64, Undefined> {
        if error > self.negligible {
            return Ok((self.conditions / df_effect as f64) / (error / df_error as f64));
        }
        Err(if self.conditions > self.negligible {
            Undefined::NoErrorVariation
        } else {
            Undefined::NoVariation
        })
    }
}

/// Residuals are squared themselves instead of being got by subtraction, which would cost a small error term its digits.
fn residual_sum_of_squares(table: &Table, row_means: &[f64], column_means: &[f64]) -> f64 {
    let grand = mean_of(row_means);
    let mut sum = 0.0;
    for (row, row_mean) in table.rows().iter().zip(row_means) {
        for (value, column_mean) in row.iter().zip(column_means) {
            let residual = (value - row_mean) - (column_mean - grand);
            sum += residual * residual;
        }
    }
    sum
}

fn negligible_sum_of_squares(table: &Table) -> f64 {
    let cells = table.rows().iter().flatten();
    let root_mean_square = rounding_of(cells.clone().copied());
    cells.count() as f64 * root_mean_square * root_mean_square
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[&[f64]]) -> Table {
        let names = |prefix: &str, count: usize| (1..=count).map(|i| format!("{prefix}{i}")).collect();
        let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
        Table::complete(names("p", rows.len()), names("c", rows[0].len()), rows).unwrap()
    }

    #[test]
    fn with_two_conditions_f_is_the_square_of_paired_t() {
        let table = table(&[&[1.0, 2.0], &[2.0, 2.5], &[4.0, 4.2], &[3.0, 5.0]]);
        let anova = repeated_measures(&table).unwrap();
        let t = crate::statistics::paired_t(&table.pair(0, 1).unwrap()).unwrap();
        assert!((anova.f - t.t * t.t).abs() < 1e-12 && (anova.p - t.p).abs() < 1e-12);
        assert_eq!(anova.sphericity, None);
    }

    #[test]
    fn degenerate_tables_get_a_reason() {
        assert_eq!(one_way(&table(&[&[0.1, 0.1], &[0.1, 0.1]])), Err(Undefined::NoVariation));
        assert_eq!(one_way(&table(&[&[0.1, 0.7], &[0.1, 0.7]])), Err(Undefined::NoErrorVariation));
        // Everyone is 0.1 better in the second condition; in binary these differences are not even equal.
        let shifted = table(&[&[0.1, 0.2], &[0.3, 0.4], &[0.7, 0.8]]);
        assert_eq!(repeated_measures(&shifted), Err(Undefined::NoErrorVariation));
        assert!(one_way(&shifted).is_ok());
        let one = repeated_measures(&table(&[&[0.1, 0.2]])).unwrap_err();
        assert_eq!(
            one.to_string(),
            "a repeated-measures ANOVA needs at least 2 participants, and there is 1"
        );
        assert!(matches!(
            one_way(&table(&[&[0.1], &[0.3]])),
            Err(Undefined::TooFew { of: "conditions", .. })
        ));
    }
}
