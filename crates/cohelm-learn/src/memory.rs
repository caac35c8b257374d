//! Replay memory: transitions by the hundred thousand, of which an update draws a few at random.

use crate::choices::Choice;

/// Transitions in a ring, each one row of numbers: what was seen, what was seen n steps later, the discounted rewards
/// between, the discount of what follows (0 after a terminal state), and what was chosen.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    inputs: usize,
    choices: usize,
    rows: Vec<f32>,
    capacity: usize,
    next: usize,
}

/// One transition, borrowed from a [`Memory`] or about to go there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transition<'a> {
    pub seen: &'a [f32],
    pub seen_next: &'a [f32],
    pub rewards: f32,
    pub discount: f32,
    pub choice: Choice,
}

impl Memory {
    /// Room for `capacity` transitions between inputs, by choices, of that many numbers.
    pub fn new([inputs, choices]: [usize; 2], capacity: usize) -> Self {
        Self { inputs, choices, rows: Vec::new(), capacity, next: 0 }
    }

    fn width(&self) -> usize {
        2 * self.inputs + 2 + self.choices
    }

    /// Transitions remembered.
    pub fn len(&self) -> usize {
        self.rows.len() / self.width()
    }

    /// Remembers one, in place of the oldest if the memory is full.
    pub fn push(&mut self, Transition { seen, seen_next, rewards, discount, choice }: Transition<'_>) {
        let tail = [rewards, discount];
        let row = seen.iter().chain(seen_next).chain(&tail).chain(&choice[..self.choices]).copied();
        if self.len() < self.capacity {
            self.rows.extend(row);
        } else {
            let start = self.next * self.width();
            self.rows[start..].iter_mut().zip(row).for_each(|(place, number)| *place = number);
        }
        self.next = (self.next + 1) % self.capacity;
    }

    /// Remembers all of another memory, oldest first; it must not have wrapped around.
    pub fn append(&mut self, other: &Self) {
        (0..other.len()).for_each(|index| self.push(other.get(index)));
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.next = 0;
    }

    /// The transition in that place.
    pub fn get(&self, index: usize) -> Transition<'_> {
        let row = &self.rows[index * self.width()..][..self.width()];
        let (seen, rest) = row.split_at(self.inputs);
        let (seen_next, tail) = rest.split_at(self.inputs);
        let mut choice = [0.0; 4];
        choice[..self.choices].copy_from_slice(&tail[2..]);
        Transition { seen, seen_next, rewards: tail[0], discount: tail[1], choice }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transition(rewards: f32) -> Transition<'static> {
        let choice = [0.25, -0.5, 0.0, 0.0];
        Transition { seen: &[1.0, 2.0], seen_next: &[3.0, 4.0], rewards, discount: 0.5, choice }
    }

    #[test]
    fn a_full_memory_forgets_the_oldest() {
        let mut memory = Memory::new([2, 2], 3);
        (0..5).for_each(|i| memory.push(transition(i as f32)));
        let rewards: Vec<f32> = (0..memory.len()).map(|i| memory.get(i).rewards).collect();
        assert_eq!(rewards, [3.0, 4.0, 2.0]);
        assert_eq!(memory.get(0), transition(3.0));
    }
}
