//! Wilcoxon's signed-rank test, with SciPy's choice of method.

use super::distribution::normal_two_sided;
use super::{Paired, Undefined, require};
use serde::Serialize;

/// Result of Wilcoxon's signed-rank test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Wilcoxon {
    /// The smaller of the two rank sums.
    pub w: f64,
    /// Two-sided p value.
    pub p: f64,
    /// How p was found.
    pub method: WilcoxonMethod,
    /// Participants whose values differ; the others are left out of the ranking.
    pub differing: usize,
    /// Matched-pairs rank-biserial correlation, (R₊ − R₋)/(R₊ + R₋), from −1 to 1; 0 if nobody differs.
    pub rank_biserial: f64,
}

/// How a p value was found. The rule is `method="auto"` of `scipy.stats.wilcoxon` 1.17.1: with more than 50 participants
/// the normal approximation; otherwise exact, if neither ties nor zeros occur; otherwise all sign changes up to 13
/// participants, and the normal approximation beyond. (Participants without a difference count in these limits.)
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WilcoxonMethod {
    /// The distribution of the rank sum of 1…n.
    Exact,
    /// The distribution of the sum of the ranks that occurred, ties included.
    Permutation,
    /// Normal approximation with the variance corrected for ties, without continuity correction.
    Normal,
}

const MOST_FOR_EXACT: usize = 50;
const MOST_FOR_PERMUTATION: usize = 13;

/// Wilcoxon's signed-rank test, two-sided, zeros left out (`scipy.stats.wilcoxon(a, b)` with its defaults).
///
/// Ties are judged on the differences as f64, so rates that ought to tie may not: see [`Paired::snapped`]. Where SciPy has no answer (more than 13 participants, none
/// of them different) p is 1, as for fewer.
///
/// # Errors
/// No participant.
pub fn wilcoxon(pairs: &Paired) -> Result<Wilcoxon, Undefined> {
    require("Wilcoxon's test", "participants", 1, pairs.len())?;
    let differences: Vec<f64> = pairs.differences().into_iter().filter(|&d| d != 0.0).collect();
    if differences.is_empty() {
        return Ok(Wilcoxon {
            w: 0.0,
            p: 1.0,
            method: WilcoxonMethod::Permutation,
            differing: 0,
            rank_biserial: 0.0,
        });
    }
    let magnitudes: Vec<f64> = differences.iter().map(|d| d.abs()).collect();
    let ranks = average_ranks(&magnitudes);
    let plus: f64 = ranks.iter().zip(&differences).filter(|(_, d)| **d > 0.0).map(|(r, _)| r).sum();
    let total = ranks.iter().sum::<f64>();
    let method = method(pairs.len(), pairs.len() - differences.len(), &magnitudes);
    let p = match method {
        WilcoxonMethod::Exact | WilcoxonMethod::Permutation => exact_p(&ranks, plus),
        WilcoxonMethod::Normal => normal_p(&magnitudes, plus),
    };
    Ok(Wilcoxon {
        w: plus.min(total - plus),
        p,
        method,
        differing: differences.len(),
        rank_biserial: (2.0 * plus - total) / total,
    })
}

fn method(participants: usize, zeros: usize, magnitudes: &[f64]) -> WilcoxonMethod {
    let complicated = zeros > 0 || tie_sizes(magnitudes).iter().any(|&size| size > 1);
    match participants {
        n if n > MOST_FOR_EXACT => WilcoxonMethod::Normal,
        _ if !complicated => WilcoxonMethod::Exact,
        n if n <= MOST_FOR_PERMUTATION => WilcoxonMethod::Permutation,
        _ => WilcoxonMethod::Normal,
    }
}

/// Probability of a rank sum at least as far out, over all 2ⁿ ways to sign the ranks, each equally likely.
///
/// Ranks are half-integers, so twice a rank sum indexes an array: the counts are built up rank by rank. They are exact
/// integers in f64, as n is at most 50.
fn exact_p(ranks: &[f64], plus: f64) -> f64 {
    let doubled: Vec<usize> = ranks.iter().map(|r| (2.0 * r) as usize).collect();
    let total: usize = doubled.iter().sum();
    let mut ways = vec![0.0_f64; total + 1];
    ways[0] = 1.0;
    for rank in doubled {
        for sum in (rank..=total).rev() {
            ways[sum] += ways[sum - rank];
        }
    }
    let observed = (2.0 * plus) as usize;
    let all: f64 = ways.iter().sum();
    let below: f64 = ways[..=observed].iter().sum();
    let above: f64 = ways[observed..].iter().sum();
    (2.0 * below.min(above) / all).min(1.0)
}

