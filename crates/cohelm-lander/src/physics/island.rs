//! What one step solves: the bodies' motion, the hinges' equations and those of the contacts that touch.
//!
//! The work of a step between looking for contacts and looking for impacts. Its stages are functions of their own, so that
//! several worlds can take each of them side by side ([`together`](super::together)).

use super::body::BODIES;
use super::contact_row::{ContactRow, Correction, Velocity};
use super::hinge::Hinge;
use super::position::Position;
use super::relax::{Hinges, Twists};
use super::vector::smaller;
use super::world::Settings;

/// Hull and legs, which their hinges always join, within one step.
#[derive(Clone, Debug)]
pub(crate) struct Island {
    pub positions: [Position; BODIES],
    pub twists: Twists<f32>,
    pub hinges: Hinges<f32>,
    /// Of touching contacts, in the order in which they are solved.
    pub contacts: Vec<ContactRow>,
}

impl Island {
    /// Iterates over the velocities of one world.
    pub fn solve_velocities(&mut self, iterations: u32) {
        let Island { twists, hinges, contacts, .. } = self;
        if contacts.is_empty() {
            return hinges.relax(twists, iterations);
        }
        for _ in 0..iterations {
            hinges.iterate(twists);
            for row in contacts.iter_mut() {
                row.push(twists);
            }
        }
    }

    /// Moves all bodies on with their velocities.
    pub fn drift(&mut self, step_s: f32) {
        for (position, twist) in self.positions.iter_mut().zip(&mut self.twists) {
            let mut velocity = Velocity::of(twist);
            position.drift(&mut velocity, step_s);
            *twist = velocity.twist();
        }
    }

    /// Iterates until overlaps and joint errors are small. True if they became so.
    pub fn correct_positions(&mut self, [first, second]: &[Hinge; 2], settings: &Settings) -> bool {
        let positions = &mut self.positions;
        for _ in 0..settings.position_iterations {
            let mut deepest: f32 = 0.0;
            for row in &self.contacts {
                deepest = smaller(deepest, row.correct(&mut positions[row.body], Correction::STEP));
            }
            let (newer, older) = (second.correct(positions), first.correct(positions));
            if Correction::STEP.tolerates(deepest) && newer && older {
                return true;
            }
        }
        false
    }
}
