//! What values should be: batches drawn from the memory, and the targets of double Q-learning for them.

mod axes;
mod commands;

use crate::choices::{Choice, Choices, Pupil};
use crate::learner::Lesson;
use crate::mirrored::MirroredInput;
use cohelm::random::Draws;

/// Batches that are ready to be learnt from.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block {
    /// `[updates][batch][inputs]`.
    states: Vec<f32>,
    /// `[updates][batch]`: what was chosen, and what it should have been worth.
    wanted: Vec<(Choice, f32)>,
}

impl Block {
    /// The batches one by one: states and what is wanted.
    pub fn batches(&self, batch: usize) -> impl Iterator<Item = (&[f32], &[(Choice, f32)])> {
        let updates = self.wanted.len() / batch;
        let states = self.states.chunks_exact((self.states.len() / updates.max(1)).max(1));
        states.zip(self.wanted.chunks_exact(batch))
    }
}

/// The room that it takes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wanting {
    inputs: usize,
    /// First the batch's states, then its next states: `[2 batch][inputs]`.
    seen: Vec<f32>,
    rows: Vec<Row>,
    judge: Option<Judge>,
}

/// What a transition holds beside its two states.
#[derive(Clone, Copy, Debug)]
struct Row {
    rewards: f32,
    discount: f32,
    choice: Choice,
}

/// Who says what choices are worth, by their kind.
#[derive(Clone, Debug)]
enum Judge {
    Commands(Box<commands::Judge>),
    Axes(Box<axes::Judge>),
}

impl Wanting {
    pub fn new(choices: &Choices, pupil: &Pupil, batch: usize) -> Self {
        let (inputs, judge) = match pupil {
            Pupil::Commands(network) => {
                let shape = network.shape();
                (shape.input(), Some(Judge::Commands(Box::new(commands::Judge::new(shape, batch)))))
            }
            Pupil::Axes(critic) => {
                let judge = axes::Judge::new(choices, critic.shape(), batch);
                (critic.shape().input(), judge.map(|judge| Judge::Axes(Box::new(judge))))
            }
        };
        Self { inputs, seen: vec![0.0; 2 * batch * inputs], rows: Vec::with_capacity(batch), judge }
    }

    /// Fills a block with that many batches, judged by an online and a target network.
    pub fn prepare(
        &mut self,
        updates: u64,
        lesson: &Lesson<'_>,
        networks: (&Pupil, &Pupil),
        draws: &mut Draws,
        block: &mut Block,
    ) {
        block.states.clear();
        block.wanted.clear();
        for _ in 0..updates {
            self.sample(lesson, draws);
            let Self { seen, rows, judge, .. } = self;
            match (judge, networks) {
                (Some(Judge::Commands(judge)), (Pupil::Commands(online), Pupil::Commands(target))) => {
                    judge.judge(lesson, (online, target), (seen, rows), &mut block.wanted);
                }
                (Some(Judge::Axes(judge)), (Pupil::Axes(online), Pupil::Axes(target))) => {
                    judge.spread(draws);
                    judge.judge(lesson, (online, target), (seen, rows), &mut block.wanted);
                }
                _ => unreachable!("a judge is made for its network"),
            }
            block.states.extend_from_slice(&self.seen[..lesson.options.batch * self.inputs]);
        }
    }

    /// Draws a batch, mirroring every second transition if there is a mirror.
    fn sample(&mut self, lesson: &Lesson<'_>, draws: &mut Draws) {
        let (inputs, memory) = (self.inputs, lesson.memory);
        let (states, nexts) = self.seen.split_at_mut(lesson.options.batch * inputs);
        self.rows.clear();
        for (state, next) in states.chunks_exact_mut(inputs).zip(nexts.chunks_exact_mut(inputs)) {
            let bits = draws.bits();
            let transition = memory.get(((u128::from(bits) * memory.len() as u128) >> 64) as usize);
            // The lowest bit hardly decides which one it is, so that it may decide this.
            let mirror = lesson.mirror.filter(|_| bits & 1 == 1);
            copy(mirror, transition.seen, state);
            copy(mirror, transition.seen_next, next);
            let choice = mirror.map_or(transition.choice, |mirror| mirror.choice(transition.choice));
            self.rows.push(Row { rewards: transition.rewards, discount: transition.discount, choice });
        }
    }
}

fn copy(mirror: Option<&MirroredInput>, from: &[f32], to: &mut [f32]) {
    match mirror {
        Some(mirror) => mirror.apply(from, to),
        None => to.copy_from_slice(from),
    }
}

fn best(values: &[f32]) -> usize {
    (1..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best })
}
