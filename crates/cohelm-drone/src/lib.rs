//! A drone in the plane: two rotors, gusty wind, three pads on pillars, one of them the pilot's. The paper's own example of
//! shared control.
//!
//! Both rotors carry the weight when nothing is asked. `lift` changes them together, `roll` against each other; nothing
//! levels the drone by itself, so that whoever flies it balances. Landing is one event: both feet reach a pad gently and
//! upright. Everything else that touches anything is a crash.
//!
//! The whole plant is this file: constants, state, options, Newton, what counts as landed. `picture` draws it, and
//! [`pilots`] says what a person who has practised tries to do. The equations are those of the planar quadrotor (Tedrake,
//! *Underactuated Robotics*, chapter 3) with drag and gusts; sizes and limits are ours, those of a small camera drone,
//! where no other source is named.
//!
//! ```
//! use cohelm::{action::Action, plant::Plant};
//! use cohelm_drone::{Drone, DroneOptions};
//!
//! let mut drone = Drone::new(DroneOptions::default())?;
//! drone.reset(7);
//! let (down, hover, up) = (1, 4, 7); // each with no roll
//! for command in [up, hover, down] {
//!     drone.step(Some(Action::Command(command)));
//! }
//! assert_eq!((drone.view().tick, drone.view().goals.len()), (3, 3));
//! # Ok::<(), cohelm_drone::OptionError>(())
//! ```
#![forbid(unsafe_code)]

mod picture;
pub mod pilots;
#[cfg(test)]
mod tests;

use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Ending, Goal, Mirror, Plant, Step, View};
use cohelm::random::Draws;
use cohelm::registry::{OfferedActions, PlantEntry};
use cohelm::scene::{Pose, Scene};
use cohelm::steering::{Steering, asked};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Changes whenever equal seeds and actions no longer give equal bits, or the state means something else.
pub const DRONE_VERSION: u32 = 1;

/// A tick, s.
const TICK_S: f64 = 0.02;
/// The visible world, m.
pub(crate) const WIDTH_M: f64 = 16.0;
/// See [`WIDTH_M`].
pub(crate) const HEIGHT_M: f64 = 12.0;
/// Weight, m/s².
const GRAVITY: f64 = 9.81;
/// Mass, kg: that of a small camera drone.
const MASS_KG: f64 = 1.2;
/// From the middle to a rotor, m.
pub(crate) const ARM_M: f64 = 0.45;
/// Moment of inertia, kg m²: two motors of 0.12 kg at the ends of the arms and the rest in the middle.
const INERTIA_KG_M2: f64 = 0.06;
/// Thrust that full `lift` adds or takes away, as a share of the weight. More is livelier.
const LIFT_SHARE: f64 = 0.5;
/// Thrust that full `roll` shifts from one rotor to the other, as a share of the weight: 5.3 rad/s² of spin.
const ROLL_SHARE: f64 = 0.03;
/// Share of the speed that the air takes in a second. At 0 a drift lasts until it is leaned against; at 2 it is gone after half a
/// second, and no skill is needed.
const DRAG_PER_S: f64 = 0.25;
/// Share of the spin that the air takes in a second. At 0 a spin lasts until the other key stops it; at 5 it stops where the
/// key is let go.
const SPIN_DRAG_PER_S: f64 = 0.8;
/// Gusts push sideways: standard deviation, m/s². At five times that it cannot be held over a pad.
const GUST_MPS2: f64 = 0.4;
/// And last for about so long, s: first-order noise, as the gusts along the flight of the Dryden model (MIL-F-8785C).
const GUST_S: f64 = 1.5;
/// Half the width of a pad, m.
pub(crate) const PAD_HALF_WIDTH_M: f64 = 1.0;
/// Least distance of the middles of two pads, m.
const PADS_APART_M: f64 = 3.0;
/// Pads.
const PADS: usize = 3;
/// The feet, in the drone's frame, m.
const FEET_M: [[f64; 2]; 2] = [[-0.3, -0.25], [0.3, -0.25]];
/// What else of it can touch something, m.
const TIPS_M: [[f64; 2]; 2] = [[-0.6, 0.08], [0.6, 0.08]];
/// A landing is gentle up to this vertical speed, m/s. Below 0.4, at which who has practised comes down, nobody lands; at 3 it is
/// a landing to drop with full `down` from 0.9 m.
const GENTLE_MPS: f64 = 1.5;
/// And this sideways speed, m/s. Below 0.6, which one gust brings (0.4 m/s² for 1.5 s), landing is luck; above 2 a pass over
/// the pad is a landing.
const STRAIGHT_MPS: f64 = 1.0;
/// And this tilt, rad. Below 0.05 a gust cannot be leaned against to the end (0.4 m/s² is 0.04 rad); above 0.83 a rotor touches
/// before a foot does.
const UPRIGHT_RAD: f64 = 0.3;
/// A foot that is found deeper than this below a pad's surface, m, came from the side and hit the pillar: at the fastest
/// gentle descent a tick is 0.03 m.
const FROM_ABOVE_M: f64 = 0.15;

