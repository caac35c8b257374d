//! A flight that a simulated person flies at the keys: the page's part, without a page.
//!
//! Knows no socket and no clock. The pilot looks at the flight and moves its fingers; what they do goes into the flight
//! as a person's keys do, so that the key log alone gives the flight again.

use crate::follow::End;
use crate::store::Chunk;
use cohelm::flight::Flight;
use cohelm::keys::Change;
use cohelm::pilot::Pilot;
use cohelm::plant::Ending;
use cohelm::trajectory::{Setup, put_event};

/// The pilot presses no keys, so no key log could give its flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this pilot presses no keys, so that it cannot fly as a participant; take a simulated person")]
pub struct NoKeys;

/// A flight and who flies it.
pub struct Aloft {
    flight: Flight,
    pilot: Box<dyn Pilot>,
    /// Controls that are down, one bit each.
    held: u64,
    tick_ms: f64,
}

impl Aloft {
    /// A pilot begins a flight; `pilot_seed` fixes what is random about how it flies this once.
    pub fn new(flight: Flight, mut pilot: Box<dyn Pilot>, pilot_seed: u64) -> Result<Self, NoKeys> {
        pilot.begin(pilot_seed);
        pilot.keys_down().ok_or(NoKeys)?;
        let tick_ms = tick_s(flight.setup(), flight.plant().ticks_per_second()) * 1e3;
        Ok(Self { flight, pilot, held: 0, tick_ms })
    }

    /// Flies one tick; false if the episode had ended before.
    pub fn tick(&mut self) -> bool {
        if self.flight.ending().is_some() {
            return false;
        }
        let plant = self.flight.plant();
        self.pilot.ask(&plant.view(), plant.pilot_goal());
        let down = self.pilot.keys_down().unwrap_or(self.held);
        let at_ms = (f64::from(self.flight.ticks()) * self.tick_ms) as f32;
        for control in controls_of(down ^ self.held) {
            let pressed = down >> control & 1 == 1;
            let change = if pressed { Change::Down(control) } else { Change::Up(control) };
            self.flight.change(change, at_ms);
        }
        self.held = down;
        self.flight.tick().is_some()
    }

    /// Flies at most so many ticks; fewer if the episode ends.
    pub fn fly(&mut self, ticks: u32) {
        for _ in 0..ticks {
            if !self.tick() {
                break;
            }
        }
    }

    /// Seconds that a tick takes at the pace of its setup.
    pub fn tick_s(&self) -> f64 {
        self.tick_ms / 1e3
    }

    /// Ticks flown.
    pub fn ticks(&self) -> u32 {
        self.flight.ticks()
    }

    /// How the episode ended, if it did.
    pub fn ending(&self) -> Option<Ending> {
        self.flight.ending()
    }

    /// The piece of the key log from a tick on, up to the last tick flown.
    pub fn since(&self, from_tick: u32) -> Chunk {
        let mut events = Vec::new();
        let since = self.flight.keys().iter().filter(|event| event.tick >= from_tick);
        since.for_each(|event| put_event(&mut events, event));
        Chunk { from_tick, to_tick: self.flight.ticks(), digests: self.flight.digests(), events }
    }

    /// What the page would say of the end now: abandoned, if the episode has not ended.
    pub fn end(&self) -> End {
        let ending = self.flight.ending().unwrap_or(Ending::Abandoned);
        End { ticks: self.flight.ticks(), ending, digests: self.flight.digests() }
    }

    /// Keys that were pressed.
    pub fn presses(&self) -> u32 {
        self.pilot.key_presses()
    }

    /// What fixes the flight.
    pub fn setup(&self) -> &Setup {
        self.flight.setup()
    }
}

/// Seconds that a tick takes.
fn tick_s(setup: &Setup, ticks_per_second: f64) -> f64 {
    1.0 / (ticks_per_second * setup.time_scale)
}

fn controls_of(bits: u64) -> impl Iterator<Item = u8> {
    (0..u64::BITS as u8).filter(move |control| bits >> control & 1 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::Follower;
    use crate::testing::{flight, setup};
    use crate::visit::testing::person;

    #[test]
    fn the_key_log_of_a_simulated_person_gives_its_flight_again() {
        let mut aloft = Aloft::new(flight(setup(6)), person(1), 3).unwrap();
        let mut follower = Follower::new(flight(setup(6)));
        let mut sent = 0;
        while aloft.ending().is_none() {
            aloft.fly(50);
            follower.follow(&aloft.since(sent)).unwrap();
            sent = aloft.ticks();
        }
        let flown = follower.land(aloft.end()).unwrap();
        assert!(!flown.keys.is_empty(), "it pressed no key");
        assert_eq!(flown.ending, aloft.ending().unwrap());
    }

    #[test]
    fn the_same_pilot_seed_presses_the_same_keys_and_another_does_not() {
        let keys = |seed| {
            let mut aloft = Aloft::new(flight(setup(6)), person(1), seed).unwrap();
            aloft.fly(10_000);
            aloft.since(0).events
        };
        assert_eq!(keys(3), keys(3));
        assert_ne!(keys(3), keys(4));
    }
}
