//! A critic Q(s, a) for actions with axes, in two towers that meet in one product.
//!
//! Q(s, a) = V(s) + w(s) · (φ(a) − φ̄), where φ(a) = ReLU(f(a)·W + b) are features of the action, f(a) is how the caller
//! encodes it, and V and w are outputs of a multilayer perceptron on the state. φ̄ is the mean of φ over a set of actions of
//! reference, which leaves V nothing but the state's value, as the mean over all actions does in a dueling head.
//!
//! The towers are apart so that many candidates cost little: the state's is run once a decision, φ of actions that are
//! always candidates once a model, and what is left for a candidate is one product as long as φ. Nothing is lost by it but
//! rank: any continuous Q is a sum of products of functions of s and functions of a, if there are enough of them (Lu et al.
//! 2021, DeepONet, theorem 1).
//!
//! Here: shape, parameters and the control loop's forward pass. Training's is in [`CriticBatch`].

#[cfg(feature = "train")]
mod batch;

#[cfg(feature = "train")]
pub use batch::CriticBatch;

use crate::dense::{Layer, accumulate};
use crate::init::linear_default;
use crate::mlp::{Head, MlpScratch, MlpShape, forward_layers};
use crate::shape::{ShapeError, check_width};

/// Widths of both towers; valid by construction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CriticShape {
    state: MlpShape,
    action: usize,
    width: usize,
}

impl CriticShape {
    /// `input` numbers of the state, ReLU layers of the widths in `hidden` on them, `action` numbers that encode an action,
    /// and `width` features φ made of those.
    ///
    /// # Errors
    /// A width of 0 or above [`MAX_WIDTH`](crate::shape::MAX_WIDTH), or more than
    /// [`MAX_HIDDEN_LAYERS`](crate::mlp::MAX_HIDDEN_LAYERS).
    pub fn new(input: usize, hidden: &[usize], action: usize, width: usize) -> Result<Self, ShapeError> {
        check_width("action", action)?;
        check_width("features", width)?;
        Ok(Self { state: MlpShape::new(input, hidden, Head::Plain(width + 1))?, action, width })
    }

    /// Numbers of the state that go in.
    #[must_use]
    pub fn input(&self) -> usize {
        self.state.input()
    }

    /// Widths of the hidden layers of the state's tower.
    #[must_use]
    pub fn hidden(&self) -> &[usize] {
        self.state.hidden()
    }

    /// Numbers that encode an action.
    #[must_use]
    pub fn action(&self) -> usize {
        self.action
    }

    /// Features φ of an action.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Length of the flat parameters.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.action_layer().end()
    }

    /// The state's tower: outputs w, then V.
    pub(crate) fn state_tower(&self) -> &MlpShape {
        &self.state
    }

    /// The layer of the action's tower, behind the state's in the flat parameters.
    pub(crate) fn action_layer(&self) -> Layer {
        Layer { inputs: self.action, outputs: self.width, start: self.state.parameters() }
    }
}

/// One number of an encoded action: its place and what stands there. Numbers left out are 0.
pub type Feature = (usize, f32);

/// A critic: its shape and one flat vector of parameters, the state's tower as an [`Mlp`](crate::mlp::Mlp)'s, then the
/// action's layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Critic {
    shape: CriticShape,
    state: Vec<Layer>,
    action: Layer,
    params: Vec<f32>,
}

impl Critic {
    /// New parameters as PyTorch's `nn.Linear` draws them; `uniform` gives numbers in [0, 1) and is called once a
    /// parameter, in the order of the flat parameters.
    #[must_use]
    pub fn new(shape: &CriticShape, mut uniform: impl FnMut() -> f32) -> Self {
        let mut critic = Self::zeros(shape);
        for layer in critic.state.iter().chain([&critic.action]) {
            linear_default(layer.inputs, &mut critic.params[layer.start..layer.end()], &mut uniform);
        }
        critic
    }

    /// All parameters 0.
    #[must_use]
    pub fn zeros(shape: &CriticShape) -> Self {
        let (state, action) = (shape.state.layers(), shape.action_layer());
        Self { state, action, params: vec![0.0; shape.parameters()], shape: shape.clone() }
    }

    /// The shape.
    #[must_use]
    pub fn shape(&self) -> &CriticShape {
        &self.shape
    }

    /// The flat parameters.
    #[must_use]
    pub fn params(&self) -> &[f32] {
        &self.params
    }

    /// The flat parameters, to be changed by an optimiser.
    pub fn params_mut(&mut self) -> &mut [f32] {
        &mut self.params
    }

    /// Runs the state's tower; what it found stays in `scratch` for [`values`](Self::values). Like
    /// [`Mlp::forward`](crate::mlp::Mlp::forward) it allocates nothing and gives the same bits everywhere.
    ///
    /// # Panics
    /// If `x` has not [`CriticShape::input`] numbers or `scratch` was made for another shape.
    pub fn look(&self, x: &[f32], scratch: &mut CriticScratch) {
        forward_layers(&self.shape.state, &self.state, &self.params, x, &mut scratch.state);
    }

