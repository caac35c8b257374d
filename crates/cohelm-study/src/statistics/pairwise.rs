//! Every pair of conditions compared, with p values adjusted for there being several.

use super::bootstrap::{self, Bootstrapped};
use super::{PairedT, Table, Tost, Undefined, Wilcoxon, holm, paired_t, tost, wilcoxon};
use serde::Serialize;

/// What two conditions of a table say when compared within the participants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairOfConditions {
    /// Name of the first condition; differences are first − second.
    pub first: String,
    /// Name of the second.
    pub second: String,
    /// Paired t test.
    pub t: Result<PairedT, Undefined>,
    /// p of the t test after Holm's adjustment over all pairs of the table; `None` where there is no test.
    pub p_holm: Option<f64>,
    /// Wilcoxon's signed-rank test, differences that agree up to rounding taken as tied.
    pub wilcoxon: Result<Wilcoxon, Undefined>,
    /// d_av with its bootstrap interval.
    pub effect: Result<Bootstrapped, Undefined>,
    /// Equivalence within the bound, if one was given.
    pub equivalence: Option<Result<Tost, Undefined>>,
}

/// Compares every pair of conditions, in the order (0, 1), (0, 2), … (1, 2), …, with an equivalence test if a bound is given.
pub fn pairwise(table: &Table, bound: Option<f64>, options: bootstrap::Options) -> Vec<PairOfConditions> {
    let conditions = table.conditions();
    let pairs = (0..conditions.len()).flat_map(|a| (a + 1..conditions.len()).map(move |b| (a, b)));
    let mut compared: Vec<PairOfConditions> = pairs
        .map(|(a, b)| {
            let pair = table.pair(a, b);
            PairOfConditions {
                first: conditions[a].clone(),
                second: conditions[b].clone(),
                t: pair.clone().and_then(|pair| paired_t(&pair)),
                p_holm: None,
                wilcoxon: pair.clone().and_then(|pair| wilcoxon(&pair.snapped())),
                effect: pair.clone().and_then(|pair| bootstrap::effect_size(&pair, options)),
                equivalence: bound.map(|bound| pair.and_then(|pair| tost(&pair, bound))),
            }
        })
        .collect();
    let p_values: Vec<Option<f64>> = compared.iter().map(|c| c.t.as_ref().ok().map(|t| t.p)).collect();
    compared.iter_mut().zip(holm(&p_values)).for_each(|(pair, adjusted)| pair.p_holm = adjusted);
    compared
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pairs_in_order_with_adjusted_p_values() {
        let names = |names: &[&str]| names.iter().map(|&n| n.to_owned()).collect();
        let rows = vec![vec![1.0, 2.0, 2.0], vec![2.0, 2.5, 2.5], vec![4.0, 4.25, 4.25], vec![3.0, 5.0, 5.0]];
        let table = Table::complete(names(&["a", "b", "c", "d"]), names(&["x", "y", "z"]), rows).unwrap();
        let compared =
            pairwise(&table, Some(0.5), bootstrap::Options { resamples: 200, ..Default::default() });
        let pairs: Vec<String> = compared.iter().map(|c| c.first.clone() + &c.second).collect();
        assert_eq!(pairs, ["xy", "xz", "yz"]);
        let t = compared[0].t.as_ref().unwrap();
        assert!(t.mean_difference < 0.0 && compared[0].p_holm == Some((2.0 * t.p).min(1.0)));
        assert_eq!((&compared[2].t, compared[2].p_holm), (&Err(Undefined::NoDifference), None));
        assert!(compared.iter().all(|c| c.equivalence.is_some()));
    }
}
