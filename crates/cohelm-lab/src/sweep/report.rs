//! The report of a sweep: interquartile means with stratified bootstrap intervals, and performance profiles, as Agarwal et
//! al. (2021) ask for where runs are few.

use super::sheets::parquet;
use super::tables::{Finished, OF_A_TRAINING, by_episode, by_job, dictionary, nodes, where_it_ran};
use super::{Description, Folder, SweepError};
use cohelm_study::apa::{number, percent};
use cohelm_study::figures::{
    Axis, Better, Conditions, Curve, CurvePanel, Curves, Heading, ParetoPoint, ParetoScatter,
};
use cohelm_study::measures::measure;
use cohelm_study::report::{Align, Block, Document, Table};
use cohelm_study::statistics::bootstrap::{Bootstrapped, Options, bootstrap, stratified_interquartile_mean};
use cohelm_study::text::Text;
use std::collections::BTreeMap;

/// Most thresholds at which a profile is computed; where runs have fewer different values, these.
const MOST_THRESHOLDS: usize = 41;
/// Resamples of a profile's band, at each threshold.
const BAND_RESAMPLES: usize = 2000;

/// What the tables of flights show.
const OF_FLIGHTS: [&str; 8] = [
    "success",
    "crash",
    "steps_of_successes",
    "ticks_with_command",
    "interventions",
    "replaced",
    "goal_accuracy",
    "reward",
];
/// What those of trainings show.
const OF_TRAININGS: [&str; 4] = ["landed", "crashed", "mean_steps", "mean_return"];

/// Writes the tables and the report of what has finished into the folder; gives the names of the files.
pub fn write_report(folder: &Folder) -> Result<Vec<String>, SweepError> {
    let (finished, planned) = (Finished::all(folder)?, folder.planned()?.len());
    let title = Description::from_toml(&folder.description()?)?.title;
    let tables =
        [("jobs", by_job(&finished)), ("episodes", by_episode(&finished)), ("ran", where_it_ran(&finished))];
    let mut files = vec![("dictionary.csv".to_string(), dictionary().to_string().into_bytes())];
    for (name, table) in tables.into_iter().filter(|(_, table)| !table.rows().is_empty()) {
        files.push((format!("{name}.csv"), table.to_string().into_bytes()));
        files.push((format!("{name}.parquet"), parquet(name, &table)?));
    }
    files.extend(document(&title, &finished, planned)?.files("report"));
    files.iter().try_for_each(|(name, bytes)| folder.write(name, bytes))?;
    Ok(files.into_iter().map(|(name, _)| name).collect())
}

/// The report of what has finished. `planned` is how many jobs there are in all.
pub fn document(title: &str, finished: &[Finished], planned: usize) -> Result<Document, SweepError> {
    let mut document = Document::new(title);
    document.lead = Text::from(format!("{} of {planned} jobs have finished.", finished.len()));
    document.facts = vec![("Program".into(), program(finished))];
    let (flown, trained): (Vec<&Finished>, Vec<&Finished>) = finished.iter().partition(|one| one.flew());
    if !flown.is_empty() {
        let words = "Every participant of this sweep is a model of a person.";
        document.push(Block::warning("The pilots are simulated", words));
        let group = Group { runs: &flown, unit: "simulated participant", by_head: true };
        group.section(&mut document, "Flights", &OF_FLIGHTS, ("success", "Success rate"))?;
        document.push(Block::figure(group.trade_off()?, "Each point is a condition.", "figures/trade-off"));
    }
    if !trained.is_empty() {
        let group = Group { runs: &trained, unit: "training", by_head: false };
        group.section(
            &mut document,
            "Trainings",
            &OF_TRAININGS,
            ("landed", "Share of fresh episodes at the goal"),
        )?;
    }
    document.push(Block::heading("Where it ran"));
    document.push(Block::Table(nodes_table(finished)));
    Ok(document)
}

/// The code that flew or trained: the same for all jobs of a plan.
fn program(finished: &[Finished]) -> String {
    let sources = finished.first().map(|one| format!(", sources {}", one.planned.job.code.sources));
    format!("cohelm {}{}", env!("CARGO_PKG_VERSION"), sources.unwrap_or_default())
}

/// Runs that are compared with each other.
struct Group<'a> {
    runs: &'a [&'a Finished],
    unit: &'static str,
    /// Whether conditions are compared rule with rule, each head (or whatever else follows the rule in their names) by itself.
    by_head: bool,
}

