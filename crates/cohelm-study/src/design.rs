//! The design of a study: what its file says, checked.
//!
//! [`Design::from_toml`] reads a file of `studies/`; `docs/study.md` explains every key. [`schedule`] says who flies the
//! conditions in which order, [`timeline`] what one participant goes through from consent to thanks, [`explain`] puts
//! the design into words. Knows no plant and no model: what needs one is asked of a [`Catalogue`].

pub mod catalogue;
mod check;
pub mod condition;
mod defaults;
pub mod error;
pub mod estimate;
pub mod explain;
pub mod item;
mod read;
pub mod rules;
pub mod schedule;
pub mod schema;
pub mod text;
pub mod timeline;

pub use catalogue::{Catalogue, PlantFacts, Resolved, ResolvedModels};
pub use condition::{Condition, ModelChoice, TaskPlan};
pub use error::{DesignError, Problem};
pub use item::{AnswerKind, Choice, Item, Scale};
pub use rules::{
    Attention, AttentionCheck, ExclusionRules, OnFailedQuiz, OnSlowDevice, Panel, Primary, RightAnswer,
};
pub use text::Words;

use crate::questionnaires::{self, Questionnaire};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A study, as its file describes it.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Design {
    /// Version of this format: 1.
    #[serde(rename = "cohelm-study")]
    pub format: u32,
    /// Names the study in files and tables: small letters, digits and hyphens.
    pub name: String,
    /// What participants read as its title.
    pub title: Words,
    /// Codes of the languages that texts are given in; the first is the one to begin with. Default: ["en"].
    #[serde(default = "english")]
    pub languages: Vec<String>,
    /// Whom participants can ask: name and address. Shown with the consent and at the end.
    pub contact: String,
    /// How many participants are to finish. Best a multiple of the number of orders.
    pub planned_participants: u32,
    /// What is flown.
    pub task: TaskPlan,
    /// What is compared; each is one block of flights.
    pub conditions: Vec<Condition>,
    /// In which order a participant flies the conditions.
    pub order: Order,
    /// When the practice flights are flown. Default: before-each.
    #[serde(default)]
    pub practice: Practice,
    /// After which flights the page says how they ended and why. Default: practice.
    #[serde(default)]
    pub feedback: Feedback,
    /// Which ground, start and goal each flight has.
    pub terrain: Terrain,
    /// What participants agree to.
    pub consent: Consent,
    /// What they are told. Default: two pages that explain the task and the keys.
    #[serde(default)]
    pub instructions: Instructions,
    /// What they are asked about themselves. Default: nothing.
    #[serde(default)]
    pub demographics: Vec<Item>,
    /// Questions that show whether the instructions were understood. Default: none.
    pub quiz: Option<Quiz>,
    /// Pauses. Default: one of any length between two blocks.
    #[serde(default)]
    pub breaks: Breaks,
    /// Questionnaires after everything was flown, by name. Default: none.
    #[serde(default)]
    pub end_questionnaires: Vec<String>,
    /// Questionnaires of this study's own, besides the built-in ones.
    #[serde(default)]
    pub questionnaires: Vec<Questionnaire>,
    /// Read before each block's flights. Default: that the controls answer differently in each mode.
    #[serde(default = "defaults::block_text")]
    pub block_text: Words,
    /// Read after everything else. Default: that this was
    /// the last part, and whom to write to.
    #[serde(default = "defaults::debrief")]
    pub debrief: Words,
    /// What shows whether a participant attends. Default: nothing is asked.
    #[serde(default)]
    pub attention: Attention,
    /// Who is left out of the confirmatory analysis, declared in advance. Default: nobody who finished.
    #[serde(default)]
    pub exclusion: ExclusionRules,
    /// The one outcome that the study is about, declared in advance.
    pub primary: Primary,
    /// Largest differences that still count as none, by measure, in the measure's unit (shares: 0.1 is ten points); each
    /// asks for a test of equivalence. Default: none.
    #[serde(default)]
    pub equivalence: BTreeMap<String, f64>,
    /// Whether anyone who has the address /join may take part, without a link of their own. Default: false, and true
    /// with a `panel`.
    pub open_link: Option<bool>,
    /// The panel that sends participants and takes them back (Prolific, SONA). Default: none.
    pub panel: Option<Panel>,
    /// The code that everyone is shown at the end, 4 to 40 letters, digits and hyphens. Default: each participant has
    /// one of their own.
    pub completion_code: Option<String>,
    /// Minutes after which somebody who is away no longer holds a place in the plan, 5 to 10080. They may come back
    /// and go on. Default: 120.
    #[serde(default = "two_hours")]
    pub drop_out_after_minutes: u32,
    /// How long things take, for estimates only.
    #[serde(default)]
    pub timing: Timing,
    /// The file, to the byte.
    #[serde(skip)]
    pub text: String,
}

/// In which order a participant flies the conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// As many orders as conditions; each condition stands once at each place.
    LatinSquare,
    /// A Latin square in which moreover each condition follows each other one equally often; with an odd number of
    /// conditions it has twice as many orders.
    Williams,
    /// Drawn anew for each participant; balanced only in the long run.
    Random,
    /// As the file lists them, for everyone: order and condition cannot be told apart afterwards.
    Fixed,
}

/// When the practice flights are flown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Practice {
    /// Those of a condition right before its measured flights.
    #[default]
    BeforeEach,
    /// Those of all conditions before the first measured flight.
    InAdvance,
}

/// After which flights the page says how they ended and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Feedback {
    /// After practice flights only.
    #[default]
    Practice,
    /// After every flight.
    Always,
    /// After none.
    Never,
}

