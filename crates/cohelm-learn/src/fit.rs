//! Fits an LSTM to sequences.

use crate::intent_options::IntentOptions;
use crate::sequence::{MirroredSequence, Sequence};
use cohelm::random::Draws;
use cohelm_nn::adam::{Adam, AdamOptions};
use cohelm_nn::goal_head;
use cohelm_nn::loss::mean_squared;
use cohelm_nn::lstm::{Lstm, LstmBatch};
use std::borrow::Cow;

/// What the outputs are to become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aim {
    /// The position of the pilot's goal, by squared error: the paper's.
    Position,
    /// A position and a spread by which the pilot's goal is likely: among the goals by cross-entropy, or, where goals
    /// are hidden, among all places by its density.
    Likelihood,
}

impl Aim {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Position, Self::Likelihood];
}

/// What is learnt from, and how.
#[derive(Clone, Copy)]
pub(crate) struct School<'a> {
    pub sequences: &'a [Sequence],
    pub mirror: Option<&'a MirroredSequence>,
    pub options: &'a IntentOptions,
}

/// A network on its way, and its optimiser.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fitting {
    pub network: Lstm,
    pub adam: Adam,
}

impl Fitting {
    pub fn begin(network: Lstm, options: &IntentOptions) -> Self {
        let adam = AdamOptions { largest_norm: Some(options.largest_norm), ..AdamOptions::default() };
        Self { adam: Adam::new(network.params().len(), adam), network }
    }

    /// Goes through all sequences once, in an order drawn anew, every second one in a mirror if there is one. `epoch`
    /// counts from 0 and sets the learning rate. Returns the mean loss a tick.
    pub fn epoch(&mut self, school: &School<'_>, aim: Aim, epoch: u32, draws: &mut Draws) -> f64 {
        let School { sequences, mirror, options } = *school;
        let order = shuffled(sequences.len(), draws);
        let batches = order.len().div_ceil(options.batch).max(1);
        let mut batch = LstmBatch::new(self.network.shape(), options.batch, options.longest);
        let mut gradient = vec![0.0; self.network.params().len()];
        let (mut loss, mut ticks) = (0.0, 0.0);
        for (i, chosen) in order.chunks(options.batch).enumerate() {
            let mut choose = |&index: &usize| match mirror.filter(|_| draws.chance(0.5)) {
                Some(mirror) => Cow::Owned(mirror.of(&sequences[index])),
                None => Cow::Borrowed(&sequences[index]),
            };
            let chosen: Vec<Cow<'_, Sequence>> = chosen.iter().map(&mut choose).collect();
            self.load(&mut batch, &chosen, options.longest);
            if batch.total_ticks() == 0 {
                continue;
            }
            batch.forward(&self.network);
            loss += differentiate(&mut batch, &chosen, aim, options);
            ticks += batch.total_ticks() as f64;
            batch.backward(&self.network, &mut gradient);
            let done = (f64::from(epoch) + i as f64 / batches as f64) / f64::from(options.epochs);
            let rate = options.learning_rate * (1.0 - done as f32);
            self.adam.step(self.network.params_mut(), &gradient, rate);
        }
        loss / f64::max(ticks, 1.0)
    }

    fn load(&self, batch: &mut LstmBatch, chosen: &[Cow<'_, Sequence>], longest: usize) {
        let lengths: Vec<usize> = chosen.iter().map(|sequence| sequence.ticks().min(longest)).collect();
        batch.begin(&lengths);
        let width = self.network.shape().input();
        for (s, (sequence, &length)) in chosen.iter().zip(&lengths).enumerate() {
            for tick in 0..length {
                batch.input_mut(s, tick).copy_from_slice(&sequence.row(tick)[..width]);
            }
        }
    }
}

/// Writes the gradient of the mean loss a tick; returns the sum of the losses.
fn differentiate(
    batch: &mut LstmBatch,
    chosen: &[Cow<'_, Sequence>],
    aim: Aim,
    options: &IntentOptions,
) -> f64 {
    let weight = 1.0 / batch.total_ticks() as f32;
    let mut loss = 0.0;
    for (s, sequence) in chosen.iter().enumerate() {
        for tick in 0..sequence.ticks().min(options.longest) {
            let (outputs, gradient) = batch.output_and_gradient_mut(s, tick);
            loss += f64::from(match aim {
                Aim::Position => mean_squared(outputs, &sequence.wanted(tick), weight, gradient),
                Aim::Likelihood if options.goals_hidden => {
                    goal_head::surprise(outputs, &sequence.wanted(tick), weight, gradient)
                }
                Aim::Likelihood => {
                    let goals = sequence.goals(tick);
                    goal_head::cross_entropy(outputs, goals, sequence.truth(tick), weight, gradient)
                }
            });
        }
    }
    loss
}

/// The numbers below `n` in a random order (Fisher–Yates).
fn shuffled(n: usize, draws: &mut Draws) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        order.swap(i, draws.below(i + 1));
    }
    order
}
