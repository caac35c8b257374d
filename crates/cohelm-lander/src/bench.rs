//! The work that `cohelm bench lander` times, and `bench/gymnasium_rate.py` times with Gymnasium itself.

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
}
