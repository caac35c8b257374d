//! The design, as far as a reader of the results needs it.

use super::Study;
use crate::apa;
use crate::design::{Order, Practice};
use crate::report::{Align, Block, Document, Table};
use crate::text::Text;
use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::intent::Inference;

pub(super) fn write(study: &Study<'_>, document: &mut Document) {
    let design = &study.data.design;
    document.push(Block::heading("Design"));
    let order = match design.order {
        Order::LatinSquare => "in orders of a Latin square",
        Order::Williams => {
            "in orders of a Williams square, in which every mode follows every other equally often"
        }
        Order::Random => "in an order drawn for each participant",
        Order::Fixed => {
            "in the same order for everyone, so that effects of mode and of order cannot be told apart"
        }
    };
    let practice = match design.practice {
        Practice::BeforeEach => "right before the measured flights of its mode",
        Practice::InAdvance => "before the first measured flight of any mode",
    };
    let terrain = match (design.terrain.same_for_everyone, design.terrain.same_in_every_condition) {
        (true, true) => "The n-th flight had the same ground, start and goal for everyone and in every mode.",
        (true, false) => {
            "The n-th flight had the same ground, start and goal for everyone, another one in every mode."
        }
        (false, true) => {
            "The n-th flight had the same ground, start and goal in every mode, another one for every participant."
        }
        (false, false) => "Every flight had a ground, start and goal of its own.",
    };
    document.push(Block::paragraph(format!(
        "Within participants: everyone flew every mode, {order}. Practice was flown {practice}. {terrain} Participants saw neutral \
         labels, never the name of a rule or what the co-pilot believed. Time scale: {}.",
        apa::number(design.task.time_scale, 2)
    )));
    document.push(Block::Table(conditions(study)));
}

fn conditions(study: &Study<'_>) -> Table {
    let heads =
        ["Mode", "Rule", "Belief about the goal", "In silence", "Practice", "Measured", "Questionnaires"];
    let align = |i: usize| if (4..6).contains(&i) { Align::Right } else { Align::Left };
    let row = |condition: &crate::design::Condition| {
        let asked = if condition.questionnaires.is_empty() {
            "–".to_owned()
        } else {
            condition.questionnaires.join(", ")
        };
        let learning = if condition.learning { "; values go on learning" } else { "" };
        vec![
            Text::from(condition.name.as_str()),
            Text::from(format!("{}{learning}", rule(&condition.rule))),
            Text::from(inference(condition.inference)),
            Text::from(match condition.silence {
                Silence::Best => "best action",
                Silence::Nothing => "nothing",
            }),
            Text::from(condition.practice_episodes.to_string()),
            Text::from(condition.measured_episodes.to_string()),
            Text::from(asked),
        ]
    };
    Table {
        caption: Text::from("The modes, with flights per participant."),
        columns: heads.into_iter().enumerate().map(|(i, head)| (Text::from(head), align(i))).collect(),
        rows: study.data.design.conditions.iter().map(row).collect(),
        notes: vec![Text::from("In silence: what is carried out while the pilot asks for nothing.")],
    }
}

/// A rule in a few words.
fn rule(rule: &Rule) -> String {
    match rule {
        Rule::Lasc => "linear arbitration (LASC)".to_owned(),
        Rule::Misc => "minimal intervention (MISC)".to_owned(),
        Rule::Tolerance { alpha } => format!("constant tolerance, α = {}", apa::number(*alpha, 2)),
        Rule::MiscR { kappa } => {
            format!("minimal intervention by regret (MISC-R), κ = {}", apa::number(*kappa, 2))
        }
        rule => rule.to_string(),
    }
}

fn inference(inference: Inference) -> &'static str {
    match inference {
        Inference::Nearest => "nearest goal",
        Inference::Known => "told",
        Inference::InverseDistance => "network, inverse distances",
        Inference::Softmax => "network, softmax",
        Inference::Calibrated => "network, calibrated",
        Inference::Bayesian => "by the values",
        Inference::CalibratedBayesian => "network, calibrated, and by the values",
        Inference::Imagined => "network that knows no goals",
    }
}
