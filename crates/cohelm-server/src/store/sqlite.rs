//! Everything in one SQLite file: WAL, every commit on the disk before it is acknowledged.

mod door;
#[cfg(test)]
mod tests;

use super::driver::{Cell, Driver, Numbering, Row, Transaction, Value};
use super::sql::SqlStore;
use super::{Store, StoreError};
use async_trait::async_trait;
use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::query::Query;
use sqlx::sqlite::{Sqlite, SqliteArguments, SqlitePool, SqliteRow};
use sqlx::{Row as _, SqlSafeStr, TypeInfo, ValueRef};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A database in one file (and, while it is open, its `-wal` and `-shm` beside it).
pub type SqliteStore = SqlStore<SqliteDriver>;

/// How long overwriting what was deleted waits for readers.
const SCRUB_PATIENCE: Duration = Duration::from_millis(300);

/// The connections to it.
#[derive(Clone, Debug)]
pub struct SqliteDriver {
    pool: SqlitePool,
    path: PathBuf,
}

impl SqliteStore {
    /// Opens the database in this file; makes it if there is none, but not its folder.
    pub async fn open(path: &Path) -> Result<Self, StoreError> {
        door::want_folder(path)?;
        SqliteDriver::connect(path).await.map(Self::new)
    }

    /// Opens the database in this file; an error if there is none.
    pub async fn open_existing(path: &Path) -> Result<Self, StoreError> {
        if !path.exists() {
            return Err(StoreError::Missing { database: path.display().to_string() });
        }
        SqliteDriver::connect(path).await.map(Self::new)
    }

    /// Closes all connections; what is in the `-wal` file goes into the database.
    pub async fn close(&self) {
        Store::close(self).await;
    }
}

/// How long to wait for the thread of a connection, and how often at most: half a second is more than a rollback takes.
const FOR_THE_OTHER_THREAD: Duration = Duration::from_millis(5);
/// See [`FOR_THE_OTHER_THREAD`].
const MOST_WAITS: u32 = 100;

/// What tests do behind the store's back.
#[cfg(test)]
impl SqliteStore {
    /// Keeps everybody else from writing until it is dropped.
    pub(crate) async fn lock_for_writing(&self) -> sqlx::Transaction<'static, Sqlite> {
        self.driver.pool.begin_with("BEGIN IMMEDIATE").await.expect("nobody else writes")
    }

    /// What no method does: forgets models that episodes name.
    pub(crate) async fn lose_models(&self) {
        let mut connection = self.driver.pool.acquire().await.expect("a connection");
        for sql in ["PRAGMA foreign_keys = OFF", "DELETE FROM models", "PRAGMA foreign_keys = ON"] {
            sqlx::query(sql).execute(&mut *connection).await.expect("it is carried out");
        }
    }
}

impl SqliteDriver {
    async fn connect(path: &Path) -> Result<Self, StoreError> {
        door::refuse_what_is_not_ours(path).await?;
        let pool = door::connect(path).await?;
        let driver = Self { pool, path: path.into() };
        driver.migrate().await?;
        Ok(driver)
    }

    /// Brings the schema up to date. A migration that was released is never changed, only followed by another.
    async fn migrate(&self) -> Result<(), StoreError> {
        let migrations = migrations();
        let known = migrations.last().map_or(0, |migration| migration.version);
        let migrated = Migrator::with_migrations(migrations).run(&self.pool).await;
        migrated.map_err(|error| door::migration_error(&self.path, known, error))
    }

    async fn begin_with(&self, statement: &'static str) -> Result<Box<dyn Transaction>, StoreError> {
        let mut begun = self.pool.begin_with(statement).await;
        // What a full disk ended is taken back by the connection's own thread, which may not have come to it yet.
        for _ in 0..MOST_WAITS {
            if !matches!(begun, Err(sqlx::Error::InvalidSavePointStatement)) {
                break;
            }
            tokio::time::sleep(FOR_THE_OTHER_THREAD).await;
            begun = self.pool.begin_with(statement).await;
        }
        let transaction = begun.map_err(self.wrong())?;
        Ok(Box::new(SqliteTransaction { transaction, path: self.path.clone() }))
    }

    fn locked(&self) -> StoreError {
        StoreError::Locked { database: self.path.display().to_string(), waited_s: door::PATIENCE.as_secs() }
    }

    fn wrong(&self) -> impl Fn(sqlx::Error) -> StoreError + '_ {
        |error| door::error(&self.path, error)
    }
}

fn migrations() -> Vec<Migration> {
    let migration = |version, name: &'static str, sql: &'static str| {
        Migration::new(version, name.into(), MigrationType::Simple, sql.into_sql_str(), false)
    };
    vec![
        migration(1, "episodes", include_str!("../../migrations/sqlite/0001_episodes.sql")),
        migration(2, "studies", include_str!("../../migrations/sqlite/0002_studies.sql")),
    ]
}

