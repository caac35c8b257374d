//! The flag task of the paper: three pairs of flags at random places, one of them the pilot's goal.
//!
//! The craft is Gymnasium's, exactly; what differs is the ground with its pads, the rule of landing (rest on both
//! legs for ten ticks) and the reward (for the pilot's pad). By [`FlagOptions`] there are one to four pads, which may become
//! goals late or cease to be, and the pilot may change its mind. Four [`ActionSet`]s act on the same engines, which may burn
//! together. Landing, crashing and leaving are events; hovering over the pad until the time is up is none of them.
//!
//! Reward of a tick: shaping · (Φ′ − Φ) − 0.003 − 0.002 for each engine turned on or off, and +3 at the goal, −1 for a
//! crash, for leaving and for landing elsewhere; −Φ is distance + speed + tilt − 0.1 for each leg on the ground, in the
//! units of [`state`]. With the default shaping of 0.5 it trains without a teacher.
//!
//! Everything random comes from the seed: scenery and goal, the start, and the scatter of the engines each from a stream
//! of their own. Knows no co-pilot and no time scale.
//!
//! ```
//! use cohelm::{action::Action, plant::Plant};
//! use cohelm_lander::flags::{FlagLander, FlagOptions};
//!
//! let mut lander = FlagLander::new(FlagOptions::default())?;
//! lander.reset(7);
//! let main_on = Action::Command(2);
//! lander.step(Some(main_on));
//! assert_eq!(lander.view().switches, 0b010, "and it stays on until switched off");
//! assert_eq!(lander.view().goals.len(), 3);
//! # Ok::<(), cohelm_lander::flags::OptionsError>(())
//! ```

pub(crate) mod actions;
mod course;
mod judge;
pub(crate) mod layout;
pub(crate) mod options;
pub(crate) mod picture;
pub(crate) mod starts;
pub mod state;
pub(crate) mod surface;
pub(crate) mod teacher;
#[cfg(test)]
mod tests;

pub use actions::{ActionSet, Burning};
pub use layout::{MOST_PADS, PADS};
pub use options::{Elsewhere, FlagOptions, OptionsError};

use crate::craft::{Controls, Craft, Dispersion, Engines, Start};
use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Ending, Goal, Mirror, Plant, Step, View, Wish};
use cohelm::random::Draws;
use cohelm::registry::{OfferedActions, PlantEntry};
use cohelm::scene::{Pose, Scene};
use course::Course;
use judge::Rest;
use layout::{Layout, purpose};
use state::STATE_LENGTH;
use std::sync::Arc;

/// Changes whenever equal seeds and actions no longer give equal bits, or the state vector means something else.
pub const FLAG_LANDER_VERSION: u32 = 1;

/// A flight of the flag task. A clone is a snapshot: it goes on with the same bits.
#[derive(Clone, Debug)]
pub struct FlagLander {
    options: FlagOptions,
    space: Arc<ActionSpace>,
    layout: Arc<Layout>,
    course: Arc<Course>,
    /// What the pilot is made to want, whatever it wanted.
    told: Option<usize>,
    /// The goals of the moment, in the first places.
    goals: [Goal; MOST_PADS],
    goals_now: usize,
    scatter: Draws,
    craft: Craft,
    engines: Engines,
    tick: u32,
    rest: Rest,
    state: [f64; STATE_LENGTH],
    shown: [f32; STATE_LENGTH],
}

impl FlagLander {
    /// The flight of seed 0.
    pub fn new(options: FlagOptions) -> Result<Self, OptionsError> {
        options.check()?;
        let layout = Layout::draw(0, options.pad_half_width, options.pads as usize);
        let start = layout.start_at_the_top(0);
        Ok(Self::begin(options, Arc::new(options.actions.space()), layout, &start, 0))
    }

    /// The options it was made with.
    pub fn options(&self) -> &FlagOptions {
        &self.options
    }

    /// Which engines burnt in the last tick.
    pub fn burning(&self) -> Burning {
        Burning::of(&self.engines)
    }

