//! What can go wrong with a database, in the words of whoever has to put it right.
//!
//! Every message that concerns a whole database names it, so that nobody who passes an error on has to.

use super::{EpisodeId, ParticipantId};
use cohelm::trajectory::TrajectoryError;
use std::path::PathBuf;

/// Why a store did not do what it was told. `database` is its file or its address without the password.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StoreError {
    /// There is none.
    #[error("there is no database {database}; check its name (`cohelm fly` and `cohelm study run` make one)")]
    Missing {
        /// Where it should be.
        database: String,
    },
    /// The folder cannot be made or written, or the file cannot be opened.
    #[error(
        "cannot open or write the database {database}: {reason}; check that its folder exists and may be written, or name another with --database"
    )]
    Unwritable {
        /// Which database.
        database: String,
        /// What the system says.
        reason: String,
    },
    /// Something else is in that file.
    #[error("{database} is no database of cohelm, and is left as it is; name another with --database")]
    Foreign {
        /// Which database.
        database: String,
    },
    /// It was one, but part of it is gone or overwritten.
    #[error(
        "the database {database} is damaged ({reason}); keep a copy and go on from a backup, or name another with --database"
    )]
    Damaged {
        /// Which database.
        database: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A later version of cohelm wrote it.
    #[error(
        "the database {database} was written by a newer cohelm (schema {found}, this program knows up to {known}); use that version, or name another with --database"
    )]
    Newer {
        /// Which database.
        database: String,
        /// Its newest migration.
        found: i64,
        /// The newest migration known here.
        known: i64,
    },
    /// Somebody else has been writing for too long.
    #[error(
        "the database {database} is locked: another program has been writing to it for more than {waited_s} s; close that one, or name another with --database"
    )]
    Locked {
        /// Which database.
        database: String,
        /// How long was waited, seconds.
        waited_s: u64,
    },
    /// No room is left.
    #[error(
        "the disk of the database {database} is full; nothing was lost that was acknowledged: make room and go on"
    )]
    Full {
        /// Which database.
        database: String,
    },
    /// The database server cannot be reached.
    #[error(
        "the server of the database {database} does not answer ({reason}); nothing was lost that was acknowledged: start it and go on, or name another with --database"
    )]
    Gone {
        /// Which database.
        database: String,
        /// What the network or the server says.
        reason: String,
    },
    /// The database server answers, and says no.
    #[error(
        "the server of the database {database} lets nobody in: {reason}; check user, password and the name of the database"
    )]
    NoEntry {
        /// Which database.
        database: String,
        /// The server's words.
        reason: String,
    },
    /// The database server offers no encryption, or none that can be trusted.
    #[error(
        "the connection to the database {database} cannot be encrypted: {reason}; give the server a certificate that this machine trusts, or, if the network between them is yours, add ?sslmode=disable to the address"
    )]
    NotEncrypted {
        /// Which database.
        database: String,
        /// What went wrong.
        reason: String,
    },
    /// The database was set up in a way that would lose something.
    #[error("the database {database} does not suit: {reason}")]
    Unsuitable {
        /// Which database.
        database: String,
        /// Why, and what to do.
        reason: String,
    },
    /// A backup would be mixed with something else.
    #[error("the database {database} is not empty; restore into a new one")]
    NotEmpty {
        /// Which database.
        database: String,
    },
    /// It is neither a file nor an address that means something here.
    #[error("{database} names no database: give a file, or postgres://USER@HOST/DATABASE ({reason})")]
    Address {
        /// What was given, without the password.
        database: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A backup would overwrite something.
    #[error("{} is there already, and is left as it is; name a new file for the backup", path.display())]
    Exists {
        /// Which file.
        path: PathBuf,
    },
    /// A change does not fit what is stored: a piece that does not follow the last one, an end of what is not in the
    /// air.
    #[error(
        "episode {episode}: {what} does not fit what is stored of it; another connection may have gone on with it"
    )]
    Misplaced {
        /// Which episode.
        episode: EpisodeId,
        /// Which change.
        what: &'static str,
    },
    /// A flight of that key exists.
    #[error("a flight of this key has begun already")]
    KeyInUse,
    /// An episode names a model that is not stored.
    #[error("the episode names a model that is not stored; store the model before its first episode")]
    ModelNotStored,
    /// A participant's study is not stored.
    #[error("the participant's study is not stored; store the study before its first participant")]
    StudyNotStored,
    /// Number, code or link of a new participant are another's.
    #[error("another participant has this number, code or link; make it with others")]
    ParticipantExists,
    /// There is no such participant.
    #[error("there is no participant {0}")]
    NoParticipant(ParticipantId),
    /// The participant withdrew; nothing is added to a tombstone.
    #[error("participant {0} has withdrawn; nothing more is stored of this person")]
    Withdrawn(ParticipantId),
    /// Something else happened to the participant since the writer read the log.
    #[error(
        "event {expected} of participant {participant} cannot follow event {last}, the newest; read the log again"
    )]
    OutOfStep {
        /// Whose log.
        participant: ParticipantId,
        /// The place that the event was meant for.
        expected: u32,
        /// Number of the newest event.
        last: u32,
    },
    /// A stored value is not what it should be, or a value cannot be stored.
    #[error("{what} in the database has an impossible value: {value}")]
    Value {
        /// Where.
        what: &'static str,
        /// What it holds.
        value: String,
    },
    /// A stored record cannot be read.
    #[error("the record cannot be read: {0}")]
    Record(#[from] TrajectoryError),
    /// A stored record cannot be unpacked.
    #[error("the record cannot be unpacked: {0}")]
    Unpack(String),
    /// The writer has stopped.
    #[error("the server is stopping and writes nothing more")]
    Stopping,
    /// Anything else that the database says.
    #[error("the database {database} failed: {reason}")]
    Other {
        /// Which database.
        database: String,
        /// Its words.
        reason: String,
    },
}

impl StoreError {
    /// True if a single change did not fit; false if nothing at all could be written.
    pub fn is_about_one_write(&self) -> bool {
        matches!(
            self,
            Self::Misplaced { .. }
                | Self::KeyInUse
                | Self::ModelNotStored
                | Self::StudyNotStored
                | Self::ParticipantExists
                | Self::NoParticipant(_)
                | Self::Withdrawn(_)
                | Self::OutOfStep { .. }
                | Self::Value { .. }
        )
    }
}
