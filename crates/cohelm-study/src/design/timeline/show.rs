//! A step as the page gets it: every text in the participant's language, nothing that they are not to know.

use super::setups::{Unresolved, flight_key, setup};
use super::shown::{
    ShownBreak, ShownChoice, ShownContent, ShownFlight, ShownItem, ShownPage, ShownQuestion, ShownStep,
};
use super::{BlockPlace, FlightPlace, Step, StepKind};
use crate::design::catalogue::Resolved;
use crate::design::schedule::Assignment;
use crate::design::{AnswerKind, Choice, Design, Feedback, Item, Scale, Words};
use crate::design::{defaults, estimate};
use crate::questionnaires;
use cohelm::plant::Ending;
use cohelm::trajectory::Setup;

/// What of a session a step's content depends on.
#[derive(Clone, Debug)]
pub struct Situation<'a> {
    /// The participant's language.
    pub language: &'a str,
    /// The participant's order and seed; before consent one that shows nothing of it.
    pub assignment: &'a Assignment,
    /// The attempt at the step's flight, from 1.
    pub attempt: u32,
    /// How the step's flight ended, if it was flown already and only its telemetry is missing.
    pub flown: Option<Ending>,
    /// Attempts at the quiz that are left.
    pub quiz_attempts: u32,
    /// The code of completion, once the session is complete.
    pub code: Option<&'a str>,
    /// Where the participant goes back to, filled in.
    pub return_address: Option<String>,
}

/// A step as the page gets it.
pub fn show(
    design: &Design,
    resolved: &Resolved,
    step: &Step,
    situation: &Situation<'_>,
) -> Result<ShownStep, Unresolved> {
    let show = Show { design, resolved, situation };
    Ok(ShownStep { id: step.id.clone(), content: show.content(step)? })
}

struct Show<'a> {
    design: &'a Design,
    resolved: &'a Resolved,
    situation: &'a Situation<'a>,
}

