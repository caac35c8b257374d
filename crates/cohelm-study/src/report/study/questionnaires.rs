//! What was asked after the modes: each item as the paper's Table I has it, and the scores compared.

use super::{Study, primary, push_figure};
use crate::analysis::{Outcome, Quantity, Source};
use crate::apa;
use crate::design::AnswerKind;
use crate::figures::{BoxPlot, Heading};
use crate::questionnaires::{self, Questionnaire};
use crate::report::{Align, Block, Document, Table, tables};
use crate::statistics::describe;
use crate::text::Text;

pub(super) fn write(study: &Study<'_>, document: &mut Document) {
    let design = &study.data.design;
    let mut asked: Vec<&str> = Vec::new();
    for name in design.conditions.iter().flat_map(|c| &c.questionnaires).chain(&design.end_questionnaires) {
        if !asked.contains(&name.as_str()) {
            asked.push(name);
        }
    }
    if asked.is_empty() {
        return;
    }
    document.push(Block::heading("Questionnaires"));
    for questionnaire in asked.into_iter().filter_map(|name| questionnaires::find(design, name)) {
        one(study, questionnaire, document);
    }
}

fn one(study: &Study<'_>, questionnaire: &Questionnaire, document: &mut Document) {
    document.push(Block::subheading(questionnaire.title.read("en", study.data.design.first_language())));
    let source = questionnaire.source.as_deref().unwrap_or("Made for this study.");
    document.push(Block::paragraph(Text::new().code(questionnaire.name.clone()).plain(format!(" {source}"))));
    let answered = study
        .data
        .answers
        .iter()
        .any(|answer| is_about(study, answer, questionnaire) && !answer.value.is_null());
    if !answered {
        document.push(Block::paragraph(if study.data.simulated() {
            "Nobody answered it: simulated participants have no opinions, and none was invented for them."
        } else {
            "Nobody who is analysed answered it."
        }));
        return;
    }
    let is_scale = |item: &&crate::design::Item| matches!(item.answer, AnswerKind::Scale(_));
    let (scales, others): (Vec<_>, Vec<_>) = questionnaire.items.iter().partition(is_scale);
    if !scales.is_empty() {
        document.push(Block::Table(items(study, questionnaire)));
    }
    let about = |answer: &crate::dataset::Answer| is_about(study, answer, questionnaire);
    let summed_up = super::items::table(study, "Its other items, over all modes.", &others, about);
    document.blocks.extend(summed_up.map(Block::Table));
    if others.iter().any(|item| matches!(item.answer, AnswerKind::Text { .. })) {
        let text = Text::from("Answers in words are in the export, in ").code("answers.csv").plain(".");
        document.push(Block::Paragraph(text));
    }
    let of_it = |outcome: &&Outcome| matches!(&outcome.quantity.source, Source::Score { instrument, .. } if *instrument == questionnaire.name);
    let scores: Vec<&Outcome> = study.analysis.exploratory.iter().filter(of_it).collect();
    if !scores.is_empty() {
        document
            .push(Block::Table(tables::any_difference(&scores, "Its scores, compared between the modes.")));
    }
    document.blocks.extend(at_the_end(study, questionnaire).map(Block::Table));
    for outcome in scores.iter().filter(|outcome| outcome.quantity.key.ends_with("/overall")) {
        let measure = outcome.quantity.measure();
        let boxes = BoxPlot {
            heading: Heading::new(measure.title(), primary::box_subtitle(study)),
            axis: outcome.quantity.axis(),
            participants: outcome.participants.clone(),
            conditions: study.looks_of(&outcome.conditions),
            values: outcome.values.clone(),
        };
        let file = format!("{}-boxes", questionnaire.name);
        push_figure(
            document,
            boxes.figure(),
            format!("{}; every point is a participant.", measure.title()),
            &file,
        );
        document.push(Block::Table(tables::pairs(&measure, &outcome.pairs)));
    }
}

