//! An arm in the plane: two links on a table, seen from above, whose hand takes one of four cups. The task of assistive
//! teleoperation: a person steers the hand, and which cup is wanted only the person knows.
//!
//! The hand is steered in the plane (resolved rates): what is asked is a direction, the joints turn so that the hand moves
//! there, and lag behind. A cup is taken by resting at it; one that is hit too fast is knocked over, a crash. A joint
//! driven to its stop trips the protective stop, which counts as out of bounds.
//!
//! The whole plant is this file: constants, state, options, kinematics, what counts as taken. `picture` draws it, and
//! [`pilots`] says what a person who has practised tries to do. Sizes and limits are ours, those of a light assistive arm,
//! where no other source is named.
//!
//! ```
//! use cohelm::{action::Action, plant::Plant};
//! use cohelm_arm::{Arm, ArmOptions};
//!
//! let mut arm = Arm::new(ArmOptions::default())?;
//! arm.reset(3);
//! let before = arm.view().position[0];
//! let to_the_right = Action::Command(3 * 1 + 2);
//! for _ in 0..20 {
//!     arm.step(Some(to_the_right));
//! }
//! assert!(arm.view().position[0] > before);
//! # Ok::<(), cohelm_arm::OptionError>(())
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
pub const ARM_VERSION: u32 = 1;

/// A tick, s.
const TICK_S: f64 = 0.02;
/// Length of each link, m: a light arm on a wheelchair or a desk.
pub(crate) const LINK_M: f64 = 0.5;
/// The hand's speed when it is asked for, m/s: somewhat above the 0.25 m/s that ISO 10218 calls reduced speed, so that
/// hurrying is possible and costs something.
const SPEED_MPS: f64 = 0.28;
/// How long the joints take to follow, s (first-order lag).
const LAG_S: f64 = 0.14;
/// Damping of the inverse near a stretched arm, m: less tracks better and turns faster, more is calmer.
const DAMPING_M: f64 = 0.05;
/// The fastest turn of a joint, rad/s.
const FASTEST_RAD_S: f64 = 3.0;
/// Range of the elbow, rad: at its ends the arm is stretched or folded.
const ELBOW_RAD: [f64; 2] = [0.15, 2.8];
/// Range of the shoulder, rad; the x axis is 0, counter-clockwise.
const SHOULDER_RAD: [f64; 2] = [-0.9, 3.0];
/// Cups on the table.
const CUPS: usize = 4;
/// Radius of a cup, m.
pub(crate) const CUP_M: f64 = 0.04;
/// Radius of the hand, m.
pub(crate) const HAND_M: f64 = 0.055;
/// Where cups may stand, from the shoulder, m.
const CUPS_AT_M: [f64; 2] = [0.62, 0.85];
/// Least distance of two cups, m.
const CUPS_APART_M: f64 = 0.22;
/// The hand can close around a cup within this distance of the middles, m.
const TOUCH_M: f64 = CUP_M + HAND_M;
/// Within this distance the palm is at the cup, m.
const PALM_M: f64 = 0.06;
/// Faster than this the palm knocks the cup over, m/s. Above [`SPEED_MPS`] no cup ever falls; at [`RESTS_MPS`] every cup falls
/// at which the hand does not rest.
const KNOCKS_MPS: f64 = 0.26;
/// Slower than this, touching, the hand may close, m/s. Near 0 the lag of the joints keeps it waiting; at [`KNOCKS_MPS`]
/// every touch that is no crash takes the cup.
const RESTS_MPS: f64 = 0.12;
/// For so many ticks it must rest: 0.16 s.
const REST_TICKS: u32 = 8;

/// One unit of position, m.
const UNIT_M: f64 = 0.8;
/// What is position zero, m.
const MIDDLE_M: [f64; 2] = [0.0, 0.45];
/// One unit of velocity, m/s.
const UNIT_MPS: f64 = 0.4;

/// Numbers in the state: hand x, y, vx, vy; shoulder and elbow (rad, halved); distance to the nearest cup; and which way
/// it is driven: left, right, down, up.
pub const STATE_LENGTH: usize = 11;
/// Components of the state.
pub(crate) mod state {
    pub const X: usize = 0;
    pub const Y: usize = 1;
    pub const VX: usize = 2;
    pub const VY: usize = 3;
    pub const LEFT: usize = 7;
    pub const RIGHT: usize = 8;
    pub const DOWN: usize = 9;
    pub const UP: usize = 10;
}

