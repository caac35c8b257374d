//! The plant at the other end.

use crate::address::Address;
use crate::line::{Line, LineError};
use crate::words::{self, Begin, Hello, MAX_LINE, MAX_OPENING, Moved, PROTOCOL, Ready, WordsError};
use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Ending, Plant, Step, View};
use cohelm::scene::{Pose, Scene};
use cohelm::tape::{self, Described, Seen, Tape, TapeError, Taped};
use std::io;
use std::str::FromStr;
use std::time::Duration;

/// How long a plant may take to say who it is, and to get ready for an episode.
const READY_WITHIN: Duration = Duration::from_secs(5);

/// How long a tick waits for its answer before the plant is taken for lost: shorter stops sooner, longer forgives a busy
/// machine. 20 ms to 5 s, usually 250 ms; fewer than two ticks leave no room for one that comes late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeOut(Duration);

impl TimeOut {
    /// Of so many milliseconds; `None` outside 20 to 5000.
    pub fn of_ms(ms: u64) -> Option<Self> {
        (20..=5000).contains(&ms).then(|| Self(Duration::from_millis(ms)))
    }

    /// As a duration.
    pub fn duration(self) -> Duration {
        self.0
    }

    /// How long the plant may hear nothing between two ticks: the time-out begins when the next tick is due, and that is
    /// one period after the last. Without the period a plant of two ticks a second would stop between any two of them.
    fn between_ticks_ms(self, ticks_per_second: f64) -> u64 {
        self.0.as_millis() as u64 + (1000.0 / ticks_per_second).ceil() as u64
    }
}

impl Default for TimeOut {
    fn default() -> Self {
        Self(Duration::from_millis(250))
    }
}

impl FromStr for TimeOut {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ms = text.parse().ok().and_then(Self::of_ms);
        ms.ok_or_else(|| format!("expected a time-out of 20 to 5000 ms, got {text:?}"))
    }
}

/// Why an episode with a plant elsewhere cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum ExternalError {
    /// Nobody is there.
    #[error("the plant at {address} cannot be reached: {reason}; start it first")]
    Unreachable {
        /// Where.
        address: Address,
        /// What the system says.
        reason: io::Error,
    },
    /// It says nothing, or not in time.
    #[error("the plant at {address} does not get ready: {reason}")]
    Unready {
        /// Where.
        address: Address,
        /// What happened.
        reason: LineError,
    },
    /// It says in its own words why it does not begin.
    #[error("the plant says: {words}")]
    Told {
        /// Where.
        address: Address,
        /// Its words.
        words: String,
    },
    /// What it says is not the protocol.
    #[error("the plant at {address} does not speak the protocol: {reason}")]
    Garbled {
        /// Where.
        address: Address,
        /// What is wrong.
        reason: String,
    },
    /// It speaks another version.
    #[error("the plant at {address} speaks version {found} of the protocol, here it is {PROTOCOL}")]
    Version {
        /// Where.
        address: Address,
        /// Its version.
        found: u32,
    },
    /// What it says of itself cannot be flown.
    #[error("the plant at {address} cannot be flown: {reason}")]
    Unsound {
        /// Where.
        address: Address,
        /// Why.
        reason: TapeError,
    },
}

/// A plant elsewhere, for one episode: it lives from its beginning to its end.
pub struct External {
    seen: Taped,
    /// `None` once the other end is lost or was told the end.
    line: Option<Line>,
    time_out: Duration,
}

impl External {
    /// Connects and begins the episode of a seed. The first tick may come whenever it likes; from then on the plant
    /// counts on one every tick.
    pub fn begin(address: &Address, seed: u64, time_out: TimeOut) -> Result<Self, ExternalError> {
        let at = || address.clone();
        let unready = |reason| ExternalError::Unready { address: at(), reason };
        let unread = |error| match error {
            WordsError::Told(words) => ExternalError::Told { address: at(), words },
            WordsError::Garbled(reason) => ExternalError::Garbled { address: at(), reason },
        };
        let mut line = Line::connect(address, READY_WITHIN)
            .map_err(|reason| ExternalError::Unreachable { address: at(), reason })?;
        let hello: Hello =
            words::read(&line.hear(MAX_LINE, READY_WITHIN).map_err(unready)?).map_err(unread)?;
        if hello.cohelm != PROTOCOL {
            return Err(ExternalError::Version { address: at(), found: hello.cohelm });
        }
        tape::check_rate(hello.ticks_per_second)
            .map_err(|reason| ExternalError::Unsound { address: at(), reason })?;
        let begin = Begin { seed, time_out_ms: time_out.between_ticks_ms(hello.ticks_per_second) };
        line.say(&words::begin(begin), READY_WITHIN).map_err(unready)?;
        let ready: Ready =
            words::read(&line.hear(MAX_OPENING, READY_WITHIN).map_err(unready)?).map_err(unread)?;
        let (scene, pilot_goal, first) = ready.seen();
        let Hello { name, ticks_per_second, space, .. } = hello;
        let about = Described { name, ticks_per_second, space, scene, pilot_goal };
        let tape =
            Tape::new(about, first).map_err(|reason| ExternalError::Unsound { address: at(), reason })?;
        Ok(Self { seen: Taped::new(tape), line: Some(line), time_out: time_out.0 })
    }

