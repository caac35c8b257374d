//! Participants as the researcher sees them.

use super::flights::condition_name;
use super::people::Seen;
use super::run::Study;
use crate::store::ParticipantId;
use cohelm_study::session::{FlightState, Remark, Session, Status};
use serde::Serialize;
use std::collections::BTreeMap;

/// A participant as the researcher's list shows it.
#[derive(Debug, Serialize)]
pub struct Row {
    id: ParticipantId,
    code: String,
    status: Status,
    excluded: Option<Excluded>,
    test: bool,
    simulated: bool,
    language: String,
    version: String,
    cell: Option<usize>,
    order: Vec<String>,
    place: usize,
    total: usize,
    step: Option<String>,
    condition: Option<String>,
    created_ms: i64,
    last_seen_ms: Option<i64>,
    connected: bool,
    in_air: Option<super::hub::Flying>,
    minutes: Option<f64>,
    minutes_left: f64,
    flights: usize,
    late_ticks: Vec<f64>,
    interruptions: u32,
    refused: u32,
    endings: BTreeMap<&'static str, u32>,
    failed_checks: usize,
    breaches: Vec<String>,
    notes: usize,
    remarks: Vec<Remark>,
    panel: BTreeMap<String, String>,
}

#[derive(Debug, Serialize)]
struct Excluded {
    reason: String,
    by: String,
}

impl Row {
    /// The row of one.
    pub fn of(study: &Study, seen: &Seen) -> Self {
        let Seen { row, edition, session } = seen;
        let (design, presence) = (&edition.design, study.hub().presence(row.id));
        let name = |&index: &usize| design.conditions.get(index).map(|condition| condition.name.clone());
        let assignment = session.assignment();
        let step = session.current().map(|step| step.id.clone());
        let flights = flights(session);
        Self {
            id: row.id,
            code: row.code.clone(),
            status: session.status(),
            excluded: session
                .excluded()
                .map(|(reason, by)| Excluded { reason: reason.into(), by: by.into() }),
            test: session.is_test(),
            simulated: session.is_simulated(),
            language: session.language().into(),
            version: row.study.clone(),
            cell: assignment.map(|assignment| assignment.cell),
            order: assignment.iter().flat_map(|assignment| &assignment.order).filter_map(name).collect(),
            place: session.place(),
            total: session.steps().len(),
            condition: step.as_deref().and_then(|step| condition_name(seen, step)),
            step,
            created_ms: row.created_at_ms,
            last_seen_ms: row.seen_at_ms,
            connected: presence.sockets > 0,
            in_air: presence.in_air,
            minutes: minutes(session),
            minutes_left: session.minutes_left(design),
            late_ticks: flights.iter().filter_map(|flight| late_share(flight)).collect(),
            interruptions: flights.iter().map(|flight| flight.interruptions).sum(),
            refused: flights.iter().map(|flight| flight.attempt.saturating_sub(1)).sum(),
            endings: endings(&flights),
            flights: flights.iter().filter(|flight| flight.ended.is_some()).count(),
            failed_checks: session.failed_checks(design),
            breaches: session.breaches(design).iter().map(|breach| breach.words()).collect(),
            notes: session.remarks().len(),
            remarks: session.remarks().to_vec(),
            panel: session.panel().clone(),
        }
    }
}

/// The flights that were begun, in the order of the steps.
fn flights(session: &Session) -> Vec<&FlightState> {
    session.steps().iter().filter_map(|step| session.flight(&step.id)).collect()
}

/// Share of ticks that came late; `None` if the page did not say.
fn late_share(flight: &FlightState) -> Option<f64> {
    let (late, (_, ticks)) = (flight.telemetry.as_ref()?.late_ticks?, flight.ended?);
    (ticks > 0).then(|| f64::from(late) / f64::from(ticks))
}

fn endings(flights: &[&FlightState]) -> BTreeMap<&'static str, u32> {
    let mut counts = BTreeMap::new();
    for (ending, _) in flights.iter().filter_map(|flight| flight.ended) {
        *counts.entry(ending.word()).or_default() += 1;
    }
    counts
}

/// From consent to the end, or until the last event.
fn minutes(session: &Session) -> Option<f64> {
    let until_ms = session.completed_ms().unwrap_or(session.last_ms());
    session.consented_ms().map(|from_ms| (until_ms - from_ms).max(0) as f64 / 60_000.0)
}
