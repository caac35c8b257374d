//! What a study is run with, and what all its requests share.

use super::designs::{Edition, ResolveError, resolve};
use super::doorkeeper::Doorkeeper;
use super::hub::Hub;
use super::people::People;
use crate::hangar::Hangar;
use crate::learn::Learning;
use crate::limits::{Bucket, Buckets, OF_A_PARTICIPANT, OF_JOINS, OF_LINKS};
use crate::secret::SecretHash;
use crate::store::{ParticipantId, Store, StoreError, Write, Writer, now_ms};
use cohelm_study::design::{Design, Resolved};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A study to be run.
pub struct StudyRun {
    /// What its file says.
    pub design: Design,
    /// Of the researcher's secret.
    pub secret: SecretHash,
    /// Where participants and the researcher reach the server, without a slash at the end, such as
    /// `https://study.example.org`. It goes into links; with `https` cookies never go in the clear.
    pub address: String,
}

/// Why a study cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum StudyStartError {
    /// Plants or models are missing.
    #[error(transparent)]
    Resolve(#[from] ResolveError),
    /// The database failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// A study that is run.
pub(crate) struct Study {
    edition: Arc<Edition>,
    address: String,
    door: Doorkeeper,
    hub: Arc<Hub>,
    people: People,
    joins: Mutex<Bucket>,
    links: Mutex<Bucket>,
    newest: tokio::sync::Mutex<i64>,
    requests: Buckets<ParticipantId>,
    assigning: tokio::sync::Mutex<()>,
    clocks: Mutex<HashMap<ParticipantId, f64>>,
}

impl Study {
    /// Stores the study's file and opens its doors.
    pub async fn start(run: StudyRun, hangar: Arc<Hangar>, writer: Writer) -> Result<Self, StudyStartError> {
        let StudyRun { design, secret, address } = run;
        let (hash, name, text) = (design.hash(), design.name.clone(), design.text.clone());
        let resolved = resolve(&design, hangar.plants(), hangar.models())?;
        hangar.store().commit(&[Write::Study { hash: hash.clone(), name, text, at_ms: now_ms() }]).await?;
        let hub = Arc::new(Hub::default());
        let people = People::new(hangar, writer, hub.clone());
        let edition = people.designs().add(Edition { hash, design, resolved });
        Ok(Self {
            edition,
            address: address.trim_end_matches('/').to_owned(),
            door: Doorkeeper::new(secret),
            hub,
            people,
            joins: Mutex::new(Bucket::new(OF_JOINS)),
            links: Mutex::new(Bucket::new(OF_LINKS)),
            newest: tokio::sync::Mutex::default(),
            requests: Buckets::new(OF_A_PARTICIPANT),
            assigning: tokio::sync::Mutex::default(),
            clocks: Mutex::default(),
        })
    }

    /// The file as it is run now: what new participants get.
    pub fn edition(&self) -> &Arc<Edition> {
        &self.edition
    }

    /// Where the server is reached.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// True if cookies may only go over TLS.
    pub fn is_secure(&self) -> bool {
        self.address.starts_with("https://")
    }

    /// The researcher's door.
    pub fn door(&self) -> &Doorkeeper {
        &self.door
    }

    /// Those who watch.
    pub fn hub(&self) -> &Arc<Hub> {
        &self.hub
    }

    /// The participants.
    pub fn people(&self) -> &People {
        &self.people
    }

    /// The right to assign an order: one at a time, so that two who consent at once do not get the same place.
    pub async fn assigning(&self) -> tokio::sync::MutexGuard<'_, ()> {
        self.assigning.lock().await
    }

    /// Plant and models of a version of the file, as they are this moment: values that learn change.
    pub fn resolved(&self, edition: &Edition, learning: Option<&Learning>) -> Resolved {
        let mut resolved = edition.resolved.clone();
        if let Some(learning) = learning {
            let learns = edition.design.conditions.iter().map(|condition| condition.learning);
            let learning_ones = resolved.models.iter_mut().zip(learns).filter(|(_, learns)| *learns);
            learning_ones.for_each(|(models, _)| models.values = Some(learning.current()));
        }
        resolved
    }

    /// Remembers by how much a page's clock differs, for markers and the beginnings of flights.
    pub fn note_clock(&self, participant: ParticipantId, offset_ms: Option<f64>) {
        if let Some(offset_ms) = offset_ms {
            lock(&self.clocks).insert(participant, offset_ms);
        }
    }

    /// The page's clock minus this machine's, milliseconds, if the page said so.
    pub fn clock(&self, participant: ParticipantId) -> Option<f64> {
        lock(&self.clocks).get(&participant).copied()
    }

    /// A number for one more participant: free in the database, and given to nobody else who comes at the same moment.
    pub async fn new_number(&self, store: &dyn Store) -> Result<ParticipantId, StoreError> {
        let mut newest = self.newest.lock().await;
        let free = store.free_participant_id().await?;
        *newest = free.0.max(*newest + 1);
        Ok(ParticipantId(*newest))
    }

    /// Counts somebody who comes by a link of their own; how long to wait if too many do.
    pub fn let_in(&self) -> Result<(), Duration> {
        lock(&self.links).take()
    }

    /// Counts somebody who comes by the open link; how long to wait if too many do.
    pub fn let_join(&self) -> Result<(), Duration> {
        lock(&self.joins).take()
    }

    /// Counts a request of a participant; how long to wait if there are too many.
    pub fn let_ask(&self, participant: ParticipantId) -> Result<(), Duration> {
        self.requests.take(participant)
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic elsewhere leaves what is inside as it was.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
