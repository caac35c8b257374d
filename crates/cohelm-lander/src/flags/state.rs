//! What pilot and co-pilot see of the craft: eleven numbers in Gymnasium's normalisation.
//!
//! | index | what | one unit is |
//! |---|---|---|
//! | [`X`] | right of the middle of the world | 10 world units (half the world's width) |
//! | [`Y`] | above the hull's height when standing at a quarter of the world's height | 6.67 world units (half the world's **height**) |
//! | [`VX`], [`VY`] | velocity of the centre of mass | 5 and 7.5 units/s |
//! | [`TILT`] | counter-clockwise, so that a craft tilted to the left is positive | 1 rad |
//! | [`SPIN`] | counter-clockwise | 2.5 rad/s |
//! | [`LEFT_LEG`], [`RIGHT_LEG`] | touches the ground | 0 or 1 |
//! | [`LEFT_ENGINE`], [`MAIN_ENGINE`], [`RIGHT_ENGINE`] | throttle of the last tick | 0 is off, 1 is full |
//!
//! Units of velocity are not units of position a second: they are Gymnasium's. Goals are given in the units of [`X`]
//! and [`Y`], at the place of the hull of a craft that stands there, and every distance is Euclidean in these units.
//! Gymnasium lists the right leg first; here left comes first, as among the engines.

use crate::craft::{Craft, Engines, WORLD_HEIGHT, WORLD_WIDTH};

/// Length of the state vector.
pub const STATE_LENGTH: usize = 11;
/// Horizontal position.
pub const X: usize = 0;
/// Height.
pub const Y: usize = 1;
/// Horizontal velocity.
pub const VX: usize = 2;
/// Vertical velocity.
pub const VY: usize = 3;
/// Tilt.
pub const TILT: usize = 4;
/// Spin.
pub const SPIN: usize = 5;
/// Left leg on the ground.
pub const LEFT_LEG: usize = 6;
/// Right leg on the ground.
pub const RIGHT_LEG: usize = 7;
/// Throttle of the left engine.
pub const LEFT_ENGINE: usize = 8;
/// Throttle of the main engine.
pub const MAIN_ENGINE: usize = 9;
/// Throttle of the right engine.
pub const RIGHT_ENGINE: usize = 10;

/// Height of the hull above the ground of a standing craft that the normalisation assumes, world units: Gymnasium's
/// 18 pixels.
pub(crate) const STANDING_HEIGHT: f64 = 18.0 / 30.0;
/// World position of the normalised origin: the middle, standing at a quarter of the world's height.
pub(crate) const ORIGIN: [f64; 2] = [WORLD_WIDTH / 2.0, WORLD_HEIGHT / 4.0 + STANDING_HEIGHT];
/// World units that a normalised unit of position is.
pub(crate) const SCALE_OF_POSITION: [f64; 2] = [WORLD_WIDTH / 2.0, WORLD_HEIGHT / 2.0];
/// Units/s that a normalised unit of velocity is: Gymnasium multiplies by half the world's size and divides by 50.
pub(crate) const SCALE_OF_VELOCITY: [f64; 2] = [50.0 / SCALE_OF_POSITION[0], 50.0 / SCALE_OF_POSITION[1]];
/// rad/s that a normalised unit of spin is.
pub(crate) const SCALE_OF_SPIN: f64 = 2.5;

/// A world position in normalised units.
pub(crate) fn position_of_world(world: [f64; 2]) -> [f64; 2] {
    core::array::from_fn(|i| (world[i] - ORIGIN[i]) / SCALE_OF_POSITION[i])
}

/// The state of a craft that has burnt `engines` in the last tick.
pub(crate) fn observe(craft: &Craft, engines: &Engines) -> [f64; STATE_LENGTH] {
    let hull = craft.hull();
    let [x, y] = position_of_world([hull.x.into(), hull.y.into()]);
    let [right_leg, left_leg] = craft.legs_touching().map(|touches| f64::from(u8::from(touches)));
    let mut state = [0.0; STATE_LENGTH];
    (state[X], state[Y]) = (x, y);
    state[VX] = f64::from(hull.vx) / SCALE_OF_VELOCITY[0];
    state[VY] = f64::from(hull.vy) / SCALE_OF_VELOCITY[1];
    state[TILT] = hull.angle_rad.into();
    state[SPIN] = f64::from(hull.omega_rad_s) / SCALE_OF_SPIN;
    (state[LEFT_LEG], state[RIGHT_LEG]) = (left_leg, right_leg);
    (state[LEFT_ENGINE], state[MAIN_ENGINE], state[RIGHT_ENGINE]) =
        (engines.left, engines.main, engines.right);
    state
}

/// The mirrored state has component `.0` of the state, times `.1`, at each place.
pub(crate) const MIRRORED: [(usize, f32); STATE_LENGTH] = [
    (X, -1.0),
    (Y, 1.0),
    (VX, -1.0),
    (VY, 1.0),
    (TILT, -1.0),
    (SPIN, -1.0),
    (RIGHT_LEG, 1.0),
    (LEFT_LEG, 1.0),
    (RIGHT_ENGINE, 1.0),
    (MAIN_ENGINE, 1.0),
    (LEFT_ENGINE, 1.0),
];
