//! The report of a reproduction: what is claimed, what came out, and the numbers behind it.

use super::claims::{Trained, claims};
use super::figures::{figure_2a, figure_2b, figure_2c, looks};
use super::name;
use crate::experiment::Experiment;
use crate::results::Results;
use cohelm_study::apa;
use cohelm_study::figures::{Axis, Better, Figure, FigureError, Heading, ParetoPoint, ParetoScatter};
use cohelm_study::measures::{Measure, measure};
use cohelm_study::report::{Align, Block, Document, Table};
use cohelm_study::statistics::{self, one_way, paired_t, repeated_measures};
use cohelm_study::text::Text;

/// What the report says of its own making.
#[derive(Clone, Debug)]
pub struct Setting<'a> {
    /// The experiment.
    pub experiment: &'a Experiment,
    /// What trained the models.
    pub trained: Trained<'a>,
    /// The command that makes it again.
    pub command: String,
    /// Version of the program.
    pub program: String,
}

/// Measures of the main table, by key.
const MAIN: [&str; 9] = [
    "success",
    "crash",
    "elsewhere",
    "steps",
    "ticks_with_command",
    "key_presses",
    "interventions",
    "nominal_interventions",
    "opposed",
];

/// Measures that are tested, LASC against MISC.
const TESTED: [&str; 8] = [
    "success",
    "crash",
    "steps",
    "steps_of_successes",
    "ticks_with_command",
    "key_presses",
    "commands_per_second",
    "nominal_interventions",
];

/// The whole report.
pub fn document(results: &Results<'_>, setting: &Setting<'_>) -> Result<Document, FigureError> {
    let experiment = setting.experiment;
    let mut document = Document::new("The paper’s experiment, with simulated pilots");
    document.lead = Text::from(
        "Adaptive Arbitration for Minimal Intervention Shared Control via Deep Reinforcement Learning (You, Kang, Zhao \
         and Zhang): its three modes, its claims and its Fig. 2, flown again by models of pilots.",
    );
    document.facts = facts(setting);
    document.push(Block::warning(
        "The pilots are simulated",
        "No person flew here. The participants are models with reaction delays, divided attention, wrong keys, resistance \
         and trust; they show what follows from such behaviour, not what people do. No questionnaire was answered.",
    ));
    document.push(Block::heading("Claims"));
    document.push(Block::Verdicts(claims(results, setting.trained)));
    document.push(Block::paragraph(
        "Verdicts are computed: a difference must be significant in a paired test over participants (p < .05), sameness \
         must be shown by an equivalence test (±0.05 of success). The paper’s p values are those of a one-way ANOVA with \
         df (1, 18), although the same ten people flew both modes; it stands beside ours below.",
    ));
    let subtitle = format!(
        "{} simulated participants, {} episodes each in every mode",
        results.participants, experiment.episodes
    );
    document.push(Block::heading("Figure 2"));
    let figures = [
        (figure_2a(results, &subtitle)?, "Success and crash rates (the paper’s Fig. 2a).", "figures/fig2a"),
        (
            figure_2b(results, &subtitle)?,
            "Steps per episode (Fig. 2b). A mode that crashes early looks fast.",
            "figures/fig2b",
        ),
        (
            figure_2c(results, &subtitle)?,
            "Inputs per episode (Fig. 2c), counted in two ways.",
            "figures/fig2c",
        ),
    ];
    for (figure, caption, file) in figures {
        document.push(Block::figure(figure, caption, file));
    }
    document.push(Block::heading("All conditions"));
    document.push(Block::Table(main_table(results)));
    document.push(Block::figure(
        trade_off(results, &subtitle)?,
        "Success against the share of asked commands that were replaced in effect: up and to the left is better.",
        "figures/tradeoff",
    ));
    document.push(Block::heading("Tests, LASC against MISC"));
    document.push(Block::Table(tests_table(
        results,
        (name::LASC, name::MISC),
        "with the paper’s confidence",
    )));
    document.push(Block::Table(tests_table(
        results,
        (name::LASC_PEAKED, name::MISC_PEAKED),
        "with the peaked confidence",
    )));
    document.push(Block::heading("What is measured"));
    document.push(Block::measures(MAIN.iter().chain(&TESTED[3..7]).map(|key| defined(key)).fold(
        Vec::new(),
        |mut measures: Vec<&Measure>, measure| {
            if !measures.iter().any(|known| known.key == measure.key) {
                measures.push(measure);
            }
            measures
        },
    )));
    document.push(Block::heading("Again"));
    document.push(Block::Code(setting.command.clone()));
    Ok(document)
}

