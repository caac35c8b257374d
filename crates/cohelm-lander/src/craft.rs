//! The craft: hull and two sprung legs over a piece of ground, and the engines that push it.
//!
//! Both tasks fly this craft: Gymnasium's, bit for bit, and the flag task of the paper. It knows no goal, no reward and
//! no random numbers: who flies it draws the [`Dispersion`] of the engines and hands it in.
//!
//! Units are Box2D's "world units" (Gymnasium draws 30 pixels for one), seconds, radians. x grows to the right, y upwards,
//! angles counter-clockwise. One [`Craft::tick`] is 1/50 s.
//!
//! ```
//! use cohelm_lander::craft::{Controls, Craft, Engines, Ground, Settings, Start};
//!
//! let ground = Ground::polyline(&[[0.0, 3.0], [20.0, 3.0]])?;
//! let mut craft = Craft::place(&ground, &Start::at(10.0, 8.0), Settings::default());
//! craft.tick(&Controls { engines: Engines::MAIN, ..Controls::IDLE });
//! assert!(craft.hull().y < 8.0 && craft.awake());
//! # Ok::<(), cohelm_lander::craft::GroundError>(())
//! ```

/// Length of one tick in seconds.
pub const TICK_S: f64 = 1.0 / 50.0;
/// Pixels that Gymnasium draws for one world unit; its constants are written in pixels.
pub const SCALE: f64 = 30.0;
/// Width of Gymnasium's world, in world units.
pub const WORLD_WIDTH: f64 = 600.0 / SCALE;
/// Height of Gymnasium's world, in world units.
pub const WORLD_HEIGHT: f64 = 400.0 / SCALE;
/// Corners of the hull around its own position, counter-clockwise, in world units: what a page draws.
pub const HULL_OUTLINE: [[f64; 2]; 6] = [
    [17.0 / SCALE, -10.0 / SCALE],
    [17.0 / SCALE, 0.0],
    [14.0 / SCALE, 17.0 / SCALE],
    [-14.0 / SCALE, 17.0 / SCALE],
    [-17.0 / SCALE, 0.0],
    [-17.0 / SCALE, -10.0 / SCALE],
];
/// Corners of a leg around its own position, counter-clockwise, in world units.
pub const LEG_OUTLINE: [[f64; 2]; 4] = [
    [-2.0 / SCALE, -8.0 / SCALE],
    [2.0 / SCALE, -8.0 / SCALE],
    [2.0 / SCALE, 8.0 / SCALE],
    [-2.0 / SCALE, 8.0 / SCALE],
];

/// What the craft stands on: a chain of straight edges that never moves. Cheap to clone (shared).
#[derive(Clone, Debug, PartialEq)]
pub struct Ground;

/// Why a list of vertices is no ground.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum GroundError {
    /// Fewer than two vertices.
    #[error("a ground needs at least 2 vertices, {0} given")]
    TooFewVertices(usize),
    /// A coordinate is not finite or beyond ±1000 world units.
    #[error("vertex {index} is ({x}, {y}): coordinates must be finite and within ±1000 world units")]
    OutOfRange {
        /// Position of the vertex in the list.
        index: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
    },
    /// Vertices must go from left to right, at least 0.01 units apart.
    #[error(
        "vertex {index} lies less than 0.01 units to the right of the one before it: list the vertices from left to right"
    )]
    NotRightwards {
        /// Position of the vertex in the list.
        index: usize,
    },
}

impl Ground {
    /// Edges between neighbouring vertices `[x, y]` (world units), which must go from left to right.
    /// Friction is that of Gymnasium's moon (0.1).
    pub fn polyline(vertices: &[[f64; 2]]) -> Result<Ground, GroundError> {
        let _ = vertices;
        todo!()
    }

    /// Gymnasium's moon: its base line at y = 0 and ten edges over eleven smoothed `heights`, evenly spaced over [`WORLD_WIDTH`].
    pub fn gymnasium(heights: &[f64; 11]) -> Ground {
        let _ = heights;
        todo!()
    }
}

/// How the world is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Vertical acceleration, units/s². Gymnasium: −10.
    pub gravity: f64,
    /// Rounds of the velocity solver in a tick. Gymnasium: 180; 60 is faster and lands the same pilots.
    pub velocity_iterations: u32,
    /// At most this many rounds of the position solver in a tick. Gymnasium: 60; with 60 velocity iterations use 20.
    pub position_iterations: u32,
}

impl Settings {
    /// Gymnasium's: 180 velocity and 60 position iterations. Bit parity holds for this one.
    pub const EXACT: Settings =
        Settings { gravity: -10.0, velocity_iterations: 180, position_iterations: 60 };
    /// 60 and 20: about 2.5 times as fast, other bits, for training.
    pub const QUICK: Settings = Settings { gravity: -10.0, velocity_iterations: 60, position_iterations: 20 };
}

impl Default for Settings {
    fn default() -> Self {
        Settings::EXACT
    }
}

