//! Looking ahead: a copy of the plant is flown on, to see whether it stays whole.
//!
//! The copy has the plant's own draws to come (the lander's scattering thrust), so that it foresees them too. It wants
//! what the co-pilot infers, not what the pilot wants, so that nothing about the pilot's goal comes out of it.

use crate::action::Action;
use crate::arbitration::LookAhead;
use crate::intent::Belief;
use crate::plant::{Ending, Plant, View};
use crate::value::ValueModel;
use std::cell::RefCell;

/// Flights ahead from where a plant is now, flown by the robot towards one goal.
pub struct Ahead<'a> {
    plant: &'a dyn Plant,
    // A rule gets nothing that it could change, but a value model works in memory of its own.
    robot: RefCell<&'a mut dyn ValueModel>,
    belief: &'a Belief,
    candidates: &'a [Action],
}

impl<'a> Ahead<'a> {
    /// From where `plant` is now; `robot` flies to the goal that is taken, or imagined, after one of the candidates.
    pub fn new(
        plant: &'a dyn Plant,
        robot: &'a mut dyn ValueModel,
        belief: &'a Belief,
        candidates: &'a [Action],
    ) -> Self {
        Self { plant, robot: RefCell::new(robot), belief, candidates }
    }
}

impl LookAhead for Ahead<'_> {
    fn is_safe(&self, candidate: usize, hold: u32, horizon: u32) -> bool {
        let (Some(mut copy), Some(&held)) = (self.plant.snapshot(), self.candidates.get(candidate)) else {
            return false;
        };
        let goals = self.plant.view().goals;
        let taken = self.belief.goal_among(goals);
        // How a copy fares whose pilot still wants the true goal could tell which that is.
        if !copy.set_pilot_goal(taken) && goals.len() > 1 {
            return false;
        }
        // The robot sees this one goal, whichever come and go on the way.
        let goal = self.belief.imagined_goal().or(goals.get(taken));
        let goal = goal.map_or(&[][..], std::slice::from_ref);
        for tick in 0..horizon {
            let action = if tick < hold {
                held
            } else {
                let mut robot = self.robot.borrow_mut();
                let values = robot.estimate(&View { goals: goal, ..copy.view() }, 0, None);
                values.candidates()[values.best()]
            };
            match copy.step(Some(action)).ending {
                Some(Ending::Crash | Ending::OutOfBounds) => return false,
                Some(_) => return true,
                None => {}
            }
        }
        true
    }
}
