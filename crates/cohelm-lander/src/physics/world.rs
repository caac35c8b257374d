//! The world: three bodies, two hinges, the ground, and one step of time.

use super::body::{BODIES, Body, HULL, LEGS, parts};
use super::contact::{Change, Contact};
use super::contact_row::{ContactRow, Velocity};
use super::ground::Ground;
use super::hinge::Hinge;
use super::island::Island;
use super::position::Position;
use super::relax::{Hinges, Twists};
use super::tuning::{MAX_ROTATION, MAX_TRANSLATION, SLEEP_SPEED, SLEEP_SPIN, TIME_TO_SLEEP_S};
use super::vector::{Transform, Vec2, smaller, vec2};

/// How the world is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Vertical acceleration, units/s². Gymnasium: −10.
    pub gravity: f64,
    /// Rounds of the velocity solver in a tick. Gymnasium: 180; 60 is faster and lands the same pilots.
    pub velocity_iterations: u32,
    /// At most this many rounds of the position solver in a tick. Gymnasium: 60; with 60 velocity iterations use 20.
    pub position_iterations: u32,
}

impl Settings {
    /// Gymnasium's: 180 velocity and 60 position iterations. Bit parity holds for this one.
    pub const EXACT: Settings =
        Settings { gravity: -10.0, velocity_iterations: 180, position_iterations: 60 };
    /// 60 and 20: faster, other bits, for training.
    pub const QUICK: Settings = Settings { gravity: -10.0, velocity_iterations: 60, position_iterations: 20 };
}

impl Default for Settings {
    fn default() -> Self {
        Settings::EXACT
    }
}

/// Plain data; a clone goes on with the same bits.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct World {
    pub(super) ground: Ground,
    pub(super) settings: Settings,
    pub(crate) bodies: [Body; BODIES],
    pub(super) hinges: [Hinge; 2],
    /// Oldest first. Box2D goes through its list from the newest, and so does everything here.
    pub(super) contacts: Vec<Contact>,
    /// Nothing has been stepped yet: no contacts were looked for and no impulses are known.
    fresh: bool,
    /// What Gymnasium's contact listener notes: a leg's mark is set when a contact begins and cleared when one ends, even if
    /// another edge still holds it.
    pub(crate) leg_contacts: [bool; 2],
    pub(crate) hull_touched: bool,
}

impl World {
    pub fn new(ground: Ground, settings: Settings, bodies: [Body; BODIES]) -> World {
        World {
            ground,
            settings,
            bodies,
            hinges: Hinge::both(),
            contacts: Vec::new(),
            fresh: true,
            leg_contacts: [false; 2],
            hull_touched: false,
        }
    }

    /// Lets `step_s` seconds pass: contacts, velocities, positions, then impacts within the step.
    pub fn step(&mut self, step_s: f32) {
        if let Some(mut island) = self.begin_step(step_s) {
            island.solve_velocities(self.settings.velocity_iterations);
            self.move_bodies(&mut island, step_s);
        }
        self.end_step(step_s);
    }

    /// Up to the iterations over velocities, which are left to the caller. `None` when everything sleeps.
    pub fn begin_step(&mut self, step_s: f32) -> Option<Island> {
        // Box2D scales last step's impulses by the ratio of the two steps' lengths; 0 in the first step.
        let step_ratio = if self.fresh { 0.0 } else { (1.0 / step_s) * step_s };
        if std::mem::take(&mut self.fresh) {
            self.find_contacts();
        }
        self.update_contacts();
        let order = self.walk()?;
        for body in &mut self.bodies {
            body.wake();
        }
        Some(self.island(order, step_s, step_ratio))
    }

    /// From the iterations over velocities on: everything that is awake or joined to it moves.
    pub fn move_bodies(&mut self, island: &mut Island, step_s: f32) {
        self.store_impulses(island);
        island.drift(step_s);
        let settled = island.correct_positions(&self.hinges, &self.settings);
        for (index, (body, part)) in self.bodies.iter_mut().zip(parts()).enumerate() {
            let sweep = &mut body.sweep;
            (sweep.c0, sweep.a0) = (sweep.c, sweep.a);
            let rotation = body.place.rotation;
            body.take(&island.positions[index], Velocity::of(&island.twists[index]));
            body.refresh_box(part, rotation);
        }
        self.fall_asleep(step_s, settled);
        self.find_contacts();
    }

