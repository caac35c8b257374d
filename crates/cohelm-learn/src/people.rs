//! Intent from recorded flights of people.

use crate::fit::{Aim, Fitting, School};
use crate::intent::{card, check, fit_epoch, goal_spread, mirror, score_all, shape};
use crate::intent_options::IntentOptions;
use crate::job::{Job, LearnError};
use crate::progress::{Progress, Watch};
use crate::score::HeadScores;
use crate::sequence::{Scribe, Sequence};
use cohelm::random::{Draws, mix_seed};
use cohelm::trajectory::Trajectory;
use cohelm_copilot::model::IntentNetworks;
use cohelm_copilot::{Card, Model, Network};
use cohelm_nn::lstm::Lstm;
use serde_json::json;
use std::collections::BTreeSet;

/// Streams of random numbers, apart from all others.
mod stream {
    pub const WEIGHTS: u64 = 0x6_0000;
    pub const ORDER: u64 = 0x7_0000;
    pub const HELD_OUT: u64 = 0x8_0000;
}

/// Every how many-th participant is held out for scoring.
const HELD_OUT_OF: usize = 5;

/// A flight and who flew it.
#[derive(Clone, Copy, Debug)]
pub struct RecordedFlight<'a> {
    /// Names the participant; flights of one participant are all learnt from or all held out.
    pub participant: &'a str,
    /// What was flown.
    pub trajectory: &'a Trajectory,
}

/// What training on recorded flights gives.
#[derive(Clone, Debug)]
pub struct IntentOfPeople {
    /// The model, its card filled in.
    pub model: Model,
    /// Participants whose flights were learnt from.
    pub learnt_from: Vec<String>,
    /// Participants it was scored on.
    pub held_out: Vec<String>,
    /// Scores on the flights of those.
    pub scores: Vec<HeadScores>,
    /// Scores, on the same flights, of the model that it began with.
    pub before: Option<Vec<HeadScores>>,
}