impl Show<'_> {
    fn read(&self, words: &Words) -> String {
        words.read(self.situation.language, self.design.first_language()).to_owned()
    }

    fn content(&self, step: &Step) -> Result<ShownContent, Unresolved> {
        let design = self.design;
        Ok(match &step.kind {
            StepKind::Consent => self.consent(),
            StepKind::Device => ShownContent::Device { refuse: design.refuses_slow_devices() },
            StepKind::Demographics => ShownContent::Form {
                title: self.read(&defaults::both("About you", "Über Sie")),
                items: design.demographics.iter().map(|item| self.item(item)).collect(),
            },
            StepKind::Instructions => self.instructions(),
            StepKind::Quiz => self.quiz(),
            StepKind::Block(place) => self.block(place),
            StepKind::Break => self.pause(),
            StepKind::Questionnaire { instrument, .. } => self.questionnaire(instrument),
            StepKind::Debrief => {
                ShownContent::Debrief { text: self.read(&design.debrief), contact: design.contact.clone() }
            }
            StepKind::Thanks => self.thanks(),
            StepKind::Flight(place) => {
                let setup = setup(design, self.situation.assignment, self.resolved, place)?;
                ShownContent::Flight(Box::new(self.flight(step, place, setup)))
            }
        })
    }

    fn consent(&self) -> ShownContent {
        let consent = &self.design.consent;
        ShownContent::Consent {
            version: consent.version.clone(),
            text: self.read(&consent.text),
            minutes: consent.minutes.or_else(|| Some(estimate::minutes_to_tell(self.design))),
            contact: self.design.contact.clone(),
        }
    }

    fn instructions(&self) -> ShownContent {
        let page = |page: &crate::design::InstructionPage| ShownPage {
            title: self.read(&page.title),
            text: self.read(&page.text),
            picture: page.picture,
        };
        ShownContent::Instructions { pages: self.design.instructions.pages.iter().map(page).collect() }
    }

    fn quiz(&self) -> ShownContent {
        let question = |question: &crate::design::QuizQuestion| ShownQuestion {
            id: question.id.clone(),
            text: self.read(&question.text),
            choices: self.choices(&question.choices),
            hint: self.read(&question.hint),
        };
        let questions = self.design.quiz.iter().flat_map(|quiz| &quiz.questions).map(question).collect();
        ShownContent::Quiz { questions, attempts: self.situation.quiz_attempts }
    }

    fn block(&self, place: &BlockPlace) -> ShownContent {
        ShownContent::Block {
            label: self.label(place.block, place.condition),
            text: self.read(&self.design.block_text),
            practice: place.practice,
            measured: place.measured,
        }
    }

    fn label(&self, block: usize, condition: usize) -> String {
        match &self.design.conditions[condition].label {
            Some(label) => self.read(label),
            None => self.read(&defaults::mode_label(block - 1)),
        }
    }

    fn flight(&self, step: &Step, place: &FlightPlace, setup: Setup) -> ShownFlight {
        let Situation { assignment, attempt, flown, .. } = *self.situation;
        ShownFlight {
            label: self.label(place.block, place.condition),
            practice: place.practice,
            number: place.number,
            of: place.of,
            block: place.block,
            setup,
            flight_key: flight_key(assignment, step, attempt),
            attempt,
            feedback: match self.design.feedback {
                Feedback::Practice => place.practice,
                Feedback::Always => true,
                Feedback::Never => false,
            },
            flown,
            committed_ticks: 0,
        }
    }

    fn pause(&self) -> ShownContent {
        let breaks = &self.design.breaks;
        ShownContent::Break(ShownBreak {
            text: self.read(&breaks.text),
            at_least_s: breaks.at_least_s,
            at_most_s: breaks.at_most_s,
        })
    }

    fn questionnaire(&self, name: &str) -> ShownContent {
        let found = questionnaires::find(self.design, name);
        ShownContent::Questionnaire {
            instrument: name.to_owned(),
            title: found.map_or_else(String::new, |found| self.read(&found.title)),
            intro: found.map_or_else(String::new, |found| self.read(&found.intro)),
            items: self.design.items_of(name).iter().map(|item| self.item(item)).collect(),
        }
    }

    fn thanks(&self) -> ShownContent {
        let button =
            self.design.panel.as_ref().map(|panel| &panel.button).filter(|button| !button.is_empty());
        ShownContent::Thanks {
            code: self.situation.code.map(str::to_owned),
            return_address: self.situation.return_address.clone(),
            button: button.map_or_else(|| self.read(&defaults::panel_button()), |button| self.read(button)),
            text: self.read(&defaults::thanks()),
            contact: self.design.contact.clone(),
        }
    }

    fn choices(&self, choices: &[Choice]) -> Vec<ShownChoice> {
        let shown =
            |choice: &Choice| ShownChoice { value: choice.value.clone(), text: self.read(&choice.text) };
        choices.iter().map(shown).collect()
    }

    fn item(&self, item: &Item) -> ShownItem {
        let (id, text, required) = (item.id.clone(), self.read(&item.text), item.required);
        match &item.answer {
            AnswerKind::Scale(scale) => self.scale(id, text, required, scale),
            AnswerKind::Choice(choices) => {
                ShownItem::Choice { id, text, required, choices: self.choices(choices) }
            }
            AnswerKind::Many(choices) => {
                ShownItem::Many { id, text, required, choices: self.choices(choices) }
            }
            AnswerKind::Number { least, most, unit } => {
                let unit = unit.as_ref().map(|unit| self.read(unit));
                ShownItem::Number { id, text, required, least: *least, most: *most, unit }
            }
            AnswerKind::Text { most_chars } => {
                ShownItem::Text { id, text, required, most_chars: *most_chars }
            }
        }
    }

    fn scale(&self, id: String, text: String, required: bool, scale: &Scale) -> ShownItem {
        ShownItem::Scale {
            id,
            text,
            required,
            least: scale.least,
            most: scale.most,
            step: scale.step,
            left: self.read(&scale.left),
            right: self.read(&scale.right),
            labels: scale.labels.iter().map(|label| self.read(label)).collect(),
            start: None,
        }
    }
}
