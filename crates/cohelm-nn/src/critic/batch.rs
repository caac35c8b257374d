//! Training's forward and backward pass of a [`Critic`] over a batch.

use super::{Critic, CriticShape};
use crate::dense_batch;
use crate::gemm::{Around, Left, multiply, transpose, vectorised};
use crate::mlp::MlpBatch;

/// Workspace for batches of up to a fixed number of states and of actions. After it is made nothing allocates.
///
/// Actions are encoded in full here, `[actions][numbers]`.
#[derive(Debug, Clone)]
pub struct CriticBatch {
    shape: CriticShape,
    state: MlpBatch,
    /// The actions of reference, over which the mean φ̄ goes.
    reference: Vec<f32>,
    /// φ: first of the actions of reference, then of those of the batch, `[actions][width]`.
    phi: Vec<f32>,
    mean: Vec<f32>,
    /// φ − φ̄ of the batch's actions, transposed: `[width][actions]`.
    columns: Vec<f32>,
    weights: Vec<f32>,
    values: Vec<f32>,
    d_phi: Vec<f32>,
    d_state: Vec<f32>,
    /// The encodings that belong to the rows of `phi`.
    encoded: Vec<f32>,
}

impl CriticBatch {
    /// Room for batches of up to `most_rows` states and `most_actions` actions. `reference` are the encoded actions over
    /// which φ̄ is the mean.
    ///
    /// # Panics
    /// If `reference` is not a whole number of actions, or none.
    #[must_use]
    pub fn new(shape: &CriticShape, reference: &[f32], most_rows: usize, most_actions: usize) -> Self {
        let (width, action) = (shape.width(), shape.action());
        assert!(!reference.is_empty() && reference.len() % action == 0, "actions of {action} numbers");
        let actions = reference.len() / action + most_actions;
        Self {
            state: MlpBatch::new(shape.state_tower(), most_rows),
            phi: vec![0.0; actions * width],
            mean: vec![0.0; width],
            columns: vec![0.0; width * most_actions],
            weights: vec![0.0; most_rows * width],
            values: vec![0.0; most_rows * most_actions.max(1)],
            d_phi: vec![0.0; actions * width],
            d_state: vec![0.0; most_rows * (width + 1)],
            encoded: Vec::with_capacity(actions * action),
            reference: reference.to_vec(),
            shape: shape.clone(),
        }
    }

    /// Q of every one of `actions` in every state of `x`: `[states][actions]`. Agrees with [`Critic::values`] to about
    /// 1e-6, not to the bit.
    ///
    /// # Panics
    /// If the critic has another shape, or there are too many states or actions.
    pub fn every(&mut self, critic: &Critic, x: &[f32], actions: &[f32]) -> &[f32] {
        let (rows, count) = self.forward(critic, x, actions);
        let width = self.shape.width();
        let phi = &self.phi[self.references() * width..][..count * width];
        transpose(phi, count, width, &mut self.columns[..width * count]);
        let (columns, mean) = (&mut self.columns[..width * count], &self.mean);
        vectorised(|| {
            for (column, mean) in columns.chunks_exact_mut(count).zip(mean) {
                column.iter_mut().for_each(|phi| *phi -= mean);
            }
        });
        let outputs = self.state.outputs();
        for (weights, output) in self.weights.chunks_exact_mut(width).zip(outputs.chunks_exact(width + 1)) {
            weights.copy_from_slice(&output[..width]);
        }
        let values = &mut self.values[..rows * count];
        let weights = Left::new(&self.weights, rows, width);
        multiply(weights, &self.columns[..width * count], count, Around::default(), values);
        vectorised(|| {
            for (values, output) in values.chunks_exact_mut(count).zip(outputs.chunks_exact(width + 1)) {
                values.iter_mut().for_each(|q| *q += output[width]);
            }
        });
        &self.values[..rows * count]
    }

    /// Q of one action a state: the i-th of `actions` in the i-th state of `x`.
    ///
    /// # Panics
    /// If the critic has another shape, or there are too many or not as many actions as states.
    pub fn each(&mut self, critic: &Critic, x: &[f32], actions: &[f32]) -> &[f32] {
        let (rows, count) = self.forward(critic, x, actions);
        assert_eq!(rows, count, "one action a state");
        let width = self.shape.width();
        let phi = self.phi[self.references() * width..].chunks_exact(width);
        let outputs = self.state.outputs().chunks_exact(width + 1);
        for (value, (output, phi)) in self.values.iter_mut().zip(outputs.zip(phi)).take(rows) {
            let products = output.iter().zip(phi.iter().zip(&self.mean));
            *value = products.fold(output[width], |sum, (w, (phi, mean))| sum + w * (phi - mean));
        }
        &self.values[..rows]
    }

