//! The same database for a program that waits: what the command line uses.

use super::{
    Episode, EpisodeId, Origin, Page, Record, SqliteStore, Store, StoreError, Write, now_ms, unpack,
};
use crate::hangar::Hangar;
use crate::recover::{RecoverError, recover};
use crate::verify::{Report, verify_episodes};
use cohelm::registry::Plants;
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
        let runtime = runtime.map_err(|error| StoreError::Other {
            database: path.display().to_string(),
            reason: error.to_string(),
        })?;
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

/// What the command line asks of it.
impl Archive {
    /// A part of the list of episodes, newest first.
    pub fn episodes(&self, page: Page) -> Result<Vec<Episode>, StoreError> {
        self.wait(self.store.episodes(page))
    }

    /// The record of a finished episode; `None` if there is none.
    pub fn trajectory(&self, id: EpisodeId) -> Result<Option<Trajectory>, StoreError> {
        let Some(packed) = self.wait(self.store.record(id))? else { return Ok(None) };
        Ok(Some(Trajectory::from_bytes(&unpack(&packed)?)?))
    }

    /// Flies every finished episode again, on all cores.
    pub fn verify(&self, plants: Plants, models: Models) -> Result<Report, StoreError> {
        self.wait(verify_episodes(&Hangar::new(plants, models, self.store())))
    }

    /// The record of an interrupted flight up to its last committed tick.
    pub fn recover(&self, id: EpisodeId, plants: Plants, models: Models) -> Result<Trajectory, RecoverError> {
        self.wait(recover(&Hangar::new(plants, models, self.store()), id))
    }
}

impl Drop for Archive {
    fn drop(&mut self) {
        self.runtime.block_on(self.store.close());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{flown, plants};

    #[test]
    fn simulated_episodes_are_stored_listed_read_and_verified_without_async() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flights.db");
        assert!(matches!(Archive::open_existing(&path), Err(StoreError::Missing { .. })));
        let archive = Archive::open(&path).unwrap();
        let episodes: Vec<Trajectory> = (0..TOGETHER as u64 + 3).map(|seed| flown(seed % 4)).collect();
        let ids = archive.add_episodes(&episodes).unwrap();
        assert_eq!(ids.len(), episodes.len());
        assert_eq!(archive.episodes(Page::newest(2)).unwrap()[0].id, *ids.last().unwrap());
        assert_eq!(archive.trajectory(ids[5]).unwrap(), Some(episodes[5].clone()));
        assert_eq!(archive.trajectory(EpisodeId(9_999)).unwrap(), None);
        drop(archive);
        let report = Archive::open_existing(&path).unwrap().verify(plants(), Models::new()).unwrap();
        assert_eq!((report.identical, report.others), (episodes.len(), vec![]));
    }
}
