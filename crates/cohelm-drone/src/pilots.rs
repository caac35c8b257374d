//! What a person who has practised tries to do with the drone: lean against drift towards the pad, and come down slowly.

use crate::state::{DOWN, LEFT, RIGHT, ROOM, SPIN, TILT, UP, VX, VY, X, Y};
use crate::{UNIT_M, UNIT_MPS, UNIT_RAD_S};
use cohelm::action::ActionSpace;
use cohelm::human::{Axis, Plan, Seen, Skill};
use cohelm::keys::{NoControl, control_named, controls};
use cohelm::random::Draws;

/// Tilt wanted for a metre beside the pad, rad.
const LEAN_PER_M: f64 = 0.07;
/// Tilt wanted against a metre a second of drift, rad.
const LEAN_PER_MPS: f64 = 0.13;
/// The largest tilt that is wanted, rad.
const LARGEST_LEAN: f64 = 0.35;
/// An average person's dead band of the tilt, rad.
const LEAN_DEAD_BAND: f64 = 0.08;
/// Descent wanted close to the pad, m/s, and further descent a metre above it.
const DESCENT: [f64; 2] = [0.4, 0.3];
/// The fastest descent that is wanted, m/s.
const FASTEST_DESCENT: f64 = 2.0;
/// An average person's dead band of the vertical speed, m/s.
const DESCENT_DEAD_BAND: f64 = 0.3;
/// Beside the pad by more than this, m, and lower than [`WAITING_M`] over it, a person holds the height.
const BESIDE_M: f64 = 1.2;
/// See [`BESIDE_M`].
const WAITING_M: f64 = 1.5;

/// How one person flies the drone.
#[derive(Clone, Debug)]
pub struct Flying {
    /// Factor on the lean wanted, 0.7 to 1.4. Low: drifts; high: swings.
    lean: f64,
    /// Seconds of spin that are felt as tilt, 0 to 0.4. At 0 the tilt overshoots.
    spin_sense_s: f64,
    /// Factor on the descent wanted, 0.8 to 1.4.
    descent: f64,
    plan: Plan,
}

impl Flying {
    /// One person's, at the keys of the drone's actions; refused where a key is missing.
    pub fn draw(space: &ActionSpace, draws: &mut Draws) -> Result<Self, NoControl> {
        let key = |name, on_axis| control_named(space, name, on_axis);
        let (left, right) = (key("left", "x −")?, key("right", "x +")?);
        let (down, up) = (key("down", "y −")?, key("up", "y +")?);
        let axis = |name, plus, minus| Axis {
            name,
            plus: Some(plus),
            minus: Some(minus),
            release: 0.3,
            droppable: false,
        };
        let mut shown = vec![None; controls(space).len()];
        for (control, lamp) in [(left, LEFT), (right, RIGHT), (down, DOWN), (up, UP)] {
            shown[usize::from(control)] = Some(lamp);
        }
        let axes = vec![axis("lateral", left, right), axis("vertical", up, down)];
        let plan = Plan { axes, moving: vec![X, Y, VX, VY, TILT, SPIN, ROOM], judged: vec![VX, VY], shown };
        let (lean, spin_sense_s) = (draws.uniform(0.7, 1.4), draws.uniform(0.0, 0.4));
        Ok(Self { lean, spin_sense_s, descent: draws.uniform(0.8, 1.4), plan })
    }
}

impl Skill for Flying {
    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn errors(&self, seen: &Seen<'_>, errors: &mut [f64]) {
        let state = seen.state;
        let (beside, height) = (UNIT_M * (state[X] - seen.goal[0]), UNIT_M * (state[Y] - seen.goal[1]));
        let wanted = self.lean * (LEAN_PER_M * beside + LEAN_PER_MPS * UNIT_MPS * state[VX]);
        let lean = wanted.clamp(-LARGEST_LEAN, LARGEST_LEAN);
        errors[0] = (lean - state[TILT] - self.spin_sense_s * UNIT_RAD_S * state[SPIN]) / LEAN_DEAD_BAND;
        let waits = beside.abs() > BESIDE_M && height < WAITING_M;
        let sink = self.descent * (DESCENT[0] + DESCENT[1] * height.max(0.0));
        let climb = if waits { 0.3 } else { -sink.min(FASTEST_DESCENT) };
        errors[1] = (climb - UNIT_MPS * state[VY]) / DESCENT_DEAD_BAND;
    }
}

/// One person's skill at the keys of one of the drone's action sets: what the drone's entry names.
pub fn skill(space: &ActionSpace, draws: &mut Draws) -> Result<Box<dyn Skill>, String> {
    let skill = Flying::draw(space, draws).map_err(|error| error.to_string())?;
    Ok(Box::new(skill))
}
