//! What page and server say to each other over the WebSocket, as bytes: one message a binary frame.
//!
//! Byte 0 is the version, byte 1 the kind; numbers are little-endian; what is of variable length comes last and goes to
//! the end of the frame. `docs/records.md` has an example of each, written by a test. Reading never panics and
//! allocates no more than the frame that came.

mod reader;
#[cfg(test)]
mod tests;

use crate::follow::End;
use crate::store::{Chunk, EpisodeId, FlightKey};
use cohelm::plant::Ending;
use cohelm::trajectory::{Digests, Setup};
use reader::Reader;
use serde::{Deserialize, Serialize};

/// Version of these messages. Whoever changes their meaning counts it up.
pub const PROTOCOL_VERSION: u8 = 1;
/// Most bytes of a message from the page: six thousand key events, or what a minute of a moved stick gives.
pub const MAX_MESSAGE: usize = 64 * 1024;
/// Most bytes of a setup.
pub const MAX_SETUP: usize = 16 * 1024;
/// Most bytes of a reason.
pub const MAX_REASON: usize = 1024;

const BEGIN: u8 = 1;
const CHUNK: u8 = 2;
const END: u8 = 3;
const WELCOME: u8 = 129;
const BEGUN: u8 = 130;
const ACK: u8 = 131;
const REFUSED: u8 = 132;
const FINISHED: u8 = 133;
const NEW_MODEL: u8 = 134;

/// What a page says.
#[derive(Clone, Debug, PartialEq)]
pub enum FromPage {
    /// A flight begins, or goes on after a lost connection: the key tells.
    Begin(Begin),
    /// A piece of its key log.
    Chunk(Chunk),
    /// It ended.
    End(End),
}

/// The beginning of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Begin {
    /// The page's random name for the flight; the same when it goes on with it.
    pub key: FlightKey,
    /// How long ago it began, milliseconds: a flight may begin while the network is away.
    pub age_ms: u32,
    /// What fixes it.
    pub setup: Setup,
}

/// What the server says.
#[derive(Clone, Debug, PartialEq)]
pub enum ToPage {
    /// First of all.
    Welcome(Welcome),
    /// The flight is followed from here on: the page sends what comes after `committed_tick`.
    Begun {
        /// Its number.
        episode: EpisodeId,
        /// Ticks that are followed and stored: 0 for a new flight.
        committed_tick: u32,
    },
    /// So many ticks are followed and stored for good.
    Ack {
        /// How many.
        committed_tick: u32,
    },
    /// The flight is not believed, or cannot be flown here; what the page still sends of it is ignored.
    Refused {
        /// Why, for people.
        reason: String,
    },
    /// The flight was followed to its end, bit for bit, and its record is stored for good.
    Finished {
        /// Its number.
        episode: EpisodeId,
    },
    /// Other values assist from the next flight on.
    NewModel {
        /// SHA-256 of their file.
        hash: [u8; 32],
    },
}

/// What the server says of itself. JSON, so that later versions may say more.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Welcome {
    /// Version of cohelm.
    pub cohelm: String,
    /// Format of records.
    pub format: u8,
    /// True if the values learn while people fly.
    pub learning: bool,
    /// SHA-256, in hexadecimal, of the values that assist now, if they learn.
    pub values: Option<String>,
}

/// Why bytes are no message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProtocolError {
    /// Another version.
    #[error("the message has version {0}, this server speaks {PROTOCOL_VERSION}; reload the page")]
    Version(u8),
    /// No such kind.
    #[error("there is no message of kind {0}")]
    Kind(u8),
    /// Too few bytes.
    #[error("the message is cut off")]
    CutOff,
    /// Too many.
    #[error("the message has {0} bytes more than it should")]
    TooLong(usize),
    /// Far too many.
    #[error("a message may have {most} bytes, this one has {bytes}")]
    TooLarge {
        /// How many.
        bytes: usize,
        /// How many it may have.
        most: usize,
    },
    /// Text or JSON that is none, or a setup that is none.
    #[error("the {what} cannot be read: {reason}")]
    Text {
        /// Which part.
        what: &'static str,
        /// Why.
        reason: String,
    },
    /// An ending that there is not.
    #[error("there is no ending {0}")]
    Ending(u8),
}

impl FromPage {
    /// The bytes of the message.
    pub fn to_bytes(&self) -> Vec<u8> {
        match self {
            Self::Begin(begin) => {
                let setup =
                    serde_json::to_vec(&begin.setup).expect("a setup of strings and numbers has a JSON form");
                message(BEGIN, &[&begin.key.0, &begin.age_ms.to_le_bytes(), &setup])
            }
            Self::Chunk(chunk) => message(
                CHUNK,
                &[
                    &chunk.from_tick.to_le_bytes(),
                    &chunk.to_tick.to_le_bytes(),
                    &digest_bytes(chunk.digests),
                    &chunk.events,
                ],
            ),
            Self::End(end) => {
                message(END, &[&end.ticks.to_le_bytes(), &[end.ending as u8], &digest_bytes(end.digests)])
            }
        }
    }

