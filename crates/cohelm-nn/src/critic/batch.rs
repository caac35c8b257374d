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
    /// States looked at last.
    rows: usize,
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
            rows: 0,
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

    /// Runs the state's tower on the states `x`, `[states][inputs]`.
    ///
    /// # Panics
    /// If the critic has another shape, `x` is not a whole number of states, or there are too many.
    pub fn look(&mut self, critic: &Critic, x: &[f32]) {
        assert_eq!(critic.shape(), &self.shape, "a workspace serves one shape");
        self.state.forward_params(critic.params(), x);
        self.rows = x.len() / self.shape.input();
    }

    /// Q of every one of `actions` in every state that the same critic looked at last: `[states][actions]`. Agrees with
    /// [`Critic::values`] to about 1e-6, not to the bit.
    ///
    /// # Panics
    /// If the critic has another shape, or there are too many actions.
    pub fn every(&mut self, critic: &Critic, actions: &[f32]) -> &[f32] {
        let (rows, count, width) = (self.rows, self.embed(critic, actions), self.shape.width());
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

    /// Q of one action a state: the i-th of `actions` in the i-th of the states that the same critic looked at last, of
    /// which there may be more.
    ///
    /// # Panics
    /// If the critic has another shape, or there are more actions than states.
    pub fn each(&mut self, critic: &Critic, actions: &[f32]) -> &[f32] {
        let count = self.embed(critic, actions);
        assert!(count <= self.rows, "{count} actions in {} states", self.rows);
        let width = self.shape.width();
        let phi = self.phi[self.references() * width..].chunks_exact(width);
        let outputs = self.state.outputs().chunks_exact(width + 1);
        let (values, mean) = (&mut self.values[..count], &self.mean);
        vectorised(|| {
            for (value, (output, phi)) in values.iter_mut().zip(outputs.zip(phi)) {
                *value = output[width] + product(&output[..width], phi, mean);
            }
        });
        &self.values[..count]
    }

    /// Writes the gradient of the parameters into `gradient` (which it replaces), after [`each`](Self::each) of the same
    /// critic; `x` are the states that it valued and `d_values` is the loss's gradient at its values.
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

    /// Runs the action's tower on the actions of reference and on others; returns how many others there are.
    fn embed(&mut self, critic: &Critic, actions: &[f32]) -> usize {
        assert_eq!(critic.shape(), &self.shape, "a workspace serves one shape");
        let (layer, width) = (self.shape.action_layer(), self.shape.width());
        assert_eq!(actions.len() % layer.inputs, 0, "actions of {} numbers", layer.inputs);
        self.encoded.clear();
        self.encoded.extend_from_slice(&self.reference);
        self.encoded.extend_from_slice(actions);
        let phi = &mut self.phi[..self.encoded.len() / layer.inputs * width];
        dense_batch::forward(&layer, critic.params(), true, &self.encoded, phi);
        let references = self.reference.len() / layer.inputs;
        let (mean, reference) = (&mut self.mean, &self.phi[..references * width]);
        vectorised(|| {
            mean.fill(0.0);
            for phi in reference.chunks_exact(width) {
                mean.iter_mut().zip(phi).for_each(|(mean, phi)| *mean += phi);
            }
            mean.iter_mut().for_each(|mean| *mean /= references as f32);
        });
        actions.len() / layer.inputs
    }

    fn references(&self) -> usize {
        self.reference.len() / self.shape.action()
    }
}

/// Sums that run side by side in [`product`].
const SUMS: usize = 16;

/// w · (φ − φ̄), as sixteen sums side by side that are added up at the end: the same bits for any width of registers.
#[inline(always)]
fn product(weights: &[f32], phi: &[f32], mean: &[f32]) -> f32 {
    let mut sums = [0.0; SUMS];
    let blocks = weights.chunks_exact(SUMS).zip(phi.chunks_exact(SUMS).zip(mean.chunks_exact(SUMS)));
    for (weights, (phi, mean)) in blocks {
        for k in 0..SUMS {
            sums[k] += weights[k] * (phi[k] - mean[k]);
        }
    }
    let whole = weights.len() / SUMS * SUMS;
    let rest = weights[whole..].iter().zip(phi[whole..].iter().zip(&mean[whole..]));
    rest.fold(sums.iter().sum(), |sum, (weight, (phi, mean))| sum + weight * (phi - mean))
}
