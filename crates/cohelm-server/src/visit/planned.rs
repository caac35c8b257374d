//! A flight flown beforehand, cut as a page would send it.
//!
//! What a simulated person does depends on the flight alone, so it can be flown before the clock starts; what is sent
//! when is then what a page would have sent.

use super::Aloft;
use crate::follow::End;
use crate::protocol::{Begin, FromPage};
use crate::store::{Chunk, FlightKey};
use cohelm::trajectory::Setup;
use std::time::Duration;

/// Ticks of a piece of the log, as the page cuts it.
pub const PIECE_TICKS: u32 = 50;

/// A flight that is flown, in pieces.
pub struct Planned {
    pub(super) key: FlightKey,
    pub(super) setup: Setup,
    pub(super) tick_s: f64,
    pub(super) pieces: Vec<Chunk>,
    pub(super) end: End,
    pub(super) presses: u32,
}

impl Planned {
    /// Flies to the end of the episode, or gives up after so many ticks.
    pub fn fly(aloft: Aloft, key: FlightKey, most_ticks: u32) -> Self {
        Self::cut(aloft, key, most_ticks, PIECE_TICKS)
    }

    /// The same in pieces of another length.
    pub fn cut(mut aloft: Aloft, key: FlightKey, most_ticks: u32, piece_ticks: u32) -> Self {
        let mut pieces = Vec::new();
        while aloft.ending().is_none() && aloft.ticks() < most_ticks {
            let from = aloft.ticks();
            aloft.fly(piece_ticks.min(most_ticks - from));
            pieces.push(aloft.since(from));
        }
        let (setup, tick_s) = (aloft.setup().clone(), aloft.tick_s());
        Self { key, setup, tick_s, pieces, end: aloft.end(), presses: aloft.presses() }
    }

    /// Ticks that it lasts.
    pub fn ticks(&self) -> u32 {
        self.end.ticks
    }

    /// How long after its beginning so many ticks are flown, at the pace of its setup.
    pub(super) fn after(&self, ticks: u32) -> Duration {
        Duration::from_secs_f64(f64::from(ticks) * self.tick_s)
    }

    pub(super) fn begin(&self, age: Duration) -> FromPage {
        let age_ms = u32::try_from(age.as_millis()).unwrap_or(u32::MAX);
        FromPage::Begin(Begin { key: self.key, age_ms, setup: self.setup.clone() })
    }
}
