//! Intent: which goal the pilot wants, by LSTMs that learn from flights in which they took part.

use crate::checkpoint::Checkpoints;
use crate::fit::{Aim, Fitting, School};
use crate::flights::{Flight, Guide, Help, Plan, RULES, fly_all, pilot_of};
use crate::intent_options::IntentOptions;
use crate::job::{Job, LearnError, PilotFactory};
use crate::parallel;
use crate::progress::{Progress, Watch};
use crate::score::{HeadScores, score};
use crate::sequence::{MirroredSequence, Sequence};
use cohelm::arbitration::Rule;
use cohelm::intent::Head;
use cohelm::plant::Ending;
use cohelm::random::{Draws, mix_seed};
use cohelm_copilot::encode::{INTENT_VERSION, IntentEncoder};
use cohelm_copilot::model::IntentNetworks;
use cohelm_copilot::values::NetworkValues;
use cohelm_copilot::{Card, Kind, Model, Network, TrainedWith};
use cohelm_nn::adam::Adam;
use cohelm_nn::goal_head;
use cohelm_nn::lstm::{Lstm, LstmShape};
use cohelm_nn::weights::TensorFile;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Numbers of the pilots that intent is scored on begin here; those it learns from are below.
pub const FIRST_TEST_PILOT: u64 = 1_000;

/// Streams of random numbers, apart from all others.
mod stream {
    pub const WEIGHTS: u64 = 0x4_0000;
    pub const ORDER: u64 = 0x5_0000;
    /// Numbers of the episodes on which it is scored begin here.
    pub const TEST_EPISODES: u64 = 1 << 40;
}

/// What intent training gives.
#[derive(Clone, Debug)]
pub struct TrainedIntent {
    /// The model, its card filled in.
    pub model: Model,
    /// Accuracy, mean c and calibration error against time, for each head, on flights of pilots it never met.
    pub scores: Vec<HeadScores>,
    /// How flights with those pilots went, with each head in the loop.
    pub closed_loop: Vec<ClosedLoop>,
    /// Where the time went.
    pub profile: IntentProfile,
}

/// Flights under minimal intervention (Eqs. 3–4) with one head in the loop and pilots it never met.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClosedLoop {
    /// Which head; where goals are hidden, the calibrated one, whose spread is the confidence.
    pub head: Head,
    /// Episodes flown.
    pub episodes: usize,
    /// Share that ended at the pilot's goal.
    pub landed: f64,
    /// Share that ended elsewhere.
    pub elsewhere: f64,
    /// Share of all ticks at which the goal that was taken was the pilot's.
    pub right: f64,
    /// The same at the middle tick of each episode.
    pub right_midway: f64,
    /// The same at the last tick.
    pub right_at_end: f64,
}

/// Where the time of intent training went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct IntentProfile {
    /// Altogether, by the clock.
    pub wall: Duration,
    /// Flying.
    pub fly: Duration,
    /// Fitting.
    pub fit: Duration,
    /// Scoring, its flights included.
    pub score: Duration,
}

/// Trains intent for a value model, with simulated pilots of numbers below [`FIRST_TEST_PILOT`].
///
/// Rounds of flying and fitting: first without a network, then with the last one in the loop, all flights so far being
/// learnt from anew (aggregation). The weights depend on the seed and the value model alone.
pub fn train_intent(
    job: &Job<'_>,
    values: &Model,
    options: &IntentOptions,
    pilots: PilotFactory<'_>,
    watch: Watch<'_>,
) -> Result<TrainedIntent, LearnError> {
    let begun = Instant::now();
    let mut training = Training::begin(job, values, options, pilots)?;
    training.resume()?;
    for round in 0..=options.rounds {
        training.fly(round)?;
        if training.networks.len() <= round as usize {
            training.fit(round, watch)?;
        }
    }
    training.profile.wall = begun.elapsed();
    training.finish()
}

