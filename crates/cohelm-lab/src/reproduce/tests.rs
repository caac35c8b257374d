//! Invented tables flip every verdict: none of them is fixed.

use super::claims::{Trained, claims};
use super::{conditions, name};
use crate::episode::Tally;
use crate::experiment::{Condition, Flown};
use crate::results::Results;
use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::intent::Inference;
use cohelm::plant::Ending;
use cohelm::registry::Task;
use cohelm::trajectory::{Digests, Setup, Trajectory};
use cohelm_copilot::Card;
use cohelm_study::verdict::Verdict;
use serde_json::json;

const PARTICIPANTS: usize = 10;
const EPISODES: usize = 40;

/// What is invented of one condition: shares of endings, steps and the share of replaced commands.
#[derive(Clone, Copy)]
struct Invented {
    success: f64,
    crash: f64,
    steps: f64,
    commands: f64,
    replaced: f64,
}

const USUAL: Invented = Invented { success: 0.8, crash: 0.1, steps: 250.0, commands: 140.0, replaced: 0.5 };

fn setup(condition: &Condition) -> Setup {
    Setup {
        task: Task::new("invented"),
        plant_version: 1,
        seed: 0,
        rule: Rule::Hic,
        inference: Inference::Nearest,
        silence: Silence::Best,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: condition.name.clone(),
    }
}

/// Participants differ a little from each other, the same way in every condition and a hair differently in each.
fn episodes(conditions: &[Condition], invent: &dyn Fn(&str) -> Invented) -> Vec<Flown> {
    let mut flown = Vec::new();
    for participant in 0..PARTICIPANTS {
        for (condition, named) in conditions.iter().enumerate() {
            let of = invent(&named.name);
            let own =
                (participant as f64 - 4.5) / 100.0 + 0.001 * ((participant * 7 + condition * 3) % 5) as f64;
            for episode in 0..EPISODES {
                let share = (episode as f64 + 0.5) / EPISODES as f64;
                let ending = if share < of.success + own {
                    Ending::Goal
                } else if share < of.success + own + of.crash {
                    Ending::Crash
                } else {
                    Ending::OutOfBounds
                };
                let mut measures = Tally::default().finish(0, 50.0);
                measures.ending = ending;
                measures.steps = (of.steps * (1.0 + own)) as u32;
                measures.ticks_with_command = (of.commands * (1.0 + own)) as u32;
                measures.nominal_interventions = Some((of.replaced + own).clamp(0.0, 1.0));
                let trajectory = Trajectory {
                    setup: setup(named),
                    asked: vec![],
                    executed: vec![],
                    keys: vec![],
                    ending,
                    digests: Digests::default(),
                    tape: None,
                };
                flown.push(Flown { participant, condition, episode, measures, trajectory });
            }
        }
    }
    flown
}

fn card(options: serde_json::Value) -> Card {
    serde_json::from_value(json!({
        "name": "invented", "kind": "values", "task": { "plant": "invented" }, "plant_version": 1,
        "space": { "kind": "single", "names": ["nothing"], "pushes": [null] }, "state": 1, "goals": 1,
        "encoder_version": 1, "seed": 0, "options": options,
        "trained_with": { "cohelm": "0", "kernel": "none" }, "scores": {},
    }))
    .unwrap()
}

/// The verdict on the claim of that number under invented data.
fn verdict(claim: usize, pilots: u64, teacher: f64, invent: &dyn Fn(&str) -> Invented) -> Verdict {
    let conditions = conditions();
    let flown = episodes(&conditions, invent);
    let results = Results { conditions: &conditions, participants: PARTICIPANTS, flown: &flown };
    let values = card(json!({ "pilots": 0.0, "teacher": teacher }));
    let intent = card(json!({ "training": { "pilots": pilots } }));
    let trained = Trained { values: &values, intent: &intent };
    claims(&results, trained)[claim].judgement.verdict.clone()
}

fn is_misc(condition: &str) -> bool {
    [name::MISC, name::MISC_PEAKED].contains(&condition)
}

fn changed(condition: &'static str, change: fn(&mut Invented)) -> impl Fn(&str) -> Invented {
    move |name: &str| {
        let mut of = USUAL;
        if name == condition || (condition == "misc*" && is_misc(name)) {
            change(&mut of);
        }
        of
    }
}

fn says(claim: usize, invent: &dyn Fn(&str) -> Invented) -> Verdict {
    verdict(claim, 30, 0.0, invent)
}

#[test]
fn crashing_alone_flips() {
    let alone = |crash: fn(&mut Invented)| says(0, &changed(name::HIC, crash));
    assert_eq!(alone(|of| (of.success, of.crash) = (0.0, 0.95)), Verdict::Reproduces);
    assert_eq!(alone(|of| (of.success, of.crash) = (0.5, 0.3)), Verdict::DoesNot);
}

#[test]
fn being_helped_flips() {
    assert_eq!(says(1, &changed(name::HIC, |of| of.success = 0.1)), Verdict::Reproduces);
    assert_eq!(says(1, &changed(name::HIC, |of| of.success = 0.95)), Verdict::DoesNot);
}

#[test]
fn sameness_of_success_flips_and_hangs_on_the_confidence() {
    assert_eq!(says(2, &|_| USUAL), Verdict::Reproduces);
    assert_eq!(says(2, &changed("misc*", |of| of.success = 0.5)), Verdict::DoesNot);
    assert!(matches!(says(2, &changed(name::MISC, |of| of.success = 0.5)), Verdict::OnlyIf(_)));
}

#[test]
fn steps_inputs_and_interference_flip() {
    let fewer: [fn(&mut Invented); 3] =
        [|of| of.steps = 200.0, |of| of.commands = 100.0, |of| of.replaced = 0.2];
    let more: [fn(&mut Invented); 3] =
        [|of| of.steps = 300.0, |of| of.commands = 180.0, |of| of.replaced = 0.8];
    for (claim, (fewer, more)) in (3..).zip(fewer.into_iter().zip(more)) {
        assert_eq!(says(claim, &changed("misc*", fewer)), Verdict::Reproduces, "claim {claim}");
        assert_eq!(says(claim, &changed("misc*", more)), Verdict::DoesNot, "claim {claim}");
    }
}

#[test]
fn being_better_than_a_constant_tolerance_flips() {
    assert_eq!(says(6, &changed(name::TOLERANCE, |of| of.success = 0.6)), Verdict::Reproduces);
    assert_eq!(says(6, &changed(name::TOLERANCE, |of| of.success = 0.9)), Verdict::DoesNot);
}

#[test]
fn needing_no_model_hangs_on_what_the_cards_record() {
    let says = |pilots, teacher| verdict(7, pilots, teacher, &|_| USUAL);
    assert_eq!(says(0, 0.0), Verdict::Reproduces);
    assert!(matches!(says(30, 0.0), Verdict::OnlyIf(_)));
    assert_eq!(says(30, 0.25), Verdict::DoesNot);
}

#[test]
fn what_people_felt_is_never_judged_by_simulation() {
    assert!(matches!(says(8, &|_| USUAL), Verdict::CannotBeJudged(_)));
}
