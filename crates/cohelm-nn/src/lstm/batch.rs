//! Training's forward and backward pass of an [`Lstm`] over sequences of unequal length.
//!
//! Sequences are packed: sorted by length, longest first, and stored tick after tick, each tick holding only
//! the sequences that still last. No padding is computed and no mask is needed.

use pulp::{Simd, WithSimd};

use super::{Lstm, LstmShape};
use crate::dense::Layer;
use crate::dense_batch;
use crate::gemm::{transpose, vectorised};
use crate::math::{sigmoid, tanh};

/// Workspace for a batch of sequences. After it is made nothing allocates.
///
/// Order of calls: [`begin`](Self::begin), fill [`input_mut`](Self::input_mut), [`forward`](Self::forward),
/// read outputs and write their gradients ([`output_and_gradient_mut`](Self::output_and_gradient_mut)),
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
    /// Transposes of the gates' weights from h, `[4 hidden][hidden]`, and of the head's, `[output][hidden]`.
    transposed_gates: Vec<f32>,
    transposed_head: Vec<f32>,
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
            transposed_gates: vec![0.0; 4 * hidden * hidden],
            transposed_head: vec![0.0; hidden * output],
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
        for t in 0..self.packing.ticks() {
            self.take_hidden(t);
            self.forward_tick(net, t);
        }
        let head = self.shape.head();
        let rows = self.packing.rows();
        let outputs = &mut self.outputs[..rows * head.outputs];
        dense_batch::forward(&head, &net.params, false, &self.hidden[..rows * head.inputs], outputs);
        self.d_outputs[..rows * head.outputs].fill(0.0);
    }

    /// Puts the hidden states of the tick before, zeros at the first, behind this tick's inputs.
    fn take_hidden(&mut self, t: usize) {
        let n = self.shape.hidden;
        let inputs = self.inputs.chunks_exact_mut(self.shape.input + n);
        let rows = self.packing.tick(t);
        let inputs = inputs.skip(rows.start).take(rows.len()).map(|row| &mut row[self.shape.input..]);
        if t == 0 {
            inputs.for_each(|h| h.fill(0.0));
        } else {
            let before = &self.hidden[self.packing.first[t - 1] * n..];
            inputs.zip(before.chunks_exact(n)).for_each(|(h, before)| h.copy_from_slice(before));
        }
    }

    fn forward_tick(&mut self, net: &Lstm, t: usize) {
        let n = self.shape.hidden;
        let layer = self.shape.gates();
        let rows = self.packing.tick(t);
        let of = |width: usize| rows.start * width..rows.end * width;
        let gates = &mut self.gates[of(4 * n)];
        dense_batch::forward(&layer, &net.params, false, &self.inputs[of(layer.inputs)], gates);
        let (before, cells) = self.cells.split_at_mut(rows.start * n);
        vectorised(ForwardCells {
            hidden_width: n,
            gates,
            before: if t > 0 { &before[self.packing.first[t - 1] * n..] } else { &[] },
            cells: &mut cells[..rows.len() * n],
            tanh_cells: &mut self.tanh_cells[of(n)],
            hidden: &mut self.hidden[of(n)],
        });
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
        let (layer, head) = (self.shape.gates(), self.shape.head());
        let of_h = &layer.weights(&net.params)[self.shape.input * layer.outputs..];
        transpose(of_h, n, 4 * n, &mut self.transposed_gates);
        transpose(head.weights(&net.params), n, head.outputs, &mut self.transposed_head);

        let d_outputs = &self.d_outputs[..rows * head.outputs];
        dense_batch::gradient(&head, &self.hidden[..rows * n], d_outputs, gradient);
        dense_batch::backward(&head, &self.transposed_head, d_outputs, &mut self.d_from_head[..rows * n]);
        self.d_hidden.fill(0.0);
        self.d_cells.fill(0.0);
        for t in (0..self.packing.ticks()).rev() {
            self.backward_tick(t);
        }
        let d_gates = &self.gates[..rows * layer.outputs];
        dense_batch::gradient(&layer, &self.inputs[..rows * layer.inputs], d_gates, gradient);
    }

    fn backward_tick(&mut self, t: usize) {
        let n = self.shape.hidden;
        let rows = self.packing.tick(t);
        let of = |width: usize| rows.start * width..rows.end * width;
        let gates = &mut self.gates[of(4 * n)];
        vectorised(BackwardCells {
            hidden_width: n,
            gates,
            before: if t > 0 { &self.cells[self.packing.first[t - 1] * n..] } else { &[] },
            tanh_cells: &self.tanh_cells[of(n)],
            d_from_head: &mut self.d_from_head[of(n)],
            d_hidden: &self.d_hidden[..rows.len() * n],
            d_cells: &mut self.d_cells[..rows.len() * n],
        });
        if t > 0 {
            let layer = Layer { inputs: n, ..self.shape.gates() };
            dense_batch::backward(
                &layer,
                &self.transposed_gates,
                gates,
                &mut self.d_hidden[..rows.len() * n],
            );
        }
    }
}

