//! Who took part, who was lost where and why, and how well the machines ran.

use super::{Study, items, push_figure};
use crate::apa;
use crate::dataset::{Answer, LeftOut, Person, Progress, Trial};
use crate::design::Item;
use crate::figures::{Flow, Heading, Stage};
use crate::report::{Align, Block, Document, Table};
use crate::statistics::describe;
use crate::text::Text;
use std::collections::BTreeMap;

pub(super) fn write(study: &Study<'_>, document: &mut Document) {
    document.push(Block::heading("Participants"));
    push_figure(document, flow(study).figure(), "The participants’ way through the study.", "participants");
    document.blocks.extend(apart(study).map(Block::Paragraph));
    let excluded: Vec<Text> = study
        .data
        .participants
        .iter()
        .enumerate()
        .filter(|(i, _)| study.data.left_out(*i) == Some(LeftOut::Excluded))
        .map(|(_, person)| {
            let why = person.excluded.as_deref().unwrap_or_default();
            Text::new().strong(person.code.clone()).plain(format!(": {why}"))
        })
        .collect();
    if !excluded.is_empty() {
        document.push(Block::paragraph("Excluded from all analyses; their data are in the export:"));
        document.push(Block::List(excluded));
    }
    let about_them: Vec<&Item> = study.data.design.demographics.iter().collect();
    let is_about =
        |answer: &Answer| answer.step == "demographics" && study.data.left_out(answer.participant).is_none();
    let described =
        items::table(study, "Those who are analysed, by their own account.", &about_them, is_about);
    document.blocks.extend(described.map(Block::Table));
    document.push(Block::Table(quality(study)));
}

/// Those who are counted: people, or simulated participants where there are no people. Tests are nobody's.
fn counted<'a>(study: &'a Study<'_>) -> Vec<(&'a Person, Option<LeftOut>)> {
    let people =
        study.data.participants.iter().enumerate().map(|(i, person)| (person, study.data.left_out(i)));
    people.filter(|(_, left_out)| !matches!(left_out, Some(LeftOut::Test | LeftOut::Simulated))).collect()
}

fn flow(study: &Study<'_>) -> Flow {
    let people = counted(study);
    let count = |reason: LeftOut| people.iter().filter(|(_, left_out)| *left_out == Some(reason)).count();
    let some = |lost: &[(LeftOut, &str)]| -> Vec<(String, usize)> {
        let named = lost.iter().map(|(reason, words)| ((*words).to_owned(), count(*reason)));
        named.filter(|(_, count)| *count > 0).collect()
    };
    let before = some(&[(LeftOut::NeverBegan, "never gave consent"), (LeftOut::Declined, "declined")]);
    let under_way = some(&[
        (LeftOut::Withdrawn, "withdrew; their data were deleted"),
        (LeftOut::Unfinished, "did not finish"),
    ]);
    let began_lost: usize = before.iter().map(|(_, count)| count).sum();
    let on_the_way: usize = under_way.iter().map(|(_, count)| count).sum();
    let excluded = count(LeftOut::Excluded);
    let unfinished = |person: &Person| person.progress != Progress::Completed;
    let excluded_early =
        people.iter().filter(|(p, l)| *l == Some(LeftOut::Excluded) && unfinished(p)).count();
    let mut lost = under_way;
    if excluded_early > 0 {
        lost.push(("excluded on the way".to_owned(), excluded_early));
    }
    let began = people.len() - began_lost;
    let finished = began - on_the_way - excluded_early;
    let late = excluded - excluded_early;
    let exclusions =
        if late > 0 { vec![("excluded, for reasons listed below".to_owned(), late)] } else { Vec::new() };
    let stage = |name: &str, count, lost| Stage { name: name.to_owned(), count, lost };
    Flow {
        heading: Heading::new("Who took part", "From the invitation to the analysis."),
        stages: vec![
            stage("Invited", people.len(), before),
            stage("Gave consent and got an order of modes", began, lost),
            stage("Finished", finished, exclusions),
            stage("Analysed", finished - late, Vec::new()),
        ],
        groups: orders(study),
    }
}

