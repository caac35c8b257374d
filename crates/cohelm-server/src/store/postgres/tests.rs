//! What is PostgreSQL's own. Run by `tools/postgres-for-tests cargo test -p cohelm-server postgres -- --include-ignored`;
//! the server's address is in `COHELM_TEST_POSTGRES`.

mod lost;

use super::*;
use crate::store::{
    EpisodeId, Page, ParticipantId, SqliteStore, Store, Studies, TokenHash, Trial, Write, open,
    open_existing, restore,
};
use crate::testing::{key, record, setup};
use std::sync::atomic::{AtomicU32, Ordering};

/// A database of its own on the server, and a store in it.
pub struct EmptyDatabase {
    pub store: PostgresStore,
    pub address: String,
    name: String,
    server: PgPool,
}

impl EmptyDatabase {
    pub async fn new() -> Self {
        Self::made_with("").await
    }

    /// `how` follows CREATE DATABASE.
    async fn made_with(how: &str) -> Self {
        let (server, name, address) = empty(how).await;
        Self { store: PostgresStore::open(&address).await.unwrap(), address, name, server }
    }

    /// Does something behind the store's back.
    pub async fn sql(&self, sql: &str) {
        execute(&self.store.driver.pool, sql).await;
    }

    /// A setting of the database, for connections that are made from now on.
    async fn set(&self, setting: &str) {
        execute(&self.server, &format!("ALTER DATABASE {} SET {setting}", self.name)).await;
    }

    pub async fn remove(self) {
        Store::close(&self.store).await;
        execute(&self.server, &format!("DROP DATABASE {} WITH (FORCE)", self.name)).await;
    }
}

async fn execute(pool: &PgPool, sql: &str) {
    sqlx::raw_sql(sqlx::AssertSqlSafe(sql.to_owned())).execute(pool).await.unwrap();
}

/// A database without our schema: connections to its server, its name, its address.
async fn empty(how: &str) -> (PgPool, String, String) {
    static MADE: AtomicU32 = AtomicU32::new(0);
    let server = std::env::var("COHELM_TEST_POSTGRES")
        .expect("the address of a server that may be written to, as tools/postgres-for-tests gives it");
    let name = format!("cohelm_{}_{}", std::process::id(), MADE.fetch_add(1, Ordering::Relaxed));
    let pool = PgPool::connect(&server).await.unwrap();
    execute(&pool, &format!("CREATE DATABASE {name} {how}")).await;
    let (place, _) = server.rsplit_once('/').unwrap();
    (pool, name.clone(), format!("{place}/{name}"))
}

fn episode() -> Write {
    Write::Episode { record: record(1), at_ms: 0 }
}

async fn refused(address: &str) -> StoreError {
    PostgresStore::open(address).await.map(drop).expect_err("it should not open")
}

#[tokio::test]
#[ignore = "needs a server"]
async fn what_was_written_is_there_when_it_is_opened_again() {
    let (_, _, address) = empty("").await;
    let missing = open_existing(&address).await.map(drop);
    assert!(matches!(missing, Err(StoreError::Missing { .. })), "{missing:?}");
    let store = open(&address).await.unwrap();
    store.commit(&[episode(), episode()]).await.unwrap();
    store.close().await;
    let store = open_existing(&address).await.unwrap();
    assert_eq!(store.episodes(Page::newest(9)).await.unwrap().len(), 2);
}

