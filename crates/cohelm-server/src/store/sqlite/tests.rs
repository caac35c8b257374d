//! What is SQLite's own: files that are not ours, damaged, newer, locked, in the wrong place.

mod backup;
mod released;
mod withdrawn;

use super::*;
use crate::store::{Page, Studies, Write};
use crate::testing::{Disk, record};
use std::fs;

/// A database that was closed, with some episodes in it.
async fn written() -> (tempfile::TempDir, PathBuf) {
    let Disk { folder, store } = Disk::new().await;
    let write = Write::Episode { record: record(1), at_ms: 0 };
    store.commit(&vec![write; 50]).await.unwrap();
    store.close().await;
    let path = folder.path().join("flights.db");
    (folder, path)
}

fn name(path: &Path) -> String {
    path.display().to_string()
}

fn files(folder: &Path) -> Vec<String> {
    let names =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

async fn opened(path: &Path) -> StoreError {
    SqliteStore::open(path).await.expect_err("it should not open")
}

#[tokio::test]
async fn what_was_written_is_there_when_it_is_opened_again() {
    let (_folder, path) = written().await;
    let store = SqliteStore::open_existing(&path).await.unwrap();
    assert_eq!(store.episodes(Page::newest(100)).await.unwrap().len(), 50);
}

#[tokio::test]
async fn no_folder_is_made_and_no_database_where_one_should_be() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a/b/flights.db");
    let missing = SqliteStore::open_existing(&path).await.expect_err("nothing is there");
    assert_eq!(missing, StoreError::Missing { database: name(&path) });
    let refused = opened(&path).await.to_string();
    let folder_of_it = name(&folder.path().join("a/b"));
    assert!(refused.contains(&format!("there is no folder {folder_of_it}; check that")), "{refused}");
    assert!(!folder.path().join("a").exists());
}

#[tokio::test]
async fn a_folder_that_is_none_is_said_so() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "not a folder").unwrap();
    let error = opened(&file.join("flights.db")).await;
    assert!(matches!(error, StoreError::Unwritable { .. }), "{error:?}");
    assert!(error.to_string().contains("--database"), "{error}");
    assert!(matches!(opened(folder.path()).await, StoreError::Unwritable { .. }));
}

#[tokio::test]
async fn a_foreign_file_is_refused_and_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("letter.txt");
    fs::write(&path, "Dear reader, this is a letter and no database.".repeat(20)).unwrap();
    let before = fs::read(&path).unwrap();
    assert_eq!(opened(&path).await, StoreError::Foreign { database: name(&path) });
    assert_eq!(fs::read(&path).unwrap(), before);
}

#[tokio::test]
async fn the_database_of_another_program_is_refused_and_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.db");
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(&path).create_if_missing(true);
    let pool = SqlitePool::connect_with(options).await.unwrap();
    sqlx::query("CREATE TABLE episodes (id INTEGER)").execute(&pool).await.unwrap();
    pool.close().await;
    let before = fs::read(&path).unwrap();
    assert_eq!(opened(&path).await, StoreError::Foreign { database: name(&path) });
    assert_eq!(fs::read(&path).unwrap(), before);
}

#[tokio::test]
async fn connections_that_close_at_the_same_moment_leave_nothing_beside_the_database() {
    let (folder, path) = written().await;
    // If closing the connections were all, some of these would leave a -wal file.
    for _ in 0..20 {
        let store = SqliteStore::open(&path).await.unwrap();
        store.commit(&[Write::Episode { record: record(1), at_ms: 0 }]).await.unwrap();
        on_every_connection(&store, "SELECT COUNT(*) FROM episodes").await;
        store.close().await;
        assert_eq!(files(folder.path()), ["flights.db"]);
    }
}

#[tokio::test]
async fn a_truncated_database_is_refused_wherever_it_is_cut() {
    let (_folder, path) = written().await;
    let whole = fs::read(&path).unwrap();
    for kept in [whole.len() - 1, whole.len() / 2, 4_096, 99, 17] {
        fs::write(&path, &whole[..kept]).unwrap();
        let error = opened(&path).await;
        assert!(matches!(error, StoreError::Damaged { .. }), "cut to {kept}: {error:?}");
    }
    fs::write(&path, &whole[..5]).unwrap();
    assert!(matches!(opened(&path).await, StoreError::Foreign { .. }));
}

#[tokio::test]
async fn an_overwritten_page_is_damage_and_no_panic() {
    let (_folder, path) = written().await;
    let mut bytes = fs::read(&path).unwrap();
    bytes[4_096..].fill(0xA5);
    fs::write(&path, &bytes).unwrap();
    let error = match SqliteStore::open(&path).await {
        Err(error) => error,
        Ok(store) => store.episodes(Page::newest(100)).await.expect_err("its pages are gone"),
    };
    assert!(matches!(error, StoreError::Damaged { .. }), "{error:?}");
}