    /// φ(a) of an encoded action, the numbers of which come in any fixed order.
    ///
    /// # Panics
    /// If a place is not below [`CriticShape::action`], or `phi` is not [`CriticShape::width`] long.
    pub fn embed(&self, action: &[Feature], phi: &mut [f32]) {
        let mut done = 0;
        while phi.len() - done >= 32 {
            self.embed_block::<32>(action, phi, done);
            done += 32;
        }
        while phi.len() > done {
            self.embed_block::<1>(action, phi, done);
            done += 1;
        }
    }

    /// `N` neighbouring features, whose sums stay in registers.
    fn embed_block<const N: usize>(&self, action: &[Feature], phi: &mut [f32], first: usize) {
        let (weights, width) = (self.action.weights(&self.params), phi.len());
        let mut sums = [0.0; N];
        sums.copy_from_slice(&self.action.bias(&self.params)[first..][..N]);
        for &(place, number) in action {
            let row = &weights[place * width + first..][..N];
            for (sum, &weight) in sums.iter_mut().zip(row) {
                *sum += number * weight;
            }
        }
        for (phi, sum) in phi[first..][..N].iter_mut().zip(sums) {
            *phi = if sum > 0.0 { sum } else { 0.0 };
        }
    }

    /// Q(s, a) of every one of some actions, in the state that was looked at last.
    ///
    /// # Panics
    /// If there are not as many values as actions, or if these were made for another shape.
    pub fn values(&self, scratch: &CriticScratch, actions: &Embedded, values: &mut [f32]) {
        assert_eq!(values.len(), actions.count, "one value for each action");
        assert_eq!(actions.columns.len(), actions.count * self.shape.width, "actions of this shape");
        let (value, weights) = scratch.state.outputs().split_last().expect("V is always there");
        values.fill(*value);
        accumulate(&actions.columns, weights, values);
    }
}

/// Actions as the critic weighs them: φ(a) − φ̄ of each, one feature after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Embedded {
    count: usize,
    columns: Vec<f32>,
}

impl Embedded {
    /// Room for that many actions of a critic of this shape.
    #[must_use]
    pub fn new(shape: &CriticShape, count: usize) -> Self {
        Self { count, columns: vec![0.0; shape.width * count] }
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Sets one of them, given φ(a) and the mean φ̄ of the actions of reference.
    ///
    /// # Panics
    /// If there is no such place or the lengths are not those of the shape.
    pub fn set(&mut self, index: usize, phi: &[f32], mean: &[f32]) {
        assert!(index < self.count, "action {index} of {}", self.count);
        let column = self.columns[index..].iter_mut().step_by(self.count);
        for (place, (phi, mean)) in column.zip(phi.iter().zip(mean)) {
            *place = phi - mean;
        }
    }
}

/// Buffers of the control loop's forward pass, made once for a shape.
#[derive(Debug, Clone)]
pub struct CriticScratch {
    state: MlpScratch,
}

impl CriticScratch {
    /// Buffers for critics of this shape.
    #[must_use]
    pub fn new(shape: &CriticShape) -> Self {
        Self { state: MlpScratch::new(&shape.state) }
    }

    /// What the state's tower found in the state that was looked at last: w(s), one number a feature, and then V(s).
    #[must_use]
    pub fn outputs(&self) -> &[f32] {
        self.state.outputs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One input, no hidden layer, two numbers of an action, one feature: w = 2x + 1, V = −x, φ = ReLU(a₀ − a₁ + 0.5).
    fn by_hand() -> Critic {
        let shape = CriticShape::new(1, &[], 2, 1).unwrap();
        let mut critic = Critic::zeros(&shape);
        critic.params_mut().copy_from_slice(&[2.0, -1.0, 1.0, 0.0, 1.0, -1.0, 0.5]);
        critic
    }

    #[test]
    fn two_towers_by_hand() {
        let critic = by_hand();
        let mut phi = [9.0];
        let mut embed = |action: &[Feature]| {
            critic.embed(action, &mut phi);
            phi[0]
        };
        assert_eq!((embed(&[(0, 1.0), (1, 0.25)]), embed(&[(1, 2.0)]), embed(&[])), (1.25, 0.0, 0.5));
        let mut actions = Embedded::new(critic.shape(), 3);
        for (index, phi) in [1.25, 0.0, 0.5].into_iter().enumerate() {
            actions.set(index, &[phi], &[0.25]);
        }
        let mut scratch = CriticScratch::new(critic.shape());
        let mut values = [0.0; 3];
        critic.look(&[3.0], &mut scratch);
        critic.values(&scratch, &actions, &mut values);
        assert_eq!(values, [-3.0 + 7.0 * 1.0, -3.0 - 7.0 * 0.25, -3.0 + 7.0 * 0.25]);
    }

    #[test]
    fn the_parameters_lie_one_tower_behind_the_other() {
        let shape = CriticShape::new(13, &[64, 64], 22, 64).unwrap();
        assert_eq!(shape.parameters(), 14 * 64 + 65 * 64 + 65 * 65 + 23 * 64);
        assert!(CriticShape::new(13, &[64], 0, 64).is_err());
    }
}
