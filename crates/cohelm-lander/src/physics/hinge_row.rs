//! The velocity equations of one hinge and their iteration: where four fifths of the time goes.
//!
//! Sequential impulses: motor, then pin and limit together, each iteration starting from the velocities that the one before
//! left. Every number is [`Lanes`], one lane a world.

use super::body::HULL;
use super::lanes::{Lanes, Mask};

/// Velocities of hull, leg, leg in `L` worlds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Velocities<const L: usize> {
    pub x: [Lanes<L>; 3],
    pub y: [Lanes<L>; 3],
    pub omega: [Lanes<L>; 3],
}

/// The velocity equations of one hinge in `L` worlds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HingeRow<const L: usize> {
    /// Index of the leg among the bodies.
    pub leg: usize,
    /// From the hull's centre of mass to the pin, world frame.
    pub hull_arm: [Lanes<L>; 2],
    /// From the leg's centre of mass to the pin, world frame.
    pub leg_arm: [Lanes<L>; 2],
    /// Inverse mass and inverse inertia of hull, then of leg.
    pub inverse_masses: [Lanes<L>; 4],
    /// The symmetric matrix of the three equations (pin x, pin y, limit): xx, xy, xz, yy, yz, zz.
    pub matrix: [Lanes<L>; 6],
    /// Cross product of its second and third columns (three numbers), 1 / its determinant, 1 / the pin's own determinant.
    pub inverses: [Lanes<L>; 5],
    pub motor_mass: Lanes<L>,
    pub motor_speed: Lanes<L>,
    pub max_motor_impulse: Lanes<L>,
    /// +1 at the lower limit, −1 at the upper, 0 in between: the only direction in which the limit pushes.
    pub limit_side: Lanes<L>,
    /// Sums over all iterations: pin x, pin y, limit.
    pub impulse: [Lanes<L>; 3],
    /// The same of the motor.
    pub motor_impulse: Lanes<L>,
}

impl<const L: usize> HingeRow<L> {
    /// Applies the impulses that the hinge begins the step with.
    pub fn warm_start(&self, v: &mut Velocities<L>) {
        let [ma, ia, mb, ib] = self.inverse_masses;
        let [x, y, z] = self.impulse;
        let hull_torque = cross(self.hull_arm, [x, y]) + self.motor_impulse + z;
        let leg_torque = cross(self.leg_arm, [x, y]) + self.motor_impulse + z;
        v.x[HULL] = v.x[HULL] - ma * x;
        v.y[HULL] = v.y[HULL] - ma * y;
        v.omega[HULL] = v.omega[HULL] - ia * hull_torque;
        v.x[self.leg] = v.x[self.leg] + mb * x;
        v.y[self.leg] = v.y[self.leg] + mb * y;
        v.omega[self.leg] = v.omega[self.leg] + ib * leg_torque;
    }

    /// One iteration.
    #[inline(always)]
    pub fn iterate(&mut self, v: &mut Velocities<L>) {
        self.run_motor(v);
        let [ma, ia, mb, ib] = self.inverse_masses;
        let (wa, wb) = (v.omega[HULL], v.omega[self.leg]);
        let ([rax, ray], [rbx, rby]) = (self.hull_arm, self.leg_arm);
        let drift = [
            v.x[self.leg] - wb * rby - v.x[HULL] + wa * ray,
            v.y[self.leg] + wb * rbx - v.y[HULL] - wa * rax,
            wb - wa,
        ];
        let [x, y, z] = self.pin_and_limit(drift);
        v.x[HULL] = v.x[HULL] - ma * x;
        v.y[HULL] = v.y[HULL] - ma * y;
        v.omega[HULL] = wa - ia * (cross(self.hull_arm, [x, y]) + z);
        v.x[self.leg] = v.x[self.leg] + mb * x;
        v.y[self.leg] = v.y[self.leg] + mb * y;
        v.omega[self.leg] = wb + ib * (cross(self.leg_arm, [x, y]) + z);
    }

    /// Drives the leg towards the motor's speed as far as its torque allows.
    #[inline(always)]
    fn run_motor(&mut self, v: &mut Velocities<L>) {
        let [_, ia, _, ib] = self.inverse_masses;
        let drift = v.omega[self.leg] - v.omega[HULL] - self.motor_speed;
        let wanted = self.motor_impulse + -self.motor_mass * drift;
        let max = self.max_motor_impulse;
        let bounded = wanted.less_than(max).choose(wanted, max);
        let bounded = bounded.less_than(-max).choose(-max, bounded);
        let impulse = bounded - self.motor_impulse;
        self.motor_impulse = bounded;
        v.omega[HULL] = v.omega[HULL] - ia * impulse;
        v.omega[self.leg] = v.omega[self.leg] + ib * impulse;
    }

    /// The impulse of this iteration, already added to the sums. Pin and limit are solved together; where the limit would have
    /// to pull, it lets go and the pin is solved alone.
    #[inline(always)]
    fn pin_and_limit(&mut self, drift: [Lanes<L>; 3]) -> [Lanes<L>; 3] {
        let free = Mask(self.limit_side.0.map(|side| side == 0.0));
        if free.every() {
            return self.add(self.pin(drift));
        }
        let both = self.pin_with_limit(drift);
        let sum = self.impulse[2] + both[2];
        let lets_go = (self.limit_side * sum).less_than(Lanes::ZERO).or(free);
        if lets_go.none() {
            return self.add(both);
        }
        let pin = self.pin(drift);
        self.add(std::array::from_fn(|axis| lets_go.choose(pin[axis], both[axis])))
    }

    /// Pin and limit held together.
    #[inline(always)]
    fn pin_with_limit(&self, [bx, by, bz]: [Lanes<L>; 3]) -> [Lanes<L>; 3] {
        let [xx, xy, xz, yy, yz, zz] = self.matrix;
        let [cx, cy, cz, inverse_det, _] = self.inverses;
        let x = inverse_det * (bx * cx + by * cy + bz * cz);
        let y =
            inverse_det * (xx * (by * zz - bz * yz) + xy * (bz * xz - bx * zz) + xz * (bx * yz - by * xz));
        let z =
            inverse_det * (xx * (yy * bz - yz * by) + xy * (yz * bx - xy * bz) + xz * (xy * by - yy * bx));
        [-x, -y, -z]
    }

    /// The pin alone; the limit takes back what it has given in this step (nothing, where it is free).
    #[inline(always)]
    fn pin(&self, [drift_x, drift_y, _]: [Lanes<L>; 3]) -> [Lanes<L>; 3] {
        let [xx, xy, xz, yy, yz, _] = self.matrix;
        let inverse_det = self.inverses[4];
        let given = self.impulse[2];
        let (bx, by) = (-drift_x + given * xz, -drift_y + given * yz);
        [inverse_det * (yy * bx - xy * by), inverse_det * (xx * by - xy * bx), -given]
    }

    #[inline(always)]
    fn add(&mut self, impulse: [Lanes<L>; 3]) -> [Lanes<L>; 3] {
        self.impulse = std::array::from_fn(|axis| self.impulse[axis] + impulse[axis]);
        impulse
    }
}

#[inline(always)]
fn cross<const L: usize>(arm: [Lanes<L>; 2], v: [Lanes<L>; 2]) -> Lanes<L> {
    arm[0] * v[1] - arm[1] * v[0]
}
