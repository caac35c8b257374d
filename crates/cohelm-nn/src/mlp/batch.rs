//! Training's forward and backward pass of an [`Mlp`] over a batch.

use super::{Head, Mlp, MlpShape, combine};
use crate::dense::Layer;
use crate::dense_batch;
use crate::gemm::{transpose, vectorised};

/// Workspace for batches of up to a fixed number of rows. After it is made nothing allocates.
///
/// It belongs to a shape, not to a network: online and target networks may use one after the other. Threads
/// take one workspace each and a fixed chunk of the batch; adding up the chunks' gradients in their order
/// ([`add_in_order`](crate::adam::add_in_order)) gives the same sums for any number of threads.
#[derive(Debug, Clone)]
pub struct MlpBatch {
    shape: MlpShape,
    layers: Vec<Layer>,
    most_rows: usize,
    rows: usize,
    /// One a layer, `[rows][outputs]`: hidden layers after ReLU, the last one the head's linear outputs.
    activations: Vec<Vec<f32>>,
    /// What the caller sees, `[rows][outputs]`.
    outputs: Vec<f32>,
    /// Loss gradients of two neighbouring layers' outputs.
    delta: Vec<f32>,
    next_delta: Vec<f32>,
    /// The transpose of one layer's weights.
    transposed: Vec<f32>,
}

impl MlpBatch {
    /// Room for batches of up to `most_rows` rows.
    #[must_use]
    pub fn new(shape: &MlpShape, most_rows: usize) -> Self {
        let layers = shape.layers();
        Self {
            most_rows,
            rows: 0,
            activations: layers.iter().map(|l| vec![0.0; l.outputs * most_rows]).collect(),
            outputs: vec![0.0; shape.outputs() * most_rows],
            delta: vec![0.0; shape.widest() * most_rows],
            next_delta: vec![0.0; shape.widest() * most_rows],
            transposed: vec![0.0; layers.iter().map(|l| l.inputs * l.outputs).max().unwrap_or(0)],
            layers,
            shape: shape.clone(),
        }
    }

    /// Outputs `[rows][outputs]` of the batch `x` of shape `[rows][inputs]`; agrees with [`Mlp::forward`] to
    /// about 1e-6, not to the bit.
    ///
    /// # Panics
    /// If the network has another shape, `x` is not a whole number of rows, or there are too many.
    pub fn forward(&mut self, net: &Mlp, x: &[f32]) -> &[f32] {
        self.check(net, x);
        self.forward_params(net.params(), x)
    }

    /// The same of the network that lies at the beginning of `params`.
    pub(crate) fn forward_params(&mut self, params: &[f32], x: &[f32]) -> &[f32] {
        self.check_rows(x);
        self.rows = x.len() / self.shape.input;
        let rows = self.rows;
        let hidden = self.layers.len() - 1;
        for (i, layer) in self.layers.iter().enumerate() {
            let (before, from_here) = self.activations.split_at_mut(i);
            let input = before.last().map_or(x, Vec::as_slice);
            let y = &mut from_here[0][..rows * layer.outputs];
            dense_batch::forward(layer, params, i < hidden, &input[..rows * layer.inputs], y);
        }
        self.combine_rows();
        self.outputs()
    }

    /// The outputs `[rows][outputs]` of the last forward pass.
    #[must_use]
    pub fn outputs(&self) -> &[f32] {
        &self.outputs[..self.rows * self.shape.outputs()]
    }

    /// Writes the gradient of the parameters into `gradient` (which it replaces).
    ///
    /// `x` and `d_outputs` are the first rows of the batch of the last forward pass and the loss's gradient
    /// at their outputs; the rows behind them are taken to have no gradient. `net` must be unchanged since.
    ///
    /// # Panics
    /// If lengths do not fit, or there are more rows than the forward pass had.
    pub fn backward(&mut self, net: &Mlp, x: &[f32], d_outputs: &[f32], gradient: &mut [f32]) {
        self.check(net, x);
        assert_eq!(gradient.len(), net.params().len(), "one number for each parameter");
        self.backward_params(net.params(), x, d_outputs, gradient);
    }

    /// The same of the network that lies at the beginning of `params`, into the beginning of `gradient`.
    pub(crate) fn backward_params(
        &mut self,
        params: &[f32],
        x: &[f32],
        d_outputs: &[f32],
        gradient: &mut [f32],
    ) {
        self.check_rows(x);
        let rows = x.len() / self.shape.input;
        assert!(rows <= self.rows, "{rows} rows of gradient after a forward pass of {}", self.rows);
        assert_eq!(d_outputs.len(), rows * self.shape.outputs(), "one gradient for each output");
        uncombine(self.shape.head, d_outputs, &mut self.delta);
        for (i, layer) in self.layers.iter().enumerate().rev() {
            let input = if i == 0 { x } else { &self.activations[i - 1] };
            let delta = &self.delta[..rows * layer.outputs];
            dense_batch::gradient(layer, &input[..rows * layer.inputs], delta, gradient);
            if i > 0 {
                let next = &mut self.next_delta[..rows * layer.inputs];
                let transposed = &mut self.transposed[..layer.inputs * layer.outputs];
                transpose(layer.weights(params), layer.inputs, layer.outputs, transposed);
                dense_batch::backward(layer, transposed, delta, next);
                vectorised(|| mask(&self.activations[i - 1], next));
                std::mem::swap(&mut self.delta, &mut self.next_delta);
            }
        }
    }

    fn check(&self, net: &Mlp, x: &[f32]) {
        assert_eq!(net.shape(), &self.shape, "a workspace serves one shape");
        self.check_rows(x);
    }

    fn check_rows(&self, x: &[f32]) {
        assert_eq!(x.len() % self.shape.input, 0, "rows of {} numbers", self.shape.input);
        assert!(x.len() <= self.shape.input * self.most_rows, "at most {} rows", self.most_rows);
    }

    fn combine_rows(&mut self) {
        let head = self.shape.head;
        let linear = self.activations.last().expect("a shape has a head");
        let outputs = self.outputs.chunks_exact_mut(head.outputs());
        for (linear, outputs) in linear.chunks_exact(head.width()).zip(outputs).take(self.rows) {
            combine(head, linear, outputs);
        }
    }
}

/// No gradient passes where ReLU's output is 0.
#[inline(always)]
fn mask(activations: &[f32], delta: &mut [f32]) {
    for (d, &a) in delta.iter_mut().zip(activations) {
        *d = if a > 0.0 { *d } else { 0.0 };
    }
}

/// From the gradient at the outputs to the gradient at the head's linear layer.
fn uncombine(head: Head, d_outputs: &[f32], d_linear: &mut [f32]) {
    let Head::Dueling(n) = head else {
        d_linear[..d_outputs.len()].copy_from_slice(d_outputs);
        return;
    };
    for (dq, dl) in d_outputs.chunks_exact(n).zip(d_linear.chunks_exact_mut(n + 1)) {
        let sum = dq.iter().sum::<f32>();
        let mean = sum / n as f32;
        for (d, q) in dl.iter_mut().zip(dq) {
            *d = q - mean;
        }
        dl[n] = sum;
    }
}
