//! How well each inference finds the pilot's goal, and what comes of it: simulated pilots fly the same episodes under
//! every rule with every inference.
//!
//! Flights, not ticks, are what is averaged in rates; what is believed is scored at every tick. Where the pilot changes
//! its mind, what counts is how long each inference takes to follow and what the rule does to the pilot meanwhile.

use crate::experiment::{ExperimentError, Rig};
use crate::parallel;
use cohelm::action::ActionSpace;
use cohelm::arbitration::Rule;
use cohelm::cockpit::{Silence, Tick};
use cohelm::flight::fly;
use cohelm::intent::Inference;
use cohelm::plant::{Ending, Plant};
use cohelm::random::mix_seed;
use cohelm::registry::Task;
use cohelm::trajectory::{MAX_SEED, Setup};
use cohelm_copilot::{Card, Kind, Model, Models, cockpit};
use serde::Serialize;

/// Bins of the calibration error.
const BINS: usize = 10;
/// An inference has followed a changed mind once it has been right for that many ticks in a row (0.2 s): a guess that
/// passes by is none.
const SETTLED: u32 = 10;

/// What is to be compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IntentTrial {
    /// Plant and options.
    pub task: Task,
    /// Fixes participants, episodes and everything else.
    pub seed: u64,
    /// How many participants.
    pub participants: usize,
    /// How many episodes each flies with every inference under every rule.
    pub episodes: usize,
    /// The rules.
    pub rules: Vec<Rule>,
    /// The inferences.
    pub inferences: Vec<Inference>,
    /// Variant of the intent models to take, for inferences that one of that variant serves; the others have the usual one.
    pub variant: Option<String>,
}

/// How one inference did under one rule.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IntentRow {
    /// The rule.
    pub rule: Rule,
    /// The inference.
    pub inference: Inference,
    /// Flights.
    pub flights: usize,
    /// Share of flights that ended at the goal that the pilot wanted in the end.
    pub success: f64,
    /// Share of flights that ended at another.
    pub elsewhere: f64,
    /// Share of flights that crashed.
    pub crash: f64,
    /// Mean share, a flight, of ticks with a command at which the plant was set differently.
    pub interventions: f64,
    /// Mean share, a flight, of ticks at which the right goal was taken.
    pub right: f64,
    /// Share of flights in which it was at the middle tick.
    pub right_midway: f64,
    /// Share of flights in which it was at the last tick.
    pub right_at_end: f64,
    /// Mean c, over ticks.
    pub confidence: f64,
    /// Expected calibration error, over ticks: the mean difference between the probability of the goal that is taken and
    /// how often it is right, in ten classes of that probability. `None` where a goal is imagined or told.
    pub calibration_error: Option<f64>,
    /// What came after a change of mind, if the pilot had any.
    pub after_change: Option<AfterChange>,
}

/// What came after changes of mind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AfterChange {
    /// Flights in which the pilot changed its mind.
    pub flights: usize,
    /// Share of them in which the inference followed: it was right for ten ticks in a row before the flight was over.
    pub followed: f64,
    /// Median ticks from the change to the first of those, flights that were over before counting as the longest;
    /// `None` if that is the median.
    pub median_ticks: Option<f64>,
    /// Share of ticks with a command between the change and then (or the end) at which the plant was set differently.
    pub interventions: f64,
    /// The same of ticks at which the opposite was carried out.
    pub opposed: f64,
}

impl IntentTrial {
    /// Flies it all; rows are by rule, then inference, whatever the number of threads.
    pub fn run(&self, rig: &Rig<'_>) -> Result<Vec<IntentRow>, ExperimentError> {
        self.check_variant(rig)?;
        let kinds: Vec<(Rule, Inference)> = self
            .rules
            .iter()
            .flat_map(|&rule| self.inferences.iter().map(move |&inference| (rule, inference)))
            .collect();
        let flights = self.participants * self.episodes;
        let flown = parallel::run(kinds.len() * flights, rig.threads, |job| {
            self.fly(rig, kinds[job / flights], job % flights)
        });
        let flown: Vec<Watched> = flown.into_iter().collect::<Result<_, _>>()?;
        let rows = kinds.iter().zip(flown.chunks(flights.max(1)));
        Ok(rows.map(|(&(rule, inference), flown)| row(rule, inference, flown)).collect())
    }

    /// Refuses a variant that no model has, as the usual ones would be measured under its name.
    fn check_variant(&self, rig: &Rig<'_>) -> Result<(), ExperimentError> {
        let Some(asked) = &self.variant else { return Ok(()) };
        let space = rig.plants.make(&self.task)?.space().clone();
        let cards = rig.models.iter().map(Model::card).filter(|card| {
            card.kind == Kind::Intent && card.task.plant == self.task.plant && card.space == space
        });
        let known: Vec<&str> = cards.filter_map(|card| card.variant.as_deref()).collect();
        if known.contains(&asked.as_str()) {
            return Ok(());
        }
        let known = if known.is_empty() { "none".into() } else { known.join(", ") };
        Err(ExperimentError::NoVariant { asked: asked.clone(), known })
    }

