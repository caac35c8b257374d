//! Training's forward and backward pass of an [`Lstm`] over sequences of unequal length.
//!
//! Sequences are packed: sorted by length, longest first, and stored tick after tick, each tick holding only
//! the sequences that still last. No padding is computed and no mask is needed.

use super::{Lstm, LstmShape};
use crate::dense::Layer;
use crate::dense_batch;
use crate::gemm::{Matrix, multiply};
use crate::math::{sigmoid, tanh};

/// Workspace for a batch of sequences. After it is made nothing allocates.
///
/// Order of calls: [`begin`](Self::begin), fill [`input_mut`](Self::input_mut), [`forward`](Self::forward),
/// read [`output`](Self::output) and write [`output_gradient_mut`](Self::output_gradient_mut),
/// [`backward`](Self::backward). For several threads see [`MlpBatch`](crate::mlp::MlpBatch).
#[derive(Debug, Clone)]
pub struct LstmBatch {
    shape: LstmShape,
    most_sequences: usize,
    most_ticks: usize,
    packing: Packing,
    /// `[packed][input + hidden]`: x of the tick, then h of the tick before.
    inputs: Vec<f32>,
    /// `[packed][4 hidden]`: gates after their activation; in the backward pass their gradients.
    gates: Vec<f32>,
    /// `[packed][hidden]`: cell states, their tanh, and hidden states.
    cells: Vec<f32>,
    tanh_cells: Vec<f32>,
    hidden: Vec<f32>,
    /// `[packed][output]`.
    outputs: Vec<f32>,
    d_outputs: Vec<f32>,
    /// `[sequences][hidden]`: gradients on their way back from the later tick.
    d_hidden: Vec<f32>,
    d_cells: Vec<f32>,
    /// `[packed][hidden]`: gradient that the head sends into each tick's hidden state.
    d_from_head: Vec<f32>,
}

/// Where each tick of each sequence lies.
#[derive(Debug, Clone, Default)]
struct Packing {
    /// Row of a sequence within its ticks.
    rank: Vec<usize>,
    lengths: Vec<usize>,
    /// First packed row of each tick, and behind the last tick the number of all rows.
    first: Vec<usize>,
    /// Sequences by falling length.
    order: Vec<usize>,
}

impl Packing {
    fn with_room(sequences: usize, ticks: usize) -> Self {
        Self {
            rank: Vec::with_capacity(sequences),
            lengths: Vec::with_capacity(sequences),
            first: Vec::with_capacity(ticks + 1),
            order: Vec::with_capacity(sequences),
        }
    }

    fn set(&mut self, lengths: &[usize]) {
        self.lengths.clear();
        self.lengths.extend_from_slice(lengths);
        self.order.clear();
        self.order.extend(0..lengths.len());
        // The index breaks ties, so that the order, and with it every sum, is a function of the lengths alone.
        self.order.sort_unstable_by_key(|&s| (std::cmp::Reverse(lengths[s]), s));
        self.rank.clear();
        self.rank.resize(lengths.len(), 0);
        for (rank, &s) in self.order.iter().enumerate() {
            self.rank[s] = rank;
        }
        self.first.clear();
        self.first.push(0);
        let ticks = self.order.first().map_or(0, |&s| lengths[s]);
        let mut active = lengths.len();
        let mut rows = 0;
        for t in 0..ticks {
            while active > 0 && lengths[self.order[active - 1]] <= t {
                active -= 1;
            }
            rows += active;
            self.first.push(rows);
        }
    }

    fn ticks(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    fn rows(&self) -> usize {
        self.first.last().copied().unwrap_or(0)
    }

    /// Packed rows of a tick.
    fn tick(&self, t: usize) -> std::ops::Range<usize> {
        self.first[t]..self.first[t + 1]
    }

    fn row(&self, sequence: usize, tick: usize) -> usize {
        assert!(tick < self.lengths[sequence], "tick {tick} of {} ticks", self.lengths[sequence]);
        self.first[tick] + self.rank[sequence]
    }
}

impl LstmBatch {
    /// Room for up to `most_sequences` sequences of up to `most_ticks` ticks.
    #[must_use]
    pub fn new(shape: LstmShape, most_sequences: usize, most_ticks: usize) -> Self {
        let rows = most_sequences * most_ticks;
        let LstmShape { input, hidden, output } = shape;
        let zeros = |width: usize| vec![0.0; rows * width];
        Self {
            shape,
            most_sequences,
            most_ticks,
            packing: Packing::with_room(most_sequences, most_ticks),
            inputs: zeros(input + hidden),
            gates: zeros(4 * hidden),
            cells: zeros(hidden),
            tanh_cells: zeros(hidden),
            hidden: zeros(hidden),
            outputs: zeros(output),
            d_outputs: zeros(output),
            d_from_head: zeros(hidden),
            d_hidden: vec![0.0; most_sequences * hidden],
            d_cells: vec![0.0; most_sequences * hidden],
        }
    }