impl Group<'_> {
    fn section(
        &self,
        document: &mut Document,
        title: &str,
        keys: &[&str],
        (key, name): (&str, &str),
    ) -> Result<(), SweepError> {
        document.push(Block::heading(title));
        document.push(Block::Table(self.table(keys)));
        let file = format!("figures/profile-{key}");
        let caption = "Higher is better. The band is a 95 % bootstrap interval at each threshold by itself.";
        document.push(Block::figure(self.profile(key, name)?, caption, file));
        document.push(Block::measures(keys.iter().filter_map(|key| measure(key))));
        Ok(())
    }

    /// Names of the conditions, in the order of the plan.
    fn conditions(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for run in self.runs {
            if !names.contains(&run.planned.condition.as_str()) {
                names.push(&run.planned.condition);
            }
        }
        names
    }

    /// A condition's numbers, by stratum.
    fn strata(&self, condition: &str, key: &str) -> Vec<Vec<f64>> {
        let mut strata: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for run in self.runs.iter().filter(|run| run.planned.condition == condition) {
            if let Some(value) = run.value(key) {
                strata.entry(&run.planned.stratum).or_default().push(value);
            }
        }
        strata.into_values().collect()
    }

    fn interquartile_mean(&self, condition: &str, key: &str) -> Option<Bootstrapped> {
        stratified_interquartile_mean(&self.strata(condition, key), Options::default()).ok()
    }

    fn table(&self, keys: &[&str]) -> Table {
        let columns = keys.iter().map(|key| (Text::from(title_of(key)), Align::Right));
        let row = |condition: &&str| {
            let runs = self.runs.iter().filter(|run| run.planned.condition == *condition).count();
            let cells = keys.iter().map(|key| match self.interquartile_mean(condition, key) {
                Some(of) => {
                    let [at, low, high] =
                        [of.estimate, of.interval.low, of.interval.high].map(|x| write(key, x));
                    Text::from(format!("{at} [{low}, {high}]"))
                }
                None => Text::from("–"),
            });
            [Text::from(*condition), Text::from(runs.to_string())].into_iter().chain(cells).collect()
        };
        let head = [(Text::from("Condition"), Align::Left), (Text::from("Runs"), Align::Right)];
        Table {
            caption: Text::from(format!(
                "Interquartile means with 95 % bootstrap intervals; a run is one {}.",
                self.unit
            )),
            columns: head.into_iter().chain(columns).collect(),
            rows: self.conditions().iter().map(row).collect(),
            notes: vec![Text::from(
                "The interquartile mean leaves out the lowest and the highest quarter of all runs. Runs are drawn anew within \
                 each stratum (pilots and options of the plant), 10,000 times. A dash: fewer than two runs have a value.",
            )],
        }
    }

    /// Share of the runs above a threshold, for every threshold. A rule that needs no head is in the panels of all heads.
    fn profile(&self, key: &str, name: &str) -> Result<cohelm_study::figures::Figure, SweepError> {
        let conditions: Vec<&str> =
            self.conditions().into_iter().filter(|name| !self.strata(name, key).is_empty()).collect();
        let mut rules: Vec<&str> = Vec::new();
        let mut heads: Vec<&str> = Vec::new();
        for (rule, head) in conditions.iter().map(|name| self.rule_and_head(name)) {
            if !rules.contains(&rule) {
                rules.push(rule);
            }
            if head.is_some_and(|head| !heads.contains(&head)) {
                heads.extend(head);
            }
        }
        let panel = |head: Option<&str>| {
            let curves = conditions.iter().filter_map(|name| {
                let (rule, of) = self.rule_and_head(name);
                let condition = rules.iter().position(|known| *known == rule)?;
                (of.is_none() || of == head).then(|| profile_curve(condition, &self.strata(name, key)))
            });
            CurvePanel { title: head.unwrap_or("all runs").into(), curves: curves.collect() }
        };
        let panels = if heads.is_empty() {
            vec![panel(None)]
        } else {
            heads.iter().map(|head| panel(Some(head))).collect()
        };
        let figure = Curves {
            heading: Heading::new(
                "Performance profiles",
                format!("Share of runs that do better than a threshold; a run is one {}", self.unit),
            ),
            x: Axis::share(format!("Threshold: {}", name.to_lowercase())),
            y: Axis::share("Share of runs above"),
            conditions: Conditions::in_order(rules.iter().copied()),
            panels,
        };
        Ok(figure.figure()?)
    }

    fn rule_and_head<'n>(&self, condition: &'n str) -> (&'n str, Option<&'n str>) {
        match condition.split_once(", ") {
            Some((rule, head)) if self.by_head => (rule, Some(head)),
            _ => (condition, None),
        }
    }

    /// Success against what help costs, both with their intervals.
    fn trade_off(&self) -> Result<cohelm_study::figures::Figure, SweepError> {
        let conditions = self.conditions();
        let point = |(index, condition): (usize, &&str)| {
            let success = self.interquartile_mean(condition, "success")?;
            let cost = self.interquartile_mean(condition, "replaced");
            let at = (cost.map_or(0.0, |cost| cost.estimate), success.estimate);
            let intervals = (cost.map(|cost| cost.interval), Some(success.interval));
            Some(ParetoPoint { label: condition.to_string(), condition: index, at, intervals })
        };
        let figure = ParetoScatter {
            heading: Heading::new("What help costs", "Interquartile means with 95 % intervals"),
            x: (Axis::share("How much of what was asked was replaced"), Better::Lower),
            y: (Axis::share("Success rate"), Better::Higher),
            conditions: Conditions::in_order(conditions.iter().copied()),
            points: conditions.iter().enumerate().filter_map(point).collect(),
            behind: None,
        };
        Ok(figure.figure()?)
    }
}

