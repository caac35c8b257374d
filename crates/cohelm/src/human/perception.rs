//! What a pilot sees: the world of a reaction delay ago, its speeds misjudged, carried forward to now as well as the
//! pilot can.

use super::skill::{Plan, Seen};
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

/// The last ticks, up to the reaction delay and one more.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    moments: VecDeque<Moment>,
    delay_ticks: usize,
}

/// What is remembered of a reaction delay ago.
pub(super) struct Recollection<'a> {
    pub(super) moment: &'a Moment,
    /// The tick before, if there was one.
    before: Option<&'a Moment>,
}

impl Memory {
    pub(super) fn new(delay_ticks: u32) -> Self {
        let delay_ticks = delay_ticks as usize;
        Self { moments: VecDeque::with_capacity(delay_ticks + 2), delay_ticks }
    }

    pub(super) fn clear(&mut self) {
        self.moments.clear();
    }

    /// Takes in what is there now, in the place of what is too old to matter.
    pub(super) fn remember(&mut self, view: &View<'_>, goal: usize, expected: u64) {
        let full = self.moments.len() > self.delay_ticks + 1;
        let mut moment = if full { self.moments.pop_front() } else { None }.unwrap_or_default();
        moment.state.clear();
        moment.state.extend_from_slice(view.state);
        moment.goal = view.goals.get(goal).map_or(view.position, |goal| goal.position);
        moment.expected = expected;
        self.moments.push_back(moment);
    }

    /// What was there a delay ago; `None` while the episode is younger than that.
    pub(super) fn recall(&self) -> Option<Recollection<'_>> {
        let index = self.moments.len().checked_sub(self.delay_ticks + 1)?;
        let before = index.checked_sub(1).map(|before| &self.moments[before]);
        Some(Recollection { moment: &self.moments[index], before })
    }
}

impl Recollection<'_> {
    /// By how much a component was growing, a tick.
    fn rate(&self, component: usize) -> f64 {
        let at = |moment: &Moment| moment.state.get(component).map_or(0.0, |&value| f64::from(value));
        self.before.map_or(0.0, |before| at(self.moment) - at(before))
    }
}

/// How speeds are misjudged, and what comes of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Eye {
    noise: Vec<f64>,
    state: Vec<f64>,
}

impl Eye {
    /// An eye that misjudges so many speeds, with errors drawn from their long-run distribution.
    pub(super) fn new(judged: usize, draws: &mut Draws) -> Self {
        Self { noise: (0..judged).map(|_| draws.normal()).collect(), state: Vec::new() }
    }

    /// One tick of wandering: the errors stay normal with unit spread.
    pub(super) fn drift(&mut self, draws: &mut Draws) {
        let fresh = libm::sqrt(1.0 - NOISE_MEMORY * NOISE_MEMORY);
        for noise in &mut self.noise {
            *noise = NOISE_MEMORY * *noise + fresh * draws.normal();
        }
    }

    /// Looks at what is remembered: carries it forward in a straight line over the predicted share of the delay, then
    /// judges the speeds.
    pub(super) fn look(&mut self, past: &Recollection<'_>, plan: &Plan, traits: &Traits) -> Seen<'_> {
        self.state.clear();
        self.state.extend(past.moment.state.iter().map(|&component| f64::from(component)));
        let ahead_ticks = traits.prediction * f64::from(traits.delay_ticks);
        for &component in &plan.moving {
            if let Some(value) = self.state.get_mut(component) {
                *value += ahead_ticks * past.rate(component);
            }
        }
        for (&component, noise) in plan.judged.iter().zip(&self.noise) {
            if let Some(speed) = self.state.get_mut(component) {
                *speed *= traits.speed_gain * (1.0 + traits.speed_noise * noise);
            }
        }
        Seen { state: &self.state, goal: past.moment.goal.map(f64::from) }
    }
}
