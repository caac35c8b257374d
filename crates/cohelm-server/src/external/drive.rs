//! The loop of an episode elsewhere: each tick when it is due, on a thread of its own, and the dead man.

use super::words::{Ended, Flown};
use cohelm::action::ActionSpace;
use cohelm::flight::Flight;
use cohelm::keys::Change;
use cohelm::plant::Ending;
use cohelm::report::TickReport;
use cohelm::trajectory::{MAX_TICKS, Trajectory};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// After how long without a word from the page everything is let go of: shorter flickers with the network, longer leaves
/// a machine moving with nobody at it. The page says ten times a second that it is there.
const LET_GO_AFTER: Duration = Duration::from_millis(300);
/// After how long without a word the episode ends.
const END_AFTER: Duration = Duration::from_secs(2);
/// Ticks that are flown with everything let go of before an episode ends that lost its person: enough for each of eight
/// switches to be turned off.
const NEUTRAL_TICKS: u32 = 10;

/// Whether somebody is at the page.
#[derive(Clone)]
pub struct Presence(Arc<Mutex<Present>>);

struct Present {
    heard: Instant,
    /// Why it is over, and whether that was the person's wish.
    over: Option<(String, bool)>,
}

impl Presence {
    /// Somebody is there now.
    pub fn new() -> Self {
        Self(Arc::new(Mutex::new(Present { heard: Instant::now(), over: None })))
    }

    /// A word was heard.
    pub fn here(&self) {
        self.lock().heard = Instant::now();
    }

    /// The person ends the episode.
    pub fn stop(&self) {
        self.over("the person ended it", true);
    }

    /// The person was lost for good.
    pub fn lose(&self, why: &str) {
        self.over(why, false);
    }

    fn over(&self, why: &str, wished: bool) {
        self.lock().over.get_or_insert_with(|| (why.to_owned(), wished));
    }

    /// How long nothing was heard.
    fn silence(&self) -> Duration {
        self.lock().heard.elapsed()
    }

    fn is_over(&self) -> Option<(String, bool)> {
        self.lock().over.clone()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Present> {
        // A panic elsewhere leaves a time a time.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

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
        let mut hand = Hand { presence, let_go_at: None };
        let (mut commands, mut corrected) = (0, 0);
        hand.presence.here();
        let why = loop {
            beat.wait();
            if let Some(why) = hand.watch(&mut flight, begun) {
                break why;
            }
            changes.try_iter().for_each(|(change, at_ms)| hand.pass_on(&mut flight, change, at_ms));
            if flight.ticks() as usize >= MAX_TICKS {
                break Some(format!("a record holds {MAX_TICKS} ticks"));
            }
            let rule = flight.setup().rule;
            let Some(tick) = flight.tick() else { break None };
            commands += u32::from(tick.asked.is_some());
            corrected += u32::from(tick.intervention.is_some_and(|seen| seen.effective));
            let report = TickReport::of(&tick, &space, &rule, median_range).placed(flight.plant());
            let over = report.ending.is_some();
            frames.send_replace(Some(Flown { report, late: beat.late }));
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

/// The person's hand, which lets go when nobody is there.
struct Hand {
    presence: Presence,
    /// The tick at which everything was let go of, while it is.
    let_go_at: Option<u32>,
}

impl Hand {
    /// What is still on its way when the flight is over counts for nothing. Whoever comes back counts from then on; what
    /// was held before must be pressed anew.
    fn pass_on(&mut self, flight: &mut Flight, change: Change, at_ms: f32) {
        if self.let_go_at.is_none() {
            flight.change(change, at_ms);
        }
    }

    /// Lets go if nobody is there. Some reason to end, or some end without one, once that has lasted.
    fn watch(&mut self, flight: &mut Flight, begun: Instant) -> Option<Option<String>> {
        let silence = self.presence.silence();
        let over = self.presence.is_over().or_else(|| {
            let words = format!("nothing was heard from the page for {} s", END_AFTER.as_secs());
            (silence > END_AFTER).then_some((words, false))
        });
        if silence <= LET_GO_AFTER && over.is_none() {
            self.let_go_at = None;
            return None;
        }
        let since = *self.let_go_at.get_or_insert_with(|| {
            flight.change(Change::ReleaseAll, begun.elapsed().as_secs_f32() * 1000.0);
            flight.ticks()
        });
        let (why, wished) = over?;
        (flight.ticks() - since >= NEUTRAL_TICKS).then_some((!wished).then_some(why))
    }
}
