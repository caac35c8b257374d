//! The velocity equations of one hinge and their iteration: where most of the time goes.
//!
//! Sequential impulses: motor, then pin and limit together, each iteration starting from the velocities that the one before
//! left. Every number is [`Lanes`], one lane a world.

use super::lanes::{Lanes, Mask};

/// Velocity and spin of one body in `L` worlds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twist<const L: usize> {
    pub x: Lanes<L>,
    pub y: Lanes<L>,
    pub omega: Lanes<L>,
}

/// The velocity equations of one hinge in `L` worlds: what stays the same in all iterations of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HingeRow<const L: usize> {
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
}

/// Impulses summed over all iterations, and over earlier steps by warm starting.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sums<const L: usize> {
    /// Of the pin, x and y.
    pub pin: [Lanes<L>; 2],
    pub limit: Lanes<L>,
    pub motor: Lanes<L>,
}

/// What one iteration did at one hinge: enough to tell whether another one with the same velocities would do the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push<const L: usize> {
    /// What the motor would have added without its bounds.
    pub motor_wanted: Lanes<L>,
    pub motor: Lanes<L>,
    /// Pin x, pin y.
    pub pin: [Lanes<L>; 2],
    pub limit: Lanes<L>,
    /// What the limit had given before; counts only where it lets go.
    pub limit_given: Lanes<L>,
    /// Where the limit would have had to pull, or is not reached at all.
    pub lets_go: Mask<L>,
}

impl<const L: usize> Push<L> {
    /// Before anything was done.
    pub const NONE: Push<L> = Push {
        motor_wanted: Lanes::ZERO,
        motor: Lanes::ZERO,
        pin: [Lanes::ZERO; 2],
        limit: Lanes::ZERO,
        limit_given: Lanes::ZERO,
        lets_go: Mask([false; L]),
    };
}

impl<const L: usize> HingeRow<L> {
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
    pub fn bounded_motor(&self, sum: Lanes<L>) -> Lanes<L> {
        let max = self.max_motor_impulse;
        if sum.less_than(max).every() && (-max).less_than(sum).every() {
            return sum;
        }
        unusual();
        let bounded = sum.less_than(max).choose(sum, max);
        bounded.less_than(-max).choose(-max, bounded)
    }

    /// Where this limit would have to pull for its impulses to have this sum.
    #[inline(always)]
    pub fn would_pull(&self, limit_sum: Lanes<L>) -> Mask<L> {
        (self.limit_side * limit_sum).less_than(Lanes::ZERO)
    }

    /// The impulses of this iteration, and where the limit lets go. Pin and limit are solved together; where the limit would
    /// have to pull, it takes back what it has given in this step and the pin is solved alone.
    #[inline(always)]
    fn pin_and_limit(&self, given: Lanes<L>, drift: [Lanes<L>; 3]) -> (Mask<L>, [Lanes<L>; 3]) {
        let free = Mask(self.limit_side.0.map(|side| side == 0.0));
        if free.every() {
            return (free, self.pin(given, drift));
        }
        let both = self.pin_with_limit(drift);
        let lets_go = self.would_pull(given + both[2]).or(free);
        if lets_go.none() {
            return (lets_go, both);
        }
        let pin = self.pin(given, drift);
        (lets_go, std::array::from_fn(|axis| lets_go.choose(pin[axis], both[axis])))
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

    /// The pin alone; the limit takes back what it has given (nothing, where it is free).
    #[inline(always)]
    fn pin(&self, given: Lanes<L>, [drift_x, drift_y, _]: [Lanes<L>; 3]) -> [Lanes<L>; 3] {
        let [xx, xy, xz, yy, yz, _] = self.matrix;
        let inverse_det = self.inverses[4];
        let (bx, by) = (-drift_x + given * xz, -drift_y + given * yz);
        [inverse_det * (yy * bx - xy * by), inverse_det * (xx * by - xy * bx), -given]
    }
}

#[inline(always)]
fn cross<const L: usize>(arm: [Lanes<L>; 2], v: [Lanes<L>; 2]) -> Lanes<L> {
    arm[0] * v[1] - arm[1] * v[0]
}

/// Marks a branch that must stay a branch: the compiler would turn it into arithmetic, which waits for both sides.
#[cold]
fn unusual() {}
