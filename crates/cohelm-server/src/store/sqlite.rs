//! Episodes and models in one SQLite file: WAL, every commit on the disk before it is acknowledged.

mod door;
mod rows;
#[cfg(test)]
mod tests;

use super::{
    Chunk, Episode, EpisodeId, FlightKey, Page, Record, Store, StoreError, StoredModel, Write, queries,
};
use async_trait::async_trait;
use cohelm::plant::Ending;
use cohelm::trajectory::{FORMAT_VERSION, Setup};
use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::sqlite::{Sqlite, SqlitePool};
use sqlx::{SqlSafeStr, Transaction};
use std::path::{Path, PathBuf};

/// A database in one file (and, while it is open, its `-wal` and `-shm` beside it).
#[derive(Clone, Debug)]
pub struct SqliteStore {
    pool: SqlitePool,
    path: PathBuf,
}

impl SqliteStore {
    /// Opens the database in this file; makes it, and its folder, if there is none.
    pub async fn open(path: &Path) -> Result<Self, StoreError> {
        door::make_folder(path)?;
        Self::connect(path).await
    }

    /// Opens the database in this file; an error if there is none.
    pub async fn open_existing(path: &Path) -> Result<Self, StoreError> {
        if !path.exists() {
            return Err(StoreError::Missing { path: path.into() });
        }
        Self::connect(path).await
    }

    async fn connect(path: &Path) -> Result<Self, StoreError> {
        door::refuse_what_is_not_ours(path).await?;
        let pool = door::connect(path).await?;
        let store = Self { pool, path: path.into() };
        store.migrate().await?;
        Ok(store)
    }

    /// Brings the schema up to date. A migration that was released is never changed, only followed by another.
    async fn migrate(&self) -> Result<(), StoreError> {
        let migrations = migrations();
        let known = migrations.last().map_or(0, |migration| migration.version);
        let migrated = Migrator::with_migrations(migrations).run(&self.pool).await;
        migrated.map_err(|error| door::migration_error(&self.path, known, error))
    }

    /// Closes all connections; what is in the `-wal` file goes into the database.
    pub async fn close(&self) {
        self.pool.close().await;
    }

    /// Keeps everybody else from writing until it is dropped.
    #[cfg(test)]
    pub(crate) async fn lock_for_writing(&self) -> Transaction<'static, Sqlite> {
        self.pool.begin_with("BEGIN IMMEDIATE").await.expect("nobody else writes")
    }

    /// What no method does: forgets models that episodes name.
    #[cfg(test)]
    pub(crate) async fn lose_models(&self) {
        let mut connection = self.pool.acquire().await.expect("a connection");
        for sql in ["PRAGMA foreign_keys = OFF", "DELETE FROM models", "PRAGMA foreign_keys = ON"] {
            sqlx::query(sql).execute(&mut *connection).await.expect("it is carried out");
        }
    }

    fn wrong(&self) -> impl Fn(sqlx::Error) -> StoreError + '_ {
        |error| door::error(&self.path, error)
    }
}

fn migrations() -> Vec<Migration> {
    let migration = |version, name: &'static str, sql: &'static str| {
        Migration::new(version, name.into(), MigrationType::Simple, sql.into_sql_str(), false)
    };
    vec![migration(1, "episodes", include_str!("../../migrations/sqlite/0001_episodes.sql"))]
}

#[async_trait]
impl Store for SqliteStore {
    async fn commit(&self, writes: &[Write]) -> Result<Vec<Option<EpisodeId>>, StoreError> {
        if writes.is_empty() {
            return Ok(Vec::new());
        }
        // Immediate: the lock is taken before anything is read, so that two programs cannot deadlock.
        let transaction = self.pool.begin_with("BEGIN IMMEDIATE").await.map_err(self.wrong())?;
        let mut batch = Batch { transaction, path: &self.path };
        let mut made = Vec::with_capacity(writes.len());
        for write in writes {
            made.push(batch.carry_out(write).await?);
        }
        batch.transaction.commit().await.map_err(self.wrong())?;
        Ok(made)
    }

