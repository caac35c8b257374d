//! The iterations over the velocities of both hinges, with an exact short cut for a single world.
//!
//! In flight the velocities mostly come to a standstill after some twenty iterations, or to a cycle of a few states, while the
//! sums of motor and limit go on growing against each other. Once the velocities return to an earlier state, an iteration can
//! only do what it did then, unless motor or limit reach a bound. So the rest are replayed on the sums alone: a few additions
//! instead of two systems of equations, and every bit as if they had been computed.

use super::hinge_row::{HingeRow, Push, Sums, Twist};
use super::lanes::Lanes;

/// Longest cycle of velocities that is looked for. In recorded flights nineteen in twenty are of one or two states.
const LONGEST_CYCLE: usize = 8;

/// Twists of hull, first leg, second leg.
pub(crate) type Twists<const L: usize> = [Twist<L>; 3];

/// Both hinges in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hinges<const L: usize> {
    pub rows: [HingeRow<L>; 2],
    pub sums: [Sums<L>; 2],
}

impl<const L: usize> Hinges<L> {
    pub fn warm_start(&self, [hull, first, second]: &mut Twists<L>) {
        self.rows[1].warm_start(&self.sums[1], hull, second);
        self.rows[0].warm_start(&self.sums[0], hull, first);
    }

    /// One iteration. The newest hinge comes first: Box2D walks its lists from the newest.
    #[inline(always)]
    pub fn iterate(&mut self, [hull, first, second]: &mut Twists<L>) -> [Push<L>; 2] {
        let newer = self.rows[1].iterate(&mut self.sums[1], hull, second);
        let older = self.rows[0].iterate(&mut self.sums[0], hull, first);
        [older, newer]
    }
}

/// What one iteration began with and did.
type Iteration = (Twists<1>, [Push<1>; 2]);

impl Hinges<1> {
    /// As many calls of [`Hinges::iterate`], with their bits, in less time.
    pub fn relax(&mut self, twists: &mut Twists<1>, iterations: u32) {
        let mut left = iterations;
        while left > 0 {
            let anchor = *twists;
            let mut cycle = [(anchor, [Push::NONE; 2]); LONGEST_CYCLE];
            for length in 1..=LONGEST_CYCLE.min(left as usize) {
                let before = *twists;
                cycle[length - 1] = (before, self.iterate(twists));
                left -= 1;
                if same(twists, &anchor) {
                    let replayed = self.replay(&cycle[..length], left);
                    left -= replayed;
                    *twists = cycle[replayed as usize % length].0;
                    break;
                }
            }
        }
    }

    /// Repeats a cycle on the sums, at most so many iterations, until motor or limit would do something else. Returns how many.
    fn replay(&mut self, cycle: &[Iteration], most: u32) -> u32 {
        let mut phase = 0;
        for done in 0..most {
            let (_, [older, newer]) = &cycle[phase];
            let (older, older_again) = self.rows[0].repeated(&self.sums[0], older);
            let (newer, newer_again) = self.rows[1].repeated(&self.sums[1], newer);
            if !(older_again && newer_again) {
                return done;
            }
            self.sums = [older, newer];
            phase = if phase + 1 < cycle.len() { phase + 1 } else { 0 };
        }
        most
    }
}

impl HingeRow<1> {
    /// The sums after another iteration with the velocities of `push`, and whether it has the same effect again.
    #[inline(always)]
    fn repeated(&self, sums: &Sums<1>, push: &Push<1>) -> (Sums<1>, bool) {
        let motor = self.bounded_motor(sums.motor + push.motor_wanted);
        let limit = sums.limit + push.limit;
        let pin = [sums.pin[0] + push.pin[0], sums.pin[1] + push.pin[1]];
        let same_motor = bits(motor - sums.motor) == bits(push.motor);
        let same_limit = if push.lets_go.every() {
            bits(sums.limit) == bits(push.limit_given)
        } else {
            self.would_pull(limit).none()
        };
        (Sums { pin, limit, motor }, same_motor && same_limit)
    }
}

fn same(a: &Twists<1>, b: &Twists<1>) -> bool {
    let every = |twists: &Twists<1>| twists.map(|twist| [bits(twist.x), bits(twist.y), bits(twist.omega)]);
    every(a) == every(b)
}

fn bits(lane: Lanes<1>) -> u32 {
    lane.0[0].to_bits()
}
