//! A trajectory as bytes, and back: magic `CHLM`, one version byte, a JSON header of bounded length, two bytes a tick
//! (more for axes), then the key log, then the tape of a plant that was elsewhere. Little-endian.

use super::{Digests, Setup, Trajectory};
use crate::action::Action;
use crate::keys::{Change, KeyEvent};
use crate::plant::Ending;
use crate::tape::{MAX_TAPE, put_tape, read_tape};
use serde::{Deserialize, Serialize};

/// Version of these bytes. Whoever changes their meaning counts it up; older ones stay readable or are refused.
pub const FORMAT_VERSION: u8 = 1;
/// Version of the same bytes with a tape behind them.
pub const TAPED_FORMAT_VERSION: u8 = 2;
/// Most ticks a trajectory may hold: over an hour at 50 Hz.
pub const MAX_TICKS: usize = 200_000;
/// Most key events a trajectory may hold.
pub const MAX_EVENTS: usize = 200_000;
/// Most bytes that a trajectory's bytes can have: its header, four axes asked and executed at each tick, sticks moved at
/// each event, and the largest tape with its scene. Whoever takes one in must have room for so many.
pub const MAX_BYTES: usize = 4 * 1024 * 1024 + 34 * MAX_TICKS + 18 * MAX_EVENTS + MAX_TAPE;

const MAGIC: &[u8; 4] = b"CHLM";
const MAX_HEADER: usize = 64 * 1024;
const NOTHING: u8 = 255;
const AXES: u8 = 254;

/// Why bytes are no trajectory.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TrajectoryError {
    /// They begin differently.
    #[error("this is no cohelm trajectory: it does not begin with CHLM")]
    Foreign,
    /// Another version wrote them.
    #[error(
        "this trajectory has format {0}, this program reads formats {FORMAT_VERSION} and {TAPED_FORMAT_VERSION}; use the version that wrote it"
    )]
    Version(u8),
    /// They end too early.
    #[error("the trajectory is cut off: {expected} more bytes were expected, {left} are left")]
    CutOff {
        /// Bytes that should follow.
        expected: usize,
        /// Bytes there are.
        left: usize,
    },
    /// Something follows them.
    #[error("{0} bytes follow the end of the trajectory; none were expected")]
    TooLong(usize),
    /// A count is larger than allowed.
    #[error("the trajectory says it has {count} {what}; at most {most} are allowed")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many it says.
        count: usize,
        /// How many it may.
        most: usize,
    },
    /// The header is not what it should be.
    #[error("the trajectory's header is wrong: {0}")]
    Header(String),
    /// A field of the body has an impossible value.
    #[error("the trajectory's {what} has an impossible value: {value}")]
    Field {
        /// Which field.
        what: &'static str,
        /// What it holds.
        value: String,
    },
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    setup: Setup,
    ending: Ending,
    ticks: usize,
    events: usize,
    plant_digest: String,
    decisions_digest: String,
}

impl Trajectory {
    /// The bytes of this trajectory.
    pub fn to_bytes(&self) -> Vec<u8> {
        let header = Header {
            setup: self.setup.clone(),
            ending: self.ending,
            ticks: self.asked.len(),
            events: self.keys.len(),
            plant_digest: format!("{:016x}", self.digests.plant),
            decisions_digest: format!("{:016x}", self.digests.decisions),
        };
        let header = serde_json::to_vec(&header).expect("a header of strings and numbers has a JSON form");
        let mut out = Vec::with_capacity(16 + header.len() + 2 * self.asked.len() + 11 * self.keys.len());
        out.extend_from_slice(MAGIC);
        out.push(self.format());
        out.extend_from_slice(&(header.len() as u32).to_le_bytes());
        out.extend_from_slice(&header);
        for (asked, executed) in self.asked.iter().zip(&self.executed) {
            put_action(&mut out, *asked);
            put_action(&mut out, *executed);
        }
        self.keys.iter().for_each(|event| put_event(&mut out, event));
        if let Some(tape) = &self.tape {
            put_tape(&mut out, tape);
        }
        out
    }

    /// The version of its bytes.
    pub fn format(&self) -> u8 {
        if self.tape.is_some() { TAPED_FORMAT_VERSION } else { FORMAT_VERSION }
    }