/// Where and how a flight begins. The hull is upright and does not spin; the legs hang where Gymnasium puts them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Position of the hull (its origin, not its centre of mass), world units.
    pub x: f64,
    /// See `x`.
    pub y: f64,
    /// Velocity of hull and legs, units/s.
    pub vx: f64,
    /// See `vx`.
    pub vy: f64,
    /// Force on the hull's centre of mass during the first tick, Gymnasium's initial random push: each within ±1000.
    pub push: [f64; 2],
}

impl Start {
    /// At rest at this position, no push.
    pub const fn at(x: f64, y: f64) -> Start {
        Start { x, y, vx: 0.0, vy: 0.0, push: [0.0, 0.0] }
    }
}

/// Throttle of the three engines during one tick: 0 is off, otherwise 0.5 (weakest) to 1 (full). Any combination may burn at once.
///
/// `left` is Gymnasium's action 1 ("left orientation engine"): it pushes and rolls the craft to the left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Engines {
    /// Main engine: upwards along the hull's axis.
    pub main: f64,
    /// The side engine that pushes to the left.
    pub left: f64,
    /// The side engine that pushes to the right.
    pub right: f64,
}

impl Engines {
    /// All off.
    pub const OFF: Engines = Engines { main: 0.0, left: 0.0, right: 0.0 };
    /// Main engine at full throttle.
    pub const MAIN: Engines = Engines { main: 1.0, ..Engines::OFF };
    /// The engine that pushes to the left at full throttle.
    pub const LEFT: Engines = Engines { left: 1.0, ..Engines::OFF };
    /// The engine that pushes to the right at full throttle.
    pub const RIGHT: Engines = Engines { right: 1.0, ..Engines::OFF };

    /// Full throttle where `true`.
    pub const fn burning(main: bool, left: bool, right: bool) -> Engines {
        const fn throttle(on: bool) -> f64 {
            if on { 1.0 } else { 0.0 }
        }
        Engines { main: throttle(main), left: throttle(left), right: throttle(right) }
    }
}

/// Scatter of the engines' push in one tick: two numbers within ±1/30 world units, along and across the hull's axis.
/// The same pair serves every engine that burns in the tick, as in Gymnasium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dispersion([f64; 2]);

impl Dispersion {
    /// No scatter.
    pub const NONE: Dispersion = Dispersion([0.0, 0.0]);

    /// From two uniform numbers in [−1, 1), in the order in which Gymnasium draws them.
    pub const fn from_uniform(draws: [f64; 2]) -> Dispersion {
        Dispersion([draws[0] / SCALE, draws[1] / SCALE])
    }
}

/// Everything that acts on the hull in one tick, beside gravity, legs and ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// What burns.
    pub engines: Engines,
    /// How the push scatters.
    pub dispersion: Dispersion,
    /// Wind: horizontal force on the hull's centre of mass.
    pub wind_force: f64,
    /// Turbulence: torque on the hull, counter-clockwise.
    pub wind_torque: f64,
}

impl Controls {
    /// Engines off, no wind.
    pub const IDLE: Controls =
        Controls { engines: Engines::OFF, dispersion: Dispersion::NONE, wind_force: 0.0, wind_torque: 0.0 };
}

/// Where one of the three bodies is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Position of the body's origin, world units.
    pub x: f32,
    /// See `x`.
    pub y: f32,
    /// Counter-clockwise, 0 is upright; not wrapped.
    pub angle_rad: f32,
    /// Velocity of the centre of mass, units/s.
    pub vx: f32,
    /// See `vx`.
    pub vy: f32,
    /// Angular velocity, rad/s.
    pub omega_rad_s: f32,
}

/// The craft in its world: plain data. A clone is a snapshot, and going on from it gives the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Craft;

impl Craft {
    /// Puts a craft over (or onto) the ground. Legs are placed relative to the hull as Gymnasium places them;
    /// a craft standing still has its hull about 0.6 units above level ground.
    pub fn place(ground: &Ground, start: &Start, settings: Settings) -> Craft {
        let _ = (ground, start, settings);
        todo!()
    }

    /// Lets 1/50 s pass. Order as in Gymnasium: wind, main engine, side engines (left, right), then the physics.
    /// A sleeping craft wakes when an engine fires; wind wakes it too (hand in none while it stands).
    pub fn tick(&mut self, controls: &Controls) {
        let _ = controls;
        todo!()
    }

    /// The hull's motion.
    pub fn hull(&self) -> Motion {
        todo!()
    }

    /// The legs' motion, in Gymnasium's order: the first one is on the **right** of an upright craft.
    pub fn legs(&self) -> [Motion; 2] {
        todo!()
    }

    /// Whether each leg touches the ground, in the order of [`Craft::legs`]; what Gymnasium reports.
    pub fn leg_contacts(&self) -> [bool; 2] {
        todo!()
    }

    /// Whether the hull has touched the ground since the craft was placed: a crash in both tasks.
    pub fn hull_touched(&self) -> bool {
        todo!()
    }

    /// False once the whole craft has lain still for half a second: Gymnasium's sign of a landing.
    pub fn awake(&self) -> bool {
        todo!()
    }
}
