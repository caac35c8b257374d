//! The hinge between hull and leg: a revolute joint with a motor (the leg's spring) and two angle limits.
//!
//! [`Hinge`] is what lasts from step to step. For the iterations over velocities it lays its equations out as a
//! [`HingeRow`](super::hinge_row::HingeRow) and afterwards takes the impulses back.

use super::body::{BODIES, HULL, LEG_AWAY, LEG_DOWN, LEG_START_RAD, LEGS, Part, parts};
use super::hinge_row::{HingeRow, Sums};
use super::position::Position;
use super::tuning::{ANGULAR_SLOP, LINEAR_SLOP, MAX_ANGULAR_CORRECTION};
use super::vector::{Vec2, clamp, vec2};

/// Greatest torque of a leg's motor.
const MAX_MOTOR_TORQUE: f32 = 40.0;
/// Speed at which the motor tries to swing a leg outwards, rad/s.
const MOTOR_SPEED: f64 = 0.3;

/// Which end of its range a hinge is at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Limit {
    Free,
    Lower,
    Upper,
}

/// A hinge between hull and one leg.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hinge {
    /// Index of the leg among the bodies.
    pub leg: usize,
    /// The hinge seen from the leg's centre of mass, in the leg's frame.
    leg_arm: Vec2,
    /// Angle between leg and hull that counts as 0: the one they were made with.
    reference_rad: f32,
    lower_rad: f32,
    upper_rad: f32,
    motor_speed: f32,
    limit: Limit,
    /// Impulses of the last step: two of the pin, one of the limit.
    impulse: [f32; 3],
    motor_impulse: f32,
}

impl Hinge {
    /// Gymnasium's two hinges, at rest.
    pub fn both() -> [Hinge; 2] {
        let hinge = |leg: usize, side: f64, lower: f64, upper: f64| Hinge {
            leg,
            leg_arm: vec2((side * LEG_AWAY) as f32, LEG_DOWN as f32) - parts()[leg].local_center,
            reference_rad: (side * LEG_START_RAD) as f32,
            lower_rad: lower as f32,
            upper_rad: upper as f32,
            motor_speed: (MOTOR_SPEED * side) as f32,
            limit: Limit::Free,
            impulse: [0.0; 3],
            motor_impulse: 0.0,
        };
        [hinge(LEGS[0], -1.0, 0.9 - 0.5, 0.9), hinge(LEGS[1], 1.0, -0.9, -0.9 + 0.5)]
    }

    fn angle_rad(&self, hull: &Position, leg: &Position) -> f32 {
        leg.angle_rad - hull.angle_rad - self.reference_rad
    }

    /// The hinge seen from the hull's centre of mass, in the hull's frame: it sits at the hull's origin.
    fn hull_arm() -> Vec2 {
        Vec2::ZERO - parts()[HULL].local_center
    }

    /// Decides which limit holds in this step. An impulse of another limit is forgotten.
    fn find_limit(&mut self, angle_rad: f32) {
        let limit = if angle_rad <= self.lower_rad {
            Limit::Lower
        } else if angle_rad >= self.upper_rad {
            Limit::Upper
        } else {
            Limit::Free
        };
        if limit == Limit::Free || limit != self.limit {
            self.impulse[2] = 0.0;
        }
        self.limit = limit;
    }

    /// The velocity equations at these positions.
    pub fn row(&mut self, positions: &[Position; BODIES], step_s: f32) -> HingeRow<f32> {
        let (hull, leg) = (positions[HULL], positions[self.leg]);
        self.find_limit(self.angle_rad(&hull, &leg));

        let (ra, rb) = (hull.rotation.apply(Hinge::hull_arm()), leg.rotation.apply(self.leg_arm));
        let ((ma, ia), (mb, ib)) = self.inverse_masses();
        let matrix = [
            ma + mb + ra.y * ra.y * ia + rb.y * rb.y * ib,
            -ra.y * ra.x * ia - rb.y * rb.x * ib,
            -ra.y * ia - rb.y * ib,
            ma + mb + ra.x * ra.x * ia + rb.x * rb.x * ib,
            ra.x * ia + rb.x * ib,
            ia + ib,
        ];
        let limit_side = match self.limit {
            Limit::Free => 0.0,
            Limit::Lower => 1.0,
            Limit::Upper => -1.0,
        };
        HingeRow {
            hull_arm: one(ra),
            leg_arm: one(rb),
            inverse_masses: [ma, ia, mb, ib],
            matrix,
            inverses: inverses(matrix),
            motor_mass: 1.0 / (ia + ib),
            motor_speed: self.motor_speed,
            max_motor_impulse: step_s * MAX_MOTOR_TORQUE,
            limit_side,
        }
    }

