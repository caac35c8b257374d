//! Invented numbers in the shape of a study's data.

use cohelm::plant::Ending;
use cohelm_study::dataset::{Answer, Class, Dataset, Measured, Part, Person, Progress, Score, Trial};
use cohelm_study::design::{Design, schedule::cells};
use cohelm_study::measures::{CLASSES, PARTS};
use cohelm_study::questionnaires;
use std::collections::BTreeMap;

/// Twenty-six invented participants, some of whom were lost.
pub fn dataset() -> Result<Dataset, Box<dyn std::error::Error>> {
    let design = Design::from_toml(include_str!("invented.toml"))?;
    let mut dataset = Dataset {
        program: "invented".into(),
        participants: Vec::new(),
        trials: Vec::new(),
        answers: Vec::new(),
        scores: Vec::new(),
        design,
    };
    let mut draw = Draw(7);
    let fates = [
        (24, Progress::Completed, None),
        (1, Progress::Completed, Some("late-ticks-over: 0.310, allowed 0.200")),
        (2, Progress::UnderWay, None),
        (1, Progress::Withdrawn, None),
        (1, Progress::Declined, None),
    ];
    for (count, progress, excluded) in fates {
        for _ in 0..count {
            add_person(&mut dataset, &mut draw, progress, excluded);
        }
    }
    Ok(dataset)
}

/// Marks everyone as simulated and takes the answers away.
pub fn simulate(dataset: &mut Dataset) {
    dataset.participants.iter_mut().for_each(|person| person.simulated = true);
    dataset.answers.iter_mut().for_each(|answer| answer.value = serde_json::Value::Null);
    dataset.scores.iter_mut().for_each(|score| score.score = None);
}

/// Leaves so many participants.
pub fn leave(dataset: &mut Dataset, count: usize) {
    dataset.participants.truncate(count);
    dataset.trials.retain(|trial| trial.participant < count);
    dataset.answers.retain(|answer| answer.participant < count);
    dataset.scores.retain(|score| score.participant < count);
}

/// A small generator: nothing here needs a good one.
struct Draw(u64);