    /// As in Gymnasium the first tick, with its push, is over before anyone sees or does anything.
    fn begin(
        options: FlagOptions,
        space: Arc<ActionSpace>,
        layout: Layout,
        start: &Start,
        seed: u64,
    ) -> Self {
        let mut craft = Craft::place_hanging(&layout.ground, start, options.settings());
        craft.tick(&Controls::IDLE);
        let course = Course::draw(seed, &options, layout.first_wish);
        let mut lander = Self {
            options,
            space,
            layout: Arc::new(layout),
            course: Arc::new(course),
            told: None,
            goals: [Goal { id: 0, position: [0.0; 2] }; MOST_PADS],
            goals_now: 0,
            scatter: Draws::fork(seed, purpose::SCATTER),
            craft,
            engines: Engines::OFF,
            tick: 0,
            rest: Rest::default(),
            state: [0.0; STATE_LENGTH],
            shown: [0.0; STATE_LENGTH],
        };
        lander.observe();
        lander
    }

    fn restart(&mut self, layout: Layout, start: &Start, seed: u64) {
        *self = Self::begin(self.options, Arc::clone(&self.space), layout, start, seed);
    }

    fn advance(&mut self, executed: Option<Action>, dispersion: Dispersion) -> Step {
        let wanted = self.wanted();
        let (potential, burnt) = (self.potential(wanted), self.burning());
        self.engines = self.options.actions.engines(executed, &self.engines);
        self.craft.tick(&Controls { engines: self.engines, dispersion, ..Controls::IDLE });
        self.tick += 1;
        self.rest.update(&self.craft);
        self.observe();
        let ending = self.ending();
        // Both for the goal before the tick: a changed mind is neither progress nor loss.
        let shaping = self.options.shaping * (self.potential(wanted) - potential);
        Step { reward: shaping + judge::worth(burnt, self.burning(), ending), ending }
    }

    fn observe(&mut self) {
        self.state = state::observe(&self.craft, &self.engines);
        self.shown = self.state.map(|value| value as f32);
        self.goals_now = 0;
        for pad in self.course.goals(self.tick) {
            self.goals[self.goals_now] = self.layout.goals[pad];
            self.goals_now += 1;
        }
    }

    /// The pad that the pilot wants now.
    fn wanted(&self) -> usize {
        self.told.unwrap_or_else(|| self.course.wanted(self.tick))
    }

    fn potential(&self, pad: usize) -> f64 {
        judge::potential(&self.state, self.layout.goals[pad].position.map(f64::from))
    }

    fn ending(&self) -> Option<Ending> {
        let late = (self.tick >= self.options.limit).then_some(Ending::TimeLimit);
        if self.craft.hull_touched() {
            Some(Ending::Crash)
        } else if judge::is_out_of_bounds(&self.state) {
            Some(Ending::OutOfBounds)
        } else if self.rest.has_landed() {
            self.landing().or(late)
        } else {
            late
        }
    }

    fn landing(&self) -> Option<Ending> {
        let at_the_goal = self.layout.is_at(self.wanted(), self.craft.hull().x.into());
        match self.options.elsewhere {
            _ if at_the_goal => Some(Ending::Goal),
            Elsewhere::End => Some(Ending::Elsewhere),
            Elsewhere::Continue => None,
        }
    }
}

impl Plant for FlagLander {
    fn reset(&mut self, seed: u64) {
        let layout = Layout::draw(seed, self.options.pad_half_width, self.options.pads as usize);
        let start = layout.start_at_the_top(seed);
        self.restart(layout, &start, seed);
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        let mut draw = || self.scatter.uniform(-1.0, 1.0);
        let dispersion = Dispersion::from_uniform([draw(), draw()]);
        self.advance(executed, dispersion)
    }