/// How it is steered. What is left out has its default.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ArmOptions {
    /// `levers` (default): eight directions and rest; or `continuous`: x to the right and y away from the base, each from −1 to
    /// 1.
    pub actions: Steering,
    /// Ticks after which the time is up, 1 to 100000; 750 is fifteen seconds.
    pub limit: u32,
}

impl Default for ArmOptions {
    fn default() -> Self {
        Self { actions: Steering::Levers, limit: 750 }
    }
}

impl ArmOptions {
    /// Reads them from an object; whatever it lacks has its default.
    pub fn from_json(value: &Value) -> Result<Self, OptionError> {
        serde_json::from_value(value.clone()).map_err(|error| OptionError::Unreadable(error.to_string()))
    }
}

/// Why there is no such arm.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OptionError {
    /// Not an object of known options.
    #[error("{0}; expected an object with some of actions (\"levers\", \"continuous\"), limit")]
    Unreadable(String),
    /// No time at all, or half an hour of it.
    #[error("expected option \"limit\" from 1 to 100000, got {0}; usual is 750")]
    Limit(u32),
}

/// Angles of the joints, rad, and how fast they turn, rad/s; the elbow's is relative to the upper arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Joints {
    pub shoulder: f64,
    pub elbow: f64,
    turning: [f64; 2],
}

impl Joints {
    /// Where the elbow is, m.
    pub fn elbow_at(&self) -> [f64; 2] {
        [LINK_M * libm::cos(self.shoulder), LINK_M * libm::sin(self.shoulder)]
    }

    /// Where the hand is, m.
    pub fn hand_at(&self) -> [f64; 2] {
        let [x, y] = self.elbow_at();
        let fore_arm = self.shoulder + self.elbow;
        [x + LINK_M * libm::cos(fore_arm), y + LINK_M * libm::sin(fore_arm)]
    }

    /// How the hand moves when the joints turn: rows x and y, columns shoulder and elbow, m/rad.
    fn jacobian(&self) -> [[f64; 2]; 2] {
        let ([x, y], [ex, ey]) = (self.hand_at(), self.elbow_at());
        [[-y, -(y - ey)], [x, x - ex]]
    }

    fn hand_velocity(&self) -> [f64; 2] {
        self.jacobian().map(|[shoulder, elbow]| shoulder * self.turning[0] + elbow * self.turning[1])
    }

    /// The turns that move the hand as wished, by damped least squares: Jᵀ(JJᵀ + d²)⁻¹ v (Wampler 1986).
    fn turns_for(&self, [vx, vy]: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = self.jacobian();
        let damping = DAMPING_M * DAMPING_M;
        let (p, q, r) = (a * a + b * b + damping, a * c + b * d, c * c + d * d + damping);
        let determinant = p * r - q * q;
        let (u, w) = ((r * vx - q * vy) / determinant, (p * vy - q * vx) / determinant);
        [a * u + c * w, b * u + d * w].map(|turn| turn.clamp(-FASTEST_RAD_S, FASTEST_RAD_S))
    }

    /// The joints that bring the hand there, elbow to the right; the place must be within reach.
    fn reaching([x, y]: [f64; 2]) -> Self {
        let squared = x * x + y * y;
        let bend = ((squared - 2.0 * LINK_M * LINK_M) / (2.0 * LINK_M * LINK_M)).clamp(-1.0, 1.0);
        let elbow = libm::acos(bend);
        let shoulder =
            libm::atan2(y, x) - libm::atan2(LINK_M * libm::sin(elbow), LINK_M * (1.0 + libm::cos(elbow)));
        Self { shoulder, elbow, turning: [0.0; 2] }
    }

    fn at_a_stop(&self) -> bool {
        let beyond = |angle: f64, [least, most]: [f64; 2]| angle < least || angle > most;
        beyond(self.elbow, ELBOW_RAD) || beyond(self.shoulder, SHOULDER_RAD)
    }
}

