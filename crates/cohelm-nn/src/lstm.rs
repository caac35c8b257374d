//! One LSTM layer with a linear head at every tick.
//!
//! Here: shape, parameters and the control loop's step. Training's passes are in [`LstmBatch`].
//!
//! The cell is PyTorch's (`nn.LSTM`): gates in the order input, forget, cell, output;
//! c′ = σ(f)·c + σ(i)·tanh(g), h′ = σ(o)·tanh(c′). PyTorch keeps two biases that are only ever added; here is
//! one. The head sees h′.

#[cfg(feature = "train")]
mod batch;

#[cfg(feature = "train")]
pub use batch::LstmBatch;

use crate::dense::{Layer, accumulate};
use crate::init::linear_default;
use crate::math::{sigmoid, tanh};
use crate::shape::{MAX_WIDTH, ShapeError, check_width};

/// Widths of an LSTM; valid by construction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LstmShape {
    input: usize,
    hidden: usize,
    output: usize,
}

impl LstmShape {
    /// `input` numbers a tick, `hidden` cells, `output` numbers a tick from the linear head.
    ///
    /// # Errors
    /// A width of 0 or too large: at most [`MAX_WIDTH`], `hidden` at most a quarter of it.
    pub fn new(input: usize, hidden: usize, output: usize) -> Result<Self, ShapeError> {
        check_width("input", input)?;
        check_width("output", output)?;
        if !(1..=MAX_WIDTH / 4).contains(&hidden) {
            return Err(ShapeError::Width { what: "hidden", found: hidden, most: MAX_WIDTH / 4 });
        }
        Ok(Self { input, hidden, output })
    }

    /// Numbers that go in each tick.
    #[must_use]
    pub fn input(&self) -> usize {
        self.input
    }

    /// Cells.
    #[must_use]
    pub fn hidden(&self) -> usize {
        self.hidden
    }

    /// Numbers that come out each tick.
    #[must_use]
    pub fn output(&self) -> usize {
        self.output
    }

    /// Length of the flat parameters.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.head().end()
    }

    /// All four gates as one layer whose input is x followed by h.
    pub(crate) fn gates(&self) -> Layer {
        Layer { inputs: self.input + self.hidden, outputs: 4 * self.hidden, start: 0 }
    }

    pub(crate) fn head(&self) -> Layer {
        Layer { inputs: self.hidden, outputs: self.output, start: self.gates().end() }
    }
}

/// A network: its shape and one flat vector of parameters.
///
/// Layout: gate weights `[input + hidden][4 hidden]` (rows of x first, then of h), gate biases `[4 hidden]`,
/// head weights `[hidden][output]`, head biases `[output]`; the gates of a row are all input gates, all forget
/// gates, all cell candidates, all output gates.
#[derive(Debug, Clone, PartialEq)]
pub struct Lstm {
    shape: LstmShape,
    params: Vec<f32>,
}

impl Lstm {
    /// New parameters, all uniform in ±1/√hidden, as PyTorch draws those of `nn.LSTM` and of a head
    /// `nn.Linear(hidden, output)`.
    ///
    /// `uniform` gives numbers in [0, 1); it is called once a parameter, in the order of the flat parameters.
    #[must_use]
    pub fn new(shape: LstmShape, mut uniform: impl FnMut() -> f32) -> Self {
        let mut net = Self::zeros(shape);
        linear_default(shape.hidden, &mut net.params, &mut uniform);
        net
    }

    /// All parameters 0.
    #[must_use]
    pub fn zeros(shape: LstmShape) -> Self {
        Self { shape, params: vec![0.0; shape.parameters()] }
    }

    /// The shape.
    #[must_use]
    pub fn shape(&self) -> LstmShape {
        self.shape
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

    /// The control loop's step: takes one tick's input, moves `state` on and returns the head's outputs.
    ///
    /// Allocates nothing and gives the same bits on every CPU and in WebAssembly, for finite inputs and
    /// parameters.
    ///
    /// # Panics
    /// If `x` has not [`LstmShape::input`] numbers or `state` was made for another shape.
    pub fn step<'s>(&self, x: &[f32], state: &'s mut LstmState) -> &'s [f32] {
        assert_eq!(x.len(), self.shape.input, "an input of {} numbers", self.shape.input);
        let LstmState { hidden, cell, gates, outputs } = state;
        let layer = self.shape.gates();
        let (of_x, of_h) = layer.weights(&self.params).split_at(self.shape.input * layer.outputs);
        gates.copy_from_slice(layer.bias(&self.params));
        accumulate(of_x, x, gates);
        accumulate(of_h, hidden, gates);
        cells(gates, cell, hidden);
        self.shape.head().forward(&self.params, hidden, outputs);
        outputs
    }
}

/// From the four gates' sums to the next cell and hidden state.
fn cells(gates: &[f32], cell: &mut [f32], hidden: &mut [f32]) {
    let n = cell.len();
    let (i, f, g, o) = (&gates[..n], &gates[n..2 * n], &gates[2 * n..3 * n], &gates[3 * n..4 * n]);
    let hidden = &mut hidden[..n];
    for k in 0..n {
        cell[k] = sigmoid(f[k]) * cell[k] + sigmoid(i[k]) * tanh(g[k]);
        hidden[k] = sigmoid(o[k]) * tanh(cell[k]);
    }
}

/// What an LSTM remembers from tick to tick, with the buffers of its step.
#[derive(Debug, Clone, PartialEq)]
pub struct LstmState {
    hidden: Vec<f32>,
    cell: Vec<f32>,
    gates: Vec<f32>,
    outputs: Vec<f32>,
}

impl LstmState {
    /// The state before the first tick: all zeros.
    #[must_use]
    pub fn new(shape: LstmShape) -> Self {
        Self {
            hidden: vec![0.0; shape.hidden],
            cell: vec![0.0; shape.hidden],
            gates: vec![0.0; 4 * shape.hidden],
            outputs: vec![0.0; shape.output],
        }
    }

    /// Back to before the first tick, without allocating.
    pub fn reset(&mut self) {
        self.hidden.fill(0.0);
        self.cell.fill(0.0);
        self.outputs.fill(0.0);
    }

    /// The head's outputs at the last tick; zeros before the first.
    #[must_use]
    pub fn outputs(&self) -> &[f32] {
        &self.outputs
    }
}
