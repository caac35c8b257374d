//! Each claim of the paper, and what our data say of it.

use super::name;
use crate::results::Results;
use cohelm_copilot::Card;
use cohelm_study::measures::{Measure, measure};
use cohelm_study::report::VerdictRow;
use cohelm_study::statistics::Table;
use cohelm_study::text::Text;
use cohelm_study::verdict::{
    Comparison, Direction, Judgement, Limit, Part, difference_in_direction, each_part_holds,
    equivalent_within, every_participant, needs_people, under_settings,
};

/// Largest difference of success rates that counts as the same.
const SAME_SUCCESS: f64 = 0.05;
/// Crash rate that the paper says every participant exceeds alone.
const CRASHES_ALONE: f64 = 0.8;

/// How the two kinds of confidence complete "only if …", with the linear and the minimal condition under each.
const SETTINGS: [(&str, &str, &str); 2] = [
    ("c comes from inverse distances, as printed", name::LASC, name::MISC),
    ("c is peaked (softmax of distances)", name::LASC_PEAKED, name::MISC_PEAKED),
];

/// What the models say of their own training: the cards of values and intent.
#[derive(Clone, Copy, Debug)]
pub struct Trained<'a> {
    /// Card of the value model.
    pub values: &'a Card,
    /// Card of the intent model.
    pub intent: &'a Card,
}

/// The claims with their verdicts, in the order of the paper.
pub fn claims(results: &Results<'_>, trained: Trained<'_>) -> Vec<VerdictRow> {
    let lasc_misc = |of: fn(&Results<'_>, &str, &str) -> Judgement| {
        let judge =
            |(setting, lasc, misc): (&str, &str, &str)| (setting.to_string(), of(results, lasc, misc));
        under_settings(SETTINGS.map(judge).into())
    };
    vec![
        row(
            "Alone, every participant crashes in more than 80 % of the episodes.",
            "“the crash rates of the ten participants are greater than 0.8”",
            every(results, "crash", name::HIC, Limit::Above(CRASHES_ALONE)),
        ),
        row(
            "Help greatly increases success.",
            "“greatly increased the success rates” (Fig. 2a)",
            helped(results),
        ),
        row(
            "MISC and LASC succeed alike.",
            "F = 0.05, p = .8265, read as “no significant difference”",
            lasc_misc(|results, lasc, misc| same(results, "success", misc, lasc, SAME_SUCCESS)),
        ),
        row(
            "MISC completes the task in fewer steps than LASC.",
            "F = 8.65, p = .0087 (one-way)",
            lasc_misc(|results, lasc, misc| differs(results, "steps", misc, lasc, Direction::Lower)),
        ),
        row(
            "MISC takes fewer inputs than LASC.",
            "100–500 against 300–800 an episode (Fig. 2c)",
            lasc_misc(|results, lasc, misc| {
                differs(results, "ticks_with_command", misc, lasc, Direction::Lower)
            }),
        ),
        row(
            "MISC interferes less than LASC.",
            "“troubled by the assistance”: 3.6 → 1.2 of 10; here: commands replaced by another",
            lasc_misc(|results, lasc, misc| {
                differs(results, "nominal_interventions", misc, lasc, Direction::Lower)
            }),
        ),
        row(
            "The adaptive threshold does better than a constant one (reference [9]).",
            "“obtains better control effects”, no numbers",
            better_than_constant(results),
        ),
        row(
            "Neither the dynamics nor the human’s behaviour needs to be modelled (contribution 3).",
            "“does not require the dynamic model …, the human’s behavior strategy or other information”",
            each_part_holds(&needs_no_model(trained)),
        ),
        row(
            "Participants are more satisfied and less troubled with MISC (Table I).",
            "satisfied 7.8 → 8.6, troubled 3.6 → 1.2",
            needs_people(0, || unreachable!("there are no answers to judge")),
        ),
    ]
}

