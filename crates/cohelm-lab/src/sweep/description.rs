//! What a sweep is, as a TOML file, and the jobs that it means.

use super::SweepError;
use super::job::{Code, Flights, Job, Training, Work};
use super::run::Lab;
use crate::experiment::{Experiment, Rig};
use cohelm::action::ActionSpace;
use cohelm::arbitration::Rule;
use cohelm::human::Population;
use cohelm::intent::Inference;
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::Task;
use cohelm::trajectory::MAX_SEED;
use cohelm_copilot::Kind;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The version of the file's format.
const FORMAT: u32 = 1;
/// Most jobs of one sweep: their plan is one file.
const MOST_JOBS: usize = 1_000_000;

/// A sweep: a grid of flights, a grid of trainings, or both. Every key is explained in `docs/sweeps.md`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Description {
    /// Version of this format: 1.
    pub cohelm_sweep: u32,
    /// What the report is called.
    pub title: String,
    /// Flights of simulated pilots.
    #[serde(default)]
    pub fly: Option<FlyGrid>,
    /// Trainings of values.
    #[serde(default)]
    pub train: Option<TrainGrid>,
}

/// Flights: seeds × rules × heads × pilots × options × models.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct FlyGrid {
    plant: String,
    /// Options of the plant, the same in every job.
    #[serde(default)]
    options: Map<String, Value>,
    /// Options of the plant that vary: a list each.
    #[serde(default)]
    vary: BTreeMap<String, Vec<Value>>,
    rules: Vec<RuleWord>,
    #[serde(default = "usual_heads")]
    heads: Vec<Inference>,
    #[serde(default = "usual_pilots")]
    pilots: Vec<Population>,
    seeds: Seeds,
    episodes: usize,
    #[serde(default = "shipped")]
    values: Vec<String>,
    #[serde(default = "shipped")]
    intent: Vec<String>,
}

/// Trainings: seeds × presets × options of training.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct TrainGrid {
    plant: String,
    /// Options of the plant.
    #[serde(default)]
    options: Map<String, Value>,
    #[serde(default = "usual_presets")]
    presets: Vec<String>,
    /// Options of training, the same in every job.
    #[serde(default)]
    changes: Map<String, Value>,
    /// Options of training that vary: a list each.
    #[serde(default)]
    vary: BTreeMap<String, Vec<Value>>,
    seeds: Seeds,
    /// Fresh episodes by which each training is judged.
    #[serde(default = "usual_fresh")]
    episodes: usize,
}

/// Which seeds: a list, or so many from a first one on.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Seeds {
    /// These.
    These(Vec<u64>),
    /// From `first` on.
    Range {
        /// The first.
        first: u64,
        /// How many.
        count: u64,
    },
}

/// A rule by its name, with usual parameters, or with its own.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
enum RuleWord {
    Name(String),
    Full(Rule),
}

/// A job in its sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Planned {
    /// The job's hash.
    pub hash: String,
    /// What is compared: rule, head and models, or preset and options of training.
    pub condition: String,
    /// What it is compared on: pilots and options of the plant. Intervals are drawn within.
    pub stratum: String,
    /// The job's place on every axis that varies, and its seed.
    pub axes: BTreeMap<String, String>,
    /// The job.
    pub job: Job,
}

/// Finds the model that a word in a description means for a task, and gives its hash.
pub type Choose<'a> = &'a dyn Fn(Kind, &str, &Task, &ActionSpace) -> Result<String, String>;

impl Description {
    /// Reads a description.
    pub fn from_toml(text: &str) -> Result<Self, SweepError> {
        let description: Self = toml::from_str(text)?;
        if description.cohelm_sweep != FORMAT {
            let found = description.cohelm_sweep;
            return Err(Self::wrong(
                "cohelm-sweep",
                format!("this program reads format {FORMAT}, got {found}"),
            ));
        }
        if description.fly.is_none() && description.train.is_none() {
            return Err(Self::wrong("the description", "there is neither [fly] nor [train]"));
        }
        Ok(description)
    }

    /// The jobs, in the order of the grid; equal jobs once. What cannot run is said here, before the first one runs.
    pub fn jobs(&self, lab: &Lab<'_>, choose: Choose<'_>) -> Result<Vec<Planned>, SweepError> {
        let mut planned = Vec::new();
        self.fly.iter().try_for_each(|grid| grid.jobs(lab, choose, &mut planned))?;
        self.train.iter().try_for_each(|grid| grid.jobs(lab, &mut planned))?;
        let mut seen = std::collections::BTreeSet::new();
        planned.retain(|one: &Planned| seen.insert(one.hash.clone()));
        Ok(planned)
    }

    /// The words by which flights name their models.
    pub(super) fn model_words(&self) -> impl Iterator<Item = &String> {
        self.fly.iter().flat_map(|grid| grid.values.iter().chain(&grid.intent))
    }

