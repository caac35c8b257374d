//! The work that `cohelm bench lander` times, and `bench/gymnasium_rate.py` times with Gymnasium itself.

#[cfg(feature = "lanes")]
use crate::gymnasium::Order;
use crate::gymnasium::{Action, GymnasiumLander};
use crate::random::Generator;

/// What was flown; reading it keeps the compiler from leaving the work out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomFlights {
    /// Episodes that ended.
    pub episodes: u32,
    /// Sum of all rewards.
    pub total_reward: f64,
}

/// Flies `steps` ticks of `LunarLander-v3` with uniformly random discrete actions, beginning anew after every ending; resets are
/// part of the work. The same `seed` gives the same flights.
pub fn random_flights(steps: u32, seed: u64) -> RandomFlights {
    let mut lander = GymnasiumLander::usual();
    lander.reset(seed);
    let mut pilot = Generator::new(seed.wrapping_add(1));
    let mut flown = RandomFlights { episodes: 0, total_reward: 0.0 };
    for _ in 0..steps {
        let action = Action::DISCRETE[pilot.integers(0, 4) as usize];
        let outcome = lander.step(action);
        flown.total_reward += outcome.reward;
        if outcome.ending.is_some() {
            flown.episodes += 1;
            lander.restart();
        }
    }
    flown
}

/// The same work for `worlds` at once, at least `steps` ticks of all of them together: [`together::tick`](crate::together::tick) instead of
/// one world after the other.
#[cfg(feature = "lanes")]
pub fn random_flights_together(worlds: usize, steps: u32, seed: u64) -> RandomFlights {
    let mut landers = vec![GymnasiumLander::usual(); worlds];
    let mut pilot = Generator::new(seed.wrapping_add(1));
    let mut orders: Vec<_> =
        (0..worlds as u64).map(|world| Some(Order::Reset(seed.wrapping_add(world)))).collect();
    crate::together::tick(&mut landers, &orders);
    let mut flown = RandomFlights { episodes: 0, total_reward: 0.0 };
    let mut ended = vec![false; worlds];
    for _ in 0..steps.div_ceil(worlds as u32) {
        for (order, ended) in orders.iter_mut().zip(&ended) {
            let action = Action::DISCRETE[pilot.integers(0, 4) as usize];
            *order = Some(if *ended { Order::Restart } else { Order::Step(action) });
        }
        let outcomes = crate::together::tick(&mut landers, &orders);
        for (outcome, ended) in outcomes.into_iter().flatten().zip(&mut ended) {
            flown.total_reward += outcome.reward;
            *ended = outcome.ending.is_some();
            flown.episodes += u32::from(*ended);
        }
    }
    flown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_flights_are_short_and_end_badly() {
        let flown = random_flights(5000, 3);
        assert!((30..100).contains(&flown.episodes), "{flown:?}");
        assert!(flown.total_reward / f64::from(flown.episodes) < -100.0, "{flown:?}");
        assert_eq!(random_flights(5000, 3), flown);
    }

    #[cfg(feature = "lanes")]
    #[test]
    fn together_as_many_flights_are_flown_as_one_after_the_other() {
        let flown = random_flights_together(50, 20_000, 3);
        assert!((150..350).contains(&flown.episodes), "{flown:?}");
        assert!(flown.total_reward / f64::from(flown.episodes) < -100.0, "{flown:?}");
    }
}
