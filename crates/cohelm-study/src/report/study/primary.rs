//! The declared primary outcome: first, and apart from everything else.

use super::{Study, push_figure, words};
use crate::analysis::Outcome;
use crate::apa;
use crate::figures::{BoxPlot, Heading, PairedSlopes};
use crate::report::{Align, Block, Document, Table, tables};
use crate::statistics::describe;
use crate::text::{Text, capitalised};

/// What came of the primary outcome, in a sentence.
pub(super) fn headline(study: &Study<'_>) -> Text {
    let alpha = study.data.design.primary.alpha;
    match &study.analysis.primary {
        Ok(outcome) if outcome.table.rows().is_empty() => {
            Text::from("Nobody has completed it yet, so that nothing can be tested.")
        }
        Ok(outcome) if outcome.names().len() == 2 => words::difference(outcome, alpha),
        Ok(outcome) => words::difference(outcome, alpha).plain(format!(" Means: {}.", means(outcome))),
        Err(why) => Text::from(format!("The primary outcome cannot be tested: {why}.")),
    }
}

/// "hic 4.0 %, misc 85.5 %".
fn means(outcome: &Outcome) -> String {
    let measure = outcome.quantity.measure();
    let columns = outcome.table.columns();
    let means = outcome.names().iter().zip(&columns).filter_map(|(name, column)| {
        let summary = describe(column).ok()?;
        Some(format!("{name} {}", measure.write(summary.mean)))
    });
    means.collect::<Vec<_>>().join(", ")
}

pub(super) fn write(study: &Study<'_>, document: &mut Document) {
    let declared = &study.data.design.primary;
    document.push(Block::heading("Primary outcome"));
    let hypothesis = declared.hypothesis.as_ref().map_or_else(
        || Text::from("The design declares no hypothesis in words."),
        |hypothesis| Text::from("Declared in advance: “").plain(hypothesis.trim_end()).plain("”"),
    );
    let level = format!(" Measure: {}. Level of significance: ", declared.measure);
    document.push(Block::paragraph(
        hypothesis
            .plain(level)
            .plain(apa::fraction(declared.alpha, 3).trim_end_matches('0').to_owned())
            .plain("."),
    ));
    let outcome = match &study.analysis.primary {
        Ok(outcome) => outcome,
        Err(why) => {
            let why = format!("{}.", capitalised(why));
            document.push(Block::warning("The primary outcome cannot be tested", why));
            return;
        }
    };
    results(study, outcome, document);
    figures(study, outcome, document);
    let measure = outcome.quantity.measure();
    document.push(Block::Table(tables::summary(&measure, &outcome.table)));
    document.push(Block::Table(tables::pairs(&measure, &outcome.pairs)));
    document.push(Block::Table(interquartile_means(outcome)));
}

fn results(study: &Study<'_>, outcome: &Outcome, document: &mut Document) {
    let alpha = study.data.design.primary.alpha;
    let tested =
        words::difference(outcome, alpha).then(words::friedman(outcome)).then(words::one_way(outcome));
    document.push(Block::paragraph(tested));
    document.push(Block::List(outcome.pairs.iter().map(|pair| words::pair(outcome, pair, alpha)).collect()));
    if outcome.bound.is_none() && outcome.pairs.iter().any(|pair| pair.t.as_ref().is_ok_and(|t| t.p >= alpha))
    {
        document.push(Block::paragraph(
            "A difference that is not significant is no evidence of sameness. The design gives no bound within which two modes \
             would count as equal, so equivalence was not tested.",
        ));
    }
    document.blocks.extend(words::gaps(outcome).map(Block::Paragraph));
}

/// At most this many pairs get slopes of their own; with more modes the boxes show them all.
const MOST_SLOPES: usize = 3;

fn figures(study: &Study<'_>, outcome: &Outcome, document: &mut Document) {
    let title = outcome.quantity.measure().title();
    let boxes = BoxPlot {
        heading: Heading::new(title.clone(), box_subtitle(study)),
        axis: outcome.quantity.axis(),
        participants: outcome.participants.clone(),
        conditions: study.looks_of(&outcome.conditions),
        values: outcome.values.clone(),
    };
    let caption = format!("{title} in each mode; every point is a participant.");
    push_figure(document, boxes.figure(), caption, "primary-boxes");
    if outcome.table.rows().is_empty() {
        return;
    }
    for (i, pair) in outcome.pairs.iter().take(MOST_SLOPES).enumerate() {
        let slopes = slopes(study, outcome, (&pair.first, &pair.second));
        let caption =
            format!("{title}: what each participant gained or lost from {} to {}.", pair.first, pair.second);
        push_figure(document, slopes, caption, &format!("primary-slopes-{}", i + 1));
    }
}

pub(super) fn box_subtitle(study: &Study<'_>) -> String {
    format!(
        "{}. Box: quartiles; line: median; diamond: mean; whiskers: values within 1.5 box lengths.",
        study.people()
    )
}

fn slopes(
    study: &Study<'_>,
    outcome: &Outcome,
    (first, second): (&str, &str),
) -> Result<crate::figures::Figure, crate::figures::FigureError> {
    let column = |name: &str| {
        outcome.table.condition(name).and_then(|index| outcome.table.column(index)).unwrap_or_default()
    };
    let slopes = PairedSlopes {
        heading: Heading::new(
            format!("{}: {first} and {second}", outcome.quantity.measure().title()),
            format!("{}. Thin line: one participant; thick line: mean.", study.people()),
        ),
        axis: outcome.quantity.axis(),
        participants: outcome.table.participants().to_vec(),
        conditions: study.looks.only(&[first, second]),
        pairs: column(first).into_iter().zip(column(second)).collect(),
        bound: outcome.bound,
    };
    slopes.figure()
}

fn interquartile_means(outcome: &Outcome) -> Table {
    let measure = outcome.quantity.measure();
    let row = |(name, iqm): (&String, &Result<_, _>)| {
        let cells = match iqm {
            Ok(crate::statistics::bootstrap::Bootstrapped { estimate, interval, .. }) => [
                Text::from(measure.write(*estimate)),
                Text::from(format!("[{}, {}]", measure.write(interval.low), measure.write(interval.high))),
            ],
            Err(why) => [apa::undefined(why), Text::from("–")],
        };
        std::iter::once(Text::from(name.as_str())).chain(cells).collect()
    };
    let heads =
        [("Mode", Align::Left), ("Interquartile mean", Align::Right), ("95\u{202f}% interval", Align::Right)];
    Table {
        caption: Text::from(format!(
            "{}: interquartile means, little moved by single participants.",
            measure.title()
        )),
        columns: heads.into_iter().map(|(head, align)| (Text::from(head), align)).collect(),
        rows: outcome.names().iter().zip(&outcome.interquartile_means).map(row).collect(),
        notes: vec![Text::from(
            "Stratified bootstrap: participants are drawn anew within the groups that flew the same order of modes.",
        )],
    }
}
