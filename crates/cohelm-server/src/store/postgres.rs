//! Everything in a schema of its own, `cohelm`, of a PostgreSQL database; a commit is on the server's disk before it is
//! acknowledged.

mod door;
#[cfg(test)]
pub mod tests;

use super::driver::{Cell, Driver, Numbering, Row, Transaction, Value};
use super::sql::SqlStore;
use super::{StoreError, copy};
use async_trait::async_trait;
use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::postgres::{PgArguments, PgPool, PgRow, Postgres};
use sqlx::query::Query;
use sqlx::{Row as _, SqlSafeStr, TypeInfo, ValueRef};
use std::path::Path;
use std::time::Duration;
use tokio::time::timeout;

/// A database on a PostgreSQL server.
pub type PostgresStore = SqlStore<PostgresDriver>;

/// The connections to it.
#[derive(Clone, Debug)]
pub struct PostgresDriver {
    pool: PgPool,
    /// Its address without the password, for messages.
    name: String,
}

/// Whoever writes holds this lock until the end of the transaction: one writes at a time, as in SQLite, so that no two
/// can wait for each other. The number is "cohelm" in ASCII.
const WRITE: &str = "SELECT pg_advisory_xact_lock(109330143997037)";
/// How long the server may take for one statement. A machine that vanished says nothing, ever: shorter gives up on a
/// busy one, longer leaves pages without an answer.
const ANSWER: Duration = Duration::from_secs(20);
/// The same for writing whole tables anew.
const REWRITE: Duration = Duration::from_secs(300);
/// How long taking away what was deleted waits for readers: it is tried again later, and meanwhile nobody writes.
const SCRUB_PATIENCE: &str = "SET LOCAL lock_timeout = '300ms'";
/// Changing a type, even into itself, writes a table anew from what can be seen. A plain VACUUM leaves the bytes of
/// deleted rows in their place, and VACUUM FULL keeps those rows while anybody on the server looks at an earlier moment.
const SCRUB: [&str; 5] = [
    "ALTER TABLE events ALTER COLUMN at_ms TYPE BIGINT USING at_ms + 0",
    "ALTER TABLE records ALTER COLUMN bytes TYPE BYTEA USING bytes || ''::BYTEA",
    "ALTER TABLE chunks ALTER COLUMN to_tick TYPE BIGINT USING to_tick + 0",
    "ALTER TABLE episodes ALTER COLUMN ticks TYPE BIGINT USING ticks + 0",
    "ALTER TABLE participants ALTER COLUMN last_seq TYPE BIGINT USING last_seq + 0",
];
/// A table that is written anew looks empty to whoever looks at an earlier moment; held like this it is not written anew.
const HOLD: &str = "LOCK TABLE models, studies, participants, events, episodes, records, chunks, settings \
    IN ACCESS SHARE MODE";

impl PostgresStore {
    /// Opens the database at this address, such as `postgres://user@host/database`; makes our schema in it if there is
    /// none. The database itself must be there.
    pub async fn open(address: &str) -> Result<Self, StoreError> {
        PostgresDriver::connect(address, true).await.map(Self::new)
    }

    /// Opens the database at this address; an error if our schema is not in it.
    pub async fn open_existing(address: &str) -> Result<Self, StoreError> {
        PostgresDriver::connect(address, false).await.map(Self::new)
    }
}

impl PostgresDriver {
    async fn connect(address: &str, may_make: bool) -> Result<Self, StoreError> {
        let (options, name) = door::options(address)?;
        let driver = Self { pool: door::pool(options), name };
        let found = driver.within(ANSWER, door::look(&driver.pool)).await?;
        let has_schema = found.refuse_unsuitable(&driver.name)?;
        if !has_schema && !may_make {
            return Err(StoreError::Missing { database: driver.name });
        }
        driver.migrate(found.has_schema).await?;
        Ok(driver)
    }

    /// Brings the schema up to date. A migration that was released is never changed, only followed by another.
    async fn migrate(&self, schema_is_there: bool) -> Result<(), StoreError> {
        let migrations = migrations();
        let known = migrations.last().map_or(0, |migration| migration.version);
        let mut migrator = Migrator::with_migrations(migrations);
        if !schema_is_there {
            migrator.create_schema("cohelm");
        }
        let migrated = migrator.run(&self.pool).await;
        migrated.map_err(|error| door::migration_error(&self.name, known, error))
    }

    /// Its address without the password.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Waits for the server, but not for ever.
    async fn within<T>(
        &self,
        limit: Duration,
        work: impl Future<Output = Result<T, sqlx::Error>>,
    ) -> Result<T, StoreError> {
        within(&self.name, limit, work).await
    }

