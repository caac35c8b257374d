//! A multilayer perceptron with ReLU between its layers and a plain or a dueling head.
//!
//! Here: shape, parameters and the control loop's forward pass. Training's is in [`MlpBatch`].
//!
//! The dueling head (Wang et al. 2016, Eq. 9) is one linear layer of n + 1 outputs, n advantages and last the
//! state's value V: Q(a) = V + A(a) − mean A.

#[cfg(feature = "train")]
mod batch;

#[cfg(feature = "train")]
pub use batch::MlpBatch;

use crate::dense::Layer;
use crate::init::linear_default;
use crate::shape::{ShapeError, check_width};

/// Most hidden layers that a shape may have.
pub const MAX_HIDDEN_LAYERS: usize = 8;

/// What the last layer means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Head {
    /// This many linear outputs.
    Plain(usize),
    /// Q-values of this many actions, made of advantages and a state value.
    Dueling(usize),
}

impl Head {
    /// Outputs that a caller sees.
    #[must_use]
    pub fn outputs(self) -> usize {
        match self {
            Head::Plain(n) | Head::Dueling(n) => n,
        }
    }

    /// Outputs of the linear layer under the head.
    fn width(self) -> usize {
        match self {
            Head::Plain(n) => n,
            Head::Dueling(n) => n + 1,
        }
    }
}

/// Widths of all layers; valid by construction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MlpShape {
    input: usize,
    hidden: Vec<usize>,
    head: Head,
}

impl MlpShape {
    /// `input` numbers, ReLU layers of the widths in `hidden`, and the head.
    ///
    /// # Errors
    /// A width of 0 or above [`MAX_WIDTH`](crate::shape::MAX_WIDTH), or more than [`MAX_HIDDEN_LAYERS`].
    pub fn new(input: usize, hidden: &[usize], head: Head) -> Result<Self, ShapeError> {
        check_width("input", input)?;
        check_width("head", head.outputs())?;
        for &width in hidden {
            check_width("hidden", width)?;
        }
        if hidden.len() > MAX_HIDDEN_LAYERS {
            return Err(ShapeError::Layers { found: hidden.len(), most: MAX_HIDDEN_LAYERS });
        }
        Ok(Self { input, hidden: hidden.to_vec(), head })
    }

    /// Numbers that go in.
    #[must_use]
    pub fn input(&self) -> usize {
        self.input
    }

    /// Widths of the hidden layers, first to last.
    #[must_use]
    pub fn hidden(&self) -> &[usize] {
        &self.hidden
    }

    /// The head.
    #[must_use]
    pub fn head(&self) -> Head {
        self.head
    }

    /// Numbers that come out.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.head.outputs()
    }

    /// Length of the flat parameters.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.layers().last().map_or(0, Layer::end)
    }

    /// The layers and where they lie in the flat parameters, first to last.
    pub(crate) fn layers(&self) -> Vec<Layer> {
        let mut start = 0;
        let mut inputs = self.input;
        let widths = self.hidden.iter().copied().chain([self.head.width()]);
        widths
            .map(|outputs| {
                let layer = Layer { inputs, outputs, start };
                start = layer.end();
                inputs = outputs;
                layer
            })
            .collect()
    }

    /// The widest of all hidden layers and the head's linear layer.
    fn widest(&self) -> usize {
        self.hidden.iter().copied().chain([self.head.width()]).max().unwrap_or(0)
    }
}

/// A network: its shape and one flat vector of parameters.
///
/// The parameters lie layer after layer, each as weights `[inputs][outputs]` followed by biases `[outputs]`,
/// the dueling head's last output being V. Gradients, Adam's moments and target networks have the same
/// layout, so that they are plain slices everywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Mlp {
    shape: MlpShape,
    layers: Vec<Layer>,
    params: Vec<f32>,
}

impl Mlp {
    /// New parameters as PyTorch's `nn.Linear` draws them: weights and biases uniform in ±1/√inputs.
    ///
    /// `uniform` gives numbers in [0, 1); it is called once a parameter, in the order of the flat parameters.
    #[must_use]
    pub fn new(shape: &MlpShape, mut uniform: impl FnMut() -> f32) -> Self {
        let mut net = Self::zeros(shape);
        for layer in &net.layers {
            linear_default(layer.inputs, &mut net.params[layer.start..layer.end()], &mut uniform);
        }
        net
    }

    /// All parameters 0.
    #[must_use]
    pub fn zeros(shape: &MlpShape) -> Self {
        Self { layers: shape.layers(), params: vec![0.0; shape.parameters()], shape: shape.clone() }
    }