/// Half the width of the world is one unit of position, m.
const UNIT_M: f64 = WIDTH_M / 2.0;
/// One unit of velocity, m/s.
const UNIT_MPS: f64 = 5.0;
/// One unit of spin, rad/s.
const UNIT_RAD_S: f64 = 3.0;

/// Numbers in the state: x, y, vx, vy, tilt (rad), spin, room to the ground below, and what burns: down, up, left, right.
pub const STATE_LENGTH: usize = 11;
/// Components of the state.
pub(crate) mod state {
    pub const X: usize = 0;
    pub const Y: usize = 1;
    pub const VX: usize = 2;
    pub const VY: usize = 3;
    pub const TILT: usize = 4;
    pub const SPIN: usize = 5;
    pub const ROOM: usize = 6;
    pub const DOWN: usize = 7;
    pub const UP: usize = 8;
    pub const LEFT: usize = 9;
    pub const RIGHT: usize = 10;
}

/// How it is flown. What is left out has its default.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DroneOptions {
    /// `levers` (default): lift and roll, nine commands; or `continuous`: roll (x, to the right) and lift (y), each from −1 to 1.
    pub actions: Steering,
    /// Ticks after which the time is up, 1 to 100000; 1000 is twenty seconds.
    pub limit: u32,
    /// Factor on the gusts, 0 to 5; 1 by default, 0 is still air.
    pub wind: f64,
}

impl Default for DroneOptions {
    fn default() -> Self {
        Self { actions: Steering::Levers, limit: 1000, wind: 1.0 }
    }
}

impl DroneOptions {
    /// Reads them from an object; whatever it lacks has its default.
    pub fn from_json(value: &Value) -> Result<Self, OptionError> {
        serde_json::from_value(value.clone()).map_err(|error| OptionError::Unreadable(error.to_string()))
    }

    fn check(&self) -> Result<(), OptionError> {
        in_range("limit", self.limit.into(), [1.0, 100_000.0], 1000.0)?;
        in_range("wind", self.wind, [0.0, 5.0], 1.0)
    }
}

fn in_range(option: &'static str, got: f64, range: [f64; 2], usual: f64) -> Result<(), OptionError> {
    let inside = (range[0]..=range[1]).contains(&got);
    if inside { Ok(()) } else { Err(OptionError::OutOfRange { option, got, range, usual }) }
}

/// Why there is no such drone.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OptionError {
    /// Not an object of known options.
    #[error("{0}; expected an object with some of actions (\"levers\", \"continuous\"), limit, wind")]
    Unreadable(String),
    /// A number that cannot be.
    #[error("expected option {option:?} from {} to {}, got {got}; usual is {usual}", .range[0], .range[1])]
    OutOfRange {
        /// Which option.
        option: &'static str,
        /// What was given.
        got: f64,
        /// The least and the greatest that can be.
        range: [f64; 2],
        /// What is usual.
        usual: f64,
    },
}

/// Where the drone is and how it moves: m, m/s, rad (counter-clockwise), rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    pub x: f64,
    pub y: f64,
    vx: f64,
    vy: f64,
    pub tilt: f64,
    spin: f64,
}

