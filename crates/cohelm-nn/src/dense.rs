//! One linear layer of the control loop: y = b + x·W, its order of summation fixed here.
//!
//! Each output is one sum that runs over the inputs from first to last; only the outputs share vector
//! registers. So the bits do not depend on how wide those registers are. Weights lie input-major
//! (`weights[input * outputs + output]`), which makes that inner loop contiguous.

/// Where one layer lies in a network's flat parameters: weights `[inputs][outputs]`, then biases `[outputs]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layer {
    pub inputs: usize,
    pub outputs: usize,
    pub start: usize,
}

impl Layer {
    /// Parameters of the layer, biases included.
    pub fn len(&self) -> usize {
        (self.inputs + 1) * self.outputs
    }

    /// The first index behind the layer.
    pub fn end(&self) -> usize {
        self.start + self.len()
    }

    pub fn weights<'a>(&self, params: &'a [f32]) -> &'a [f32] {
        &params[self.start..self.start + self.inputs * self.outputs]
    }

    pub fn bias<'a>(&self, params: &'a [f32]) -> &'a [f32] {
        &params[self.start + self.inputs * self.outputs..self.end()]
    }

    /// y = b + x·W.
    pub fn forward(&self, params: &[f32], x: &[f32], y: &mut [f32]) {
        y.copy_from_slice(self.bias(params));
        accumulate(self.weights(params), x, y);
    }
}

/// y += x·W with W of shape `[x.len()][y.len()]`.
pub(crate) fn accumulate(weights: &[f32], x: &[f32], y: &mut [f32]) {
    let outputs = y.len();
    debug_assert_eq!(weights.len(), x.len() * outputs);
    let mut done = 0;
    while outputs - done >= 32 {
        block::<32>(weights, outputs, done, x, y);
        done += 32;
    }
    while outputs - done >= 8 {
        block::<8>(weights, outputs, done, x, y);
        done += 8;
    }
    while outputs - done >= 4 {
        block::<4>(weights, outputs, done, x, y);
        done += 4;
    }
    while outputs > done {
        block::<1>(weights, outputs, done, x, y);
        done += 1;
    }
}

/// The same for `N` neighbouring outputs, whose sums stay in registers.
#[inline(always)]
fn block<const N: usize>(weights: &[f32], outputs: usize, first: usize, x: &[f32], y: &mut [f32]) {
    let y = &mut y[first..first + N];
    let mut sums = [0.0; N];
    sums.copy_from_slice(y);
    for (&x, row) in x.iter().zip(weights.chunks_exact(outputs)) {
        let row = &row[first..first + N];
        for (sum, &w) in sums.iter_mut().zip(row) {
            *sum += x * w;
        }
    }
    y.copy_from_slice(&sums);
}
