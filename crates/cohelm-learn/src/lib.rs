//! Training of co-pilots, written straight down: one function a model.
//!
//! | module | what it explains |
//! |---|---|
//! | [`values`] | [`train_values`]: what commands are worth, by double DQN (Algorithm 1 and what it needed) |
//! | [`options`] | every option of it with its reason; presets `default` and `paper` |
//! | [`mod@evaluate`] | how well values fly when the goal is known |
//!
//! Plants come by name from a registry and simulated pilots from a factory: this crate names none. It does no input or
//! output but the checkpoints it is asked for, and prints nothing: progress goes to a callback.
#![forbid(unsafe_code)]

mod checkpoint;
mod choices;
mod curriculum;
pub mod evaluate;
mod fit;
mod flights;
pub mod intent;
pub mod intent_options;
mod job;
mod learner;
pub mod live;
mod memory;
mod mirrored;
pub mod options;
mod parallel;
pub mod people;
mod progress;
mod score;
mod sequence;
pub mod ship;
pub mod values;
mod wanting;
mod window;
mod world;

pub use evaluate::{Evaluation, evaluate};
pub use intent::{ClosedLoop, FIRST_TEST_PILOT, IntentProfile, TrainedIntent, train_intent};
pub use intent_options::IntentOptions;
pub use job::{Job, LearnError, PilotFactory};
pub use live::{LiveLearner, LiveOptions};
pub use options::ValueOptions;
pub use people::{IntentOfPeople, RecordedFlight, train_intent_from};
pub use progress::{Profile, Progress, Watch};
pub use score::{HeadScores, IntentScore};
pub use values::{TrainedValues, train_values};
