//! What a server said is stored, noted by those it said it to, and held against its database.

use anyhow::{Context, Result};
use cohelm::plant::Ending;
use cohelm_server::store::{EpisodeId, Participant, Progress, Store};
use cohelm_server::visit::Heard;
use cohelm_study::session::Event;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Everything that was acknowledged. Knows nothing of what the server thinks.
#[derive(Default)]
pub struct Ledger {
    pages: Mutex<Pages>,
}

#[derive(Default)]
struct Pages {
    ticks: HashMap<EpisodeId, u32>,
    finished: HashMap<EpisodeId, (Ending, u32)>,
    steps: BTreeMap<String, BTreeSet<String>>,
    counts: Counts,
}

/// How much was acknowledged.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Counts {
    /// Pieces of key logs.
    pub pieces: usize,
    /// Flights.
    pub flights: usize,
    /// Steps of sessions.
    pub steps: usize,
    /// Flights that were taken up again in the air.
    pub resumed: usize,
}

impl Ledger {
    /// Notes what a participant heard.
    pub fn note(&self, participant: &str, heard: Heard) {
        let mut pages = self.lock();
        match heard {
            Heard::Ack { episode, ticks } => {
                pages.counts.pieces += 1;
                let known = pages.ticks.entry(episode).or_default();
                *known = ticks.max(*known);
            }
            Heard::Finished { episode, ending, ticks } => {
                pages.counts.flights += 1;
                pages.finished.insert(episode, (ending, ticks));
            }
            Heard::Step { id } => {
                pages.counts.steps += 1;
                pages.steps.entry(participant.to_owned()).or_default().insert(id);
            }
            Heard::Resumed { .. } => pages.counts.resumed += 1,
        }
    }

    /// How much was noted.
    pub fn counts(&self) -> Counts {
        self.lock().counts
    }

    /// What the database does not have of what was noted, and what it has by halves; in words, empty if all is well.
    pub async fn hold_against(&self, store: &dyn Store, study: &str) -> Result<Vec<String>> {
        let mut losses = self.lost_flights(store).await?;
        for participant in store.participants(study).await? {
            losses.extend(self.lost_steps(store, &participant).await?);
        }
        Ok(losses)
    }

    async fn lost_flights(&self, store: &dyn Store) -> Result<Vec<String>> {
        let (ticks, finished) = {
            let pages = self.lock();
            (pages.ticks.clone(), pages.finished.clone())
        };
        let mut losses = Vec::new();
        for (episode, acknowledged) in ticks {
            match store.episode(episode).await? {
                Some(row) if row.ticks >= acknowledged => {}
                found => losses.push(format!(
                    "{acknowledged} ticks of episode {episode} were acknowledged, {} are stored",
                    found.map_or(0, |row| row.ticks)
                )),
            }
        }
        for (episode, (ending, ticks)) in finished {
            let row = store.episode(episode).await?;
            let as_said =
                row.is_some_and(|row| row.progress == (Progress::Finished { ending }) && row.ticks == ticks);
            if !as_said || store.record(episode).await?.is_none() {
                losses.push(format!("episode {episode} was acknowledged as finished, and is not stored so"));
            }
        }
        Ok(losses)
    }

    /// Steps that are not in the log; and flights whose end is in the log or in their row, but not in both.
    async fn lost_steps(&self, store: &dyn Store, participant: &Participant) -> Result<Vec<String>> {
        let (mut done, mut ended) = (BTreeSet::new(), BTreeSet::new());
        for stored in store.events(participant.id, 0).await? {
            let event = serde_json::from_str(&stored.json);
            match event.with_context(|| format!("event {} of {}", stored.seq, participant.code))? {
                Event::StepDone { step, .. } | Event::FlightNoted { step, .. } => drop(done.insert(step)),
                Event::FlightEnded { episode, .. } => drop(ended.insert(EpisodeId(episode))),
                _ => {}
            }
        }
        let acknowledged = self.lock().steps.get(&participant.code).cloned().unwrap_or_default();
        let lost = acknowledged.difference(&done);
        let mut losses: Vec<String> = lost
            .map(|step| format!("step {step} of {} was acknowledged and is not stored", participant.code))
            .collect();
        for flight in store.trials(participant.id).await? {
            let finished = matches!(flight.progress, Progress::Finished { .. });
            if finished != ended.contains(&flight.id) {
                losses.push(format!("the end of episode {} is stored by half", flight.id));
            }
        }
        Ok(losses)
    }

    fn lock(&self) -> MutexGuard<'_, Pages> {
        // A panic elsewhere leaves lists of numbers lists of numbers.
        self.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
