//! Losses and their gradients, one row at a time.
//!
//! Each function returns the loss and gives its gradient; means over a batch are the caller's: pass `weight`
//! 1/rows and the gradients need no second pass.

use crate::math::softmax_log_sum;

/// Huber loss of an error (prediction − target): quadratic up to `delta`, linear beyond. Returns loss and
/// gradient; with `delta` 1 PyTorch's `smooth_l1_loss`.
#[inline]
#[must_use]
pub fn huber(error: f32, delta: f32) -> (f32, f32) {
    let size = error.abs();
    if size <= delta {
        (0.5 * error * error, error)
    } else {
        (delta * (size - 0.5 * delta), delta.copysign(error))
    }
}

/// Mean squared error over a row; writes `weight` times its gradient. PyTorch's `mse_loss` for one row.
///
/// # Panics
/// If the lengths differ.
pub fn mean_squared(prediction: &[f32], target: &[f32], weight: f32, gradient: &mut [f32]) -> f32 {
    assert!(prediction.len() == target.len() && prediction.len() == gradient.len(), "rows of one length");
    let n = prediction.len() as f32;
    let mut sum = 0.0;
    for ((d, p), t) in gradient.iter_mut().zip(prediction).zip(target) {
        let error = p - t;
        sum += error * error;
        *d = weight * 2.0 * error / n;
    }
    sum / n
}

/// Cross-entropy of softmax(logits) with the true class; writes `weight` times its gradient.
///
/// # Panics
/// If the lengths differ or `truth` is no class.
pub fn cross_entropy(logits: &[f32], truth: usize, weight: f32, gradient: &mut [f32]) -> f32 {
    assert!(truth < logits.len(), "class {truth} of {}", logits.len());
    gradient.copy_from_slice(logits);
    let loss = softmax_log_sum(gradient) - logits[truth];
    gradient[truth] -= 1.0;
    for d in gradient {
        *d *= weight;
    }
    loss
}