/// Which ground, start and goal each flight has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Terrain {
    /// From which all are drawn, 0 to 2⁵³. Another number, other grounds.
    pub seed: u64,
    /// Whether the n-th flight has the same ground for every participant. Comparisons between people then have less
    /// noise; what is found holds for these grounds. Default: true.
    #[serde(default = "yes")]
    pub same_for_everyone: bool,
    /// Whether the n-th measured flight has the same ground in every condition. Comparisons between conditions then
    /// have less noise, but a participant sees each ground once a condition. Default: true.
    #[serde(default = "yes")]
    pub same_in_every_condition: bool,
}

/// What participants agree to.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Consent {
    /// Version of the text; stored with the consent.
    pub version: String,
    /// The text: paragraphs, lists, bold, links to https addresses.
    pub text: Words,
    /// How long the study takes, as participants are told. Default: as estimated, rounded up to five.
    pub minutes: Option<f64>,
}

/// What participants are told before they fly.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Instructions {
    /// One page after the other.
    pub pages: Vec<InstructionPage>,
}

/// One page of instructions.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct InstructionPage {
    /// Its heading.
    pub title: Words,
    /// Paragraphs, lists, bold, links to https addresses.
    pub text: Words,
    /// A picture above the text. Default: none.
    pub picture: Option<Picture>,
}

/// What an instruction page shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Picture {
    /// The keys and what they do, as the participant has set them.
    Controls,
    /// What is steered, and the goals.
    Task,
}

/// Questions that show whether the instructions were understood.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Quiz {
    /// How often all questions may be answered, 1 to 10. Default: 3.
    #[serde(default = "three")]
    pub attempts: u32,
    /// What happens when the last attempt failed. Default: go-on.
    #[serde(default)]
    pub failed: OnFailedQuiz,
    /// The questions.
    pub questions: Vec<QuizQuestion>,
}

/// A question with a right answer.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct QuizQuestion {
    /// Names the answer; small letters, digits and hyphens.
    pub id: String,
    /// The question.
    pub text: Words,
    /// The answers to choose from, each a text or { value = "…", text = … }.
    pub choices: Vec<Choice>,
    /// The value of the right one. Never sent to the page.
    pub right: String,
    /// Read after a wrong answer.
    #[serde(default)]
    pub hint: Words,
}

/// Pauses between blocks, and within them.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Breaks {
    /// Whether there is one between two blocks. Default: true.
    #[serde(default = "yes")]
    pub between_blocks: bool,
    /// One after every so many flights within a block. Default: none.
    pub every_flights: Option<u32>,
    /// Seconds before which the participant cannot go on, 0 to 3600. Default: 0.
    #[serde(default)]
    pub at_least_s: u32,
    /// Seconds after which the page asks to go on. Default: never.
    pub at_most_s: Option<u32>,
    /// What is read meanwhile.
    #[serde(default = "defaults::pause")]
    pub text: Words,
}

/// How long things take, for estimates only: nothing is timed by it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", default, deny_unknown_fields)]
pub struct Timing {
    /// Seconds a usual flight lasts for the participant. Default: 6.
    pub flight_s: f64,
    /// Seconds from the end of a flight to the beginning of the next. Default: 4.
    pub between_flights_s: f64,
}

impl Default for Timing {
    fn default() -> Self {
        Self { flight_s: 6.0, between_flights_s: 4.0 }
    }
}

impl Default for Breaks {
    fn default() -> Self {
        Self {
            between_blocks: true,
            every_flights: None,
            at_least_s: 0,
            at_most_s: None,
            text: defaults::pause(),
        }
    }
}

impl Design {
    /// Reads and checks a study's file.
    pub fn from_toml(text: &str) -> Result<Self, DesignError> {
        read::read(text)
    }

    /// Whether it can be flown with the plants and models there are. What a program has not, or what a plant refuses, is
    /// told with its place in the file.
    pub fn check_with(&self, catalogue: &dyn Catalogue) -> Result<PlantFacts, DesignError> {
        read::check_with(self, catalogue)
    }

    /// SHA-256 of the file's bytes, in hexadecimal: names this version of the study.
    pub fn hash(&self) -> String {
        use sha2::{Digest, Sha256};
        Sha256::digest(self.text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// The language to begin with, in which every text can be read.
    pub fn first_language(&self) -> &str {
        self.languages.first().map_or("en", |language| language)
    }

    /// Whether participants may come without a link of their own.
    pub fn has_open_link(&self) -> bool {
        self.open_link.unwrap_or(self.panel.is_some())
    }

    /// Whether a device that cannot keep the plant's rate of ticks may not go on.
    pub fn refuses_slow_devices(&self) -> bool {
        self.exclusion.slow_device == OnSlowDevice::Refuse
    }

    /// The items of a questionnaire as they are asked: with its attention checks, each as the last item but one.
    pub fn items_of(&self, questionnaire: &str) -> Vec<Item> {
        let mut items =
            questionnaires::find(self, questionnaire).map_or_else(Vec::new, |found| found.items.clone());
        let checks = self.attention.checks.iter().filter(|check| check.questionnaire == questionnaire);
        for check in checks {
            items.insert(items.len().saturating_sub(1), check.item.clone());
        }
        items
    }
}

fn english() -> Vec<String> {
    vec!["en".to_owned()]
}

fn yes() -> bool {
    true
}

fn three() -> u32 {
    3
}

fn two_hours() -> u32 {
    120
}

#[cfg(test)]
mod tests;
