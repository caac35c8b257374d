//! Invented numbers that look like a study's.

pub fn participants() -> Vec<String> {
    (1..=10).map(|i| format!("P{i}")).collect()
}

/// A number from −1 to 1 that looks random and is always the same.
pub fn wobble(seed: usize) -> f64 {
    let mut x = (seed as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x ^= x >> 31;
    x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^= x >> 29;
    (x % 2001) as f64 / 1000.0 - 1.0
}

/// Invented means of each participant under conditions with the given means.
pub fn values(means: &[f64], spread: f64) -> Vec<Vec<Option<f64>>> {
    let value = |c: usize, p: usize| means[c] + spread * (wobble(c * 31 + p) + 0.5 * wobble(p));
    (0..means.len()).map(|c| (0..10).map(|p| Some(value(c, p))).collect()).collect()
}

pub fn rates(means: &[f64], spread: f64) -> Vec<Vec<Option<f64>>> {
    let rate = |v: f64| (v.clamp(0.0, 1.0) * 40.0).round() / 40.0;
    values(means, spread).into_iter().map(|row| row.into_iter().map(|v| v.map(rate)).collect()).collect()
}
