//! Tuning, then the comparison: what is flown, in which order.

use super::curve::Curve;
use super::stand::{Stand, Unit};
use super::tuning::{Tried, best};
use super::{CompareError, Draw, HeldOut, Setting, contenders, robots, tolerances};
use crate::experiment::{Condition, Experiment, ExperimentError, Rig};
use cohelm::arbitration::Rule;
use cohelm::human::{Person, Population};
use cohelm::intent::Head;
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::random::mix_seed;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::{Kind, Models};
use serde::Serialize;

/// A plant with its actions and the models that fly it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bench {
    /// A short name for files, such as `flag-lander-switches`.
    pub name: String,
    /// The plant and its options.
    pub task: Task,
    /// Hash of its value model.
    pub values: String,
    /// Hash of its intent model.
    pub intent: String,
}

/// How much is flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Budget {
    /// People of each population.
    pub participants: usize,
    /// Episodes of each under each setting that is compared.
    pub episodes: usize,
    /// Episodes of each under each setting that tuning tries.
    pub tuning_episodes: usize,
}

/// What is compared.
#[derive(Clone)]
pub struct Comparison<'a> {
    /// The plants there are.
    pub plants: &'a Plants,
    /// The models there are.
    pub models: &'a Models,
    /// Who is flown in tuning, and who in the table.
    pub draws: HeldOut,
    /// How much is flown.
    pub budget: Budget,
    /// Worker threads, which change nothing but the time; 0 for one a core.
    pub threads: usize,
}

/// A rule as it enters the table.
#[derive(Clone, Debug, Serialize)]
pub struct Entered {
    /// Everything that tuning tried.
    pub tried: Vec<Tried>,
    /// The best of it, flown by those who were held out.
    pub held_out: Stand,
    /// The same by new people of the kinds that tuning saw.
    pub seen: Stand,
}

/// A plant's outcome.
#[derive(Clone, Debug, Serialize)]
pub struct Compared {
    /// The plant.
    pub bench: Bench,
    /// The rules.
    pub entered: Vec<Entered>,
    /// Constant tolerances, flown by those who were held out.
    pub curve: Curve,
    /// The same by new people of the kinds that tuning saw.
    pub curve_of_seen: Curve,
}

impl Bench {
    /// Every plant, with every set of actions it offers, that has simulated people, values and an intent model.
    pub fn all(plants: &Plants, models: &Models) -> Vec<Self> {
        let entries = plants.entries().iter().filter(|entry| entry.skill.is_some());
        let tasks = entries.flat_map(|entry| {
            let of = |options| Task { plant: entry.name.into(), options };
            let offered = entry
                .actions
                .iter()
                .map(move |set| (format!("{}-{}", entry.name, set.name), of(set.options())));
            let only = entry.actions.is_empty().then(|| (entry.name.to_string(), Task::new(entry.name)));
            offered.chain(only).collect::<Vec<_>>()
        });
        tasks.filter_map(|(name, task)| Self::of(name, task, plants, models)).collect()
    }

    fn of(name: String, task: Task, plants: &Plants, models: &Models) -> Option<Self> {
        let plant = plants.make(&task).ok()?;
        let hash = |kind| Some(models.newest_for(kind, &task, plant.space())?.hash().to_string());
        let (values, intent) = (hash(Kind::Values)?, hash(Kind::Intent)?);
        Some(Self { name, values, intent, task })
    }
}

