//! The loop of an episode elsewhere: each tick when it is due, on a thread of its own, and the dead man.

use super::presence::{END_AFTER, LET_GO_AFTER, Presence};
use super::words::{Ended, Flown};
use cohelm::action::ActionSpace;
use cohelm::flight::Flight;
use cohelm::keys::Change;
use cohelm::plant::Ending;
use cohelm::report::TickReport;
use cohelm::tape::{MAX_TAPE, Tape};
use cohelm::trajectory::{MAX_EVENTS, MAX_TICKS, Trajectory};
use std::sync::mpsc::Receiver;
use std::thread::sleep;
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Before an episode ends that lost its person nothing must have been asked for so long, s: ten ticks at fifty a second,
/// and at least one.
const NEUTRAL_S: f64 = 0.2;
/// For how long at most that is waited for, s: whoever tapped switches faster than the plant takes commands has left some
/// to be carried out.
const NEUTRAL_AT_MOST_S: f64 = 2.0;
/// How many ticks that is at least: enough for each of eight switches to be turned on and off.
const NEUTRAL_AT_MOST: u32 = 16;
/// Ticks and changes for which a record must still have room, or the episode ends: more than letting go takes.
const ROOM: usize = 1000;

/// When ticks are due. One that comes late moves all that follow: a machine is not rushed.
struct Beat {
    due: Instant,
    period: Duration,
    late: u32,
}

impl Beat {
    fn new(ticks_per_second: f64) -> Self {
        Self { due: Instant::now(), period: Duration::from_secs_f64(1.0 / ticks_per_second), late: 0 }
    }

    fn wait(&mut self) {
        let now = Instant::now();
        if now > self.due + self.period {
            self.late += 1;
            self.due = now;
        }
        sleep(self.due.saturating_duration_since(now));
        self.due += self.period;
    }
}

/// An episode in the air.
pub struct Drive {
    /// The flight.
    pub flight: Flight,
    /// What the person does.
    pub changes: Receiver<(Change, f32)>,
    /// Whether there is one.
    pub presence: Presence,
    /// Median range of the values, if models have one: for the threshold that is shown.
    pub median_range: Option<f64>,
}

impl Drive {
    /// Flies to the end. Blocks; belongs on a thread of its own.
    pub fn fly(self, frames: &watch::Sender<Option<Flown>>) -> (Trajectory, Ended) {
        let Self { mut flight, changes, presence, median_range } = self;
        let space: ActionSpace = flight.plant().space().clone();
        let begun = Instant::now();
        let mut beat = Beat::new(flight.plant().ticks_per_second());
        let mut hand = Hand::new(presence, flight.plant().ticks_per_second());
        let (mut commands, mut corrected) = (0, 0);
        hand.presence.begin();
        let why = loop {
            beat.wait();
            if let Some(why) = full(&flight) {
                hand.presence.lose(&why);
            }
            if let Some(why) = hand.watch(&mut flight, begun) {
                break why;
            }
            changes.try_iter().for_each(|(change, at_ms)| hand.pass_on(&mut flight, change, at_ms));
            let rule = flight.setup().rule;
            let Some(tick) = flight.tick() else { break None };
            hand.note(tick.asked.is_some());
            commands += u32::from(tick.asked.is_some());
            corrected += u32::from(tick.intervention.is_some_and(|seen| seen.effective));
            let report = TickReport::of(&tick, &space, &rule, median_range).placed(flight.plant());
            let over = report.ending.is_some();
            frames.send_replace(Some(Flown { report, late: beat.late, let_go: hand.must_press_again() }));
            if over {
                break None;
            }
        };
        // The flight's end tells the plant's, and lets go of it.
        let flown = flight.finish();
        let lost =
            flown.tape.as_ref().and_then(|tape| tape.lost()).map(|why| format!("the plant was lost: {why}"));
        let (ticks, ending, late) = (flown.ticks() as u32, flown.ending, beat.late);
        let why = lost.or(why).filter(|_| ending == Ending::Abandoned);
        (flown, Ended { ending, why, ticks, commands, corrected, late, episode: None })
    }
}

/// Why a record takes no more, while it still has room for letting go.
fn full(flight: &Flight) -> Option<String> {
    let room = flight.plant().tape().map_or(usize::MAX, Tape::room);
    full_with(flight.ticks() as usize, flight.keys().len(), room)
}

fn full_with(ticks: usize, events: usize, room: usize) -> Option<String> {
    if ticks + ROOM > MAX_TICKS {
        Some(format!("the record is full: it holds {MAX_TICKS} ticks"))
    } else if events + ROOM > MAX_EVENTS {
        Some(format!("the record is full: it holds {MAX_EVENTS} changes of keys and sticks"))
    } else {
        let megabytes = MAX_TAPE / (1024 * 1024);
        (room < ROOM).then(|| format!("the record is full: it holds {megabytes} MiB of states"))
    }
}

/// The person's hand, which lets go when nobody is there.
struct Hand {
    presence: Presence,
    /// While everything is let go of.
    let_go: Option<LetGo>,
    /// Ticks at which nothing is asked before an episode ends that lost its person.
    neutral: u32,
    /// Ticks after which it ends even if something was.
    at_most: u32,
}

