//! A design in words and as tables, for whoever is about to run it: who flies what when, and how long it takes.

mod cautions;

use super::timeline::{Step, StepKind, steps};
use super::{Condition, Design, Feedback, Order, PlantFacts, Practice, estimate, schedule};
use crate::{measures, questionnaires};
use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::intent::Inference;
use serde::Serialize;
use std::fmt;

/// A design in words and as tables.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explanation {
    /// Title and name.
    pub heading: String,
    /// SHA-256 of the file.
    pub hash: String,
    /// The design in sentences, the most important first.
    pub sentences: Vec<String>,
    /// The conditions.
    pub conditions: Table,
    /// The orders, and how many participants are to finish each.
    pub orders: Table,
    /// What one participant goes through, with the minutes it takes.
    pub way: Table,
    /// Minutes for one participant.
    pub minutes: f64,
    /// What to think about before running it; nothing of it is forbidden.
    pub cautions: Vec<String>,
}

/// A table of words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Table {
    /// Above the columns.
    pub head: Vec<String>,
    /// The rows, as long as the head.
    pub rows: Vec<Vec<String>>,
}

/// What each of the sentences of an [`Explanation`] is about, in their order.
pub const TOPICS: [&str; 7] =
    ["Participants", "Flown", "Order", "Practice", "Ground", "Primary outcome", "Left out"];

/// Explains a design. With what is known of the plant, it also says how long a flight may last.
pub fn explain(design: &Design, facts: Option<&PlantFacts>) -> Explanation {
    let way = steps(design, &as_listed(design));
    let minutes = estimate::minutes(design, &way);
    Explanation {
        heading: format!("{} ({})", design.title.read(design.first_language(), ""), design.name),
        hash: design.hash(),
        sentences: sentences(design, facts, minutes),
        conditions: conditions(design),
        orders: orders(design),
        way: way_of_one(design, &way, minutes),
        minutes,
        cautions: cautions::cautions(design, facts, minutes),
    }
}

fn as_listed(design: &Design) -> schedule::Assignment {
    schedule::Assignment { cell: 0, order: (0..design.conditions.len()).collect(), seed: 0 }
}

fn sentences(design: &Design, facts: Option<&PlantFacts>, minutes: f64) -> Vec<String> {
    let about_each: [String; TOPICS.len()] = [
        who(design, minutes),
        flown(design, facts),
        ordered(design),
        practised(design),
        grounds(design),
        primary(design),
        excluded(design),
    ];
    about_each.into()
}

fn who(design: &Design, minutes: f64) -> String {
    let flights = design
        .conditions
        .iter()
        .map(|condition| condition.practice_episodes + condition.measured_episodes)
        .sum::<u32>();
    let hours = (f64::from(design.planned_participants) * minutes / 60.0).ceil();
    format!(
        "{} to finish. Each flies {} ({}), {}: about {minutes:.0} minutes, {} for all.",
        count(design.planned_participants as usize, "participant")
            + if design.planned_participants == 1 { " is" } else { " are" },
        count(design.conditions.len(), "condition"),
        if design.conditions.len() > 1 { "within-subject" } else { "one group" },
        count(flights as usize, "flight"),
        count(hours as usize, "hour"),
    )
}

fn flown(design: &Design, facts: Option<&PlantFacts>) -> String {
    let task = &design.task;
    let options = task.task.options.as_object().filter(|options| !options.is_empty());
    let options = options.map_or("default options".to_owned(), |options| {
        options.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
    });
    let speed = if task.time_scale == 1.0 {
        "in real time".to_owned()
    } else {
        format!("at {} of real time", task.time_scale)
    };
    let limit = facts.and_then(|facts| {
        let ticks = facts.limit_ticks?;
        let seconds = f64::from(ticks) / facts.ticks_per_second / task.time_scale;
        Some(format!(" A flight lasts at most {seconds:.0} seconds ({ticks} ticks)."))
    });
    format!("Flown is {} ({options}), {speed}.{}", task.task.plant, limit.unwrap_or_default())
}

fn ordered(design: &Design) -> String {
    let cells = schedule::cells(design).len();
    match design.order {
        Order::LatinSquare => format!(
            "The order is a Latin square of {cells}: each condition stands equally often at each place. A cell is filled \
             by who finished it."
        ),
        Order::Williams => format!(
            "The orders are a Williams square of {cells}: each condition stands equally often at each place and follows \
             each other one equally often. A cell is filled by who finished it."
        ),
        Order::Random => "The order is drawn anew for each participant.".to_owned(),
        Order::Fixed => "Everyone flies the conditions in the order of the file.".to_owned(),
    }
}

fn practised(design: &Design) -> String {
    let flights: u32 = design.conditions.iter().map(|condition| condition.practice_episodes).sum();
    let when = match design.practice {
        Practice::BeforeEach => "those of a condition right before its measured flights",
        Practice::InAdvance => "all before the first measured flight",
    };
    let feedback = match design.feedback {
        Feedback::Practice => {
            "After practice flights the page says how they ended and why, after measured ones it does not."
        }
        Feedback::Always => "After every flight the page says how it ended and why.",
        Feedback::Never => "The page never says how a flight ended.",
    };
    if flights == 0 {
        format!("There is no practice. {feedback}")
    } else {
        format!("{flights} flights are practice, {when}. {feedback}")
    }
}