    /// The shape.
    #[must_use]
    pub fn shape(&self) -> &MlpShape {
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

    /// The control loop's forward pass: allocates nothing and gives the same bits on every CPU and in
    /// WebAssembly, for finite inputs and parameters.
    ///
    /// # Panics
    /// If `x` has not [`MlpShape::input`] numbers or `scratch` was made for another shape.
    pub fn forward<'s>(&self, x: &[f32], scratch: &'s mut MlpScratch) -> &'s [f32] {
        forward_layers(&self.shape, &self.layers, &self.params, x, scratch);
        &scratch.outputs
    }
}

/// The control loop's forward pass of the network that lies at the beginning of `params`.
pub(crate) fn forward_layers(
    shape: &MlpShape,
    layers: &[Layer],
    params: &[f32],
    x: &[f32],
    scratch: &mut MlpScratch,
) {
    assert_eq!(x.len(), shape.input, "an input of {} numbers", shape.input);
    let MlpScratch { from, to, outputs } = scratch;
    let (head, hidden) = layers.split_last().expect("a shape has a head");
    let mut width = x.len();
    from[..width].copy_from_slice(x);
    for layer in hidden {
        let y = &mut to[..layer.outputs];
        layer.forward(params, &from[..width], y);
        relu(y);
        width = layer.outputs;
        std::mem::swap(from, to);
    }
    let y = &mut to[..head.outputs];
    head.forward(params, &from[..width], y);
    combine(shape.head, y, outputs);
}

/// Buffers of the control loop's forward pass, made once for a shape.
#[derive(Debug, Clone)]
pub struct MlpScratch {
    from: Vec<f32>,
    to: Vec<f32>,
    outputs: Vec<f32>,
}

impl MlpScratch {
    /// Buffers for networks of this shape.
    #[must_use]
    pub fn new(shape: &MlpShape) -> Self {
        let width = shape.widest().max(shape.input);
        Self { from: vec![0.0; width], to: vec![0.0; width], outputs: vec![0.0; shape.outputs()] }
    }

    /// The outputs of the last forward pass.
    pub(crate) fn outputs(&self) -> &[f32] {
        &self.outputs
    }
}

/// Negative numbers become 0 (and −0 becomes 0).
#[inline(always)]
fn relu(y: &mut [f32]) {
    for y in y {
        *y = if *y > 0.0 { *y } else { 0.0 };
    }
}

/// From the head's linear layer to what the caller sees, one row.
#[inline(always)]
fn combine(head: Head, linear: &[f32], outputs: &mut [f32]) {
    match head {
        Head::Plain(_) => outputs.copy_from_slice(linear),
        Head::Dueling(n) => {
            let (advantages, value) = (&linear[..n], linear[n]);
            let mean = advantages.iter().sum::<f32>() / n as f32;
            for (q, a) in outputs.iter_mut().zip(advantages) {
                *q = value + (a - mean);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_of_the_default_values_network() {
        let shape = MlpShape::new(13, &[64, 64], Head::Dueling(4)).unwrap();
        assert_eq!(shape.parameters(), 14 * 64 + 65 * 64 + 65 * 5);
    }

    #[test]
    fn a_layer_without_width_is_refused() {
        assert_eq!(
            MlpShape::new(3, &[8, 0], Head::Plain(1)),
            Err(ShapeError::Width { what: "hidden", found: 0, most: crate::shape::MAX_WIDTH })
        );
        assert!(MlpShape::new(3, &[8; MAX_HIDDEN_LAYERS + 1], Head::Plain(1)).is_err());
    }

    #[test]
    fn two_layers_by_hand() {
        let shape = MlpShape::new(2, &[2], Head::Plain(1)).unwrap();
        let mut net = Mlp::zeros(&shape);
        // Hidden: [x0 − x1 + 0.5, 2 x1 − 1]; output: 3 h0 + 4 h1 + 0.25.
        net.params_mut().copy_from_slice(&[1.0, 0.0, -1.0, 2.0, 0.5, -1.0, 3.0, 4.0, 0.25]);
        let mut scratch = MlpScratch::new(&shape);
        assert_eq!(net.forward(&[1.0, 0.25], &mut scratch), [3.0 * 1.25 + 0.25]);
        assert_eq!(net.forward(&[0.0, 2.0], &mut scratch), [4.0 * 3.0 + 0.25]);
    }

    #[test]
    fn dueling_values_are_value_plus_advantage_less_mean() {
        let mut q = [0.0; 3];
        combine(Head::Dueling(3), &[1.0, 2.0, 6.0, 10.0], &mut q);
        assert_eq!(q, [8.0, 9.0, 13.0]);
    }
}
