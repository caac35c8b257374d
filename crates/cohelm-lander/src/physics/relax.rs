//! The iterations over the velocities of both hinges, with an exact short cut for a single world.
//!
//! In flight the velocities mostly come to a standstill after some twenty iterations, or to a cycle of a few states, while the
//! sums of motor and limit go on growing against each other. Once the velocities return to an earlier state, an iteration can
//! only do what it did then, unless motor or limit reach a bound. So the rest are replayed on the sums alone: a few additions
//! instead of two systems of equations, and every bit as if they had been computed.

use super::hinge_row::{HingeRow, Push, Sums, Twist};
use super::lanes::Lanes;

/// Longest cycle of velocities that is looked for. In random and controlled flights nine in ten are of one or two states.
const LONGEST_CYCLE: usize = 8;

/// Twists of hull, first leg, second leg.
pub(crate) type Twists<L> = [Twist<L>; 3];

/// Both hinges in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hinges<L> {
    pub rows: [HingeRow<L>; 2],
    pub sums: [Sums<L>; 2],
}

impl<L: Lanes> Hinges<L> {
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
type Iteration = (Twists<f32>, [Push<f32>; 2]);

impl Hinges<f32> {
    /// As many calls of [`Hinges::iterate`], with their bits, in less time.
    pub fn relax(&mut self, twists: &mut Twists<f32>, iterations: u32) {
        let mut cycle = [(*twists, [Push::NONE; 2]); LONGEST_CYCLE];
        let mut left = iterations;
        while left > 0 {
            let anchor = *twists;
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

impl HingeRow<f32> {
    /// The sums after another iteration with the velocities of `push`, and whether it has the same effect again.
    #[inline(always)]
    fn repeated(&self, sums: &Sums<f32>, push: &Push<f32>) -> (Sums<f32>, bool) {
        let motor = self.bounded_motor(sums.motor + push.motor_wanted);
        let limit = sums.limit + push.limit;
        let pin = [sums.pin[0] + push.pin[0], sums.pin[1] + push.pin[1]];
        let same_motor = (motor - sums.motor).to_bits() == push.motor.to_bits();
        let same_limit = if push.lets_go {
            sums.limit.to_bits() == push.limit_given.to_bits()
        } else {
            !self.would_pull(limit)
        };
        (Sums { pin, limit, motor }, same_motor && same_limit)
    }
}

/// Whether all bits agree. One number after the other: to compare all of them at once, the compiler would read back from memory
/// what has only just been written.
fn same(a: &Twists<f32>, b: &Twists<f32>) -> bool {
    let differ = |a: f32, b: f32| a.to_bits() ^ b.to_bits();
    let twists = a.iter().zip(b);
    twists.fold(0, |all, (a, b)| all | differ(a.omega, b.omega) | differ(a.x, b.x) | differ(a.y, b.y)) == 0
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::craft::{Controls, Craft, Engines, Ground, Settings, Start};

    const STEP_S: f32 = 0.02;

    /// Both hinges of a craft that has flown for a while, pushed and steered at random: limits reached, left and free.
    fn problem(push: [f64; 2], engines: [bool; 3], ticks: u32) -> (Hinges<f32>, Twists<f32>) {
        let ground = Ground::polyline(&[[-100.0, 0.0], [100.0, 0.0]]).expect("a chain");
        let start = Start { push, ..Start::at(0.0, 90.0) };
        let mut craft = Craft::place(&ground, &start, Settings::EXACT);
        for _ in 0..ticks {
            craft.tick(&Controls::IDLE);
        }
        let [main, left, right] = engines;
        craft.tick(&Controls { engines: Engines::burning(main, left, right), ..Controls::IDLE });
        craft.world().velocity_problem(STEP_S)
    }

    fn problems() -> impl Strategy<Value = (Hinges<f32>, Twists<f32>)> {
        let push = -1000.0..1000.0_f64;
        ([push.clone(), push], any::<[bool; 3]>(), 0..80_u32)
            .prop_map(|(push, engines, ticks)| problem(push, engines, ticks))
    }

    fn all_bits(hinges: &Hinges<f32>, twists: &Twists<f32>) -> Vec<u32> {
        let sums = hinges.sums.iter().flat_map(|sums| [sums.pin[0], sums.pin[1], sums.limit, sums.motor]);
        sums.chain(twists.iter().flat_map(|twist| [twist.x, twist.y, twist.omega]))
            .map(f32::to_bits)
            .collect()
    }

    proptest! {
        #[test]
        fn the_short_cut_has_the_bits_of_the_long_way(problem in problems(), iterations in 0..400_u32) {
            let (mut hinges, mut twists) = problem;
            let (mut short, mut short_twists) = problem;
            for _ in 0..iterations {
                hinges.iterate(&mut twists);
            }
            short.relax(&mut short_twists, iterations);
            prop_assert_eq!(all_bits(&short, &short_twists), all_bits(&hinges, &twists));
        }
    }

    /// Otherwise the property above would say nothing about the short cut.
    #[test]
    fn most_flights_in_which_the_limits_hold_come_to_a_cycle() {
        let cycles = |ticks: u32| {
            let (mut hinges, mut twists) = problem([300.0, -200.0], [false, true, false], ticks);
            for _ in 0..100 {
                hinges.iterate(&mut twists);
            }
            let (before, mut found) = (twists, false);
            for _ in 0..LONGEST_CYCLE {
                hinges.iterate(&mut twists);
                found |= same(&twists, &before);
            }
            found
        };
        let found = (40..80).filter(|ticks| cycles(*ticks)).count();
        assert!(found > 20, "{found} of 40");
    }
}
