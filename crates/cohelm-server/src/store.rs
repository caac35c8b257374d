//! Where episodes and models are kept: one trait, whatever database lies behind it.
//!
//! A store knows nothing of sockets and flies nothing. What changes it goes through [`Store::commit`], a transaction
//! for a whole batch; the [`Writer`] gathers what many sockets write into few of them.

mod archive;
mod backup;
mod batch;
#[cfg(test)]
mod conformance;
mod copy;
mod driver;
mod error;
mod open;
mod postgres;
mod queries;
mod record;
mod rows;
mod sql;
mod sqlite;
mod study;
mod writer;

pub use archive::Archive;
pub use error::StoreError;
pub use open::{open, open_existing, restore};
pub use postgres::PostgresStore;
pub use record::{Record, unpack};
pub use sqlite::SqliteStore;
pub use study::{Participant, ParticipantId, StoredEvent, StoredStudy, Studies, TokenHash, Trial};
pub use writer::{COMMIT_EVERY, Writer};

use async_trait::async_trait;
use cohelm::plant::Ending;
use cohelm::trajectory::{Digests, Setup};
use cohelm_copilot::Model;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;

/// Number of an episode in its database: counts up from 1, never given twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct EpisodeId(pub i64);

impl fmt::Display for EpisodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// What the page calls a flight: random bytes of its own, with which it finds the flight again after a lost
/// connection. Whoever knows them may go on with the flight, so they are shown to nobody.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct FlightKey(pub [u8; 16]);

impl fmt::Debug for FlightKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("FlightKey(..)")
    }
}

/// A piece of a key log: the events before the ticks `from_tick..to_tick`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chunk {
    /// Ticks flown before it.
    pub from_tick: u32,
    /// Ticks flown after it.
    pub to_tick: u32,
    /// Digests of the whole flight after `to_tick` ticks.
    pub digests: Digests,
    /// Key events as [`put_event`](cohelm::trajectory::put_event) writes them, each with `from_tick ≤ tick < to_tick`.
    pub events: Vec<u8>,
}

/// Where a model came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// With the program.
    Shipped,
    /// From a file that somebody named.
    Given,
    /// Learned while people flew.
    Learned,
}

impl Origin {
    /// The word for it in the database.
    pub fn word(self) -> &'static str {
        match self {
            Self::Shipped => "shipped",
            Self::Given => "given",
            Self::Learned => "learned",
        }
    }
}

/// One change of what is stored.
#[derive(Clone, Debug)]
pub enum Write {
    /// Keeps a model under its hash; one that is there already stays as it is.
    Model {
        /// The model.
        model: Model,
        /// Where it came from.
        origin: Origin,
        /// Now, milliseconds since 1970.
        at_ms: i64,
    },
    /// A person chose to go on from a model, or, with `None`, no longer to go on from any of that plant.
    Keep {
        /// The plant whose models this concerns.
        plant: String,
        /// Hash of the model to go on from.
        hash: Option<String>,
        /// Now, milliseconds since 1970.
        at_ms: i64,
    },
    /// An episode begins. Its models must be stored.
    Begin {
        /// What the page calls it.
        key: FlightKey,
        /// What fixes it.
        setup: Setup,
        /// When it began, milliseconds since 1970.
        at_ms: i64,
    },
    /// A piece of its key log was followed; it must begin where the last one ended.
    Chunk {
        /// Of which episode.
        episode: EpisodeId,
        /// The piece.
        chunk: Chunk,
    },
    /// An episode in the air ended: its record takes the place of the pieces.
    Finish {
        /// Which episode.
        episode: EpisodeId,
        /// The record.
        record: Record,
        /// Now, milliseconds since 1970.
        at_ms: i64,
    },
    /// What the page says of an episode in the air is not what its key log gives.
    Refuse {
        /// Which episode.
        episode: EpisodeId,
        /// Why, for people.
        reason: String,
        /// Now, milliseconds since 1970.
        at_ms: i64,
    },
    /// A whole episode at once, such as a simulated one. Its models must be stored.
    Episode {
        /// The record.
        record: Record,
        /// When it was flown, milliseconds since 1970.
        at_ms: i64,
    },
    /// An episode that never flew a tick goes.
    Forget(EpisodeId),
    /// Like [`Begin`](Self::Begin), as part of a study.
    BeginTrial {
        /// What the page calls it.
        key: FlightKey,
        /// What fixes it.
        setup: Setup,
        /// When it began, milliseconds since 1970.
        at_ms: i64,
        /// Who flies, and which step of the session.
        trial: Trial,
    },
    /// Keeps a study's file under its hash; one that is there already stays as it is.
    Study {
        /// SHA-256 of the file, 64 hexadecimal digits.
        hash: String,
        /// The study's name.
        name: String,
        /// The file.
        text: String,
        /// Now, milliseconds since 1970.
        at_ms: i64,
    },
    /// A new participant. Its study must be stored.
    Participant {
        /// Its number, from [`Studies::free_participant_id`].
        id: ParticipantId,
        /// Hash of the study's file.
        study: String,
        /// What people call it; no other participant of the database may have the same.
        code: String,
        /// Of the secret in its link.
        token: TokenHash,
        /// Now, milliseconds since 1970.
        at_ms: i64,
    },
    /// A participant gets a new link, which voids the old one; or none.
    Link {
        /// Whose.
        participant: ParticipantId,
        /// Of the secret in the new link.
        token: Option<TokenHash>,
    },
    /// A participant's page was heard of.
    Seen {
        /// Whose.
        participant: ParticipantId,
        /// Now, milliseconds since 1970.
        at_ms: i64,
    },
    /// Something happened to a participant.
    Event {
        /// To whom.
        participant: ParticipantId,
        /// The place in the log that it is meant for: one after the newest event that the writer knew. Fails with
        /// [`StoreError::OutOfStep`] if another came first.
        expected_seq: u32,
        /// What, as JSON.
        event_json: String,
        /// Now, milliseconds since 1970.
        at_ms: i64,
    },
    /// A participant withdraws: episodes, records, pieces of key logs, events and the link go, their bytes are
    /// overwritten, and number, code and this time stay.
    Withdraw {
        /// Who.
        participant: ParticipantId,
        /// What the log says from then on, as JSON, numbered from 1; it may hold nothing of the person.
        left: Vec<String>,
        /// Now, milliseconds since 1970.
        at_ms: i64,
    },
    /// Remembers a value under a name, in place of what was there.
    Setting {
        /// The name.
        name: String,
        /// The value.
        value: String,
    },
}