    pub(super) fn wrong(place: &str, reason: impl Into<String>) -> SweepError {
        SweepError::Description { place: place.into(), reason: reason.into() }
    }
}

impl FlyGrid {
    fn jobs(&self, lab: &Lab<'_>, choose: Choose<'_>, planned: &mut Vec<Planned>) -> Result<(), SweepError> {
        let seeds = self.seeds.check("[fly] seeds")?;
        at_least_one("[fly] episodes", self.episodes)?;
        for (name, length) in
            [("rules", self.rules.len()), ("heads", self.heads.len()), ("pilots", self.pilots.len())]
        {
            at_least_one(&format!("[fly] {name}"), length)?;
        }
        for options in grid("[fly.vary]", &self.vary)? {
            let task = task(&self.plant, &self.options, &options);
            for condition in self.conditions(lab, choose, &task)? {
                self.check(lab, &condition)?;
                for &pilot in &self.pilots {
                    for &seed in &seeds {
                        let flights = Flights { pilot, seed, ..condition.clone() };
                        planned.push(self.place(lab, flights, &options)?);
                        enough(planned.len())?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Rules × heads × models on one task, each as the flights of somebody.
    fn conditions(&self, lab: &Lab<'_>, choose: Choose<'_>, task: &Task) -> Result<Vec<Flights>, SweepError> {
        let plant = lab.plants.make(task)?;
        let find = |kind, word: &String| {
            choose(kind, word, task, plant.space()).map_err(|why| Description::wrong("[fly]", why)).map(Some)
        };
        let has_own = lab.plants.entry(task)?.values.is_some();
        let mut conditions = Vec::new();
        for rule in &self.rules {
            let rule = rule.rule()?;
            // The human alone is not helped: what is inferred changes nothing, so one head is enough.
            let heads = if rule == Rule::Hic { &self.heads[..1] } else { &self.heads[..] };
            for &head in heads {
                for values in &self.values {
                    let values = if has_own { None } else { find(Kind::Values, values)? };
                    let words = if head.head().is_some() { &self.intent[..] } else { &self.intent[..1] };
                    for word in words {
                        let intent = if head.head().is_some() { find(Kind::Intent, word)? } else { None };
                        let (task, values) = (task.clone(), values.clone());
                        let (pilot, seed, episodes) = (Population::default(), 0, self.episodes);
                        conditions.push(Flights { task, values, intent, rule, head, pilot, seed, episodes });
                    }
                }
            }
        }
        Ok(conditions)
    }

    /// Sits down once, so that a model that does not fit is found before anything runs.
    fn check(&self, lab: &Lab<'_>, condition: &Flights) -> Result<(), SweepError> {
        let nobody =
            |_: &dyn Plant, _: u64, _: usize| -> Result<Box<dyn Pilot>, String> { Err(String::new()) };
        let experiment = Experiment { participants: 0, ..condition.experiment() };
        experiment.run(&Rig { plants: lab.plants, models: lab.models, pilots: &nobody, threads: 1 })?;
        Ok(())
    }

    fn place(
        &self,
        lab: &Lab<'_>,
        flights: Flights,
        options: &Map<String, Value>,
    ) -> Result<Planned, SweepError> {
        let mut condition = vec![describe(&flights.rule)];
        let mut stratum = vec![flights.pilot.to_string()];
        let mut axes = BTreeMap::from([
            ("rule".to_string(), describe(&flights.rule)),
            ("head".into(), word_of(&flights.head)),
            ("pilot".into(), flights.pilot.to_string()),
            ("seed".into(), flights.seed.to_string()),
        ]);
        if self.heads.len() > 1 && flights.rule != Rule::Hic {
            condition.push(word_of(&flights.head));
        }
        for (name, words, hash) in
            [("values", &self.values, &flights.values), ("intent", &self.intent, &flights.intent)]
        {
            if let Some(hash) = hash.as_ref().filter(|_| words.len() > 1) {
                condition.push(format!("{name} {}", &hash[..8.min(hash.len())]));
                axes.insert(name.into(), hash.clone());
            }
        }
        for (name, value) in options {
            stratum.push(format!("{name} {}", plain(value)));
            axes.insert(format!("option_{name}"), plain(value));
        }
        Planned::new(lab, Work::Fly(flights), condition.join(", "), stratum.join(", "), axes)
    }
}

impl TrainGrid {
    fn jobs(&self, lab: &Lab<'_>, planned: &mut Vec<Planned>) -> Result<(), SweepError> {
        let seeds = self.seeds.check("[train] seeds")?;
        at_least_one("[train] episodes", self.episodes)?;
        at_least_one("[train] presets", self.presets.len())?;
        let task = task(&self.plant, &self.options, &Map::new());
        lab.plants.make(&task)?;
        for preset in &self.presets {
            for varied in grid("[train.vary]", &self.vary)? {
                let changes: Map<String, Value> =
                    self.changes.clone().into_iter().chain(varied.clone()).collect();
                for &seed in &seeds {
                    let (task, preset, changes) = (task.clone(), preset.clone(), changes.clone());
                    let training = Training { task, preset, changes, seed, episodes: self.episodes };
                    training.options()?;
                    planned.push(self.place(lab, training, &varied)?);
                    enough(planned.len())?;
                }
            }
        }
        Ok(())
    }

    fn place(
        &self,
        lab: &Lab<'_>,
        training: Training,
        varied: &Map<String, Value>,
    ) -> Result<Planned, SweepError> {
        let mut condition = vec![format!("trained {}", training.preset)];
        let mut axes = BTreeMap::from([
            ("preset".to_string(), training.preset.clone()),
            ("seed".into(), training.seed.to_string()),
        ]);
        for (name, value) in varied {
            condition.push(format!("{name} {}", plain(value)));
            axes.insert(format!("training_{name}"), plain(value));
        }
        let stratum = self.plant.clone();
        Planned::new(lab, Work::TrainValues(training), condition.join(", "), stratum, axes)
    }
}

impl Planned {
    fn new(
        lab: &Lab<'_>,
        work: Work,
        condition: String,
        stratum: String,
        axes: BTreeMap<String, String>,
    ) -> Result<Self, SweepError> {
        let job = Job { code: Code::of(&work, lab.plants)?, work };
        Ok(Self { hash: job.hash()?, condition, stratum, axes, job })
    }
}

impl Seeds {
    fn check(&self, place: &str) -> Result<Vec<u64>, SweepError> {
        let seeds: Vec<u64> = match self {
            Self::These(seeds) => seeds.clone(),
            Self::Range { first, count } => {
                (*first..first.saturating_add(*count)).take(MOST_JOBS + 1).collect()
            }
        };
        at_least_one(place, seeds.len())?;
        enough(seeds.len())?;
        match seeds.iter().find(|&&seed| seed >= MAX_SEED) {
            Some(seed) => {
                Err(Description::wrong(place, format!("a seed is less than {MAX_SEED}, got {seed}")))
            }
            None => Ok(seeds),
        }
    }
}

impl RuleWord {
    fn rule(&self) -> Result<Rule, SweepError> {
        match self {
            Self::Full(rule) => Ok(*rule),
            Self::Name(name) => {
                Rule::named(name).map_err(|error| Description::wrong("[fly] rules", error.to_string()))
            }
        }
    }
}

/// Every choice of one value an axis; the last axis changes fastest.
fn grid(place: &str, vary: &BTreeMap<String, Vec<Value>>) -> Result<Vec<Map<String, Value>>, SweepError> {
    let mut points = vec![Map::new()];
    for (name, values) in vary {
        at_least_one(&format!("{place} {name}"), values.len())?;
        let with = |point: &Map<String, Value>, value: &Value| {
            let mut point = point.clone();
            point.insert(name.clone(), value.clone());
            point
        };
        points = points.iter().flat_map(|point| values.iter().map(move |value| with(point, value))).collect();
        enough(points.len())?;
    }
    Ok(points)
}

fn task(plant: &str, fixed: &Map<String, Value>, varied: &Map<String, Value>) -> Task {
    let options: Map<String, Value> = fixed.clone().into_iter().chain(varied.clone()).collect();
    Task { plant: plant.into(), options: options.into() }
}

fn at_least_one(place: &str, count: usize) -> Result<(), SweepError> {
    if count > 0 { Ok(()) } else { Err(Description::wrong(place, "at least one is needed")) }
}

fn enough(jobs: usize) -> Result<(), SweepError> {
    if jobs <= MOST_JOBS {
        return Ok(());
    }
    Err(Description::wrong(
        "the grid",
        format!("a sweep has at most {MOST_JOBS} jobs; split it into several"),
    ))
}

fn describe(rule: &Rule) -> String {
    let values = rule.parameters().into_iter().map(|(_, value)| value.to_string());
    std::iter::once(rule.word().to_string()).chain(values).collect::<Vec<_>>().join(" ")
}

fn word_of(head: &Inference) -> String {
    serde_json::to_value(head).ok().and_then(|word| word.as_str().map(String::from)).unwrap_or_default()
}

fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), String::from)
}

fn usual_heads() -> Vec<Inference> {
    vec![Inference::InverseDistance]
}

fn usual_pilots() -> Vec<Population> {
    vec![Population::Ordinary]
}

fn usual_presets() -> Vec<String> {
    vec!["default".into()]
}

fn usual_fresh() -> usize {
    300
}

fn shipped() -> Vec<String> {
    vec!["shipped".into()]
}
