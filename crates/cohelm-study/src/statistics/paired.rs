//! Two conditions flown by the same participants: are they different, by how much, or the same?

use super::describe::{Interval, mean_of, standard_deviation, t_interval};
use super::distribution::{t_two_sided, t_upper_tail};
use super::{Paired, Undefined, require, rounding_of};
use serde::Serialize;

/// Paired t test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PairedT {
    /// Mean difference over its standard error; positive where the first condition is larger.
    pub t: f64,
    /// Two-sided p value.
    pub p: f64,
    /// Participants − 1.
    pub df: usize,
    /// Mean of first − second, in the measure's unit.
    pub mean_difference: f64,
    /// Standard deviation of the differences.
    pub sd_difference: f64,
    /// 95 % interval of the mean difference.
    pub ci95: Interval,
}

/// Equivalence by two one-sided paired t tests (Schuirmann 1987).
///
/// A large p of a difference test is no proof of sameness; this is. The 90 % interval lies within the bounds
/// exactly when p < .05.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tost {
    /// Differences within ± this count as none, in the measure's unit.
    pub bound: f64,
    /// The larger of the two one-sided p values: below the level, the conditions are equivalent.
    pub p: f64,
    /// p of "the difference is at most −bound".
    pub p_above_lower: f64,
    /// p of "the difference is at least +bound".
    pub p_below_upper: f64,
    /// Participants − 1.
    pub df: usize,
    /// Mean of first − second.
    pub mean_difference: f64,
    /// 90 % interval of the mean difference.
    pub ci90: Interval,
}

/// How large a difference is in standard deviations; positive where the first condition is larger.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EffectSizes {
    /// Cohen's d with the root mean square of both standard deviations (d_av; pingouin's paired Cohen's d).
    pub d_av: f64,
    /// The same times Hedges' correction for few participants, 1 − 3/(4(n − 1) − 1).
    pub g_av: f64,
    /// Mean difference over the standard deviation of the differences: the one that fixes power. `None` if all differ alike.
    pub d_z: Option<f64>,
}

/// Differences with their mean and a standard deviation above rounding.
struct Differences {
    n: usize,
    mean: f64,
    sd: f64,
}

impl Differences {
    fn of(pairs: &Paired, what: &'static str) -> Result<Self, Undefined> {
        require(what, "participants", 2, pairs.len())?;
        let differences = pairs.differences();
        let (mean, sd) = (mean_of(&differences), standard_deviation(&differences)?);
        // A difference carries the rounding of the values it was taken from, however small it is itself.
        let rounding = rounding_of(pairs.a().iter().chain(pairs.b()).copied());
        if sd > rounding {
            return Ok(Differences { n: pairs.len(), mean, sd });
        }
        Err(if mean.abs() > rounding { Undefined::NoErrorVariation } else { Undefined::NoDifference })
    }

    fn df(&self) -> usize {
        self.n - 1
    }

    fn t(&self, against: f64) -> f64 {
        (self.mean - against) / (self.sd / (self.n as f64).sqrt())
    }
}

/// Paired t test, two-sided (`scipy.stats.ttest_rel`).
///
/// # Errors
/// Fewer than two participants, or the same difference in all of them.
pub fn paired_t(pairs: &Paired) -> Result<PairedT, Undefined> {
    let d = Differences::of(pairs, "a paired t test")?;
    let t = d.t(0.0);
    Ok(PairedT {
        t,
        p: t_two_sided(t, d.df() as f64),
        df: d.df(),
        mean_difference: d.mean,
        sd_difference: d.sd,
        ci95: t_interval(d.mean, d.sd, d.n, 0.95),
    })
}