/// How many of those analysed flew each order of modes.
fn orders(study: &Study<'_>) -> Vec<(String, usize)> {
    let mut counts: BTreeMap<&[usize], usize> = BTreeMap::new();
    for person in study.data.analysed() {
        *counts.entry(&study.data.participants[person].order).or_default() += 1;
    }
    let named = |order: &[usize]| order.iter().map(|&c| study.name(c)).collect::<Vec<_>>().join(" → ");
    counts.into_iter().map(|(order, count)| (named(order), count)).collect()
}

fn apart(study: &Study<'_>) -> Option<Text> {
    let count =
        |reason| study.analysis.left_out.iter().find(|(r, _)| *r == reason).map_or(0, |(_, count)| *count);
    let parts: Vec<String> = [(LeftOut::Test, "test run"), (LeftOut::Simulated, "simulated participant")]
        .into_iter()
        .filter(|(reason, _)| count(*reason) > 0)
        .map(|(reason, name)| {
            let n = count(reason);
            format!("{n} {name}{}", if n == 1 { "" } else { "s" })
        })
        .collect();
    (!parts.is_empty()).then(|| {
        Text::from(format!("Not counted here and in no analysis: {}.", super::words::listed(&parts)))
    })
}

/// What could have spoilt the data: interruptions, late ticks, flights that could not be measured.
fn quality(study: &Study<'_>) -> Table {
    let people = study.data.analysed();
    let trials: Vec<&Trial> = study
        .data
        .trials
        .iter()
        .filter(|trial| people.contains(&trial.participant) && !trial.practice)
        .collect();
    let counting: Vec<&&Trial> = trials.iter().filter(|trial| trial.counts).collect();
    let exact = counting.iter().filter(|trial| trial.measured.is_ok()).count();
    let again = trials.iter().filter(|trial| !trial.counts).count();
    let interrupted = counting.iter().filter(|trial| trial.interruptions > 0).count();
    let abandoned = counting.iter().filter(|trial| {
        trial.measured.as_ref().is_ok_and(|measured| measured.ending == cohelm::plant::Ending::Abandoned)
    });
    let minutes: Vec<f64> = people.iter().filter_map(|&p| study.data.participants[p].minutes).collect();
    let rows = [
        ("Measured flights", counting.len().to_string()),
        ("– flown again with the same bits, and measured", exact.to_string()),
        ("– interrupted in the air and resumed", interrupted.to_string()),
        ("– given up before an ending", abandoned.count().to_string()),
        ("Attempts that do not count (refused, or not finished)", again.to_string()),
        ("Late ticks, share of all ticks", late_ticks(&counting)),
        ("Minutes from consent to the end: median (range)", spread(&minutes)),
    ];
    Table {
        caption: Text::from("The data at a glance."),
        columns: vec![(Text::from("Of those who are analysed"), Align::Left), (Text::from(""), Align::Right)],
        rows: rows.into_iter().map(|(name, value)| vec![Text::from(name), Text::from(value)]).collect(),
        notes: unmeasured(&counting),
    }
}

fn late_ticks(trials: &[&&Trial]) -> String {
    let told = trials.iter().filter_map(|trial| Some((trial.telemetry.get("late_ticks")?, trial)));
    let (late, ticks) = told.fold((0.0, 0.0), |sum, (late, trial)| {
        let steps = trial.measured.as_ref().ok().and_then(|m| m.values.get("steps")).copied().unwrap_or(0.0);
        (sum.0 + late, sum.1 + steps)
    });
    if ticks > 0.0 { apa::percent(late / ticks, 2) } else { "not recorded".to_owned() }
}

fn spread(minutes: &[f64]) -> String {
    describe(minutes).map_or_else(
        |_| "–".to_owned(),
        |s| format!("{} ({} to {})", apa::number(s.median, 0), apa::number(s.min, 0), apa::number(s.max, 0)),
    )
}

/// Why flights could not be measured, with how many.
fn unmeasured(trials: &[&&Trial]) -> Vec<Text> {
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    for why in trials.iter().filter_map(|trial| trial.measured.as_ref().err()) {
        *reasons.entry(why).or_default() += 1;
    }
    reasons.into_iter().map(|(why, n)| Text::from(format!("Not measured, {n}: {why}."))).collect()
}
