//! The calibrated intent head: a network says where the pilot is going and how sure it is, and the goals at
//! hand compete for it.
//!
//! Outputs (μx, μy, ln σ) stand for a round Gaussian; the logit of a goal g is −|g − μ|² / (2σ²), and softmax
//! over the goals of the moment gives their probabilities. So the network never names a goal and works for
//! any number of them; trained by cross-entropy, σ learns how much the position is worth. Coordinates are in
//! whatever unit the caller uses for goals and training alike.

use crate::math::{exp, softmax};

/// Network outputs that the head needs: μx, μy and ln σ.
pub const OUTPUTS: usize = 3;
/// ln σ is held in ±this: σ from 0.0025 to 403 in the unit of the goals, beyond which squares lose all digits.
pub const LN_SIGMA_MOST: f32 = 6.0;

/// Writes the probability of each goal. Allocates nothing; the same bits everywhere.
///
/// # Panics
/// If `probabilities` is not as long as `goals` or the outputs are not [`OUTPUTS`].
pub fn probabilities(outputs: &[f32], goals: &[[f32; 2]], probabilities: &mut [f32]) {
    assert_eq!(goals.len(), probabilities.len(), "one number a goal");
    let gaussian = Gaussian::from_outputs(outputs);
    for (p, goal) in probabilities.iter_mut().zip(goals) {
        *p = gaussian.logit(goal);
    }
    softmax(probabilities);
}

/// What the three outputs stand for.
struct Gaussian {
    mean: [f32; 2],
    /// 1/σ², ln σ held in its range.
    precision: f32,
}

impl Gaussian {
    fn from_outputs(outputs: &[f32]) -> Self {
        assert_eq!(outputs.len(), OUTPUTS, "mean x, mean y and ln sigma");
        let ln_sigma = outputs[2].clamp(-LN_SIGMA_MOST, LN_SIGMA_MOST);
        Self { mean: [outputs[0], outputs[1]], precision: exp(-2.0 * ln_sigma) }
    }

    /// −|g − μ|² / (2σ²).
    fn logit(&self, goal: &[f32; 2]) -> f32 {
        let (dx, dy) = (goal[0] - self.mean[0], goal[1] - self.mean[1]);
        -0.5 * self.precision * (dx * dx + dy * dy)
    }
}

/// Cross-entropy with the goal `goals[truth]`; writes `weight` times the gradient at the three outputs.
///
/// Beyond its range ln σ has no gradient except back into it.
///
/// # Panics
/// If `truth` is no goal, or outputs and gradient are not [`OUTPUTS`].
#[cfg(feature = "train")]
pub fn cross_entropy(
    outputs: &[f32],
    goals: &[[f32; 2]],
    truth: usize,
    weight: f32,
    gradient: &mut [f32],
) -> f32 {
    let gaussian = Gaussian::from_outputs(outputs);
    let logits = || goals.iter().map(|goal| gaussian.logit(goal));
    let largest = logits().fold(f32::NEG_INFINITY, f32::max);
    let sum: f32 = logits().map(|logit| exp(logit - largest)).sum();
    let mut d = [0.0; OUTPUTS];
    for (i, (goal, logit)) in goals.iter().zip(logits()).enumerate() {
        let hit = if i == truth { 1.0 } else { 0.0 };
        let d_logit = weight * (exp(logit - largest) / sum - hit);
        d[0] += d_logit * gaussian.precision * (goal[0] - gaussian.mean[0]);
        d[1] += d_logit * gaussian.precision * (goal[1] - gaussian.mean[1]);
        d[2] += d_logit * -2.0 * logit;
    }
    let leaving = outputs[2].abs() > LN_SIGMA_MOST && d[2] * outputs[2] < 0.0;
    if leaving {
        d[2] = 0.0;
    }
    gradient.copy_from_slice(&d);
    largest + crate::math::ln(sum) - gaussian.logit(&goals[truth])
}

/// −ln of the Gaussian's density at `target`, but for a constant: |target − μ|² / (2σ²) + 2 ln σ. Writes `weight` times the
/// gradient at the three outputs. For a network that knows no goals: σ learns how far off the position is.
///
/// Beyond its range ln σ has no gradient except back into it.
///
/// # Panics
/// If outputs and gradient are not [`OUTPUTS`].
#[cfg(feature = "train")]
pub fn surprise(outputs: &[f32], target: &[f32; 2], weight: f32, gradient: &mut [f32]) -> f32 {
    let gaussian = Gaussian::from_outputs(outputs);
    let logit = gaussian.logit(target);
    let pull = |i: usize| -weight * gaussian.precision * (target[i] - gaussian.mean[i]);
    let mut of_spread = weight * (2.0 + 2.0 * logit);
    if outputs[2].abs() > LN_SIGMA_MOST && of_spread * outputs[2] < 0.0 {
        of_spread = 0.0;
    }
    gradient.copy_from_slice(&[pull(0), pull(1), of_spread]);
    2.0 * outputs[2].clamp(-LN_SIGMA_MOST, LN_SIGMA_MOST) - logit
}