/// The scores of a questionnaire that was asked at the end, if it was.
fn at_the_end(study: &Study<'_>, questionnaire: &Questionnaire) -> Option<Table> {
    let of_it = |quantity: &Quantity| matches!(&quantity.source, Source::Score { instrument, .. } if *instrument == questionnaire.name);
    let row = |quantity: Quantity| {
        let value = |person: usize| quantity.value_at_the_end(study.data, person);
        let values: Vec<f64> = study.data.analysed().into_iter().filter_map(value).collect();
        let mut cells = vec![quantity.measure().title(), values.len().to_string()];
        match describe(&values) {
            Ok(s) => cells.extend([
                apa::number(s.mean, 1),
                s.sd.map_or_else(|| "–".to_owned(), |sd| apa::number(sd, 1)),
                format!("{} to {}", apa::number(s.min, 1), apa::number(s.max, 1)),
            ]),
            Err(_) => cells.extend(["–", "–", "–"].map(str::to_owned)),
        }
        cells.into_iter().map(Text::from).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<Text>> = Quantity::end_scores(study.data).into_iter().filter(of_it).map(row).collect();
    let align = |i: usize| if i == 0 { Align::Left } else { Align::Right };
    let heads = ["Score", "n", "Mean", "SD", "Range"];
    (!rows.is_empty()).then(|| Table {
        caption: Text::from("Its scores at the end, about all modes together."),
        columns: heads.into_iter().enumerate().map(|(i, head)| (Text::from(head), align(i))).collect(),
        rows,
        notes: Vec::new(),
    })
}

fn is_about(study: &Study<'_>, answer: &crate::dataset::Answer, questionnaire: &Questionnaire) -> bool {
    answer.step.rsplit('/').next() == Some(questionnaire.name.as_str())
        && answer.step.contains("questionnaire/")
        && study.data.left_out(answer.participant).is_none()
}

/// A row an item, a column a mode (or "at the end"): mean and standard deviation of the answers as given.
fn items(study: &Study<'_>, questionnaire: &Questionnaire) -> Table {
    let mut places: Vec<Option<usize>> = Vec::new();
    for answer in study.data.answers.iter().filter(|answer| is_about(study, answer, questionnaire)) {
        if !places.contains(&answer.condition) {
            places.push(answer.condition);
        }
    }
    places.sort_unstable();
    let name =
        |place: &Option<usize>| place.map_or("At the end", |condition| study.name(condition)).to_owned();
    let language = study.data.design.first_language();
    let cell = |item: &str, place: &Option<usize>| {
        let answers = study.data.answers.iter().filter(|a| is_about(study, a, questionnaire));
        let given: Vec<f64> = answers
            .filter(|answer| answer.item == item && answer.condition == *place)
            .filter_map(|answer| answer.value.as_f64())
            .collect();
        let summary = describe(&given).ok()?;
        let sd = summary.sd.map_or_else(|| "–".to_owned(), |sd| apa::number(sd, 1));
        Some(format!("{}\u{a0}({sd})", apa::number(summary.mean, 1)))
    };
    let scales = questionnaire.items.iter().filter(|item| matches!(item.answer, AnswerKind::Scale(_)));
    let row = |item: &crate::design::Item| {
        let text = item.text.read("en", language).replace("**", "");
        let text = if item.reversed { format!("{text} (reversed)") } else { text };
        let cells =
            places.iter().map(|place| Text::from(cell(&item.id, place).unwrap_or_else(|| "–".to_owned())));
        std::iter::once(Text::from(text)).chain(cells).collect()
    };
    Table {
        caption: Text::from("Answers: mean (standard deviation) over those who answered."),
        columns: std::iter::once((Text::from("Item"), Align::Left))
            .chain(places.iter().map(|place| (Text::from(name(place)), Align::Right)))
            .collect(),
        rows: scales.map(row).collect(),
        notes: vec![Text::from("As answered: reversed items are not turned round here, only in the scores.")],
    }
}
