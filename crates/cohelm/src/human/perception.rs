//! What a pilot sees: the world of a reaction delay ago, its speeds misjudged, carried forward to now as well as the
//! pilot can.

use super::skill::{Motion, Seen};
use super::traits::{NOISE_MEMORY, Traits};
use crate::plant::View;
use crate::random::Draws;
use std::collections::VecDeque;

/// One tick, as it was.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Moment {
    pub(super) state: Vec<f32>,
    pub(super) goal: [f32; 2],
    /// Controls, one bit each, that the pilot knew should be working then.
    pub(super) expected: u64,
}

/// The last ticks, up to the reaction delay.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    moments: VecDeque<Moment>,
    delay_ticks: usize,
}

impl Memory {
    pub(super) fn new(delay_ticks: u32) -> Self {
        let delay_ticks = delay_ticks as usize;
        Self { moments: VecDeque::with_capacity(delay_ticks + 1), delay_ticks }
    }

    pub(super) fn clear(&mut self) {
        self.moments.clear();
    }

    /// Takes in what is there now, in the place of what is older than the delay.
    pub(super) fn remember(&mut self, view: &View<'_>, goal: usize, expected: u64) {
        let full = self.moments.len() > self.delay_ticks;
        let mut moment = if full { self.moments.pop_front() } else { None }.unwrap_or_default();
        moment.state.clear();
        moment.state.extend_from_slice(view.state);
        moment.goal = view.goals.get(goal).map_or(view.position, |goal| goal.position);
        moment.expected = expected;
        self.moments.push_back(moment);
    }

    /// What was there a delay ago; `None` while the episode is younger than that.
    pub(super) fn recall(&self) -> Option<&Moment> {
        self.moments.front().filter(|_| self.moments.len() > self.delay_ticks)
    }
}

/// How speeds are misjudged, and what comes of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Eye {
    noise: Vec<f64>,
    state: Vec<f64>,
}

impl Eye {
    /// An eye for these motions, with errors drawn from their long-run distribution.
    pub(super) fn new(motions: &[Motion], draws: &mut Draws) -> Self {
        Self { noise: motions.iter().map(|_| draws.normal()).collect(), state: Vec::new() }
    }

    /// One tick of wandering: the errors stay normal with unit spread.
    pub(super) fn drift(&mut self, draws: &mut Draws) {
        let fresh = libm::sqrt(1.0 - NOISE_MEMORY * NOISE_MEMORY);
        for noise in &mut self.noise {
            *noise = NOISE_MEMORY * *noise + fresh * draws.normal();
        }
    }

    /// Looks at a moment: judges speeds, then carries what moves forward over the predicted share of the delay.
    pub(super) fn look(&mut self, moment: &Moment, motions: &[Motion], traits: &Traits) -> Seen<'_> {
        self.state.clear();
        self.state.extend(moment.state.iter().map(|&component| f64::from(component)));
        for (motion, noise) in motions.iter().zip(&self.noise) {
            if let Some(speed) = self.state.get_mut(motion.speed).filter(|_| motion.judged) {
                *speed *= traits.speed_gain * (1.0 + traits.speed_noise * noise);
            }
        }
        let ahead_ticks = traits.prediction * f64::from(traits.delay_ticks);
        for motion in motions {
            let speed = self.state.get(motion.speed).copied().unwrap_or(0.0);
            if let Some(place) = self.state.get_mut(motion.place) {
                *place += ahead_ticks * motion.per_tick * speed;
            }
        }
        Seen { state: &self.state, goal: moment.goal.map(f64::from) }
    }
}