    /// Starts a batch of sequences of these lengths in ticks, in any order; sequences are named by their index
    /// here.
    ///
    /// # Panics
    /// If there are too many sequences or one is too long.
    pub fn begin(&mut self, lengths: &[usize]) {
        assert!(lengths.len() <= self.most_sequences, "at most {} sequences", self.most_sequences);
        assert!(lengths.iter().all(|&l| l <= self.most_ticks), "at most {} ticks", self.most_ticks);
        self.packing.set(lengths);
    }

    /// Ticks of the whole batch, all sequences together.
    #[must_use]
    pub fn total_ticks(&self) -> usize {
        self.packing.rows()
    }

    /// The input of one tick, to be written before [`forward`](Self::forward).
    ///
    /// # Panics
    /// If the sequence has no such tick.
    pub fn input_mut(&mut self, sequence: usize, tick: usize) -> &mut [f32] {
        let start = self.packing.row(sequence, tick) * (self.shape.input + self.shape.hidden);
        &mut self.inputs[start..start + self.shape.input]
    }

    /// The head's outputs at one tick, after [`forward`](Self::forward).
    ///
    /// # Panics
    /// If the sequence has no such tick.
    #[must_use]
    pub fn output(&self, sequence: usize, tick: usize) -> &[f32] {
        let start = self.packing.row(sequence, tick) * self.shape.output;
        &self.outputs[start..start + self.shape.output]
    }

    /// The outputs of one tick and the place for the loss's gradient there, which is 0 until written.
    ///
    /// # Panics
    /// If the sequence has no such tick.
    pub fn output_and_gradient_mut(&mut self, sequence: usize, tick: usize) -> (&[f32], &mut [f32]) {
        let start = self.packing.row(sequence, tick) * self.shape.output;
        let range = start..start + self.shape.output;
        (&self.outputs[range.clone()], &mut self.d_outputs[range])
    }

    /// Runs all sequences from a state of zeros; agrees with [`Lstm::step`] to about 1e-6, not to the bit.
    ///
    /// # Panics
    /// If the network has another shape.
    pub fn forward(&mut self, net: &Lstm) {
        assert_eq!(net.shape, self.shape, "a workspace serves one shape");
        self.project_inputs(net);
        for t in 0..self.packing.ticks() {
            self.forward_tick(net, t);
        }
        let head = self.shape.head();
        let rows = self.packing.rows();
        let outputs = &mut self.outputs[..rows * head.outputs];
        dense_batch::forward(&head, &net.params, Matrix::new(&self.hidden, rows, head.inputs), outputs);
        self.d_outputs[..rows * head.outputs].fill(0.0);
    }

    /// Biases and the inputs' part of all gates of all ticks at once.
    fn project_inputs(&mut self, net: &Lstm) {
        let gates = self.shape.gates();
        let rows = self.packing.rows();
        let x = Matrix::new(&self.inputs, rows, gates.inputs).columns(0, self.shape.input);
        let of_x = Layer { inputs: self.shape.input, ..gates };
        let y = &mut self.gates[..rows * gates.outputs];
        for row in y.chunks_exact_mut(gates.outputs) {
            row.copy_from_slice(gates.bias(&net.params));
        }
        multiply(x, Matrix::new(of_x.weights(&net.params), of_x.inputs, of_x.outputs), true, y);
    }

    fn forward_tick(&mut self, net: &Lstm, t: usize) {
        let n = self.shape.hidden;
        let layer = self.shape.gates();
        let rows = self.packing.tick(t);
        if t > 0 {
            self.carry_hidden(t);
            let of_h = &layer.weights(&net.params)[self.shape.input * layer.outputs..];
            let h = Matrix::new(&self.hidden[self.packing.first[t - 1] * n..], rows.len(), n);
            let gates = &mut self.gates[rows.start * 4 * n..rows.end * 4 * n];
            multiply(h, Matrix::new(of_h, n, 4 * n), true, gates);
        } else {
            self.clear_first_hidden();
        }
        for (rank, row) in rows.enumerate() {
            let (before, now) = self.cells.split_at_mut(row * n);
            let before = if t > 0 { &before[(self.packing.first[t - 1] + rank) * n..][..n] } else { &[] };
            let tick = CellRow {
                gates: &mut self.gates[row * 4 * n..][..4 * n],
                cell: &mut now[..n],
                tanh_cell: &mut self.tanh_cells[row * n..][..n],
                hidden: &mut self.hidden[row * n..][..n],
            };
            tick.forward(before);
        }
    }

    /// Copies the hidden states of the tick before into this tick's inputs, for the weights' gradient.
    fn carry_hidden(&mut self, t: usize) {
        let (n, width) = (self.shape.hidden, self.shape.input + self.shape.hidden);
        let from = self.packing.first[t - 1];
        for (rank, row) in self.packing.tick(t).enumerate() {
            let h = &self.hidden[(from + rank) * n..][..n];
            self.inputs[row * width + self.shape.input..][..n].copy_from_slice(h);
        }
    }

    fn clear_first_hidden(&mut self) {
        let (n, width) = (self.shape.hidden, self.shape.input + self.shape.hidden);
        for row in self.packing.tick(0) {
            self.inputs[row * width + self.shape.input..][..n].fill(0.0);
        }
    }