#[tokio::test]
#[ignore = "needs a server"]
async fn tables_of_others_are_left_alone_and_a_schema_of_others_is_refused() {
    let (_, _, address) = empty("").await;
    let pool = PgPool::connect(&address).await.unwrap();
    execute(
        &pool,
        "CREATE TABLE episodes (id BIGINT); CREATE SCHEMA cohelm; CREATE TABLE cohelm.letters (a TEXT)",
    )
    .await;
    let error = refused(&address).await;
    assert!(
        matches!(&error, StoreError::Foreign { database } if database.contains("schema cohelm")),
        "{error:?}"
    );
    execute(&pool, "DROP TABLE cohelm.letters").await;
    assert!(PostgresStore::open(&address).await.is_ok());
    let theirs: i64 =
        sqlx::query_scalar("SELECT COUNT(*) FROM public.episodes").fetch_one(&pool).await.unwrap();
    assert_eq!(theirs, 0);
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_newer_schema_is_refused_with_both_numbers() {
    let database = EmptyDatabase::new().await;
    let sql = "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) \
        VALUES (4711, 'of the future', true, '', 0)";
    database.sql(sql).await;
    let known = migrations().last().unwrap().version;
    let name = database.store.driver.name.clone();
    assert_eq!(refused(&database.address).await, StoreError::Newer { database: name, found: 4711, known });
    database.remove().await;
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_database_that_cannot_hold_every_language_is_refused() {
    let (_, _, address) = empty("ENCODING 'SQL_ASCII' TEMPLATE template0").await;
    let error = refused(&address).await;
    assert!(matches!(&error, StoreError::Unsuitable { reason, .. } if reason.contains("UTF8")), "{error:?}");
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_commit_waits_for_the_disk_whatever_the_database_is_set_to() {
    let (_, name, address) = empty("").await;
    let pool = PgPool::connect(&address).await.unwrap();
    execute(&pool, &format!("ALTER DATABASE {name} SET synchronous_commit = off")).await;
    let store = PostgresStore::open(&address).await.unwrap();
    let mut row =
        store.driver.read("SELECT current_setting('synchronous_commit')", &[]).await.unwrap().remove(0);
    assert_eq!(row.take::<String>("synchronous_commit"), Ok("on".into()));
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_database_that_somebody_else_writes_to_is_locked_and_can_be_read() {
    let database = EmptyDatabase::new().await;
    let other = PostgresStore::open(&database.address).await.unwrap();
    let held = other.driver.begin().await.unwrap();
    let error = database.store.commit(&[episode()]).await.unwrap_err();
    assert!(matches!(error, StoreError::Locked { .. }), "{error:?}");
    assert_eq!(database.store.episodes(Page::newest(9)).await, Ok(vec![]));
    drop(held);
    assert!(database.store.commit(&[episode()]).await.is_ok());
    database.remove().await;
}

/// Only a server whose disk is full says so of itself; this one is made to say it.
#[tokio::test]
#[ignore = "needs a server"]
async fn a_full_disk_is_said_so_and_takes_nothing_back() {
    let database = EmptyDatabase::new().await;
    database.store.commit(&[episode()]).await.unwrap();
    let full = "CREATE FUNCTION full_disk() RETURNS trigger LANGUAGE plpgsql AS \
        $$ BEGIN RAISE EXCEPTION 'could not extend file' USING ERRCODE = 'disk_full'; END $$;
        CREATE TRIGGER full_disk BEFORE INSERT ON records EXECUTE FUNCTION full_disk()";
    database.sql(full).await;
    let error = database.store.commit(&[episode(), episode()]).await.unwrap_err();
    assert!(matches!(error, StoreError::Full { .. }) && !error.is_about_one_write(), "{error:?}");
    assert_eq!(database.store.episodes(Page::newest(9)).await.unwrap().len(), 1);
    database.sql("DROP TRIGGER full_disk ON records").await;
    assert!(database.store.commit(&[episode()]).await.is_ok());
    database.remove().await;
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_database_that_may_only_be_read_is_said_so() {
    let database = EmptyDatabase::new().await;
    database.set("default_transaction_read_only = on").await;
    let store = PostgresStore::open(&database.address).await;
    let error = match store {
        Ok(store) => store.commit(&[episode()]).await.unwrap_err(),
        Err(error) => error,
    };
    assert!(matches!(error, StoreError::Unwritable { .. }), "{error:?}");
    database.remove().await;
}

/// Anna, who said and did what can be recognised.
async fn anna(store: &PostgresStore) -> Vec<Write> {
    let hash = "ab".repeat(32);
    let participant = ParticipantId(1);
    let study = Write::Study { hash: hash.clone(), name: "s".into(), text: "t".into(), at_ms: 1 };
    let anna = Write::Participant {
        id: participant,
        study: hash,
        code: "A".into(),
        token: TokenHash([1; 32]),
        at_ms: 1,
    };
    let trial = Trial { participant, step: "flight-MARKED".into() };
    let begin = Write::BeginTrial { key: key(1), setup: setup(1), at_ms: 1, trial };
    let episode = store.commit(&[study, anna, begin]).await.unwrap()[2].unwrap();
    let event_json = r#""something MARKED""#.into();
    store.commit(&[Write::Event { participant, expected_seq: 1, event_json, at_ms: 1 }]).await.unwrap();
    store.commit(&[Write::Refuse { episode, reason: "it is MARKED".into(), at_ms: 1 }]).await.unwrap();
    vec![Write::Withdraw { participant, left: vec!["{}".into()], at_ms: 2 }]
}

/// In how many files of tables the bytes "MARKED" are.
async fn marked(database: &EmptyDatabase) -> i64 {
    database.sql("CHECKPOINT").await;
    let sql = "SELECT COUNT(*) FROM pg_class WHERE relnamespace IN ('cohelm'::regnamespace, 'pg_toast'::regnamespace) \
        AND relkind IN ('r', 't', 'i') AND position('MARKED'::bytea IN pg_read_binary_file(pg_relation_filepath(oid))) > 0";
    sqlx::query_scalar(sql).fetch_one(&database.store.driver.pool).await.unwrap()
}

#[tokio::test]
#[ignore = "needs a server"]
async fn nothing_of_who_withdrew_is_left_in_the_files() {
    let database = EmptyDatabase::new().await;
    let withdraw = anna(&database.store).await;
    assert_eq!(marked(&database).await, 2, "events and episodes");
    database.store.commit(&withdraw).await.unwrap();
    assert_eq!(marked(&database).await, 0);
    database.remove().await;
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_backup_under_way_keeps_what_is_withdrawn_meanwhile_and_only_delays_its_end() {
    let database = EmptyDatabase::new().await;
    let withdraw = anna(&database.store).await;
    let mut reading = database.store.driver.snapshot().await.unwrap();
    database.store.commit(&withdraw).await.unwrap();
    assert_eq!(reading.read("SELECT event FROM events", &[]).await.unwrap().len(), 1);
    assert!(marked(&database).await > 0, "a backup reads the moment before");
    drop(reading);
    database.store.commit(&[Write::Setting { name: "a".into(), value: "b".into() }]).await.unwrap();
    assert_eq!(marked(&database).await, 0);
    database.remove().await;
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_backup_is_a_file_of_sqlite_and_can_be_restored() {
    let database = EmptyDatabase::new().await;
    let withdraw = anna(&database.store).await;
    let last = database.store.commit(&[episode(), episode()]).await.unwrap()[1].unwrap();
    let begin = Write::Begin { key: key(2), setup: setup(2), at_ms: 1 };
    let forgotten = database.store.commit(&[begin]).await.unwrap()[0].unwrap();
    database.store.commit(&[Write::Forget(forgotten)]).await.unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("backup.db");
    database.store.backup(&file).await.unwrap();

    let (_, _, elsewhere) = empty("").await;
    restore(&file, &elsewhere).await.unwrap();
    let (copy, restored) = (
        SqliteStore::open_existing(&file).await.unwrap(),
        PostgresStore::open_existing(&elsewhere).await.unwrap(),
    );
    let stores: [&dyn Store; 2] = [&copy, &restored];
    for store in stores {
        assert_eq!(store.episodes(Page::newest(9)).await, database.store.episodes(Page::newest(9)).await);
        assert_eq!(store.record(last).await, database.store.record(last).await);
        assert_eq!(store.events(ParticipantId(1), 0).await, database.store.events(ParticipantId(1), 0).await);
        // A number that was given once is not given again, though its episode is gone.
        assert_eq!(store.commit(&[episode()]).await.unwrap(), [Some(EpisodeId(forgotten.0 + 1))]);
        assert!(store.commit(&withdraw).await.is_ok());
    }
    let again = restore(&file, &elsewhere).await.unwrap_err();
    assert!(matches!(again, StoreError::NotEmpty { .. }), "{again:?}");
    database.remove().await;
}

#[test]
fn what_crosses_a_network_is_encrypted_unless_somebody_says_otherwise() {
    use sqlx::postgres::PgSslMode;
    let mode = |address: &str| door::options(address).unwrap().0.get_ssl_mode();
    assert!(matches!(mode("postgres://anna@db.example.org/study"), PgSslMode::VerifyFull));
    assert!(matches!(mode("postgres://anna@db.example.org/study?sslmode=disable"), PgSslMode::Disable));
    for here in ["localhost", "127.0.0.1", "[::1]", "%2Frun%2Fpostgresql"] {
        assert!(matches!(mode(&format!("postgres://anna@{here}/study")), PgSslMode::Prefer), "{here}");
    }
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_server_without_encryption_is_said_so_where_it_is_demanded() {
    let (_, _, address) = empty("").await;
    let error = refused(&format!("{address}?sslmode=require")).await;
    assert!(matches!(error, StoreError::NotEncrypted { .. }), "{error:?}");
}

#[tokio::test]
#[ignore = "needs a server"]
async fn a_database_that_is_not_there_is_said_so_with_its_address() {
    let (_, name, address) = empty("").await;
    let error = refused(&address.replace(&name, "nowhere")).await;
    assert!(matches!(error, StoreError::NoEntry { .. }), "{error:?}");
    assert!(error.to_string().contains("nowhere"), "{error}");
}

#[tokio::test]
async fn no_error_shows_a_password() {
    for address in
        ["postgres://anna:geheim@127.0.0.1:1/study", "postgres://anna:geheim@[::1/x", "mysql://a:geheim@b/c"]
    {
        let error = open(address).await.map(drop).unwrap_err();
        let told = format!("{error} {error:?}");
        assert!(!told.contains("geheim"), "{told}");
        let expected = match address.contains("127.0.0.1") {
            true => matches!(error, StoreError::Gone { .. }),
            false => matches!(error, StoreError::Address { .. }),
        };
        assert!(expected, "{error:?}");
    }
}