    fn view(&self) -> View<'_> {
        let switches = if self.options.actions == ActionSet::Switches { self.burning().bits() } else { 0 };
        View {
            tick: self.tick,
            state: &self.shown,
            position: [self.shown[state::X], self.shown[state::Y]],
            switches,
            goals: &self.goals[..self.goals_now],
        }
    }

    fn pilot_goal(&self) -> usize {
        let wanted = self.wanted();
        self.course.goals(self.tick).position(|pad| pad == wanted).unwrap_or(0)
    }

    fn wishes(&self) -> Vec<Wish> {
        let wish = |&(from, pad): &(u32, usize)| Wish { from, goal: self.layout.goals[pad].id };
        self.course.wishes().iter().map(wish).collect()
    }

    fn space(&self) -> &ActionSpace {
        &self.space
    }

    fn limit_ticks(&self) -> Option<u32> {
        Some(self.options.limit)
    }

    fn scene(&self) -> Scene {
        let Layout { surface, pads, goals, half_width, .. } = &*self.layout;
        let part = |pad: usize| picture::pad(goals[pad].id, pads[pad], *half_width);
        let (fixed, passing): (Vec<usize>, Vec<usize>) =
            (0..pads.len()).partition(|&pad| self.course.always(pad));
        let mut scene = picture::scene(surface, fixed.into_iter().map(part));
        scene.movable.extend(passing.into_iter().map(part));
        scene
    }

    /// Pads that come or go follow the craft's parts, and are not to be seen while they are no goals.
    fn poses(&self, poses: &mut Vec<Pose>) {
        picture::craft_poses(&self.craft, &self.engines, poses);
        let passing = (0..self.layout.pads.len()).filter(|&pad| !self.course.always(pad));
        poses.extend(passing.map(|pad| {
            let is_goal = self.course.goals(self.tick).any(|goal| goal == pad);
            Pose { x: 0.0, y: 0.0, angle_rad: 0.0, strength: f32::from(u8::from(is_goal)) }
        }));
    }

    fn snapshot(&self) -> Option<Box<dyn Plant>> {
        Some(Box::new(self.clone()))
    }

    fn set_pilot_goal(&mut self, goal: usize) -> bool {
        let pad = self.course.goals(self.tick).nth(goal);
        if pad.is_some() {
            self.told = pad;
        }
        pad.is_some()
    }

    fn reset_near_goal(&mut self, seed: u64, difficulty: f64) -> bool {
        if difficulty.is_nan() {
            return false;
        }
        let layout = Layout::draw(seed, self.options.pad_half_width, self.options.pads as usize);
        let pad = layout.pads[layout.first_wish];
        let mut draws = Draws::fork(seed, purpose::START);
        let start = starts::near_goal(pad, &layout.surface, difficulty.clamp(0.0, 1.0), &mut draws);
        self.restart(layout, &start, seed);
        true
    }

    fn mirror(&self) -> Option<Mirror> {
        let (commands, axes) = self.options.actions.mirrored();
        Some(Mirror { state: state::MIRRORED.to_vec(), position: [-1.0, 1.0], commands, axes })
    }

    fn teacher(&mut self, goal: usize) -> Option<Action> {
        let goal = self.view().goals.get(goal)?.position.map(f64::from);
        let wanted = teacher::wanted(&self.state, goal);
        Some(self.options.actions.towards(wanted, self.burning()))
    }
}

/// The action sets to offer where people choose.
const ACTIONS: &[OfferedActions] = &[
    OfferedActions::named("switches", "switches (the paper’s)"),
    OfferedActions::named("main-side", "main × side, held"),
    OfferedActions::named("gymnasium", "Gymnasium’s four"),
    OfferedActions::named("continuous", "axes, stick or keys"),
];

/// The flag task's entry in a registry, under the name `flag-lander`.
pub fn entry() -> PlantEntry {
    PlantEntry {
        name: "flag-lander",
        version: FLAG_LANDER_VERSION,
        summary: "Lunar Lander with three pairs of flags, one of them the pilot's goal: the task of the paper.",
        make: |options| {
            let lander = FlagOptions::from_json(options).and_then(FlagLander::new);
            lander.map(|lander| Box::new(lander) as _).map_err(|error| error.to_string())
        },
        values: None,
        skill: Some(crate::pilots::skill),
        actions: ACTIONS,
        preset: "default",
    }
}
