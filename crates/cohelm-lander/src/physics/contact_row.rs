//! The equations of one contact within a step: normal and friction impulses at up to two points, and position correction.
//!
//! The ground is one of the two bodies; as it cannot move, its terms are left out.

use super::body::Part;
use super::contact::Contact;
use super::hinge_row::Twist;
use super::manifold::{Face, Manifold};
use super::position::Position;
use super::relax::Twists;
use super::shape::Edge;
use super::tuning::{
    BAUMGARTE, LINEAR_SLOP, MAX_CONDITION_NUMBER, MAX_LINEAR_CORRECTION, SKIN, TOI_BAUMGARTE,
};
use super::vector::{Transform, Vec2, clamp, larger, smaller, vec2};

/// How much of the overlap an iteration removes, and what overlap is left in peace.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Correction {
    share: f32,
    tolerated: f32,
}

impl Correction {
    /// After an ordinary step.
    pub const STEP: Correction = Correction { share: BAUMGARTE, tolerated: -3.0 * LINEAR_SLOP };
    /// After a time of impact: firmer.
    pub const IMPACT: Correction = Correction { share: TOI_BAUMGARTE, tolerated: -1.5 * LINEAR_SLOP };
}

/// Velocity of one body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Velocity {
    pub linear: Vec2,
    pub omega: f32,
}

impl Velocity {
    pub fn of(twist: &Twist<f32>) -> Velocity {
        Velocity { linear: vec2(twist.x, twist.y), omega: twist.omega }
    }

    pub fn twist(self) -> Twist<f32> {
        Twist { x: self.linear.x, y: self.linear.y, omega: self.omega }
    }

    pub fn bits(self) -> [u32; 3] {
        [self.linear.x, self.linear.y, self.omega].map(f32::to_bits)
    }

    fn at(self, arm: Vec2) -> Vec2 {
        self.linear + arm.swung(self.omega)
    }
}

/// One contact point.
#[derive(Clone, Copy, Debug)]
struct RowPoint {
    /// From the centre of mass, world frame.
    arm: Vec2,
    normal_impulse: f32,
    tangent_impulse: f32,
    normal_mass: f32,
    tangent_mass: f32,
}

/// One touching contact in a step.
#[derive(Clone, Debug)]
pub(crate) struct ContactRow {
    /// Index of the contact in the world's list.
    pub contact: usize,
    pub body: usize,
    manifold: Manifold,
    inverse_mass: f32,
    inverse_inertia: f32,
    local_center: Vec2,
    friction: f32,
    normal: Vec2,
    points: [RowPoint; 2],
    /// Points that take part in the velocity equations: two that say the same count as one.
    count: usize,
    /// The two normal equations: k11, k12, k22, and their inverse.
    block: [f32; 3],
    inverse_block: [f32; 3],
}

impl ContactRow {
    /// Of contact number `index`; call [`ContactRow::prepare`] before iterating over velocities.
    pub fn new(index: usize, contact: &Contact, edge: &Edge, part: &Part) -> ContactRow {
        let none = RowPoint {
            arm: Vec2::ZERO,
            normal_impulse: 0.0,
            tangent_impulse: 0.0,
            normal_mass: 0.0,
            tangent_mass: 0.0,
        };
        ContactRow {
            contact: index,
            body: contact.body,
            manifold: contact.manifold,
            inverse_mass: part.inverse_mass,
            inverse_inertia: part.inverse_inertia,
            local_center: part.local_center,
            friction: (edge.friction * part.friction).sqrt(),
            normal: Vec2::ZERO,
            points: [none; 2],
            count: contact.manifold.points().len(),
            block: [0.0; 3],
            inverse_block: [0.0; 3],
        }
    }

    /// Takes over the impulses of the last step, scaled.
    pub fn with_impulses(mut self, step_ratio: f32) -> ContactRow {
        for (row, point) in self.points.iter_mut().zip(self.manifold.points()) {
            row.normal_impulse = step_ratio * point.normal_impulse;
            row.tangent_impulse = step_ratio * point.tangent_impulse;
        }
        self
    }

    /// Lays out the velocity equations for a body at `position`.
    pub fn prepare(&mut self, position: &Position) {
        let place = Transform::about_center(position.center, position.rotation, self.local_center);
        let (normal, points) = world_points(&self.manifold, place);
        self.normal = normal;
        let tangent = normal.turned_right();
        for (row, point) in self.points.iter_mut().zip(points).take(self.count) {
            row.arm = point - position.center;
            let mass = |axis: Vec2| {
                let lever = row.arm.cross(axis);
                inverse_or_zero(self.inverse_mass + self.inverse_inertia * lever * lever)
            };
            row.normal_mass = mass(normal);
            row.tangent_mass = mass(tangent);
        }
        if self.count == 2 {
            self.prepare_block();
        }
    }

