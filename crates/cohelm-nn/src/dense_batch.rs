//! One linear layer of training: forward and backward over many rows.

use crate::dense::Layer;
use crate::gemm::{Around, Left, multiply, vectorised};

/// y = b + x·W for every row of `x`, negative numbers becoming 0 if `relu`.
pub(crate) fn forward(layer: &Layer, params: &[f32], relu: bool, x: &[f32], y: &mut [f32]) {
    let x = Left::new(x, y.len() / layer.outputs, layer.inputs);
    let around = Around { bias: Some(layer.bias(params)), relu };
    multiply(x, layer.weights(params), layer.outputs, around, y);
}

/// Writes the gradient of the layer's parameters, from its input and the gradient `d_y` at its outputs.
pub(crate) fn gradient(layer: &Layer, x: &[f32], d_y: &[f32], gradient: &mut [f32]) {
    let gradient = &mut gradient[layer.start..layer.end()];
    let (d_weights, d_bias) = gradient.split_at_mut(layer.inputs * layer.outputs);
    let x = Left::new(x, d_y.len() / layer.outputs, layer.inputs);
    multiply(x.transposed(), d_y, layer.outputs, Around::default(), d_weights);
    vectorised(|| sum_rows(d_y, d_bias));
}

/// Writes the gradient at the layer's inputs, given the transpose of its weights.
pub(crate) fn backward(layer: &Layer, transposed_weights: &[f32], d_y: &[f32], d_x: &mut [f32]) {
    let d_y = Left::new(d_y, d_y.len() / layer.outputs, layer.outputs);
    multiply(d_y, transposed_weights, layer.inputs, Around::default(), d_x);
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
