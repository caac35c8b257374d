//! Timings of what this crate is for, beside the floor that the machine sets.
//!
//! The floor of a training step is the time that its matrix products alone would take at the best rate that any
//! product reaches on this machine: floor = floating-point operations / that rate. Element-wise work, copying,
//! the optimiser and all overhead come on top; so 1 is not to be had and 2 is good.
//!
//! Numbers are of one thread. `cohelm bench nets` prints them.

use std::hint::black_box;
use std::time::Instant;

use crate::adam::{Adam, AdamOptions, follow};
use crate::gemm::{Around, Left, kernel_name, multiply};
use crate::goal_head;
use crate::loss::huber;
use crate::lstm::{Lstm, LstmBatch, LstmShape, LstmState};
use crate::mlp::{Head, Mlp, MlpBatch, MlpScratch, MlpShape};

/// One timed thing.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// What was timed, with its sizes.
    pub name: &'static str,
    /// Median over the runs, in microseconds.
    pub median_us: f64,
    /// Best run, in microseconds: what the machine can do when nothing else runs on it.
    pub best_us: f64,
    /// Operations of its matrix products / the best rate, in microseconds; none for the control loop, whose
    /// bound is a fixed time.
    pub floor_us: Option<f64>,
}

/// All timings and the machine's rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Timings {
    /// [`kernel_name`] of this machine.
    pub kernel: String,
    /// Best rate of matrix products here, in 10⁹ operations a second; a multiplication and an addition count
    /// as two.
    pub gflops: f64,
    /// Double-DQN steps, an LSTM training step, a decision.
    pub timings: Vec<Timing>,
}

/// Measures everything; `runs` batches of each, 30 being enough for a quiet machine (about a second).
#[must_use]
pub fn measure(runs: usize) -> Timings {
    let gflops = peak_gflops(runs);
    let mut timings = Vec::new();
    let mut add = |name, operations: f64, step: &mut dyn FnMut()| {
        let floor_us = (operations > 0.0).then_some(operations / gflops * 1e-3);
        timings.push(time(name, runs, floor_us, step));
    };
    let sizes = [
        ("double-DQN step, batch 64, 2x64", 64, [64, 64], false),
        ("double-DQN step, batch 64, 2x128", 64, [128, 128], false),
        ("double-DQN step, batch 256, 2x256", 256, [256, 256], false),
        ("double-DQN step with advantage learning, batch 128, 2x64", 128, [64, 64], true),
    ];
    for (name, rows, hidden, advantage_learning) in sizes {
        let mut step = DoubleDqn::new(rows, &hidden, advantage_learning);
        add(name, step.operations(), &mut || step.run());
    }
    let mut lstm = LstmTraining::new(64, 50);
    add("LSTM training step, 64 sequences of 50 ticks, 64 cells", lstm.operations(), &mut || lstm.run());
    let mut decision = Decision::new();
    add("decision: LSTM step and values", 0.0, &mut || decision.run());
    Timings { kernel: kernel_name(), gflops, timings }
}

/// Times something that belongs to a control loop: no floor.
#[must_use]
pub fn decision(name: &'static str, runs: usize, mut step: impl FnMut()) -> Timing {
    time(name, runs, None, &mut step)
}

/// Median and best of `runs` batches: of 0.3 ms, long for the clock and short for whatever else the machine does.
fn time(name: &'static str, runs: usize, floor_us: Option<f64>, step: &mut dyn FnMut()) -> Timing {
    let mut batch = |n: usize| {
        let start = Instant::now();
        (0..n).for_each(|_| step());
        start.elapsed().as_secs_f64() * 1e6 / n as f64
    };
    batch(1);
    let n = (300.0 / batch(3)).ceil().max(1.0) as usize;
    let mut times: Vec<f64> = (0..runs.max(1)).map(|_| batch(n)).collect();
    times.sort_by(f64::total_cmp);
    Timing { name, median_us: times[times.len() / 2], best_us: times[0], floor_us }
}

/// The best rate of matrix products here, in 10⁹ operations a second: of a large one and of one that stays
/// in the first cache level, whichever is faster.
fn peak_gflops(runs: usize) -> f64 {
    let shapes = [(512, 512, 512), (96, 128, 64)];
    let rate = |&(rows, inner, n): &(usize, usize, usize)| {
        2e-3 * (rows * inner * n) as f64 / product([rows, inner, n], runs).best_us
    };
    shapes.iter().map(rate).fold(0.0, f64::max)
}

