//! Worlds that are stepped together have, each, the bits that they have alone.
#![cfg(feature = "lanes")]

use cohelm_lander::gymnasium::{Action, GymnasiumLander, GymnasiumOptions, Order, Outcome};
use cohelm_lander::random::Generator;
use cohelm_lander::together::tick;
use proptest::prelude::*;

/// Everything that a tick brought, to the bit.
fn bits(outcome: &Outcome) -> ([u32; 8], u64, Option<&'static str>) {
    let ending = outcome.ending.map(cohelm::plant::Ending::word);
    (outcome.observation.map(f32::to_bits), outcome.reward.to_bits(), ending)
}

/// The same worlds twice: stepped together, and each alone.
struct Twins {
    together: Vec<GymnasiumLander>,
    alone: Vec<GymnasiumLander>,
}

impl Twins {
    /// Calm ones and windy ones by turns, each with a seed of its own.
    fn new(worlds: usize, first_seed: u64) -> Twins {
        let world = |index: usize| {
            let options = GymnasiumOptions { enable_wind: index % 2 == 1, ..GymnasiumOptions::default() };
            let mut world = GymnasiumLander::new(options).expect("usual options");
            world.reset(first_seed + index as u64);
            world
        };
        let together: Vec<_> = (0..worlds).map(world).collect();
        Twins { alone: together.clone(), together }
    }

    /// One tick; fails where a world is not its twin afterwards. Returns what it brought.
    fn tick(&mut self, orders: &[Option<Order>]) -> Vec<Option<Outcome>> {
        let outcomes = tick(&mut self.together, orders);
        for (index, order) in orders.iter().enumerate() {
            let alone = &mut self.alone[index];
            let expected = order.map(|order| match order {
                Order::Step(action) => alone.step(action),
                Order::Reset(seed) => begun(alone.reset(seed)),
                Order::Restart => begun(alone.restart()),
            });
            assert_eq!(outcomes[index].as_ref().map(bits), expected.as_ref().map(bits), "world {index}");
            assert_eq!(self.together[index], self.alone[index], "world {index}");
        }
        outcomes
    }

    /// Flies on, each world with actions of this pilot, and begins anew after each ending. Returns how many there were.
    fn fly(&mut self, ticks: usize, mut pilot: impl FnMut(&GymnasiumLander) -> Action) -> usize {
        let (mut over, mut endings) = (vec![false; self.together.len()], 0);
        for _ in 0..ticks {
            let worlds = self.together.iter().zip(&over);
            let order = |(world, over): (&GymnasiumLander, &bool)| {
                Some(if *over { Order::Restart } else { Order::Step(pilot(world)) })
            };
            let orders: Vec<_> = worlds.map(order).collect();
            let outcomes = self.tick(&orders);
            over = outcomes.iter().map(|outcome| outcome.is_some_and(|now| now.ending.is_some())).collect();
            endings += over.iter().filter(|over| **over).count();
        }
        endings
    }
}

fn begun(observation: [f32; 8]) -> Outcome {
    Outcome { observation, reward: 0.0, ending: None }
}

/// Comes down on the legs, mostly, and stays there with the engines off.
fn careful(world: &GymnasiumLander) -> Action {
    let [x, y, vx, vy, angle, spin, first, second] = world.observation();
    if first + second > 0.0 {
        return Action::Nothing;
    }
    let lean = angle - (0.5 * x + vx).clamp(-0.4, 0.4);
    if vy < -0.1 - 0.4 * y {
        Action::Main
    } else if lean + spin > 0.1 {
        Action::Right
    } else if lean + spin < -0.1 {
        Action::Left
    } else {
        Action::Nothing
    }
}

#[test]
fn hundreds_of_random_flights_with_and_without_wind_are_those_of_the_worlds_alone() {
    let mut pilot = Generator::new(1);
    let random = |_: &GymnasiumLander| Action::DISCRETE[pilot.integers(0, 4) as usize];
    let endings = Twins::new(64, 100).fly(600, random);
    assert!(endings > 300, "{endings} flights");
}

#[test]
fn landing_resting_and_falling_asleep_is_that_of_the_worlds_alone() {
    let mut twins = Twins::new(48, 500);
    let mut landed = 0;
    for _ in 0..2 {
        twins.fly(500, careful);
        landed += twins.together.iter().filter(|world| world.craft().legs_touching() == [true; 2]).count();
    }
    assert!(landed > 10, "{landed} worlds standing");
}

#[test]
fn worlds_without_an_order_stand_still() {
    let mut twins = Twins::new(5, 7);
    let before = twins.together[3].clone();
    let orders = [Some(Order::Step(Action::Main)), Some(Order::Reset(9)), Some(Order::Restart), None, None];
    assert_eq!(twins.tick(&orders)[3], None);
    assert_eq!(twins.together[3], before);
    assert_eq!(tick(&mut [], &[]), []);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Any number of worlds, so that registers are filled partly, with throttles, pauses and resets at different times.
    #[test]
    fn whatever_they_are_told_is_done_as_alone(worlds in 1..70_usize, seed in 0..1000_u64, ticks in 1..120_usize) {
        let (mut twins, mut draws) = (Twins::new(worlds, seed), Generator::new(seed));
        for _ in 0..ticks {
            let orders: Vec<_> = (0..worlds).map(|_| order(&mut draws)).collect();
            twins.tick(&orders);
        }
    }
}

fn order(draws: &mut Generator) -> Option<Order> {
    match draws.integers(0, 60) {
        0 => None,
        1 => Some(Order::Restart),
        2 => Some(Order::Reset(draws.integers(0, 1000) as u64)),
        _ => {
            let throttles = [draws.uniform(-1.0, 1.0) as f32, draws.uniform(-1.0, 1.0) as f32];
            Some(Order::Step(Action::Throttles(throttles)))
        }
    }
}
