//! How long a participant needs: an estimate for consent, plan and progress. Nothing is timed by it.

use super::schedule::Assignment;
use super::timeline::{Step, StepKind, steps};
use super::{Design, Item};

/// Words that people read a minute, somewhat below the usual 240 since much is new to them.
const WORDS_A_MINUTE: f64 = 200.0;
/// Seconds for an item of a questionnaire, reading included.
const ITEM_S: f64 = 8.0;
/// Seconds for a question about oneself.
const FORM_ITEM_S: f64 = 10.0;
/// Seconds for a question of the quiz.
const QUIZ_ITEM_S: f64 = 15.0;
/// Seconds for the test of the device.
const DEVICE_S: f64 = 15.0;
/// Seconds to read a short announcement.
const NOTICE_S: f64 = 10.0;

/// Minutes for some steps.
pub fn minutes(design: &Design, steps: &[Step]) -> f64 {
    steps.iter().map(|step| seconds(design, step)).sum::<f64>() / 60.0
}

/// Minutes for the whole of it, as one tells participants: rounded up to five.
pub fn minutes_to_tell(design: &Design) -> f64 {
    let as_listed = Assignment { cell: 0, order: (0..design.conditions.len()).collect(), seed: 0 };
    5.0 * (minutes(design, &steps(design, &as_listed)) / 5.0).ceil()
}

fn seconds(design: &Design, step: &Step) -> f64 {
    match &step.kind {
        StepKind::Consent => reading_s(design.consent.text.read(design.first_language(), "")),
        StepKind::Device => DEVICE_S,
        StepKind::Demographics => FORM_ITEM_S * design.demographics.len() as f64,
        StepKind::Instructions => {
            let pages = design.instructions.pages.iter();
            pages.map(|page| NOTICE_S + reading_s(page.text.read(design.first_language(), ""))).sum()
        }
        StepKind::Quiz => QUIZ_ITEM_S * design.quiz.as_ref().map_or(0, |quiz| quiz.questions.len()) as f64,
        StepKind::Flight(_) => design.timing.flight_s + design.timing.between_flights_s,
        StepKind::Break => f64::from(design.breaks.at_least_s.max(20)),
        StepKind::Questionnaire { instrument, .. } => {
            let items: Vec<Item> = design.items_of(instrument);
            NOTICE_S + ITEM_S * items.len() as f64
        }
        StepKind::Block(_) | StepKind::Debrief | StepKind::Thanks => NOTICE_S,
    }
}

fn reading_s(text: &str) -> f64 {
    60.0 * text.split_whitespace().count() as f64 / WORDS_A_MINUTE
}