/// A flight. A clone is a snapshot.
#[derive(Clone, Debug)]
pub struct Drone {
    options: DroneOptions,
    space: ActionSpace,
    /// Middles of the pads' surfaces, from left to right, m.
    pub(crate) pads: [[f64; 2]; PADS],
    goals: [Goal; PADS],
    wanted: usize,
    gusts: Draws,
    gust_mps2: f64,
    pub(crate) motion: Motion,
    /// Roll (to the right) and lift, each from −1 to 1.
    pub(crate) thrust: [f64; 2],
    tick: u32,
    shown: [f32; STATE_LENGTH],
}

impl Drone {
    /// The flight of seed 0, or what is wrong with the options.
    pub fn new(options: DroneOptions) -> Result<Self, OptionError> {
        options.check()?;
        let mut drone = Self {
            options,
            space: options.actions.space(["lift", "roll"], ["hover", "none"]),
            pads: [[0.0; 2]; PADS],
            goals: [0, 1, 2].map(|id| Goal { id, position: [0.0; 2] }),
            wanted: 0,
            gusts: Draws::new(0),
            gust_mps2: 0.0,
            motion: Motion::default(),
            thrust: [0.0; 2],
            tick: 0,
            shown: [0.0; STATE_LENGTH],
        };
        drone.reset(0);
        Ok(drone)
    }

    /// Pads, goal and wind of a seed; the drone is placed by the caller.
    fn lay_out(&mut self, seed: u64) -> Draws {
        let mut draws = Draws::new(seed);
        let room = WIDTH_M - 2.0 * (PAD_HALF_WIDTH_M + 0.5) - (PADS - 1) as f64 * PADS_APART_M;
        let mut shifts: [f64; PADS] = std::array::from_fn(|_| draws.uniform(0.0, room));
        shifts.sort_by(f64::total_cmp);
        for (index, shift) in shifts.into_iter().enumerate() {
            let x = PAD_HALF_WIDTH_M + 0.5 + shift + index as f64 * PADS_APART_M;
            self.pads[index] = [x, draws.uniform(0.5, 3.0)];
            // What is to come to rest on the pad is the middle of the drone.
            self.goals[index].position = position([x, self.pads[index][1] - FEET_M[0][1]]);
        }
        self.wanted = draws.below(PADS);
        self.gusts = Draws::fork(seed, 1);
        (self.gust_mps2, self.thrust, self.tick) = (0.0, [0.0; 2], 0);
        draws
    }

    /// An ordinary start: high up, hardly moving.
    fn start(draws: &mut Draws) -> Motion {
        Motion {
            x: draws.uniform(3.0, WIDTH_M - 3.0),
            y: draws.uniform(9.0, 10.5),
            vx: draws.uniform(-1.0, 1.0),
            vy: draws.uniform(-0.5, 0.5),
            tilt: draws.uniform(-0.1, 0.1),
            spin: draws.uniform(-0.1, 0.1),
        }
    }

    /// Height of what lies below a place, m: a pad, or the ground.
    fn surface(&self, x: f64) -> f64 {
        let over = |pad: &&[f64; 2]| (x - pad[0]).abs() <= PAD_HALF_WIDTH_M;
        self.pads.iter().find(over).map_or(0.0, |pad| pad[1])
    }

    /// Newton, once a tick: velocities first, then places with the new velocities, so that energy does not grow.
    fn advance(&mut self) {
        let [roll, lift] = self.thrust;
        // An Ornstein–Uhlenbeck process in discrete time: it forgets, and is pushed anew.
        let kept = 1.0 - TICK_S / GUST_S;
        let push = GUST_MPS2 * self.options.wind * libm::sqrt(1.0 - kept * kept);
        self.gust_mps2 = kept * self.gust_mps2 + push * self.gusts.normal();
        let motion = &mut self.motion;
        let lifting = GRAVITY * (1.0 + LIFT_SHARE * lift);
        let turning = -roll * 2.0 * ROLL_SHARE * MASS_KG * GRAVITY * ARM_M / INERTIA_KG_M2;
        motion.vx += TICK_S * (-libm::sin(motion.tilt) * lifting - DRAG_PER_S * motion.vx + self.gust_mps2);
        motion.vy += TICK_S * (libm::cos(motion.tilt) * lifting - GRAVITY - DRAG_PER_S * motion.vy);
        motion.spin += TICK_S * (turning - SPIN_DRAG_PER_S * motion.spin);
        motion.x += TICK_S * motion.vx;
        motion.y += TICK_S * motion.vy;
        motion.tilt += TICK_S * motion.spin;
    }

