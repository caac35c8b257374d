//! What else the page is told, as JSON: models taken in, digests, replays.

use cohelm::flight::Replay;
use cohelm::trajectory::Digests;
use cohelm_copilot::{Kind, Model};
use serde::Serialize;

/// A model that the page has.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ModelReport {
    /// SHA-256 of its bytes, in hexadecimal: what setups name it by.
    pub hash: String,
    /// What its card calls it.
    pub name: String,
    /// What it is for.
    pub kind: Kind,
}

impl ModelReport {
    /// Of a model.
    pub fn of(model: &Model) -> Self {
        let card = model.card();
        Self { hash: model.hash().into(), name: card.name.clone(), kind: card.kind }
    }
}

/// The digests of a flight so far, in hexadecimal: what the server must find when it follows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DigestReport {
    /// Ticks they cover.
    pub ticks: u32,
    /// Of states, rewards and ending.
    pub plant: String,
    /// Of beliefs, values and executed actions.
    pub decisions: String,
}

impl DigestReport {
    /// Of a flight so far.
    pub fn of(ticks: u32, digests: Digests) -> Self {
        let hex = |digest: u64| format!("{digest:016x}");
        Self { ticks, plant: hex(digests.plant), decisions: hex(digests.decisions) }
    }
}

/// What flying a record again showed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ReplayReport {
    /// True if nothing that was checked differed.
    pub identical: bool,
    /// What was carried out leads through the same states to the same ending.
    pub plant_identical: bool,
    /// What was asked leads to the same decisions; `None` if that could not be checked.
    pub decisions_identical: Option<bool>,
    /// The key log gives the same requests; `None` without a person's keys.
    pub requests_identical: Option<bool>,
}

impl From<Replay> for ReplayReport {
    fn from(replay: Replay) -> Self {
        Self {
            identical: replay.identical(),
            plant_identical: replay.plant_identical,
            decisions_identical: replay.decisions_identical,
            requests_identical: replay.requests_identical,
        }
    }
}
