//! Flights with simulated pilots from which intent is learnt and on which it is scored.

use crate::job::{Job, LearnError, PilotFactory};
use crate::parallel;
use crate::sequence::{Scribe, Sequence};
use cohelm::arbitration::{DEFAULT_KAPPA, Rule};
use cohelm::cockpit::Cockpit;
use cohelm::intent::{Head, IntentModel, NearestGoal, Told};
use cohelm::pilot::{Pilot, Silent};
use cohelm::plant::Ending;
use cohelm::random::{Draws, mix_seed};
use cohelm_copilot::Card;
use cohelm_copilot::intent::{ImaginedIntent, NetworkIntent};
use cohelm_copilot::model::IntentNetworks;
use cohelm_copilot::values::NetworkValues;
use std::sync::Arc;

/// Where the co-pilot of a flight gets the goal from.
#[derive(Clone)]
pub(crate) enum Guide {
    Nobody,
    Truth,
    Network(Box<Card>, Arc<IntentNetworks>, Head),
    /// Networks that know no goals.
    Imagined(Box<Card>, Arc<IntentNetworks>),
}

/// A flight to be flown.
#[derive(Clone)]
pub(crate) struct Plan {
    pub rule: Rule,
    pub guide: Guide,
    /// Number of the pilot; `None` for one that never asks.
    pub pilot: Option<u64>,
    /// Number of the episode.
    pub episode: u64,
}

/// A flight that was flown.
pub(crate) struct Flight {
    pub sequence: Sequence,
    pub ending: Ending,
    /// For each control tick, whether the goal that was taken was the pilot's.
    pub right: Vec<bool>,
}

/// What helps in these flights.
pub(crate) struct Help<'a> {
    pub values: NetworkValues,
    pub median_range: f64,
    pub pilots: PilotFactory<'a>,
}

/// Flies all of the plans; flights come in their order.
pub(crate) fn fly_all(job: &Job<'_>, help: &Help<'_>, plans: &[Plan]) -> Result<Vec<Flight>, LearnError> {
    parallel::map(plans.len(), job.threads, |index| fly(job, help, &plans[index])).into_iter().collect()
}

fn fly(job: &Job<'_>, help: &Help<'_>, plan: &Plan) -> Result<Flight, LearnError> {
    let mut plant = job.plant()?;
    let seed = mix_seed(mix_seed(job.seed, EPISODES), plan.episode);
    plant.reset(seed >> 11);
    let no_actions = || LearnError::NoActions(job.task.plant.clone());
    let intent: Box<dyn IntentModel> = match &plan.guide {
        Guide::Nobody => Box::new(NearestGoal),
        Guide::Truth => Box::new(Told::new(plant.wishes())),
        Guide::Network(card, networks, head) => {
            let intent = NetworkIntent::new(card, networks.clone(), *head);
            Box::new(intent.ok_or_else(no_actions)?)
        }
        Guide::Imagined(card, networks) => {
            Box::new(ImaginedIntent::new(card, networks.clone()).ok_or_else(no_actions)?)
        }
    };
    let arbiter = plan.rule.arbiter(help.median_range);
    let arbiter =
        arbiter.map_err(|error| LearnError::Option { option: "values", reason: error.to_string() })?;
    let mut cockpit = Cockpit::new(intent, Box::new(help.values.clone()), arbiter);
    if matches!(plan.guide, Guide::Imagined(..)) {
        cockpit = cockpit.with_goals_hidden();
    }
    let mut pilot: Box<dyn Pilot> = match plan.pilot {
        Some(number) => (help.pilots)(plant.as_ref(), number).map_err(LearnError::Pilot)?,
        None => Box::new(Silent),
    };
    pilot.begin(mix_seed(seed, PILOT));
    cockpit.begin();
    let scribe = Scribe::new(plant.as_ref());
    let mut scribe = scribe.ok_or_else(|| LearnError::NoActions(job.task.plant.clone()))?;
    let mut right = Vec::new();
    loop {
        scribe.look(plant.as_ref());
        let tick = cockpit.tick(plant.as_mut(), pilot.as_mut());
        scribe.note(tick.asked);
        right.push(tick.right);
        if let Some(ending) = tick.step.ending {
            return Ok(Flight { sequence: scribe.finish(), ending, right });
        }
    }
}

/// Streams of random numbers, apart from those of value training.
const EPISODES: u64 = 0x1_0000;
const PILOT: u64 = 0x2_0000;
const SILENCE: u64 = 0x3_0000;

/// Who flies episode `episode` of training: one of the pilots in turn, or nobody with the given probability.
pub(crate) fn pilot_of(seed: u64, episode: u64, pilots: u64, silent: f64) -> Option<u64> {
    let is_silent = Draws::fork(mix_seed(seed, SILENCE), episode).chance(silent);
    (!is_silent).then_some(episode % pilots)
}

/// Rules under which the network is in the loop in training: those that it will serve.
pub(crate) const RULES: [Rule; 3] = [Rule::Lasc, Rule::Misc, Rule::MiscR { kappa: DEFAULT_KAPPA }];
