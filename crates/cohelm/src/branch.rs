//! What if: a recorded episode, flown on from one of its ticks under another cockpit or by another pilot.
//!
//! Up to the tick the record is flown again exactly, by its own cockpit; the other one only looks on, so that it has
//! seen what it would have seen. From there the other one decides. With the recorded requests this is an open loop:
//! the person answered another flight than the one that is shown, and would have seen the difference within a reaction
//! time. The first moments say what another rule would have done; what comes a second later says little.
//!
//! ```
//! use cohelm::arbitration::{HumanAlone, RobotAlone};
//! use cohelm::branch::Branch;
//! use cohelm::cockpit::Cockpit;
//! use cohelm::flight::Flight;
//! # use cohelm::{cockpit::Silence, arbitration::Rule, intent::{Inference, KnownGoal}, keys::Change};
//! # use cohelm::{plant::{Ending, Plant}, point::{self, Point}, registry::Task, trajectory::Setup};
//! # let setup = Setup {
//! #     task: Task::new("point"), plant_version: 1, seed: 5, rule: Rule::Hic, inference: Inference::Nearest,
//! #     silence: Silence::Best, time_scale: 1.0, values: None, intent: None, pilot: "person".into(),
//! # };
//! # let own = || Cockpit::unassisted(&Point::new(), Box::new(HumanAlone));
//! let mut flight = Flight::new(setup, Box::new(Point::new()), own());
//! flight.change(Change::Down(0), 0.0); // against the left edge
//! while flight.tick().is_some() {}
//! let record = flight.finish();
//! assert_eq!(record.ending, Ending::OutOfBounds);
//!
//! # let mut wanted = Point::new();
//! # wanted.reset(5);
//! # let goal = Box::new(KnownGoal(wanted.pilot_goal()));
//! # let values = point::entry().values.unwrap();
//! let robot = Cockpit::new(goal, values(), Box::new(RobotAlone));
//! let mut branch = Branch::new(&record, 30, Box::new(Point::new()), &mut own(), robot)?;
//! while branch.tick().is_some() {}
//! assert_eq!(branch.ending(), Some(Ending::Goal));
//! # Ok::<(), cohelm::branch::BranchError>(())
//! ```

use crate::action::{Action, ActionSpace};
use crate::cockpit::{Cockpit, Tick};
use crate::keys::{Change, KeyEvent, Keyboard};
use crate::pilot::{Pilot, Recorded};
use crate::plant::{Ending, Plant, View};
use crate::trajectory::{Digests, Recorder, Trajectory};
use std::collections::VecDeque;

/// Why there is no branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BranchError {
    /// The record is shorter.
    #[error("the record has {ticks} ticks; it cannot be flown on from tick {at}")]
    Beyond {
        /// The tick that was wished for.
        at: u32,
        /// Ticks there are.
        ticks: usize,
    },
    /// The episode had ended by then.
    #[error("the episode had ended ({}) by tick {at}; choose an earlier tick", .ending.word())]
    Over {
        /// The tick that was wished for.
        at: u32,
        /// How it had ended.
        ending: Ending,
    },
    /// The record does not give the same flight here.
    #[error(
        "the record is not flown again exactly: at tick {tick} something else is carried out than it says, so what \
         follows would be the what-if of another flight"
    )]
    Strayed {
        /// Where.
        tick: u32,
    },
}

/// An episode that was recorded up to some tick and is flown on from there.
pub struct Branch {
    plant: Box<dyn Plant>,
    cockpit: Cockpit,
    pilot: Box<dyn Pilot>,
    left: Keyboard,
    recorder: Recorder,
}

