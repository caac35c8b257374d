//! Values: what every command, or any action on axes, is worth, by double Q-learning from nothing but flying.

use crate::checkpoint::Checkpoints;
use crate::choices::{Choices, Pupil};
use crate::curriculum::Curriculum;
use crate::evaluate::{Evaluation, fly_fresh, median_range};
use crate::job::{Job, LearnError, PilotFactory};
use crate::learner::{Learner, Lesson, Weights};
use crate::memory::Memory;
use crate::mirrored::MirroredInput;
use crate::options::{Exploration, Target, Updates, ValueOptions};
use crate::parallel;
use crate::progress::{Profile, Progress, Watch};
use crate::world::{Flown, Log, Policy, World};
use cohelm::action::ActionSpace;
use cohelm::plant::Ending;
use cohelm::random::{Draws, mix_seed};
use cohelm_copilot::encode::{VALUES_VERSION, ValueEncoder};
use cohelm_copilot::outputs::Outputs;
use cohelm_copilot::values::NetworkValues;
use cohelm_copilot::{Card, Kind, Model, TrainedWith};
use cohelm_nn::adam::Adam;
use cohelm_nn::weights::TensorFile;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::time::Instant;

/// Steps that every world flies in a round. Short: threads wait for each other; long: episodes that ended are learnt from
/// late.
const ROUND_STEPS: usize = 32;

/// Streams of random numbers, apart from those of the worlds.
mod stream {
    pub const WEIGHTS: u64 = 0x1;
    pub const BATCHES: u64 = 0x2;
    pub const VALIDATION: u64 = 0x3;
}

/// What value training gives.
#[derive(Clone, Debug)]
pub struct TrainedValues {
    /// The model, its card filled in.
    pub model: Model,
    /// How the chosen checkpoint did on the episodes by which it was chosen.
    pub validation: Evaluation,
    /// Where the time went.
    pub profile: Profile,
}

/// Trains values from nothing (Algorithm 1 and what `options` add to it).
///
/// Rounds are fixed: the worlds fly a few steps, side by side on all threads, with the network as it is; then the network
/// does the updates that ended episodes have earned (K of Algorithm 1). The weights depend on the seed alone, not on the
/// number of threads, nor on whether it was interrupted: with a folder for checkpoints it goes on from the last one.
pub fn train_values(
    job: &Job<'_>,
    options: &ValueOptions,
    pilots: Option<PilotFactory<'_>>,
    watch: Watch<'_>,
) -> Result<TrainedValues, LearnError> {
    let begun = Instant::now();
    let mut training = Training::begin(job, options, pilots)?;
    let mut checkpoints = Checkpoints::new(job, "values.checkpoint", options)?;
    training.resume(&checkpoints)?;
    while training.steps() < options.steps {
        training.round()?;
        if training.validation_is_due() {
            training.validate()?;
        }
        let stopped = watch(&training.progress()).is_break();
        if stopped || checkpoints.is_due() {
            training.save(&mut checkpoints)?;
        }
        if stopped {
            return Err(LearnError::Stopped);
        }
    }
    training.profile.wall = begun.elapsed();
    training.finish()
}

struct Training<'a> {
    job: &'a Job<'a>,
    options: &'a ValueOptions,
    space: ActionSpace,
    choices: Choices,
    worlds: Vec<World>,
    mirror: Option<MirroredInput>,
    learner: Learner,
    memory: Memory,
    curriculum: Curriculum,
    rounds: u64,
    /// Updates that ended episodes have earned and that are not done yet.
    owed: f64,
    updates: u64,
    validations: u32,
    best: Option<(Evaluation, Pupil)>,
    recent: Recent,
    profile: Profile,
}

impl<'a> Training<'a> {
    fn begin(
        job: &'a Job<'a>,
        options: &'a ValueOptions,
        pilots: Option<PilotFactory<'_>>,
    ) -> Result<Self, LearnError> {
        options.check(pilots.is_some())?;
        let plant = job.plant()?;
        let choices = Choices::of(job, options, plant.as_ref())?;
        let asked = choices.asked(options.sees_asked);
        let encoder = ValueEncoder::new(plant.view().state.len(), asked);
        let mut draws = Draws::fork(job.seed, stream::WEIGHTS);
        let online = choices.pupil(encoder.len(), options, plant.space(), &mut draws)?;
        let mirror = plant.mirror().filter(|_| options.mirror);
        let mirror = mirror.and_then(|mirror| MirroredInput::new(&mirror, &choices, asked));
        let world = |number| World::new(job, options, pilots, &online, number);
        Ok(Self {
            job,
            options,
            space: plant.space().clone(),
            worlds: (0..options.worlds).map(world).collect::<Result<_, _>>()?,
            memory: Memory::new([encoder.len(), choices.width()], options.memory),
            curriculum: Curriculum::new(options.near_goal),
            learner: Learner::new(Weights::begin(online), &choices, options),
            choices,
            mirror,
            rounds: 0,
            owed: 0.0,
            updates: 0,
            validations: 0,
            best: None,
            recent: Recent::default(),
            profile: Profile::default(),
        })
    }