    /// The message of these bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ProtocolError> {
        let (kind, mut reader) = open(bytes)?;
        let message = match kind {
            BEGIN => Self::Begin(Begin {
                key: FlightKey(reader.array()?),
                age_ms: reader.u32()?,
                setup: setup(reader.rest())?,
            }),
            CHUNK => Self::Chunk(Chunk {
                from_tick: reader.u32()?,
                to_tick: reader.u32()?,
                digests: digests(&mut reader)?,
                events: reader.rest().to_vec(),
            }),
            END => Self::End(End {
                ticks: reader.u32()?,
                ending: ending(reader.byte()?)?,
                digests: digests(&mut reader)?,
            }),
            other => return Err(ProtocolError::Kind(other)),
        };
        reader.end()?;
        Ok(message)
    }
}

impl ToPage {
    /// The bytes of the message. A reason is cut to [`MAX_REASON`] bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        match self {
            Self::Welcome(welcome) => {
                let json = serde_json::to_vec(welcome).expect("strings and numbers have a JSON form");
                message(WELCOME, &[&json])
            }
            Self::Begun { episode, committed_tick } => {
                message(BEGUN, &[&episode.0.to_le_bytes(), &committed_tick.to_le_bytes()])
            }
            Self::Ack { committed_tick } => message(ACK, &[&committed_tick.to_le_bytes()]),
            Self::Refused { reason } => message(REFUSED, &[cut(reason, MAX_REASON).as_bytes()]),
            Self::Finished { episode } => message(FINISHED, &[&episode.0.to_le_bytes()]),
            Self::NewModel { hash } => message(NEW_MODEL, &[hash]),
        }
    }

    /// The message of these bytes: what a page, or a test, reads.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ProtocolError> {
        let (kind, mut reader) = open(bytes)?;
        let message = match kind {
            WELCOME => Self::Welcome(json("welcome", reader.rest())?),
            BEGUN => Self::Begun { episode: EpisodeId(reader.i64()?), committed_tick: reader.u32()? },
            ACK => Self::Ack { committed_tick: reader.u32()? },
            REFUSED => Self::Refused { reason: text("reason", reader.rest())? },
            FINISHED => Self::Finished { episode: EpisodeId(reader.i64()?) },
            NEW_MODEL => Self::NewModel { hash: reader.array()? },
            other => return Err(ProtocolError::Kind(other)),
        };
        reader.end()?;
        Ok(message)
    }
}

/// The beginning of a text, at most so many bytes of it, cut between characters.
pub(crate) fn cut(text: &str, most: usize) -> &str {
    &text[..text.floor_char_boundary(most)]
}

fn message(kind: u8, parts: &[&[u8]]) -> Vec<u8> {
    let mut bytes = vec![PROTOCOL_VERSION, kind];
    parts.iter().for_each(|part| bytes.extend_from_slice(part));
    bytes
}

fn open(bytes: &[u8]) -> Result<(u8, Reader<'_>), ProtocolError> {
    at_most(bytes, MAX_MESSAGE)?;
    let mut reader = Reader::new(bytes);
    let version = reader.byte()?;
    if version != PROTOCOL_VERSION {
        return Err(ProtocolError::Version(version));
    }
    Ok((reader.byte()?, reader))
}

fn at_most(bytes: &[u8], most: usize) -> Result<(), ProtocolError> {
    if bytes.len() > most { Err(ProtocolError::TooLarge { bytes: bytes.len(), most }) } else { Ok(()) }
}

fn setup(bytes: &[u8]) -> Result<Setup, ProtocolError> {
    at_most(bytes, MAX_SETUP)?;
    json("setup", bytes)
}

fn json<T: for<'a> Deserialize<'a>>(what: &'static str, bytes: &[u8]) -> Result<T, ProtocolError> {
    serde_json::from_slice(bytes).map_err(|error| ProtocolError::Text { what, reason: error.to_string() })
}

fn text(what: &'static str, bytes: &[u8]) -> Result<String, ProtocolError> {
    let text = std::str::from_utf8(bytes);
    text.map(str::to_owned).map_err(|error| ProtocolError::Text { what, reason: error.to_string() })
}

fn digest_bytes(digests: Digests) -> [u8; 16] {
    let mut bytes = [0; 16];
    bytes[..8].copy_from_slice(&digests.plant.to_le_bytes());
    bytes[8..].copy_from_slice(&digests.decisions.to_le_bytes());
    bytes
}

fn digests(reader: &mut Reader<'_>) -> Result<Digests, ProtocolError> {
    Ok(Digests { plant: reader.u64()?, decisions: reader.u64()? })
}

fn ending(index: u8) -> Result<Ending, ProtocolError> {
    Ending::ALL.get(usize::from(index)).copied().ok_or(ProtocolError::Ending(index))
}
