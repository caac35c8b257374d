//! What choosing an action on axes should be worth: the same targets, the maxima taken over samples.
//!
//! The samples are the beginning of the grid that decisions begin with (nothing, the ends, the corners, a few points) and
//! points of low discrepancy that are shifted anew for every update: over many updates every part of the space is asked
//! about, so that no place between fixed points can be overrated unseen. All transitions of a batch share them, so that φ of
//! the samples is worked out once an update.

use super::Row;
use crate::choices::{Choice, Choices};
use crate::learner::Lesson;
use cohelm::action::Action;
use cohelm::random::Draws;
use cohelm_copilot::axes::{AxesEncoder, Spread};
use cohelm_nn::critic::{Critic, CriticBatch, CriticShape};

/// Samples over which maxima are taken. Few: the best action is missed and values come out low; many: updates take longer.
const SAMPLES: usize = 64;
/// How many of them are those of the grid, always the same.
const FIXED: usize = 32;

/// The room that judging takes.
#[derive(Clone, Debug)]
pub(super) struct Judge {
    axes: AxesEncoder,
    spread: Spread,
    inputs: usize,
    samples: Vec<f32>,
    chosen: Vec<f32>,
    by_online: CriticBatch,
    by_target: CriticBatch,
    best_next: Vec<usize>,
    most_now: Vec<f32>,
    next: Vec<f32>,
}

impl Judge {
    pub fn new(choices: &Choices, shape: &CriticShape, batch: usize) -> Option<Self> {
        let Choices::Axes { axes, grid } = choices else { return None };
        let encoded = |actions: &[Action]| {
            let mut rows = vec![0.0; actions.len() * axes.len()];
            rows.chunks_exact_mut(axes.len()).zip(actions).for_each(|(row, &a)| axes.encode_into(a, row));
            rows
        };
        let reference = encoded(grid);
        let mut samples = encoded(&grid[..FIXED]);
        samples.resize(SAMPLES * axes.len(), 0.0);
        Some(Self {
            spread: Spread::over(axes.axes()),
            inputs: shape.input(),
            samples,
            chosen: vec![0.0; batch * axes.len()],
            by_online: CriticBatch::new(shape, &reference, batch, SAMPLES),
            by_target: CriticBatch::new(shape, &reference, 2 * batch, SAMPLES.max(batch)),
            best_next: Vec::with_capacity(batch),
            most_now: Vec::with_capacity(batch),
            next: Vec::with_capacity(batch),
            axes: axes.clone(),
        })
    }

    /// Shifts the samples that are not fixed.
    pub fn spread(&mut self, draws: &mut Draws) {
        let shift = core::array::from_fn(|_| draws.unit());
        let moving = self.samples.chunks_exact_mut(self.axes.len()).skip(FIXED);
        for (number, row) in moving.enumerate() {
            self.axes.encode_into(self.axes.at(self.spread.point(number, shift)), row);
        }
    }

    /// y = R + γᵐ Q⁻(s′, argmax Q(s′)) − α (max Q⁻(s) − Q⁻(s, a)) for each transition, the maxima over the samples, and the
    /// last one over what was chosen too.
    pub fn judge(
        &mut self,
        lesson: &Lesson<'_>,
        (online, target): (&Critic, &Critic),
        (seen, rows): (&[f32], &[Row]),
        wanted: &mut Vec<(Choice, f32)>,
    ) {
        let options = lesson.options;
        let nexts = &seen[options.batch * self.inputs..];
        self.best_next.clear();
        if options.double {
            self.by_online.look(online, nexts);
            let values = self.by_online.every(online, &self.samples);
            self.best_next.extend(values.chunks_exact(SAMPLES).map(best));
        }
        self.by_target.look(target, seen);
        let (now, next) = self.by_target.every(target, &self.samples).split_at(options.batch * SAMPLES);
        if !options.double {
            self.best_next.extend(next.chunks_exact(SAMPLES).map(best));
        }
        self.next.clear();
        let chosen = next.chunks_exact(SAMPLES).zip(&self.best_next);
        self.next.extend(chosen.map(|(values, &best)| values[best]));
        self.most_now.clear();
        self.most_now.extend(now.chunks_exact(SAMPLES).map(|values| values[best(values)]));
        self.encode_chosen(rows);
        let of_chosen = (options.advantage > 0.0).then(|| self.by_target.each(target, &self.chosen));
        for (i, row) in rows.iter().enumerate() {
            let mut value = row.rewards + row.discount * self.next[i];
            if let Some(of_chosen) = of_chosen {
                value -= options.advantage * (self.most_now[i] - of_chosen[i]).max(0.0);
            }
            wanted.push((row.choice, value));
        }
    }

    fn encode_chosen(&mut self, rows: &[Row]) {
        for (encoded, row) in self.chosen.chunks_exact_mut(self.axes.len()).zip(rows) {
            self.axes.encode_into(Action::Axes(row.choice), encoded);
        }
    }
}

/// Values looked at side by side in [`best`].
const ABREAST: usize = 16;

/// The place of the largest value, the first of equals; 0 if one is not a number.
fn best(values: &[f32]) -> usize {
    let mut most = [f32::NEG_INFINITY; ABREAST];
    for values in values.chunks_exact(ABREAST) {
        for (most, &value) in most.iter_mut().zip(values) {
            *most = if value > *most { value } else { *most };
        }
    }
    let most = most.into_iter().fold(f32::NEG_INFINITY, f32::max);
    values.iter().position(|&value| value == most).unwrap_or(0)
}

// No value is left out.
const _: () = assert!(SAMPLES.is_multiple_of(ABREAST));