    fn fly(
        &self,
        rig: &Rig<'_>,
        (rule, inference): (Rule, Inference),
        index: usize,
    ) -> Result<Watched, ExperimentError> {
        let (participant, episode) = (index / self.episodes, index % self.episodes);
        let mut plant = rig.plants.make(&self.task)?;
        let seed = mix_seed(mix_seed(self.seed, participant as u64), episode as u64) % MAX_SEED;
        plant.reset(seed);
        let space = plant.space().clone();
        let values = rig.models.newest_for(Kind::Values, &self.task, &space);
        let intent = self.intent(rig.models, inference, &space);
        let setup = Setup {
            task: self.task.clone(),
            plant_version: rig.plants.entry(&self.task)?.version,
            seed,
            rule,
            inference,
            silence: Silence::Best,
            time_scale: 1.0,
            values: values.map(|model| model.hash().to_owned()),
            intent: intent.map(|model| model.hash().to_owned()),
            pilot: "simulated person".into(),
        };
        let mut cockpit = cockpit(&setup, plant.as_ref(), rig.plants, rig.models)?;
        let mut pilot =
            (rig.pilots)(plant.as_ref(), self.seed, participant).map_err(ExperimentError::Pilot)?;
        pilot.begin(mix_seed(seed, 0));
        let mut watched = Watched::default();
        let mut wanted = wanted_id(plant.as_ref());
        fly(setup, plant.as_mut(), &mut cockpit, pilot.as_mut(), |tick, plant| {
            watched.note(tick);
            let wants = wanted_id(plant);
            if wants != wanted {
                watched.changed_at.get_or_insert(watched.ticks.len());
                wanted = wants;
            }
        });
        Ok(watched)
    }

    fn intent<'a>(&self, models: &'a Models, inference: Inference, space: &ActionSpace) -> Option<&'a Model> {
        let usual = models.newest_intent(inference, &self.task, space)?;
        let fits = |card: &Card| {
            card.kind == Kind::Intent && card.serves(inference) && card.task.plant == self.task.plant
        };
        let of_variant = |model: &&Model| {
            let card = model.card();
            fits(card) && card.space == *space && card.variant.is_some() && card.variant == self.variant
        };
        Some(models.iter().rev().find(of_variant).unwrap_or(usual))
    }
}

fn wanted_id(plant: &dyn Plant) -> Option<u32> {
    plant.view().goals.get(plant.pilot_goal()).map(|goal| goal.id)
}

/// What was seen of one flight.
#[derive(Clone, Debug, Default)]
struct Watched {
    ticks: Vec<Seen>,
    /// The first tick at which the pilot wanted another goal than at first.
    changed_at: Option<usize>,
    ending: Option<Ending>,
}

/// What was seen of one tick.
#[derive(Clone, Copy, Debug)]
struct Seen {
    right: bool,
    confidence: f32,
    /// Of the goal that was taken; `None` if it was imagined.
    probability: Option<f32>,
    asked: bool,
    effective: bool,
    opposed: bool,
}

impl Watched {
    fn note(&mut self, tick: &Tick<'_>) {
        let belief = &tick.belief;
        let imagined = belief.imagined_goal().is_some();
        let intervention = tick.intervention.unwrap_or_default();
        self.ticks.push(Seen {
            right: tick.right,
            confidence: belief.confidence,
            probability: belief.probabilities().get(belief.goal).copied().filter(|_| !imagined),
            asked: tick.asked.is_some(),
            effective: intervention.effective,
            opposed: intervention.opposed,
        });
        self.ending = tick.step.ending;
    }

    /// Ticks from the change of mind until the inference was right and stayed so; `None` if it never was.
    fn followed_after(&self) -> Option<usize> {
        let after = &self.ticks[self.changed_at?.min(self.ticks.len())..];
        let mut in_a_row = 0;
        let settled = after.iter().position(|seen| {
            in_a_row = if seen.right { in_a_row + 1 } else { 0 };
            in_a_row == SETTLED
        });
        settled.map(|tick| tick + 1 - SETTLED as usize)
    }

    /// The ticks between the change of mind and when the inference followed, or the end.
    fn meanwhile(&self) -> &[Seen] {
        let Some(changed) = self.changed_at.filter(|&tick| tick < self.ticks.len()) else { return &[] };
        let end = self.followed_after().map_or(self.ticks.len(), |ticks| changed + ticks);
        &self.ticks[changed..end]
    }
}

