//! The record of an episode as it is stored: its bytes, packed, and what lists need to know of it.

use super::StoreError;
use cohelm::plant::Ending;
use cohelm::trajectory::{self, Setup, Trajectory};
use std::io::Read;

/// Most bytes a trajectory can have.
const MAX_BYTES: u64 = trajectory::MAX_BYTES as u64;
/// How hard zstd tries: higher packs a little smaller and much slower.
const LEVEL: i32 = 3;

/// A finished episode, ready to be stored.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub(super) setup: Setup,
    pub(super) ending: Ending,
    pub(super) ticks: u32,
    pub(super) packed: Vec<u8>,
}

impl Record {
    /// Packs a trajectory.
    pub fn new(flown: &Trajectory) -> Self {
        let bytes = flown.to_bytes();
        let packed =
            zstd::bulk::compress(&bytes, LEVEL).expect("zstd packs into memory whatever it is given");
        Self { setup: flown.setup.clone(), ending: flown.ending, ticks: flown.ticks() as u32, packed }
    }
}

/// The bytes of a trajectory from a packed record; bounded, whatever the packed bytes claim.
pub fn unpack(packed: &[u8]) -> Result<Vec<u8>, StoreError> {
    let wrong = |error: std::io::Error| StoreError::Unpack(error.to_string());
    let mut bytes = Vec::new();
    let decoder = zstd::stream::Decoder::new(packed).map_err(wrong)?;
    decoder.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(wrong)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(StoreError::Unpack(format!("it holds more than {MAX_BYTES} bytes")));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bomb_is_not_unpacked_beyond_what_a_record_can_be() {
        let bomb = zstd::bulk::compress(&vec![0; MAX_BYTES as usize + 10], LEVEL).unwrap();
        assert!(bomb.len() < 10_000);
        assert!(matches!(unpack(&bomb), Err(StoreError::Unpack(_))));
    }

    #[test]
    fn damaged_packing_is_an_error() {
        let packed = zstd::bulk::compress(&vec![7; 5_000], LEVEL).unwrap();
        assert!(unpack(&packed[..packed.len() - 2]).is_err());
        assert!(unpack(b"nothing").is_err());
    }
}
