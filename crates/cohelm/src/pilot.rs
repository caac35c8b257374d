//! Who asks: a person at keys, or a model of one.

use crate::action::Action;
use crate::plant::View;

/// Asks for at most one action a tick. The pilot, unlike the co-pilot, knows which goal is wanted.
pub trait Pilot: Send {
    /// Begins an episode; whatever is random about the pilot comes from `seed`.
    fn begin(&mut self, seed: u64);

    /// What is asked now; `None` if nothing is.
    fn ask(&mut self, view: &View<'_>, goal: usize) -> Option<Action>;

    /// Keys pressed since the episode began; 0 for a pilot without keys.
    fn key_presses(&self) -> u32 {
        0
    }

    /// The controls that are held down since what was asked last, one bit each; `None` for a pilot without keys, whose
    /// requests no key log could give.
    fn keys_down(&self) -> Option<u64> {
        None
    }
}

/// Never asks for anything.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Pilot for Silent {
    fn begin(&mut self, _seed: u64) {}

    fn ask(&mut self, _view: &View<'_>, _goal: usize) -> Option<Action> {
        None
    }

    fn keys_down(&self) -> Option<u64> {
        Some(0)
    }
}

/// Asks again for what a recorded pilot asked, tick by tick, then for nothing.
#[derive(Clone, Debug)]
pub struct Recorded<'a> {
    asked: &'a [Option<Action>],
    next: usize,
}

impl<'a> Recorded<'a> {
    /// The requests of an episode, one a tick.
    pub fn new(asked: &'a [Option<Action>]) -> Self {
        Self { asked, next: 0 }
    }
}

impl Pilot for Recorded<'_> {
    fn begin(&mut self, _seed: u64) {
        self.next = 0;
    }

    fn ask(&mut self, _view: &View<'_>, _goal: usize) -> Option<Action> {
        let asked = self.asked.get(self.next).copied().flatten();
        self.next += 1;
        asked
    }
}
