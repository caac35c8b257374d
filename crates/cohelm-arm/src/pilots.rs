//! What a person who has practised tries to do with the arm: move the hand towards the cup, and slow down before it.

use crate::state::{DOWN, LEFT, RIGHT, UP, VX, VY, X, Y};
use crate::{SPEED_MPS, TOUCH_M, UNIT_M, UNIT_MPS};
use cohelm::action::ActionSpace;
use cohelm::human::{Axis, Plan, Seen, Skill};
use cohelm::keys::controls;
use cohelm::random::Draws;

/// Speed wanted for a metre of distance, 1/s.
const APPROACH_PER_S: f64 = 1.2;
/// An average person's dead band of the hand's speed, m/s.
const SPEED_DEAD_BAND: f64 = 0.07;

/// How one person reaches.
#[derive(Clone, Debug)]
pub struct Reaching {
    /// Factor on the speed wanted, 0.6 to 1.2. Low: creeps; high: knocks cups over.
    haste: f64,
    plan: Plan,
}

impl Reaching {
    /// One person's, at the keys of the arm's actions; refused where a key is missing.
    pub fn draw(space: &ActionSpace, draws: &mut Draws) -> Result<Self, String> {
        let known = controls(space);
        let key = |name: &str, on_axis: &str| {
            let found = known.iter().position(|control| control.name == name || control.name == on_axis);
            found.map(|index| index as u8).ok_or_else(|| format!("steering the hand takes a key for {name:?}"))
        };
        let (left, right) = (key("left", "x −")?, key("right", "x +")?);
        let (down, up) = (key("down", "y −")?, key("up", "y +")?);
        let axis = |name, plus, minus| Axis { name, plus: Some(plus), minus: Some(minus), release: 0.3, droppable: false };
        let mut shown = vec![None; known.len()];
        for (control, lamp) in [(left, LEFT), (right, RIGHT), (down, DOWN), (up, UP)] {
            shown[usize::from(control)] = Some(lamp);
        }
        let axes = vec![axis("aside", right, left), axis("away", up, down)];
        let plan = Plan { axes, moving: vec![X, Y, VX, VY], judged: vec![VX, VY], shown };
        Ok(Self { haste: draws.uniform(0.6, 1.2), plan })
    }
}

impl Skill for Reaching {
    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn errors(&self, seen: &Seen<'_>, errors: &mut [f64]) {
        let gap = [0, 1].map(|i| UNIT_M * (seen.goal[i] - seen.state[i]));
        let far = libm::sqrt(gap[0] * gap[0] + gap[1] * gap[1]);
        let speed = (self.haste * APPROACH_PER_S * (far - 0.5 * TOUCH_M).max(0.0)).min(SPEED_MPS);
        for (i, velocity) in [VX, VY].into_iter().enumerate() {
            let wanted = speed * gap[i] / far.max(1e-9);
            errors[i] = (wanted - UNIT_MPS * seen.state[velocity]) / SPEED_DEAD_BAND;
        }
    }
}