fn grounds(design: &Design) -> String {
    let terrain = &design.terrain;
    let between = if terrain.same_for_everyone {
        "the same for every participant"
    } else {
        "drawn for each participant"
    };
    let within = if terrain.same_in_every_condition {
        "the same in every condition"
    } else {
        "different in each condition"
    };
    format!(
        "Ground, start and goal of the n-th measured flight are {between} and {within} (seed {}).",
        terrain.seed
    )
}

fn primary(design: &Design) -> String {
    let primary = &design.primary;
    let compared = if primary.conditions.is_empty() {
        "all conditions".to_owned()
    } else {
        primary.conditions.join(" and ")
    };
    let said =
        primary.hypothesis.as_ref().map_or(String::new(), |hypothesis| format!(" Hypothesis: {hypothesis}"));
    let written = |key: &str, bound: f64| match measures::measure(key) {
        Some(measure) => measure.write_difference(bound),
        None => bound.to_string(),
    };
    let bounds: Vec<String> =
        design.equivalence.iter().map(|(key, &bound)| format!("{key} ±{}", written(key, bound))).collect();
    let sameness = if bounds.is_empty() {
        String::new()
    } else {
        format!(" Tests of equivalence: {}.", bounds.join(", "))
    };
    format!(
        "The primary outcome is {} over {compared}, α = {}.{said}{sameness}",
        primary.measure, primary.alpha
    )
}

fn excluded(design: &Design) -> String {
    let rules = &design.exclusion;
    let percent = |share: f64| format!("{} %", 100.0 * share);
    let found = [
        rules
            .failed_checks_over
            .map(|most| format!("more than {} failed", count(most as usize, "attention check"))),
        rules.late_ticks_over.map(|share| format!("more than {} of the ticks late", percent(share))),
        rules
            .inattentive_flights_over
            .map(|share| format!("more than {} of the flights without attention", percent(share))),
        rules
            .interrupted_flights_over
            .map(|most| format!("more than {} interrupted", count(most as usize, "flight"))),
        rules
            .silent_flights_over
            .map(|share| format!("more than {} of the flights without a key", percent(share))),
        rules.failed_quiz.then(|| "quiz failed".to_owned()),
    ];
    let found: Vec<String> = found.into_iter().flatten().collect();
    let left_out = if found.is_empty() {
        "Everyone who finishes is analysed.".to_owned()
    } else {
        format!("Left out of the confirmatory analysis: {}.", found.join("; "))
    };
    let device = if design.refuses_slow_devices() { " A device that cannot keep up is refused." } else { "" };
    left_out + device
}

fn conditions(design: &Design) -> Table {
    let head = [
        "condition",
        "rule",
        "belief about the goal",
        "asked nothing",
        "practice",
        "measured",
        "questionnaires",
    ];
    let row = |condition: &Condition| {
        vec![
            condition.name.clone(),
            rule_words(condition),
            inference_words(condition).to_owned(),
            silence_words(condition).to_owned(),
            condition.practice_episodes.to_string(),
            condition.measured_episodes.to_string(),
            if condition.questionnaires.is_empty() {
                "–".to_owned()
            } else {
                condition.questionnaires.join(", ")
            },
        ]
    };
    Table { head: head.map(str::to_owned).to_vec(), rows: design.conditions.iter().map(row).collect() }
}

fn rule_words(condition: &Condition) -> String {
    let words = condition.rule;
    if condition.learning { format!("{words}, learning") } else { words.to_string() }
}

fn inference_words(condition: &Condition) -> &'static str {
    match (condition.rule, condition.inference) {
        (Rule::Hic, _) => "not used",
        (_, Inference::Nearest) => "nearest goal",
        (_, Inference::Known) => "told",
        (_, Inference::InverseDistance) => "network, inverse distances",
        (_, Inference::Softmax) => "network, softmax",
        (_, Inference::Calibrated) => "network, calibrated",
        (_, Inference::Bayesian) => "by the values",
        (_, Inference::CalibratedBayesian) => "network, calibrated, and by the values",
        (_, Inference::Imagined) => "network that knows no goals",
    }
}

fn silence_words(condition: &Condition) -> &'static str {
    match (condition.rule, condition.silence) {
        (Rule::Hic, _) => "nothing changes",
        (_, Silence::Best) => "co-pilot’s best",
        (_, Silence::Nothing) => "nothing",
    }
}

