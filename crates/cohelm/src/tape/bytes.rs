//! A tape as bytes, behind the trajectory that it belongs to: length of a header, header, then what was seen.

use super::{Described, MAX_TAPE, Seen, Tape, TapeError};
use crate::plant::{Ending, Goal};
use crate::scene::Pose;
use crate::trajectory::{Reader, TrajectoryError};
use serde::{Deserialize, Serialize};

/// Longest reason for which a plant was lost, characters.
pub(super) const MAX_REASON: usize = 300;
/// Most bytes of a header: the largest scene there may be.
const MAX_HEADER: usize = 2 * 1024 * 1024;
const NO_ENDING: u8 = 255;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    about: Described,
    states: usize,
    lost: Option<String>,
}

/// Bytes that one moment takes.
pub(super) fn size_of(seen: &Seen) -> usize {
    let floats = seen.state.len() + 2 + 2 * seen.goals.len() + 4 * seen.poses.len();
    4 * (floats + seen.goals.len()) + 8 + 3
}

pub(crate) fn put_tape(out: &mut Vec<u8>, tape: &Tape) {
    let header =
        Header { about: tape.about.clone(), states: tape.last().state.len(), lost: tape.lost.clone() };
    let header = serde_json::to_vec(&header).expect("finite numbers and strings have a JSON form");
    out.extend_from_slice(&(header.len() as u32).to_le_bytes());
    out.extend_from_slice(&header);
    tape.seen.iter().for_each(|seen| put_seen(out, seen));
}

fn put_seen(out: &mut Vec<u8>, seen: &Seen) {
    let mut floats = |values: &[f32]| values.iter().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
    floats(&seen.state);
    floats(&seen.position);
    seen.poses.iter().for_each(|pose| floats(&[pose.x, pose.y, pose.angle_rad, pose.strength]));
    out.extend_from_slice(&seen.reward.to_le_bytes());
    out.extend_from_slice(&[
        seen.switches,
        seen.ending.map_or(NO_ENDING, |ending| ending as u8),
        seen.goals.len() as u8,
    ]);
    for goal in &seen.goals {
        out.extend_from_slice(&goal.id.to_le_bytes());
        goal.position.iter().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
    }
}

/// The tape of an episode of so many ticks, checked as if it came in anew.
pub(crate) fn read_tape(reader: &mut Reader<'_>, ticks: usize) -> Result<Tape, TrajectoryError> {
    let wrong = |error: TapeError| TrajectoryError::Field { what: "tape", value: error.to_string() };
    let length = reader.u32()? as usize;
    if length > MAX_HEADER {
        return Err(TrajectoryError::TooMany {
            what: "header bytes of the tape",
            count: length,
            most: MAX_HEADER,
        });
    }
    let header: Header = serde_json::from_slice(reader.take(length)?)
        .map_err(|error| TrajectoryError::Header(error.to_string()))?;
    let Header { about, states, lost } = header;
    let sizes = (states, about.scene.movable.len());
    let mut tape = Tape::new(about, read_seen(reader, sizes)?).map_err(wrong)?;
    for _ in 0..ticks {
        tape.add(read_seen(reader, sizes)?, 0).map_err(wrong)?;
    }
    tape.lost = lost;
    Ok(tape)
}

fn read_seen(reader: &mut Reader<'_>, (states, movable): (usize, usize)) -> Result<Seen, TrajectoryError> {
    // What is there bounds what is taken in, whatever the header claims.
    if states > MAX_TAPE / 4 {
        return Err(TrajectoryError::TooMany {
            what: "numbers of a state",
            count: states,
            most: super::MAX_STATE,
        });
    }
    let state = floats(reader.take(4 * states)?).collect();
    let position = pair(reader)?;
    let mut poses = Vec::new();
    for _ in 0..movable {
        let [x, y, angle_rad, strength] = four(reader)?;
        poses.push(Pose { x, y, angle_rad, strength });
    }
    let reward = f64::from_le_bytes(reader.array()?);
    let [switches, ending, count] = reader.array()?;
    let ending = (ending != NO_ENDING).then(|| Ending::ALL.get(usize::from(ending)).copied());
    let ending = match ending {
        Some(None) => {
            return Err(TrajectoryError::Field {
                what: "ending on the tape",
                value: "none that is known".into(),
            });
        }
        known => known.flatten(),
    };
    let mut goals = Vec::new();
    for _ in 0..count {
        goals.push(Goal { id: reader.u32()?, position: pair(reader)? });
    }
    Ok(Seen { state, position, switches, goals, poses, reward, ending })
}

fn floats(bytes: &[u8]) -> impl Iterator<Item = f32> + '_ {
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]]))
}

fn pair(reader: &mut Reader<'_>) -> Result<[f32; 2], TrajectoryError> {
    let mut read = floats(reader.take(8)?);
    Ok([read.next().unwrap_or_default(), read.next().unwrap_or_default()])
}

fn four(reader: &mut Reader<'_>) -> Result<[f32; 4], TrajectoryError> {
    let mut read = floats(reader.take(16)?);
    Ok(core::array::from_fn(|_| read.next().unwrap_or_default()))
}