impl Branch {
    /// Flies `record` again up to `at` ticks under `own`, the cockpit of its setup, while `other` looks on; then `other`
    /// has the say. The plant is one made from the record's task, whatever its state. The recorded requests go on; after
    /// the last of them nobody asks.
    ///
    /// The actions of the record must be of the plant's space, as for [`replay`](crate::flight::replay).
    pub fn new(
        record: &Trajectory,
        at: u32,
        mut plant: Box<dyn Plant>,
        own: &mut Cockpit,
        mut other: Cockpit,
    ) -> Result<Self, BranchError> {
        if at as usize > record.ticks() {
            return Err(BranchError::Beyond { at, ticks: record.ticks() });
        }
        let (before, after) = record.asked.split_at(at as usize);
        plant.reset(record.setup.seed);
        own.begin();
        other.begin();
        let mut recorder = Recorder::new(plant.as_ref());
        let mut pilot = Recorded::new(before);
        for (&asked, &executed) in before.iter().zip(&record.executed) {
            other.look_on(plant.as_ref(), asked, executed);
            let tick = own.tick(plant.as_mut(), &mut pilot);
            if tick.executed != executed {
                return Err(BranchError::Strayed { tick: tick.tick });
            }
            recorder.note(&tick, plant.as_ref());
        }
        if let Some(ending) = recorder.ending() {
            return Err(BranchError::Over { at, ending });
        }
        let left = let_go(&record.keys, at, plant.space());
        let pilot = Box::new(GoesOn { asked: after.iter().copied().collect() });
        Ok(Self { plant, cockpit: other, pilot, left, recorder })
    }

    /// The same, but from here on another pilot asks, which the caller has begun. What the person holds is let go first,
    /// as keys are that come up; the pilot has seen nothing yet, so that a simulated person needs its reaction time.
    pub fn flown_by(mut self, pilot: Box<dyn Pilot>) -> Self {
        self.pilot = Box::new(TakesOver { left: self.left.clone(), pilot });
        self
    }

    /// Flies one tick; `None` once the episode has ended.
    pub fn tick(&mut self) -> Option<Tick<'_>> {
        if self.recorder.ending().is_some() {
            return None;
        }
        let tick = self.cockpit.tick(self.plant.as_mut(), self.pilot.as_mut());
        self.recorder.note(&tick, self.plant.as_ref());
        Some(tick)
    }

    /// Ticks from the beginning of the episode.
    pub fn ticks(&self) -> u32 {
        self.recorder.ticks() as u32
    }

    /// How it ended, if it did.
    pub fn ending(&self) -> Option<Ending> {
        self.recorder.ending()
    }

    /// Digests of all bits from the beginning of the episode, those before the branch as they were recorded.
    pub fn digests(&self) -> Digests {
        self.recorder.digests()
    }

    /// The plant as it is now.
    pub fn plant(&self) -> &dyn Plant {
        self.plant.as_ref()
    }
}

/// Asks for what was asked then.
struct GoesOn {
    asked: VecDeque<Option<Action>>,
}

impl Pilot for GoesOn {
    fn begin(&mut self, _seed: u64) {}

    fn ask(&mut self, _view: &View<'_>, _goal: usize) -> Option<Action> {
        self.asked.pop_front().flatten()
    }
}

/// The keyboard as the person left it, all keys let go; then another pilot.
struct TakesOver {
    left: Keyboard,
    pilot: Box<dyn Pilot>,
}

impl Pilot for TakesOver {
    fn begin(&mut self, seed: u64) {
        self.pilot.begin(seed);
    }

    fn ask(&mut self, view: &View<'_>, goal: usize) -> Option<Action> {
        let asked = self.pilot.ask(view, goal);
        self.left.next_request().or(asked)
    }

    fn key_presses(&self) -> u32 {
        self.pilot.key_presses()
    }
}

/// The keyboard after so many ticks, and everything let go.
fn let_go(keys: &[KeyEvent], ticks: u32, space: &ActionSpace) -> Keyboard {
    let mut keyboard = Keyboard::new(space);
    let mut events = keys.iter().peekable();
    for tick in 0..ticks {
        while let Some(event) = events.next_if(|event| event.tick <= tick) {
            keyboard.change(event.change);
        }
        keyboard.next_request();
    }
    keyboard.change(Change::ReleaseAll);
    keyboard
}
