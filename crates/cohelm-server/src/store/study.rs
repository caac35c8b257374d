//! What a store keeps of a study: its file, its participants, what happened to each of them, and which flights are
//! whose. The store does not know what the events mean.

use super::{Episode, StoreError};
use async_trait::async_trait;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Number of a participant in its database: counts up from 1, never given twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ParticipantId(pub i64);

impl fmt::Display for ParticipantId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// SHA-256 of the secret in a participant's link. The secret itself is never stored.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct TokenHash(pub [u8; 32]);

impl fmt::Debug for TokenHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("TokenHash(..)")
    }
}

/// Which part of a study a flight is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trial {
    /// Who flies.
    pub participant: ParticipantId,
    /// The step of the session.
    pub step: String,
}

/// One version of a study's file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StoredStudy {
    /// SHA-256 of the file.
    pub hash: String,
    /// The study's name; another version of the file may have the same.
    pub name: String,
    /// The file.
    pub text: String,
    /// When it was stored, milliseconds since 1970.
    pub stored_at_ms: i64,
}

/// A participant as lists show it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Participant {
    /// Its number.
    pub id: ParticipantId,
    /// Hash of the study's file for which it was made.
    pub study: String,
    /// What people call it.
    pub code: String,
    /// When it was made, milliseconds since 1970.
    pub created_at_ms: i64,
    /// When its page was last heard of, milliseconds since 1970.
    pub seen_at_ms: Option<i64>,
    /// Number of its newest event; 0 if there is none.
    pub last_seq: u32,
    /// When it withdrew, milliseconds since 1970: then this row and what [`Write::Withdraw`](super::Write::Withdraw) put
    /// into its log are all that is left.
    pub withdrawn_at_ms: Option<i64>,
}

/// Something that happened to a participant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredEvent {
    /// Its place in the log, from 1.
    pub seq: u32,
    /// When, milliseconds since 1970 by the server's clock; times need not ascend.
    pub at_ms: i64,
    /// What, as JSON.
    pub json: String,
}

/// Reading what belongs to studies; [`Store::commit`](super::Store::commit) writes it.
#[async_trait]
pub trait Studies: Send + Sync {
    /// All versions of all studies, in the order in which they were stored.
    async fn studies(&self) -> Result<Vec<StoredStudy>, StoreError>;

    /// The study's file of this hash.
    async fn study(&self, hash: &str) -> Result<Option<StoredStudy>, StoreError>;

    /// The participants who were made for the file of this hash, in the order of their numbers.
    async fn participants(&self, study: &str) -> Result<Vec<Participant>, StoreError>;

    /// One participant.
    async fn participant(&self, id: ParticipantId) -> Result<Option<Participant>, StoreError>;

    /// The participant whose link holds the secret of this hash.
    async fn participant_by_token(&self, token: TokenHash) -> Result<Option<Participant>, StoreError>;

    /// The smallest number that no participant ever had.
    async fn free_participant_id(&self) -> Result<ParticipantId, StoreError>;

    /// What happened to a participant after the event of this number (0 for everything), in order.
    async fn events(
        &self,
        participant: ParticipantId,
        after_seq: u32,
    ) -> Result<Vec<StoredEvent>, StoreError>;

    /// A participant's flights, in the order in which they began.
    async fn trials(&self, participant: ParticipantId) -> Result<Vec<Episode>, StoreError>;

    /// What was stored under a name by [`Write::Setting`](super::Write::Setting).
    async fn setting(&self, name: &str) -> Result<Option<String>, StoreError>;
}
