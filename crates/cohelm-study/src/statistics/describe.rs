//! Numbers that describe one column: centre, spread, quartiles, and the interquartile mean.

use super::distribution::t_upper_quantile;
use super::{Undefined, require, require_finite, rounding_of};
use serde::Serialize;

/// A confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end, in the unit of what is estimated.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Coverage, as 0.95.
    pub level: f64,
}

/// What a table of results prints of one column.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Number of values.
    pub n: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// Sample standard deviation (divided by n − 1); `None` for a single value.
    pub sd: Option<f64>,
    /// Student's t interval of the mean, 95 %; `None` for a single value.
    pub mean_ci95: Option<Interval>,
    /// Smallest value.
    pub min: f64,
    /// First quartile.
    pub q1: f64,
    /// Median.
    pub median: f64,
    /// Third quartile.
    pub q3: f64,
    /// Largest value.
    pub max: f64,
    /// Interquartile mean, see [`interquartile_mean`].
    pub iqm: f64,
}

/// Describes a column of finite values.
///
/// # Errors
/// No value, or one that is not finite.
pub fn describe(values: &[f64]) -> Result<Summary, Undefined> {
    let sorted = sorted(values)?;
    let centre = mean_of(values);
    let spread = standard_deviation(values).ok();
    Ok(Summary {
        n: values.len(),
        mean: centre,
        sd: spread,
        mean_ci95: spread.map(|sd| t_interval(centre, sd, values.len(), 0.95)),
        min: sorted[0],
        q1: quantile_of(&sorted, 0.25),
        median: quantile_of(&sorted, 0.5),
        q3: quantile_of(&sorted, 0.75),
        max: sorted[sorted.len() - 1],
        iqm: trimmed_mean(&sorted),
    })
}

/// Arithmetic mean.
///
/// # Errors
/// No value, or one that is not finite.
pub fn mean(values: &[f64]) -> Result<f64, Undefined> {
    require("a mean", "values", 1, values.len())?;
    require_finite(values)?;
    Ok(mean_of(values))
}

/// Median: the middle value, or the mean of the middle two.
///
/// # Errors
/// No value, or one that is not finite.
pub fn median(values: &[f64]) -> Result<f64, Undefined> {
    quantile(values, 0.5)
}

/// Quantile with linear interpolation between order statistics (NumPy's and R's default, type 7).
///
/// # Errors
/// No value, one that is not finite, or `p` outside [0, 1].
pub fn quantile(values: &[f64], p: f64) -> Result<f64, Undefined> {
    if !(0.0..=1.0).contains(&p) {
        return Err(Undefined::OutOfRange { name: "p", expected: "within [0, 1]", found: p.to_string() });
    }
    Ok(quantile_of(&sorted(values)?, p))
}

/// Sample standard deviation, divided by n − 1; exactly zero where the values differ by no more than rounding.
///
/// # Errors
/// Fewer than two values, or one that is not finite.
pub fn standard_deviation(values: &[f64]) -> Result<f64, Undefined> {
    require("a standard deviation", "values", 2, values.len())?;
    require_finite(values)?;
    let sd = (sum_of_squares(values) / (values.len() - 1) as f64).sqrt();
    Ok(if sd > rounding_of(values.iter().copied()) { sd } else { 0.0 })
}

/// Mean of the values between the quartiles: a quarter of them, rounded down, is cut off at each end
/// (`scipy.stats.trim_mean(x, 0.25)`; recommended for few runs by Agarwal et al. 2021).
///
/// # Errors
/// No value, or one that is not finite.
pub fn interquartile_mean(values: &[f64]) -> Result<f64, Undefined> {
    Ok(trimmed_mean(&sorted(values)?))
}

/// Student's t interval of a mean.
pub(super) fn t_interval(mean: f64, sd: f64, n: usize, level: f64) -> Interval {
    let half_width = t_upper_quantile((1.0 - level) / 2.0, (n - 1) as f64) * sd / (n as f64).sqrt();
    Interval { low: mean - half_width, high: mean + half_width, level }
}

/// Mean of at least one value. Values are taken relative to the first, so that equal ones have that very mean.
pub(super) fn mean_of(values: &[f64]) -> f64 {
    let first = values[0];
    first + values.iter().map(|v| v - first).sum::<f64>() / values.len() as f64
}

/// Sum of squared deviations from the mean.
pub(super) fn sum_of_squares(values: &[f64]) -> f64 {
    let mean = mean_of(values);
    values.iter().map(|v| (v - mean) * (v - mean)).sum()
}

pub(super) fn sorted(values: &[f64]) -> Result<Vec<f64>, Undefined> {
    require("a summary", "values", 1, values.len())?;
    require_finite(values)?;
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    Ok(sorted)
}

/// Type 7 quantile of sorted values.
pub(super) fn quantile_of(sorted: &[f64], p: f64) -> f64 {
    let position = p * (sorted.len() - 1) as f64;
    let below = position.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (position - below as f64) * (sorted[above] - sorted[below])
}

fn trimmed_mean(sorted: &[f64]) -> f64 {
    let cut = sorted.len() / 4;
    mean_of(&sorted[cut..sorted.len() - cut])
}

#[cfg(test)]
mod tests {
    use super::*;

    // numpy 2.4.6: mean, std(ddof=1), quantile; scipy.stats.t.interval, trim_mean on the same ten values.
    #[test]
    fn describes_as_numpy_does() {
        let s = describe(&[0.85, 0.9, 0.975, 0.8, 0.925, 0.95, 0.7, 1.0, 0.875, 0.9]).unwrap();
        let close =
            |ours: f64, reference: f64| assert!((ours - reference).abs() < 1e-12, "{ours} {reference}");
        close(s.mean, 0.8875);
        close(s.sd.unwrap(), 0.088_388_347_648_318_45);
        close(s.q1, 0.85625);
        close(s.median, 0.9);
        close(s.q3, 0.94375);
        close(s.iqm, 0.9);
        close(s.mean_ci95.unwrap().low, 0.824_270_785_102_439_3);
        close(s.mean_ci95.unwrap().high, 0.950_729_214_897_560_6);
    }

    #[test]
    fn one_value_has_no_spread_and_none_has_nothing() {
        let one = describe(&[3.0]).unwrap();
        assert_eq!((one.median, one.iqm, one.sd, one.mean_ci95), (3.0, 3.0, None, None));
        assert_eq!(
            describe(&[]).unwrap_err().to_string(),
            "a summary needs one or more values, and there are 0"
        );
        assert_eq!(describe(&[f64::NAN]), Err(Undefined::NotFinite));
        assert!(quantile(&[1.0], 1.5).is_err());
    }

    #[test]
    fn equal_values_have_exactly_their_mean_and_no_spread() {
        let s = describe(&[0.1; 10]).unwrap();
        assert_eq!((s.mean, s.sd), (0.1, Some(0.0)));
    }
}