    /// The two normal equations together; if they say nearly the same, the second point is dropped.
    fn prepare_block(&mut self) {
        let (m, i) = (self.inverse_mass, self.inverse_inertia);
        let [lever1, lever2] = self.points.map(|point| point.arm.cross(self.normal));
        let k11 = m + i * lever1 * lever1;
        let k22 = m + i * lever2 * lever2;
        let k12 = m + i * lever1 * lever2;
        if k11 * k11 < MAX_CONDITION_NUMBER * (k11 * k22 - k12 * k12) {
            self.block = [k11, k12, k22];
            self.inverse_block = inverse_of_symmetric(self.block);
        } else {
            self.count = 1;
        }
    }

    /// Applies the impulses that the contact begins the step with.
    pub fn warm_start(&self, twists: &mut Twists<f32>) {
        let mut velocity = Velocity::of(&twists[self.body]);
        let tangent = self.normal.turned_right();
        for point in &self.points[..self.count] {
            let impulse = point.normal_impulse * self.normal + point.tangent_impulse * tangent;
            self.apply(&mut velocity, impulse, point.arm);
        }
        twists[self.body] = velocity.twist();
    }

    /// One iteration on the body's velocity among all.
    pub fn push(&mut self, twists: &mut Twists<f32>) {
        let mut velocity = Velocity::of(&twists[self.body]);
        self.iterate(&mut velocity);
        twists[self.body] = velocity.twist();
    }

    /// One iteration: friction first, because not to sink in matters more.
    pub fn iterate(&mut self, velocity: &mut Velocity) {
        self.rub(velocity);
        if self.count == 2 {
            self.press_block(velocity);
        } else {
            self.press_point(velocity);
        }
    }

    fn rub(&mut self, velocity: &mut Velocity) {
        let tangent = self.normal.turned_right();
        for i in 0..self.count {
            let point = self.points[i];
            let slip = velocity.at(point.arm).dot(tangent);
            let most = self.friction * point.normal_impulse;
            let sum = clamp(point.tangent_impulse + point.tangent_mass * -slip, -most, most);
            self.points[i].tangent_impulse = sum;
            self.apply(velocity, (sum - point.tangent_impulse) * tangent, point.arm);
        }
    }

    fn press_point(&mut self, velocity: &mut Velocity) {
        let point = self.points[0];
        let approach = velocity.at(point.arm).dot(self.normal);
        let sum = larger(point.normal_impulse + -point.normal_mass * approach, 0.0);
        self.points[0].normal_impulse = sum;
        self.apply(velocity, (sum - point.normal_impulse) * self.normal, point.arm);
    }

    /// Both normal impulses at once, as a linear complementarity problem of two unknowns: each point either separates with no
    /// impulse or is held with a non-negative one. The four combinations are tried in turn.
    fn press_block(&mut self, velocity: &mut Velocity) {
        let [first, second] = self.points;
        let old = vec2(first.normal_impulse, second.normal_impulse);
        let approach = [first, second].map(|point| velocity.at(point.arm).dot(self.normal));
        let b = vec2(approach[0], approach[1]) - symmetric_times(self.block, old);
        let Some(sums) = self.complementary_impulses(b) else { return };
        let change = sums - old;
        let (p1, p2) = (change.x * self.normal, change.y * self.normal);
        velocity.linear += self.inverse_mass * (p1 + p2);
        velocity.omega += self.inverse_inertia * (first.arm.cross(p1) + second.arm.cross(p2));
        self.points[0].normal_impulse = sums.x;
        self.points[1].normal_impulse = sums.y;
    }

    /// `None` when rounding leaves no combination: then nothing is changed.
    fn complementary_impulses(&self, b: Vec2) -> Option<Vec2> {
        let [_, k12, _] = self.block;
        let both = -symmetric_times(self.inverse_block, b);
        if both.x >= 0.0 && both.y >= 0.0 {
            return Some(both);
        }
        let first = -self.points[0].normal_mass * b.x;
        if first >= 0.0 && k12 * first + b.y >= 0.0 {
            return Some(vec2(first, 0.0));
        }
        let second = -self.points[1].normal_mass * b.y;
        if second >= 0.0 && k12 * second + b.x >= 0.0 {
            return Some(vec2(0.0, second));
        }
        (b.x >= 0.0 && b.y >= 0.0).then_some(Vec2::ZERO)
    }