    async fn episodes(&self, page: Page) -> Result<Vec<Episode>, StoreError> {
        let before = page.before.map_or(i64::MAX, |id| id.0);
        let query = sqlx::query(queries::EPISODES_BEFORE).bind(before).bind(i64::from(page.limit));
        let rows = query.fetch_all(&self.pool).await.map_err(self.wrong())?;
        rows.iter().map(rows::episode).collect()
    }

    async fn episode(&self, id: EpisodeId) -> Result<Option<Episode>, StoreError> {
        let query = sqlx::query(queries::EPISODE).bind(id.0);
        let row = query.fetch_optional(&self.pool).await.map_err(self.wrong())?;
        row.as_ref().map(rows::episode).transpose()
    }

    async fn flight(&self, key: FlightKey) -> Result<Option<Episode>, StoreError> {
        let query = sqlx::query(queries::EPISODE_OF_KEY).bind(key.0.to_vec());
        let row = query.fetch_optional(&self.pool).await.map_err(self.wrong())?;
        row.as_ref().map(rows::episode).transpose()
    }

    async fn record(&self, id: EpisodeId) -> Result<Option<Vec<u8>>, StoreError> {
        let query = sqlx::query_scalar(queries::RECORD).bind(id.0);
        query.fetch_optional(&self.pool).await.map_err(self.wrong())
    }

    async fn chunks(&self, id: EpisodeId) -> Result<Vec<Chunk>, StoreError> {
        let query = sqlx::query(queries::CHUNKS).bind(id.0);
        let rows = query.fetch_all(&self.pool).await.map_err(self.wrong())?;
        rows.iter().map(rows::chunk).collect()
    }

    async fn models(&self) -> Result<Vec<StoredModel>, StoreError> {
        let rows = sqlx::query(queries::MODELS).fetch_all(&self.pool).await.map_err(self.wrong())?;
        rows.iter().map(rows::model).collect()
    }

    async fn model(&self, hash: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let query = sqlx::query_scalar(queries::MODEL).bind(hash);
        query.fetch_optional(&self.pool).await.map_err(self.wrong())
    }

    async fn check(&self) -> Result<(), StoreError> {
        let query = sqlx::query_scalar::<_, i64>(queries::CHECK);
        query.fetch_one(&self.pool).await.map(drop).map_err(self.wrong())
    }
}

/// A transaction under way; dropping it takes everything back.
struct Batch<'a> {
    transaction: Transaction<'static, Sqlite>,
    path: &'a Path,
}

type Query<'q> = sqlx::query::Query<'q, Sqlite, sqlx::sqlite::SqliteArguments>;