struct Training<'a> {
    job: &'a Job<'a>,
    options: &'a IntentOptions,
    values: &'a Model,
    help: Help<'a>,
    card: Card,
    checkpoints: Checkpoints,
    mirror: Option<MirroredSequence>,
    sequences: Vec<Sequence>,
    episodes: u64,
    /// What each finished round gave.
    networks: Vec<Arc<IntentNetworks>>,
    /// What the present round has so far, and the epochs that are done.
    fittings: Option<([Fitting; 2], u32)>,
    profile: IntentProfile,
}

impl<'a> Training<'a> {
    fn begin(
        job: &'a Job<'a>,
        values: &'a Model,
        options: &'a IntentOptions,
        pilots: PilotFactory<'a>,
    ) -> Result<Self, LearnError> {
        options.check()?;
        let help = Help {
            values: values_of(job, values)?,
            median_range: values.card().median_range.unwrap_or(f64::NAN),
            pilots,
        };
        let card = card(job, json!({ "training": options, "values": values.hash() }), options.goals_hidden)?;
        Ok(Self {
            job,
            options,
            values,
            help,
            checkpoints: Checkpoints::new(job, "intent.checkpoint", &card.options)?,
            mirror: mirror(job, options)?,
            card,
            sequences: Vec::new(),
            episodes: 0,
            networks: Vec::new(),
            fittings: None,
            profile: IntentProfile::default(),
        })
    }

    /// Flies the episodes of a round and adds them to all before.
    fn fly(&mut self, round: u32) -> Result<(), LearnError> {
        let begun = Instant::now();
        let before = round.checked_sub(1).and_then(|before| self.networks.get(before as usize));
        let kinds = before.map_or_else(first_kinds, |networks| self.kinds_with(networks));
        let episodes =
            if round == 0 { self.options.first_episodes * kinds.len() } else { self.options.round_episodes };
        let plans: Vec<Plan> = (0..episodes)
            .map(|i| {
                let episode = self.episodes + i as u64;
                let (rule, guide) = kinds[i % kinds.len()].clone();
                let pilot = pilot_of(self.job.seed, episode, self.options.pilots, self.options.silent);
                Plan { rule, guide, pilot, episode }
            })
            .collect();
        let flights = fly_all(self.job, &self.help, &plans)?;
        self.sequences.extend(flights.into_iter().map(|flight| flight.sequence));
        if round == 0 && self.options.goals_hidden {
            self.card.goal_spread = Some(goal_spread(&self.sequences));
        }
        self.episodes += episodes as u64;
        self.profile.fly += begun.elapsed();
        Ok(())
    }

    /// Every rule with every head, so that the network meets whatever it may cause.
    fn kinds_with(&self, networks: &Arc<IntentNetworks>) -> Vec<(Rule, Guide)> {
        let guides = self.guides(networks);
        RULES
            .into_iter()
            .flat_map(|rule| guides.iter().map(move |(_, guide)| (rule, guide.clone())))
            .collect()
    }

    /// What the networks can be in the loop: under every head, or imagining a goal.
    fn guides(&self, networks: &Arc<IntentNetworks>) -> Vec<(Head, Guide)> {
        let card = || Box::new(self.card.clone());
        if self.options.goals_hidden {
            return vec![(Head::Calibrated, Guide::Imagined(card(), networks.clone()))];
        }
        Head::ALL.map(|head| (head, Guide::Network(card(), networks.clone(), head))).into()
    }

