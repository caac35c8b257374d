//! The velocity equations of one hinge and their iteration: where most of the time goes.
//!
//! Sequential impulses: motor, then pin and limit together, each iteration starting from the velocities that the one before
//! left. Written over [`Lanes`]: for one world, and for several side by side.

use super::lanes::Lanes;

/// Velocity and spin of one body in one world or several.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twist<L> {
    pub x: L,
    pub y: L,
    pub omega: L,
}

/// The velocity equations of one hinge in one world or several: what stays the same in all iterations of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HingeRow<L> {
    /// From the hull's centre of mass to the pin, world frame.
    pub hull_arm: [L; 2],
    /// From the leg's centre of mass to the pin, world frame.
    pub leg_arm: [L; 2],
    /// Inverse mass and inverse inertia of hull, then of leg.
    pub inverse_masses: [L; 4],
    /// The symmetric matrix of the three equations (pin x, pin y, limit): xx, xy, xz, yy, yz, zz.
    pub matrix: [L; 6],
    /// Cross product of its second and third columns (three numbers), 1 / its determinant, 1 / the pin's own determinant.
    pub inverses: [L; 5],
    pub motor_mass: L,
    pub motor_speed: L,
    pub max_motor_impulse: L,
    /// +1 at the lower limit, −1 at the upper, 0 in between: the only direction in which the limit pushes.
    pub limit_side: L,
}

/// Impulses summed over all iterations, and over earlier steps by warm starting.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sums<L> {
    /// Of the pin, x and y.
    pub pin: [L; 2],
    pub limit: L,
    pub motor: L,
}

/// What one iteration did at one hinge: enough to tell whether another one with the same velocities would do the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push<L: Lanes> {
    /// What the motor would have added without its bounds.
    pub motor_wanted: L,
    pub motor: L,
    /// Pin x, pin y.
    pub pin: [L; 2],
    pub limit: L,
    /// What the limit had given before; counts only where it lets go.
    pub limit_given: L,
    /// Where the limit would have had to pull, or is not reached at all.
    pub lets_go: L::Mask,
}

impl Push<f32> {
    /// Before anything was done.
    pub const NONE: Push<f32> =
        Push { motor_wanted: 0.0, motor: 0.0, pin: [0.0; 2], limit: 0.0, limit_given: 0.0, lets_go: false };
}

impl<L: Lanes> HingeRow<L> {
    /// Applies the impulses that the hinge begins the step with.
    pub fn warm_start(&self, sums: &Sums<L>, hull: &mut Twist<L>, leg: &mut Twist<L>) {
        let [ma, ia, mb, ib] = self.inverse_masses;
        let [x, y] = sums.pin;
        hull.x = hull.x - ma * x;
        hull.y = hull.y - ma * y;
        hull.omega = hull.omega - ia * (cross(self.hull_arm, sums.pin) + sums.motor + sums.limit);
        leg.x = leg.x + mb * x;
        leg.y = leg.y + mb * y;
        leg.omega = leg.omega + ib * (cross(self.leg_arm, sums.pin) + sums.motor + sums.limit);
    }

    /// One iteration.
    #[inline(always)]
    pub fn iterate(&self, sums: &mut Sums<L>, hull: &mut Twist<L>, leg: &mut Twist<L>) -> Push<L> {
        let [ma, ia, mb, ib] = self.inverse_masses;
        let ([rax, ray], [rbx, rby]) = (self.hull_arm, self.leg_arm);

        let motor_wanted = -self.motor_mass * (leg.omega - hull.omega - self.motor_speed);
        let bounded = self.bounded_motor(sums.motor + motor_wanted);
        let motor = bounded - sums.motor;
        sums.motor = bounded;
        let hull_omega = hull.omega - ia * motor;
        let leg_omega = leg.omega + ib * motor;

        let drift = [
            leg.x - leg_omega * rby - hull.x + hull_omega * ray,
            leg.y + leg_omega * rbx - hull.y - hull_omega * rax,
            leg_omega - hull_omega,
        ];
        let limit_given = sums.limit;
        let (lets_go, [x, y, z]) = self.pin_and_limit(limit_given, drift);
        sums.pin = [sums.pin[0] + x, sums.pin[1] + y];
        sums.limit = limit_given + z;
        hull.x = hull.x - ma * x;
        hull.y = hull.y - ma * y;
        hull.omega = hull_omega - ia * (cross(self.hull_arm, [x, y]) + z);
        leg.x = leg.x + mb * x;
        leg.y = leg.y + mb * y;
        leg.omega = leg_omega + ib * (cross(self.leg_arm, [x, y]) + z);
        Push { motor_wanted, motor, pin: [x, y], limit: z, limit_given, lets_go }
    }