/// A reach. A clone is a snapshot.
#[derive(Clone, Debug)]
pub struct Arm {
    options: ArmOptions,
    space: ActionSpace,
    /// Middles of the cups, m.
    pub(crate) cups: [[f64; 2]; CUPS],
    goals: [Goal; CUPS],
    wanted: usize,
    pub(crate) joints: Joints,
    /// The direction asked for, each from −1 to 1.
    pub(crate) driven: [f64; 2],
    rested: u32,
    tick: u32,
    shown: [f32; STATE_LENGTH],
}

impl Arm {
    /// The reach of seed 0, or what is wrong with the options.
    pub fn new(options: ArmOptions) -> Result<Self, OptionError> {
        if !(1..=100_000).contains(&options.limit) {
            return Err(OptionError::Limit(options.limit));
        }
        let mut arm = Self {
            options,
            space: options.actions.space(["away", "aside"], ["still", "still"]),
            cups: [[0.0; 2]; CUPS],
            goals: [0, 1, 2, 3].map(|id| Goal { id, position: [0.0; 2] }),
            wanted: 0,
            joints: Joints::default(),
            driven: [0.0; 2],
            rested: 0,
            tick: 0,
            shown: [0.0; STATE_LENGTH],
        };
        arm.reset(0);
        Ok(arm)
    }

    /// Cups and wish of a seed; the hand is placed by the caller. Cups are drawn until they stand apart.
    fn lay_table(&mut self, seed: u64) -> Draws {
        let mut draws = Draws::new(seed);
        let mut standing = 0;
        while standing < CUPS {
            let (far, angle) = (draws.uniform(CUPS_AT_M[0], CUPS_AT_M[1]), draws.uniform(0.45, 2.7));
            let cup = [far * libm::cos(angle), far * libm::sin(angle)];
            if self.cups[..standing].iter().all(|&other| distance(cup, other) >= CUPS_APART_M) {
                self.cups[standing] = cup;
                standing += 1;
            }
        }
        self.cups.sort_by(|a, b| a[0].total_cmp(&b[0]));
        for (goal, cup) in self.goals.iter_mut().zip(self.cups) {
            goal.position = position(cup);
        }
        self.wanted = draws.below(CUPS);
        (self.driven, self.rested, self.tick) = ([0.0; 2], 0, 0);
        draws
    }

    /// The cup that is nearer to the hand than this, m.
    fn within(&self, reach: f64) -> Option<usize> {
        let hand = self.joints.hand_at();
        self.cups.iter().position(|&cup| distance(hand, cup) <= reach)
    }

    fn advance(&mut self) {
        let wished = self.joints.turns_for(self.driven.map(|part| SPEED_MPS * part));
        for (turning, wished) in self.joints.turning.iter_mut().zip(wished) {
            *turning += TICK_S / LAG_S * (wished - *turning);
        }
        self.joints.shoulder += TICK_S * self.joints.turning[0];
        self.joints.elbow += TICK_S * self.joints.turning[1];
        self.tick += 1;
        let rests = self.within(TOUCH_M).is_some() && self.speed() < RESTS_MPS;
        self.rested = if rests { self.rested + 1 } else { 0 };
    }

    fn speed(&self) -> f64 {
        let [vx, vy] = self.joints.hand_velocity();
        libm::sqrt(vx * vx + vy * vy)
    }

    fn ending(&self) -> Option<Ending> {
        let late = (self.tick >= self.options.limit).then_some(Ending::TimeLimit);
        if self.within(PALM_M).is_some() && self.speed() > KNOCKS_MPS {
            return Some(Ending::Crash);
        }
        match self.within(TOUCH_M) {
            Some(cup) if self.rested >= REST_TICKS && cup == self.wanted => Some(Ending::Goal),
            Some(_) if self.rested >= REST_TICKS => Some(Ending::Elsewhere),
            _ if self.joints.at_a_stop() => Some(Ending::OutOfBounds),
            _ => late,
        }
    }

    fn observe(&mut self) {
        let (hand, [vx, vy]) = (self.joints.hand_at(), self.joints.hand_velocity());
        let [x, y] = position(hand);
        let nearest = self.cups.iter().map(|&cup| distance(hand, cup)).fold(f64::INFINITY, f64::min);
        let moving = [
            vx / UNIT_MPS,
            vy / UNIT_MPS,
            self.joints.shoulder / 2.0,
            self.joints.elbow / 2.0,
            nearest / UNIT_M,
        ];
        let [right, up] = self.driven;
        let driven = [-right, right, -up, up].map(|part| f64::from(u8::from(part > 0.5)));
        self.shown[..2].copy_from_slice(&[x, y]);
        for (shown, value) in self.shown[2..].iter_mut().zip(moving.into_iter().chain(driven)) {
            *shown = value as f32;
        }
    }

