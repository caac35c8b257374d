//! What happens within the flights and over the session: authority, calibration, learning, order.

use super::{Study, push_figure, words};
use crate::analysis::{Learning, Quantity, Ribbon, Stretch, calibrations, ribbons};
use crate::apa;
use crate::dataset::Part;
use crate::figures::{
    Axis, Bin, Curve, CurvePanel, Curves, Extent, Figure, FigureError, Heading, Reliability,
};
use crate::report::{Align, Block, Document, Table};
use crate::statistics::describe;
use crate::text::{Text, capitalised};

pub(super) fn write(study: &Study<'_>, document: &mut Document) {
    document.push(Block::heading("Authority over the flight"));
    let caption = "Left: of the pilot’s commands, those that took effect as asked. Middle: ticks at which the goal was inferred \
                   rightly. Right: ticks with a command. Over the flight, from start to ending; band: 95\u{202f}% interval of the \
                   mean over participants.";
    push_figure(document, authority(study), caption, "authority");
    document.push(Block::heading("Calibration of the confidence"));
    let calibrations = calibrations(study.data);
    let caption = "How often the inferred goal was right, where the co-pilot’s confidence was that high.";
    push_figure(document, reliability(study), caption, "calibration");
    let errors: Vec<String> = calibrations
        .iter()
        .filter_map(|c| Some(format!("{} {}", study.name(c.condition), apa::fraction(c.error?, 3))))
        .collect();
    if !errors.is_empty() {
        document.push(Block::paragraph(format!(
            "Expected calibration error over all ticks: {}. The confidence is read as a probability here. That of Eq. 1 of the \
             paper is none: over three goals with inverse distances it cannot be calibrated, and is shown to say how far it may be \
             taken for one.",
            words::listed(&errors)
        )));
    }
    learning(study, document);
    order(study, document);
}

fn authority(study: &Study<'_>) -> Result<Figure, FigureError> {
    let panel = |title: &str, share: fn(&Part) -> (u32, u32)| CurvePanel {
        title: title.to_owned(),
        curves: ribbons(study.data, share)
            .iter()
            .filter(|ribbon| !ribbon.points.is_empty())
            .map(curve)
            .collect(),
    };
    let curves = Curves {
        heading: Heading::new(
            "Who steers, from start to ending",
            format!(
                "{}, measured flights. Line: mean over participants; band: its 95 % interval.",
                study.people()
            ),
        ),
        x: Axis { extent: Extent::FromZero, ..Axis::amount("Percent of the flight that are over") },
        y: Axis::share("Share"),
        conditions: study.looks.clone(),
        panels: vec![
            panel("Commands carried out as asked", |part| (part.as_asked, part.commands)),
            panel("Goal inferred rightly", |part| (part.goal_right, part.ticks)),
            panel("Ticks with a command", |part| (part.commands, part.ticks)),
        ],
    };
    curves.figure()
}

fn curve(ribbon: &Ribbon) -> Curve {
    let ends = |summary: &crate::statistics::Summary| {
        summary.mean_ci95.map_or((summary.mean, summary.mean), |ci| (ci.low.max(0.0), ci.high.min(1.0)))
    };
    Curve {
        condition: ribbon.condition,
        points: ribbon.points.iter().map(|(x, summary)| (100.0 * x, summary.mean)).collect(),
        band: ribbon.points.iter().map(|(_, summary)| ends(summary)).collect(),
    }
}

fn reliability(study: &Study<'_>) -> Result<Figure, FigureError> {
    let calibrations = calibrations(study.data);
    let conditions: Vec<usize> = calibrations.iter().map(|c| c.condition).collect();
    let bins = |classes: &[crate::dataset::Class]| -> Vec<Bin> {
        let all: u32 = classes.iter().map(|class| class.ticks).sum();
        let some = classes.iter().filter(|class| class.ticks > 0);
        some.map(|class| Bin {
            confidence: class.confidence / f64::from(class.ticks),
            right: f64::from(class.goal_right) / f64::from(class.ticks),
            share: f64::from(class.ticks) / f64::from(all),
        })
        .collect()
    };
    let figure = Reliability {
        heading: Heading::new(
            "Can the confidence be trusted?",
            format!(
                "All ticks of {}. On the dashed line c is the share of right goals; small marks: few ticks.",
                study.people()
            ),
        ),
        conditions: study.looks_of(&conditions),
        classes: calibrations.iter().map(|c| bins(&c.classes)).collect(),
    };
    figure.figure()
}

