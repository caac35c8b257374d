//! What is flown, and under which rules.

use super::Words;
use super::text::described_by;
use cohelm::arbitration::{Rule, RuleError};
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
    /// The plant's own options; those left out have its defaults. `docs/lander.md` and `docs/plants.md` list them.
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
    /// Linear arbitration. On axes a blend, c · robot + (1 − c) · person; with levers the same for each lever, at the
    /// nearest position; where actions have no sum the robot's if the confidence c is above one half, otherwise the
    /// person's.
    Lasc,
    /// A blend whose weight follows a broken line over the confidence; takes `start`, `full` and `most`.
    LineGraph,
    /// The robot takes over above a confidence; takes `confidence`.
    Threshold,
    /// The best action on average over the goals (QMDP); takes `likeness`.
    Hindsight,
    /// Minimal intervention, the paper's Eqs. 3 and 4.
    Misc,
    /// Constant tolerance; needs `alpha`.
    Tolerance,
    /// Minimal intervention with a regret threshold; takes `kappa`.
    MiscR,
    /// Minimal intervention by regret, averaged over the goals and with hysteresis; takes `kappa` and `release`.
    MiscH,
    /// The robot's action, if it is better than the person's for every goal.
    Ida,
    /// The nearest action that flights ahead find safe; takes `hold` and `horizon`. Needs a plant that can be copied.
    SafeNearest,
}

impl RuleName {
    /// The rule with its usual parameters.
    fn usual(self) -> Rule {
        let word = match self {
            Self::Hic => "hic",
            Self::Robot => "robot",
            Self::Lasc => "lasc",
            Self::LineGraph => "line-graph",
            Self::Threshold => "threshold",
            Self::Hindsight => "hindsight",
            Self::Misc => "misc",
            Self::Tolerance => "tolerance",
            Self::MiscR => "misc-r",
            Self::MiscH => "misc-h",
            Self::Ida => "ida",
            Self::SafeNearest => "safe-nearest",
        };
        Rule::named(word).expect("every name here is a rule's word")
    }
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
    /// misc-r, misc-h: regret allowed, in median ranges of the values. Usual: 0.5 to 1.5 for commands; for axes 0.1 to 0.5, 0.6
    /// to 1 for misc-h. Default: 0.7, 1.25 for misc-h, which suit commands; on axes give 0.2, 1 for misc-h.
    kappa: Option<f64>,
    /// misc-h: share of `kappa` allowed at the tick after an intervention, 0 to 1; less holds on longer. Default: 0.5; on
    /// axes give 0.25.
    release: Option<f64>,
    /// line-graph: confidence up to which the person alone flies, 0 to 1. Default: 0.2.
    start: Option<f64>,
    /// line-graph: confidence from which the robot has its largest weight, `start` to 1. Default: 0.8.
    full: Option<f64>,
    /// line-graph: the robot's largest weight, 0 to 1. Default: 1.
    most: Option<f64>,
    /// threshold: confidence above which the robot takes over, 0 to 1. Default: 0.6.
    confidence: Option<f64>,
    /// hindsight: what likeness to what is asked is worth, in median ranges of the values; 0 is plain QMDP. Default: 0.
    likeness: Option<f64>,
    /// safe-nearest: ticks for which an action is thought to be held, 0 to 500; more steps in earlier. Default: 10.
    hold: Option<f64>,
    /// safe-nearest: ticks flown ahead, 0 to 500. Default: 80.
    horizon: Option<f64>,
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
        let rule = table.rule().map_err(|fault| format!("condition {:?}: {}", table.name, fault.reason))?;
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

/// What is wrong with a rule, and the key where.
struct RuleFault {
    key: String,
    reason: String,
}

impl From<RuleError> for RuleFault {
    fn from(error: RuleError) -> Self {
        let key = match &error {
            RuleError::Alpha(_) => "alpha",
            RuleError::Kappa(_) => "kappa",
            RuleError::Parameter { name, .. } => name,
            RuleError::NoParameter { name, .. } => name,
            RuleError::Unknown { .. } | RuleError::MedianRange { .. } => "rule",
        };
        Self { key: key.to_owned(), reason: error.to_string() }
    }
}

/// What is wrong with the rules of a file whose conditions can be read: where (`conditions[1].kappa`), and a sentence
/// each. The reader of TOML does not know in which of several tables a conversion failed.
pub(super) fn rule_faults(text: &str) -> Vec<(String, String)> {
    #[derive(Deserialize)]
    struct OnlyConditions {
        conditions: Vec<ConditionTable>,
    }
    let Ok(OnlyConditions { conditions }) = toml::from_str(text) else { return Vec::new() };
    let fault = |(index, table): (usize, &ConditionTable)| {
        let RuleFault { key, reason } = table.rule().err()?;
        Some((format!("conditions[{index}].{key}"), format!("condition {:?}: {reason}", table.name)))
    };
    conditions.iter().enumerate().filter_map(fault).collect()
}

impl ConditionTable {
    fn rule(&self) -> Result<Rule, RuleFault> {
        if matches!(self.rule, RuleName::Tolerance) && self.alpha.is_none() {
            let reason =
                "rule tolerance needs `alpha` in 0 to 1 (0: only a best action, 1: every action), got none";
            return Err(RuleFault { key: "rule".into(), reason: reason.into() });
        }
        let parameters = [
            ("alpha", self.alpha),
            ("kappa", self.kappa),
            ("release", self.release),
            ("start", self.start),
            ("full", self.full),
            ("most", self.most),
            ("confidence", self.confidence),
            ("likeness", self.likeness),
            ("hold", self.hold),
            ("horizon", self.horizon),
        ];
        let given = parameters.into_iter().filter_map(|(name, value)| Some((name, value?)));
        let rule =
            given.into_iter().try_fold(self.rule.usual(), |rule, (name, value)| rule.with(name, value));
        // The models come later: here only the parameters are looked at, whatever the values' range.
        Ok(rule.and_then(|rule| rule.arbiter(1.0).map(|_| rule))?)
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
