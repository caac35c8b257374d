//! Sphericity: do the differences between conditions all have one variance, as the plain F of repeated measures assumes?

use super::describe::mean_of;
use super::distribution::{chi2_upper_tail, f_upper_tail};
use super::{Table, Undefined};
use serde::Serialize;

/// Greenhouse–Geisser correction and Mauchly's test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sphericity {
    /// Greenhouse–Geisser ε, from 1/(conditions − 1) to 1: the factor on both degrees of freedom.
    pub epsilon: f64,
    /// The p value of F with both degrees of freedom times ε.
    pub p_corrected: f64,
    /// Mauchly's test; weak with few participants, so the corrected p value is the one to report.
    pub mauchly: Result<Mauchly, Undefined>,
}

/// Mauchly's test of sphericity (1940), with the second-order term of its p value as in R's `mauchly.test`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mauchly {
    /// From 0 to 1; 1 is perfect sphericity.
    pub w: f64,
    /// The statistic referred to the χ² distribution.
    pub chi2: f64,
    /// Its degrees of freedom.
    pub df: usize,
    /// Probability of so small a w under sphericity.
    pub p: f64,
}

/// Sphericity of a table with at least three conditions and two participants and some error variation.
pub(super) fn sphericity(table: &Table, f: f64) -> Sphericity {
    let (n, k) = (table.rows().len(), table.conditions().len());
    let covariance = contrast_covariance(table);
    let epsilon = greenhouse_geisser(&covariance);
    let corrected = |df: usize| (epsilon * df as f64).max(1.0);
    Sphericity {
        epsilon,
        p_corrected: f_upper_tail(f, corrected(k - 1), corrected((k - 1) * (n - 1))),
        mauchly: mauchly(covariance, n, k),
    }
}

/// Covariance matrix of k − 1 orthonormal contrasts (Helmert's; any set gives the same ε and w).
fn contrast_covariance(table: &Table) -> Vec<Vec<f64>> {
    let scores: Vec<Vec<f64>> = (1..table.conditions().len())
        .map(|c| centred(table.rows().iter().map(|row| helmert(row, c)).collect()))
        .collect();
    let df = (table.rows().len() - 1) as f64;
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / df;
    scores.iter().map(|a| scores.iter().map(|b| dot(a, b)).collect()).collect()
}

/// The c-th value of a row against the mean of those before it, scaled to unit length.
fn helmert(row: &[f64], c: usize) -> f64 {
    let c_f = c as f64;
    (row[c] - mean_of(&row[..c])) * (c_f / (c_f + 1.0)).sqrt()
}

fn centred(mut values: Vec<f64>) -> Vec<f64> {
    let mean = mean_of(&values);
    values.iter_mut().for_each(|v| *v -= mean);
    values
}

fn greenhouse_geisser(m: &[Vec<f64>]) -> f64 {
    let trace = trace(m);
    let squares: f64 = m.iter().flatten().map(|v| v * v).sum();
    (trace * trace / (m.len() as f64 * squares)).min(1.0)
}

fn trace(m: &[Vec<f64>]) -> f64 {
    (0..m.len()).map(|i| m[i][i]).sum()
}

fn mauchly(covariance: Vec<Vec<f64>>, n: usize, k: usize) -> Result<Mauchly, Undefined> {
    let d = covariance.len() as f64;
    let mean_variance = trace(&covariance) / d;
    let ln_w =
        ln_determinant(covariance).ok_or(Undefined::SingularCovariance)? - d * libm::log(mean_variance);
    let df = covariance_df(d);
    let residual = (n - 1) as f64;
    let f = 1.0 - (2.0 * d * d + d + 2.0) / (6.0 * d * residual);
    let chi2 = -residual * f * ln_w;
    if chi2 < 0.0 {
        return Err(Undefined::SingularCovariance);
    }
    let scale = residual * d * f;
    // R, and pingouin after it, takes the number of conditions here where the derivation has d.
    let second_order =
        (d + 2.0) * (d - 1.0) * (d - 2.0) * (2.0 * d * d * d + 6.0 * d * d + 3.0 * k as f64 + 2.0)
            / (288.0 * scale * scale);
    let first = chi2_upper_tail(chi2, df);
    let p = first + second_order * (chi2_upper_tail(chi2, df + 4.0) - first);
    Ok(Mauchly { w: libm::exp(ln_w), chi2, df: df as usize, p: p.clamp(0.0, 1.0) })
}

/// Free elements of a covariance matrix beyond its scale.
fn covariance_df(d: f64) -> f64 {
    d * (d + 1.0) / 2.0 - 1.0
}

/// Logarithm of the determinant by elimination; `None` if the matrix is not positive definite beyond rounding.
fn ln_determinant(mut m: Vec<Vec<f64>>) -> Option<f64> {
    let negligible = 1e-12 * trace(&m);
    let mut sum = 0.0;
    for j in 0..m.len() {
        let row = m[j].clone();
        if row[j] <= negligible {
            return None;
        }
        sum += libm::log(row[j]);
        for below in &mut m[j + 1..] {
            let factor = below[j] / row[j];
            below.iter_mut().zip(&row).for_each(|(value, above)| *value -= factor * above);
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[[f64; 3]]) -> Sphericity {
        let names = |prefix: &str, count: usize| (1..=count).map(|i| format!("{prefix}{i}")).collect();
        let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
        let table = Table::complete(names("p", rows.len()), names("c", 3), rows).unwrap();
        sphericity(&table, 4.0)
    }

    // pingouin 0.7.0's own example, wide format: epsilon 0.56; sphericity W 0.21, chi2 4.677, df 2, p 0.096.
    #[test]
    fn pingouins_example() {
        let rows = [[2.2, 1.1, 8.2], [3.1, 2.5, 4.5], [4.3, 4.1, 3.4], [4.1, 5.2, 6.2], [7.2, 6.4, 7.2]];
        let s = of(&rows);
        let mauchly = s.mauchly.unwrap();
        assert!((s.epsilon - 0.5587754577585018).abs() < 1e-12);
        assert!((mauchly.w - 0.21037236).abs() < 1e-7 && (mauchly.chi2 - 4.676_6).abs() < 1e-3);
        assert_eq!((mauchly.df, (mauchly.p * 1000.0).round()), (2, 96.0));
    }

    #[test]
    fn two_participants_or_a_repeated_column_leave_mauchly_undefined() {
        assert_eq!(of(&[[1.0, 2.0, 4.0], [2.0, 5.0, 3.0]]).mauchly, Err(Undefined::SingularCovariance));
        let repeated = of(&[[1.0, 1.0, 4.0], [2.0, 2.0, 3.0], [5.0, 5.0, 5.5], [3.0, 3.0, 1.0]]);
        assert_eq!(repeated.mauchly, Err(Undefined::SingularCovariance));
        assert!((repeated.epsilon - 0.5).abs() < 1e-12);
    }
}
