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
//! assert!(craft.hull().y > 8.0 && craft.awake(), "the main engine is stronger than gravity");
//! # Ok::<(), cohelm_lander::craft::GroundError>(())
//! ```

use crate::physics::body::{BODIES, Body, HULL, LEG_AWAY, LEG_DOWN, LEG_START_RAD, LEGS, parts};
pub use crate::physics::body::{HULL_OUTLINE, LEG_OUTLINE, SCALE};
pub use crate::physics::ground::{Ground, GroundError, WORLD_WIDTH};
use crate::physics::vector::vec2;
pub use crate::physics::world::Settings;
use crate::physics::world::World;

/// Ticks in a second.
pub const TICKS_PER_S: f64 = 50.0;
/// Length of one tick in seconds.
pub const TICK_S: f64 = 1.0 / TICKS_PER_S;
/// Height of Gymnasium's world, in world units.
pub const WORLD_HEIGHT: f64 = 400.0 / SCALE;
/// Tilt at which the legs of a flying craft come to hang: the hinge's limit less the solver's tolerance, rad.
const LEG_HANGING_RAD: f64 = 0.396;
/// Impulse of the main engine per world unit of its arm and tick, at full throttle.
const MAIN_ENGINE_POWER: f64 = 13.0;
/// The same for a side engine.
const SIDE_ENGINE_POWER: f64 = 0.6;
/// Where the main engine pushes, below the hull's origin.
const MAIN_ENGINE_BELOW: f64 = 4.0 / SCALE;
/// Where a side engine pushes, beside the hull's origin, pixels.
const SIDE_ENGINE_AWAY: f64 = 12.0;
/// Where a side engine pushes, above the hull's origin, pixels.
const SIDE_ENGINE_HEIGHT: f64 = 14.0;
/// Gymnasium's formula has 17 in one place where the height of 14 is presumably meant, so that the torque of the side
/// engines depends on the tilt. It is part of the task.
const SIDE_ENGINE_SKEW: f64 = 17.0;

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
pub struct Craft {
    world: World,
}

impl Craft {
    /// Puts a craft over (or onto) the ground. Legs are placed relative to the hull as Gymnasium places them;
    /// a craft standing still has its hull about 0.6 units above level ground.
    pub fn place(ground: &Ground, start: &Start, settings: Settings) -> Craft {
        let leg = |index: usize, side: f64| {
            Body::at(&parts()[index], start.x - side * LEG_AWAY, start.y, side * LEG_START_RAD)
        };
        Craft::assemble(ground, start, settings, [leg(LEGS[0], -1.0), leg(LEGS[1], 1.0)])
    }

    /// Like [`Craft::place`], but the legs hang already as they do after a moment of flight. For starts near the ground:
    /// where Gymnasium puts the legs they are still beside the hull, which would touch the ground before them.
    pub fn place_hanging(ground: &Ground, start: &Start, settings: Settings) -> Craft {
        let (sin, cos) = (libm::sin(LEG_HANGING_RAD), libm::cos(LEG_HANGING_RAD));
        let away = LEG_AWAY * cos + LEG_DOWN * sin;
        let down = LEG_DOWN * cos - LEG_AWAY * sin;
        let leg = |index: usize, side: f64| {
            Body::at(&parts()[index], start.x - side * away, start.y - down, -side * LEG_HANGING_RAD)
        };
        Craft::assemble(ground, start, settings, [leg(LEGS[0], -1.0), leg(LEGS[1], 1.0)])
    }

    fn assemble(ground: &Ground, start: &Start, settings: Settings, [right, left]: [Body; 2]) -> Craft {
        let hull = Body::at(&parts()[HULL], start.x, start.y, 0.0);
        let mut bodies: [Body; BODIES] = [hull, right, left];
        for body in &mut bodies {
            body.velocity = vec2(start.vx as f32, start.vy as f32);
        }
        bodies[HULL].force = vec2(start.push[0] as f32, start.push[1] as f32);
        Craft { world: World::new(ground.clone(), settings, bodies) }
    }

    /// Lets 1/50 s pass. Order as in Gymnasium: wind, main engine, side engines (left, right), then the physics.
    /// A sleeping craft wakes when an engine fires; wind wakes it too (hand in none while it stands).
    pub fn tick(&mut self, controls: &Controls) {
        self.steer(controls);
        self.coast();
    }

