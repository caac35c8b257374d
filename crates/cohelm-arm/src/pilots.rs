//! What a person who has practised tries to do with the arm: move the hand towards the cup, and slow down before it.

use crate::state::{DOWN, LEFT, RIGHT, UP, VX, VY, X, Y};
use crate::{UNIT_M, UNIT_MPS};
use cohelm::action::ActionSpace;
use cohelm::human::{Axis, Plan, Seen, Skill};
use cohelm::keys::{NoControl, control_named, controls};
use cohelm::random::Draws;

/// An average person's dead band of the hand's place, m.
const PLACE_DEAD_BAND: f64 = 0.04;

/// How one person reaches.
#[derive(Clone, Debug)]
pub struct Reaching {
    /// How far ahead the hand's motion is carried before a key is let go, s, 0.3 to 0.8. Low: runs into cups; high: stops
    /// early and taps its way.
    foresight_s: f64,
    plan: Plan,
}

impl Reaching {
    /// One person's, at the keys of the arm's actions; refused where a key is missing.
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
        let axes = vec![axis("aside", right, left), axis("away", up, down)];
        let plan = Plan { axes, moving: vec![X, Y, VX, VY], judged: vec![VX, VY], shown };
        Ok(Self { foresight_s: draws.uniform(0.3, 0.8), plan })
    }
}

impl Skill for Reaching {
    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn errors(&self, seen: &Seen<'_>, errors: &mut [f64]) {
        for (i, velocity) in [VX, VY].into_iter().enumerate() {
            let gap = UNIT_M * (seen.goal[i] - seen.state[i]);
            errors[i] = (gap - self.foresight_s * UNIT_MPS * seen.state[velocity]) / PLACE_DEAD_BAND;
        }
    }
}

/// One person's skill at the keys of one of the arm's action sets: what the arm's entry names.
pub fn skill(space: &ActionSpace, draws: &mut Draws) -> Result<Box<dyn Skill>, String> {
    let skill = Reaching::draw(space, draws).map_err(|error| error.to_string())?;
    Ok(Box::new(skill))
}