/// How far an episode is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "state", rename_all = "kebab-case")]
pub enum Progress {
    /// In the air, or interrupted and not taken up again.
    InTheAir,
    /// Finished, and its record kept.
    Finished {
        /// How it ended.
        ending: Ending,
    },
    /// Its log was not believed.
    Refused {
        /// Why.
        reason: String,
    },
}

/// An episode as lists show it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Episode {
    /// Its number.
    pub id: EpisodeId,
    /// How far it is.
    #[serde(flatten)]
    pub progress: Progress,
    /// Ticks flown; of one in the air, those that are committed.
    pub ticks: u32,
    /// The plant.
    pub plant: String,
    /// Version of the plant.
    pub plant_version: u32,
    /// Format of its record.
    pub format: u8,
    /// Version of cohelm that wrote it.
    pub program: String,
    /// The rule's word.
    pub rule: String,
    /// The episode's seed.
    pub seed: u64,
    /// `person`, or the name of a simulated pilot.
    pub pilot: String,
    /// How fast the world went: 1 is real time.
    pub time_scale: f64,
    /// Hash of the value model.
    pub values: Option<String>,
    /// Hash of the intent model.
    pub intent: Option<String>,
    /// The whole setup, as it was written; of another version it may have other fields than [`Setup`].
    pub setup: serde_json::Value,
    /// When it began, milliseconds since 1970.
    pub started_at_ms: i64,
    /// When it ended, milliseconds since 1970.
    pub ended_at_ms: Option<i64>,
    /// Which part of a study it is; `None` outside of studies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trial: Option<Trial>,
}

/// A model as lists show it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StoredModel {
    /// SHA-256 of its bytes.
    pub hash: String,
    /// Where it came from: a word of [`Origin`], or one of a later version.
    pub origin: String,
    /// What it is for: `values` or `intent`.
    pub kind: String,
    /// Its name.
    pub name: String,
    /// The plant it flies.
    pub plant: String,
    /// Its card.
    pub card: serde_json::Value,
    /// When it was stored, milliseconds since 1970.
    pub stored_at_ms: i64,
    /// When a person chose to go on from it, if that still holds.
    pub kept_at_ms: Option<i64>,
}

/// Which part of the list of episodes: at most `limit` of those with a smaller number than `before`, newest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Page {
    /// The number to begin below; `None` for the newest.
    pub before: Option<EpisodeId>,
    /// Most episodes to give.
    pub limit: u32,
}

impl Page {
    /// From the newest on, at most `limit`.
    pub fn newest(limit: u32) -> Self {
        Self { before: None, limit }
    }
}

/// A database of episodes and models, and through [`Studies`] of studies. Many methods, since a list, a row and a blob are
/// three things of each noun; one writes, the others only read.
#[async_trait]
pub trait Store: Studies {
    /// Carries out all changes, in order, in one transaction: all of them or, on an error, none. Once it returns they
    /// survive the loss of power. Gives for each change the episode it made ([`Write::Begin`], [`Write::BeginTrial`],
    /// [`Write::Episode`]).
    ///
    /// After [`StoreError::Gone`] the changes may have been carried out or not: the server was lost before it answered.
    /// Whoever goes on reads first.
    async fn commit(&self, writes: &[Write]) -> Result<Vec<Option<EpisodeId>>, StoreError>;

    /// A part of the list of episodes, newest first.
    async fn episodes(&self, page: Page) -> Result<Vec<Episode>, StoreError>;

    /// One episode.
    async fn episode(&self, id: EpisodeId) -> Result<Option<Episode>, StoreError>;

    /// The episode that the page calls by this key.
    async fn flight(&self, key: FlightKey) -> Result<Option<Episode>, StoreError>;

    /// The record of a finished episode, packed: [`unpack`] opens it.
    async fn record(&self, id: EpisodeId) -> Result<Option<Vec<u8>>, StoreError>;

    /// What is committed of the key log of an episode that is not finished, in the order of ticks.
    async fn chunks(&self, id: EpisodeId) -> Result<Vec<Chunk>, StoreError>;

    /// All models, in the order in which they were stored.
    async fn models(&self) -> Result<Vec<StoredModel>, StoreError>;

    /// The bytes of a model.
    async fn model(&self, hash: &str) -> Result<Option<Vec<u8>>, StoreError>;

    /// Fails if the database cannot be read.
    async fn check(&self) -> Result<(), StoreError>;

    /// Writes everything that is stored into a new SQLite file, while others go on reading and writing: the state of one
    /// moment, whatever kind of database this is. A file that is there already is left as it is.
    async fn backup(&self, to: &Path) -> Result<(), StoreError>;

    /// Closes all connections; what is not in the main file of a SQLite database yet goes there.
    async fn close(&self);
}

/// Milliseconds since 1970 by this machine's clock.
pub fn now_ms() -> i64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.map_or(0, |since| since.as_millis() as i64)
}
