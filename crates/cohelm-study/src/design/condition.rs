//! What is flown, and under which rules.

use super::Words;
use super::text::described_by;
use cohelm::arbitration::{DEFAULT_KAPPA, Rule};
use cohelm::cockpit::Silence;
use cohelm::intent::Inference;
use cohelm::registry::Task;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What is flown in every condition.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "TaskTable")]
pub struct TaskPlan {
    /// Plant and its options.
    pub task: Task,
    /// How fast the world goes: 1 is real time.
    pub time_scale: f64,
    /// Which network estimates the values.
    pub values: ModelChoice,
    /// Which network infers the goal.
    pub intent: ModelChoice,
}

/// Which model of a kind is used.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Deserialize, Serialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
pub enum ModelChoice {
    /// The one that the program ships as usual for the task.
    #[default]
    Shipped,
    /// The one whose file has this SHA-256, 64 hexadecimal digits.
    Hash(String),
}

impl TryFrom<String> for ModelChoice {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let is_hash = text.len() == 64 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        match text.as_str() {
            "shipped" => Ok(Self::Shipped),
            _ if is_hash => Ok(Self::Hash(text.to_ascii_lowercase())),
            _ => Err(format!(
                "a model is \"shipped\" or the SHA-256 of its file (64 hexadecimal digits; `sha256sum FILE` prints it), \
                 got {text:?}"
            )),
        }
    }
}

impl From<ModelChoice> for String {
    fn from(choice: ModelChoice) -> Self {
        match choice {
            ModelChoice::Shipped => "shipped".to_owned(),
            ModelChoice::Hash(hash) => hash,
        }
    }
}

/// One way of sharing control; a participant flies one block of each.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "ConditionTable")]
pub struct Condition {
    /// Names it in files and tables; participants never see it.
    pub name: String,
    /// What participants read; without one "Mode A", "Mode B", … in the order flown.
    pub label: Option<Words>,
    /// The rule of arbitration.
    pub rule: Rule,
    /// Where the belief about the goal comes from.
    pub inference: Inference,
    /// What is carried out when nothing is asked.
    pub silence: Silence,
    /// Whether the values go on learning from these flights.
    pub learning: bool,
    /// Flights to get used to it, which are not analysed.
    pub practice_episodes: u32,
    /// Flights that are analysed.
    pub measured_episodes: u32,
    /// Questionnaires after its last flight.
    pub questionnaires: Vec<String>,
}

/// What is flown in every condition.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct TaskTable {
    /// The plant's name, such as "flag-lander".
    plant: String,
    /// The plant's own options; those left out have its defaults. `docs/lander.md` lists them.
    #[serde(default = "no_options")]
    options: Value,
    /// How fast the world goes: 1 is real time, 0.5 half as fast, 0.1 to 3. Default: 1.
    #[serde(default = "one")]
    time_scale: f64,
    /// Which network estimates the values: "shipped", or the SHA-256 of a model's file. Default: shipped.
    #[serde(default)]
    values: ModelChoice,
    /// Which network infers the goal: "shipped", or the SHA-256 of a model's file. Default: shipped.
    #[serde(default)]
    intent: ModelChoice,
}

fn no_options() -> Value {
    Value::Object(serde_json::Map::new())
}

fn one() -> f64 {
    1.0
}

/// The rules, by the names that records use.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum RuleName {
    /// Human alone: what is asked is carried out.
    Hic,
    /// Robot alone: the best action, whatever is asked.
    Robot,
    /// Linear arbitration: the robot's action if the confidence is above one half, otherwise the person's.
    Lasc,
    /// Minimal intervention, the paper's Eqs. 3 and 4.
    Misc,
    /// Constant tolerance; needs `alpha`.
    Tolerance,
    /// Minimal intervention with a regret threshold; takes `kappa`.
    MiscR,
}

/// Where the belief about the goal comes from.
#[derive(Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum InferenceName {
    /// The nearest goal; no network.
    Nearest,
    /// The goal is told from outside: for demonstrations.
    Known,
    /// A network; probabilities are normalised inverse distances (the paper's reading).
    InverseDistance,
    /// A network; softmax of distances, a peaked confidence.
    Softmax,
    /// A network with calibrated probabilities.
    #[default]
    Calibrated,
    /// The goal whose values explain best what is asked (Boltzmann-rational, recursive); no network but that of the values.
    Bayesian,
    /// The product of the two before.
    CalibratedBayesian,
    /// The co-pilot knows no goals: a network imagines one, and the values help to get there.
    Imagined,
}

/// What is carried out when nothing is asked.
#[derive(Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum SilenceName {
    /// The co-pilot's best action, as in the paper.
    #[default]
    Best,
    /// Nothing.
    Nothing,
}