/// Times one product of a `rows` × `inner` with an `inner` × `n` matrix.
#[must_use]
pub fn product([rows, inner, n]: [usize; 3], runs: usize) -> Timing {
    let (a, b) = (vec![0.5; rows * inner], vec![0.25; inner * n]);
    let mut c = vec![0.0; rows * n];
    let mut multiply = || {
        multiply(Left::new(&a, rows, inner), black_box(&b), n, Around::default(), &mut c);
        black_box(&mut c);
    };
    time("matrix product", runs, None, &mut multiply)
}

/// Uniform numbers in [0, 1).
fn uniform(seed: u32) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    }
}

/// A double-DQN update of a 13-…-4 dueling network as a trainer does it, the batch already gathered: online
/// values of states and next states in one pass, target values, Huber gradient, Adam, soft target update.
struct DoubleDqn {
    online: Mlp,
    target: Mlp,
    online_batch: MlpBatch,
    target_batch: MlpBatch,
    adam: Adam,
    gradient: Vec<f32>,
    /// States, then next states.
    x: Vec<f32>,
    d_q: Vec<f32>,
    rows: usize,
    advantage_learning: bool,
}

const STATE: usize = 13;
const ACTIONS: usize = 4;

impl DoubleDqn {
    fn new(rows: usize, hidden: &[usize], advantage_learning: bool) -> Self {
        let shape = MlpShape::new(STATE, hidden, Head::Dueling(ACTIONS)).expect("widths within the limits");
        let online = Mlp::new(&shape, uniform(1));
        let mut draw = uniform(2);
        Self {
            target: online.clone(),
            online_batch: MlpBatch::new(&shape, 2 * rows),
            target_batch: MlpBatch::new(&shape, 2 * rows),
            adam: Adam::new(shape.parameters(), AdamOptions::default()),
            gradient: vec![0.0; shape.parameters()],
            x: (0..2 * rows * STATE).map(|_| 2.0 * draw() - 1.0).collect(),
            d_q: vec![0.0; rows * ACTIONS],
            online,
            rows,
            advantage_learning,
        }
    }

    /// Operations of the matrix products: the forward passes, the weights' gradients and the gradients at the
    /// inputs of all layers but the first.
    fn operations(&self) -> f64 {
        let layers = self.online.shape().layers();
        let all: usize = layers.iter().map(|l| l.inputs * l.outputs).sum();
        let first = layers[0].inputs * layers[0].outputs;
        let forward_passes = if self.advantage_learning { 4 } else { 3 };
        (2 * self.rows * ((forward_passes + 2) * all - first)) as f64
    }

    fn run(&mut self) {
        let (rows, half) = (self.rows, self.rows * STATE);
        let q = self.online_batch.forward(&self.online, &self.x);
        let (q, q_next) = q.split_at(rows * ACTIONS);
        let seen = if self.advantage_learning { 0 } else { half };
        let target = self.target_batch.forward(&self.target, &self.x[seen..]);
        let (target_now, target_next) = target.split_at(target.len() - rows * ACTIONS);
        self.d_q.fill(0.0);
        for row in 0..rows {
            let here = row * ACTIONS..(row + 1) * ACTIONS;
            let best = argmax(&q_next[here.clone()]);
            let mut y = 0.1 + 0.99 * target_next[here.start + best];
            let action = row % ACTIONS;
            if self.advantage_learning {
                let now = &target_now[here.clone()];
                y -= 0.8 * (now[argmax(now)] - now[action]);
            }
            let (_, gradient) = huber(q[here.start + action] - y, 1.0);
            self.d_q[here.start + action] = gradient / rows as f32;
        }
        self.online_batch.backward(&self.online, &self.x[..half], &self.d_q, &mut self.gradient);
        self.adam.step(self.online.params_mut(), &self.gradient, 1e-4);
        follow(self.target.params_mut(), self.online.params(), 0.005);
    }
}

fn argmax(values: &[f32]) -> usize {
    (1..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best })
}

/// A training step of the intent network: 26 inputs, three outputs, the calibrated head at every tick.
struct LstmTraining {
    net: Lstm,
    batch: LstmBatch,
    adam: Adam,
    gradient: Vec<f32>,
    x: Vec<f32>,
    lengths: Vec<usize>,
}

const INTENT_INPUTS: usize = 26;
const CELLS: usize = 64;