    /// Its own name.
    pub fn name(&self) -> &str {
        &self.seen.tape().about().name
    }

    /// Tells the plant that the episode is over, if it is still there.
    pub fn end(&mut self, ending: Ending) {
        if let Some(mut line) = self.line.take() {
            // Whoever does not hear it hears the connection end.
            let _ = line.say(&words::end(ending), self.time_out);
            line.close();
        }
    }

    fn exchange(&mut self, action: Option<Action>) -> Result<Seen, String> {
        let line = self.line.as_mut().ok_or("the episode was over")?;
        let View { tick, goals, .. } = self.seen.view();
        let axes = if let ActionSpace::Axes { names, .. } = self.seen.space() { names.len() } else { 0 };
        line.say(&words::tick(tick, action, axes), self.time_out).map_err(|error| error.to_string())?;
        let answer = line.hear(MAX_LINE, self.time_out).map_err(|error| error.to_string())?;
        let moved: Moved = words::read(&answer).map_err(|error| error.to_string())?;
        if moved.tick != tick {
            return Err(format!("it answers tick {}, but tick {tick} was asked", moved.tick));
        }
        Ok(moved.seen(goals))
    }
}

impl Plant for External {
    /// Does nothing: the episode was begun when the plant was connected.
    fn reset(&mut self, _seed: u64) {}

    fn step(&mut self, executed: Option<Action>) -> Step {
        let action = within_limits(self.seen.space(), executed);
        let answer = self.exchange(action);
        let step = self.seen.grow(answer);
        if let Some(ending) = step.ending {
            self.end(ending);
        }
        step
    }

    fn view(&self) -> View<'_> {
        self.seen.view()
    }

    fn pilot_goal(&self) -> usize {
        self.seen.pilot_goal()
    }

    fn space(&self) -> &ActionSpace {
        self.seen.space()
    }

    fn ticks_per_second(&self) -> f64 {
        self.seen.ticks_per_second()
    }

    fn scene(&self) -> Scene {
        self.seen.scene()
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        self.seen.poses(poses);
    }

    fn tape(&self) -> Option<&Tape> {
        Some(self.seen.tape())
    }
}

impl Drop for External {
    fn drop(&mut self) {
        self.end(Ending::Abandoned);
    }
}

/// What may leave for the plant: axes are held within their ends, and what is not of its space is nothing. Arbitration
/// gives no other action; this does not rely on it.
fn within_limits(space: &ActionSpace, action: Option<Action>) -> Option<Action> {
    let action = match (space, action?) {
        (ActionSpace::Axes { low, high, .. }, Action::Axes(values)) => {
            let ends = low.iter().zip(high);
            let held: Vec<f32> =
                ends.zip(values).map(|((&low, &high), value)| value.clamp(low, high)).collect();
            Action::axes(&held)
        }
        (_, other) => other,
    };
    space.contains(action).then_some(action)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plant_waits_a_period_and_the_time_out_for_its_next_tick() {
        let time_out = TimeOut::default();
        let waits = [200.0, 50.0, 3.0, 2.0, 1.0].map(|rate| time_out.between_ticks_ms(rate));
        assert_eq!(waits, [255, 270, 584, 750, 1250]);
    }

    #[test]
    fn no_action_leaves_that_the_plant_does_not_take() {
        let axes = ActionSpace::Axes { names: vec!["x".into()], low: vec![-1.0], high: vec![0.5] };
        let sent = |values: &[f32]| within_limits(&axes, Some(Action::axes(values)));
        assert_eq!(sent(&[0.25]), Some(Action::axes(&[0.25])));
        assert_eq!(sent(&[3.0]), Some(Action::axes(&[0.5])));
        assert_eq!(sent(&[-9.0, 7.0]), Some(Action::axes(&[-1.0])));
        assert_eq!(sent(&[f32::NAN]), None);
        assert_eq!(within_limits(&axes, Some(Action::Command(0))), None);
        let single = ActionSpace::Single { names: vec!["wait".into(), "go".into()], pushes: vec![None; 2] };
        assert_eq!(within_limits(&single, Some(Action::Command(1))), Some(Action::Command(1)));
        assert_eq!(within_limits(&single, Some(Action::Command(2))), None);
    }
}
