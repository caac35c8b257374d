//! A hand-made controller: proportional in place, derivative in motion; a demonstrator and a baseline.
//!
//! It tilts the craft towards the goal, sinks the slower the lower it is, and waits at height while it is still far to
//! the side. Constants were found by search on the flag task; all are in the normalised units of the state.

use super::actions::Burning;
use super::state::{LEFT_LEG, MAIN_ENGINE, RIGHT_LEG, SPIN, STATE_LENGTH, TILT, VX, VY, X, Y};

/// Tilt (rad) wanted for a unit of distance: more is hastier.
const TILT_PER_DISTANCE: f64 = 0.649;
/// Tilt wanted against a unit of horizontal velocity: less overshoots.
const TILT_PER_VELOCITY: f64 = 0.632;
/// Most tilt ever wanted.
const LARGEST_TILT: f64 = 0.841;
/// Tilt that a unit of spin counts for: less swings.
const SPIN_DAMPING: f64 = 0.944;
/// Sinking wanted at the goal's height.
const SINK_AT_GOAL: f64 = 0.078;
/// Further sinking for a unit of height: more is hastier.
const SINK_PER_HEIGHT: f64 = 0.589;
/// Height to keep for each unit of distance beyond [`NEAR`]: flies over the terrain in between.
const HEIGHT_PER_DISTANCE: f64 = 1.36;
/// Distance within which it comes straight down: the pads' half width is 0.15.
const NEAR: f64 = 0.1;
/// Deviation of the vertical velocity at which the main engine goes on, and off again.
const MAIN_BAND: f64 = 0.078;
/// Deviation of the tilt at which a side engine burns.
const SIDE_BAND: f64 = 0.038;
/// Most sinking ever wanted.
const LARGEST_SINK: f64 = 0.344;

/// Which engines should burn now to land at `goal`.
pub(crate) fn wanted(state: &[f64; STATE_LENGTH], goal: [f64; 2]) -> Burning {
    if state[LEFT_LEG] > 0.0 && state[RIGHT_LEG] > 0.0 {
        return Burning::NONE;
    }
    let (dx, dy) = (state[X] - goal[0], state[Y] - goal[1]);
    main(state, dx, dy).with(side(state, dx))
}

fn side(state: &[f64; STATE_LENGTH], dx: f64) -> Burning {
    let tilt = (TILT_PER_DISTANCE * dx + TILT_PER_VELOCITY * state[VX]).clamp(-LARGEST_TILT, LARGEST_TILT);
    let error = tilt - state[TILT] - SPIN_DAMPING * state[SPIN];
    if error > SIDE_BAND {
        Burning::LEFT
    } else if error < -SIDE_BAND {
        Burning::RIGHT
    } else {
        Burning::NONE
    }
}

fn main(state: &[f64; STATE_LENGTH], dx: f64, dy: f64) -> Burning {
    let above = f64::max(dy - HEIGHT_PER_DISTANCE * f64::max(dx.abs() - NEAR, 0.0), -0.1);
    let sinking = f64::min(SINK_AT_GOAL + SINK_PER_HEIGHT * above, LARGEST_SINK);
    let too_slow = -sinking - state[VY];
    let threshold = if state[MAIN_ENGINE] > 0.0 { -MAIN_BAND } else { MAIN_BAND };
    if too_slow > threshold { Burning::MAIN } else { Burning::NONE }
}
