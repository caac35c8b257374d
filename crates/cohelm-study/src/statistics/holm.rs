//! Holm's step-down adjustment for several comparisons (1979).

/// Adjusts p values so that the chance of any false finding among them stays below the level used.
///
/// Order is kept. The smallest p is multiplied by their number, the next by one less, and so on; no adjusted value is
/// smaller than one before it or larger than 1. `None` (a comparison that could not be made) stays `None` and does not count.
pub fn holm(p_values: &[Option<f64>]) -> Vec<Option<f64>> {
    let mut order: Vec<usize> = (0..p_values.len()).filter(|&i| p_values[i].is_some()).collect();
    order.sort_by(|&i, &j| p_values[i].partial_cmp(&p_values[j]).unwrap_or(std::cmp::Ordering::Equal));
    let mut adjusted = vec![None; p_values.len()];
    let mut largest = 0.0_f64;
    for (rank, &i) in order.iter().enumerate() {
        let scaled = p_values[i].map_or(1.0, |p| p * (order.len() - rank) as f64);
        largest = largest.max(scaled.min(1.0));
        adjusted[i] = Some(largest);
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;

    // pingouin.multicomp([.5, .003, nan, .054, .0003], method="holm") is its documented example.
    #[test]
    fn pingouins_example_with_a_missing_value() {
        let adjusted = holm(&[Some(0.5), Some(0.003), None, Some(0.054), Some(0.0003)]);
        let expected = [Some(0.5), Some(0.009), None, Some(0.108), Some(0.0012)];
        for (ours, reference) in adjusted.iter().zip(expected) {
            assert_eq!(ours.is_some(), reference.is_some());
            assert!((ours.unwrap_or(0.0) - reference.unwrap_or(0.0)).abs() < 1e-15);
        }
    }

    #[test]
    fn never_above_one_never_out_of_order() {
        assert_eq!(holm(&[Some(0.9), Some(0.6)]), [Some(1.0), Some(1.0)]);
        assert_eq!(holm(&[Some(0.03), Some(0.02)]), [Some(0.04), Some(0.04)]);
        assert!(holm(&[]).is_empty());
    }
}