    async fn begin_with(&self, statement: &'static str) -> Result<PostgresTransaction, StoreError> {
        let transaction = self.within(ANSWER, self.pool.begin_with(statement)).await?;
        Ok(PostgresTransaction { transaction, name: self.name.clone(), limit: ANSWER })
    }
}

async fn within<T>(
    name: &str,
    limit: Duration,
    work: impl Future<Output = Result<T, sqlx::Error>>,
) -> Result<T, StoreError> {
    match timeout(limit, work).await {
        Ok(done) => done.map_err(|error| door::error(name, error)),
        Err(_) => Err(StoreError::Gone {
            database: name.into(),
            reason: format!("no answer for {} s", limit.as_secs()),
        }),
    }
}

fn migrations() -> Vec<Migration> {
    let sql = include_str!("../../migrations/postgres/0001_all.sql").into_sql_str();
    vec![Migration::new(1, "all".into(), MigrationType::Simple, sql, false)]
}

#[async_trait]
impl Driver for PostgresDriver {
    async fn read(&self, sql: &'static str, values: &[Value<'_>]) -> Result<Vec<Row>, StoreError> {
        self.within(ANSWER, async { rows(bound(sql, values).fetch_all(&self.pool).await?) }).await
    }

    async fn begin(&self) -> Result<Box<dyn Transaction>, StoreError> {
        let mut begun = self.begin_with("BEGIN").await?;
        begun.execute(WRITE, &[]).await?;
        Ok(Box::new(begun))
    }

    async fn snapshot(&self) -> Result<Box<dyn Transaction>, StoreError> {
        let mut begun = self.begin_with("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY").await?;
        begun.execute(HOLD, &[]).await?;
        Ok(Box::new(begun))
    }

    async fn scrub(&self) -> Result<(), StoreError> {
        let mut begun = self.begin_with("BEGIN").await?;
        begun.limit = REWRITE;
        for sql in [WRITE, SCRUB_PATIENCE].into_iter().chain(SCRUB) {
            begun.execute(sql, &[]).await?;
        }
        Box::new(begun).commit().await
    }

    async fn copy_into(&self, to: &Path) -> Result<(), StoreError> {
        copy::into_new_file(self.snapshot().await?, to).await
    }

    async fn close(&self) {
        self.pool.close().await;
    }
}

struct PostgresTransaction {
    transaction: sqlx::Transaction<'static, Postgres>,
    name: String,
    /// How long each of its statements may take.
    limit: Duration,
}

#[async_trait]
impl Transaction for PostgresTransaction {
    async fn execute(&mut self, sql: &'static str, values: &[Value<'_>]) -> Result<u64, StoreError> {
        let work = bound(sql, values).execute(&mut *self.transaction);
        within(&self.name, self.limit, work).await.map(|done| done.rows_affected())
    }

    async fn read(&mut self, sql: &'static str, values: &[Value<'_>]) -> Result<Vec<Row>, StoreError> {
        let work = bound(sql, values).fetch_all(&mut *self.transaction);
        within(&self.name, self.limit, async { rows(work.await?) }).await
    }

    fn numbering(&self) -> Numbering {
        Numbering {
            read: "SELECT CASE WHEN is_called THEN last_value ELSE 0 END FROM episodes_id_seq",
            write: "SELECT setval('episodes_id_seq', GREATEST($1, 1), $1 > 0)",
        }
    }

    async fn commit(self: Box<Self>) -> Result<(), StoreError> {
        within(&self.name, self.limit, self.transaction.commit()).await
    }
}

fn bound<'q>(sql: &'static str, values: &'q [Value<'_>]) -> Query<'q, Postgres, PgArguments> {
    values.iter().fold(sqlx::query(sql), |query, value| match *value {
        Value::Number(number) => query.bind(number),
        Value::Real(number) => query.bind(number),
        Value::Text(text) => query.bind(text),
        Value::Bytes(bytes) => query.bind(bytes),
    })
}

fn rows(rows: Vec<PgRow>) -> Result<Vec<Row>, sqlx::Error> {
    rows.iter().map(row).collect()
}

fn row(row: &PgRow) -> Result<Row, sqlx::Error> {
    (0..row.len()).map(|place| cell(row, place)).collect::<Result<_, _>>().map(Row::new)
}

fn cell(row: &PgRow, place: usize) -> Result<Cell, sqlx::Error> {
    let raw = row.try_get_raw(place)?;
    if raw.is_null() {
        return Ok(Cell::Nothing);
    }
    let kind = raw.type_info().into_owned();
    match kind.name() {
        "INT8" => row.try_get(place).map(Cell::Number),
        "FLOAT8" => row.try_get(place).map(Cell::Real),
        "BYTEA" => row.try_get(place).map(Cell::Bytes),
        // Any other type is one that we never made, and an error here.
        _ => row.try_get(place).map(Cell::Text),
    }
}
