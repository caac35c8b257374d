//! What can go wrong with a database, in the words of whoever has to put it right.

use super::EpisodeId;
use cohelm::trajectory::TrajectoryError;
use std::path::PathBuf;

/// Why a store did not do what it was told.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StoreError {
    /// There is none.
    #[error("there is no database {}; the first flight makes one (cohelm fly), or name another with --database", path.display())]
    Missing {
        /// Where it should be.
        path: PathBuf,
    },
    /// The folder cannot be made or written, or the file cannot be opened.
    #[error("cannot open or write the database {}: {reason}; check that its folder exists and may be written, or name another with --database", path.display())]
    Unwritable {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// Something else is in that file.
    #[error("{} is no database of cohelm, and is left as it is; name another file with --database", path.display())]
    Foreign {
        /// Which file.
        path: PathBuf,
    },
    /// It was one, but part of it is gone or overwritten.
    #[error("the database {} is damaged ({reason}); keep a copy, then try `sqlite3 FILE .recover`, or name another with --database", path.display())]
    Damaged {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A later version of cohelm wrote it.
    #[error("the database {} was written by a newer cohelm (schema {found}, this program knows up to {known}); use that version, or name another file with --database", path.display())]
    Newer {
        /// Which file.
        path: PathBuf,
        /// Its newest migration.
        found: i64,
        /// The newest migration known here.
        known: i64,
    },
    /// Somebody else has been writing for too long.
    #[error("the database {} is locked: another program has been writing to it for more than {waited_s} s; close that one, or name another file with --database", path.display())]
    Locked {
        /// Which file.
        path: PathBuf,
        /// How long was waited, seconds.
        waited_s: u64,
    },
    /// No room is left.
    #[error("the disk of the database {} is full; nothing was lost that was acknowledged: make room and go on", path.display())]
    Full {
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
    /// A stored value is not what it should be.
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
    #[error("the database {}: {reason}", path.display())]
    Other {
        /// Which file.
        path: PathBuf,
        /// Its words.
        reason: String,
    },
}

impl StoreError {
    /// True if a single change did not fit; false if nothing at all could be written.
    pub fn is_about_one_write(&self) -> bool {
        matches!(self, Self::Misplaced { .. } | Self::KeyInUse | Self::ModelNotStored | Self::Value { .. })
    }
}
