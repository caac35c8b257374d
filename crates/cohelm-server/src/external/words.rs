//! What page and server say to each other while a plant elsewhere is flown: one JSON value a text message.

use cohelm::arbitration::Rule;
use cohelm::keys::Change;
use cohelm::plant::Ending;
use cohelm::report::{Opening, TickReport};
use serde::{Deserialize, Serialize};

/// What a page says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum FromPage {
    /// Get the plant ready for an episode; one that was ready before and has not started is given up.
    Begin(Wish),
    /// Fly.
    Start,
    /// A control or stick changed.
    Change {
        /// What was done.
        change: Change,
        /// When, by the page's clock, ms since the start; decides nothing.
        at_ms: f32,
    },
    /// The person is still there and sees the plant. The page says so ten times a second, and whenever it has shown a few
    /// ticks more, while it flies, is to be seen and has the focus.
    Here {
        /// The newest tick that it has shown.
        shown: Option<u32>,
    },
    /// End the flight.
    Stop,
}

/// How an episode is to be flown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wish {
    /// For whatever is random about it.
    pub seed: u64,
    /// The rule of arbitration.
    pub rule: Rule,
}

/// What the server says.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToPage {
    /// The plant is ready.
    Ready(Box<Ready>),
    /// The newest tick; those that a slow page has not taken are left out.
    Tick(Box<Flown>),
    /// The episode ended and is stored.
    Ended(Ended),
    /// It cannot be flown.
    Refused {
        /// Why, for people.
        reason: String,
    },
}

/// A plant that is ready.
#[derive(Clone, Debug, Serialize)]
pub struct Ready {
    /// Its own name.
    pub name: String,
    /// True if it has axes, for which a stick can be drawn.
    pub has_axes: bool,
    /// True if values were found that fit it; otherwise the person flies alone, whatever the rule.
    pub has_values: bool,
    /// Why the person flies alone, for people.
    pub why_alone: Option<String>,
    /// What to draw and to press.
    pub opening: Opening,
}

/// A tick that was flown.
#[derive(Clone, Debug, Serialize)]
pub struct Flown {
    /// Every stage of it.
    pub report: TickReport,
    /// Ticks so far that came late.
    pub late: u32,
    /// True while everything is let go of since nothing was heard from the page, or it showed nothing newer. That lasts
    /// until the page has shown a tick of which this was true: what is held must be pressed again.
    pub let_go: bool,
}

/// How an episode ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ended {
    /// How.
    pub ending: Ending,
    /// Why it was abandoned, if that was nobody's wish.
    pub why: Option<String>,
    /// Ticks it lasted.
    pub ticks: u32,
    /// Ticks at which something was asked.
    pub commands: u32,
    /// Those of them at which something of another effect was carried out.
    pub corrected: u32,
    /// Ticks that came late.
    pub late: u32,
    /// Its number; none if it ended before its first tick, or could not be stored.
    pub episode: Option<i64>,
}
