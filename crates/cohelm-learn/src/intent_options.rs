//! Every option of intent training, with its reason.

use crate::job::LearnError;
use serde::{Deserialize, Serialize};

/// Options of [`train_intent`](crate::train_intent).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct IntentOptions {
    /// Simulated pilots to learn from; others than those it is scored on. Few: it learns persons instead of people.
    pub pilots: u64,
    /// Episodes of each kind flown before there is a network: human alone, and helped by values that know the goal
    /// (constant tolerance, and the robot flying). Alone they teach little: a person alone crashes before the end.
    pub first_episodes: usize,
    /// Rounds in which the network itself is in the loop, its flights added to all before (aggregation). 0: it has
    /// never seen what its own mistakes lead to, and a third of the flights ends on the wrong pad.
    pub rounds: u32,
    /// Episodes a round, spread over rules and heads.
    pub round_episodes: usize,
    /// Share of episodes in which the pilot is silent: nothing can be known then, and a network that never saw silence
    /// takes it for consent.
    pub silent: f64,
    /// Learns every second flight in the plant's mirror, if it has one: each flight teaches two, and left and right
    /// come out alike.
    pub mirror: bool,
    /// Hides the goals: the networks see commands and motion alone and learn to imagine a goal, with a spread that says
    /// how far off it may be. What comes out serves the inference `imagined` and no other.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub goals_hidden: bool,
    /// Cells of the LSTMs.
    pub cells: usize,
    /// Times that each fit goes through all flights.
    pub epochs: u32,
    /// Sequences in an update.
    pub batch: usize,
    /// Ticks of the network (80 ms each) of a flight that are learnt from; a flight that takes longer is cut.
    pub longest: usize,
    /// Adam's learning rate at the beginning of a fit; it falls linearly to 0.
    pub learning_rate: f32,
    /// Largest norm of a gradient. High: one strange flight throws the weights about.
    pub largest_norm: f32,
    /// Pilots that it is scored on, none of which it learnt from.
    pub test_pilots: u64,
    /// Episodes that each of them flies for each head.
    pub test_episodes: usize,
}

impl Default for IntentOptions {
    fn default() -> Self {
        Self {
            pilots: 100,
            first_episodes: 300,
            rounds: 3,
            round_episodes: 1500,
            silent: 0.0,
            mirror: true,
            goals_hidden: false,
            cells: 64,
            epochs: 15,
            batch: 32,
            longest: 100,
            learning_rate: 2e-3,
            largest_norm: 1.0,
            test_pilots: 10,
            test_episodes: 20,
        }
    }
}

impl IntentOptions {
    /// Refuses what cannot be.
    pub(crate) fn check(&self) -> Result<(), LearnError> {
        let wrong = |option, reason: &str| Err(LearnError::Option { option, reason: reason.into() });
        if self.pilots == 0
            || self.first_episodes == 0
            || self.epochs == 0
            || self.batch == 0
            || self.longest == 0
        {
            return wrong("pilots, first_episodes, epochs, batch, longest", "each must be at least 1");
        }
        if !(0.0..=1.0).contains(&self.silent) {
            return wrong("silent", "must be a share, from 0 to 1");
        }
        Ok(())
    }
}
