//! The network that learns: double DQN, block after block of updates.
//!
//! An update has two halves of about the same cost: what the values should be ([`Wanting`]), and the step towards it
//! (here). They run on two threads, the first half a block of updates ahead of the second; so it sees weights that are
//! up to two blocks old, and does so for any number of threads.

use crate::choices::{Choice, Choices, Pupil};
use crate::job::LearnError;
use crate::memory::Memory;
use crate::mirrored::MirroredInput;
use crate::options::{Target, ValueOptions};
use crate::parallel;
use crate::progress::Profile;
use crate::wanting::{Block, Wanting};
use cohelm::action::Action;
use cohelm::random::Draws;
use cohelm_copilot::axes::AxesEncoder;
use cohelm_nn::adam::{Adam, AdamOptions, follow};
use cohelm_nn::critic::CriticBatch;
use cohelm_nn::loss::huber;
use cohelm_nn::mlp::MlpBatch;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// All weights of a training.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Weights {
    /// The network that learns.
    pub online: Pupil,
    /// The one that says what comes after.
    pub target: Pupil,
    /// The one that is kept: see [`ValueOptions::average`].
    pub average: Pupil,
    pub adam: Adam,
}

impl Weights {
    /// The weights before the first update.
    pub fn begin(online: Pupil) -> Self {
        let adam = Adam::new(online.params().len(), AdamOptions::default());
        Self { target: online.clone(), average: online.clone(), online, adam }
    }
}

/// What there is to learn.
#[derive(Clone, Copy)]
pub(crate) struct Lesson<'a> {
    pub memory: &'a Memory,
    pub mirror: Option<&'a MirroredInput>,
    pub options: &'a ValueOptions,
    pub updates: u64,
    pub rate: f32,
    pub threads: NonZeroUsize,
}

/// Weights, and the room that updates take.
pub(crate) struct Learner {
    pub weights: Weights,
    wanting: Wanting,
    blocks: [Block; 2],
    pass: Pass,
    /// The loss's gradient at each value.
    d_values: Vec<f32>,
    gradient: Vec<f32>,
}

/// The room of a forward and backward pass.
enum Pass {
    Commands { by_online: MlpBatch, d_outputs: Vec<f32> },
    Axes { by_online: Box<CriticBatch>, axes: AxesEncoder, chosen: Vec<f32> },
}

impl Learner {
    pub fn new(weights: Weights, choices: &Choices, options: &ValueOptions) -> Self {
        let parameters = weights.online.params().len();
        let pass = match (&weights.online, choices) {
            (Pupil::Commands(network), _) => Pass::Commands {
                by_online: MlpBatch::new(network.shape(), options.batch),
                d_outputs: vec![0.0; options.batch * network.shape().outputs()],
            },
            (Pupil::Axes(critic), Choices::Axes { axes, grid }) => {
                let mut reference = vec![0.0; grid.len() * axes.len()];
                let rows = reference.chunks_exact_mut(axes.len());
                rows.zip(grid).for_each(|(row, &action)| axes.encode_into(action, row));
                let by_online = CriticBatch::new(critic.shape(), &reference, options.batch, options.batch);
                Pass::Axes {
                    by_online: Box::new(by_online),
                    axes: axes.clone(),
                    chosen: vec![0.0; options.batch * axes.len()],
                }
            }
            _ => unreachable!("a critic learns axes"),
        };
        Self {
            wanting: Wanting::new(choices, &weights.online, options.batch),
            blocks: Default::default(),
            pass,
            d_values: vec![0.0; options.batch],
            gradient: vec![0.0; parameters],
            weights,
        }
    }

    /// Does the updates of a lesson on batches drawn from its memory; returns the mean loss of the last batch.
    pub fn learn(
        &mut self,
        lesson: &Lesson<'_>,
        draws: &mut Draws,
        profile: &mut Profile,
    ) -> Result<f32, LearnError> {
        let loss = match lesson.options.ahead {
            0 => self.one_by_one(lesson, draws, profile),
            ahead => self.in_blocks(lesson, ahead, draws, profile),
        };
        if loss.is_finite() {
            Ok(loss)
        } else {
            Err(LearnError::Diverged { updates: self.weights.adam.steps() })
        }
    }

