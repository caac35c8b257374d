//! What values should be: batches drawn from the memory, and the targets of double DQN for them.

use crate::learner::Lesson;
use crate::mirrored::MirroredInput;
use cohelm::random::Draws;
use cohelm_nn::mlp::{Mlp, MlpBatch, MlpShape};

/// Batches that are ready to be learnt from.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block {
    /// `[updates][batch][inputs]`.
    states: Vec<f32>,
    /// `[updates][batch]`: the output that was chosen, and what it should have said.
    wanted: Vec<(usize, f32)>,
}

impl Block {
    /// The batches one by one: states and what is wanted.
    pub fn batches(&self, batch: usize) -> impl Iterator<Item = (&[f32], &[(usize, f32)])> {
        let updates = self.wanted.len() / batch;
        let states = self.states.chunks_exact((self.states.len() / updates.max(1)).max(1));
        states.zip(self.wanted.chunks_exact(batch))
    }
}

/// The room that it takes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wanting {
    inputs: usize,
    outputs: usize,
    /// First the batch's states, then its next states: `[2 batch][inputs]`.
    seen: Vec<f32>,
    rows: Vec<Row>,
    by_online: Option<MlpBatch>,
    by_target: Option<MlpBatch>,
}

/// What a transition holds beside its two states.
#[derive(Clone, Copy, Debug)]
struct Row {
    rewards: f32,
    discount: f32,
    output: usize,
}

impl Wanting {
    pub fn new(shape: &MlpShape, batch: usize) -> Self {
        Self {
            inputs: shape.input(),
            outputs: shape.outputs(),
            seen: vec![0.0; 2 * batch * shape.input()],
            rows: Vec::with_capacity(batch),
            by_online: Some(MlpBatch::new(shape, batch)),
            by_target: Some(MlpBatch::new(shape, 2 * batch)),
        }
    }

    /// Fills a block with that many batches, judged by an online and a target network.
    pub fn prepare(
        &mut self,
        updates: u64,
        lesson: &Lesson<'_>,
        networks: (&Mlp, &Mlp),
        draws: &mut Draws,
        block: &mut Block,
    ) {
        block.states.clear();
        block.wanted.clear();
        for _ in 0..updates {
            self.sample(lesson, draws);
            self.judge(lesson, networks, &mut block.wanted);
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
            let output = mirror.map_or(transition.output, |mirror| mirror.output(transition.output));
            self.rows.push(Row { rewards: transition.rewards, discount: transition.discount, output });
        }
    }

    /// y = R + γᵐ Q⁻(s′, argmax Q(s′)) − α (max Q⁻(s) − Q⁻(s, a)) for each transition.
    fn judge(&mut self, lesson: &Lesson<'_>, (online, target): (&Mlp, &Mlp), wanted: &mut Vec<(usize, f32)>) {
        let (options, n) = (lesson.options, self.outputs);
        let (Some(by_online), Some(by_target)) = (&mut self.by_online, &mut self.by_target) else { return };
        let nexts = &self.seen[options.batch * self.inputs..];
        // The target network need not look at the states themselves if nobody asks what it thinks of them.
        let (now, next) = if options.advantage > 0.0 {
            by_target.forward(target, &self.seen).split_at(options.batch * n)
        } else {
            (&[][..], by_target.forward(target, nexts))
        };
        let chooser = if options.double { by_online.forward(online, nexts) } else { next };
        for (i, row) in self.rows.iter().enumerate() {
            let of = i * n..(i + 1) * n;
            let chosen = best(&chooser[of.clone()]);
            let mut value = row.rewards + row.discount * next[of.start + chosen];
            if options.advantage > 0.0 {
                let now = &now[of];
                value -= options.advantage * (now[best(now)] - now[row.output]);
            }
            wanted.push((row.output, value));
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
