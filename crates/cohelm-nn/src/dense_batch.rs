//! One linear layer of training: forward and backward over many rows.

use crate::dense::Layer;
use crate::gemm::{Left, multiply, vectorised};

/// y = b + x·W for every row of `x`.
pub(crate) fn forward(layer: &Layer, params: &[f32], x: &[f32], y: &mut [f32]) {
    let bias = layer.bias(params);
    vectorised(|| y.chunks_exact_mut(bias.len()).for_each(|row| row.copy_from_slice(bias)));
    let x = Left::new(x, y.len() / layer.outputs, layer.inputs);
    multiply(x, layer.weights(params), layer.outputs, true, y);
}

/// Writes the gradient of the layer's parameters, from its input and the gradient `d_y` at its outputs.
pub(crate) fn gradient(layer: &Layer, x: &[f32], d_y: &[f32], gradient: &mut [f32]) {
    let gradient = &mut gradient[layer.start..layer.end()];
    let (d_weights, d_bias) = gradient.split_at_mut(layer.inputs * layer.outputs);
    let x = Left::new(x, d_y.len() / layer.outputs, layer.inputs);
    multiply(x.transposed(), d_y, layer.outputs, false, d_weights);
    vectorised(|| sum_rows(d_y, d_bias));
}

/// Writes the gradient at the layer's inputs, given the transpose of its weights.
pub(crate) fn backward(layer: &Layer, transposed_weights: &[f32], d_y: &[f32], d_x: &mut [f32]) {
    let d_y = Left::new(d_y, d_y.len() / layer.outputs, layer.outputs);
    multiply(d_y, transposed_weights, layer.inputs, false, d_x);
}

/// Column sums of a matrix of rows as long as `sums`, first row first.
#[inline(always)]
fn sum_rows(rows: &[f32], sums: &mut [f32]) {
    sums.fill(0.0);
    for row in rows.chunks_exact(sums.len()) {
        for (sum, x) in sums.iter_mut().zip(row) {
            *sum += x;
        }
    }
}