    /// Fits both networks, from nothing, to all flights so far.
    fn fit(&mut self, round: u32, watch: Watch<'_>) -> Result<(), LearnError> {
        let begun = Instant::now();
        let (mut fittings, first) = match self.fittings.take() {
            Some(interrupted) => interrupted,
            None => (self.fresh(round), 0),
        };
        for epoch in first..self.options.epochs {
            let seed = mix_seed(self.job.seed, round.into());
            let school =
                School { sequences: &self.sequences, mirror: self.mirror.as_ref(), options: self.options };
            let losses = fit_epoch(&mut fittings, &school, (epoch, seed), self.job);
            check(losses, &fittings)?;
            let stopped = watch(&self.progress(round, epoch, losses)).is_break();
            if stopped || self.checkpoints.is_due() {
                self.save(&fittings, epoch + 1)?;
            }
            if stopped {
                return Err(LearnError::Stopped);
            }
        }
        let [regression, calibrated] = fittings.map(|fitting| fitting.network);
        self.networks.push(Arc::new(IntentNetworks { regression, calibrated }));
        self.profile.fit += begun.elapsed();
        Ok(())
    }

    fn fresh(&self, round: u32) -> [Fitting; 2] {
        Aim::BOTH.map(|aim| {
            let seed = mix_seed(self.job.seed, stream::WEIGHTS + aim as u64);
            let mut draws = Draws::fork(seed, round.into());
            let shape = shape(&self.card, aim, self.options.cells);
            Fitting::begin(Lstm::new(shape, || draws.unit() as f32), self.options)
        })
    }

    fn progress(&self, round: u32, epoch: u32, [squared_error, cross_entropy]: [f64; 2]) -> Progress {
        Progress {
            stage: format!("intent, round {round} of {}", self.options.rounds),
            done: u64::from(epoch) + 1,
            total: self.options.epochs.into(),
            numbers: vec![
                ("flights", self.sequences.len() as f64),
                ("squared error", squared_error),
                ("cross-entropy", cross_entropy),
            ],
        }
    }

    /// Writes down what cannot be made again: the flights can.
    fn save(&mut self, fittings: &[Fitting; 2], epochs: u32) -> Result<(), LearnError> {
        let mut file = TensorFile::new();
        for (round, networks) in self.networks.iter().enumerate() {
            networks.regression.save(&mut file, &format!("round.{round}.regression."));
            networks.calibrated.save(&mut file, &format!("round.{round}.calibrated."));
        }
        for (fitting, place) in fittings.iter().zip(["regression.", "calibrated."]) {
            fitting.network.save(&mut file, &format!("network.{place}"));
            fitting.adam.save(&mut file, &format!("adam.{place}"));
        }
        self.checkpoints.write(file, &State { rounds: self.networks.len(), epochs })
    }

    /// Takes the weights of a checkpoint, if there is one. Flights are flown again.
    fn resume(&mut self) -> Result<(), LearnError> {
        let Some((file, state)) = self.checkpoints.read::<State>()? else { return Ok(()) };
        let network = |prefix: String| self.checkpoints.check(Lstm::load(&file, &prefix));
        let fitting = |place: &str| {
            let network = network(format!("network.{place}"))?;
            let adam = Adam::load(&file, &format!("adam.{place}"), network.params().len());
            Ok::<_, LearnError>(Fitting { adam: self.checkpoints.check(adam)?, network })
        };
        let rounds = (0..state.rounds).map(|round| {
            let regression = network(format!("round.{round}.regression."))?;
            let calibrated = network(format!("round.{round}.calibrated."))?;
            Ok::<_, LearnError>(Arc::new(IntentNetworks { regression, calibrated }))
        });
        let networks = rounds.collect::<Result<_, _>>()?;
        let fittings = [fitting("regression.")?, fitting("calibrated.")?];
        (self.networks, self.fittings) = (networks, Some((fittings, state.epochs)));
        Ok(())
    }

    /// Scores the last networks with pilots that they never met.
    fn finish(mut self) -> Result<TrainedIntent, LearnError> {
        let begun = Instant::now();
        let networks = self.networks.pop().expect("there is at least one round");
        let (closed_loop, sequences) = self.test(&networks)?;
        let scores = score_all(&networks, &sequences.iter().collect::<Vec<_>>(), self.job);
        self.profile.score = begun.elapsed();
        self.profile.wall += self.profile.score;
        let card = Card {
            scores: json!({ "closed_loop": closed_loop, "heads": scores, "values": self.values.hash() }),
            ..self.card
        };
        let model = Model::of_intent(&card, &networks)?;
        Ok(TrainedIntent { model, scores, closed_loop, profile: self.profile })
    }

