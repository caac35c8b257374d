//! All other outcomes: looked at, not tested in advance.

use super::{Study, primary, push_figure};
use crate::analysis::{Outcome, Source};
use crate::figures::{BoxPlot, Heading};
use crate::report::{Align, Block, Document, Table, tables};
use crate::statistics::describe;
use crate::text::Text;

/// Outcomes with a figure and a table of pairs of their own, if they vary.
const SHOWN: [&str; 6] =
    ["success", "crash", "steps_of_successes", "ticks_with_command", "interventions", "opposed"];

pub(super) fn write(study: &Study<'_>, document: &mut Document) {
    let outcomes: Vec<&Outcome> =
        study.analysis.exploratory.iter().filter(|o| o.quantity.source == Source::Flights).collect();
    document.push(Block::heading("Exploratory outcomes"));
    document.push(Block::note(
        "Not declared in advance",
        "What follows was looked at without a hypothesis. With so many tests some p values fall below .05 by chance; they are \
         adjusted within a measure, not over measures. Take them for hints at what to test next.",
    ));
    document.push(Block::Table(means(study, &outcomes)));
    document
        .push(Block::Table(tables::any_difference(&outcomes, "Is there any difference between the modes?")));
    for outcome in outcomes.iter().filter(|o| SHOWN.contains(&o.quantity.key.as_str()) && varies(o)) {
        let measure = outcome.quantity.measure();
        document.push(Block::subheading(measure.title()));
        let boxes = BoxPlot {
            heading: Heading::new(measure.title(), primary::box_subtitle(study)),
            axis: outcome.quantity.axis(),
            participants: outcome.participants.clone(),
            conditions: study.looks_of(&outcome.conditions),
            values: outcome.values.clone(),
        };
        let caption = format!("{} in each mode; every point is a participant.", measure.title());
        push_figure(document, boxes.figure(), caption, &format!("{}-boxes", measure.key.replace('_', "-")));
        document.push(Block::Table(tables::pairs(&measure, &outcome.pairs)));
    }
}

fn varies(outcome: &Outcome) -> bool {
    let mut values = outcome.values.iter().flatten().flatten();
    values.next().is_some_and(|first| values.any(|value| value != first))
}

/// A row a measure, a column a mode: mean (standard deviation).
fn means(study: &Study<'_>, outcomes: &[&Outcome]) -> Table {
    let conditions = 0..study.data.design.conditions.len();
    let head = std::iter::once((Text::from("Measure"), Align::Left))
        .chain(conditions.clone().map(|c| (Text::from(study.name(c)), Align::Right)));
    let people = study.data.analysed();
    let cell = |outcome: &Outcome, condition: usize| {
        let value = |person: &usize| outcome.quantity.value(study.data, *person, condition);
        let values: Vec<f64> = people.iter().filter_map(value).collect();
        let (summary, measure) = (describe(&values).ok()?, outcome.quantity.measure());
        let given = outcome.quantity.is_given(&study.data.design.conditions[condition]);
        let sd = summary.sd.map_or("–".to_owned(), |sd| measure.difference(sd));
        let mark = if given { "\u{a0}*" } else { "" };
        Some(format!("{}\u{a0}({sd}){mark}", measure.write(summary.mean)))
    };
    let row = |outcome: &&Outcome| {
        let cells =
            conditions.clone().map(|c| Text::from(cell(outcome, c).unwrap_or_else(|| "–".to_owned())));
        std::iter::once(Text::from(outcome.quantity.measure().title())).chain(cells).collect()
    };
    Table {
        caption: Text::from("Every other measure: mean over participants (standard deviation between them)."),
        columns: head.collect(),
        rows: outcomes.iter().map(row).collect(),
        notes: vec![Text::from(
            "Standard deviations of shares are in percentage points. –: no participant has a value. *: so by construction \
             (nobody intervenes under human alone; a goal that is told is always right), and in no test.",
        )],
    }
}