    /// Environment steps flown.
    fn steps(&self) -> u64 {
        self.rounds * (ROUND_STEPS * self.worlds.len()) as u64
    }

    /// How much of the run is over, from 0 to 1.
    fn share(&self) -> f64 {
        (self.steps() as f64 / self.options.steps as f64).min(1.0)
    }

    /// The worlds fly a few steps; then the network learns what ended episodes have earned.
    fn round(&mut self) -> Result<(), LearnError> {
        self.collect();
        self.take_in();
        self.learn()
    }

    fn collect(&mut self) {
        let begun = Instant::now();
        let policy = Policy::Network {
            network: &self.learner.weights.online,
            curriculum: &self.curriculum,
            epsilon: epsilon(&self.options.exploration, self.steps(), self.share()),
            round: self.rounds,
        };
        parallel::map_mut(&mut self.worlds, self.job.threads, |world| world.fly(ROUND_STEPS, policy));
        self.profile.collect += begun.elapsed();
    }

    fn learn(&mut self) -> Result<(), LearnError> {
        let begun = Instant::now();
        let updates = self.due();
        let lesson = Lesson {
            memory: &self.memory,
            mirror: self.mirror.as_ref(),
            options: self.options,
            updates,
            rate: learning_rate(self.options, self.share()),
            threads: self.job.threads,
        };
        let mut draws = Draws::fork(mix_seed(self.job.seed, stream::BATCHES), self.rounds);
        self.recent.loss = self.learner.learn(&lesson, &mut draws, &mut self.profile)?;
        self.profile.learn += begun.elapsed();
        Ok(())
    }

    /// Takes the updates that are due from what is owed.
    fn due(&mut self) -> u64 {
        let updates = self.owed.floor();
        self.owed -= updates;
        self.updates += updates as u64;
        updates as u64
    }

    /// Passes on what was flown in a round: to the memory, the curriculum, and what is still to be learnt.
    fn take_in(&mut self) {
        let before = self.steps();
        self.rounds += 1;
        for world in &self.worlds {
            self.memory.append(&world.memory);
            for flown in &world.flown {
                self.curriculum.note(flown.start, flown.ending == Some(Ending::Goal));
                self.recent.note(flown);
                if before >= self.options.warm_up {
                    self.owed += match self.options.updates {
                        Updates::PerStep(share) => share * f64::from(flown.steps),
                        Updates::PerEpisode(count) => count,
                    };
                }
            }
        }
        if let Target::CopyEvery(period) = self.options.target
            && before / period != self.steps() / period
        {
            let Weights { online, target, .. } = &mut self.learner.weights;
            target.clone_from(online);
        }
    }

    /// Checkpoints are compared at even distances over the second half of the run, the last one at its end.
    fn validation_is_due(&self) -> bool {
        let ValueOptions { validations, .. } = *self.options;
        let due = |done: u32| 0.5 + 0.5 * f64::from(done + 1) / f64::from(validations);
        self.validations < validations && self.share() >= due(self.validations)
    }

    /// Keeps the network if it flies fresh episodes better than any before; of equals the later.
    fn validate(&mut self) -> Result<(), LearnError> {
        let begun = Instant::now();
        let values = self.as_values(&self.learner.weights.average, None)?;
        let set = mix_seed(self.job.seed, stream::VALIDATION);
        let evaluation = fly_fresh(self.job, &values, set, self.options.validation_episodes)?;
        let better = self.best.as_ref().is_none_or(|(best, _)| {
            let score = |evaluation: &Evaluation| (evaluation.landed, evaluation.mean_return);
            score(&evaluation) >= score(best)
        });
        if better {
            self.best = Some((evaluation, self.learner.weights.average.clone()));
        }
        self.validations += 1;
        self.profile.validate += begun.elapsed();
        Ok(())
    }

    /// Writes everything down that cannot be made again. The replay memory can: what was carried out leads through the
    /// same states.
    fn save(&mut self, checkpoints: &mut Checkpoints) -> Result<(), LearnError> {
        let begun = Instant::now();
        let mut file = TensorFile::new();
        let Weights { online, target, average, adam } = &self.learner.weights;
        for (network, prefix) in [(online, "online."), (target, "target."), (average, "average.")] {
            network.save(&mut file, prefix);
        }
        adam.save(&mut file, "adam.");
        if let Some((_, best)) = &self.best {
            best.save(&mut file, "best.");
        }
        for (number, world) in self.worlds.iter().enumerate() {
            world.log.save(number, &self.space, &mut file);
        }
        let best = self.best.as_ref().map(|(evaluation, _)| evaluation.clone());
        let episodes = self.worlds.iter().map(|world| world.log.starts.len()).collect();
        let state = State { rounds: self.rounds, episodes, validations: self.validations, best };
        checkpoints.write(file, &state)?;
        self.profile.save += begun.elapsed();
        Ok(())
    }