    /// The motor's sum within what its torque allows.
    ///
    /// An iteration is one chain of dependencies. A minimum and a maximum are links of it; a predicted branch is not, which is
    /// worth a quarter more steps a second.
    #[inline(always)]
    pub fn bounded_motor(&self, sum: L) -> L {
        let max = self.max_motor_impulse;
        if L::surely_all(sum.less_than(max)) && L::surely_all((-max).less_than(sum)) {
            return sum;
        }
        unusual();
        let bounded = L::choose(sum.less_than(max), sum, max);
        L::choose(bounded.less_than(-max), -max, bounded)
    }

    /// Where this limit would have to pull for its impulses to have this sum.
    #[inline(always)]
    pub fn would_pull(&self, limit_sum: L) -> L::Mask {
        (self.limit_side * limit_sum).less_than(limit_sum.alike(0.0))
    }

    /// The impulses of this iteration, and where the limit lets go. Pin and limit are solved together; where the limit would
    /// have to pull, it takes back what it has given in this step and the pin is solved alone.
    #[inline(always)]
    fn pin_and_limit(&self, given: L, drift: [L; 3]) -> (L::Mask, [L; 3]) {
        let free = self.limit_side.equals(given.alike(0.0));
        if L::surely_all(free) {
            return (free, self.pin(given, drift));
        }
        let both = self.pin_with_limit(drift);
        let lets_go = L::either(self.would_pull(given + both[2]), free);
        if L::surely_none(lets_go) {
            return (lets_go, both);
        }
        let pin = self.pin(given, drift);
        let choose = |axis: usize| L::choose(lets_go, pin[axis], both[axis]);
        (lets_go, [choose(0), choose(1), choose(2)])
    }

    /// Pin and limit held together.
    #[inline(always)]
    fn pin_with_limit(&self, [bx, by, bz]: [L; 3]) -> [L; 3] {
        let [xx, xy, xz, yy, yz, zz] = self.matrix;
        let [cx, cy, cz, inverse_det, _] = self.inverses;
        let x = inverse_det * (bx * cx + by * cy + bz * cz);
        let y =
            inverse_det * (xx * (by * zz - bz * yz) + xy * (bz * xz - bx * zz) + xz * (bx * yz - by * xz));
        let z =
            inverse_det * (xx * (yy * bz - yz * by) + xy * (yz * bx - xy * bz) + xz * (xy * by - yy * bx));
        [-x, -y, -z]
    }

    /// The pin alone; the limit takes back what it has given (nothing, where it is free).
    #[inline(always)]
    fn pin(&self, given: L, [drift_x, drift_y, _]: [L; 3]) -> [L; 3] {
        let [xx, xy, xz, yy, yz, _] = self.matrix;
        let inverse_det = self.inverses[4];
        let (bx, by) = (-drift_x + given * xz, -drift_y + given * yz);
        [inverse_det * (yy * bx - xy * by), inverse_det * (xx * by - xy * bx), -given]
    }
}

#[inline(always)]
fn cross<L: Lanes>(arm: [L; 2], v: [L; 2]) -> L {
    arm[0] * v[1] - arm[1] * v[0]
}

/// Marks a branch that must stay a branch: the compiler would turn it into arithmetic, which waits for both sides.
#[cold]
fn unusual() {}