    fn one_by_one(&mut self, lesson: &Lesson<'_>, draws: &mut Draws, profile: &mut Profile) -> f32 {
        let mut block = std::mem::take(&mut self.blocks[0]);
        let mut loss = 0.0;
        for _ in 0..lesson.updates {
            let Weights { online, target, .. } = &self.weights;
            profile.prepare +=
                timed(|| self.wanting.prepare(1, lesson, (online, target), draws, &mut block)).1;
            let (trained, took) = timed(|| self.train(lesson, &block));
            (loss, profile.train) = (trained, profile.train + took);
        }
        self.blocks[0] = block;
        loss
    }

    fn in_blocks(
        &mut self,
        lesson: &Lesson<'_>,
        ahead: u64,
        draws: &mut Draws,
        profile: &mut Profile,
    ) -> f32 {
        let [mut now, mut next] = std::mem::take(&mut self.blocks);
        let mut wanting = std::mem::take(&mut self.wanting);
        let size = |done: u64| ahead.min(lesson.updates.saturating_sub(done));
        let Weights { online, target, .. } = &self.weights;
        profile.prepare += timed(|| wanting.prepare(size(0), lesson, (online, target), draws, &mut now)).1;
        let (mut loss, mut done) = (0.0, 0);
        while done < lesson.updates {
            done += size(done);
            let (online, target) = (self.weights.online.clone(), self.weights.target.clone());
            let (prepared, (trained, took)) = parallel::both(
                lesson.threads,
                |_| timed(|| wanting.prepare(size(done), lesson, (&online, &target), draws, &mut next)).1,
                || timed(|| self.train(lesson, &now)),
            );
            (loss, profile.train) = (trained, profile.train + took);
            profile.prepare += prepared;
            std::mem::swap(&mut now, &mut next);
        }
        (self.blocks, self.wanting) = ([now, next], wanting);
        loss
    }

    /// One step for each batch of a block; returns the mean loss of the last.
    fn train(&mut self, lesson: &Lesson<'_>, block: &Block) -> f32 {
        let options = lesson.options;
        let mut loss = 0.0;
        for (states, wanted) in block.batches(options.batch) {
            loss = self.differentiate(states, wanted, options.huber);
            let Weights { online, target, average, adam } = &mut self.weights;
            adam.step(online.params_mut(), &self.gradient, lesson.rate);
            if let Target::Follow(rate) = options.target {
                follow(target.params_mut(), online.params(), rate);
            }
            follow(average.params_mut(), online.params(), options.average);
        }
        loss
    }

    /// The gradient of the mean loss over a batch; returns that loss.
    fn differentiate(&mut self, states: &[f32], wanted: &[(Choice, f32)], bound: f32) -> f32 {
        let Self { weights, pass, d_values, gradient, .. } = self;
        match (pass, &weights.online) {
            (Pass::Commands { by_online, d_outputs }, Pupil::Commands(online)) => {
                let n = online.shape().outputs();
                let values = by_online.forward(online, states);
                let value = |row: usize, choice: &Choice| values[row * n + choice[0] as usize];
                let loss = slopes(wanted, bound, value, d_values);
                d_outputs.fill(0.0);
                for (row, ((choice, _), d)) in wanted.iter().zip(d_values).enumerate() {
                    d_outputs[row * n + choice[0] as usize] = *d;
                }
                by_online.backward(online, states, d_outputs, gradient);
                loss
            }
            (Pass::Axes { by_online, axes, chosen }, Pupil::Axes(online)) => {
                for (row, (choice, _)) in chosen.chunks_exact_mut(axes.len()).zip(wanted) {
                    axes.encode_into(Action::Axes(*choice), row);
                }
                by_online.look(online, states);
                let values = by_online.each(online, chosen);
                let loss = slopes(wanted, bound, |row, _| values[row], d_values);
                by_online.backward(online, states, d_values, gradient);
                loss
            }
            _ => unreachable!("a pass is made for its network"),
        }
    }
}

/// The mean loss of values against what is wanted, and its gradient at each of them.
fn slopes(
    wanted: &[(Choice, f32)],
    bound: f32,
    value: impl Fn(usize, &Choice) -> f32,
    d_values: &mut [f32],
) -> f32 {
    let weight = 1.0 / wanted.len() as f32;
    let mut loss = 0.0;
    for (row, ((choice, wanted), d)) in wanted.iter().zip(d_values).enumerate() {
        let error = value(row, choice) - wanted;
        let (row_loss, slope) = if bound > 0.0 { huber(error, bound) } else { (error * error, 2.0 * error) };
        loss += weight * row_loss;
        *d = weight * slope;
    }
    loss
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let begun = Instant::now();
    let result = work();
    (result, begun.elapsed())
}
