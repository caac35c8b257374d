//! Learning while a person flies: Algorithm 1 goes on, one finished episode after the other.

use crate::choices::{Choices, Pupil};
use crate::job::LearnError;
use crate::learner::{Learner, Lesson, Weights};
use crate::memory::Memory;
use crate::mirrored::MirroredInput;
use crate::options::{Target, ValueOptions};
use crate::progress::Profile;
use crate::window::Window;
use cohelm::action::Action;
use cohelm::plant::Ending;
use cohelm::random::{Draws, mix_seed};
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::Trajectory;
use cohelm::value::ValueModel;
use cohelm_copilot::encode::ValueEncoder;
use cohelm_copilot::values::NetworkValues;
use cohelm_copilot::{Card, Model, Network};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::num::NonZeroUsize;

/// Options of live learning.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LiveOptions {
    /// Updates a step of the finished episode: K of Algorithm 1 is this times the episode's length.
    pub updates_per_step: f64,
    /// Adam's learning rate. High: forgets in a few episodes what took a hundred thousand steps to learn.
    pub learning_rate: f32,
    /// Share of the memory's first content that is flown at random, so that it knows what mistakes cost.
    pub exploration: f64,
    /// Steps that the model flies by itself before anyone else does, to have something to remember beside one person's
    /// flights. 0: a handful of episodes is all there is to learn from, and the rest is forgotten.
    pub own_steps: u32,
}

impl Default for LiveOptions {
    fn default() -> Self {
        Self { updates_per_step: 0.5, learning_rate: 5e-5, exploration: 0.05, own_steps: 10_000 }
    }
}

/// A value model that learns from every episode it is given.
pub struct LiveLearner {
    plants: Plants,
    options: LiveOptions,
    training: ValueOptions,
    card: Card,
    began_with: String,
    choices: Choices,
    encoder: ValueEncoder,
    mirror: Option<MirroredInput>,
    learner: Learner,
    memory: Memory,
    seed: u64,
    episodes: u64,
}

/// Stream of random numbers of the model's own flights.
const OWN: u64 = 0x9_0000;
/// Stream of the batches.
const BATCHES: u64 = 0xa_0000;

impl LiveLearner {
    /// Goes on from a value model; flies its own steps first, which takes about a tenth of a second for the default.
    pub fn new(plants: &Plants, model: &Model, options: LiveOptions, seed: u64) -> Result<Self, LearnError> {
        let card = model.card().clone();
        let Network::Values(network) = model.network() else {
            let reason = format!("{:?} infers intent; only values learn live", card.name);
            return Err(LearnError::Option { option: "model", reason });
        };
        let training = training_options(&card);
        let plant = plants.make(&card.task)?;
        let choices = Choices::of_card(&card);
        let choices = choices.ok_or_else(|| LearnError::NoActions(card.task.plant.clone()))?;
        let asked = choices.asked(card.sees_asked);
        let encoder = ValueEncoder::new(card.state, asked);
        let mirror = plant.mirror().filter(|_| training.mirror);
        let mut learner = Self {
            plants: plants.clone(),
            options,
            mirror: mirror.and_then(|mirror| MirroredInput::new(&mirror, &choices, asked)),
            learner: Learner::new(Weights::begin(Pupil::from(network)), &choices, &training),
            memory: Memory::new([encoder.len(), choices.width()], training.memory),
            began_with: model.hash().into(),
            training,
            card,
            choices,
            encoder,
            seed,
            episodes: 0,
        };
        learner.fly_alone(model)?;
        Ok(learner)
    }

    /// Learns from a finished episode (it is flown again from what was carried out) and returns the new model.
    pub fn learn(&mut self, trajectory: &Trajectory) -> Result<Model, LearnError> {
        let setup = &trajectory.setup;
        if setup.task.plant != self.card.task.plant || setup.plant_version != self.card.plant_version {
            let reason = format!("a flight of {} cannot teach {:?}", setup.task.plant, self.card.name);
            return Err(LearnError::Option { option: "trajectory", reason });
        }
        self.remember(&setup.task, setup.seed, &trajectory.asked, &trajectory.executed)?;
        self.update(trajectory.ticks())?;
        self.episodes += 1;
        self.model()
    }

    /// Episodes it has learnt from.
    pub fn episodes(&self) -> u64 {
        self.episodes
    }

