//! Tail probabilities and quantiles of the distributions that the tests refer to: normal, Student's t, F, chi².
//!
//! Degrees of freedom are positive and may be fractional (Greenhouse–Geisser). Tails are computed as tails, never as
//! one minus the rest, so that a tiny p value keeps its digits.

use super::special::{beta_regularised, gamma_upper_regularised, normal_cdf};

/// `P(F > f)` with `df1` and `df2` degrees of freedom.
pub(crate) fn f_upper_tail(f: f64, df1: f64, df2: f64) -> f64 {
    if f <= 0.0 {
        return 1.0;
    }
    let total = df2 + df1 * f;
    beta_regularised(df2 / 2.0, df1 / 2.0, df2 / total, df1 * f / total)
}

/// `P(χ² > x)` with `df` degrees of freedom.
pub(crate) fn chi2_upper_tail(x: f64, df: f64) -> f64 {
    gamma_upper_regularised(df / 2.0, x / 2.0)
}

/// `P(T > t)` with `df` degrees of freedom.
pub(crate) fn t_upper_tail(t: f64, df: f64) -> f64 {
    let half = 0.5 * f_upper_tail(t * t, 1.0, df);
    if t >= 0.0 { half } else { 1.0 - half }
}

/// `P(|T| > |t|)` with `df` degrees of freedom.
pub(crate) fn t_two_sided(t: f64, df: f64) -> f64 {
    f_upper_tail(t * t, 1.0, df)
}

/// `P(|Z| > |z|)` of the standard normal distribution.
pub(crate) fn normal_two_sided(z: f64) -> f64 {
    2.0 * normal_cdf(-z.abs())
}

/// The `t` with `P(T > t) = tail`, for `tail` in (0, ½].
pub(crate) fn t_upper_quantile(tail: f64, df: f64) -> f64 {
    decreasing_root(|t| t_upper_tail(t, df) - tail)
}

/// The `z` with `P(Z <= z) = p`, for `p` in (0, 1).
pub(crate) fn normal_quantile(p: f64) -> f64 {
    if p > 0.5 {
        return -normal_quantile_lower(1.0 - p);
    }
    normal_quantile_lower(p)
}

fn normal_quantile_lower(p: f64) -> f64 {
    -decreasing_root(|z| normal_cdf(-z) - p)
}

/// Root of a decreasing function on `[0, ∞)`, to the last digit, by doubling and halving: a quantile is asked for
/// a few times a report, so certainty is worth more than speed.
fn decreasing_root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while f(high) > 0.0 && high < 1e300 {
        low = high;
        high *= 2.0;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if f(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(ours: f64, reference: f64) {
        assert!((ours - reference).abs() <= 1e-12 * reference.abs(), "{ours:e} against {reference:e}");
    }

    // scipy 1.17.1: f.sf, chi2.sf, t.sf, norm.sf; the last four t.ppf and norm.ppf.
    #[test]
    fn agrees_with_scipy() {
        close(f_upper_tail(0.05, 1.0, 18.0), 0.825_581_450_455_932);
        close(f_upper_tail(8.65, 1.0, 18.0), 0.008_733_676_708_828_632);
        close(f_upper_tail(8.65, 1.0, 9.0), 0.016_457_594_689_410_732);
        close(f_upper_tail(1017.0, 1.3, 11.7), 3.548_102_525_443_783_6e-13);
        close(chi2_upper_tail(9.5, 2.0), 0.008_651_695_203_120_634);
        close(t_upper_tail(2.3, 9.0), 0.023_499_694_460_931_576);
        close(t_upper_tail(-2.3, 9.0), 0.976_500_305_539_068_4);
        close(t_two_sided(40.0, 29.0), 6.346_877_329_729_342e-27);
        close(normal_two_sided(-6.0), 1.973_175_290_075_389e-9);
        close(t_upper_quantile(0.025, 9.0), 2.262_157_162_798_205);
        close(t_upper_quantile(0.05, 29.0), 1.699_127_026_533_497_2);
        close(normal_quantile(0.025), -1.959_963_984_540_054);
        close(normal_quantile(0.9), 1.281_551_565_544_600_4);
    }
}
