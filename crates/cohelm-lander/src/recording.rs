//! Files of recorded Gymnasium flights, and flying them again.
//!
//! A file is JSON lines, gzipped or not: one object a line, one line an episode, as `tests/data/record_gymnasium.py` writes:
//!
//! | field | | |
//! |---|---|---|
//! | `seed` | integer, 0 to 2⁶⁴−1 | `env.reset(seed=seed)` |
//! | `continuous` | bool | actions are pairs instead of numbers 0 to 3 |
//! | `wind` | bool | `enable_wind` |
//! | `gravity`, `wind_power`, `turbulence_power` | number, optional | −10, 15 and 1.5 unless given |
//! | `terrain` | 11 numbers | smoothed heights of the ground, world units, left to right |
//! | `actions` | n entries | 0 to 3, or `[main, lateral]` |
//! | `observations` | n + 1 rows of 8 | `f32` widened; row 0 is what `reset` returned |
//! | `rewards` | n numbers | `f64` |
//! | `terminated`, `truncated` | bool | of the last step |
//!
//! Other fields are ignored. Every number must be finite.

mod verify;

pub use verify::{Difference, Place, Report, verify};

use std::io::{BufRead, BufReader, Read};

use flate2::read::MultiGzDecoder;
use serde::Deserialize;

use crate::gymnasium::{Action, GymnasiumOptions};

/// Longest line that is read: an episode of 1000 steps takes a twentieth of it.
const MAX_LINE_BYTES: u64 = 4 << 20;
/// The first two bytes of every gzip file.
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Why a file is not a recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// Reading failed, or the gzip stream is damaged.
    #[error(
        "line {line} cannot be read ({source}): is the file complete, and a recording in .jsonl or .jsonl.gz?"
    )]
    Read {
        /// Counted from 1.
        line: usize,
        /// What the reader said.
        source: std::io::Error,
    },
    /// A line is too long to be an episode.
    #[error("line {line} is longer than {MAX_LINE_BYTES} bytes: a recording has one episode a line")]
    TooLong {
        /// Counted from 1.
        line: usize,
    },
    /// A line is not the JSON of an episode.
    #[error("line {line} is not an episode in JSON: {source}")]
    Json {
        /// Counted from 1.
        line: usize,
        /// What the parser said.
        source: serde_json::Error,
    },
    /// Fields do not fit together.
    #[error("line {line}: {problem}")]
    Shape {
        /// Counted from 1.
        line: usize,
        /// What was expected and what came.
        problem: String,
    },
    /// There is no line at all.
    #[error("there is no episode in the file")]
    Empty,
}

/// One recorded episode; shapes are checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// `env.reset(seed=seed)`.
    pub seed: u64,
    /// How the environment was made.
    pub options: GymnasiumOptions,
    /// Smoothed heights of the ground, world units.
    pub terrain: [f64; 11],
    /// One for each step.
    pub actions: Vec<Action>,
    /// One row more than actions: after `reset`, then after each step.
    pub observations: Vec<[f64; 8]>,
    /// One for each step.
    pub rewards: Vec<f64>,
    /// Whether the last step ended the episode.
    pub terminated: bool,
    /// Whether the time limit cut it off at the last step.
    pub truncated: bool,
}

/// The line as it is written.
#[derive(Deserialize)]
struct Line {
    seed: u64,
    continuous: bool,
    wind: bool,
    gravity: Option<f64>,
    wind_power: Option<f64>,
    turbulence_power: Option<f64>,
    terrain: [f64; 11],
    actions: Vec<ActionEntry>,
    observations: Vec<[f64; 8]>,
    rewards: Vec<f64>,
    terminated: bool,
    truncated: bool,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(untagged)]
enum ActionEntry {
    Discrete(u8),
    Continuous([f64; 2]),
}

impl ActionEntry {
    fn action(self, continuous: bool) -> Result<Action, String> {
        match self {
            ActionEntry::Discrete(index) if !continuous => Action::DISCRETE
                .get(usize::from(index))
                .copied()
                .ok_or_else(|| format!("action {index} is none of 0, 1, 2, 3")),
            ActionEntry::Continuous(pair) if continuous => {
                let narrow = pair.map(|value| value as f32);
                if narrow.map(f64::from) == pair {
                    Ok(Action::Throttles(narrow))
                } else {
                    Err(format!("action {pair:?} is not a pair of 32-bit numbers"))
                }
            }
            ActionEntry::Discrete(index) => {
                Err(format!("action {index} is not a pair, though continuous is true"))
            }
            ActionEntry::Continuous(pair) => {
                Err(format!("action {pair:?} is not a whole number, though continuous is false"))
            }
        }
    }
}

