//! Rows of the database as the store's types. A value that cannot be is an error, never a panic or a silent default.

use super::driver::Row;
use super::{
    Chunk, Episode, EpisodeId, Participant, ParticipantId, Progress, StoreError, StoredEvent, StoredModel,
    StoredStudy, Trial,
};
use cohelm::plant::Ending;
use cohelm::trajectory::Digests;

fn json(row: &mut Row, what: &'static str) -> Result<serde_json::Value, StoreError> {
    let text: String = row.take(what)?;
    serde_json::from_str(&text).map_err(|error| StoreError::Value { what, value: error.to_string() })
}

pub fn episode(mut row: Row) -> Result<Episode, StoreError> {
    let row = &mut row;
    Ok(Episode {
        id: EpisodeId(row.take("id")?),
        plant: row.take("plant")?,
        plant_version: row.number("plant_version")?,
        format: row.number("format")?,
        program: row.take("program")?,
        rule: row.take("rule")?,
        seed: row.number("seed")?,
        pilot: row.take("pilot")?,
        time_scale: row.take("time_scale")?,
        values: row.take("values_model")?,
        intent: row.take("intent_model")?,
        setup: json(row, "setup")?,
        started_at_ms: row.take("started_at_ms")?,
        ended_at_ms: row.take("ended_at_ms")?,
        ticks: row.number("ticks")?,
        progress: progress(row.take("ending")?, row.take("refused")?)?,
        trial: trial(row.take("participant")?, row.take("step")?)?,
    })
}

fn progress(ending: Option<String>, refused: Option<String>) -> Result<Progress, StoreError> {
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

fn trial(participant: Option<i64>, step: Option<String>) -> Result<Option<Trial>, StoreError> {
    match (participant, step) {
        (None, None) => Ok(None),
        (Some(participant), Some(step)) => Ok(Some(Trial { participant: ParticipantId(participant), step })),
        (participant, step) => Err(StoreError::Value {
            what: "participant and step",
            value: format!("{participant:?}, {step:?}"),
        }),
    }
}

pub fn chunk(mut row: Row) -> Result<Chunk, StoreError> {
    let row = &mut row;
    let (from_tick, to_tick) = (row.number("from_tick")?, row.number("to_tick")?);
    let mut digest = |what| row.take::<i64>(what).map(|bits| bits as u64);
    let digests = Digests { plant: digest("plant_digest")?, decisions: digest("decisions_digest")? };
    Ok(Chunk { from_tick, to_tick, digests, events: row.take("events")? })
}

pub fn model(mut row: Row) -> Result<StoredModel, StoreError> {
    let row = &mut row;
    Ok(StoredModel {
        hash: row.take("hash")?,
        origin: row.take("origin")?,
        kind: row.take("kind")?,
        name: row.take("name")?,
        plant: row.take("plant")?,
        card: json(row, "card")?,
        stored_at_ms: row.take("stored_at_ms")?,
        kept_at_ms: row.take("kept_at_ms")?,
    })
}

pub fn study(mut row: Row) -> Result<StoredStudy, StoreError> {
    Ok(StoredStudy {
        hash: row.take("hash")?,
        name: row.take("name")?,
        text: row.take("text")?,
        stored_at_ms: row.take("stored_at_ms")?,
    })
}

pub fn participant(mut row: Row) -> Result<Participant, StoreError> {
    Ok(Participant {
        id: ParticipantId(row.take("id")?),
        study: row.take("study")?,
        code: row.take("code")?,
        created_at_ms: row.take("created_at_ms")?,
        seen_at_ms: row.take("seen_at_ms")?,
        last_seq: row.number("last_seq")?,
        withdrawn_at_ms: row.take("withdrawn_at_ms")?,
    })
}

pub fn event(mut row: Row) -> Result<StoredEvent, StoreError> {
    Ok(StoredEvent { seq: row.number("seq")?, at_ms: row.take("at_ms")?, json: row.take("event")? })
}