fn facts(setting: &Setting<'_>) -> Vec<(String, String)> {
    let experiment = setting.experiment;
    let hash = |hash: &Option<String>| {
        hash.as_deref().map_or("–".into(), |hash| hash[..12.min(hash.len())].to_string())
    };
    let fact = |name: &str, value: String| (name.to_string(), value);
    vec![
        fact("Program", setting.program.clone()),
        fact("Plant", format!("{} {}", experiment.task.plant, experiment.task.options)),
        fact("Pilots", experiment.pilot.clone()),
        fact("Seed", experiment.seed.to_string()),
        fact("Participants", experiment.participants.to_string()),
        fact(
            "Episodes",
            format!("{} a participant and condition (the paper gives no count: ours)", experiment.episodes),
        ),
        fact("Values", format!("{} ({})", setting.trained.values.name, hash(&experiment.values))),
        fact("Intent", format!("{} ({})", setting.trained.intent.name, hash(&experiment.intent))),
    ]
}

fn defined(key: &str) -> &'static Measure<'static> {
    measure(key).expect("the report names defined measures")
}

fn main_table(results: &Results<'_>) -> Table {
    let head = MAIN.iter().map(|key| (Text::from(defined(key).title()), Align::Right));
    let row = |(index, condition): (usize, &crate::experiment::Condition)| {
        let cells = MAIN.iter().map(|key| {
            let mean = results.mean(key, index);
            Text::from(mean.map_or("–".into(), |mean| defined(key).write(mean)))
        });
        std::iter::once(Text::from(condition.label.as_str())).chain(cells).collect()
    };
    Table {
        caption: Text::from("Means over participants."),
        columns: std::iter::once((Text::from("Condition"), Align::Left)).chain(head).collect(),
        rows: results.conditions.iter().enumerate().map(row).collect(),
        notes: vec![Text::from(
            "All helped conditions take the same goal, that nearest to the predicted position; the robot alone is told \
             the goal. Interventions are shares of the ticks with a command.",
        )],
    }
}

fn tests_table(results: &Results<'_>, (lasc, misc): (&str, &str), which: &str) -> Table {
    let columns =
        ["Measure", "LASC", "MISC", "One-way ANOVA (the paper’s)", "Within subjects", "Paired t", "Effect"];
    let align = |(i, name): (usize, &str)| {
        (Text::from(name), if (1..3).contains(&i) { Align::Right } else { Align::Left })
    };
    Table {
        caption: Text::from(format!("LASC against MISC {which}, over participants’ means.")),
        columns: columns.into_iter().enumerate().map(align).collect(),
        rows: TESTED.iter().map(|key| test_row(results, key, lasc, misc)).collect(),
        notes: vec![Text::from(
            "p values are not adjusted for the number of rows; every row but the claims is exploratory.",
        )],
    }
}

fn test_row(results: &Results<'_>, key: &str, lasc: &str, misc: &str) -> Vec<Text> {
    let measure = defined(key);
    let table =
        results.table(key, &[misc, lasc]).expect("means of finite measures under different names").table;
    let mean = |name: &str| {
        let mean = results.condition(name).and_then(|index| results.mean(key, index));
        Text::from(mean.map_or("–".into(), |mean| measure.write(mean)))
    };
    let or_why =
        |tested: Result<Text, statistics::Undefined>| tested.unwrap_or_else(|why| apa::undefined(&why));
    let pairs = table.pair(0, 1);
    let within = repeated_measures(&table).map(|test| apa::repeated_measures(&test));
    let t = pairs.clone().and_then(|pairs| paired_t(&pairs)).map(|test| apa::paired_t(&test));
    let options = statistics::bootstrap::Options::default();
    let effect = pairs.and_then(|pairs| statistics::bootstrap::effect_size(&pairs, options));
    vec![
        Text::from(measure.title()),
        mean(lasc),
        mean(misc),
        or_why(one_way(&table).map(|test| apa::one_way(&test))),
        or_why(within),
        or_why(t),
        or_why(effect.map(|effect| apa::effect_size(&effect))),
    ]
}

fn trade_off(results: &Results<'_>, subtitle: &str) -> Result<Figure, FigureError> {
    let point = |(index, condition): (usize, &crate::experiment::Condition)| {
        let at = (results.mean("interventions", index)?, results.mean("success", index)?);
        Some(ParetoPoint { label: condition.label.clone(), condition: index, at, intervals: (None, None) })
    };
    let scatter = ParetoScatter {
        heading: Heading::new("What help costs", subtitle),
        x: (Axis::share("Asked commands that were replaced in effect"), Better::Lower),
        y: (Axis::share("Success rate"), Better::Higher),
        conditions: looks(results),
        points: results.conditions.iter().enumerate().filter_map(point).collect(),
        behind: None,
    };
    scatter.figure()
}
