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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::craft::{Controls, Craft, Engines, Ground, Settings, Start};
    use crate::physics::hinge_row::{HingeRow, Sums};

    const STEP_S: f32 = 0.02;
    const LANES: usize = 8;

    /// Both hinges of a craft that has flown for a while, pushed and steered at random: limits reached, left and free.
    fn problem(push: [f64; 2], engines: [bool; 3], ticks: u32) -> (Hinges<1>, Twists<1>) {
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

    fn problems() -> impl Strategy<Value = (Hinges<1>, Twists<1>)> {
        let push = -1000.0..1000.0_f64;
        ([push.clone(), push], any::<[bool; 3]>(), 0..80_u32)
            .prop_map(|(push, engines, ticks)| problem(push, engines, ticks))
    }

    fn all_bits(hinges: &Hinges<1>, twists: &Twists<1>) -> Vec<u32> {
        let sums = hinges.sums.iter().flat_map(|sums| [sums.pin[0], sums.pin[1], sums.limit, sums.motor]);
        sums.chain(twists.iter().flat_map(|twist| [twist.x, twist.y, twist.omega])).map(bits).collect()
    }

    /// The same numbers of several worlds side by side.
    struct Packed<'a, T>(&'a [T; LANES]);

    impl<T> Packed<'_, T> {
        fn lanes(&self, number: impl Fn(&T) -> Lanes<1>) -> Lanes<LANES> {
            Lanes(std::array::from_fn(|lane| number(&self.0[lane]).0[0]))
        }

        fn array<const N: usize>(&self, numbers: impl Fn(&T) -> [Lanes<1>; N]) -> [Lanes<LANES>; N] {
            std::array::from_fn(|i| self.lanes(|one| numbers(one)[i]))
        }
    }

    fn pack_row(rows: Packed<HingeRow<1>>) -> HingeRow<LANES> {
        HingeRow {
            hull_arm: rows.array(|row| row.hull_arm),
            leg_arm: rows.array(|row| row.leg_arm),
            inverse_masses: rows.array(|row| row.inverse_masses),
            matrix: rows.array(|row| row.matrix),
            inverses: rows.array(|row| row.inverses),
            motor_mass: rows.lanes(|row| row.motor_mass),
            motor_speed: rows.lanes(|row| row.motor_speed),
            max_motor_impulse: rows.lanes(|row| row.max_motor_impulse),
            limit_side: rows.lanes(|row| row.limit_side),
        }
    }

    fn pack_sums(sums: Packed<Sums<1>>) -> Sums<LANES> {
        let (limit, motor) = (sums.lanes(|sums| sums.limit), sums.lanes(|sums| sums.motor));
        Sums { pin: sums.array(|sums| sums.pin), limit, motor }
    }

    fn pack(worlds: &[(Hinges<1>, Twists<1>); LANES]) -> (Hinges<LANES>, Twists<LANES>) {
        let hinges = Hinges {
            rows: std::array::from_fn(|i| pack_row(Packed(&worlds.map(|(hinges, _)| hinges.rows[i])))),
            sums: std::array::from_fn(|i| pack_sums(Packed(&worlds.map(|(hinges, _)| hinges.sums[i])))),
        };
        let worlds = Packed(worlds);
        let twists = std::array::from_fn(|body| Twist {
            x: worlds.lanes(|(_, twists)| twists[body].x),
            y: worlds.lanes(|(_, twists)| twists[body].y),
            omega: worlds.lanes(|(_, twists)| twists[body].omega),
        });
        (hinges, twists)
    }

    /// World number `lane` of several.
    fn unpack(
        packed: &(Hinges<LANES>, Twists<LANES>),
        lane: usize,
        world: &Hinges<1>,
    ) -> (Hinges<1>, Twists<1>) {
        let one = |lanes: Lanes<LANES>| Lanes([lanes.0[lane]]);
        let (hinges, twists) = packed;
        let sums = hinges.sums.map(|sums| Sums {
            pin: sums.pin.map(one),
            limit: one(sums.limit),
            motor: one(sums.motor),
        });
        let twists = twists.map(|twist| Twist { x: one(twist.x), y: one(twist.y), omega: one(twist.omega) });
        (Hinges { rows: world.rows, sums }, twists)
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

        #[test]
        fn each_of_eight_lanes_has_the_bits_of_its_world_alone(problems in prop::array::uniform8(problems())) {
            let (mut together, mut twists) = pack(&problems);
            for _ in 0..180 {
                together.iterate(&mut twists);
            }
            for (lane, (mut hinges, mut alone)) in problems.into_iter().enumerate() {
                let (packed, packed_twists) = unpack(&(together, twists), lane, &hinges);
                for _ in 0..180 {
                    hinges.iterate(&mut alone);
                }
                prop_assert_eq!(all_bits(&packed, &packed_twists), all_bits(&hinges, &alone), "lane {}", lane);
            }
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