impl Draw {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// About normal, mean 0, spread 1.
    fn about(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

fn add_person(dataset: &mut Dataset, draw: &mut Draw, progress: Progress, excluded: Option<&str>) {
    let participant = dataset.participants.len();
    let cells = cells(&dataset.design);
    let cell = participant % cells.len();
    let began = !matches!(progress, Progress::Declined | Progress::Withdrawn);
    dataset.participants.push(Person {
        code: format!("P{:02}", participant + 1),
        progress,
        test: false,
        simulated: false,
        excluded: excluded.map(str::to_owned),
        language: Some("en".into()),
        cell: began.then_some(cell),
        order: if began { cells[cell].clone() } else { Vec::new() },
        minutes: began.then(|| 41.0 + 5.0 * draw.about()),
        interruptions: u32::from(participant % 9 == 4),
    });
    if !began {
        return;
    }
    let skill = draw.about();
    tell_of_themselves(dataset, draw, participant);
    for (block, &condition) in cells[cell].iter().enumerate() {
        fly(dataset, draw, (participant, block + 1, condition), skill);
        if progress == Progress::Completed {
            let asked = dataset.design.conditions[condition].questionnaires.clone();
            answer(dataset, draw, participant, (Some(condition), asked));
        }
    }
    if progress == Progress::Completed {
        let asked = dataset.design.end_questionnaires.clone();
        answer(dataset, draw, participant, (None, asked));
    }
}

fn fly(
    dataset: &mut Dataset,
    draw: &mut Draw,
    (participant, block, condition): (usize, usize, usize),
    skill: f64,
) {
    let plan = &dataset.design.conditions[condition];
    let flights = (1..=plan.practice_episodes).map(|n| (true, n));
    let flights: Vec<(bool, u32)> = flights.chain((1..=plan.measured_episodes).map(|n| (false, n))).collect();
    for (i, (practice, number)) in flights.into_iter().enumerate() {
        let learnt = 1.0 - libm::exp(-(i as f64) / 9.0);
        dataset.trials.push(Trial {
            participant,
            block,
            condition,
            practice,
            number,
            attempt: 1,
            episode: dataset.trials.len() as i64 + 1,
            seed: Some(1000 + i as u64),
            counts: true,
            interruptions: u32::from(participant % 9 == 4 && i == 12 && block == 2),
            telemetry: BTreeMap::from([("late_ticks".to_owned(), (3.0 * draw.unit()).floor())]),
            measured: Ok(flight(draw, condition, skill, learnt)),
        });
    }
}

/// Chance of success, share of replaced commands and mean confidence of a condition.
const SHAPES: [(f64, f64, f64); 3] = [(0.06, 0.0, 0.5), (0.76, 0.72, 0.7), (0.86, 0.5, 0.7)];

fn flight(draw: &mut Draw, condition: usize, skill: f64, learnt: f64) -> Measured {
    let (success, replaced, sure) = SHAPES[condition];
    let success = (success + 0.05 * skill - 0.25 * (1.0 - learnt) * success).clamp(0.0, 0.98);
    let ending = match draw.unit() {
        u if u < success => Ending::Goal,
        u if u < success + (1.0 - success) * 0.7 => Ending::Crash,
        u if u < success + (1.0 - success) * 0.85 => Ending::Elsewhere,
        _ => Ending::OutOfBounds,
    };
    let ticks = (235.0 + 25.0 * draw.about() - 8.0 * skill).max(60.0).floor();
    let commands = (ticks * (0.55 + 0.05 * draw.about())).clamp(1.0, ticks).floor();
    let replaced = if replaced > 0.0 { (replaced + 0.06 * draw.about()).clamp(0.0, 1.0) } else { 0.0 };
    let is = |wanted: Ending| f64::from(u8::from(ending == wanted));
    let right = (0.8 + 0.05 * draw.about()).clamp(0.0, 1.0);
    let mut values = BTreeMap::from([
        ("success", is(Ending::Goal)),
        ("crash", is(Ending::Crash)),
        ("elsewhere", is(Ending::Elsewhere)),
        ("out_of_bounds", is(Ending::OutOfBounds)),
        ("time_limit", 0.0),
        ("steps", ticks),
        ("seconds", ticks / 50.0),
        ("reward", draw.about()),
        ("ticks_with_command", commands),
        ("key_presses", (commands / 9.0).floor()),
        ("commands_per_second", commands / ticks * 50.0),
        ("interventions", replaced),
        ("authority", 1.0 - replaced),
        ("nominal_interventions", (replaced * 1.1).min(1.0)),
        ("opposed", replaced * 0.22),
        ("reversals", (8.0 * replaced * draw.unit()).floor()),
        ("repeats", (14.0 * replaced * draw.unit()).floor()),
        ("goal_accuracy", right),
        ("goal_right_midway", f64::from(u8::from(draw.unit() < 0.85))),
        ("goal_right_at_end", f64::from(u8::from(draw.unit() < 0.93))),
        ("mean_confidence", sure),
        ("switches", (60.0 + 20.0 * draw.unit()).floor()),
        ("wrong_interventions", replaced * (1.0 - right)),
        ("uncorrected", 0.0),
        ("brier", (0.16 + 0.02 * draw.about()).clamp(0.0, 1.0)),
        ("confidence_when_wrong", 0.5),
    ]);
    if ending == Ending::Goal {
        values.insert("steps_of_successes", ticks);
    }
    if replaced > 0.0 && draw.unit() < 0.8 {
        values.insert("time_to_correct", 0.2 + 0.4 * draw.unit());
    }
    Measured { ending, values, parts: parts(draw, ticks, replaced), classes: classes(draw, ticks) }
}

fn parts(draw: &mut Draw, ticks: f64, replaced: f64) -> Vec<Part> {
    let part = |i: usize| {
        let over = (i as f64 + 0.5) / PARTS as f64;
        let ticks = (ticks / PARTS as f64).round().max(1.0);
        let commands = (ticks * (0.35 + 0.4 * over)).round().min(ticks);
        let kept = 1.0 - replaced * (0.5 + 0.9 * over) + 0.1 * draw.about();
        let right = 0.45 + 0.5 * libm::sqrt(over) + 0.12 * draw.about();
        Part {
            ticks: ticks as u32,
            commands: commands as u32,
            as_asked: if replaced == 0.0 {
                commands as u32
            } else {
                (commands * kept.clamp(0.0, 1.0)).round() as u32
            },
            goal_right: (ticks * right.clamp(0.0, 1.0)).round() as u32,
            confidence: ticks * 0.7,
        }
    };
    (0..PARTS).map(part).collect()
}

fn classes(draw: &mut Draw, ticks: f64) -> Vec<Class> {
    let class = |i: usize| {
        let confidence = (i as f64 + 0.5) / CLASSES as f64;
        let here = (ticks * 0.2 * confidence * (0.5 + draw.unit())).round();
        let right = (0.25 + 0.72 * confidence + 0.05 * draw.about()).clamp(0.0, 1.0);
        Class { ticks: here as u32, goal_right: (here * right).round() as u32, confidence: here * confidence }
    };
    (0..CLASSES).map(class).collect()
}

fn tell_of_themselves(dataset: &mut Dataset, draw: &mut Draw, participant: usize) {
    let games = ["never", "sometimes", "often"][(3.0 * draw.unit()) as usize];
    let age = (27.0 + 6.0 * draw.about().abs()).round();
    for (item, value) in [("age", age.into()), ("games", games.into())] {
        let (step, item) = ("demographics".to_owned(), item.to_owned());
        dataset.answers.push(Answer { participant, step, condition: None, item, value });
    }
}

/// Numbers where answers would be, so that the tables of questionnaires can be looked at.
fn answer(
    dataset: &mut Dataset,
    draw: &mut Draw,
    participant: usize,
    (condition, asked): (Option<usize>, Vec<String>),
) {
    for name in asked {
        let Some(questionnaire) = questionnaires::find(&dataset.design, &name) else { continue };
        let mut given = serde_json::Map::new();
        for item in &questionnaire.items {
            if let cohelm_study::design::AnswerKind::Scale(scale) = &item.answer {
                let place =
                    (0.6 - 0.08 * condition.unwrap_or(0) as f64 + 0.15 * draw.about()).clamp(0.0, 1.0);
                let steps = (place * (scale.most - scale.least) / scale.step).round();
                given.insert(item.id.clone(), (scale.least + steps * scale.step).into());
            }
        }
        let given = serde_json::Value::Object(given);
        let scores = questionnaire.score(&given).into_iter().map(|(scale, score)| Score {
            participant,
            condition,
            instrument: name.clone(),
            scale,
            score,
        });
        dataset.scores.extend(scores);
        let answers = given.as_object().into_iter().flatten().map(|(item, value)| Answer {
            participant,
            step: format!("{}/questionnaire/{name}", if condition.is_some() { "block-1" } else { "end" }),
            condition,
            item: item.clone(),
            value: value.clone(),
        });
        dataset.answers.extend(answers);
    }
}