#[tokio::test]
async fn a_newer_schema_is_refused_with_both_numbers() {
    let (_folder, path) = written().await;
    let store = SqliteStore::open(&path).await.unwrap();
    sqlx::query(
        "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) \
         VALUES (4711, 'of the future', 1, x'00', 0)",
    )
    .execute(&store.driver.pool)
    .await
    .unwrap();
    store.close().await;
    let known = migrations().last().unwrap().version;
    assert_eq!(opened(&path).await, StoreError::Newer { database: name(&path), found: 4711, known });
}

#[tokio::test]
async fn a_database_that_somebody_else_writes_to_is_locked() {
    let (_folder, path) = written().await;
    let (ours, theirs) = (SqliteStore::open(&path).await.unwrap(), SqliteStore::open(&path).await.unwrap());
    let held = theirs.lock_for_writing().await;
    let error = ours.commit(&[Write::Episode { record: record(1), at_ms: 0 }]).await.unwrap_err();
    assert!(matches!(error, StoreError::Locked { .. }), "{error:?}");
    assert_eq!(ours.episodes(Page::newest(100)).await.unwrap().len(), 50);
    held.rollback().await.unwrap();
    assert!(ours.commit(&[Write::Episode { record: record(1), at_ms: 0 }]).await.is_ok());
}

#[tokio::test]
async fn every_commit_waits_for_the_disk() {
    let disk = Disk::new().await;
    let pragma = |name: &'static str| sqlx::query_scalar::<_, i64>(name).fetch_one(&disk.store.driver.pool);
    assert_eq!(pragma("PRAGMA synchronous").await.unwrap(), 2, "2 is FULL");
    let journal: String =
        sqlx::query_scalar("PRAGMA journal_mode").fetch_one(&disk.store.driver.pool).await.unwrap();
    assert_eq!(journal, "wal");
}

#[tokio::test]
async fn a_full_disk_is_said_so_and_takes_nothing_back() {
    let (_folder, path) = written().await;
    let store = SqliteStore::open(&path).await.unwrap();
    // Every connection of the pool may grow the file no further.
    on_every_connection(&store, "PRAGMA max_page_count = 1").await;
    let episodes = vec![Write::Episode { record: record(1), at_ms: 0 }; 200];
    let error = store.commit(&episodes).await.unwrap_err();
    assert!(matches!(error, StoreError::Full { .. }) && !error.is_about_one_write(), "{error:?}");
    assert_eq!(store.episodes(Page::newest(999)).await.unwrap().len(), 50);
    // Somebody makes room.
    on_every_connection(&store, "PRAGMA max_page_count = 1000000").await;
    store.commit(&episodes).await.unwrap();
    assert_eq!(store.episodes(Page::newest(999)).await.unwrap().len(), 250);
}

async fn on_every_connection(store: &SqliteStore, sql: &'static str) {
    let mut connections = Vec::new();
    for _ in 0..4 {
        let mut connection = store.driver.pool.acquire().await.unwrap();
        sqlx::query(sql).execute(&mut *connection).await.unwrap();
        connections.push(connection);
    }
}

#[tokio::test]
async fn a_database_that_may_only_be_read_is_said_so_and_can_be_read() {
    let (_folder, path) = written().await;
    let store = SqliteStore::open(&path).await.unwrap();
    on_every_connection(&store, "PRAGMA query_only = ON").await;
    let error = store.commit(&[Write::Episode { record: record(1), at_ms: 0 }]).await.unwrap_err();
    assert!(matches!(error, StoreError::Unwritable { .. }), "{error:?}");
    assert_eq!(store.episodes(Page::newest(100)).await.unwrap().len(), 50);
}

#[cfg(unix)]
#[tokio::test]
async fn a_folder_and_a_file_without_rights_are_said_so() {
    use std::os::unix::fs::PermissionsExt;
    let (folder, path) = written().await;
    let allow = |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    for (what, without, with) in [(path.as_path(), 0o444, 0o644), (folder.path(), 0o555, 0o755)] {
        allow(what, without);
        let opened = SqliteStore::open(&path).await.map(drop);
        let new = SqliteStore::open(&folder.path().join("new.db")).await.map(drop);
        let everything_is_allowed = fs::OpenOptions::new().append(true).open(&path).is_ok()
            && fs::write(folder.path().join("probe"), "").is_ok();
        allow(what, with);
        if everything_is_allowed {
            // Root may write anyway.
            assert_eq!((opened, new), (Ok(()), Ok(())));
        } else {
            assert!(matches!(opened.or(new), Err(StoreError::Unwritable { .. })), "{what:?}");
        }
    }
}

#[tokio::test]
async fn what_stands_where_sqlite_wants_its_log_is_said_so() {
    let (folder, path) = written().await;
    fs::create_dir(folder.path().join("flights.db-wal")).unwrap();
    let error = opened(&path).await;
    assert!(matches!(error, StoreError::Unwritable { .. }), "{error:?}");
    assert_eq!(error.to_string().matches(&name(&path)).count(), 1, "{error}");
}
