//! Continuous collision: nothing tunnels through the ground within a step.
//!
//! After the ordinary step, the earliest impact of any body with any edge is found, the body is put back to that moment,
//! pushed apart, and sent on for the rest of the step; then the next earliest, until there is none.

use super::body::parts;
use super::contact_row::{ContactRow, Correction, Velocity};
use super::distance::Pair;
use super::impact::time_of_impact;
use super::position::Position;
use super::tuning::{MAX_SUB_STEPS, TOI_POSITION_ITERATIONS};
use super::vector::{Rotation, smaller};
use super::world::World;

/// What one step remembers of a contact's impacts.
#[derive(Clone, Copy, Default)]
struct Impacts {
    /// When it comes next, if that has been computed and still holds.
    next: Option<f32>,
    count: u8,
}

/// The impacts of one step.
struct Calendar {
    /// One for each contact of the world, in the same order.
    impacts: Vec<Impacts>,
    /// Up to where the ground has been taken along: Box2D advances its sweep, which stays where it is, like any other.
    ground_alpha: f32,
}

impl World {
    /// Finds and solves the impacts of the step just made.
    pub(super) fn solve_impacts(&mut self, step_s: f32) {
        for body in &mut self.bodies {
            body.sweep.alpha0 = 0.0;
        }
        if self.contacts.is_empty() {
            return;
        }
        let mut calendar =
            Calendar { impacts: vec![Impacts::default(); self.contacts.len()], ground_alpha: 0.0 };
        while let Some((index, alpha)) = self.earliest_impact(&mut calendar) {
            self.solve_impact(index, alpha, step_s, &mut calendar);
            calendar.impacts.resize(self.contacts.len(), Impacts::default());
        }
    }

    /// The contact that comes first and when, as a share of the step.
    fn earliest_impact(&mut self, calendar: &mut Calendar) -> Option<(usize, f32)> {
        let mut earliest = (None, 1.0);
        for index in (0..self.contacts.len()).rev() {
            if !self.contacts[index].enabled || calendar.impacts[index].count > MAX_SUB_STEPS {
                continue;
            }
            let alpha = match calendar.impacts[index].next {
                Some(alpha) => alpha,
                None if self.bodies[self.contacts[index].body].awake => {
                    let alpha = self.impact_of(index, calendar);
                    calendar.impacts[index].next = Some(alpha);
                    alpha
                }
                None => continue,
            };
            if alpha < earliest.1 {
                earliest = (Some(index), alpha);
            }
        }
        let (index, alpha) = earliest;
        index.filter(|_| alpha <= 1.0 - 10.0 * f32::EPSILON).map(|index| (index, alpha))
    }

    /// When this contact's body and edge meet; 1 if they do not in this step.
    fn impact_of(&mut self, index: usize, calendar: &mut Calendar) -> f32 {
        let contact = &self.contacts[index];
        let sweep = &mut self.bodies[contact.body].sweep;
        // Both sweeps must begin at the same moment.
        if sweep.alpha0 < calendar.ground_alpha {
            sweep.advance(calendar.ground_alpha);
        } else {
            calendar.ground_alpha = sweep.alpha0;
        }
        let begin = sweep.alpha0;
        let pair =
            Pair { edge: &self.ground.edges()[contact.edge], corners: parts()[contact.body].shape.corners() };
        time_of_impact(pair, sweep).map_or(1.0, |share| smaller(begin + (1.0 - begin) * share, 1.0))
    }

    /// Puts the body back to the impact and, if it does touch there, solves its contacts alone for the rest of the step.
    fn solve_impact(&mut self, index: usize, alpha: f32, step_s: f32, calendar: &mut Calendar) {
        let body = self.contacts[index].body;
        let (backup, ground_backup) = (self.bodies[body].sweep, calendar.ground_alpha);
        self.bodies[body].rewind(alpha);
        calendar.ground_alpha = alpha;
        self.update_contact(index);
        calendar.impacts[index].next = None;
        calendar.impacts[index].count += 1;
        if !self.contacts[index].touching {
            self.contacts[index].enabled = false;
            self.bodies[body].sweep = backup;
            self.bodies[body].settle();
            calendar.ground_alpha = ground_backup;
            return;
        }
        self.bodies[body].wake();
        let island = self.impact_island(index, body);
        self.solve_island(&island, body, (1.0 - alpha) * step_s);
        let state = &mut self.bodies[body];
        state.refresh_box(&parts()[body], Rotation::of(state.sweep.a0));
        for (contact, impacts) in self.contacts.iter().zip(&mut calendar.impacts) {
            if contact.body == body {
                impacts.next = None;
            }
        }
        self.find_contacts();
    }

    /// The contact itself and every other of the same body that touches at that moment.
    fn impact_island(&mut self, index: usize, body: usize) -> Vec<usize> {
        let mut island = vec![index];
        for other in (0..self.contacts.len()).rev() {
            if other != index && self.contacts[other].body == body {
                self.update_contact(other);
                if self.contacts[other].touching {
                    island.push(other);
                }
            }
        }
        island
    }

    /// Pushes the body out of its contacts, stops it there, and lets it drift for what is left of the step.
    fn solve_island(&mut self, island: &[usize], body: usize, rest_s: f32) {
        let mut rows: Vec<_> = island.iter().map(|index| self.contact_row(*index)).collect();
        let state = &mut self.bodies[body];
        let mut position = Position::of(state);
        let mut velocity = Velocity { linear: state.velocity, omega: state.omega };
        for _ in 0..TOI_POSITION_ITERATIONS {
            let mut deepest: f32 = 0.0;
            for row in &rows {
                deepest = smaller(deepest, row.correct(&mut position, Correction::IMPACT));
            }
            if Correction::IMPACT.tolerates(deepest) {
                break;
            }
        }
        (state.sweep.c0, state.sweep.a0) = (position.center, position.angle_rad);
        for row in &mut rows {
            row.prepare(&position);
        }
        for _ in 0..self.settings.velocity_iterations {
            if stands_still(&mut rows, &mut velocity) {
                break;
            }
        }
        position.drift(&mut velocity, rest_s);
        self.bodies[body].take(&position, velocity);
    }
}

/// One iteration over the velocities of one body's contacts. True if it left everything as it was, to the bit: then so would all
/// that follow.
fn stands_still(rows: &mut [ContactRow], velocity: &mut Velocity) -> bool {
    let before = velocity.bits();
    let mut same = true;
    for row in rows {
        let impulses = row.impulse_bits();
        row.iterate(velocity);
        same &= row.impulse_bits() == impulses;
    }
    same && velocity.bits() == before
}
