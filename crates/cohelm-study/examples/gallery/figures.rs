//! One of every kind of figure.

use crate::Outcome;
use crate::invented::{participants, rates, values, wobble};
use cohelm_study::figures::{
    Axis, Better, BoxPlot, ByParticipant, Colour, Conditions, Curve, CurvePanel, Curves, Figure, Heading,
    PairedSlopes, Panel, ParetoPoint, ParetoScatter,
};
use cohelm_study::statistics::Interval;

pub fn figures() -> Outcome<Vec<(&'static str, Figure)>> {
    Ok(vec![
        ("fig2a", success_and_crash(&three())?),
        ("fig2a_eight_modes", success_and_crash(&eight())?),
        ("fig2b", steps(&three())?),
        ("box", box_plot()?),
        ("slopes", slopes()?),
        ("slopes_steps", slopes_steps()?),
        ("curves", curves(10)?),
        ("curves_three", curves(3)?),
        ("pareto", pareto()?),
    ])
}

pub fn three() -> Conditions {
    Conditions::in_order(["HIC", "LASC", "MISC"])
}

pub fn eight() -> Conditions {
    Conditions::with_colours([
        ("HIC", Colour::GREY),
        ("LASC", Colour::ORANGE),
        ("LASC, peaked", Colour::VERMILLION),
        ("MISC", Colour::SKY),
        ("MISC, peaked", Colour::BLUE),
        ("constant 0.6", Colour::PURPLE),
        ("MISC-R", Colour::GREEN),
        ("robot alone", Colour::INK),
    ])
}

pub fn success_and_crash(conditions: &Conditions) -> Outcome<Figure> {
    let success = [0.0, 0.64, 0.85, 0.86, 0.87, 0.84, 0.95, 0.97];
    let crash = [0.92, 0.29, 0.04, 0.08, 0.05, 0.06, 0.01, 0.03];
    let pick: Vec<usize> = if conditions.len() == 3 { vec![0, 1, 4] } else { (0..8).collect() };
    let of = |means: &[f64]| -> Vec<f64> { pick.iter().map(|&i| means[i]).collect() };
    let mut success = rates(&of(&success), 0.06);
    success[0].fill(Some(0.0));
    Ok(ByParticipant {
        heading: Heading::new(
            "Success and crash rates of ten simulated participants",
            "Share of 40 episodes for each participant and mode. Right: mean over participants with its 95 % interval.",
        ),
        participants: participants(),
        conditions: conditions.clone(),
        panels: vec![
            Panel { axis: Axis::share("Landed at the goal (share of episodes)"), values: success },
            Panel { axis: Axis::share("Crashed (share of episodes)"), values: rates(&of(&crash), 0.05) },
        ],
    }
    .figure()?)
}

pub fn steps(conditions: &Conditions) -> Outcome<Figure> {
    Ok(ByParticipant {
        heading: Heading::new(
            "Steps per episode",
            "Mean over 40 episodes for each participant and mode; 50 steps are one second.",
        ),
        participants: participants(),
        conditions: conditions.clone(),
        panels: vec![Panel {
            axis: Axis::amount("Steps per episode"),
            values: values(&[97.0, 238.0, 245.0], 22.0),
        }],
    }
    .figure()?)
}

pub fn box_plot() -> Outcome<Figure> {
    Ok(BoxPlot {
        heading: Heading::new(
            "Commands that the co-pilot replaced",
            "Share of ticks with a command in which the executed one had another effect. A point is a participant, the \
             line the median, the diamond the mean; whiskers end at data.",
        ),
        axis: Axis::share("Interventions (share of ticks with a command)"),
        participants: participants(),
        conditions: eight(),
        values: rates(&[0.0, 0.53, 0.82, 0.49, 0.58, 0.5, 0.36, 0.83], 0.06),
    }
    .figure()?)
}

pub fn slopes() -> Outcome<Figure> {
    let a = rates(&[0.85, 0.86], 0.05);
    let pairs = (0..10).filter_map(|i| Some((a[0][i]?, a[1][i]?))).collect();
    Ok(PairedSlopes {
        heading: Heading::new(
            "Equal success: the difference lies within ±5 percentage points",
            "A line is a participant. Right: differences, their mean and its 95 % interval.",
        ),
        axis: Axis::share("Landed at the goal (share of episodes)").zoomed(),
        participants: participants(),
        conditions: three().only(&["LASC", "MISC"]),
        pairs,
        bound: Some(0.05),
    }
    .figure()?)
}

fn slopes_steps() -> Outcome<Figure> {
    let a = values(&[238.0, 250.0], 22.0);
    let pairs = (0..10).filter_map(|i| Some((a[0][i]?, a[1][i]?))).collect();
    Ok(PairedSlopes {
        heading: Heading::new("Steps per episode", "A line is a participant."),
        axis: Axis::amount("Steps per episode"),
        participants: participants(),
        conditions: three().only(&["LASC", "MISC"]),
        pairs,
        bound: None,
    }
    .figure()?)
}

fn curves(panels: usize) -> Outcome<Figure> {
    let curve = |condition: usize, p: usize| {
        let y = |x: usize| {
            (0.3 + 0.2 * condition as f64 + 0.04 * x as f64 + 0.05 * wobble(x + 7 * p)).clamp(0.0, 1.0)
        };
        Curve {
            condition,
            points: (1..=8).map(|x| (x as f64 * 5.0, y(x))).collect(),
            band: (1..=8).map(|x| ((y(x) - 0.08).max(0.0), (y(x) + 0.08).min(1.0))).collect(),
        }
    };
    Ok(Curves {
        heading: Heading::new(
            "Learning over forty episodes",
            "Success in blocks of five episodes; band: 95 % interval.",
        ),
        x: Axis::amount("Episode"),
        y: Axis::share("Landed at the goal"),
        conditions: three(),
        panels: (0..panels)
            .map(|p| CurvePanel {
                title: format!("P{}", p + 1),
                curves: (0..3).map(|c| curve(c, p)).collect(),
            })
            .collect(),
    }
    .figure()?)
}

pub fn pareto() -> Outcome<Figure> {
    let conditions = eight();
    let at = [
        (0.0, 0.0),
        (0.53, 0.64),
        (0.82, 0.85),
        (0.49, 0.86),
        (0.58, 0.86),
        (0.5, 0.84),
        (0.36, 0.95),
        (0.83, 0.97),
    ];
    let interval =
        |v: f64| Some(Interval { low: (v - 0.03).max(0.0), high: (v + 0.03).min(1.0), level: 0.95 });
    Ok(ParetoScatter {
        heading: Heading::new(
            "Success against interventions",
            "Means over ten participants with 95 % intervals; the dashed line joins what nothing beats on both.",
        ),
        x: (Axis::share("Interventions (share of ticks with a command)"), Better::Lower),
        y: (Axis::share("Landed at the goal (share of episodes)"), Better::Higher),
        points: conditions
            .as_slice()
            .iter()
            .zip(at)
            .enumerate()
            .map(|(i, (condition, at))| ParetoPoint {
                label: condition.name.clone(),
                condition: i,
                at,
                intervals: (interval(at.0), interval(at.1)),
            })
            .collect(),
        conditions,
        behind: None,
    }
    .figure()?)
}
