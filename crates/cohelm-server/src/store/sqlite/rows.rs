//! Rows of the database as the store's types. A value that cannot be is an error, never a panic or a silent default.

use crate::store::{Chunk, Episode, EpisodeId, Progress, StoreError, StoredModel};
use cohelm::plant::Ending;
use cohelm::trajectory::Digests;
use sqlx::sqlite::{Sqlite, SqliteRow};
use sqlx::{Decode, Row, Type};

/// The value of a column.
fn get<'r, T: Decode<'r, Sqlite> + Type<Sqlite>>(
    row: &'r SqliteRow,
    what: &'static str,
) -> Result<T, StoreError> {
    row.try_get(what).map_err(|error| StoreError::Value { what, value: error.to_string() })
}

/// The value of a column of whole numbers, as a narrower type.
fn number<T: TryFrom<i64>>(row: &SqliteRow, what: &'static str) -> Result<T, StoreError> {
    let value: i64 = get(row, what)?;
    T::try_from(value).map_err(|_| StoreError::Value { what, value: value.to_string() })
}

fn json(row: &SqliteRow, what: &'static str) -> Result<serde_json::Value, StoreError> {
    let text: String = get(row, what)?;
    serde_json::from_str(&text).map_err(|error| StoreError::Value { what, value: error.to_string() })
}

pub fn episode(row: &SqliteRow) -> Result<Episode, StoreError> {
    Ok(Episode {
        id: EpisodeId(get(row, "id")?),
        progress: progress(row)?,
        ticks: number(row, "ticks")?,
        plant: get(row, "plant")?,
        plant_version: number(row, "plant_version")?,
        format: number(row, "format")?,
        program: get(row, "program")?,
        rule: get(row, "rule")?,
        seed: number(row, "seed")?,
        pilot: get(row, "pilot")?,
        time_scale: get(row, "time_scale")?,
        values: get(row, "values_model")?,
        intent: get(row, "intent_model")?,
        setup: json(row, "setup")?,
        started_at_ms: get(row, "started_at_ms")?,
        ended_at_ms: get(row, "ended_at_ms")?,
    })
}

fn progress(row: &SqliteRow) -> Result<Progress, StoreError> {
    let (ending, refused): (Option<String>, Option<String>) = (get(row, "ending")?, get(row, "refused")?);
    match (ending, refused) {
        (_, Some(reason)) => Ok(Progress::Refused { reason }),
        (None, None) => Ok(Progress::InTheAir),
        (Some(word), None) => Ending::ALL
            .into_iter()
            .find(|ending| ending.word() == word)
            .map(|ending| Progress::Finished { ending })
            .ok_or(StoreError::Value { what: "ending", value: word }),
    }
}

pub fn chunk(row: &SqliteRow) -> Result<Chunk, StoreError> {
    let digest = |what| get::<i64>(row, what).map(|bits| bits as u64);
    Ok(Chunk {
        from_tick: number(row, "from_tick")?,
        to_tick: number(row, "to_tick")?,
        digests: Digests { plant: digest("plant_digest")?, decisions: digest("decisions_digest")? },
        events: get(row, "events")?,
    })
}

pub fn model(row: &SqliteRow) -> Result<StoredModel, StoreError> {
    Ok(StoredModel {
        hash: get(row, "hash")?,
        origin: get(row, "origin")?,
        kind: get(row, "kind")?,
        name: get(row, "name")?,
        plant: get(row, "plant")?,
        card: json(row, "card")?,
        stored_at_ms: get(row, "stored_at_ms")?,
        kept_at_ms: get(row, "kept_at_ms")?,
    })
}
