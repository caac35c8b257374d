//! A person, simulated: late, attending to one thing at a time, misjudging speeds, hitting wrong keys, trusting and
//! resenting help.
//!
//! The layer is the same for every plant; what is right to do about what was seen is the plant's [`Skill`]. Keys go
//! through [`Keyboard`](crate::keys::Keyboard), so that requests and presses are made and counted as a person's are.
//!
//! These are models of participants, never participants: nothing here was fitted to a recorded person.
//!
//! A skill for [`Point`](crate::point::Point), whose keys push left, right, down and up:
//!
//! ```
//! use cohelm::arbitration::HumanAlone;
//! use cohelm::cockpit::Cockpit;
//! use cohelm::human::{Axis, HumanPilot, Plan, Population, Seen, Skill};
//! use cohelm::pilot::Pilot;
//! use cohelm::plant::{Ending, Plant};
//! use cohelm::point::Point;
//! use cohelm::random::Draws;
//!
//! struct Push(Plan);
//!
//! impl Skill for Push {
//!     fn plan(&self) -> &Plan {
//!         &self.0
//!     }
//!
//!     fn errors(&self, seen: &Seen<'_>, errors: &mut [f64]) {
//!         for (i, error) in errors.iter_mut().enumerate() {
//!             let wanted_speed = (seen.goal[i] - seen.state[i]).clamp(-0.6, 0.6);
//!             *error = (wanted_speed - seen.state[2 + i]) / 0.05;
//!         }
//!     }
//! }
//!
//! let key = |name, minus| Axis { name, plus: Some(minus + 1), minus: Some(minus), release: 0.3, droppable: true };
//! let axes = vec![key("x", 0), key("y", 2)];
//! let plan = Plan { axes, moving: vec![0, 1, 2, 3], judged: vec![2, 3], shown: vec![] };
//!
//! let mut point = Point::new();
//! let traits = Population::Ordinary.ranges().draw(&mut Draws::new(1));
//! let mut pilot = HumanPilot::new(traits, Box::new(Push(plan)), point.space())?;
//! let mut cockpit = Cockpit::unassisted(&point, Box::new(HumanAlone));
//! point.reset(7);
//! pilot.begin(7);
//! let ending = std::iter::repeat_with(|| cockpit.tick(&mut point, &mut pilot).step.ending).flatten().next();
//! assert_eq!(ending, Some(Ending::Goal));
//! assert!(pilot.key_presses() > 1);
//! # Ok::<(), cohelm::human::HumanError>(())
//! ```

mod fingers;
mod mood;
mod participant;
mod perception;
mod population;
mod skill;
mod traits;

pub use mood::{CALM_DEAD_BANDS, Mood, REPRESS_FRUSTRATION};
pub use participant::{MakeSkill, ParticipantError, Person, participant};
pub use population::{Population, UnknownPopulation};
pub use skill::{Axis, Plan, Seen, Skill};
pub use traits::{NOISE_MEMORY, Ranges, SHORTEST_DWELL_TICKS, TraitError, Traits};

use crate::action::{Action, ActionSpace};
use crate::keys::controls;
use crate::pilot::Pilot;
use crate::plant::View;
use crate::random::Draws;
use fingers::{Fingers, conflict};
use perception::{Eye, Memory};

/// Sets the stream of a pilot apart from others that are seeded with the same number.
const STREAM: u64 = 0x0068_756d_616e;

/// A simulated person with a skill.
pub struct HumanPilot {
    traits: Traits,
    skill: Box<dyn Skill>,
    draws: Draws,
    memory: Memory,
    eye: Eye,
    errors: Vec<f64>,
    mood: Mood,
    attention: Attention,
    fingers: Fingers,
    press_again: Option<u8>,
}

/// Which axis is attended to, and for how long yet.
#[derive(Clone, Copy, Debug, Default)]
struct Attention {
    axis: usize,
    left_ticks: f64,
}

/// Why there is no such pilot.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HumanError {
    /// A trait is out of its range.
    #[error(transparent)]
    Trait(#[from] TraitError),
    /// The skill has nothing to attend to.
    #[error("the skill names no axis; a pilot needs at least one thing to attend to")]
    NoAxes,
    /// The skill is not for this set of actions.
    #[error(
        "the skill uses control {control}, but this set of actions has {controls}; see cohelm::keys::controls"
    )]
    NoSuchControl {
        /// The control.
        control: u8,
        /// How many there are.
        controls: usize,
    },
}

impl HumanPilot {
    /// A person with these traits and this skill, at the keys of a plant with these actions.
    pub fn new(traits: Traits, skill: Box<dyn Skill>, space: &ActionSpace) -> Result<Self, HumanError> {
        traits.check()?;
        let (plan, controls) = (skill.plan(), controls(space).len());
        if let Some(control) = plan.missing_control(controls) {
            return Err(HumanError::NoSuchControl { control, controls });
        }
        if plan.axes.is_empty() {
            return Err(HumanError::NoAxes);
        }
        let mut pilot = Self {
            traits,
            draws: Draws::new(0),
            memory: Memory::new(traits.delay_ticks),
            eye: Eye::default(),
            errors: vec![0.0; plan.axes.len()],
            mood: Mood::default(),
            attention: Attention::default(),
            fingers: Fingers::new(space),
            press_again: None,
            skill,
        };
        pilot.begin(0);
        Ok(pilot)
    }