#[derive(Clone, Copy)]
struct LetGo {
    /// The first tick of it.
    since: u32,
    /// Ticks in a row, up to now, at which nothing was asked.
    quiet: u32,
}

impl Hand {
    fn new(presence: Presence, ticks_per_second: f64) -> Self {
        let ticks = |seconds: f64| (seconds * ticks_per_second).ceil() as u32;
        let (neutral, at_most) = (ticks(NEUTRAL_S).max(1), ticks(NEUTRAL_AT_MOST_S).max(NEUTRAL_AT_MOST));
        Self { presence, let_go: None, neutral, at_most }
    }

    /// What is still on its way when the flight is over counts for nothing. Whoever comes back counts from then on; what
    /// was held before must be pressed anew.
    fn pass_on(&mut self, flight: &mut Flight, change: Change, at_ms: f32) {
        if self.let_go.is_none() {
            flight.change(change, at_ms);
        }
    }

    /// Lets go if nobody is there. Some reason to end, or some end without one, once that has lasted.
    fn watch(&mut self, flight: &mut Flight, begun: Instant) -> Option<Option<String>> {
        let (silence, words) = self.presence.silence();
        let over = self.presence.is_over().or_else(|| {
            let words = format!("{words} {} s", END_AFTER.as_secs());
            (silence > END_AFTER).then_some((words, false))
        });
        if silence <= LET_GO_AFTER && over.is_none() {
            // Who comes back must have seen that everything was let go of.
            self.let_go = self.let_go.filter(|let_go| !self.presence.has_shown(let_go.since));
            return None;
        }
        let let_go = *self.let_go.get_or_insert_with(|| {
            flight.change(Change::ReleaseAll, begun.elapsed().as_secs_f32() * 1000.0);
            LetGo { since: flight.ticks(), quiet: 0 }
        });
        let (why, wished) = over?;
        let enough = let_go.quiet >= self.neutral || flight.ticks() - let_go.since >= self.at_most;
        enough.then_some((!wished).then_some(why))
    }

    /// A tick was flown.
    fn note(&mut self, asked: bool) {
        if let Some(let_go) = &mut self.let_go {
            let_go.quiet = if asked { 0 } else { let_go.quiet + 1 };
        }
    }

    /// True if the person, who may come back, must press again what was held.
    fn must_press_again(&self) -> bool {
        self.let_go.is_some() && self.presence.is_over().is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{flight, setup};
    use cohelm::arbitration::Rule;
    use cohelm::cockpit::Silence;
    use std::sync::mpsc::{self, Sender};

    /// A person who is there and alone with the point.
    fn drive() -> (Sender<(Change, f32)>, Presence, Drive) {
        let (hands, changes) = mpsc::channel();
        let presence = Presence::new();
        let flight =
            flight(cohelm::trajectory::Setup { rule: Rule::Hic, silence: Silence::Nothing, ..setup(1) });
        (hands, presence.clone(), Drive { flight, changes, presence, median_range: None })
    }

    fn fly(drive: Drive) -> (Trajectory, Ended) {
        drive.fly(&watch::channel(None).0)
    }

    #[test]
    fn a_key_log_that_fills_up_ends_the_flight_with_everything_let_go_of() {
        let (hands, _presence, drive) = drive();
        (0..=MAX_EVENTS)
            .for_each(|i| hands.send((Change::Stick([20_000 + (i % 2) as i16, 0, 0, 0]), 0.0)).unwrap());
        let (flown, ended) = fly(drive);
        assert_eq!(ended.why.unwrap(), "the record is full: it holds 200000 changes of keys and sticks");
        assert_eq!(flown.keys.last().unwrap().change, Change::ReleaseAll);
        assert!(flown.asked[0].is_some());
        assert_eq!(flown.executed[flown.ticks() - 10..], [None; 10]);
    }

    #[test]
    fn a_record_is_full_while_it_still_has_room_for_letting_go() {
        assert_eq!(full_with(10_000, 10_000, 10_000), None);
        for (ticks, events, room, words) in [
            (MAX_TICKS - 100, 0, usize::MAX, "200000 ticks"),
            (0, MAX_EVENTS - 100, usize::MAX, "200000 changes"),
            (0, 0, 100, "32 MiB of states"),
        ] {
            let why = full_with(ticks, events, room).unwrap();
            assert!(why.starts_with("the record is full: it holds ") && why.contains(words), "{why}");
        }
        let (_, _, drive) = drive();
        let (_, at_most) = (drive.flight.ticks(), Hand::new(Presence::new(), 200.0).at_most);
        assert!((at_most as usize) < ROOM, "at the highest rate there is");
    }

    #[test]
    fn before_the_end_of_a_slow_plant_one_tick_asks_for_nothing() {
        let ticks = |rate: f64| {
            let hand = Hand::new(Presence::new(), rate);
            (hand.neutral, hand.at_most)
        };
        assert_eq!([1.0, 50.0, 200.0].map(ticks), [(1, 16), (10, 100), (40, 400)]);
    }
}