impl Flight {
    /// Of one line of a file, without its line feed.
    fn parse(text: &[u8], line: usize) -> Result<Flight, RecordingError> {
        let read: Line =
            serde_json::from_slice(text).map_err(|source| RecordingError::Json { line, source })?;
        Flight::checked(read).map_err(|problem| RecordingError::Shape { line, problem })
    }

    fn checked(line: Line) -> Result<Flight, String> {
        let steps = line.actions.len();
        if line.observations.len() != steps + 1 || line.rewards.len() != steps {
            return Err(format!(
                "{steps} actions need {} observations and {steps} rewards, but there are {} and {}",
                steps + 1,
                line.observations.len(),
                line.rewards.len()
            ));
        }
        let actions: Result<_, _> = line.actions.iter().map(|entry| entry.action(line.continuous)).collect();
        let usual = GymnasiumOptions::default();
        Ok(Flight {
            seed: line.seed,
            options: GymnasiumOptions {
                gravity: line.gravity.unwrap_or(usual.gravity),
                enable_wind: line.wind,
                wind_power: line.wind_power.unwrap_or(usual.wind_power),
                turbulence_power: line.turbulence_power.unwrap_or(usual.turbulence_power),
            },
            terrain: line.terrain,
            actions: actions?,
            observations: line.observations,
            rewards: line.rewards,
            terminated: line.terminated,
            truncated: line.truncated,
        })
    }
}

/// The episodes of a file, one after another; after an error there are no more.
pub struct Flights<R> {
    lines: BufReader<Unpacked<R>>,
    line: usize,
    failed: bool,
}

/// Bytes that were read to tell the format, then the rest.
type Source<R> = std::io::Chain<std::io::Cursor<Vec<u8>>, R>;

/// A plain or gzipped stream.
enum Unpacked<R> {
    Plain(Source<R>),
    Gzip(Box<MultiGzDecoder<Source<R>>>),
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        match self {
            Unpacked::Plain(source) => source.read(buffer),
            Unpacked::Gzip(source) => source.read(buffer),
        }
    }
}

impl<R: Read> Flights<R> {
    /// From JSON lines, gzipped (told by the first two bytes) or not.
    pub fn new(mut reader: R) -> Result<Flights<R>, RecordingError> {
        let mut head = Vec::new();
        reader
            .by_ref()
            .take(GZIP_MAGIC.len() as u64)
            .read_to_end(&mut head)
            .map_err(|source| RecordingError::Read { line: 1, source })?;
        let gzipped = head == GZIP_MAGIC;
        let source = std::io::Cursor::new(head).chain(reader);
        let unpacked = if gzipped {
            Unpacked::Gzip(Box::new(MultiGzDecoder::new(source)))
        } else {
            Unpacked::Plain(source)
        };
        Ok(Flights { lines: BufReader::new(unpacked), line: 0, failed: false })
    }

    fn read_line(&mut self) -> Result<Option<Vec<u8>>, RecordingError> {
        self.line += 1;
        let mut text = Vec::new();
        self.lines
            .by_ref()
            .take(MAX_LINE_BYTES + 1)
            .read_until(b'\n', &mut text)
            .map_err(|source| RecordingError::Read { line: self.line, source })?;
        if text.len() as u64 > MAX_LINE_BYTES {
            return Err(RecordingError::TooLong { line: self.line });
        }
        if text.is_empty() { Ok(None) } else { Ok(Some(text)) }
    }
}

impl<R: Read> Iterator for Flights<R> {
    type Item = Result<Flight, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let flight = match self.read_line() {
            Ok(Some(text)) => Flight::parse(&text, self.line),
            Ok(None) if self.line == 1 => Err(RecordingError::Empty),
            Ok(None) => return None,
            Err(error) => Err(error),
        };
        self.failed = flight.is_err();
        Some(flight)
    }
}