    /// The first half of a tick: wind and engines act on the hull.
    pub(crate) fn steer(&mut self, controls: &Controls) {
        self.blow(controls);
        self.fire(controls);
    }

    /// The second half of a tick: time passes.
    pub(crate) fn coast(&mut self) {
        self.world.step(TICK_S as f32);
    }

    /// As many calls of [`Craft::coast`], with their bits, in less time.
    #[cfg(feature = "lanes")]
    pub(crate) fn coast_together<'a>(crafts: impl Iterator<Item = &'a mut Craft>) {
        let mut worlds: Vec<_> = crafts.map(|craft| &mut craft.world).collect();
        crate::physics::together::step(&mut worlds, TICK_S as f32);
    }

    fn blow(&mut self, controls: &Controls) {
        if controls.wind_force == 0.0 && controls.wind_torque == 0.0 {
            return;
        }
        let hull = &mut self.world.bodies[HULL];
        hull.wake();
        hull.force += vec2(controls.wind_force as f32, 0.0);
        hull.torque += controls.wind_torque as f32;
    }

    /// Gymnasium's formulas, in f64 as there; Box2D takes the results in f32.
    fn fire(&mut self, controls: &Controls) {
        let Engines { main, left, right } = controls.engines;
        if main == 0.0 && left == 0.0 && right == 0.0 {
            return;
        }
        let hull = self.hull();
        let angle = f64::from(hull.angle_rad);
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let Dispersion([along, across]) = controls.dispersion;
        let (x, y) = (f64::from(hull.x), f64::from(hull.y));
        if main > 0.0 {
            let arm = MAIN_ENGINE_BELOW + 2.0 * along;
            let (ox, oy) = (sin * arm + -cos * across, -cos * arm - sin * across);
            let strength = |offset: f64| -offset * MAIN_ENGINE_POWER * main;
            self.push([strength(ox), strength(oy)], [x + ox, y + oy]);
        }
        for (direction, throttle) in [(-1.0, left), (1.0, right)] {
            if throttle > 0.0 {
                let arm = 3.0 * across + direction * SIDE_ENGINE_AWAY / SCALE;
                let (ox, oy) = (sin * along + -cos * arm, -cos * along - sin * arm);
                let strength = |offset: f64| -offset * SIDE_ENGINE_POWER * throttle;
                let at = [x + ox - sin * SIDE_ENGINE_SKEW / SCALE, y + oy + cos * SIDE_ENGINE_HEIGHT / SCALE];
                self.push([strength(ox), strength(oy)], at);
            }
        }
    }

    /// An impulse on the hull at a point of the world.
    fn push(&mut self, impulse: [f64; 2], at: [f64; 2]) {
        let narrow = |[x, y]: [f64; 2]| vec2(x as f32, y as f32);
        self.world.bodies[HULL].push(&parts()[HULL], narrow(impulse), narrow(at));
    }

    /// The hull's motion.
    pub fn hull(&self) -> Motion {
        Motion::of(&self.world.bodies[HULL])
    }

    /// The legs' motion, in Gymnasium's order: the first one is on the **right** of an upright craft.
    pub fn legs(&self) -> [Motion; 2] {
        LEGS.map(|leg| Motion::of(&self.world.bodies[leg]))
    }

    /// Whether each leg touches the ground as Gymnasium reports it, in the order of [`Craft::legs`].
    pub fn leg_contacts(&self) -> [bool; 2] {
        self.world.leg_contacts
    }

    /// Whether each leg really touches the ground, in the order of [`Craft::legs`]. Gymnasium's report misses a leg that
    /// stands where two edges meet and has let go of one of them.
    pub fn legs_touching(&self) -> [bool; 2] {
        LEGS.map(|leg| self.world.touches(leg))
    }

    /// Whether the hull has touched the ground since the craft was placed: a crash in both tasks.
    pub fn hull_touched(&self) -> bool {
        self.world.hull_touched
    }

    /// False once the whole craft has lain still for half a second: Gymnasium's sign of a landing.
    pub fn awake(&self) -> bool {
        self.world.bodies[HULL].awake
    }
}

#[cfg(test)]
impl Craft {
    pub(crate) fn world(&self) -> &World {
        &self.world
    }
}

impl Motion {
    fn of(body: &Body) -> Motion {
        Motion {
            x: body.place.origin.x,
            y: body.place.origin.y,
            angle_rad: body.sweep.a,
            vx: body.velocity.x,
            vy: body.velocity.y,
            omega_rad_s: body.omega,
        }
    }
}