    /// Impacts within the step, and the end of the forces that acted in it.
    pub fn end_step(&mut self, step_s: f32) {
        self.solve_impacts(step_s);
        for body in &mut self.bodies {
            body.force = Vec2::ZERO;
            body.torque = 0.0;
        }
    }

    /// Whether a body touches any edge, which [`World::leg_contacts`] does not always say.
    pub fn touches(&self, body: usize) -> bool {
        self.contacts.iter().any(|contact| contact.body == body && contact.touching)
    }

    /// Makes contacts of the pairs whose wide boxes have begun to overlap.
    pub(super) fn find_contacts(&mut self) {
        if !self.bodies.iter().any(|body| body.box_moved) {
            return;
        }
        for (edge, part) in self.ground.edges().iter().enumerate() {
            for (index, body) in self.bodies.iter_mut().enumerate() {
                let overlap = body.box_moved && body.wide_box.overlaps(part.aabb);
                let known = |contact: &Contact| contact.edge == edge && contact.body == index;
                if overlap && !self.contacts.iter().any(known) {
                    body.wake();
                    self.contacts.push(Contact::new(edge, index));
                }
            }
        }
        for body in &mut self.bodies {
            body.box_moved = false;
        }
    }

    /// Looks at every contact of an awake body again, the newest first; drops those whose boxes have parted.
    fn update_contacts(&mut self) {
        for index in (0..self.contacts.len()).rev() {
            let contact = &self.contacts[index];
            let body = &self.bodies[contact.body];
            if !body.awake {
                continue;
            }
            if body.wide_box.overlaps(self.ground.edges()[contact.edge].aabb) {
                self.update_contact(index);
            } else {
                let gone = self.contacts.remove(index);
                if gone.touching {
                    self.note(gone.body, Change::Ended);
                }
                if gone.manifold.touching() {
                    self.bodies[gone.body].wake();
                }
            }
        }
    }

    pub(super) fn update_contact(&mut self, index: usize) {
        let contact = &mut self.contacts[index];
        let body = contact.body;
        let change =
            contact.update(&self.ground.edges()[contact.edge], &parts()[body], &mut self.bodies[body]);
        self.note(body, change);
    }

    fn note(&mut self, body: usize, change: Change) {
        if change == Change::Began && body == HULL {
            self.hull_touched = true;
        }
        for (leg, touches) in LEGS.into_iter().zip(&mut self.leg_contacts) {
            if leg == body && change != Change::None {
                *touches = change == Change::Began;
            }
        }
    }

    /// The order in which Box2D walks from body to body along the hinges, beginning with the newest that is awake.
    /// Contacts are solved in this order. `None` when everything sleeps.
    ///
    /// All bodies fall asleep together, and only the hull is woken by itself: by an engine or the wind.
    fn walk(&self) -> Option<[usize; BODIES]> {
        if self.bodies[LEGS[1]].awake {
            Some([LEGS[1], HULL, LEGS[0]])
        } else if self.bodies[HULL].awake {
            Some([HULL, LEGS[0], LEGS[1]])
        } else {
            None
        }
    }

    /// The equations of a step, the impulses of the last one applied.
    fn island(&mut self, order: [usize; BODIES], step_s: f32, step_ratio: f32) -> Island {
        let positions = self.bodies.each_ref().map(Position::of);
        let mut twists = self.accelerated(step_s);
        let mut contacts = self.contact_rows(order, step_ratio);
        for row in &mut contacts {
            row.prepare(&positions[row.body]);
        }
        for row in &contacts {
            row.warm_start(&mut twists);
        }
        let hinges = self.hinge_equations(&positions, step_s, step_ratio);
        hinges.warm_start(&mut twists);
        Island { positions, twists, hinges, contacts }
    }