    /// Who this is.
    pub fn traits(&self) -> &Traits {
        &self.traits
    }

    /// How it feels now.
    pub fn mood(&self) -> Mood {
        self.mood
    }

    /// Index, in the skill's plan, of the axis that it attends to now.
    pub fn attended(&self) -> usize {
        self.attention.axis
    }

    /// Judges what was there a reaction delay ago; false while nothing has been seen yet.
    fn see(&mut self) -> bool {
        let Some(past) = self.memory.recall() else { return false };
        let plan = self.skill.plan();
        self.skill.errors(&self.eye.look(&past, plan, &self.traits), &mut self.errors);
        self.fingers.watch(past.moment, plan);
        let conflict = conflict(past.moment, plan);
        let dead_band = self.mood.dead_band(&self.traits);
        let calm = (0..self.errors.len()).all(|axis| self.urgency(axis) < CALM_DEAD_BANDS * dead_band);
        self.mood.feel(calm, conflict);
        true
    }

    /// How much an axis asks for attention, in average dead bands.
    fn urgency(&self, axis: usize) -> f64 {
        self.skill.plan().axes[axis].urgency(self.errors[axis], self.held_on(axis))
    }

    fn held_on(&self, axis: usize) -> Option<u8> {
        let axis = &self.skill.plan().axes[axis];
        self.fingers.held().find(|&control| axis.has(control))
    }

    /// Lets attention move on when its time is over.
    fn attend(&mut self) {
        self.attention.left_ticks -= 1.0;
        if self.attention.left_ticks > 0.0 {
            return;
        }
        let left = self.attention.axis;
        let axes = self.errors.len();
        let axis = if self.draws.chance(self.traits.urgency) { self.worst() } else { (left + 1) % axes };
        self.attention = Attention { axis, left_ticks: dwell(&self.traits, &mut self.draws) };
        if axis != left {
            self.turn_away_from(left);
        }
    }

    fn worst(&self) -> usize {
        let worse = |worst, axis| if self.urgency(axis) > self.urgency(worst) { axis } else { worst };
        (1..self.errors.len()).fold(0, worse)
    }

    fn turn_away_from(&mut self, axis: usize) {
        self.press_again = None;
        let droppable = self.skill.plan().axes[axis].droppable;
        if let Some(control) = self.held_on(axis).filter(|_| droppable) {
            if self.draws.chance(self.traits.drop_key) {
                self.fingers.leave(control);
            }
        }
    }

    /// The one thing that the fingers do at this tick, if anything.
    fn act(&mut self) {
        if let Some(control) = self.fingers.due(&self.traits) {
            self.fingers.release(control);
        } else if !self.fingers.busy() {
            match self.held_on(self.attention.axis) {
                Some(control) => self.perhaps_release(control),
                None => self.perhaps_press(),
            }
        }
    }

    fn perhaps_release(&mut self, control: u8) {
        if !self.fingers.may_release(control, &self.traits) {
            return;
        }
        let (axis, error) = self.attended_error();
        let left_over = if axis.plus == Some(control) { error } else { -error };
        if left_over < axis.release {
            self.fingers.release(control);
        } else if self.draws.chance(self.mood.repress(&self.traits)) {
            self.fingers.release(control);
            self.press_again = Some(control);
        }
    }

    fn perhaps_press(&mut self) {
        let (axis, error) = self.attended_error();
        let wanted = axis.control(error).filter(|_| error.abs() > 1.0);
        if let Some(control) = self.press_again.take().or(wanted) {
            self.fingers.press(control, &self.traits, &mut self.draws);
        }
    }

    /// The attended axis and its error in the pilot's own dead bands.
    fn attended_error(&self) -> (&Axis, f64) {
        let axis = self.attention.axis;
        (&self.skill.plan().axes[axis], self.errors[axis] / self.mood.dead_band(&self.traits))
    }
}

/// How long attention stays: half of the mean for certain, the other half exponentially distributed.
fn dwell(traits: &Traits, draws: &mut Draws) -> f64 {
    let exponential = -libm::log(1.0 - draws.unit());
    (traits.dwell_ticks * 0.5 * (1.0 + exponential)).max(SHORTEST_DWELL_TICKS)
}

impl Pilot for HumanPilot {
    fn begin(&mut self, seed: u64) {
        self.draws = Draws::fork(seed, STREAM);
        self.memory.clear();
        self.eye = Eye::new(self.skill.plan().judged.len(), &mut self.draws);
        self.errors.fill(0.0);
        self.mood = Mood::default();
        let axis = self.draws.below(self.errors.len());
        self.attention = Attention { axis, left_ticks: dwell(&self.traits, &mut self.draws) };
        self.fingers.begin();
        self.press_again = None;
    }

    /// The person sees, lets its attention wander and moves a finger; the keys ask.
    fn ask(&mut self, view: &View<'_>, goal: usize) -> Option<Action> {
        self.memory.remember(view, goal, self.fingers.expected());
        self.eye.drift(&mut self.draws);
        if self.see() {
            self.attend();
            self.act();
        }
        self.fingers.ask()
    }

    fn key_presses(&self) -> u32 {
        self.fingers.presses()
    }

    fn keys_down(&self) -> Option<u64> {
        Some(self.fingers.keys_down())
    }
}
