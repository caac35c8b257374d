//! How well values fly: fresh episodes with the goal known and the robot alone.

use crate::job::{Job, LearnError};
use crate::parallel;
use cohelm::arbitration::RobotAlone;
use cohelm::cockpit::Cockpit;
use cohelm::intent::KnownGoal;
use cohelm::pilot::Silent;
use cohelm::plant::Ending;
use cohelm::random::mix_seed;
use cohelm::value::ValueModel;
use cohelm_copilot::values::NetworkValues;
use cohelm_copilot::{Model, Network};
use serde::{Deserialize, Serialize};

/// Sets the episodes of an evaluation apart from those of training.
const FRESH: u64 = 0x0065_7661_6c75_6174;

/// How a number of episodes went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Episodes flown.
    pub episodes: usize,
    /// Share that ended at the goal.
    pub landed: f64,
    /// Share that ended elsewhere.
    pub elsewhere: f64,
    /// Share that crashed.
    pub crashed: f64,
    /// Share that left the space.
    pub out_of_bounds: f64,
    /// Share that ran out of time.
    pub timed_out: f64,
    /// Mean steps of those that ended at the goal; `None` if none did.
    pub mean_steps: Option<f64>,
    /// Mean sum of rewards.
    pub mean_return: f64,
}

/// One episode of it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Episode {
    ending: Ending,
    steps: u32,
    reward: f64,
}

/// Flies fresh episodes `0..episodes` of the set that `set` names; another `set` has other episodes.
pub fn evaluate(job: &Job<'_>, model: &Model, set: u64, episodes: usize) -> Result<Evaluation, LearnError> {
    let Network::Values(network) = model.network() else {
        let reason = format!("{:?} infers intent; give a value model", model.card().name);
        return Err(LearnError::Option { option: "model", reason });
    };
    let values = NetworkValues::new(model.card(), network.clone());
    let values = values.ok_or_else(|| LearnError::NoActions(job.task.plant.clone()))?;
    fly_fresh(job, &values, set, episodes)
}

pub(crate) fn fly_fresh(
    job: &Job<'_>,
    values: &NetworkValues,
    set: u64,
    episodes: usize,
) -> Result<Evaluation, LearnError> {
    job.plant()?;
    let flown = parallel::map(episodes, job.threads, |index| episode(job, values, seed(set, index)));
    Ok(summary(&flown.into_iter().collect::<Result<Vec<_>, _>>()?))
}

/// The seed of a fresh episode.
pub(crate) fn seed(set: u64, index: usize) -> u64 {
    mix_seed(mix_seed(FRESH, set), index as u64) >> 11
}

fn episode(job: &Job<'_>, values: &NetworkValues, seed: u64) -> Result<Episode, LearnError> {
    let mut plant = job.plant()?;
    plant.reset(seed);
    let intent = Box::new(KnownGoal(plant.pilot_goal()));
    let mut cockpit = Cockpit::new(intent, Box::new(values.clone()), Box::new(RobotAlone));
    cockpit.begin();
    let (mut steps, mut reward) = (0, 0.0);
    loop {
        let tick = cockpit.tick(plant.as_mut(), &mut Silent);
        steps += 1;
        reward += tick.step.reward;
        if let Some(ending) = tick.step.ending {
            return Ok(Episode { ending, steps, reward });
        }
    }
}

fn summary(flown: &[Episode]) -> Evaluation {
    let of_all = |count: f64| count / flown.len().max(1) as f64;
    let share = |ending| of_all(flown.iter().filter(|episode| episode.ending == ending).count() as f64);
    let landed = flown.iter().filter(|episode| episode.ending == Ending::Goal);
    let steps: u32 = landed.clone().map(|episode| episode.steps).sum();
    let landings = landed.count();
    Evaluation {
        episodes: flown.len(),
        landed: share(Ending::Goal),
        elsewhere: share(Ending::Elsewhere),
        crashed: share(Ending::Crash),
        out_of_bounds: share(Ending::OutOfBounds),
        timed_out: share(Ending::TimeLimit),
        mean_steps: (landings > 0).then(|| f64::from(steps) / landings as f64),
        mean_return: of_all(flown.iter().map(|episode| episode.reward).sum()),
    }
}

/// States over which the median range of the values is taken.
const RANGE_STATES: usize = 10_000;
/// Sets the episodes in which it is taken apart from those of evaluations.
const RANGE_SET: u64 = 0x0072_616e_6765;

/// Median of max Q − min Q over the first 10 000 states that the robot flies through, in fresh episodes with the goal
/// known.
pub fn median_range(job: &Job<'_>, values: &NetworkValues) -> Result<f64, LearnError> {
    let mut values = values.clone();
    let mut plant = job.plant()?;
    let mut ranges = Vec::with_capacity(RANGE_STATES);
    for index in 0.. {
        plant.reset(seed(RANGE_SET, index));
        let mut ending = None;
        while ending.is_none() && ranges.len() < RANGE_STATES {
            let estimate = values.estimate(&plant.view(), plant.pilot_goal(), None);
            ranges.push(estimate.range());
            let best = estimate.candidates()[estimate.best()];
            ending = plant.step(Some(best)).ending;
        }
        if ranges.len() >= RANGE_STATES {
            break;
        }
    }
    ranges.sort_unstable_by(f64::total_cmp);
    Ok(0.5 * (ranges[RANGE_STATES / 2 - 1] + ranges[RANGE_STATES / 2]))
}