#[async_trait]
impl Driver for SqliteDriver {
    async fn read(&self, sql: &'static str, values: &[Value<'_>]) -> Result<Vec<Row>, StoreError> {
        let rows = bound(sql, values).fetch_all(&self.pool).await.map_err(self.wrong())?;
        rows.iter().map(row).collect::<Result<_, _>>().map_err(self.wrong())
    }

    async fn begin(&self) -> Result<Box<dyn Transaction>, StoreError> {
        // Immediate: the lock is taken before anything is read, so that two programs cannot deadlock.
        self.begin_with("BEGIN IMMEDIATE").await
    }

    async fn snapshot(&self) -> Result<Box<dyn Transaction>, StoreError> {
        self.begin_with("BEGIN").await
    }

    async fn scrub(&self) -> Result<(), StoreError> {
        // `secure_delete` wrote zeros over it; what it was is still in the -wal file, until that is emptied.
        // Readers of an earlier moment keep it from being emptied. They are not waited for long, since nobody writes
        // meanwhile, and it is tried again later.
        let mut connection = self.pool.acquire().await.map_err(self.wrong())?;
        door::wait_for_others(&mut connection, SCRUB_PATIENCE).await.map_err(self.wrong())?;
        let emptied = sqlx::query("PRAGMA wal_checkpoint(TRUNCATE)").fetch_one(&mut *connection).await;
        door::wait_for_others(&mut connection, door::PATIENCE).await.map_err(self.wrong())?;
        match emptied.and_then(|row| row.try_get::<i64, _>(0)).map_err(self.wrong())? {
            0 => Ok(()),
            _ => Err(self.locked()),
        }
    }

    async fn copy_into(&self, to: &Path) -> Result<(), StoreError> {
        // Errors of writing are told of the new file: it is the one that needs room.
        let wrong = |error| door::error(to, error);
        let name = to.to_str().ok_or_else(|| StoreError::Unwritable {
            database: to.display().to_string(),
            reason: "SQLite wants a name in Unicode".into(),
        })?;
        sqlx::query("VACUUM INTO $1").bind(name).execute(&self.pool).await.map(drop).map_err(wrong)
    }

    async fn close(&self) {
        self.pool.close().await;
        door::take_the_wal_in(&self.path).await;
    }
}

struct SqliteTransaction {
    transaction: sqlx::Transaction<'static, Sqlite>,
    path: PathBuf,
}

#[async_trait]
impl Transaction for SqliteTransaction {
    async fn execute(&mut self, sql: &'static str, values: &[Value<'_>]) -> Result<u64, StoreError> {
        let done = bound(sql, values).execute(&mut *self.transaction).await;
        done.map(|done| done.rows_affected()).map_err(|error| door::error(&self.path, error))
    }

    async fn read(&mut self, sql: &'static str, values: &[Value<'_>]) -> Result<Vec<Row>, StoreError> {
        let rows = bound(sql, values).fetch_all(&mut *self.transaction).await;
        let rows = rows.and_then(|rows| rows.iter().map(row).collect::<Result<_, _>>());
        rows.map_err(|error| door::error(&self.path, error))
    }

    fn numbering(&self) -> Numbering {
        Numbering {
            read: "SELECT COALESCE(MAX(seq), 0) FROM sqlite_sequence WHERE name = 'episodes'",
            write: "INSERT INTO sqlite_sequence (name, seq) VALUES ('episodes', $1)",
        }
    }

    async fn commit(self: Box<Self>) -> Result<(), StoreError> {
        self.transaction.commit().await.map_err(|error| door::error(&self.path, error))
    }
}

fn bound<'q>(sql: &'static str, values: &'q [Value<'_>]) -> Query<'q, Sqlite, SqliteArguments> {
    values.iter().fold(sqlx::query(sql), |query, value| match *value {
        Value::Number(number) => query.bind(number),
        Value::Real(number) => query.bind(number),
        Value::Text(text) => query.bind(text),
        Value::Bytes(bytes) => query.bind(bytes),
    })
}

fn row(row: &SqliteRow) -> Result<Row, sqlx::Error> {
    (0..row.len()).map(|place| cell(row, place)).collect::<Result<_, _>>().map(Row::new)
}

fn cell(row: &SqliteRow, place: usize) -> Result<Cell, sqlx::Error> {
    let raw = row.try_get_raw(place)?;
    if raw.is_null() {
        return Ok(Cell::Nothing);
    }
    let kind = raw.type_info().into_owned();
    match kind.name() {
        "INTEGER" => row.try_get_unchecked(place).map(Cell::Number),
        "REAL" => row.try_get_unchecked(place).map(Cell::Real),
        "TEXT" => row.try_get_unchecked(place).map(Cell::Text),
        _ => row.try_get_unchecked(place).map(Cell::Bytes),
    }
}
