//! A step as the page gets it: every text in the participant's language, nothing that they are not to know.

use super::setups::{Unresolved, flight_key, setup};
use super::{BlockPlace, FlightPlace, Step, StepKind};
use crate::design::catalogue::Resolved;
use crate::design::defaults;
use crate::design::schedule::Assignment;
use crate::design::{AnswerKind, Choice, Design, Feedback, Item, Picture, Scale, Words};
use crate::questionnaires;
use cohelm::plant::Ending;
use cohelm::trajectory::Setup;
use serde::{Deserialize, Serialize};

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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownStep {
    /// As [`Step::id`].
    pub id: String,
    /// What is shown.
    #[serde(flatten)]
    pub content: ShownContent,
}

/// What a step shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ShownContent {
    /// The text of the consent.
    Consent {
        /// Its version.
        version: String,
        /// Restricted Markdown.
        text: String,
        /// How long the study takes, in minutes, if it is said.
        minutes: Option<f64>,
        /// Whom to ask.
        contact: String,
    },
    /// The test of the device.
    Device {
        /// Whether a device that cannot keep up may not go on.
        refuse: bool,
    },
    /// A form.
    Form {
        /// Its heading.
        title: String,
        /// Its questions.
        items: Vec<ShownItem>,
    },
    /// Pages to read.
    Instructions {
        /// One after the other.
        pages: Vec<ShownPage>,
    },
    /// A quiz, without its answers.
    Quiz {
        /// The questions.
        questions: Vec<ShownQuestion>,
        /// Attempts that are left.
        attempts: u32,
    },
    /// A block begins.
    Block {
        /// The neutral label of its mode.
        label: String,
        /// What is said about it.
        text: String,
        /// Practice flights that follow.
        practice: u32,
        /// Measured flights that follow.
        measured: u32,
    },
    /// A flight.
    Flight(Box<ShownFlight>),
    /// A pause.
    Break(ShownBreak),
    /// A questionnaire.
    Questionnaire {
        /// Its name.
        instrument: String,
        /// Its heading.
        title: String,
        /// Read above the items.
        intro: String,
        /// The items.
        items: Vec<ShownItem>,
    },
    /// The last words.
    Debrief {
        /// Restricted Markdown.
        text: String,
        /// Whom to ask.
        contact: String,
    },
    /// Completion.
    Thanks {
        /// The code of completion.
        code: Option<String>,
        /// Where to go back to.
        return_address: Option<String>,
        /// On the button that leads there.
        button: String,
        /// A sentence of thanks.
        text: String,
        /// Whom to ask.
        contact: String,
    },
}

/// A flight as the page gets it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownFlight {
    /// The neutral label of its mode.
    pub label: String,
    /// Whether it is for practice.
    pub practice: bool,
    /// From 1.
    pub number: u32,
    /// How many there are of its kind in the block.
    pub of: u32,
    /// From 1.
    pub block: usize,
    /// What fixes it.
    pub setup: Setup,
    /// 32 hexadecimal digits: the key of its Begin.
    pub flight_key: String,
    /// From 1; higher after a flight that was refused.
    pub attempt: u32,
    /// Whether the page says afterwards how it ended and why.
    pub feedback: bool,
    /// How it ended, if it was flown and only its telemetry is missing.
    pub flown: Option<Ending>,
    /// Ticks that the server has committed; the server fills it in.
    #[serde(default)]
    pub committed_ticks: u32,
}

/// A pause as the page gets it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownBreak {
    /// What is read meanwhile.
    pub text: String,
    /// Seconds before which one cannot go on.
    pub at_least_s: u32,
    /// Seconds after which the page asks to go on.
    pub at_most_s: Option<u32>,
}

/// A page of instructions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownPage {
    /// Its heading.
    pub title: String,
    /// Restricted Markdown.
    pub text: String,
    /// The picture above.
    pub picture: Option<Picture>,
}

/// A question of the quiz, without its answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownQuestion {
    /// Names the answer.
    pub id: String,
    /// The question.
    pub text: String,
    /// The answers to choose from.
    pub choices: Vec<ShownChoice>,
    /// Read after a wrong answer.
    pub hint: String,
}

/// One of the answers to choose from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownChoice {
    /// What is stored.
    pub value: String,
    /// What is read.
    pub text: String,
}

/// A question as the page gets it; `kind` says which of the fields it has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ShownItem {
    /// A number on a scale.
    Scale {
        /// Names the answer.
        id: String,
        /// The question.
        text: String,
        /// Whether it may not be left out.
        required: bool,
        /// At the left end.
        least: f64,
        /// At the right end.
        most: f64,
        /// Between neighbours.
        step: f64,
        /// The word at the left end.
        left: String,
        /// The word at the right end.
        right: String,
        /// A word for every point, or none.
        labels: Vec<String>,
        /// What is chosen beforehand: nothing.
        start: Option<f64>,
    },
    /// One of several.
    Choice {
        /// Names the answer.
        id: String,
        /// The question.
        text: String,
        /// Whether it may not be left out.
        required: bool,
        /// The answers to choose from.
        choices: Vec<ShownChoice>,
    },
    /// Any of several.
    Many {
        /// Names the answer.
        id: String,
        /// The question.
        text: String,
        /// Whether it may not be left out.
        required: bool,
        /// The answers to choose from.
        choices: Vec<ShownChoice>,
    },
    /// A number.
    Number {
        /// Names the answer.
        id: String,
        /// The question.
        text: String,
        /// Whether it may not be left out.
        required: bool,
        /// The smallest allowed.
        least: Option<f64>,
        /// The largest allowed.
        most: Option<f64>,
        /// Printed behind it.
        unit: Option<String>,
    },
    /// Free text.
    Text {
        /// Names the answer.
        id: String,
        /// The question.
        text: String,
        /// Whether it may not be left out.
        required: bool,
        /// Most characters.
        most_chars: u32,
    },
}

/// A step as the page gets it.
pub fn show(
    design: &Design,
    resolved: &Resolved,
    step: &Step,
    situation: &Situation<'_>,
) -> Result<ShownStep, Unresolved> {
    let show = Show { design, situation };
    let content = match &step.kind {
        StepKind::Flight(place) => {
            let setup = setup(design, situation.assignment, resolved, place)?;
            ShownContent::Flight(Box::new(show.flight(step, place, setup)))
        }
        kind => show.content(kind),
    };
    Ok(ShownStep { id: step.id.clone(), content })
}

struct Show<'a> {
    design: &'a Design,
    situation: &'a Situation<'a>,
}

impl Show<'_> {
    fn read(&self, words: &Words) -> String {
        words.read(self.situation.language, self.design.first_language()).to_owned()
    }

    fn content(&self, kind: &StepKind) -> ShownContent {
        let design = self.design;
        match kind {
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
            StepKind::Flight(_) => unreachable!("flights are shown with their setup"),
        }
    }

    fn consent(&self) -> ShownContent {
        let consent = &self.design.consent;
        ShownContent::Consent {
            version: consent.version.clone(),
            text: self.read(&consent.text),
            minutes: consent.minutes,
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
            text: self.read(&defaults::block_intro()),
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