    fn test(&self, networks: &Arc<IntentNetworks>) -> Result<(Vec<ClosedLoop>, Vec<Sequence>), LearnError> {
        let (mut closed_loop, mut sequences) = (Vec::new(), Vec::new());
        for (head, guide) in self.guides(networks) {
            let episodes = self.options.test_pilots * self.options.test_episodes as u64;
            let plans: Vec<Plan> = (0..episodes)
                .map(|i| Plan {
                    rule: Rule::Misc,
                    guide: guide.clone(),
                    pilot: Some(FIRST_TEST_PILOT + i % self.options.test_pilots),
                    episode: stream::TEST_EPISODES + i,
                })
                .collect();
            let flights = fly_all(self.job, &self.help, &plans)?;
            closed_loop.push(summary(head, &flights));
            sequences.extend(flights.into_iter().map(|flight| flight.sequence));
        }
        Ok((closed_loop, sequences))
    }
}

/// What a checkpoint says beside weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Finished rounds.
    rounds: usize,
    /// Finished epochs of the round after them.
    epochs: u32,
}

/// Goes through all sequences once with both networks; returns their mean losses a tick.
pub(crate) fn fit_epoch(
    fittings: &mut [Fitting; 2],
    school: &School<'_>,
    (epoch, seed): (u32, u64),
    job: &Job<'_>,
) -> [f64; 2] {
    let mut fittings: Vec<(Aim, &mut Fitting)> = Aim::BOTH.into_iter().zip(fittings.iter_mut()).collect();
    let losses = parallel::map_mut(&mut fittings, job.threads, |(aim, fitting)| {
        let mut draws = Draws::fork(mix_seed(seed, stream::ORDER + *aim as u64), epoch.into());
        fitting.epoch(school, *aim, epoch, &mut draws)
    });
    [losses[0], losses[1]]
}

/// The plant's symmetry, if it has one and it is to be used.
pub(crate) fn mirror(job: &Job<'_>, options: &IntentOptions) -> Result<Option<MirroredSequence>, LearnError> {
    let plant = job.plant()?;
    let mirror = plant.mirror().filter(|_| options.mirror);
    let goals = plant.view().goals.len();
    Ok(mirror.and_then(|mirror| MirroredSequence::new(&mirror, plant.space(), goals)))
}

/// Refuses losses that are no numbers.
pub(crate) fn check(losses: [f64; 2], fittings: &[Fitting; 2]) -> Result<(), LearnError> {
    let finite = losses.iter().all(|loss| loss.is_finite());
    if finite { Ok(()) } else { Err(LearnError::Diverged { updates: fittings[0].adam.steps() }) }
}

/// Scores all heads on flights.
pub(crate) fn score_all(
    networks: &IntentNetworks,
    sequences: &[&Sequence],
    job: &Job<'_>,
) -> Vec<HeadScores> {
    parallel::map(Head::ALL.len(), job.threads, |i| score(networks, Head::ALL[i], sequences))
}

/// How episodes are flown before there is a network: a person alone, one whom values that know the goal help a little,
/// and one whom they do not let fly.
fn first_kinds() -> Vec<(Rule, Guide)> {
    vec![
        (Rule::Hic, Guide::Nobody),
        (Rule::Tolerance { alpha: 0.4 }, Guide::Truth),
        (Rule::Robot, Guide::Truth),
    ]
}