    /// Writes the gradient of the parameters into `gradient` (which it replaces), from the output gradients
    /// written since [`forward`](Self::forward). `net` must be unchanged since. Once a forward pass.
    ///
    /// # Panics
    /// If `gradient` is not as long as the parameters or the network has another shape.
    pub fn backward(&mut self, net: &Lstm, gradient: &mut [f32]) {
        assert_eq!(net.shape, self.shape, "a workspace serves one shape");
        assert_eq!(gradient.len(), net.params.len(), "one number for each parameter");
        let (rows, n) = (self.packing.rows(), self.shape.hidden);
        let head = self.shape.head();
        let d_outputs = &self.d_outputs[..rows * head.outputs];
        dense_batch::gradient(&head, Matrix::new(&self.hidden, rows, n), d_outputs, gradient);
        dense_batch::backward(&head, &net.params, d_outputs, &mut self.d_from_head[..rows * n]);
        self.d_hidden.fill(0.0);
        self.d_cells.fill(0.0);
        for t in (0..self.packing.ticks()).rev() {
            self.backward_tick(net, t);
        }
        let layer = self.shape.gates();
        let d_gates = &self.gates[..rows * layer.outputs];
        dense_batch::gradient(&layer, Matrix::new(&self.inputs, rows, layer.inputs), d_gates, gradient);
    }

    fn backward_tick(&mut self, net: &Lstm, t: usize) {
        let n = self.shape.hidden;
        let rows = self.packing.tick(t);
        for (rank, row) in rows.clone().enumerate() {
            let before = if t > 0 { &self.cells[(self.packing.first[t - 1] + rank) * n..][..n] } else { &[] };
            CellGradient {
                gates: &mut self.gates[row * 4 * n..][..4 * n],
                tanh_cell: &self.tanh_cells[row * n..][..n],
                d_from_head: &self.d_from_head[row * n..][..n],
                d_hidden: &self.d_hidden[rank * n..][..n],
                d_cell: &mut self.d_cells[rank * n..][..n],
            }
            .backward(before);
        }
        if t > 0 {
            let layer = self.shape.gates();
            let of_h = &layer.weights(&net.params)[self.shape.input * layer.outputs..];
            let d_gates = Matrix::new(&self.gates[rows.start * 4 * n..], rows.len(), 4 * n);
            let d_hidden = &mut self.d_hidden[..rows.len() * n];
            multiply(d_gates, Matrix::new(of_h, n, 4 * n).transposed(), false, d_hidden);
        }
    }
}

/// One sequence at one tick, forward. `gates` come in as sums and go out activated.
struct CellRow<'a> {
    gates: &'a mut [f32],
    cell: &'a mut [f32],
    tanh_cell: &'a mut [f32],
    hidden: &'a mut [f32],
}

impl CellRow<'_> {
    /// `before` is the cell state of the tick before, empty at the first tick.
    fn forward(self, before: &[f32]) {
        let n = self.cell.len();
        let (i, rest) = self.gates.split_at_mut(n);
        let (f, rest) = rest.split_at_mut(n);
        let (g, o) = rest.split_at_mut(n);
        for k in 0..n {
            i[k] = sigmoid(i[k]);
            f[k] = sigmoid(f[k]);
            g[k] = tanh(g[k]);
            o[k] = sigmoid(o[k]);
            self.cell[k] = i[k] * g[k];
        }
        for (c, (f, before)) in self.cell.iter_mut().zip(f.iter().zip(before)) {
            *c += f * before;
        }
        let states = self.tanh_cell.iter_mut().zip(self.hidden).zip(self.cell.iter().zip(o));
        for ((tanh_cell, hidden), (cell, o)) in states {
            *tanh_cell = tanh(*cell);
            *hidden = *o * *tanh_cell;
        }
    }
}

/// One sequence at one tick, backward. `gates` come in activated and go out as gradients of their sums.
struct CellGradient<'a> {
    gates: &'a mut [f32],
    tanh_cell: &'a [f32],
    d_from_head: &'a [f32],
    d_hidden: &'a [f32],
    d_cell: &'a mut [f32],
}

impl CellGradient<'_> {
    /// `before` is the cell state of the tick before, empty at the first tick.
    fn backward(self, before: &[f32]) {
        let n = self.d_cell.len();
        let (i, rest) = self.gates.split_at_mut(n);
        let (f, rest) = rest.split_at_mut(n);
        let (g, o) = rest.split_at_mut(n);
        for k in 0..n {
            let d_hidden = self.d_from_head[k] + self.d_hidden[k];
            let tc = self.tanh_cell[k];
            let d_cell = self.d_cell[k] + d_hidden * o[k] * (1.0 - tc * tc);
            o[k] = d_hidden * tc * o[k] * (1.0 - o[k]);
            let before = before.get(k).copied().unwrap_or(0.0);
            self.d_cell[k] = d_cell * f[k];
            f[k] = d_cell * before * f[k] * (1.0 - f[k]);
            let (ik, gk) = (i[k], g[k]);
            i[k] = d_cell * gk * ik * (1.0 - ik);
            g[k] = d_cell * ik * (1.0 - gk * gk);
        }
    }
}
