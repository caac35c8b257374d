//! Friedman's test: do the conditions differ, judged by each participant's ranking of them?

use super::distribution::chi2_upper_tail;
use super::wilcoxon::average_ranks;
use super::{Table, Undefined, require};
use serde::Serialize;

/// Result of Friedman's test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Friedman {
    /// The statistic, corrected for ties.
    pub chi2: f64,
    /// Conditions − 1.
    pub df: usize,
    /// Probability of a χ² this large if all rankings were chance; an approximation that is rough below ten participants.
    pub p: f64,
    /// Kendall's W, from 0 (no agreement between participants) to 1 (all rank alike).
    pub kendall_w: f64,
}

/// Friedman's test of at least three columns (`scipy.stats.friedmanchisquare`).
///
/// # Errors
/// Fewer than three conditions or two participants; every participant has equal values in all conditions.
pub fn friedman(table: &Table) -> Result<Friedman, Undefined> {
    let (n, k) = (table.rows().len(), table.conditions().len());
    require("Friedman's test", "conditions", 3, k)?;
    require("Friedman's test", "participants", 2, n)?;
    let ranks: Vec<Vec<f64>> = table.rows().iter().map(|row| average_ranks(row)).collect();
    // Sums of half-integers: exact, so equal rank sums give exactly zero.
    let middle = (k + 1) as f64 / 2.0;
    let spread: f64 = ranks.iter().flatten().map(|r| (r - middle) * (r - middle)).sum();
    if spread == 0.0 {
        return Err(Undefined::NoVariation);
    }
    let between: f64 =
        (0..k).map(|c| ranks.iter().map(|row| row[c] - middle).sum::<f64>()).map(|sum| sum * sum).sum();
    let chi2 = (k - 1) as f64 * between / spread;
    let df = k - 1;
    Ok(Friedman { chi2, df, p: chi2_upper_tail(chi2, df as f64), kendall_w: chi2 / (n * df) as f64 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[[f64; 3]]) -> Result<Friedman, Undefined> {
        let names = |prefix: &str, count: usize| (1..=count).map(|i| format!("{prefix}{i}")).collect();
        let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
        friedman(&Table::complete(names("p", rows.len()), names("c", 3), rows).unwrap())
    }

    #[test]
    fn full_agreement_has_w_of_one() {
        let result = of(&[[1.0, 2.0, 3.0], [2.0, 5.0, 9.0], [0.0, 0.1, 0.2]]).unwrap();
        assert_eq!((result.chi2, result.kendall_w, result.df), (6.0, 1.0, 2));
    }

    // scipy 1.17.1: friedmanchisquare([1, 3, 1], [1, 2, 2], [2, 2, 2]).
    #[test]
    fn ties_are_corrected_for() {
        let result = of(&[[1.0, 1.0, 2.0], [3.0, 2.0, 2.0], [1.0, 2.0, 2.0]]).unwrap();
        assert!((result.chi2 - 0.666_666_666_666_666_6).abs() < 1e-12);
        assert!((result.p - 0.716_531_310_573_789_2).abs() < 1e-12);
    }

    #[test]
    fn degenerate_tables_get_a_reason() {
        assert_eq!(of(&[[1.0; 3], [2.0; 3]]), Err(Undefined::NoVariation));
        assert!(matches!(of(&[[1.0, 2.0, 3.0]]), Err(Undefined::TooFew { .. })));
    }
}