    /// Goes on from a checkpoint, if there is one: flies all rounds again from the logs, then takes the weights.
    fn resume(&mut self, checkpoints: &Checkpoints) -> Result<(), LearnError> {
        let begun = Instant::now();
        let Some((file, state)) = checkpoints.read::<State>()? else { return Ok(()) };
        let steps = state.rounds as usize * ROUND_STEPS;
        let log = |(world, &episodes)| Log::load(&file, world, [episodes, steps], &self.space);
        let logs: Vec<Log> = checkpoints.check(state.episodes.iter().enumerate().map(log).collect())?;
        if logs.len() != self.worlds.len() {
            return Err(checkpoints.wrong(&"it has another number of worlds: delete it"));
        }
        while self.rounds < state.rounds {
            let policy = Policy::Logged(&logs);
            parallel::map_mut(&mut self.worlds, self.job.threads, |world| world.fly(ROUND_STEPS, policy));
            self.take_in();
            self.due();
        }
        if self.worlds.iter().zip(&logs).any(|(world, log)| world.log != *log) {
            return Err(checkpoints.wrong(&"its flights end elsewhere now: delete it"));
        }
        let kind = self.learner.weights.online.clone();
        let network = |prefix| checkpoints.check(kind.load(&file, prefix));
        let parameters = kind.params().len();
        self.learner.weights = Weights {
            online: network("online.")?,
            target: network("target.")?,
            average: network("average.")?,
            adam: checkpoints.check(Adam::load(&file, "adam.", parameters))?,
        };
        self.best = match state.best {
            Some(evaluation) => Some((evaluation, network("best.")?)),
            None => None,
        };
        self.validations = state.validations;
        self.profile.resume = begun.elapsed();
        Ok(())
    }

    fn progress(&self) -> Progress {
        let best = self.best.as_ref().map_or(f64::NAN, |(evaluation, _)| evaluation.landed);
        Progress {
            stage: "values".into(),
            done: self.steps(),
            total: self.options.steps,
            numbers: vec![
                ("landed of the last 100", self.recent.landed()),
                ("difficulty", self.curriculum.difficulty()),
                ("updates", self.updates as f64),
                ("loss", f64::from(self.recent.loss)),
                ("best landed in validation", best),
            ],
        }
    }

    fn finish(mut self) -> Result<TrainedValues, LearnError> {
        let (validation, network) = match self.best.take() {
            Some(best) => best,
            None => {
                self.validate()?;
                self.best.take().expect("the first is the best")
            }
        };
        let range = median_range(self.job, &self.as_values(&network, None)?)?;
        let card = Card { scores: json!({ "validation": validation }), ..self.card(Some(range))? };
        Ok(TrainedValues {
            model: Model::of_values(&card, network.to_network())?,
            validation,
            profile: self.profile,
        })
    }

    fn as_values(&self, network: &Pupil, range: Option<f64>) -> Result<NetworkValues, LearnError> {
        let values = NetworkValues::new(&self.card(range)?, network.to_network());
        values.ok_or_else(|| LearnError::NoActions(self.job.task.plant.clone()))
    }

    fn card(&self, median_range: Option<f64>) -> Result<Card, LearnError> {
        let plant = self.job.plant()?;
        Ok(Card {
            name: self.job.name.into(),
            kind: Kind::Values,
            variant: self.job.variant.map(Into::into),
            task: self.job.task.clone(),
            plant_version: self.job.plants.entry(self.job.task)?.version,
            space: plant.space().clone(),
            state: plant.view().state.len(),
            goals: plant.view().goals.len(),
            goal_spread: None,
            encoder_version: VALUES_VERSION,
            sees_asked: self.options.sees_asked,
            free_outputs: matches!(self.choices, Choices::Commands(outputs) if Some(outputs) != Outputs::of(plant.space())),
            seed: self.job.seed,
            options: json!(self.options),
            trained_with: TrainedWith {
                cohelm: env!("CARGO_PKG_VERSION").into(),
                kernel: cohelm_nn::kernel_name(),
            },
            median_range,
            scores: json!({}),
        })
    }
}

/// What a checkpoint says beside weights and logs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    rounds: u64,
    /// Episodes that each world has begun.
    episodes: Vec<usize>,
    validations: u32,
    best: Option<Evaluation>,
}

/// The last numbers of the learning curve.
#[derive(Clone, Debug, Default)]
struct Recent {
    landed: Vec<bool>,
    loss: f32,
}

impl Recent {
    fn note(&mut self, flown: &Flown) {
        if flown.own {
            self.landed.push(flown.ending == Some(Ending::Goal));
        }
    }

    fn landed(&self) -> f64 {
        let last = &self.landed[self.landed.len().saturating_sub(100)..];
        last.iter().filter(|landed| **landed).count() as f64 / last.len().max(1) as f64
    }
}

fn epsilon(exploration: &Exploration, steps: u64, share: f64) -> f64 {
    let Exploration { first, then, steps: over, last, last_from, .. } = *exploration;
    if share >= last_from {
        return last;
    }
    let fallen = (steps as f64 / over.max(1) as f64).min(1.0);
    first + fallen * (then - first)
}

fn learning_rate(options: &ValueOptions, share: f64) -> f32 {
    let [first, last] = options.learning_rate;
    first + share as f32 * (last - first)
}