impl Batch<'_> {
    async fn carry_out(&mut self, write: &Write) -> Result<Option<EpisodeId>, StoreError> {
        match write {
            Write::Model { model, origin, at_ms } => {
                let card = model.card();
                let card_json = serde_json::to_string(card)
                    .map_err(|error| StoreError::Value { what: "a card", value: error.to_string() })?;
                let query = sqlx::query(queries::ADD_MODEL).bind(model.hash()).bind(origin.word());
                let query = query.bind(card.kind.word()).bind(&card.name).bind(&card.task.plant);
                self.execute(query.bind(card_json).bind(model.bytes()).bind(*at_ms)).await?;
            }
            Write::Keep { plant, hash, at_ms } => {
                self.execute(sqlx::query(queries::KEEP_NONE).bind(plant)).await?;
                if let Some(hash) = hash {
                    self.execute(sqlx::query(queries::KEEP).bind(hash).bind(*at_ms)).await?;
                }
            }
            Write::Begin { key, setup, at_ms } => {
                return self.add_episode(Some(*key), setup, *at_ms, None).await.map(Some);
            }
            Write::Chunk { episode, chunk } => self.add_chunk(*episode, chunk).await?,
            Write::Finish { episode, record, at_ms } => self.finish(*episode, record, *at_ms).await?,
            Write::Refuse { episode, reason, at_ms } => {
                let query = sqlx::query(queries::REFUSE).bind(episode.0).bind(reason).bind(*at_ms);
                self.execute_one(query, *episode, "a refusal").await?;
            }
            Write::Episode { record, at_ms } => {
                let ended = Some((record.ending, record.ticks));
                let id = self.add_episode(None, &record.setup, *at_ms, ended).await?;
                self.add_record(id, record).await?;
                return Ok(Some(id));
            }
            Write::Forget(episode) => {
                self.execute_one(sqlx::query(queries::FORGET).bind(episode.0), *episode, "being forgotten")
                    .await?;
            }
        }
        Ok(None)
    }

    async fn add_episode(
        &mut self,
        key: Option<FlightKey>,
        setup: &Setup,
        at_ms: i64,
        ended: Option<(Ending, u32)>,
    ) -> Result<EpisodeId, StoreError> {
        let setup_json = serde_json::to_string(setup)
            .map_err(|error| StoreError::Value { what: "a setup", value: error.to_string() })?;
        let id = sqlx::query_scalar(queries::ADD_EPISODE)
            .bind(key.map(|key| key.0.to_vec()))
            .bind(&setup.task.plant)
            .bind(i64::from(setup.plant_version))
            .bind(i64::from(FORMAT_VERSION))
            .bind(env!("CARGO_PKG_VERSION"))
            .bind(setup.rule.word())
            .bind(setup.seed as i64)
            .bind(&setup.pilot)
            .bind(setup.time_scale)
            .bind(&setup.values)
            .bind(&setup.intent)
            .bind(setup_json)
            .bind(at_ms)
            .bind(ended.map(|_| at_ms))
            .bind(ended.map_or(0, |(_, ticks)| i64::from(ticks)))
            .bind(ended.map(|(ending, _)| ending.word()));
        id.fetch_one(&mut *self.transaction)
            .await
            .map(EpisodeId)
            .map_err(|error| door::error(self.path, error))
    }

    async fn add_chunk(&mut self, episode: EpisodeId, chunk: &Chunk) -> Result<(), StoreError> {
        let (from, to) = (i64::from(chunk.from_tick), i64::from(chunk.to_tick));
        let advance = sqlx::query(queries::ADVANCE).bind(episode.0).bind(from).bind(to);
        self.execute_one(advance, episode, "a piece of its key log").await?;
        let query = sqlx::query(queries::ADD_CHUNK).bind(episode.0).bind(from).bind(to);
        let query = query.bind(chunk.digests.plant as i64).bind(chunk.digests.decisions as i64);
        self.execute(query.bind(&chunk.events)).await.map(drop)
    }

    async fn finish(&mut self, episode: EpisodeId, record: &Record, at_ms: i64) -> Result<(), StoreError> {
        let query = sqlx::query(queries::FINISH).bind(episode.0).bind(record.ending.word());
        let query = query.bind(i64::from(record.ticks)).bind(at_ms);
        self.execute_one(query, episode, "its end").await?;
        self.add_record(episode, record).await?;
        self.execute(sqlx::query(queries::DROP_CHUNKS).bind(episode.0)).await.map(drop)
    }

    async fn add_record(&mut self, episode: EpisodeId, record: &Record) -> Result<(), StoreError> {
        let query = sqlx::query(queries::ADD_RECORD).bind(episode.0).bind(&record.packed);
        self.execute(query).await.map(drop)
    }

    async fn execute(&mut self, query: Query<'_>) -> Result<u64, StoreError> {
        let done = query.execute(&mut *self.transaction).await;
        done.map(|done| done.rows_affected()).map_err(|error| door::error(self.path, error))
    }

    /// For a change that fits exactly one row, or nothing that is stored.
    async fn execute_one(
        &mut self,
        query: Query<'_>,
        episode: EpisodeId,
        what: &'static str,
    ) -> Result<(), StoreError> {
        match self.execute(query).await? {
            1 => Ok(()),
            _ => Err(StoreError::Misplaced { episode, what }),
        }
    }
}