fn normal_p(magnitudes: &[f64], plus: f64) -> f64 {
    let n = magnitudes.len() as f64;
    let ties: f64 = tie_sizes(magnitudes).iter().map(|&size| (size * size * size - size) as f64).sum();
    let variance = (n * (n + 1.0) * (2.0 * n + 1.0) - ties / 2.0) / 24.0;
    normal_two_sided((plus - n * (n + 1.0) / 4.0) / variance.sqrt())
}

/// Ranks from 1; equal values share the mean of their ranks.
pub(super) fn average_ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut ranks = vec![0.0; values.len()];
    let mut start = 0;
    for group in order.chunk_by(|&i, &j| values[i] == values[j]) {
        let shared = start as f64 + (group.len() + 1) as f64 / 2.0;
        group.iter().for_each(|&i| ranks[i] = shared);
        start += group.len();
    }
    ranks
}

/// How many values share each distinct value.
fn tie_sizes(values: &[f64]) -> Vec<usize> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.chunk_by(|a, b| a == b).map(<[f64]>::len).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test of given differences against zero.
    fn of(differences: &[f64]) -> Wilcoxon {
        wilcoxon(&Paired::new(differences, &vec![0.0; differences.len()]).unwrap()).unwrap()
    }

    fn check(differences: &[f64], w: f64, p: f64, method: WilcoxonMethod) {
        let result = of(differences);
        assert_eq!((result.w, result.method), (w, method));
        assert!((result.p - p).abs() <= 1e-12 * p, "{} against {p}", result.p);
    }

    // scipy.stats.wilcoxon 1.17.1 of the same differences.
    #[test]
    fn without_ties_exact() {
        check(
            &[6.0, 8.0, 14.0, 16.0, 23.0, 24.0, 28.0, 29.0, 41.0, -48.0, 49.0, 56.0, 60.0, -67.0, 75.0],
            24.0,
            0.041259765625,
            WilcoxonMethod::Exact,
        );
    }

    #[test]
    fn few_with_ties_or_zeros_by_permutation() {
        check(&[1.0, 1.0, -1.0, 2.0, 3.0, 3.0], 2.0, 0.125, WilcoxonMethod::Permutation);
        check(&[0.0, 1.0, 2.0, 3.0, -4.0, 5.0], 4.0, 0.4375, WilcoxonMethod::Permutation);
    }

    #[test]
    fn many_with_ties_or_zeros_by_the_normal_distribution() {
        let tied: Vec<f64> = (0..16).map(|i| f64::from(i % 5) - 1.0).collect();
        check(&tied, 16.0, 0.035_455_030_530_136_53, WilcoxonMethod::Normal);
        let many: Vec<f64> = (0..60).map(|i| f64::from(i) - 20.5).collect();
        check(&many, 451.5, 0.000_644_063_741_527_686_9, WilcoxonMethod::Normal);
    }

    #[test]
    fn rates_tie_when_snapped() {
        let rates = Paired::new(&[34.0 / 40.0, 36.0 / 40.0, 1.0], &[32.0 / 40.0, 34.0 / 40.0, 0.5]).unwrap();
        assert_eq!(wilcoxon(&rates).unwrap().method, WilcoxonMethod::Exact);
        assert_eq!(wilcoxon(&rates.snapped()).unwrap().method, WilcoxonMethod::Permutation);
    }

    #[test]
    fn nobody_differs() {
        assert_eq!((of(&[0.0; 5]).p, of(&[0.0; 60]).p, of(&[0.0; 5]).differing), (1.0, 1.0, 0));
        assert!(wilcoxon(&Paired::new(&[], &[]).unwrap()).is_err());
    }

    #[test]
    fn one_sided_evidence_has_a_rank_biserial_of_one() {
        assert_eq!(of(&[1.0, 2.0, 3.0]).rank_biserial, 1.0);
        assert_eq!(of(&[-1.0, -2.0, -3.0]).rank_biserial, -1.0);
    }
}
