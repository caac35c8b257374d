//! From single steps to transitions over n steps.

use crate::choices::Choice;
use crate::memory::{Memory, Transition};
use std::collections::VecDeque;

/// The last steps of an episode, until what they led to is known.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    n: usize,
    discount: f32,
    pending: VecDeque<Pending>,
    spare: Vec<Vec<f32>>,
}

#[derive(Clone, Debug)]
struct Pending {
    seen: Vec<f32>,
    choice: Choice,
    rewards: f32,
    discount: f32,
}

impl Window {
    pub fn new(n: usize, discount: f32) -> Self {
        Self { n, discount, pending: VecDeque::with_capacity(n + 1), spare: Vec::new() }
    }

    /// Something is seen that is not the end: the step n before it is complete.
    pub fn see(&mut self, seen: &[f32], memory: &mut Memory) {
        if self.pending.len() == self.n
            && let Some(step) = self.pending.pop_front()
        {
            let Pending { seen: before, choice, rewards, discount } = step;
            memory.push(Transition { seen: &before, seen_next: seen, rewards, discount, choice });
            self.spare.push(before);
        }
    }

    /// A choice was made for what is seen, and brought a reward.
    pub fn act(&mut self, seen: &[f32], choice: Choice, reward: f32) {
        let mut copy = self.spare.pop().unwrap_or_default();
        copy.clear();
        copy.extend_from_slice(seen);
        self.pending.push_back(Pending { seen: copy, choice, rewards: 0.0, discount: 1.0 });
        for step in &mut self.pending {
            step.rewards += step.discount * reward;
            step.discount *= self.discount;
        }
    }

    /// The episode is over: all steps that are left lead to what is seen at last. After a terminal state nothing
    /// follows, so its discount is 0; after a truncation values go on.
    pub fn end(&mut self, seen: &[f32], terminal: bool, memory: &mut Memory) {
        while let Some(Pending { seen: before, choice, rewards, discount }) = self.pending.pop_front() {
            let discount = if terminal { 0.0 } else { discount };
            memory.push(Transition { seen: &before, seen_next: seen, rewards, discount, choice });
            self.spare.push(before);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rewards 1, 2, 4 at inputs 0, 1, 2, ending in input 3, over two steps at discount 1/2.
    fn flown(terminal: bool) -> Vec<(f32, f32, f32, f32)> {
        let (mut window, mut memory) = (Window::new(2, 0.5), Memory::new([1, 1], 10));
        for (i, reward) in [1.0, 2.0, 4.0].into_iter().enumerate() {
            window.see(&[i as f32], &mut memory);
            window.act(&[i as f32], [0.0; 4], reward);
        }
        window.end(&[3.0], terminal, &mut memory);
        let row = |i| {
            let t = memory.get(i);
            (t.seen[0], t.seen_next[0], t.rewards, t.discount)
        };
        (0..memory.len()).map(row).collect()
    }

    #[test]
    fn rewards_are_summed_over_n_steps() {
        assert_eq!(flown(false), [(0.0, 2.0, 2.0, 0.25), (1.0, 3.0, 4.0, 0.25), (2.0, 3.0, 4.0, 0.5)]);
    }

    #[test]
    fn nothing_lies_beyond_a_terminal_state() {
        assert_eq!(flown(true), [(0.0, 2.0, 2.0, 0.25), (1.0, 3.0, 4.0, 0.0), (2.0, 3.0, 4.0, 0.0)]);
    }
}