/// Equivalence test with bounds ± `bound` in the measure's unit (`pingouin.tost(…, paired=True)`).
///
/// # Errors
/// A bound that is not positive and finite; fewer than two participants, or the same difference in all of them.
pub fn tost(pairs: &Paired, bound: f64) -> Result<Tost, Undefined> {
    if !(bound > 0.0 && bound.is_finite()) {
        return Err(Undefined::OutOfRange {
            name: "the equivalence bound",
            expected: "positive and finite",
            found: bound.to_string(),
        });
    }
    let d = Differences::of(pairs, "an equivalence test")?;
    let df = d.df() as f64;
    let p_above_lower = t_upper_tail(d.t(-bound), df);
    let p_below_upper = t_upper_tail(-d.t(bound), df);
    Ok(Tost {
        bound,
        p: p_above_lower.max(p_below_upper),
        p_above_lower,
        p_below_upper,
        df: d.df(),
        mean_difference: d.mean,
        ci90: t_interval(d.mean, d.sd, d.n, 0.9),
    })
}

/// Standardised differences between two conditions.
///
/// # Errors
/// Fewer than two participants, or no variation within the conditions.
pub fn effect_sizes(pairs: &Paired) -> Result<EffectSizes, Undefined> {
    require("an effect size", "participants", 2, pairs.len())?;
    let (sd_a, sd_b) = (standard_deviation(pairs.a())?, standard_deviation(pairs.b())?);
    let sd = ((sd_a * sd_a + sd_b * sd_b) / 2.0).sqrt();
    let difference = mean_of(pairs.a()) - mean_of(pairs.b());
    if sd == 0.0 {
        return Err(if difference == 0.0 { Undefined::NoVariation } else { Undefined::NoErrorVariation });
    }
    let hedges = 1.0 - 3.0 / (4.0 * (pairs.len() - 1) as f64 - 1.0);
    let d_z = Differences::of(pairs, "an effect size").ok().map(|d| d.mean / d.sd);
    Ok(EffectSizes { d_av: difference / sd, g_av: hedges * difference / sd, d_z })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(a: &[f64], b: &[f64]) -> Paired {
        Paired::new(a, b).unwrap()
    }

    // pingouin 0.7.0, documented example of tost: a, b, bound 0.5, paired: p 0.954854.
    #[test]
    fn pingouins_equivalence_example() {
        let p = pairs(&[4.0, 7.0, 8.0, 6.0, 3.0, 2.0], &[6.0, 8.0, 7.0, 10.0, 11.0, 9.0]);
        assert!((tost(&p, 0.5).unwrap().p - 0.954854).abs() < 1e-6);
    }

    #[test]
    fn the_ninety_percent_interval_decides_equivalence() {
        let p = pairs(&[0.85, 0.9, 0.875, 0.8, 0.925], &[0.86, 0.88, 0.9, 0.81, 0.92]);
        for bound in [0.005, 0.01, 0.015, 0.02, 0.03, 0.05] {
            let result = tost(&p, bound).unwrap();
            let inside = result.ci90.low > -bound && result.ci90.high < bound;
            assert_eq!(inside, result.p < 0.05, "bound {bound}");
        }
    }

    #[test]
    fn equal_or_constant_differences_have_no_t() {
        let same = pairs(&[0.1, 0.2, 0.3], &[0.1, 0.2, 0.3]);
        let shifted = pairs(&[0.1, 0.3, 0.7], &[0.2, 0.4, 0.8]);
        assert_eq!(paired_t(&same), Err(Undefined::NoDifference));
        assert_eq!(paired_t(&shifted), Err(Undefined::NoErrorVariation));
        assert_eq!(tost(&shifted, 0.5), Err(Undefined::NoErrorVariation));
        assert_eq!(effect_sizes(&shifted).unwrap().d_z, None);
        assert!(matches!(paired_t(&pairs(&[1.0], &[2.0])), Err(Undefined::TooFew { .. })));
        assert!(tost(&same, f64::NAN).unwrap_err().to_string().contains("positive and finite, and is NaN"));
        assert_eq!(effect_sizes(&pairs(&[1.0, 1.0], &[1.0, 1.0])), Err(Undefined::NoVariation));
    }
}
