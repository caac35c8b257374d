//! The two incomplete integrals behind every p value here: regularised beta and regularised gamma.
//!
//! Why not a library: `statrs` takes `ln`, `exp` and `powf` from the platform's C library, whose last digits differ
//! between systems, and a report must print the same numbers on every machine. These take all transcendental
//! functions from the crate `libm`. Held against values of arbitrary precision (mpmath) to 1e-12 relative, far tails included.
//!
//! Method: leading factor in Stirling form with the remainder [`stirling_error`], so that nothing large cancels
//! (Loader 2000), times a continued fraction evaluated by Lentz's method, or a power series.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Factors of a continued fraction within this of one no longer change the product.
const CONVERGED: f64 = 1e-16;
/// Stands for zero in Lentz's method, whose denominators must not vanish.
const TINY: f64 = 1e-300;
/// Enough for parameters up to about 1e8, as the fraction needs some `sqrt(max(a, b))` terms.
const MAX_TERMS: u32 = 20_000;

/// Regularised incomplete beta function `I_x(a, b)`, with `y = 1 − x` given apart.
///
/// Both arguments are asked for because a caller often knows the small one exactly (`y = t²/(ν + t²)`) where a
/// subtraction would lose it. Needs `a, b > 0` and `x, y` in `[0, 1]`; returns a probability.
pub(crate) fn beta_regularised(a: f64, b: f64, x: f64, y: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if y <= 0.0 {
        return 1.0;
    }
    // The fraction converges fast below the mean of the distribution; above it the mirrored one does.
    if x * (a + b + 2.0) <= a + 1.0 { beta_lower(a, b, x, y) } else { 1.0 - beta_lower(b, a, y, x) }
}

fn beta_lower(a: f64, b: f64, x: f64, y: f64) -> f64 {
    beta_density_factor(a, b, x, y) / a / beta_fraction(a, b, x)
}

/// `x^a y^b / B(a, b)`.
fn beta_density_factor(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let sum = a + b;
    let exponent = a * libm::log(x * sum / a)
        + b * libm::log(y * sum / b)
        + (stirling_error(sum) - stirling_error(a) - stirling_error(b));
    (a * b / (2.0 * PI * sum)).sqrt() * libm::exp(exponent)
}

/// The denominator `1 + d1/(1 + d2/(1 + …))` of the continued fraction of the incomplete beta function
/// (NIST Digital Library of Mathematical Functions, 8.17.22).
fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    lentz(|term| {
        let m = f64::from(term / 2);
        if term % 2 == 0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        }
    })
}

/// Evaluates `1 + c(1)/(1 + c(2)/(1 + …))` by the modified Lentz method.
fn lentz(coefficient: impl Fn(u32) -> f64) -> f64 {
    let away_from_zero = |v: f64| if v.abs() < TINY { TINY } else { v };
    let (mut value, mut above, mut below) = (1.0, 1.0, 0.0);
    for term in 1..=MAX_TERMS {
        let c = coefficient(term);
        below = 1.0 / away_from_zero(1.0 + c * below);
        above = away_from_zero(1.0 + c / above);
        let step = above * below;
        value *= step;
        if (step - 1.0).abs() < CONVERGED {
            break;
        }
    }
    value
}

/// Regularised upper incomplete gamma function `Q(a, x) = Γ(a, x)/Γ(a)`. Needs `a > 0`, `x >= 0`.
pub(crate) fn gamma_upper_regularised(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        1.0
    } else if x == f64::INFINITY {
        0.0
    } else if x < a + 1.0 {
        1.0 - gamma_density_factor(a, x) * gamma_series(a, x)
    } else {
        gamma_density_factor(a, x) * gamma_fraction(a, x)
    }
}

/// `x^a e^(−x) / Γ(a)`.
fn gamma_density_factor(a: f64, x: f64) -> f64 {
    (a / (2.0 * PI)).sqrt() * libm::exp(a * libm::log(x / a) + (a - x) - stirling_error(a))
}

/// `1/a + x/(a(a+1)) + x²/(a(a+1)(a+2)) + …`
fn gamma_series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for n in 1..=MAX_TERMS {
        term *= x / (a + f64::from(n));
        sum += term;
        if term < sum * CONVERGED {
            break;
        }
    }
    sum
}

/// `1/(x + 1 − a − 1(1−a)/(x + 3 − a − …))`, the even form of the continued fraction (DLMF 8.9.2).
fn gamma_fraction(a: f64, x: f64) -> f64 {
    let mut partial = x + 1.0 - a;
    let mut above = 1.0 / TINY;
    let mut below = 1.0 / partial;
    let mut value = below;
    for n in 1..=MAX_TERMS {
        let n = f64::from(n);
        let c = -n * (n - a);
        partial += 2.0;
        below = 1.0 / (partial + c * below);
        above = partial + c / above;
        let step = above * below;
        value *= step;
        if (step - 1.0).abs() < CONVERGED {
            break;
        }
    }
    value
}

/// What Stirling's formula leaves out: `ln Γ(z) − [(z − ½) ln z − z + ½ ln 2π]`, for `z > 0`.
fn stirling_error(z: f64) -> f64 {
    const HALF_LN_2PI: f64 = 0.918_938_533_204_672_8;
    if z < 10.0 {
        return libm::lgamma(z) - ((z - 0.5) * libm::log(z) - z + HALF_LN_2PI);
    }
    let r = 1.0 / (z * z);
    let series = 1.0 / 12.0
        - r * (1.0 / 360.0
            - r * (1.0 / 1260.0
                - r * (1.0 / 1680.0 - r * (1.0 / 1188.0 - r * (691.0 / 360_360.0 - r / 156.0)))));
    series / z
}

/// Distribution function of the standard normal distribution; relative accuracy in the lower tail too.
pub(crate) fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asserts a relative distance of at most 1e-12.
    fn close(ours: f64, reference: f64) {
        assert!((ours - reference).abs() <= 1e-12 * reference.abs(), "{ours:e} against {reference:e}");
    }

    // Recipe of tests/data/special.json: `tests/data/record_special.py` (mpmath with 400 digits).
    #[test]
    fn agrees_with_values_of_many_digits() {
        let file: serde_json::Value =
            serde_json::from_str(include_str!("../../tests/data/special.json")).unwrap();
        let rows = |name: &str| -> Vec<Vec<f64>> { serde_json::from_value(file[name].clone()).unwrap() };
        for r in rows("beta") {
            close(beta_regularised(r[0], r[1], r[2], r[3]), r[4]);
        }
        for r in rows("gamma_upper") {
            close(gamma_upper_regularised(r[0], r[1]), r[2]);
        }
        for r in rows("normal_cdf") {
            close(normal_cdf(r[0]), r[1]);
        }
        assert!(rows("beta").len() > 300 && rows("gamma_upper").len() > 100 && rows("normal_cdf").len() > 30);
    }

    #[test]
    fn ends_of_the_range() {
        assert_eq!(beta_regularised(2.0, 3.0, 0.0, 1.0), 0.0);
        assert_eq!(beta_regularised(2.0, 3.0, 1.0, 0.0), 1.0);
        assert_eq!(gamma_upper_regularised(1.5, 0.0), 1.0);
        assert_eq!(gamma_upper_regularised(1.5, f64::INFINITY), 0.0);
    }
}