fn learning(study: &Study<'_>, document: &mut Document) {
    let Some(quantity) = study.analysis.learning.first().and_then(|l| Quantity::of_flights(&l.key)) else {
        return;
    };
    document.push(Block::heading("Learning and order"));
    let measure = quantity.measure();
    let curves = Curves {
        heading: Heading::new(
            format!("{} over the flights", measure.title()),
            format!("{}. Practice counts up to 0. Line: mean; band: its 95 % interval.", study.people()),
        ),
        x: Axis::free("Flight within the mode (practice up to 0, measured from 1)"),
        y: quantity.axis(),
        conditions: study.looks.clone(),
        panels: study
            .analysis
            .learning
            .iter()
            .filter(|l| !l.course.is_empty())
            .map(|l| course(study, l))
            .collect(),
    };
    let caption =
        format!("{} from the first flight of a mode to its last, practice included.", measure.title());
    push_figure(document, curves.figure(), caption, "learning");
    document.push(Block::Table(slopes(study, &quantity)));
}

/// Practice and measured flights are two lines, so that one sees where what counts begins.
fn course(study: &Study<'_>, learning: &Learning) -> CurvePanel {
    let share = Quantity::of_flights(&learning.key).is_some_and(|q| q.unit == crate::measures::Unit::Share);
    let clipped = |end: f64| if share { end.clamp(0.0, 1.0) } else { end };
    let ends = |stretch: &Stretch| {
        stretch.interval.map_or((stretch.mean, stretch.mean), |ci| (clipped(ci.low), clipped(ci.high)))
    };
    let (practice, measured): (Vec<Stretch>, Vec<Stretch>) =
        learning.course.iter().partition(|stretch| stretch.flight < 0.75);
    let curve = |stretches: &Vec<Stretch>| Curve {
        condition: learning.condition,
        points: stretches.iter().map(|stretch| (stretch.flight, stretch.mean)).collect(),
        band: stretches.iter().map(ends).collect(),
    };
    let lines = [practice, measured];
    let curves = lines.iter().filter(|stretches| !stretches.is_empty()).map(curve).collect();
    CurvePanel { title: study.name(learning.condition).to_owned(), curves }
}

fn slopes(study: &Study<'_>, quantity: &Quantity) -> Table {
    let measure = quantity.measure();
    let row = |learning: &Learning| {
        let name = Text::from(study.name(learning.condition));
        match &learning.slope {
            Ok(t) => vec![
                name,
                Text::from(measure.write_difference(t.mean_difference)),
                Text::from(format!(
                    "[{}, {}]",
                    measure.difference(t.ci95.low),
                    measure.difference(t.ci95.high)
                )),
                apa::paired_t(t),
                learning.p_holm.map_or_else(|| Text::from("–"), apa::p_value),
            ],
            Err(why) => vec![name, Text::from("–"), Text::from("–"), apa::undefined(why), Text::from("–")],
        }
    };
    let heads = ["Mode", "Change in ten flights", "95\u{202f}% interval", "Against zero", "Adjusted (Holm)"];
    let align = |i: usize| if (1..3).contains(&i) { Align::Right } else { Align::Left };
    Table {
        caption: Text::from(format!("{}: change within the measured flights of a mode.", measure.title())),
        columns: heads.into_iter().enumerate().map(|(i, head)| (Text::from(head), align(i))).collect(),
        rows: study.analysis.learning.iter().map(row).collect(),
        notes: vec![Text::from(
            "Each participant’s least-squares slope over the flights, tested against zero.",
        )],
    }
}

fn order(study: &Study<'_>, document: &mut Document) {
    let effect = &study.analysis.order;
    let Some(quantity) = Quantity::of_flights(&effect.key) else { return };
    if !effect.separable {
        document.push(Block::paragraph(
            "Everyone who is analysed flew the modes in one order, so that an effect of order cannot be told from one of mode.",
        ));
        return;
    }
    let measure = quantity.measure();
    let means: Vec<String> = effect
        .table
        .conditions()
        .iter()
        .zip(effect.table.columns())
        .filter_map(|(position, column)| {
            Some(format!("{position} {}", measure.write(describe(&column).ok()?.mean)))
        })
        .collect();
    let name = words::name_of(&quantity);
    let tested = match &effect.anova {
        Ok(test) => {
            let p = test.sphericity.as_ref().map_or(test.p, |s| s.p_corrected);
            let verb =
                if p < study.data.design.primary.alpha { "changed" } else { "did not change significantly" };
            Text::from(format!("Over the blocks, whatever was flown in them, {name} {verb}, "))
                .then(apa::repeated_measures(test))
        }
        Err(why) => Text::from(format!("{} over the blocks cannot be tested: {why}", capitalised(&name))),
    };
    document.push(Block::paragraph(
        tested.plain(format!(". Means by place in the order flown: {}.", words::listed(&means))),
    ));
}
