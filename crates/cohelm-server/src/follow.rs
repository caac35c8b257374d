//! Following a flight: the page's key log is flown again, piece by piece, and must give the same bits.
//!
//! Knows no socket, no clock and no database.

use crate::store::Chunk;
use cohelm::flight::Flight;
use cohelm::keys::KeyEvent;
use cohelm::plant::Ending;
use cohelm::trajectory::{
    Digests, MAX_EVENTS, MAX_TICKS, Trajectory, TrajectoryError, put_event, read_events,
};

/// Most ticks of one piece, a minute at 50 Hz: more would keep a thread from others for too long, fewer would make
/// many pieces of what a page that was away sends late.
pub const MAX_CHUNK_TICKS: u32 = 3_000;

/// Why a piece of a log, or its end, is not believed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Disbelief {
    /// A piece is missing. Everything may still be well: the page sends again from what was acknowledged.
    #[error(
        "the log goes on at tick {from_tick}, but only {flown} ticks were followed; send again from tick {flown}"
    )]
    Gap {
        /// Where the piece begins.
        from_tick: u32,
        /// Ticks followed.
        flown: u32,
    },
    /// A piece is empty, reversed or too long.
    #[error(
        "a piece of the log must hold 1 to {MAX_CHUNK_TICKS} ticks and end by tick {MAX_TICKS}, got {from_tick} to {to_tick}"
    )]
    Span {
        /// Where it begins.
        from_tick: u32,
        /// Where it ends.
        to_tick: u32,
    },
    /// The events cannot be read.
    #[error("the key events cannot be read: {0}")]
    Events(#[from] TrajectoryError),
    /// An event lies outside its piece, or before the one that it follows.
    #[error(
        "a key event of tick {tick} stands in the piece from tick {from_tick} to {to_tick}, or out of order"
    )]
    Misplaced {
        /// Its tick.
        tick: u32,
        /// Where the piece begins.
        from_tick: u32,
        /// Where it ends.
        to_tick: u32,
    },
    /// More events than an episode may have.
    #[error("the log holds more than {MAX_EVENTS} key events")]
    TooManyEvents,
    /// The episode was over before.
    #[error("the episode ended at tick {ended}, but the log goes on to tick {to_tick}")]
    Over {
        /// Where it ended.
        ended: u32,
        /// Where the piece ends.
        to_tick: u32,
    },
    /// The plant went another way.
    #[error("the same keys give another flight here by tick {tick}: states or rewards differ in their bits")]
    Plant {
        /// By when.
        tick: u32,
    },
    /// The co-pilot decided otherwise.
    #[error(
        "the same keys give other decisions here by tick {tick}: beliefs, values or what was carried out differ"
    )]
    Decisions {
        /// By when.
        tick: u32,
    },
    /// The end is said to be elsewhere.
    #[error("the page ends the episode at tick {said}, but its log was followed to tick {flown}")]
    Length {
        /// Ticks the page says.
        said: u32,
        /// Ticks followed.
        flown: u32,
    },
    /// It ended differently.
    #[error("the page says the episode ended with {said:?}, but here it {}", .found.map_or("goes on".into(), |found| format!("ended with {found:?}")))]
    Ending {
        /// What the page says.
        said: Ending,
        /// What following it gave.
        found: Option<Ending>,
    },
}

/// The page's words for the end of an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct End {
    /// Ticks it lasted.
    pub ticks: u32,
    /// How it ended; [`Ending::Abandoned`] if the person stopped it.
    pub ending: Ending,
    /// Digests of all of it.
    pub digests: Digests,
}

/// A flight that follows the page's.
pub struct Follower {
    flight: Flight,
}

impl Follower {
    /// Follows from the beginning of a flight.
    pub fn new(flight: Flight) -> Self {
        Self { flight }
    }

    /// Ticks followed.
    pub fn ticks(&self) -> u32 {
        self.flight.ticks()
    }

    /// Flies the piece and compares. Gives the part of it that was new, to be stored; `None` if nothing was: pieces
    /// may come twice, and may overlap. After an error other than [`Disbelief::Gap`] the follower is of no more use.
    pub fn follow(&mut self, chunk: &Chunk) -> Result<Option<Chunk>, Disbelief> {
        let &Chunk { from_tick, to_tick, digests, .. } = chunk;
        let flown = self.ticks();
        if from_tick > flown {
            return Err(Disbelief::Gap { from_tick, flown });
        }
        if to_tick <= from_tick || to_tick - from_tick > MAX_CHUNK_TICKS || to_tick as usize > MAX_TICKS {
            return Err(Disbelief::Span { from_tick, to_tick });
        }
        if to_tick <= flown {
            return Ok(None);
        }
        let mut events = events_of(chunk)?;
        events.retain(|event| event.tick >= flown);
        self.fly(&events, to_tick)?;
        self.compare(digests)?;
        let mut bytes = Vec::with_capacity(chunk.events.len());
        events.iter().for_each(|event| put_event(&mut bytes, event));
        Ok(Some(Chunk { from_tick: flown, to_tick, digests, events: bytes }))
    }

    /// Compares the end and gives the record.
    pub fn land(self, end: End) -> Result<Trajectory, Disbelief> {
        let (flown, found) = (self.ticks(), self.flight.ending());
        if end.ticks != flown {
            return Err(Disbelief::Length { said: end.ticks, flown });
        }
        if found.unwrap_or(Ending::Abandoned) != end.ending {
            return Err(Disbelief::Ending { said: end.ending, found });
        }
        self.compare(end.digests)?;
        Ok(self.flight.finish())
    }

    /// The record as far as it was followed, abandoned there if the episode had not ended.
    pub fn abandon(self) -> Trajectory {
        self.flight.finish()
    }

    fn fly(&mut self, events: &[KeyEvent], to_tick: u32) -> Result<(), Disbelief> {
        if self.flight.keys().len() + events.len() > MAX_EVENTS {
            return Err(Disbelief::TooManyEvents);
        }
        let mut events = events.iter().peekable();
        while self.ticks() < to_tick {
            let tick = self.ticks();
            while let Some(event) = events.next_if(|event| event.tick == tick) {
                self.flight.change(event.change, event.at_ms);
            }
            if self.flight.tick().is_none() {
                return Err(Disbelief::Over { ended: tick, to_tick });
            }
        }
        Ok(())
    }

    fn compare(&self, digests: Digests) -> Result<(), Disbelief> {
        let (own, tick) = (self.flight.digests(), self.ticks());
        if own.plant != digests.plant {
            return Err(Disbelief::Plant { tick });
        }
        if own.decisions != digests.decisions {
            return Err(Disbelief::Decisions { tick });
        }
        Ok(())
    }
}

/// The events of a piece: readable, in order, and inside it.
fn events_of(chunk: &Chunk) -> Result<Vec<KeyEvent>, Disbelief> {
    let &Chunk { from_tick, to_tick, .. } = chunk;
    let events = read_events(&chunk.events)?;
    let mut earliest = from_tick;
    for event in &events {
        if event.tick < earliest || event.tick >= to_tick {
            return Err(Disbelief::Misplaced { tick: event.tick, from_tick, to_tick });
        }
        earliest = event.tick;
    }
    Ok(events)
}

#[cfg(test)]
mod tests;