    fn observe(&mut self) {
        let Motion { x, y, vx, vy, tilt, spin } = self.motion;
        let [px, py] = position([x, y]);
        let room = (y - self.surface(x)) / UNIT_M;
        let burns = |asked: f64| f64::from(u8::from(asked > 0.5));
        let [roll, lift] = self.thrust;
        let moving = [vx / UNIT_MPS, vy / UNIT_MPS, tilt, spin / UNIT_RAD_S, room];
        let burning = [burns(-lift), burns(lift), burns(-roll), burns(roll)];
        self.shown[..2].copy_from_slice(&[px, py]);
        for (shown, value) in self.shown[2..].iter_mut().zip(moving.into_iter().chain(burning)) {
            *shown = value as f32;
        }
    }

    fn ending(&self) -> Option<Ending> {
        let Motion { x, y, .. } = self.motion;
        if (x - WIDTH_M / 2.0).abs() > WIDTH_M / 2.0 || y > HEIGHT_M {
            return Some(Ending::OutOfBounds);
        }
        let below = |[x, y]: [f64; 2]| y <= self.surface(x);
        if TIPS_M.iter().any(|&tip| below(self.in_world(tip))) {
            return Some(Ending::Crash);
        }
        if FEET_M.iter().any(|&foot| below(self.in_world(foot))) {
            return Some(self.touch_down());
        }
        (self.tick >= self.options.limit).then_some(Ending::TimeLimit)
    }

    /// What the first touch of a foot is.
    fn touch_down(&self) -> Ending {
        let Motion { vx, vy, tilt, .. } = self.motion;
        let gently = vy.abs() <= GENTLE_MPS && vx.abs() <= STRAIGHT_MPS && tilt.abs() <= UPRIGHT_RAD;
        let feet = FEET_M.map(|foot| self.in_world(foot));
        let over = |pad: &[f64; 2]| feet.iter().all(|foot| (foot[0] - pad[0]).abs() <= PAD_HALF_WIDTH_M);
        let from_above = |pad: &[f64; 2]| feet.iter().all(|foot| foot[1] > pad[1] - FROM_ABOVE_M);
        match self.pads.iter().position(|pad| over(pad) && from_above(pad)) {
            Some(pad) if gently && pad == self.wanted => Ending::Goal,
            Some(_) if gently => Ending::Elsewhere,
            _ => Ending::Crash,
        }
    }

    fn in_world(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (libm::sin(self.motion.tilt), libm::cos(self.motion.tilt));
        [self.motion.x + cos * x - sin * y, self.motion.y + sin * x + cos * y]
    }

    /// −(distance + speed + tilt), in the state's units: what shaping is made of.
    fn potential(&self) -> f64 {
        let at = |index: usize| f64::from(self.shown[index]);
        let goal = self.goals[self.wanted].position;
        let (dx, dy) = (at(state::X) - f64::from(goal[0]), at(state::Y) - f64::from(goal[1]));
        let distance = libm::sqrt(dx * dx + dy * dy);
        let speed = libm::sqrt(at(state::VX) * at(state::VX) + at(state::VY) * at(state::VY));
        -(distance + speed + at(state::TILT).abs())
    }
}

/// In units of position: half the world's width, from its middle.
fn position([x, y]: [f64; 2]) -> [f32; 2] {
    [((x - WIDTH_M / 2.0) / UNIT_M) as f32, ((y - HEIGHT_M / 2.0) / UNIT_M) as f32]
}

impl Plant for Drone {
    fn reset(&mut self, seed: u64) {
        let mut draws = self.lay_out(seed);
        self.motion = Self::start(&mut draws);
        self.observe();
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        let before = self.potential();
        self.thrust = asked(executed);
        self.advance();
        self.tick += 1;
        self.observe();
        let ending = self.ending();
        let worth = match ending {
            Some(Ending::Goal) => 3.0,
            Some(ending) if ending.is_terminal() => -1.0,
            _ => 0.0,
        };
        Step { reward: 0.5 * (self.potential() - before) - 0.003 + worth, ending }
    }

