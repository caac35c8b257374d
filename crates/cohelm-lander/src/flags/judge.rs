//! When a flight of the flag task is over, and what each tick of it is worth.

use super::actions::Burning;
use super::state::{LEFT_LEG, RIGHT_LEG, STATE_LENGTH, TILT, VX, VY, X, Y};
use crate::craft::Craft;
use cohelm::plant::Ending;

/// Ticks in a row that the craft must rest on both legs to have landed: a bounce is shorter, and Gymnasium's own sign
/// (the physics falls asleep) never comes while an engine burns.
const REST_TICKS: u32 = 10;
/// Speed below which each component of the hull's velocity counts as rest: units/s.
const REST_SPEED: f32 = 0.15;
/// The same for its spin: rad/s.
const REST_SPIN: f32 = 0.15;
/// Out of bounds is this far to a side, normalised: the hull's middle over the edge of the world.
const FARTHEST_X: f64 = 1.0;
/// Out of bounds is above this height, normalised: 17.3 world units, a third above what Gymnasium shows.
const HIGHEST_Y: f64 = 2.0;

/// Cost of each tick, so that arriving sooner is better.
const TICK_COST: f64 = 0.003;
/// Cost of each engine turned on or off, so that equal flights prefer quiet engines.
const SWITCHING_COST: f64 = 0.002;
/// Reward for landing at the goal.
const GOAL_REWARD: f64 = 3.0;
/// Cost of every other end but the time limit.
const FAILURE_COST: f64 = 1.0;

/// How long the craft has been resting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Rest {
    ticks: u32,
}

impl Rest {
    /// Takes the next tick in.
    pub fn update(&mut self, craft: &Craft) {
        let hull = craft.hull();
        let still =
            hull.vx.abs() < REST_SPEED && hull.vy.abs() < REST_SPEED && hull.omega_rad_s.abs() < REST_SPIN;
        let rests = still && craft.legs_touching() == [true; 2];
        self.ticks = if rests { self.ticks.saturating_add(1) } else { 0 };
    }

    /// Whether that is long enough.
    pub fn has_landed(self) -> bool {
        self.ticks >= REST_TICKS
    }
}

/// Whether the craft has left the space it may be in.
pub(crate) fn is_out_of_bounds(state: &[f64; STATE_LENGTH]) -> bool {
    state[X].abs() >= FARTHEST_X || state[Y] > HIGHEST_Y
}

/// How good it is to be in a state, for a goal: Gymnasium's shaping over 100 (at rest on both legs at the goal 0.2,
/// otherwise less).
pub(crate) fn potential(state: &[f64; STATE_LENGTH], goal: [f64; 2]) -> f64 {
    let length = |x: f64, y: f64| (x * x + y * y).sqrt();
    let distance = length(state[X] - goal[0], state[Y] - goal[1]);
    let legs = state[LEFT_LEG] + state[RIGHT_LEG];
    0.1 * legs - distance - length(state[VX], state[VY]) - state[TILT].abs()
}

/// What a tick is worth apart from the shaping.
pub(crate) fn worth(before: Burning, now: Burning, ending: Option<Ending>) -> f64 {
    let end = match ending {
        Some(Ending::Goal) => GOAL_REWARD,
        Some(Ending::Crash | Ending::OutOfBounds | Ending::Elsewhere) => -FAILURE_COST,
        Some(Ending::TimeLimit | Ending::Abandoned) | None => 0.0,
    };
    end - TICK_COST - SWITCHING_COST * f64::from(before.differences(now))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_failures_cost_and_only_the_goal_pays() {
        for (ending, expected) in [
            (Ending::Goal, 3.0),
            (Ending::Elsewhere, -1.0),
            (Ending::Crash, -1.0),
            (Ending::OutOfBounds, -1.0),
            (Ending::TimeLimit, 0.0),
            (Ending::Abandoned, 0.0),
        ] {
            let end = worth(Burning::NONE, Burning::NONE, Some(ending)) + TICK_COST;
            assert!((end - expected).abs() < 1e-12, "{ending:?}: {end}");
        }
    }

    #[test]
    fn every_engine_turned_on_or_off_costs() {
        let cost = |before, now| -(worth(before, now, None) + TICK_COST);
        assert_eq!(cost(Burning::MAIN, Burning::MAIN), 0.0);
        assert!((cost(Burning::LEFT, Burning::MAIN) - 2.0 * SWITCHING_COST).abs() < 1e-12);
    }

    #[test]
    fn the_potential_falls_with_distance_speed_and_tilt() {
        let mut standing = [0.0; STATE_LENGTH];
        (standing[LEFT_LEG], standing[RIGHT_LEG]) = (1.0, 1.0);
        assert_eq!(potential(&standing, [0.0, 0.0]), 0.2);
        for (worse, by) in [([0.3, 0.4, 0.0], 0.5), ([0.0, 0.0, -0.7], 0.7)] {
            let mut state = standing;
            (state[X], state[Y], state[TILT]) = (worse[0], worse[1], worse[2]);
            assert!((potential(&state, [0.0, 0.0]) - 0.2 + by).abs() < 1e-12);
        }
    }
}