    fn apply(&self, velocity: &mut Velocity, impulse: Vec2, arm: Vec2) {
        velocity.linear += self.inverse_mass * impulse;
        velocity.omega += self.inverse_inertia * arm.cross(impulse);
    }

    /// The bits of all impulses: what an iteration leaves to the next one beside the velocity.
    pub fn impulse_bits(&self) -> [u32; 4] {
        let [first, second] = &self.points;
        [first.normal_impulse, first.tangent_impulse, second.normal_impulse, second.tangent_impulse]
            .map(f32::to_bits)
    }

    /// Writes the impulses where the next step looks for them.
    pub fn store(&self, manifold: &mut Manifold) {
        for (point, row) in manifold.points_mut().iter_mut().zip(&self.points[..self.count]) {
            point.normal_impulse = row.normal_impulse;
            point.tangent_impulse = row.tangent_impulse;
        }
    }

    /// One iteration over positions. Returns the deepest overlap met (negative) or 0.
    pub fn correct(&self, position: &mut Position, correction: Correction) -> f32 {
        let mut deepest = 0.0;
        for index in 0..self.manifold.points().len() {
            let place = Transform::about_center(position.center, position.rotation, self.local_center);
            let (normal, point, separation) = separation(&self.manifold, index, place);
            deepest = smaller(deepest, separation);
            let arm = point - position.center;
            let wanted = clamp(correction.share * (separation + LINEAR_SLOP), -MAX_LINEAR_CORRECTION, 0.0);
            let lever = arm.cross(normal);
            let stiffness = self.inverse_mass + self.inverse_inertia * lever * lever;
            let impulse = if stiffness > 0.0 { -wanted / stiffness } else { 0.0 } * normal;
            position.center += self.inverse_mass * impulse;
            *position = position.turned(position.angle_rad + self.inverse_inertia * arm.cross(impulse));
        }
        deepest
    }
}

impl Correction {
    /// Whether an overlap is small enough to be left.
    pub fn tolerates(self, deepest: f32) -> bool {
        deepest >= self.tolerated
    }
}

/// Normal from ground to body and points halfway between the two skins, world frame.
fn world_points(manifold: &Manifold, place: Transform) -> (Vec2, [Vec2; 2]) {
    let mut out = [Vec2::ZERO; 2];
    let points = out.iter_mut().zip(manifold.points());
    match manifold.face {
        Face::Ground => {
            let (normal, plane) = (manifold.local_normal, manifold.local_point);
            for (out, point) in points {
                let clip = place.apply(point.local_point);
                let on_ground = clip + (SKIN - (clip - plane).dot(normal)) * normal;
                let on_body = clip - SKIN * normal;
                *out = 0.5 * (on_ground + on_body);
            }
            (normal, out)
        }
        Face::Body => {
            let normal = place.rotation.apply(manifold.local_normal);
            let plane = place.apply(manifold.local_point);
            for (out, point) in points {
                let clip = point.local_point;
                let on_body = clip + (SKIN - (clip - plane).dot(normal)) * normal;
                let on_ground = clip - SKIN * normal;
                *out = 0.5 * (on_ground + on_body);
            }
            (-normal, out)
        }
    }
}

/// Normal from ground to body, point and distance of the skins (negative: overlap) for one point of the manifold.
fn separation(manifold: &Manifold, index: usize, place: Transform) -> (Vec2, Vec2, f32) {
    let local_point = manifold.points()[index].local_point;
    match manifold.face {
        Face::Ground => {
            let normal = manifold.local_normal;
            let point = place.apply(local_point);
            let distance = (point - manifold.local_point).dot(normal);
            (normal, point, distance - SKIN - SKIN)
        }
        Face::Body => {
            let normal = place.rotation.apply(manifold.local_normal);
            let plane = place.apply(manifold.local_point);
            let distance = (local_point - plane).dot(normal);
            (-normal, local_point, distance - SKIN - SKIN)
        }
    }
}

fn symmetric_times([a, b, d]: [f32; 3], v: Vec2) -> Vec2 {
    vec2(a * v.x + b * v.y, b * v.x + d * v.y)
}

/// Inverse of ((a, b), (b, d)).
fn inverse_of_symmetric([a, b, d]: [f32; 3]) -> [f32; 3] {
    let mut det = a * d - b * b;
    if det != 0.0 {
        det = 1.0 / det;
    }
    [det * d, -det * b, det * a]
}

fn inverse_or_zero(k: f32) -> f32 {
    if k > 0.0 { 1.0 / k } else { 0.0 }
}