/// All sequences at one tick, forward, from the gates' sums to h. Matrices have a row a sequence.
struct ForwardCells<'a> {
    hidden_width: usize,
    /// Sums in, activated gates out.
    gates: &'a mut [f32],
    /// Cell states of the tick before, for at least as many sequences; empty at the first tick.
    before: &'a [f32],
    cells: &'a mut [f32],
    tanh_cells: &'a mut [f32],
    hidden: &'a mut [f32],
}

impl WithSimd for ForwardCells<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.hidden_width;
        let mut before = self.before.chunks_exact(n);
        for (gates, cell) in self.gates.chunks_exact_mut(4 * n).zip(self.cells.chunks_exact_mut(n)) {
            forward_cell(gates, before.next(), cell);
        }
        self.tanh_cells.iter_mut().zip(&*self.cells).for_each(|(y, &x)| *y = tanh(x));
        let outputs = self.gates.chunks_exact(4 * n).map(|gates| &gates[3 * n..]);
        let states = self.hidden.chunks_exact_mut(n).zip(self.tanh_cells.chunks_exact(n));
        for (o, (hidden, tanh_cell)) in outputs.zip(states) {
            hidden.iter_mut().zip(o.iter().zip(tanh_cell)).for_each(|(h, (o, tc))| *h = o * tc);
        }
    }
}

/// All sequences at one tick, backward, from the gradient at h to the gradients at the gates' sums.
struct BackwardCells<'a> {
    hidden_width: usize,
    /// Activated gates in, gradients at their sums out.
    gates: &'a mut [f32],
    /// Cell states of the tick before; empty at the first tick.
    before: &'a [f32],
    tanh_cells: &'a [f32],
    /// Gradient at h from the head in, the whole gradient at h out.
    d_from_head: &'a mut [f32],
    /// Gradient at h from the tick behind.
    d_hidden: &'a [f32],
    /// Gradient at c from the tick behind in, for the tick before out.
    d_cells: &'a mut [f32],
}

impl WithSimd for BackwardCells<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.hidden_width;
        self.d_from_head.iter_mut().zip(self.d_hidden).for_each(|(d, behind)| *d += behind);
        let states = self.tanh_cells.chunks_exact(n).zip(self.d_from_head.chunks_exact(n));
        let gates = self.gates.chunks_exact_mut(4 * n).zip(self.d_cells.chunks_exact_mut(n));
        let mut before = self.before.chunks_exact(n);
        for ((gates, d_cell), (tanh_cell, d_hidden)) in gates.zip(states) {
            backward_output_gate(&mut gates[3 * n..], tanh_cell, d_hidden, d_cell);
            backward_cell(&mut gates[..3 * n], before.next(), d_cell);
        }
    }
}

/// Activates the sums of all gates and computes the cell states. `before` are those of the tick before.
#[inline(always)]
fn forward_cell(gates: &mut [f32], before: Option<&[f32]>, cell: &mut [f32]) {
    let n = cell.len();
    let (i, rest) = gates.split_at_mut(n);
    let (f, rest) = rest.split_at_mut(n);
    let (g, o) = rest.split_at_mut(n);
    i.iter_mut().for_each(|x| *x = sigmoid(*x));
    f.iter_mut().for_each(|x| *x = sigmoid(*x));
    g.iter_mut().for_each(|x| *x = tanh(*x));
    o.iter_mut().for_each(|x| *x = sigmoid(*x));
    cell.iter_mut().zip(i.iter().zip(&*g)).for_each(|(c, (i, g))| *c = i * g);
    if let Some(before) = before {
        cell.iter_mut().zip(f.iter().zip(before)).for_each(|(c, (f, before))| *c += f * before);
    }
}

/// From the gradient at h = o·tanh(c): adds to the gradient at c, and replaces the activated output gates by
/// the gradient at their sums.
#[inline(always)]
fn backward_output_gate(o: &mut [f32], tanh_cell: &[f32], d_hidden: &[f32], d_cell: &mut [f32]) {
    for ((d_cell, o), (dh, tc)) in d_cell.iter_mut().zip(&*o).zip(d_hidden.iter().zip(tanh_cell)) {
        *d_cell += dh * o * (1.0 - tc * tc);
    }
    for (o, (dh, tc)) in o.iter_mut().zip(d_hidden.iter().zip(tanh_cell)) {
        *o = dh * tc * *o * (1.0 - *o);
    }
}

/// From the gradient at c = f·before + i·g: replaces the activated gates by the gradients at their sums, and
/// the gradient at c by that at `before`.
#[inline(always)]
fn backward_cell(gates: &mut [f32], before: Option<&[f32]>, d_cell: &mut [f32]) {
    let n = d_cell.len();
    let (i, rest) = gates.split_at_mut(n);
    let (f, g) = rest.split_at_mut(n);
    for ((i, g), d) in i.iter_mut().zip(g).zip(&*d_cell) {
        let (at_i, at_g) = (d * *g * *i * (1.0 - *i), d * *i * (1.0 - *g * *g));
        (*i, *g) = (at_i, at_g);
    }
    let Some(before) = before else {
        f.fill(0.0);
        return;
    };
    for ((f, before), d) in f.iter_mut().zip(before).zip(d_cell) {
        let (at_f, at_before) = (*d * before * *f * (1.0 - *f), *d * *f);
        (*f, *d) = (at_f, at_before);
    }
}
