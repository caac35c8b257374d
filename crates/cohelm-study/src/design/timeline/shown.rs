//! The form of a step as the page gets it: JSON with a tag `kind`.

use crate::design::Picture;
use cohelm::plant::Ending;
use cohelm::trajectory::Setup;
use serde::{Deserialize, Serialize};

/// A step as the page gets it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownStep {
    /// As [`Step::id`](super::Step::id).
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
        /// How long the study takes, in minutes.
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