/// Trains intent on recorded flights; every fifth participant, at least one, is held out and scored on.
///
/// `begin_with` is a model whose weights are learnt on from; without one the networks begin from nothing, which takes
/// hundreds of flights. Trajectories hold no states: they are flown again from what was carried out.
pub fn train_intent_from(
    job: &Job<'_>,
    flights: &[RecordedFlight<'_>],
    options: &IntentOptions,
    begin_with: Option<&Model>,
    watch: Watch<'_>,
) -> Result<IntentOfPeople, LearnError> {
    options.check()?;
    let (learnt_from, held_out) = split(flights, job.seed)?;
    let of = |participants: &[String]| {
        let theirs =
            flights.iter().filter(|flight| participants.iter().any(|name| name == flight.participant));
        theirs.map(|flight| sequence(job, flight.trajectory)).collect::<Result<Vec<_>, _>>()
    };
    let (train, test) = (of(&learnt_from)?, of(&held_out)?);
    let options_of_card = json!({ "training": options, "participants": learnt_from.len(), "flights": train.len(),
        "began_with": begin_with.map(Model::hash) });
    let card = Card {
        goal_spread: options.goals_hidden.then(|| goal_spread(&train)),
        ..card(job, options_of_card, options.goals_hidden)?
    };
    let mut fittings = begin(job, &card, options, begin_with)?;
    let mirror = mirror(job, options)?;
    let school = School { sequences: &train, mirror: mirror.as_ref(), options };
    for epoch in 0..options.epochs {
        let seed = mix_seed(job.seed, stream::ORDER);
        let losses = fit_epoch(&mut fittings, &school, (epoch, seed), job);
        check(losses, &fittings)?;
        let numbers = vec![("flights", train.len() as f64), ("cross-entropy", losses[1])];
        let (done, total) = (u64::from(epoch) + 1, options.epochs.into());
        if watch(&Progress { stage: "intent from flights".into(), done, total, numbers }).is_break() {
            return Err(LearnError::Stopped);
        }
    }
    let [regression, calibrated] = fittings.map(|fitting| fitting.network);
    let networks = IntentNetworks { regression, calibrated };
    let test: Vec<&Sequence> = test.iter().collect();
    let scores = score_all(&networks, &test, job);
    let before = begin_with.and_then(networks_of).map(|networks| score_all(networks, &test, job));
    let card = Card { scores: json!({ "held_out": held_out.len(), "heads": scores }), ..card };
    Ok(IntentOfPeople { model: Model::of_intent(&card, &networks)?, learnt_from, held_out, scores, before })
}

/// Participants to learn from, and participants to score on.
fn split(flights: &[RecordedFlight<'_>], seed: u64) -> Result<(Vec<String>, Vec<String>), LearnError> {
    let names: BTreeSet<&str> = flights.iter().map(|flight| flight.participant).collect();
    if names.len() < 2 {
        let reason = format!(
            "flights of {} participants; one to learn from and one to score on are needed",
            names.len()
        );
        return Err(LearnError::Option { option: "from", reason });
    }
    let mut names: Vec<String> = names.into_iter().map(Into::into).collect();
    let mut draws = Draws::fork(seed, stream::HELD_OUT);
    for i in (1..names.len()).rev() {
        names.swap(i, draws.below(i + 1));
    }
    let held_out = names.split_off(names.len() - names.len().div_ceil(HELD_OUT_OF));
    Ok((names, held_out))
}

/// The sequence of a recorded flight.
fn sequence(job: &Job<'_>, trajectory: &Trajectory) -> Result<Sequence, LearnError> {
    let wrong = |reason: String| LearnError::Option { option: "from", reason };
    let setup = &trajectory.setup;
    let version = job.plants.entry(job.task)?.version;
    if setup.task.plant != job.task.plant || setup.plant_version != version {
        let found = format!("{} of version {}", setup.task.plant, setup.plant_version);
        return Err(wrong(format!(
            "a flight of {found} among those of {} of version {version}",
            job.task.plant
        )));
    }
    let mut plant = job.plants.make(&setup.task)?;
    if *plant.space() != *job.plant()?.space() {
        return Err(wrong("a flight with another set of actions is among them: choose its task".into()));
    }
    plant.reset(setup.seed);
    let scribe = Scribe::new(plant.as_ref());
    let mut scribe = scribe.ok_or_else(|| LearnError::NoActions(job.task.plant.clone()))?;
    for (&asked, &executed) in trajectory.asked.iter().zip(&trajectory.executed) {
        scribe.look(plant.as_ref());
        scribe.note(asked);
        if plant.step(executed).ending.is_some() {
            break;
        }
    }
    Ok(scribe.finish())
}

fn begin(
    job: &Job<'_>,
    card: &Card,
    options: &IntentOptions,
    model: Option<&Model>,
) -> Result<[Fitting; 2], LearnError> {
    let Some(model) = model else {
        return Ok(Aim::BOTH.map(|aim| {
            let mut draws = Draws::fork(job.seed, stream::WEIGHTS + aim as u64);
            Fitting::begin(Lstm::new(shape(card, aim, options.cells), || draws.unit() as f32), options)
        }));
    };
    let wrong = |reason: String| LearnError::Option { option: "begin_with", reason };
    let name = &model.card().name;
    let networks =
        networks_of(model).ok_or_else(|| wrong(format!("{name:?} estimates values, not intent")))?;
    let fits = model.card().space == card.space
        && model.card().state == card.state
        && model.card().goals == card.goals;
    if !fits {
        return Err(wrong(format!(
            "{name:?} is for another plant or set of actions, or was trained with other sight of the goals"
        )));
    }
    Ok([&networks.regression, &networks.calibrated].map(|network| Fitting::begin(network.clone(), options)))
}

fn networks_of(model: &Model) -> Option<&IntentNetworks> {
    match model.network() {
        Network::Intent(networks) => Some(networks),
        Network::Values(_) => None,
    }
}