impl Comparison<'_> {
    /// Tunes every rule on a bench, then compares them there.
    pub fn run(&self, bench: &Bench) -> Result<Compared, CompareError> {
        let robots = self.tune(bench, robots())?;
        let head = robots[best(&robots)].setting.inference.head().unwrap_or(Head::Calibrated);
        let tune = |settings: Vec<Setting>| match settings[0].rule {
            Rule::Robot => Ok(robots.clone()),
            _ => self.tune(bench, settings),
        };
        let tried = contenders(head).into_iter().map(tune).collect::<Result<Vec<_>, _>>()?;
        let chosen: Vec<Setting> = tried.iter().map(|tried| tried[best(tried)].setting).collect();
        let line = tolerances(head);
        let settings: Vec<Setting> = chosen.iter().chain(&line).copied().collect();
        let fly = |populations: &[Population]| {
            let draw = Draw { seed: self.draws.held_out.seed, populations: populations.to_vec() };
            let mut stands = self.fly(bench, &draw, &settings, self.budget.episodes)?;
            let stands_of_line = stands.split_off(chosen.len());
            Ok::<_, CompareError>((stands, Curve { stands: stands_of_line }))
        };
        let (held_out, curve) = fly(&self.draws.held_out.populations)?;
        let (seen, curve_of_seen) = fly(&self.draws.tuning.populations)?;
        let entered = tried.into_iter().zip(held_out.into_iter().zip(seen));
        let entered = entered.map(|(tried, (held_out, seen))| Entered { tried, held_out, seen }).collect();
        Ok(Compared { bench: bench.clone(), entered, curve, curve_of_seen })
    }

    fn tune(&self, bench: &Bench, settings: Vec<Setting>) -> Result<Vec<Tried>, CompareError> {
        let stands = self.fly(bench, &self.draws.tuning, &settings, self.budget.tuning_episodes)?;
        Ok(stands.iter().map(Tried::of).collect())
    }

    /// Every setting, flown by the same people through the same episodes, with the same chance in their hands. Each kind of
    /// people has episodes and techniques of its own: with the same ones, kinds would be near-twins, and intervals that draw
    /// people anew within each would be too narrow.
    pub(super) fn fly(
        &self,
        bench: &Bench,
        draw: &Draw,
        settings: &[Setting],
        episodes: usize,
    ) -> Result<Vec<Stand>, ExperimentError> {
        let stand = |&setting: &Setting| {
            let units = draw.populations.iter().map(|&population| {
                // One condition an experiment, because the chance in a pilot's hands hangs on the condition's number.
                let kind = Population::ALL.iter().position(|&known| known == population).unwrap_or(0);
                let seed = mix_seed(draw.seed, kind as u64);
                let experiment = self.experiment(bench, seed, setting, episodes);
                self.units(&experiment, population)
            });
            let units: Vec<Vec<Unit>> = units.collect::<Result<_, _>>()?;
            Ok(Stand { setting, units: units.concat() })
        };
        settings.iter().map(stand).collect()
    }

    /// The people of a population, flown.
    fn units(&self, experiment: &Experiment, population: Population) -> Result<Vec<Unit>, ExperimentError> {
        let pilots = |plant: &dyn Plant, seed: u64, index: usize| -> Result<Box<dyn Pilot>, String> {
            let entry = self.plants.entry(&experiment.task).map_err(|error| error.to_string())?;
            let person = Person { population, seed, index: index as u64 };
            let pilot = entry.participant(plant.space(), person).map_err(|error| error.to_string())?;
            Ok(Box::new(pilot))
        };
        let rig = Rig { plants: self.plants, models: self.models, pilots: &pilots, threads: self.threads };
        let flown = experiment.run(&rig)?;
        // In order of participants, as an experiment of one condition flies them.
        let by_person = flown.chunk_by(|a, b| a.participant == b.participant);
        Ok(by_person.map(|mine| Unit::of(population, mine)).collect())
    }

    fn experiment(&self, bench: &Bench, seed: u64, setting: Setting, episodes: usize) -> Experiment {
        let word = setting.rule.word();
        Experiment {
            task: bench.task.clone(),
            values: Some(bench.values.clone()),
            intent: Some(bench.intent.clone()),
            seed,
            participants: self.budget.participants,
            episodes,
            conditions: vec![Condition::new(word, word, setting.rule, setting.inference)],
            pilot: "simulated".into(),
        }
    }
}
