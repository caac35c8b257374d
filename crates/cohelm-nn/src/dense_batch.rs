//! One linear layer of training: forward and backward over many rows, on the GEMM library.

use crate::dense::Layer;
use crate::gemm::{Matrix, multiply};

/// y = b + x·W for every row of `x`.
pub(crate) fn forward(layer: &Layer, params: &[f32], x: Matrix, y: &mut [f32]) {
    for row in y.chunks_exact_mut(layer.outputs) {
        row.copy_from_slice(layer.bias(params));
    }
    multiply(x, Matrix::new(layer.weights(params), layer.inputs, layer.outputs), true, y);
}

/// Writes the gradient of the layer's parameters, from its input and the gradient `d_y` at its outputs.
pub(crate) fn gradient(layer: &Layer, x: Matrix, d_y: &[f32], gradient: &mut [f32]) {
    let gradient = &mut gradient[layer.start..layer.end()];
    let (d_weights, d_bias) = gradient.split_at_mut(layer.inputs * layer.outputs);
    let rows = d_y.len() / layer.outputs;
    multiply(x.transposed(), Matrix::new(d_y, rows, layer.outputs), false, d_weights);
    sum_rows(d_y, d_bias);
}

/// Writes the gradient at the layer's inputs.
pub(crate) fn backward(layer: &Layer, params: &[f32], d_y: &[f32], d_x: &mut [f32]) {
    let rows = d_y.len() / layer.outputs;
    let weights = Matrix::new(layer.weights(params), layer.inputs, layer.outputs);
    multiply(Matrix::new(d_y, rows, layer.outputs), weights.transposed(), false, d_x);
}

/// Column sums of a matrix of rows as long as `sums`, first row first.
fn sum_rows(rows: &[f32], sums: &mut [f32]) {
    sums.fill(0.0);
    for row in rows.chunks_exact(sums.len()) {
        for (sum, x) in sums.iter_mut().zip(row) {
            *sum += x;
        }
    }
}