fn orders(design: &Design) -> Table {
    let cells = schedule::cells(design);
    let places = (1..=design.conditions.len()).map(|place| format!("block {place}"));
    let head = ["order".to_owned()].into_iter().chain(places).chain(["participants".to_owned()]).collect();
    if design.order == Order::Random {
        let drawn = design.conditions.iter().map(|_| "drawn".to_owned());
        let row = ["each".to_owned()]
            .into_iter()
            .chain(drawn)
            .chain([design.planned_participants.to_string()])
            .collect();
        return Table { head, rows: vec![row] };
    }
    let planned = design.planned_participants as usize;
    let row = |(index, order): (usize, &Vec<usize>)| {
        let share = planned / cells.len() + usize::from(index < planned % cells.len());
        let names = order.iter().map(|&index| design.conditions[index].name.clone());
        [(index + 1).to_string()].into_iter().chain(names).chain([share.to_string()]).collect()
    };
    Table { head, rows: cells.iter().enumerate().map(row).collect() }
}

/// What one participant goes through; what follows at once in the same block is one row.
fn way_of_one(design: &Design, way: &[Step], minutes: f64) -> Table {
    let mut rows: Vec<(String, String, f64)> = Vec::new();
    for step in way {
        let (part, what) = (part_of(design, step), what_of(design, step));
        let took = estimate::minutes(design, std::slice::from_ref(step));
        match rows.last_mut() {
            Some((last_part, last_what, sum)) if *last_part == part => {
                *sum += took;
                if last_what.is_empty() {
                    *last_what = what;
                } else if !what.is_empty() && !last_what.split(", ").any(|known| known == what) {
                    *last_what = format!("{last_what}, {what}");
                }
            }
            _ => rows.push((part, what, took)),
        }
    }
    let rows = rows.into_iter().map(|(part, what, took)| vec![part, what, format!("{took:.1}")]);
    let all = vec!["together".to_owned(), String::new(), format!("{minutes:.1}")];
    Table { head: ["part", "what", "minutes"].map(str::to_owned).to_vec(), rows: rows.chain([all]).collect() }
}

fn part_of(design: &Design, step: &Step) -> String {
    match (&step.kind, step.block()) {
        (StepKind::Block(place), _) if place.measured == 0 => format!("practice of block {}", place.block),
        (StepKind::Flight(place), _) if place.practice && design.practice == Practice::InAdvance => {
            format!("practice of block {}", place.block)
        }
        (StepKind::Break, Some(block)) if step.id.ends_with("/break") => format!("break after block {block}"),
        (_, Some(block)) => format!("block {block}"),
        (StepKind::Questionnaire { .. }, None) => "at the end".to_owned(),
        (StepKind::Debrief | StepKind::Thanks, _) => "debriefing".to_owned(),
        _ => "before".to_owned(),
    }
}

fn what_of(design: &Design, step: &Step) -> String {
    match &step.kind {
        StepKind::Consent => "consent".to_owned(),
        StepKind::Device => "test of the device".to_owned(),
        StepKind::Demographics => count(design.demographics.len(), "question"),
        StepKind::Instructions => count(design.instructions.pages.len(), "page") + " of instructions",
        StepKind::Quiz => "quiz".to_owned(),
        StepKind::Block(_) => String::new(),
        StepKind::Flight(place) if place.practice => count(place.of as usize, "practice flight"),
        StepKind::Flight(place) => count(place.of as usize, "measured flight"),
        StepKind::Break => "break".to_owned(),
        StepKind::Questionnaire { instrument, .. } => {
            let items = questionnaires::find(design, instrument).map_or(0, |found| found.items.len());
            format!("{instrument} ({})", count(items, "item"))
        }
        StepKind::Debrief => "last words".to_owned(),
        StepKind::Thanks => "completion code".to_owned(),
    }
}

/// A number with its noun.
fn count(number: usize, noun: &str) -> String {
    if number == 1 { format!("1 {noun}") } else { format!("{number} {noun}s") }
}

impl fmt::Display for Explanation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(formatter, "{}\nfile {}\n", self.heading, &self.hash[..16.min(self.hash.len())])?;
        for sentence in &self.sentences {
            writeln!(formatter, "{sentence}")?;
        }
        for table in [&self.conditions, &self.orders, &self.way] {
            write!(formatter, "\n{table}")?;
        }
        if !self.cautions.is_empty() {
            writeln!(formatter, "\nBefore you run it:")?;
        }
        self.cautions.iter().try_for_each(|caution| writeln!(formatter, "- {caution}"))
    }
}

impl fmt::Display for Table {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widths: Vec<usize> = (0..self.head.len()).map(|column| self.width(column)).collect();
        self.line(formatter, &self.head, &widths)?;
        let rule: Vec<String> = widths.iter().map(|&width| "─".repeat(width)).collect();
        self.line(formatter, &rule, &widths)?;
        self.rows.iter().try_for_each(|row| self.line(formatter, row, &widths))
    }
}

impl Table {
    fn width(&self, column: usize) -> usize {
        let cells = self.rows.iter().chain([&self.head]).filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    }

    fn line(&self, formatter: &mut fmt::Formatter<'_>, cells: &[String], widths: &[usize]) -> fmt::Result {
        let padded = cells.iter().zip(widths).map(|(cell, &width)| format!("{cell:<width$}"));
        writeln!(formatter, "{}", padded.collect::<Vec<_>>().join("  ").trim_end())
    }
}
