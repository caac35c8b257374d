//! First values of parameters. Draws nothing by itself: uniform numbers in [0, 1) come from the caller.

/// Uniform in ±1/√fan_in: what PyTorch's `nn.Linear` gives weights (Kaiming uniform with a = √5) and biases.
/// With the hidden width for `fan_in` it is also what `nn.LSTM` does.
pub(crate) fn linear_default(fan_in: usize, params: &mut [f32], uniform: &mut impl FnMut() -> f32) {
    let bound = 1.0 / (fan_in as f32).sqrt();
    for p in params {
        *p = (2.0 * uniform() - 1.0) * bound;
    }
}
