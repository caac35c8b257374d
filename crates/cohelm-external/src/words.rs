//! What is said over the socket: one JSON object a line.

use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Ending, Goal};
use cohelm::scene::{Pose, Scene};
use cohelm::tape::Seen;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Version of the protocol.
pub const PROTOCOL: u32 = 1;
/// Most bytes of the line that begins an episode, which holds the scene.
pub const MAX_OPENING: usize = 1024 * 1024;
/// Most bytes of any other line.
pub const MAX_LINE: usize = 64 * 1024;

/// Who the plant is: its first line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hello {
    /// Version of the protocol that it speaks.
    pub cohelm: u32,
    /// Its name: 1 to 64 bytes.
    pub name: String,
    /// Ticks a second that it wants to be driven at: 1 to 200, usually 50.
    pub ticks_per_second: f64,
    /// The actions it takes.
    pub space: ActionSpace,
}

/// An episode is to begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Begin {
    /// For whatever is random about it; at most 2⁵³.
    pub seed: u64,
    /// The plant's own dead man: if it hears nothing for so long between two ticks, it must stop by itself, ms. One period
    /// of its ticks longer than the time-out that it was given.
    pub time_out_ms: u64,
}

/// The plant is ready to begin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ready {
    /// What to draw.
    pub scene: Scene,
    /// The id of the goal that the pilot is to reach.
    pub pilot_goal: u32,
    /// The state vector, 1 to 64 numbers within about −1 to 1.
    pub state: Vec<f32>,
    /// Where the plant is, in the goals' units.
    pub position: [f32; 2],
    /// How its switches stand, one bit each.
    #[serde(default)]
    pub switches: u8,
    /// The goals, 1 to 8.
    pub goals: Vec<Goal>,
    /// Where the scene's movable parts are.
    pub poses: Vec<Pose>,
}

/// What a tick brought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moved {
    /// The tick that is answered.
    pub tick: u32,
    /// The state vector.
    pub state: Vec<f32>,
    /// Where the plant is.
    pub position: [f32; 2],
    /// How its switches stand.
    #[serde(default)]
    pub switches: u8,
    /// The goals, if they are not those of before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goals: Option<Vec<Goal>>,
    /// Where the scene's movable parts are.
    pub poses: Vec<Pose>,
    /// What the tick brought, in the plant's units.
    #[serde(default)]
    pub reward: f64,
    /// How it ended the episode, if it did.
    #[serde(default)]
    pub ending: Option<Ending>,
}

impl Ready {
    /// What was seen before the first tick.
    pub fn seen(self) -> (Scene, u32, Seen) {
        let Self { scene, pilot_goal, state, position, switches, goals, poses } = self;
        (scene, pilot_goal, Seen { state, position, switches, goals, poses, reward: 0.0, ending: None })
    }
}

impl Moved {
    /// What was seen after the tick, given the goals of before.
    pub fn seen(self, before: &[Goal]) -> Seen {
        let Self { state, position, switches, goals, poses, reward, ending, .. } = self;
        let goals = goals.unwrap_or_else(|| before.to_vec());
        Seen { state, position, switches, goals, poses, reward, ending }
    }
}

/// The line that begins an episode.
pub fn begin(begin: Begin) -> String {
    serde_json::json!({ "begin": begin }).to_string()
}

/// The line of a tick: a command's index, the axes' values, or null for nothing.
pub fn tick(tick: u32, action: Option<Action>, axes: usize) -> String {
    let action = match action {
        None => Value::Null,
        Some(Action::Command(command)) => command.into(),
        Some(Action::Axes(values)) => values[..axes.min(values.len())].into(),
    };
    serde_json::json!({ "tick": tick, "action": action }).to_string()
}

/// The line that ends an episode: the plant must do nothing from here on.
pub fn end(ending: Ending) -> String {
    serde_json::json!({ "end": ending.word() }).to_string()
}

/// Why a line of the plant is not what was asked for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WordsError {
    /// The plant has something to say instead: its own words.
    #[error("it says: {0}")]
    Told(String),
    /// It is not the protocol.
    #[error("{0}")]
    Garbled(String),
}

/// What a line of the plant says, or what is wrong with it.
pub fn read<T: DeserializeOwned>(line: &str) -> Result<T, WordsError> {
    let value: Value = serde_json::from_str(line).map_err(|error| {
        WordsError::Garbled(format!(
            "its line is no JSON ({error}; NaN and Infinity are none either): {}",
            shorten(line)
        ))
    })?;
    if let Some(words) = value.get("error").and_then(Value::as_str) {
        return Err(WordsError::Told(shorten(words)));
    }
    serde_json::from_value(value)
        .map_err(|error| format!("its line is not what was expected ({error}): {}", shorten(line)))
        .map_err(WordsError::Garbled)
}

fn shorten(text: &str) -> String {
    const SHOWN: usize = 120;
    let mut shown: String = text.chars().filter(|c| !c.is_control()).take(SHOWN).collect();
    if text.chars().count() > SHOWN {
        shown.push('…');
    }
    shown
}
