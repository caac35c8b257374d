//! The network that learns: one update of double DQN after another.

use crate::job::LearnError;
use crate::memory::Memory;
use crate::options::{Target, ValueOptions};
use crate::progress::Profile;
use cohelm::plant::Mirror;
use cohelm::random::Draws;
use cohelm_copilot::outputs::Outputs;
use cohelm_nn::adam::{Adam, AdamOptions, follow};
use cohelm_nn::loss::huber;
use cohelm_nn::mlp::{Mlp, MlpBatch};
use std::time::Instant;

/// Online and target network, optimiser, and the room that an update takes.
pub(crate) struct Learner {
    pub online: Mlp,
    pub target: Mlp,
    pub adam: Adam,
    mirror: Option<MirroredInput>,
    inputs: usize,
    /// First the batch's states, then its next states: `[2 batch][inputs]`.
    batch: Vec<f32>,
    rows: Vec<Row>,
    by_online: MlpBatch,
    by_target: MlpBatch,
    d_outputs: Vec<f32>,
    gradient: Vec<f32>,
}

/// What a row of the batch holds beside its two states.
#[derive(Clone, Copy, Debug)]
struct Row {
    rewards: f32,
    discount: f32,
    output: usize,
}

impl Learner {
    pub fn new(
        online: Mlp,
        target: Mlp,
        adam: Adam,
        mirror: Option<MirroredInput>,
        options: &ValueOptions,
    ) -> Self {
        let shape = online.shape().clone();
        let inputs = shape.input();
        Self {
            mirror,
            inputs,
            batch: vec![0.0; 2 * options.batch * inputs],
            rows: Vec::with_capacity(options.batch),
            by_online: MlpBatch::new(&shape, 2 * options.batch),
            by_target: MlpBatch::new(&shape, 2 * options.batch),
            d_outputs: vec![0.0; options.batch * shape.outputs()],
            gradient: vec![0.0; online.params().len()],
            online,
            target,
            adam,
        }
    }

    /// A learner at its beginning.
    pub fn begin(online: Mlp, mirror: Option<MirroredInput>, options: &ValueOptions) -> Self {
        let adam = Adam::new(online.params().len(), AdamOptions::default());
        Self::new(online.clone(), online, adam, mirror, options)
    }

    /// Does that many updates on batches drawn from the memory; returns the mean loss of the last one.
    pub fn learn(
        &mut self,
        memory: &Memory,
        (updates, rate): (u64, f32),
        options: &ValueOptions,
        draws: &mut Draws,
        profile: &mut Profile,
    ) -> Result<f32, LearnError> {
        let mut loss = 0.0;
        for _ in 0..updates {
            let begun = Instant::now();
            self.sample(memory, options.batch, draws);
            let sampled = Instant::now();
            loss = self.differentiate(options);
            let differentiated = Instant::now();
            self.adam.step(self.online.params_mut(), &self.gradient, rate);
            if let Target::Follow(rate) = options.target {
                follow(self.target.params_mut(), self.online.params(), rate);
            }
            profile.sample += sampled - begun;
            profile.gradients += differentiated - sampled;
            profile.optimise += differentiated.elapsed();
        }
        if !loss.is_finite() {
            return Err(LearnError::Diverged { updates: self.adam.steps() });
        }
        Ok(loss)
    }

    /// The target network becomes the online one.
    pub fn copy_target(&mut self) {
        self.target.params_mut().copy_from_slice(self.online.params());
    }

    /// Draws a batch, mirroring every second transition if there is a mirror.
    fn sample(&mut self, memory: &Memory, batch: usize, draws: &mut Draws) {
        let inputs = self.inputs;
        let (seen, seen_next) = self.batch.split_at_mut(batch * inputs);
        self.rows.clear();
        for (seen, seen_next) in seen.chunks_exact_mut(inputs).zip(seen_next.chunks_exact_mut(inputs)) {
            let bits = draws.bits();
            let index = ((u128::from(bits) * memory.len() as u128) >> 64) as usize;
            let transition = memory.get(index);
            let mut row =
                Row { rewards: transition.rewards, discount: transition.discount, output: transition.output };
            // The lowest bit hardly decides the index, so that it may decide this.
            match &self.mirror {
                Some(mirror) if bits & 1 == 1 => {
                    mirror.apply(transition.seen, seen);
                    mirror.apply(transition.seen_next, seen_next);
                    row.output = mirror.outputs[row.output];
                }
                _ => {
                    seen.copy_from_slice(transition.seen);
                    seen_next.copy_from_slice(transition.seen_next);
                }
            }
            self.rows.push(row);
        }
    }

    /// The gradient of the mean loss over the batch; returns that loss.
    fn differentiate(&mut self, options: &ValueOptions) -> f32 {
        let n = self.online.shape().outputs();
        let batch = self.rows.len();
        let (states, next_states) = self.batch.split_at(batch * self.inputs);
        // Networks that nobody asks about these rows need not see them.
        let (now, next) = if options.advantage > 0.0 {
            self.by_target.forward(&self.target, &self.batch).split_at(batch * n)
        } else {
            (&[][..], self.by_target.forward(&self.target, next_states))
        };
        let online = self.by_online.forward(&self.online, if options.double { &self.batch } else { states });
        self.d_outputs.fill(0.0);
        let weight = 1.0 / batch as f32;
        let mut loss = 0.0;
        for (i, row) in self.rows.iter().enumerate() {
            let of = |values: &[f32]| [i * n, (i + 1) * n].map(|at| at.min(values.len()));
            let [from, to] = of(next);
            let chooser = if options.double { &online[(batch + i) * n..][..n] } else { &next[from..to] };
            let mut wanted = row.rewards + row.discount * next[from + best(chooser)];
            if options.advantage > 0.0 {
                let now = &now[from..to];
                wanted -= options.advantage * (now[best(now)] - now[row.output]);
            }
            let error = online[i * n + row.output] - wanted;
            let (row_loss, slope) =
                if options.huber > 0.0 { huber(error, options.huber) } else { (error * error, 2.0 * error) };
            loss += weight * row_loss;
            self.d_outputs[i * n + row.output] = weight * slope;
        }
        self.by_online.backward(&self.online, states, &self.d_outputs, &mut self.gradient);
        loss
    }
}

fn best(values: &[f32]) -> usize {
    (1..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best })
}

/// A plant's symmetry, as it shows in the network's input and outputs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MirroredInput {
    /// Where each number comes from, and its sign.
    input: Vec<(usize, f32)>,
    /// The output that each output becomes.
    outputs: Vec<usize>,
}

impl MirroredInput {
    /// For inputs of a state, the way to the goal, and `asked` commands.
    pub fn new(mirror: &Mirror, outputs: Outputs, asked: usize) -> Self {
        let state = mirror.state.len();
        let to_goal = [0, 1].map(|i| (state + i, mirror.position[i]));
        let one_hot =
            mirror.commands.iter().take(asked).map(|&command| (state + 2 + usize::from(command), 1.0));
        let mirrored = |output| {
            let command = outputs.command(output, 0).command().unwrap_or(0);
            outputs.output(usize::from(mirror.commands[command]), 0)
        };
        Self {
            input: mirror.state.iter().copied().chain(to_goal).chain(one_hot).collect(),
            outputs: (0..outputs.len()).map(mirrored).collect(),
        }
    }

    fn apply(&self, from: &[f32], to: &mut [f32]) {
        for (to, &(place, sign)) in to.iter_mut().zip(&self.input) {
            *to = sign * from[place];
        }
    }
}
