//! What all connections share.

use crate::external::Elsewhere;
use crate::hangar::Hangar;
use crate::hosts::Hosts;
use crate::learn::{Learning, Lessons};
use crate::lease::Leases;
use crate::page::Assets;
use crate::protocol::Welcome;
use crate::recover::{PATIENCE, end_interrupted};
use crate::store::{Origin, Store, StoreError, Write, Writer, now_ms};
use crate::study::{Study, StudyRun, StudyStartError};
use cohelm::registry::Plants;
use cohelm::trajectory::FORMAT_VERSION;
use cohelm_copilot::{Model, Models, shipped};
use std::sync::Arc;
use tokio::sync::{Semaphore, watch};
use tokio::task::JoinError;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;

/// Most pages connected at once: each costs some 50 kB; far more than a study needs are more likely an accident.
const MOST_CONNECTIONS: usize = 2_048;

/// What a server is made of.
pub struct Parts {
    /// Where episodes and models are kept.
    pub store: Arc<dyn Store>,
    /// The plants of this program.
    pub plants: Plants,
    /// The models that come with it, and those that were named to it.
    pub models: Models,
    /// What learns while people fly, if anything does.
    pub lessons: Option<Lessons>,
    /// Under which names the server may be asked for.
    pub hosts: Hosts,
    /// The built page.
    pub assets: Assets,
    /// The study that is run, if one is.
    pub study: Option<StudyRun>,
}

/// Why a server cannot start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The database failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The study cannot be run.
    #[error(transparent)]
    Study(#[from] StudyStartError),
}

/// The server's state; cheap to clone.
#[derive(Clone)]
pub struct Server {
    shared: Arc<Shared>,
    elsewhere: Option<Elsewhere>,
}

struct Shared {
    writer: Writer,
    hangar: Arc<Hangar>,
    study: Option<Arc<Study>>,
    leases: Leases,
    learning: Option<Learning>,
    assets: Assets,
    hosts: Hosts,
    places: Arc<Semaphore>,
    cores: Semaphore,
    closing: CancellationToken,
    connections: TaskTracker,
}

/// Whether a model came with the program or from a file that somebody named.
fn origin_of(model: &Model) -> Origin {
    let is_shipped = shipped::FILES.iter().any(|(_, bytes)| *bytes == model.bytes());
    if is_shipped { Origin::Shipped } else { Origin::Given }
}

impl Server {
    /// Stores the models and starts the writer and, if there is one, the learner. Needs a Tokio runtime.
    pub async fn start(parts: Parts) -> Result<Self, StartError> {
        let Parts { store, plants, models, lessons, hosts, assets, study } = parts;
        let at_ms = now_ms();
        let keep = |model: &Model| Write::Model { model: model.clone(), origin: origin_of(model), at_ms };
        store.commit(&models.iter().map(keep).collect::<Vec<_>>()).await?;
        let writer = Writer::start(store.clone());
        let learning = match lessons {
            Some(lessons) => Some(Learning::start(lessons, &store, writer.clone()).await?),
            None => None,
        };
        let hangar = Arc::new(Hangar::new(plants, models, store));
        let (ended, forgotten) = end_interrupted(&hangar, PATIENCE).await?;
        tracing::info!(ended, forgotten, "old interrupted flights");
        let study = match study {
            Some(run) => Some(Arc::new(Study::start(run, hangar.clone(), writer.clone()).await?)),
            None => None,
        };
        let shared = Shared {
            hangar,
            study,
            writer,
            leases: Leases::default(),
            learning,
            assets,
            hosts,
            places: Arc::new(Semaphore::new(MOST_CONNECTIONS)),
            cores: Semaphore::new(std::thread::available_parallelism().map_or(1, usize::from)),
            closing: CancellationToken::new(),
            connections: TaskTracker::new(),
        };
        Ok(Self { shared: Arc::new(shared), elsewhere: None })
    }

    /// The same, where a plant is flown that is elsewhere.
    pub fn with_plant_elsewhere(self, plant: Elsewhere) -> Self {
        Self { elsewhere: Some(plant), ..self }
    }

    pub(crate) fn elsewhere(&self) -> Option<&Elsewhere> {
        self.elsewhere.as_ref()
    }

    /// Where episodes and models are kept.
    pub fn store(&self) -> &dyn Store {
        self.shared.hangar.store()
    }

    /// The way to write.
    pub fn writer(&self) -> &Writer {
        &self.shared.writer
    }

    /// What can be flown.
    pub fn hangar(&self) -> &Hangar {
        &self.shared.hangar
    }

    /// What learns, if anything does.
    pub fn learning(&self) -> Option<&Learning> {
        self.shared.learning.as_ref()
    }

    /// The study that is run, if one is.
    pub(crate) fn study(&self) -> Option<&Arc<Study>> {
        self.shared.study.as_ref()
    }

    pub(crate) fn leases(&self) -> &Leases {
        &self.shared.leases
    }

    pub(crate) fn assets(&self) -> &Assets {
        &self.shared.assets
    }

    pub(crate) fn hosts(&self) -> &Hosts {
        &self.shared.hosts
    }

    /// A place for one more connection.
    pub(crate) fn places(&self) -> Arc<Semaphore> {
        self.shared.places.clone()
    }

    /// The tasks of all connections.
    pub(crate) fn connections(&self) -> &TaskTracker {
        &self.shared.connections
    }

    /// Cancelled when the server stops.
    pub(crate) fn closing(&self) -> &CancellationToken {
        &self.shared.closing
    }

    /// Runs what takes time on a thread that may be kept, as many at once as there are cores. An error is a panic of
    /// the work, which this server survives.
    pub(crate) async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, JoinError> {
        let _core = self.shared.cores.acquire().await;
        tokio::task::spawn_blocking(work).await
    }

    /// What is said to every page first.
    pub(crate) fn welcome(&self) -> Welcome {
        let values = self.learning().map(Learning::current);
        let cohelm = env!("CARGO_PKG_VERSION").into();
        Welcome { cohelm, format: FORMAT_VERSION, learning: values.is_some(), values }
    }

    /// The hash of the values that learn, and word of every change; a channel that never speaks if nothing learns.
    pub(crate) fn news(&self) -> Option<watch::Receiver<String>> {
        self.learning().map(Learning::news)
    }

    /// Closes all connections with a reason and waits until what they had to write is written.
    pub async fn stop(&self) {
        self.shared.closing.cancel();
        self.shared.connections.close();
        self.shared.connections.wait().await;
        self.shared.writer.flush().await;
    }
}