    /// Velocities after gravity and the gathered forces have acted.
    fn accelerated(&self, step_s: f32) -> Twists<f32> {
        let gravity = vec2(0.0, self.settings.gravity as f32);
        std::array::from_fn(|index| {
            let (body, part) = (&self.bodies[index], &parts()[index]);
            let linear = body.velocity + step_s * (gravity + part.inverse_mass * body.force);
            let omega = body.omega + step_s * part.inverse_inertia * body.torque;
            Velocity { linear, omega }.twist()
        })
    }

    /// The equations of touching contacts, in the order of the walk, newest first for each body.
    fn contact_rows(&self, order: [usize; BODIES], step_ratio: f32) -> Vec<ContactRow> {
        let mut rows = Vec::new();
        for body in order {
            for (index, contact) in self.contacts.iter().enumerate().rev() {
                if contact.body == body && contact.touching && contact.enabled {
                    rows.push(self.contact_row(index).with_impulses(step_ratio));
                }
            }
        }
        rows
    }

    pub(super) fn contact_row(&self, index: usize) -> ContactRow {
        let contact = &self.contacts[index];
        ContactRow::new(index, contact, &self.ground.edges()[contact.edge], &parts()[contact.body])
    }

    fn hinge_equations(
        &mut self,
        positions: &[Position; BODIES],
        step_s: f32,
        step_ratio: f32,
    ) -> Hinges<f32> {
        let rows = self.hinges.each_mut().map(|hinge| hinge.row(positions, step_s));
        let sums = self.hinges.each_ref().map(|hinge| hinge.sums(step_ratio));
        Hinges { rows, sums }
    }

    /// Keeps the impulses for the next step.
    fn store_impulses(&mut self, island: &Island) {
        for (hinge, sums) in self.hinges.iter_mut().zip(&island.hinges.sums) {
            hinge.store(sums);
        }
        for row in &island.contacts {
            row.store(&mut self.contacts[row.contact].manifold);
        }
    }

    /// Puts everything to sleep once all bodies have been still for long enough.
    fn fall_asleep(&mut self, step_s: f32, settled: bool) {
        let mut shortest = f32::MAX;
        for body in &mut self.bodies {
            let turning = body.omega * body.omega > SLEEP_SPIN * SLEEP_SPIN;
            let moving = body.velocity.dot(body.velocity) > SLEEP_SPEED * SLEEP_SPEED;
            body.still_s = if turning || moving { 0.0 } else { body.still_s + step_s };
            shortest = smaller(shortest, body.still_s);
        }
        if shortest >= TIME_TO_SLEEP_S && settled {
            self.bodies.iter_mut().for_each(Body::put_to_sleep);
        }
    }
}

/// What the iterations over velocities begin with, for the tests of those iterations.
#[cfg(test)]
impl World {
    pub fn velocity_problem(&self, step_s: f32) -> (Hinges<f32>, Twists<f32>) {
        let island = self.clone().begin_step(step_s).expect("a craft in flight is awake");
        (island.hinges, island.twists)
    }
}

impl Position {
    pub fn of(body: &Body) -> Position {
        Position { center: body.sweep.c, angle_rad: body.sweep.a, rotation: body.place.rotation }
    }

    /// Moves on with this velocity, which is cut where it would go too far for one step.
    pub fn drift(&mut self, velocity: &mut Velocity, step_s: f32) {
        let shift = step_s * velocity.linear;
        if shift.dot(shift) > MAX_TRANSLATION * MAX_TRANSLATION {
            velocity.linear = (MAX_TRANSLATION / shift.length()) * velocity.linear;
        }
        let turn = step_s * velocity.omega;
        if turn * turn > MAX_ROTATION * MAX_ROTATION {
            velocity.omega *= MAX_ROTATION / turn.abs();
        }
        self.center += step_s * velocity.linear;
        *self = self.turned(self.angle_rad + step_s * velocity.omega);
    }
}

impl Body {
    /// Ends its sweep here.
    pub fn take(&mut self, position: &Position, velocity: Velocity) {
        self.sweep.c = position.center;
        self.sweep.a = position.angle_rad;
        self.velocity = velocity.linear;
        self.omega = velocity.omega;
        self.place = Transform::about_center(position.center, position.rotation, self.sweep.local_center);
    }
}