/// A staircase: the share is the same from one threshold up to the next.
fn profile_curve(condition: usize, strata: &[Vec<f64>]) -> Curve {
    let (sizes, values): (Vec<usize>, Vec<f64>) = (strata.iter().map(Vec::len).collect(), strata.concat());
    let options = Options { resamples: BAND_RESAMPLES, ..Options::default() };
    let all: Vec<usize> = (0..values.len()).collect();
    let thresholds = thresholds(&values);
    let (mut points, mut band) = (Vec::new(), Vec::new());
    for (index, &threshold) in thresholds.iter().enumerate() {
        let above = |chosen: &[usize]| {
            let count = chosen.iter().filter(|&&run| values[run] > threshold).count();
            Some(count as f64 / chosen.len() as f64)
        };
        let at = above(&all).unwrap_or(0.0);
        let interval =
            bootstrap(&sizes, above, options).map_or((at, at), |of| (of.interval.low, of.interval.high));
        let until = thresholds.get(index + 1).copied().unwrap_or(1.0);
        points.extend([(threshold, at), (until, at)]);
        band.extend([interval, interval]);
    }
    Curve { condition, points, band }
}

/// Where the share of shares above can change: the values themselves, or an even grid where they are many.
fn thresholds(values: &[f64]) -> Vec<f64> {
    let mut thresholds: Vec<f64> =
        values.iter().copied().chain([0.0]).filter(|x| (0.0..1.0).contains(x)).collect();
    thresholds.sort_by(f64::total_cmp);
    thresholds.dedup();
    if thresholds.len() > MOST_THRESHOLDS {
        thresholds = (0..MOST_THRESHOLDS).map(|step| step as f64 / MOST_THRESHOLDS as f64).collect();
    }
    thresholds
}

fn nodes_table(finished: &[Finished]) -> Table {
    let names = ["Executor", "Node", "Jobs", "Seconds of work", "Of these again, after a lost worker"];
    let align = |(i, name): (usize, &str)| (Text::from(name), if i < 2 { Align::Left } else { Align::Right });
    let row = |((executor, node), (jobs, seconds, again)): ((String, String), (usize, f64, usize))| {
        [executor, node, jobs.to_string(), format!("{seconds:.1}"), again.to_string()].map(Text::from).into()
    };
    Table {
        caption: Text::from("Jobs by node. Where a job runs changes none of its bits."),
        columns: names.into_iter().enumerate().map(align).collect(),
        rows: nodes(finished).into_iter().map(row).collect(),
        notes: Vec::new(),
    }
}

fn title_of(key: &str) -> String {
    match (measure(key), OF_A_TRAINING.iter().find(|(known, _)| *known == key)) {
        (Some(measure), _) => measure.title(),
        (None, Some((_, meaning))) => meaning.trim_end_matches('.').into(),
        (None, None) => key.into(),
    }
}

fn write(key: &str, value: f64) -> String {
    match measure(key) {
        Some(measure) => measure.write(value),
        None if ["landed", "crashed"].contains(&key) => percent(value, 1),
        None => number(value, 2),
    }
}