    /// The impulses that the step begins with: those of the last one, scaled by `step_ratio`. Call after [`Hinge::row`], which
    /// decides whether the limit's still counts.
    pub fn sums(&self, step_ratio: f32) -> Sums<f32> {
        let [x, y, limit] = self.impulse.map(|impulse| impulse * step_ratio);
        Sums { pin: [x, y], limit, motor: self.motor_impulse * step_ratio }
    }

    /// Keeps the impulses for the next step.
    pub fn store(&mut self, sums: &Sums<f32>) {
        self.impulse = [sums.pin[0], sums.pin[1], sums.limit];
        self.motor_impulse = sums.motor;
    }

    /// Inverse mass and inverse inertia of the hull, then of the leg.
    fn inverse_masses(&self) -> ((f32, f32), (f32, f32)) {
        let of = |part: &Part| (part.inverse_mass, part.inverse_inertia);
        (of(&parts()[HULL]), of(&parts()[self.leg]))
    }

    /// One iteration over positions: turns the leg back within its range, then brings the two sides of the pin together.
    /// True when little was left to do.
    pub fn correct(&self, positions: &mut [Position; BODIES]) -> bool {
        let ((ma, ia), (mb, ib)) = self.inverse_masses();
        let [hull, leg] = [positions[HULL], positions[self.leg]];
        let (angular_error, turn) = self.limit_correction(self.angle_rad(&hull, &leg), 1.0 / (ia + ib));
        let hull = hull.turned(hull.angle_rad - ia * turn);
        let leg = leg.turned(leg.angle_rad + ib * turn);

        let (ra, rb) = (hull.rotation.apply(Hinge::hull_arm()), leg.rotation.apply(self.leg_arm));
        let gap = leg.center + rb - hull.center - ra;
        let xx = ma + mb + ia * ra.y * ra.y + ib * rb.y * rb.y;
        let xy = -ia * ra.x * ra.y - ib * rb.x * rb.y;
        let yy = ma + mb + ia * ra.x * ra.x + ib * rb.x * rb.x;
        let inverse_det = inverse_or_zero(xx * yy - xy * xy);
        let impulse = -vec2(inverse_det * (yy * gap.x - xy * gap.y), inverse_det * (xx * gap.y - xy * gap.x));

        positions[HULL] = Position { center: hull.center - ma * impulse, ..hull }
            .turned(hull.angle_rad - ia * ra.cross(impulse));
        positions[self.leg] = Position { center: leg.center + mb * impulse, ..leg }
            .turned(leg.angle_rad + ib * rb.cross(impulse));
        gap.length() <= LINEAR_SLOP && angular_error <= ANGULAR_SLOP
    }

    /// How far the leg is outside its range, and the angular impulse that brings part of it back.
    fn limit_correction(&self, angle_rad: f32, motor_mass: f32) -> (f32, f32) {
        match self.limit {
            Limit::Free => (0.0, 0.0),
            Limit::Lower => {
                let error = angle_rad - self.lower_rad;
                let bounded = clamp(error + ANGULAR_SLOP, -MAX_ANGULAR_CORRECTION, 0.0);
                (-error, -motor_mass * bounded)
            }
            Limit::Upper => {
                let error = angle_rad - self.upper_rad;
                let bounded = clamp(error - ANGULAR_SLOP, 0.0, MAX_ANGULAR_CORRECTION);
                (error, -motor_mass * bounded)
            }
        }
    }
}

fn one(v: Vec2) -> [f32; 2] {
    [v.x, v.y]
}

/// Cross product of the second and third columns of the symmetric matrix (xx, xy, xz, yy, yz, zz), 1 / its determinant,
/// and 1 / the determinant of its upper left corner; 0 for 1 / 0.
fn inverses([xx, xy, xz, yy, yz, zz]: [f32; 6]) -> [f32; 5] {
    let (cx, cy, cz) = (yy * zz - yz * yz, yz * xz - xy * zz, xy * yz - yy * xz);
    let det3 = xx * cx + xy * cy + xz * cz;
    let det2 = xx * yy - xy * xy;
    [cx, cy, cz, inverse_or_zero(det3), inverse_or_zero(det2)]
}

fn inverse_or_zero(determinant: f32) -> f32 {
    if determinant == 0.0 { 0.0 } else { 1.0 / determinant }
}
