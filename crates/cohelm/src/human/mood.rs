//! How a pilot feels about the help it gets: trust grows while all goes well, frustration where keys do not obey.

use super::traits::Traits;

/// Trust and frustration, both in [0, 1] and 0 when an episode begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mood {
    /// Grows by 0.01 a tick while every axis is within [`CALM_DEAD_BANDS`] and nothing conflicts, otherwise falls by
    /// 0.02: two seconds of a good flight make a pilot trust fully.
    pub trust: f64,
    /// Grows by 0.04 a tick of conflict, otherwise falls by 0.01: half a second of disobedience is the limit.
    pub frustration: f64,
}

/// A flight whose errors are all below this many dead bands looks fine.
pub const CALM_DEAD_BANDS: f64 = 2.0;

/// Above this frustration a pilot hits its key again.
pub const REPRESS_FRUSTRATION: f64 = 0.3;

impl Mood {
    /// One tick of feeling.
    pub(super) fn feel(&mut self, calm: bool, conflict: bool) {
        let trust = if calm && !conflict { 0.01 } else { -0.02 };
        let frustration = if conflict { 0.04 } else { -0.01 };
        self.trust = (self.trust + trust).clamp(0.0, 1.0);
        self.frustration = (self.frustration + frustration).clamp(0.0, 1.0);
    }

    /// The width of the dead bands that a pilot in this mood tolerates, as a factor on an average person's: wider with
    /// trust, narrower with frustration, never below half its own.
    pub fn dead_band(&self, traits: &Traits) -> f64 {
        let widened = 1.0 + 2.0 * traits.trust * self.trust - 0.4 * traits.resist * self.frustration;
        traits.dead_band * widened.max(0.5)
    }

    /// Probability, at a tick, of hitting the held key again.
    pub(super) fn repress(&self, traits: &Traits) -> f64 {
        if self.frustration > REPRESS_FRUSTRATION { 0.1 * traits.resist * self.frustration } else { 0.0 }
    }
}