    /// Writes the gradient of the parameters into `gradient` (which it replaces), after [`each`](Self::each) of the same
    /// critic and states; `d_values` is the loss's gradient at its values.
    ///
    /// # Panics
    /// If lengths do not fit.
    pub fn backward(&mut self, critic: &Critic, x: &[f32], d_values: &[f32], gradient: &mut [f32]) {
        let (width, references, rows) = (self.shape.width(), self.references(), d_values.len());
        assert_eq!(gradient.len(), critic.params().len(), "one number for each parameter");
        assert_eq!(x.len(), rows * self.shape.input(), "one gradient for each state");
        let d_state = &mut self.d_state[..rows * (width + 1)];
        let (of_reference, of_rows) =
            self.d_phi[..(references + rows) * width].split_at_mut(references * width);
        let (d_mean, _) = of_reference.split_at_mut(width);
        d_mean.fill(0.0);
        let phi = self.phi[references * width..].chunks_exact(width);
        let outputs = self.state.outputs().chunks_exact(width + 1);
        let steps = d_values.iter().zip(outputs.zip(phi));
        let room = d_state.chunks_exact_mut(width + 1).zip(of_rows.chunks_exact_mut(width));
        let mean = &self.mean;
        vectorised(|| {
            for ((&d, (output, phi)), (d_state, d_phi)) in steps.zip(room) {
                d_state[width] = d;
                for (d_state, (phi, mean)) in d_state.iter_mut().zip(phi.iter().zip(mean)) {
                    *d_state = d * (phi - mean);
                }
                for (d_phi, (d_mean, weight)) in d_phi.iter_mut().zip(d_mean.iter_mut().zip(output)) {
                    *d_phi = d * weight;
                    *d_mean -= *d_phi;
                }
            }
        });
        // Every action of reference has its share in the mean.
        let share = 1.0 / references as f32;
        d_mean.iter_mut().for_each(|d| *d *= share);
        for reference in 1..references {
            of_reference.copy_within(..width, reference * width);
        }
        let layer = self.shape.action_layer();
        let (of_state, _) = gradient.split_at_mut(layer.start);
        self.state.backward_params(critic.params(), x, d_state, of_state);
        let d_phi = &mut self.d_phi[..(references + rows) * width];
        let phi = &self.phi[..d_phi.len()];
        vectorised(|| {
            for (d, &phi) in d_phi.iter_mut().zip(phi) {
                *d = if phi > 0.0 { *d } else { 0.0 };
            }
        });
        dense_batch::gradient(&layer, &self.encoded, d_phi, gradient);
    }

    /// Runs both towers; returns how many states and actions there are.
    fn forward(&mut self, critic: &Critic, x: &[f32], actions: &[f32]) -> (usize, usize) {
        assert_eq!(critic.shape(), &self.shape, "a workspace serves one shape");
        let (layer, width) = (self.shape.action_layer(), self.shape.width());
        assert_eq!(actions.len() % layer.inputs, 0, "actions of {} numbers", layer.inputs);
        self.state.forward_params(critic.params(), x);
        self.encoded.clear();
        self.encoded.extend_from_slice(&self.reference);
        self.encoded.extend_from_slice(actions);
        let phi = &mut self.phi[..self.encoded.len() / layer.inputs * width];
        dense_batch::forward(&layer, critic.params(), true, &self.encoded, phi);
        let references = self.reference.len() / layer.inputs;
        let (mean, reference) = (&mut self.mean, &self.phi[..references * width]);
        mean.fill(0.0);
        for phi in reference.chunks_exact(width) {
            mean.iter_mut().zip(phi).for_each(|(mean, phi)| *mean += phi);
        }
        mean.iter_mut().for_each(|mean| *mean /= references as f32);
        (x.len() / self.shape.input(), actions.len() / layer.inputs)
    }

    fn references(&self) -> usize {
        self.reference.len() / self.shape.action()
    }
}