    /// The model as it is now. Its card says from which it came and after how many episodes.
    fn model(&self) -> Result<Model, LearnError> {
        let variant = Some(format!("live-{}", self.episodes));
        let live =
            json!({ "options": self.options, "began_with": self.began_with, "episodes": self.episodes });
        let options = json!({ "training": self.training, "live": live });
        let card = Card { variant, options, seed: self.seed, scores: json!({}), ..self.card.clone() };
        Ok(Model::of_values(&card, self.learner.weights.online.to_network())?)
    }

    /// Turns an episode into transitions.
    fn remember(
        &mut self,
        task: &Task,
        seed: u64,
        asked: &[Option<Action>],
        executed: &[Option<Action>],
    ) -> Result<(), LearnError> {
        let mut plant = self.plants.make(task)?;
        if *plant.space() != self.card.space {
            let reason = format!("a flight with other actions cannot teach {:?}", self.card.name);
            return Err(LearnError::Option { option: "trajectory", reason });
        }
        plant.reset(seed);
        let mut window = Window::new(self.training.n_step, self.training.discount);
        let mut seen = vec![0.0; self.encoder.len()];
        let mut ending = None;
        for (&asked, &executed) in asked.iter().zip(executed) {
            self.encoder.encode(&plant.view(), plant.pilot_goal(), asked, &mut seen);
            window.see(&seen, &mut self.memory);
            let choice = self.choices.of_executed(executed, plant.view().switches);
            let step = plant.step(executed);
            window.act(&seen, choice, step.reward as f32 * self.training.reward_scale);
            ending = step.ending;
            if ending.is_some() {
                break;
            }
        }
        self.encoder.encode(&plant.view(), plant.pilot_goal(), None, &mut seen);
        window.end(&seen, ending.is_some_and(Ending::is_terminal), &mut self.memory);
        Ok(())
    }

    /// Fills the memory with the model's own flights.
    fn fly_alone(&mut self, model: &Model) -> Result<(), LearnError> {
        let Network::Values(network) = model.network() else { return Ok(()) };
        let Some(mut values) = NetworkValues::new(&self.card, network.clone()) else { return Ok(()) };
        let task = self.card.task.clone();
        let mut plant = self.plants.make(&task)?;
        let mut steps = 0;
        for episode in 0.. {
            if steps >= self.options.own_steps {
                return Ok(());
            }
            let seed = mix_seed(mix_seed(self.seed, OWN), episode) >> 11;
            let mut draws = Draws::fork(seed, OWN);
            plant.reset(seed);
            let mut executed = Vec::new();
            let mut ending = None;
            while ending.is_none() && executed.len() < self.training.episode_cap as usize {
                let estimate = values.estimate(&plant.view(), plant.pilot_goal(), None);
                let best = estimate.candidates()[estimate.best()];
                let random = draws.chance(self.options.exploration);
                let action = if random { self.choices.random(&mut draws) } else { best };
                executed.push(Some(action));
                ending = plant.step(Some(action)).ending;
            }
            steps += executed.len() as u32;
            self.remember(&task, seed, &vec![None; executed.len()], &executed)?;
        }
        Ok(())
    }

    /// K updates.
    fn update(&mut self, steps: usize) -> Result<(), LearnError> {
        if self.memory.len() < self.training.batch {
            return Ok(());
        }
        let lesson = Lesson {
            memory: &self.memory,
            mirror: self.mirror.as_ref(),
            options: &self.training,
            updates: (self.options.updates_per_step * steps as f64).floor() as u64,
            rate: self.options.learning_rate,
            threads: NonZeroUsize::MIN,
        };
        let mut draws = Draws::fork(mix_seed(self.seed, BATCHES), self.episodes);
        self.learner.learn(&lesson, &mut draws, &mut Profile::default())?;
        Ok(())
    }
}

/// The options that the model was trained with, as far as they matter here. A model that learnt live has them too.
fn training_options(card: &Card) -> ValueOptions {
    let options = card.options.get("training").unwrap_or(&card.options);
    let trained: ValueOptions = serde_json::from_value(options.clone()).unwrap_or_default();
    ValueOptions { target: Target::Follow(0.005), ahead: 0, average: 1.0, ..trained }
}