fn row(claim: &str, paper: &str, judgement: Judgement) -> VerdictRow {
    VerdictRow { claim: Text::from(claim), paper: Text::from(paper), judgement }
}

/// Success of each helped condition with the paper's confidence above that of the person alone.
fn helped(results: &Results<'_>) -> Judgement {
    let above = |(setting, helped): (&str, &str)| {
        (setting.to_string(), differs(results, "success", helped, name::HIC, Direction::Higher))
    };
    let conditions = [
        ("LASC helps", name::LASC),
        ("MISC helps", name::MISC),
        ("LASC helps with a peaked c", name::LASC_PEAKED),
        ("MISC helps with a peaked c", name::MISC_PEAKED),
    ];
    under_settings(conditions.map(above).into())
}

/// MISC's success above that of the constant tolerance.
fn better_than_constant(results: &Results<'_>) -> Judgement {
    let above = |(setting, _, misc): (&str, &str, &str)| {
        (setting.to_string(), differs(results, "success", misc, name::TOLERANCE, Direction::Higher))
    };
    under_settings(SETTINGS.map(above).into())
}

/// Contribution 3, from what the cards record of the training.
fn needs_no_model(trained: Trained<'_>) -> [Part; 2] {
    let share =
        |option: &str| trained.values.options.get(option).and_then(|value| value.as_f64()).unwrap_or(0.0);
    let pilots =
        trained.intent.options.pointer("/training/pilots").and_then(|value| value.as_u64()).unwrap_or(0);
    let from_nobody = share("pilots") == 0.0 && share("teacher") == 0.0;
    let steered = 100.0 * share("pilots") + 100.0 * share("teacher");
    let values = if from_nobody {
        "The values were learnt by flying alone, without pilots and without a teacher.".to_string()
    } else {
        format!("The values were learnt with a pilot or teacher in {steered:.0} % of the worlds.")
    };
    let intent =
        format!("Intent was learnt from flights of {pilots} (simulated) pilots: it models how people ask.");
    [
        Part { name: "the values".into(), holds: from_nobody, evidence: Text::from(values) },
        Part { name: "the intent".into(), holds: pilots == 0, evidence: Text::from(intent) },
    ]
}

fn differs(
    results: &Results<'_>,
    key: &str,
    condition: &str,
    against: &str,
    direction: Direction,
) -> Judgement {
    let (measure, table) = labelled(results, key, &[condition, against]);
    let (condition, against) = (label(results, condition), label(results, against));
    let comparison = Comparison { table: &table, measure, condition: &condition, against: &against };
    difference_in_direction(&comparison, direction, 0.0)
}

fn same(results: &Results<'_>, key: &str, condition: &str, against: &str, bound: f64) -> Judgement {
    let (measure, table) = labelled(results, key, &[condition, against]);
    let (condition, against) = (label(results, condition), label(results, against));
    equivalent_within(&Comparison { table: &table, measure, condition: &condition, against: &against }, bound)
}

fn every(results: &Results<'_>, key: &str, condition: &str, limit: Limit) -> Judgement {
    let (measure, table) = labelled(results, key, &[condition]);
    every_participant(&table, measure, &label(results, condition), limit)
}

/// The label of a condition, or its name if it was not flown.
fn label(results: &Results<'_>, name: &str) -> String {
    let condition = results.condition(name).map(|index| results.conditions[index].label.clone());
    condition.unwrap_or_else(|| name.into())
}

/// A measure and its table with the labels of the conditions, as sentences call them.
fn labelled(results: &Results<'_>, key: &str, conditions: &[&str]) -> (&'static Measure<'static>, Table) {
    let measure = measure(key).expect("the claims name defined measures");
    let table = results.table(key, conditions).expect("means of finite measures under different names").table;
    let labels = conditions.iter().map(|name| label(results, name)).collect();
    let renamed = Table::complete(table.participants().to_vec(), labels, table.rows().to_vec());
    (measure, renamed.expect("labels of different conditions differ"))
}