    fn view(&self) -> View<'_> {
        let position = [self.shown[state::X], self.shown[state::Y]];
        View { tick: self.tick, state: &self.shown, position, switches: 0, goals: &self.goals }
    }

    fn pilot_goal(&self) -> usize {
        self.wanted
    }

    fn space(&self) -> &ActionSpace {
        &self.space
    }

    fn limit_ticks(&self) -> Option<u32> {
        Some(self.options.limit)
    }

    fn scene(&self) -> Scene {
        picture::scene(self)
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        picture::poses(self, poses);
    }

    fn snapshot(&self) -> Option<Box<dyn Plant>> {
        Some(Box::new(self.clone()))
    }

    fn set_pilot_goal(&mut self, goal: usize) -> bool {
        let known = goal < PADS;
        if known {
            self.wanted = goal;
        }
        known
    }

    /// From standing over the goal to anywhere: places, speeds and tilt are mixed by the difficulty.
    fn reset_near_goal(&mut self, seed: u64, difficulty: f64) -> bool {
        if difficulty.is_nan() {
            return false;
        }
        let far = difficulty.clamp(0.0, 1.0);
        let mut draws = self.lay_out(seed);
        let wide = Self::start(&mut draws);
        let [pad_x, pad_y] = self.pads[self.wanted];
        let over_pad = pad_y - FEET_M[0][1] + 0.1;
        let lowest = 3.0 + 0.6;
        self.motion = Motion {
            x: pad_x + far * (wide.x - pad_x),
            y: over_pad + far * (draws.uniform(lowest, wide.y) - over_pad),
            vx: far * draws.uniform(-1.5, 1.5),
            vy: -0.3 + far * draws.uniform(-1.5, 1.0),
            tilt: far * draws.uniform(-0.2, 0.2),
            spin: far * draws.uniform(-0.3, 0.3),
        };
        self.observe();
        true
    }

    /// Left and right.
    fn mirror(&self) -> Option<Mirror> {
        let signs = [-1.0, 1.0, -1.0, 1.0, -1.0, -1.0, 1.0, 1.0, 1.0];
        let mut state: Vec<(usize, f32)> = signs.into_iter().enumerate().collect();
        state.extend([(state::RIGHT, 1.0), (state::LEFT, 1.0)]);
        let (commands, axes) = match self.options.actions {
            Steering::Levers => ((0..9).map(|command| command / 3 * 3 + (2 - command % 3)).collect(), vec![]),
            Steering::Continuous => (vec![], vec![(0, -1.0), (1, 1.0)]),
        };
        Some(Mirror { state, position: [-1.0, 1.0], commands, axes })
    }

    /// Leans against distance and drift, comes down where it is over the pad.
    fn teacher(&mut self, goal: usize) -> Option<Action> {
        let [goal_x, goal_y] = *self.pads.get(goal)?;
        let Motion { x, y, vx, vy, tilt, spin } = self.motion;
        let off = x - goal_x;
        let lean = (0.10 * off + 0.16 * vx).clamp(-0.3, 0.3) - tilt - 0.35 * spin;
        let height = y + FEET_M[0][1] - goal_y;
        let waits = if off.abs() > 0.5 + 0.3 * height.max(0.0) { 1.5 } else { 0.0 };
        let climb = (0.8 * (waits - height)).clamp(-2.0, 1.5) - 0.4 - vy;
        let asked = [(-lean / 0.1).clamp(-1.0, 1.0), (climb / 0.3).clamp(-1.0, 1.0)];
        Some(self.options.actions.action(asked))
    }
}

/// The action sets to offer where people choose.
const ACTIONS: &[OfferedActions] = &[
    OfferedActions::named("levers", "lift × roll, held"),
    OfferedActions::named("continuous", "axes, stick or keys"),
];

/// The drone's entry in a registry, under the name `drone`.
pub fn entry() -> PlantEntry {
    PlantEntry {
        name: "drone",
        version: DRONE_VERSION,
        summary: "A planar drone in gusty wind that lands on one of three pads.",
        make: |options| {
            let drone = DroneOptions::from_json(options).and_then(Drone::new);
            drone.map(|drone| Box::new(drone) as _).map_err(|error| error.to_string())
        },
        values: None,
        skill: Some(pilots::skill),
        actions: ACTIONS,
        preset: "default",
    }
}
