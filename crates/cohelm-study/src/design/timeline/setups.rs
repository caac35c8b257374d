//! What fixes a flight: its seed, its setup, and the key by which page and server name it.

use super::{FlightPlace, Step};
use crate::design::Design;
use crate::design::catalogue::Resolved;
use crate::design::schedule::{Assignment, draw};
use cohelm::trajectory::{MAX_SEED, Setup};
use sha2::{Digest, Sha256};

/// A condition whose plant and models were not looked up.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the models of condition {condition:?} were not resolved: expected one entry a condition ({conditions}), got {got}"
)]
pub struct Unresolved {
    /// Its name.
    pub condition: String,
    /// How many conditions there are.
    pub conditions: usize,
    /// How many were resolved.
    pub got: usize,
}

/// The seed of a flight: its ground, its start and its goal. Practice never shows a ground that is measured later, but
/// for a coincidence of 53 bits.
pub fn flight_seed(design: &Design, assignment: &Assignment, place: &FlightPlace) -> u64 {
    let terrain = &design.terrain;
    let person = if terrain.same_for_everyone { 0 } else { assignment.seed | 1 << 63 };
    let condition = if terrain.same_in_every_condition { 0 } else { place.condition as u64 + 1 };
    let kind = if place.practice { "practice ground" } else { "measured ground" };
    let of_the_study = draw(terrain.seed, kind, condition);
    draw(of_the_study ^ draw(person, "person", 0), "flight", u64::from(place.number)) % MAX_SEED
}

/// Everything that fixes a flight but the participant's keys.
pub fn setup(
    design: &Design,
    assignment: &Assignment,
    resolved: &Resolved,
    place: &FlightPlace,
) -> Result<Setup, Unresolved> {
    let condition = &design.conditions[place.condition];
    let models = resolved.models.get(place.condition).ok_or_else(|| Unresolved {
        condition: condition.name.clone(),
        conditions: design.conditions.len(),
        got: resolved.models.len(),
    })?;
    Ok(Setup {
        task: design.task.task.clone(),
        plant_version: resolved.plant_version,
        seed: flight_seed(design, assignment, place),
        rule: condition.rule,
        inference: condition.inference,
        silence: condition.silence,
        time_scale: design.task.time_scale,
        values: models.values.clone(),
        intent: models.intent.clone(),
        pilot: "person".to_owned(),
    })
}

/// The key of an attempt at a flight, 32 hexadecimal digits: half of the SHA-256 of seed, step and attempt.
pub fn flight_key(assignment: &Assignment, step: &Step, attempt: u32) -> String {
    let digest = Sha256::new()
        .chain_update(b"cohelm flight key ")
        .chain_update(assignment.seed.to_le_bytes())
        .chain_update(step.id.as_bytes())
        .chain_update([0])
        .chain_update(attempt.to_le_bytes())
        .finalize();
    digest[..16].iter().map(|byte| format!("{byte:02x}")).collect()
}