    /// −(distance to the wanted cup + a little for speed), in the state's units: what shaping is made of.
    fn potential(&self) -> f64 {
        let near = distance(self.joints.hand_at(), self.cups[self.wanted]) / UNIT_M;
        -(2.0 * near + 0.3 * self.speed() / UNIT_MPS)
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    libm::sqrt(dx * dx + dy * dy)
}

fn position([x, y]: [f64; 2]) -> [f32; 2] {
    [((x - MIDDLE_M[0]) / UNIT_M) as f32, ((y - MIDDLE_M[1]) / UNIT_M) as f32]
}

/// The direction that an action means; a slanting one is no faster than a straight one.
fn direction(executed: Option<Action>) -> [f64; 2] {
    let [x, y] = asked(executed);
    let length = libm::sqrt(x * x + y * y).max(1.0);
    [x / length, y / length]
}

impl Plant for Arm {
    fn reset(&mut self, seed: u64) {
        let mut draws = self.lay_table(seed);
        let start = [draws.uniform(-0.12, 0.12), draws.uniform(0.22, 0.3)];
        self.joints = Joints::reaching(start);
        self.observe();
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        let before = self.potential();
        self.driven = direction(executed);
        self.advance();
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
        let known = goal < CUPS;
        if known {
            self.wanted = goal;
        }
        known
    }

    /// From touching the wanted cup to the ordinary start, on a straight line.
    fn reset_near_goal(&mut self, seed: u64, difficulty: f64) -> bool {
        if difficulty.is_nan() {
            return false;
        }
        let far = difficulty.clamp(0.0, 1.0);
        let mut draws = self.lay_table(seed);
        let start = [draws.uniform(-0.3, 0.3), draws.uniform(0.22, 0.6)];
        let cup = self.cups[self.wanted];
        let mut hand = [0, 1].map(|i| cup[i] + far * (start[i] - cup[i]));
        let near = distance(hand, cup).max(1e-9);
        if near < 0.9 * TOUCH_M {
            // At the cup, not in it: on its side towards the start.
            let towards = distance(start, cup).max(1e-9);
            hand = [0, 1].map(|i| cup[i] + 0.9 * TOUCH_M * (start[i] - cup[i]) / towards);
        }
        self.joints = Joints::reaching(hand);
        self.observe();
        true
    }

    /// None: the elbow is always on the same side.
    fn mirror(&self) -> Option<Mirror> {
        None
    }

    /// Goes straight to a cup, slower as it comes near, around nothing.
    fn teacher(&mut self, goal: usize) -> Option<Action> {
        let cup = *self.cups.get(goal)?;
        let (hand, [vx, vy]) = (self.joints.hand_at(), self.joints.hand_velocity());
        let gap = (distance(hand, cup) - 0.4 * TOUCH_M).max(0.0);
        let speed = (2.0 * gap).min(SPEED_MPS);
        let wish = |i: usize, now: f64| {
            let wanted = speed * (cup[i] - hand[i]) / distance(hand, cup).max(1e-9);
            ((wanted + 2.0 * (wanted - now)) / SPEED_MPS).clamp(-1.0, 1.0)
        };
        let asked = [wish(0, vx), wish(1, vy)];
        Some(self.options.actions.action(asked))
    }
}

/// The action sets to offer where people choose.
const ACTIONS: &[OfferedActions] = &[
    OfferedActions::named("levers", "eight directions, held"),
    OfferedActions::named("continuous", "axes, stick or keys"),
];

/// The arm's entry in a registry, under the name `arm`.
pub fn entry() -> PlantEntry {
    PlantEntry {
        name: "arm",
        version: ARM_VERSION,
        summary: "A planar arm whose hand takes one of four cups without knocking any over.",
        make: |options| {
            let arm = ArmOptions::from_json(options).and_then(Arm::new);
            arm.map(|arm| Box::new(arm) as _).map_err(|error| error.to_string())
        },
        values: None,
        skill: Some(pilots::skill),
        actions: ACTIONS,
        preset: "default",
    }
}