impl LstmTraining {
    fn new(sequences: usize, ticks: usize) -> Self {
        let shape =
            LstmShape::new(INTENT_INPUTS, CELLS, goal_head::OUTPUTS).expect("widths within the limits");
        let mut draw = uniform(3);
        Self {
            net: Lstm::new(shape, uniform(4)),
            batch: LstmBatch::new(shape, sequences, ticks),
            adam: Adam::new(
                shape.parameters(),
                AdamOptions { largest_norm: Some(1.0), ..Default::default() },
            ),
            gradient: vec![0.0; shape.parameters()],
            x: (0..sequences * ticks * INTENT_INPUTS).map(|_| 2.0 * draw() - 1.0).collect(),
            lengths: vec![ticks; sequences],
        }
    }

    /// Operations of the matrix products: forward, weights' gradients, and gradients at the hidden states.
    fn operations(&self) -> f64 {
        let (gates, head) = (self.net.shape().gates(), self.net.shape().head());
        let rows: usize = self.lengths.iter().sum();
        let forward = gates.inputs * gates.outputs + head.inputs * head.outputs;
        let to_hidden = CELLS * gates.outputs + head.inputs * head.outputs;
        (2 * rows * (2 * forward + to_hidden)) as f64
    }

    fn run(&mut self) {
        const GOALS: [[f32; 2]; 3] = [[-0.5, 0.1], [0.25, 0.0], [0.75, -0.2]];
        self.batch.begin(&self.lengths);
        let mut inputs = self.x.chunks_exact(INTENT_INPUTS);
        for (sequence, &length) in self.lengths.iter().enumerate() {
            for (tick, x) in (0..length).zip(&mut inputs) {
                self.batch.input_mut(sequence, tick).copy_from_slice(x);
            }
        }
        self.batch.forward(&self.net);
        let weight = 1.0 / self.batch.total_ticks() as f32;
        for (sequence, &length) in self.lengths.iter().enumerate() {
            for tick in 0..length {
                let (outputs, gradient) = self.batch.output_and_gradient_mut(sequence, tick);
                goal_head::cross_entropy(outputs, &GOALS, sequence % 3, weight, gradient);
            }
        }
        self.batch.backward(&self.net, &mut self.gradient);
        self.adam.step(self.net.params_mut(), &self.gradient, 1e-4);
    }
}

/// What the control loop asks of the networks at a decision: an LSTM step of 26 inputs and 64 cells with the
/// calibrated head, then the values of a 13-64-64 dueling network.
struct Decision {
    intent: Lstm,
    state: LstmState,
    values: Mlp,
    scratch: MlpScratch,
    x: Vec<f32>,
}

impl Decision {
    fn new() -> Self {
        let intent =
            LstmShape::new(INTENT_INPUTS, CELLS, goal_head::OUTPUTS).expect("widths within the limits");
        let values =
            MlpShape::new(STATE, &[64, 64], Head::Dueling(ACTIONS)).expect("widths within the limits");
        let mut draw = uniform(5);
        Self {
            intent: Lstm::new(intent, uniform(6)),
            state: LstmState::new(intent),
            values: Mlp::new(&values, uniform(7)),
            scratch: MlpScratch::new(&values),
            x: (0..INTENT_INPUTS).map(|_| 2.0 * draw() - 1.0).collect(),
        }
    }

    fn run(&mut self) {
        const GOALS: [[f32; 2]; 3] = [[-0.5, 0.1], [0.25, 0.0], [0.75, -0.2]];
        let mut probabilities = [0.0; 3];
        let outputs = self.intent.step(black_box(&self.x), &mut self.state);
        goal_head::probabilities(outputs, &GOALS, &mut probabilities);
        black_box(probabilities);
        black_box(self.values.forward(black_box(&self.x[..STATE]), &mut self.scratch));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Not whether they are fast: other tests run beside this one.
    #[test]
    fn training_has_floors_and_the_decision_has_none() {
        let Timings { timings, gflops, .. } = measure(3);
        assert!(gflops > 0.0 && timings.iter().all(|t| t.best_us > 0.0 && t.median_us >= t.best_us));
        let without_floor: Vec<_> = timings.iter().filter(|t| t.floor_us.is_none()).map(|t| t.name).collect();
        assert_eq!(without_floor, ["decision: LSTM step and values"]);
    }

    #[test]
    fn operations_of_a_small_step_by_hand() {
        // Layers 13-64, 64-64, 64-5: 832 + 4096 + 320 = 5248 products a row.
        let step = DoubleDqn::new(2, &[64, 64], false);
        assert_eq!(step.operations(), (2 * 2 * (5 * 5248 - 832)) as f64);
    }
}