/// One way of sharing control; a participant flies one block of each.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct ConditionTable {
    /// Names it in files and tables; participants never see it. Small letters, digits and hyphens.
    name: String,
    /// What participants read. Default: "Mode A", "Mode B", … in the order flown, so that the label tells nothing.
    label: Option<Words>,
    /// The rule of arbitration.
    rule: RuleName,
    /// tolerance: 0 allows only a best action, 1 every action. Usual: 0.5 to 0.8.
    alpha: Option<f64>,
    /// misc-r: regret allowed, in median ranges of the values; larger lets more through. Usual: 0.5 to 1.5. Default: 0.7.
    kappa: Option<f64>,
    /// Where the belief about the goal comes from. Default: calibrated.
    #[serde(default)]
    inference: InferenceName,
    /// What is carried out when nothing is asked. Default: best.
    #[serde(default)]
    silence: SilenceName,
    /// Whether the values go on learning from these flights, for all participants together. Default: false.
    #[serde(default)]
    learning: bool,
    /// Flights to get used to it, which are not analysed, 0 to 500. Default: 0.
    #[serde(default)]
    practice_episodes: u32,
    /// Flights that are analysed, 1 to 500.
    measured_episodes: u32,
    /// Questionnaires after its last flight, by name. Default: none.
    #[serde(default)]
    questionnaires: Vec<String>,
}

impl TryFrom<TaskTable> for TaskPlan {
    type Error = String;

    fn try_from(table: TaskTable) -> Result<Self, String> {
        let TaskTable { plant, options, time_scale, values, intent } = table;
        if !options.is_object() {
            return Err(format!("`options` is a table such as {{ limit = 600 }}, got {options}"));
        }
        if !(0.1..=3.0).contains(&time_scale) {
            return Err(format!("`time-scale` must lie in 0.1 to 3 (1: real time), got {time_scale}"));
        }
        Ok(Self { task: Task { plant, options }, time_scale, values, intent })
    }
}

impl TryFrom<ConditionTable> for Condition {
    type Error = String;

    fn try_from(table: ConditionTable) -> Result<Self, String> {
        let rule = table.rule().map_err(|reason| format!("condition {:?}: {reason}", table.name))?;
        Ok(Self {
            rule,
            name: table.name,
            label: table.label,
            inference: table.inference.into(),
            silence: table.silence.into(),
            learning: table.learning,
            practice_episodes: table.practice_episodes,
            measured_episodes: table.measured_episodes,
            questionnaires: table.questionnaires,
        })
    }
}

impl ConditionTable {
    fn rule(&self) -> Result<Rule, String> {
        if self.alpha.is_some() && !matches!(self.rule, RuleName::Tolerance) {
            return Err("`alpha` belongs to rule tolerance alone".to_owned());
        }
        if self.kappa.is_some() && !matches!(self.rule, RuleName::MiscR) {
            return Err("`kappa` belongs to rule misc-r alone".to_owned());
        }
        match self.rule {
            RuleName::Hic => Ok(Rule::Hic),
            RuleName::Robot => Ok(Rule::Robot),
            RuleName::Lasc => Ok(Rule::Lasc),
            RuleName::Misc => Ok(Rule::Misc),
            RuleName::Tolerance => tolerance(self.alpha),
            RuleName::MiscR => regret(self.kappa.unwrap_or(DEFAULT_KAPPA)),
        }
    }
}

fn tolerance(alpha: Option<f64>) -> Result<Rule, String> {
    let expected = "rule tolerance needs `alpha` in 0 to 1 (0: only a best action, 1: every action)";
    match alpha {
        Some(alpha) if (0.0..=1.0).contains(&alpha) => Ok(Rule::Tolerance { alpha }),
        Some(other) => Err(format!("{expected}, got {other}")),
        None => Err(format!("{expected}, got none")),
    }
}

fn regret(kappa: f64) -> Result<Rule, String> {
    if kappa.is_finite() && kappa >= 0.0 {
        Ok(Rule::MiscR { kappa })
    } else {
        Err(format!("`kappa` must be a finite number of at least 0 (usual: 0.5 to 1.5), got {kappa}"))
    }
}

impl From<InferenceName> for Inference {
    fn from(name: InferenceName) -> Self {
        match name {
            InferenceName::Nearest => Self::Nearest,
            InferenceName::Known => Self::Known,
            InferenceName::InverseDistance => Self::InverseDistance,
            InferenceName::Softmax => Self::Softmax,
            InferenceName::Calibrated => Self::Calibrated,
            InferenceName::Bayesian => Self::Bayesian,
            InferenceName::CalibratedBayesian => Self::CalibratedBayesian,
            InferenceName::Imagined => Self::Imagined,
        }
    }
}

impl From<SilenceName> for Silence {
    fn from(name: SilenceName) -> Self {
        match name {
            SilenceName::Best => Self::Best,
            SilenceName::Nothing => Self::Nothing,
        }
    }
}

described_by!(TaskPlan, TaskTable);
described_by!(Condition, ConditionTable);
