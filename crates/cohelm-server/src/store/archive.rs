//! The same database for a program that waits: what the command line uses.

use super::{EpisodeId, Origin, Record, SqliteStore, Store, StoreError, Write, now_ms};
use cohelm::trajectory::Trajectory;
use cohelm_copilot::Models;
use std::future::Future;
use std::path::Path;
use std::sync::Arc;
use tokio::runtime::{Builder, Runtime};

/// Episodes committed together: more wait for the disk less often, fewer are lost when a long run is stopped.
const TOGETHER: usize = 256;

/// A database with a runtime of its own. Not to be used from async code.
pub struct Archive {
    store: Arc<SqliteStore>,
    runtime: Runtime,
}

impl Archive {
    /// Opens the database in this file, and makes it if there is none.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        Self::with(path, SqliteStore::open(path))
    }

    /// Opens the database in this file; an error if there is none.
    pub fn open_existing(path: &Path) -> Result<Self, StoreError> {
        Self::with(path, SqliteStore::open_existing(path))
    }

    fn with(
        path: &Path,
        opening: impl Future<Output = Result<SqliteStore, StoreError>>,
    ) -> Result<Self, StoreError> {
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime =
            runtime.map_err(|error| StoreError::Other { path: path.into(), reason: error.to_string() })?;
        let store = Arc::new(runtime.block_on(opening)?);
        Ok(Self { store, runtime })
    }

    /// The database, for async code.
    pub fn store(&self) -> Arc<dyn Store> {
        self.store.clone()
    }

    /// Waits for something async, such as a method of [`store`](Self::store).
    pub fn wait<T>(&self, work: impl Future<Output = T>) -> T {
        self.runtime.block_on(work)
    }

    /// Stores models; those that are there already stay as they are.
    pub fn add_models(&self, models: &Models, origin: Origin) -> Result<(), StoreError> {
        let at_ms = now_ms();
        let writes: Vec<Write> =
            models.iter().map(|model| Write::Model { model: model.clone(), origin, at_ms }).collect();
        self.wait(self.store.commit(&writes)).map(drop)
    }

    /// Stores whole episodes, such as simulated ones; their models must be stored. Gives their numbers.
    pub fn add_episodes(&self, flown: &[Trajectory]) -> Result<Vec<EpisodeId>, StoreError> {
        let mut ids = Vec::with_capacity(flown.len());
        for part in flown.chunks(TOGETHER) {
            let at_ms = now_ms();
            let write = |flown| Write::Episode { record: Record::new(flown), at_ms };
            let writes: Vec<Write> = part.iter().map(write).collect();
            ids.extend(self.wait(self.store.commit(&writes))?.into_iter().flatten());
        }
        Ok(ids)
    }
}

impl Drop for Archive {
    fn drop(&mut self) {
        self.runtime.block_on(self.store.close());
    }
}