    /// The trajectory of these bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TrajectoryError> {
        let mut reader = Reader { rest: bytes };
        if reader.take(4).map_err(|_| TrajectoryError::Foreign)? != MAGIC {
            return Err(TrajectoryError::Foreign);
        }
        let version = reader.byte()?;
        if ![FORMAT_VERSION, TAPED_FORMAT_VERSION].contains(&version) {
            return Err(TrajectoryError::Version(version));
        }
        let length = reader.u32()? as usize;
        at_most("header bytes", length, MAX_HEADER)?;
        let header: Header = serde_json::from_slice(reader.take(length)?)
            .map_err(|error| TrajectoryError::Header(error.to_string()))?;
        at_most("ticks", header.ticks, MAX_TICKS)?;
        at_most("key events", header.events, MAX_EVENTS)?;
        let (mut asked, mut executed) = (Vec::new(), Vec::new());
        for _ in 0..header.ticks {
            asked.push(reader.action()?);
            executed.push(reader.action()?);
        }
        let keys = (0..header.events).map(|_| reader.event()).collect::<Result<Vec<_>, _>>()?;
        let taped = version == TAPED_FORMAT_VERSION;
        let tape = if taped { Some(read_tape(&mut reader, header.ticks)?) } else { None };
        if !reader.rest.is_empty() {
            return Err(TrajectoryError::TooLong(reader.rest.len()));
        }
        let digests =
            Digests { plant: hex(&header.plant_digest)?, decisions: hex(&header.decisions_digest)? };
        Ok(Self { setup: header.setup, asked, executed, keys, ending: header.ending, digests, tape })
    }
}

/// Key events as bytes: how the page sends them while an episode runs.
pub fn put_event(out: &mut Vec<u8>, event: &KeyEvent) {
    out.extend_from_slice(&event.tick.to_le_bytes());
    out.extend_from_slice(&event.at_ms.to_le_bytes());
    match event.change {
        Change::Down(control) => out.extend_from_slice(&[0, control]),
        Change::Up(control) => out.extend_from_slice(&[1, control]),
        Change::ReleaseAll => out.extend_from_slice(&[2, 0]),
        Change::Stick(axes) => {
            out.extend_from_slice(&[3, 0]);
            axes.iter().for_each(|axis| out.extend_from_slice(&axis.to_le_bytes()));
        }
    }
}

/// Reads a run of key events as [`put_event`] wrote them, to the end of the bytes.
pub fn read_events(bytes: &[u8]) -> Result<Vec<KeyEvent>, TrajectoryError> {
    let mut reader = Reader { rest: bytes };
    let mut events = Vec::new();
    while !reader.rest.is_empty() {
        at_most("key events", events.len() + 1, MAX_EVENTS)?;
        events.push(reader.event()?);
    }
    Ok(events)
}

fn put_action(out: &mut Vec<u8>, action: Option<Action>) {
    match action {
        None => out.push(NOTHING),
        Some(Action::Command(command)) => out.push(command.min(AXES - 1)),
        Some(Action::Axes(axes)) => {
            out.push(AXES);
            axes.iter().for_each(|axis| out.extend_from_slice(&axis.to_le_bytes()));
        }
    }
}

fn at_most(what: &'static str, count: usize, most: usize) -> Result<(), TrajectoryError> {
    if count > most { Err(TrajectoryError::TooMany { what, count, most }) } else { Ok(()) }
}

fn hex(text: &str) -> Result<u64, TrajectoryError> {
    u64::from_str_radix(text, 16).map_err(|_| TrajectoryError::Field { what: "digest", value: text.into() })
}

pub(crate) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u8], TrajectoryError> {
        if count > self.rest.len() {
            return Err(TrajectoryError::CutOff { expected: count, left: self.rest.len() });
        }
        let (taken, rest) = self.rest.split_at(count);
        self.rest = rest;
        Ok(taken)
    }

    pub(crate) fn array<const N: usize>(&mut self) -> Result<[u8; N], TrajectoryError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn byte(&mut self) -> Result<u8, TrajectoryError> {
        Ok(self.array::<1>()?[0])
    }

    pub(crate) fn u32(&mut self) -> Result<u32, TrajectoryError> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    fn finite(&mut self, what: &'static str) -> Result<f32, TrajectoryError> {
        let value = f32::from_le_bytes(self.array()?);
        if value.is_finite() {
            Ok(value)
        } else {
            Err(TrajectoryError::Field { what, value: value.to_string() })
        }
    }

    fn action(&mut self) -> Result<Option<Action>, TrajectoryError> {
        Ok(match self.byte()? {
            NOTHING => None,
            AXES => {
                let mut axes = [0.0; 4];
                for axis in &mut axes {
                    *axis = self.finite("axis")?;
                }
                Some(Action::Axes(axes))
            }
            command => Some(Action::Command(command)),
        })
    }

    fn event(&mut self) -> Result<KeyEvent, TrajectoryError> {
        let tick = self.u32()?;
        let at_ms = self.finite("time of a key event")?;
        let [kind, control] = self.array()?;
        let change = match kind {
            0 => Change::Down(control),
            1 => Change::Up(control),
            2 => Change::ReleaseAll,
            3 => {
                let raw: [u8; 8] = self.array()?;
                Change::Stick(core::array::from_fn(|i| i16::from_le_bytes([raw[2 * i], raw[2 * i + 1]])))
            }
            other => {
                return Err(TrajectoryError::Field { what: "kind of key event", value: other.to_string() });
            }
        };
        Ok(KeyEvent { tick, change, at_ms })
    }
}
