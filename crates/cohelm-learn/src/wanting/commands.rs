//! What choosing a command should be worth.

use super::{Row, best};
use crate::choices::Choice;
use crate::learner::Lesson;
use cohelm_nn::mlp::{Mlp, MlpBatch, MlpShape};

/// The room that judging takes.
#[derive(Clone, Debug)]
pub(super) struct Judge {
    inputs: usize,
    outputs: usize,
    by_online: MlpBatch,
    by_target: MlpBatch,
}

impl Judge {
    pub fn new(shape: &MlpShape, batch: usize) -> Self {
        Self {
            inputs: shape.input(),
            outputs: shape.outputs(),
            by_online: MlpBatch::new(shape, batch),
            by_target: MlpBatch::new(shape, 2 * batch),
        }
    }

    /// y = R + γᵐ Q⁻(s′, argmax Q(s′)) − α (max Q⁻(s) − Q⁻(s, a)) for each transition.
    pub fn judge(
        &mut self,
        lesson: &Lesson<'_>,
        (online, target): (&Mlp, &Mlp),
        (seen, rows): (&[f32], &[Row]),
        wanted: &mut Vec<(Choice, f32)>,
    ) {
        let (options, n) = (lesson.options, self.outputs);
        let nexts = &seen[options.batch * self.inputs..];
        // The target network need not look at the states themselves if nobody asks what it thinks of them.
        let (now, next) = if options.advantage > 0.0 {
            self.by_target.forward(target, seen).split_at(options.batch * n)
        } else {
            (&[][..], self.by_target.forward(target, nexts))
        };
        let chooser = if options.double { self.by_online.forward(online, nexts) } else { next };
        for (i, row) in rows.iter().enumerate() {
            let of = i * n..(i + 1) * n;
            let chosen = best(&chooser[of.clone()]);
            let mut value = row.rewards + row.discount * next[of.start + chosen];
            if options.advantage > 0.0 {
                let now = &now[of];
                value -= options.advantage * (now[best(now)] - now[row.choice[0] as usize]);
            }
            wanted.push((row.choice, value));
        }
    }
}
