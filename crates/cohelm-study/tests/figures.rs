//! Figures: the same bytes everywhere, hostile names and odd amounts of data, well-formed SVG.

use cohelm_study::figures::{
    Axis, BoxPlot, ByParticipant, Conditions, Curve, CurvePanel, Curves, Figure, FigureError, Heading,
    PairedSlopes, Panel,
};
use proptest::prelude::*;

fn heading() -> Heading {
    Heading::new("Success", "Share of 40 episodes")
}

fn names(prefix: &str, count: usize) -> Vec<String> {
    (1..=count).map(|i| format!("{prefix}{i}")).collect()
}

fn by_participant(participants: usize, conditions: usize) -> ByParticipant {
    let value = |c: usize, p: usize| Some(((7 * c + 13 * p) % 41) as f64 / 40.0);
    let names_of_conditions = names("C", conditions);
    ByParticipant {
        heading: heading(),
        participants: names("P", participants),
        conditions: Conditions::in_order(names_of_conditions.iter().map(String::as_str)),
        panels: vec![Panel {
            axis: Axis::share("Success (share of episodes)"),
            values: (0..conditions).map(|c| (0..participants).map(|p| value(c, p)).collect()).collect(),
        }],
    }
}

/// FNV-1a, enough to notice a changed byte.
fn fingerprint(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A change of style changes these numbers, and then they are to be taken from the failing test; a change of machine,
/// compiler or optimisation must not.
#[test]
fn bytes_are_the_same_on_every_machine() {
    let figure = by_participant(10, 3).figure().unwrap();
    let prints = [
        fingerprint(figure.svg().as_bytes()),
        fingerprint(&figure.png(2.0)),
        fingerprint(figure.csv().to_string().as_bytes()),
    ];
    assert_eq!(prints, [0xc987_d40a_8423_9d28, 0xf4ea_589f_22b2_7ac2, 0x3fa4_87b9_77ac_2bc7], "{prints:#x?}");
}

/// Every tag closed, every attribute quoted, no stray `<` or `&`: a small parser of what the writer may write.
fn assert_well_formed(svg: &str) {
    let mut open = Vec::new();
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let text = &rest[..start];
        assert!(text.split('&').skip(1).all(|entity| entity.find(';').is_some_and(|end| end <= 5)), "{text}");
        let end = start + rest[start..].find('>').expect("an open tag");
        let tag = &rest[start + 1..end];
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        match tag.strip_prefix('/') {
            Some(name) => assert_eq!(open.pop(), Some(name)),
            None if tag.ends_with('/') => {}
            None => open.push(tag.split(' ').next().unwrap()),
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty(), "{open:?}");
}

fn assert_drawn(figure: &Figure) {
    assert_well_formed(&figure.svg());
    let png = figure.png(0.5);
    assert_eq!(&png[1..4], b"PNG");
    assert!(!figure.csv().rows().is_empty() && !figure.description().contains("NaN"));
}

#[test]
fn few_and_many_participants_and_conditions() {
    for (participants, conditions) in [(1, 1), (2, 4), (10, 8), (60, 3), (60, 12)] {
        assert_drawn(&by_participant(participants, conditions).figure().unwrap());
    }
}

#[test]
fn a_scale_out_of_bounds_is_brought_back() {
    let figure = by_participant(2, 2).figure().unwrap();
    for scale in [f64::NAN, -1.0, 0.0, 1e9] {
        let png = figure.png(if scale == 1e9 { 3.0 } else { scale });
        assert_eq!(&png[1..4], b"PNG");
    }
}

#[test]
fn lists_that_do_not_fit_are_refused() {
    let mut figure = by_participant(3, 2);
    figure.panels[0].values[1].pop();
    let error = figure.figure().unwrap_err();
    assert_eq!(error.to_string(), "the figure has 2 participants, but 3 were expected");
    assert_eq!(by_participant(0, 2).figure().unwrap_err(), FigureError::Nothing { of: "participants" });
    let mut figure = by_participant(1, 1);
    figure.panels[0].values = vec![vec![None]];
    assert!(figure.figure().unwrap_err().to_string().contains("has no value to show"));
}

#[test]
fn missing_values_are_missing_in_the_data_too() {
    let mut figure = by_participant(2, 1);
    figure.panels[0].values[0][1] = None;
    let csv = figure.figure().unwrap().csv().to_string();
    assert!(csv.ends_with("Success (share of episodes),C1,P2,\n"), "{csv}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn any_names_and_values_are_drawn_or_refused(
        names in prop::collection::vec(any::<String>(), 1..4),
        title in any::<String>(),
        values in prop::collection::vec((any::<f64>(), -1e3..1e3_f64), 3),
    ) {
        let conditions = Conditions::in_order(names.iter().map(String::as_str));
        let participants: Vec<String> = names.iter().chain([&title]).take(3).cloned().collect();
        let first: Vec<Option<f64>> = values.iter().take(participants.len()).map(|v| Some(v.0)).collect();
        let second: Vec<Option<f64>> = values.iter().take(participants.len()).map(|v| Some(v.1)).collect();
        for column in [first, second] {
            let figure = BoxPlot {
                heading: Heading::new(title.clone(), title.clone()),
                axis: Axis::free(title.clone()),
                participants: participants.clone(),
                conditions: conditions.clone(),
                values: vec![column; conditions.len()],
            };
            if let Ok(figure) = figure.figure() {
                assert_drawn(&figure);
            }
        }
    }

    #[test]
    fn slopes_and_curves_of_any_finite_numbers(pairs in prop::collection::vec((-1e9..1e9_f64, -1e-9..1e-9_f64), 1..9)) {
        let two = Conditions::in_order(["LASC", "MISC"]);
        let slopes = PairedSlopes {
            heading: heading(),
            axis: Axis::share("Success").zoomed(),
            participants: names("P", pairs.len()),
            conditions: two.clone(),
            pairs: pairs.clone(),
            bound: Some(0.05),
        };
        assert_drawn(&slopes.figure().unwrap());
        let curves = Curves {
            heading: heading(),
            x: Axis::amount("Episode"),
            y: Axis::free("Steps"),
            conditions: two,
            panels: vec![CurvePanel { title: "P1".into(), curves: vec![Curve { condition: 1, band: pairs.clone(), points: pairs }] }],
        };
        assert_drawn(&curves.figure().unwrap());
    }
}