fn row(rule: Rule, inference: Inference, flown: &[Watched]) -> IntentRow {
    let flights = flown.len().max(1) as f64;
    let share = |of: &dyn Fn(&Watched) -> bool| flown.iter().filter(|w| of(w)).count() as f64 / flights;
    let ended = |ending| share(&|watched: &Watched| watched.ending == Some(ending));
    let mean = |of: &dyn Fn(&Watched) -> f64| flown.iter().map(of).sum::<f64>() / flights;
    let all = || flown.iter().flat_map(|watched| &watched.ticks);
    let ticks = all().count().max(1) as f64;
    IntentRow {
        rule,
        inference,
        flights: flown.len(),
        success: ended(Ending::Goal),
        elsewhere: ended(Ending::Elsewhere),
        crash: ended(Ending::Crash),
        interventions: mean(&|w| part(w.ticks.iter().filter(|t| t.asked), |t| t.effective)),
        right: mean(&|w| part(w.ticks.iter(), |t| t.right)),
        right_midway: share(&|w| w.ticks.get(w.ticks.len() / 2).is_some_and(|t| t.right)),
        right_at_end: share(&|w| w.ticks.last().is_some_and(|t| t.right)),
        confidence: all().map(|tick| f64::from(tick.confidence)).sum::<f64>() / ticks,
        calibration_error: calibration_error(all()).filter(|_| inference != Inference::Known),
        after_change: after_change(flown),
    }
}

/// The share of some ticks of which something is true; 0 of none.
fn part<'a>(ticks: impl Iterator<Item = &'a Seen>, is: impl Fn(&Seen) -> bool) -> f64 {
    let (all, of) = ticks.fold((0_u32, 0_u32), |(all, of), tick| (all + 1, of + u32::from(is(tick))));
    f64::from(of) / f64::from(all.max(1))
}

fn calibration_error<'a>(ticks: impl Iterator<Item = &'a Seen>) -> Option<f64> {
    let mut bins = [(0.0, 0.0); BINS];
    let mut count = 0_u32;
    for tick in ticks {
        let Some(p) = tick.probability.map(f64::from) else { continue };
        let bin = &mut bins[((p * BINS as f64) as usize).min(BINS - 1)];
        *bin = (bin.0 + p, bin.1 + f64::from(u8::from(tick.right)));
        count += 1;
    }
    let sum: f64 = bins.iter().map(|(p, right)| (p - right).abs()).sum();
    (count > 0).then(|| sum / f64::from(count))
}

fn after_change(flown: &[Watched]) -> Option<AfterChange> {
    let changed = || flown.iter().filter(|w| w.changed_at.is_some_and(|tick| tick < w.ticks.len()));
    let flights = changed().count();
    if flights == 0 {
        return None;
    }
    let mut ticks: Vec<f64> =
        changed().map(|w| w.followed_after().map_or(f64::INFINITY, |ticks| ticks as f64)).collect();
    ticks.sort_by(f64::total_cmp);
    let median = 0.5 * (ticks[(flights - 1) / 2] + ticks[flights / 2]);
    let meanwhile = || changed().flat_map(Watched::meanwhile).filter(|tick| tick.asked);
    Some(AfterChange {
        flights,
        followed: ticks.iter().filter(|ticks| ticks.is_finite()).count() as f64 / flights as f64,
        median_ticks: median.is_finite().then_some(median),
        interventions: part(meanwhile(), |tick| tick.effective),
        opposed: part(meanwhile(), |tick| tick.opposed),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watched(right: &[bool], changed_at: usize) -> Watched {
        let seen = |&right: &bool| Seen {
            right,
            confidence: 0.5,
            probability: Some(0.75),
            asked: true,
            effective: !right,
            opposed: false,
        };
        let ticks = right.iter().map(seen).collect();
        Watched { ticks, changed_at: Some(changed_at), ending: Some(Ending::Goal) }
    }

    #[test]
    fn who_is_right_by_the_way_has_not_followed_yet() {
        let right = [vec![true; 5], vec![false; 8], vec![true; 3], vec![false; 4], vec![true; 20]].concat();
        let flight = watched(&right, 5);
        assert_eq!(flight.followed_after(), Some(15));
        assert_eq!(flight.meanwhile().len(), 15);
        let never = watched(&right[..20], 5);
        assert_eq!((never.followed_after(), never.meanwhile().len()), (None, 15));
    }

    #[test]
    fn flights_that_end_too_early_count_as_the_longest() {
        let (soon, late) = (watched(&[true; 30], 3), watched(&[false; 30], 3));
        let after = after_change(&[soon.clone(), soon.clone(), late.clone()]).unwrap();
        assert_eq!((after.flights, after.median_ticks), (3, Some(0.0)));
        assert!((after.followed - 2.0 / 3.0).abs() < 1e-12 && after.interventions == 1.0);
        assert_eq!(after_change(&[late.clone(), late, soon]).unwrap().median_ticks, None);
    }

    #[test]
    fn calibration_compares_what_is_believed_with_what_is_true() {
        let flight = watched(&[true, true, true, false], 0);
        assert_eq!(calibration_error(flight.ticks.iter()), Some(0.0));
        let flight = watched(&[true; 4], 0);
        assert_eq!(calibration_error(flight.ticks.iter()), Some(0.25));
    }
}