pub(crate) fn shape(card: &Card, aim: Aim, cells: usize) -> LstmShape {
    let encoder =
        IntentEncoder::new(&card.space, card.state, card.goals).expect("a card of a plant with actions");
    let (input, output) = match aim {
        Aim::Position => (encoder.without_goals(), 2),
        Aim::Likelihood => (encoder.with_goals(), goal_head::OUTPUTS),
    };
    LstmShape::new(input, cells, output).expect("a card's widths are small")
}

fn values_of(job: &Job<'_>, model: &Model) -> Result<NetworkValues, LearnError> {
    let Network::Values(network) = model.network() else {
        let reason = format!("{:?} infers intent; give a value model", model.card().name);
        return Err(LearnError::Option { option: "values", reason });
    };
    let plant = job.plant()?;
    if model.card().space != *plant.space() || model.card().task.plant != job.task.plant {
        let reason =
            format!("{:?} was trained for another plant or another set of actions", model.card().name);
        return Err(LearnError::Option { option: "values", reason });
    }
    let values = NetworkValues::new(model.card(), network.clone());
    values.ok_or_else(|| LearnError::NoActions(job.task.plant.clone()))
}

/// Standard deviation of the pilots' goals from their mean, along an axis.
pub(crate) fn goal_spread(sequences: &[Sequence]) -> f64 {
    let flights = sequences.iter().filter(|sequence| sequence.ticks() > 0);
    let wanted: Vec<[f64; 2]> = flights.map(|sequence| sequence.wanted(0).map(f64::from)).collect();
    let n = wanted.len().max(1) as f64;
    let mean = [0, 1].map(|i| wanted.iter().map(|at| at[i]).sum::<f64>() / n);
    let square = |at: &[f64; 2]| [0, 1].map(|i| (at[i] - mean[i]) * (at[i] - mean[i])).iter().sum::<f64>();
    (wanted.iter().map(square).sum::<f64>() / (2.0 * n)).sqrt()
}

/// The card of intent networks for the job's plant, without scores. Where goals are hidden, its spread is still to come.
pub(crate) fn card(job: &Job<'_>, options: Value, goals_hidden: bool) -> Result<Card, LearnError> {
    let plant = job.plant()?;
    let view = plant.view();
    if view.goals.len() < if goals_hidden { 1 } else { 2 } {
        let reason =
            format!("{:?} has {} goals; there is nothing to infer", job.task.plant, view.goals.len());
        return Err(LearnError::Option { option: "task", reason });
    }
    Ok(Card {
        name: job.name.into(),
        kind: Kind::Intent,
        variant: job.variant.map(Into::into),
        task: job.task.clone(),
        plant_version: job.plants.entry(job.task)?.version,
        space: plant.space().clone(),
        state: view.state.len(),
        goals: if goals_hidden { 0 } else { view.goals.len() },
        goal_spread: None,
        encoder_version: INTENT_VERSION,
        sees_asked: false,
        free_outputs: false,
        seed: job.seed,
        options,
        trained_with: TrainedWith {
            cohelm: env!("CARGO_PKG_VERSION").into(),
            kernel: cohelm_nn::kernel_name(),
        },
        median_range: None,
        scores: json!({}),
    })
}

fn summary(head: Head, flights: &[Flight]) -> ClosedLoop {
    let episodes = flights.len();
    let share = |of: &dyn Fn(&Flight) -> bool| {
        flights.iter().filter(|flight| of(flight)).count() as f64 / episodes.max(1) as f64
    };
    let ticks: Vec<bool> = flights.iter().flat_map(|flight| flight.right.iter().copied()).collect();
    ClosedLoop {
        head,
        episodes,
        landed: share(&|flight| flight.ending == Ending::Goal),
        elsewhere: share(&|flight| flight.ending == Ending::Elsewhere),
        right: ticks.iter().filter(|right| **right).count() as f64 / ticks.len().max(1) as f64,
        right_midway: share(&|flight| flight.right.get(flight.right.len() / 2) == Some(&true)),
        right_at_end: share(&|flight| flight.right.last() == Some(&true)),
    }
}
