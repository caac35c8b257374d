//! What stands before a database file: whether it may be opened, and what its errors mean.

use crate::store::StoreError;
use sqlx::migrate::MigrateError;
use sqlx::sqlite::{
    SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};
use sqlx::{AssertSqlSafe, ConnectOptions, Connection, SqliteConnection};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tracing::warn;

/// What SQLite's header says of whose file it is: "CHLM".
const APPLICATION_ID: i64 = 0x4348_4c4d;
/// How long to wait for another program that writes: shorter fails where patience would have done.
pub const PATIENCE: Duration = Duration::from_millis(if cfg!(test) { 300 } else { 5_000 });
/// One connection writes, the others read meanwhile.
const CONNECTIONS: u32 = 4;

/// A database is made where its folder is: a name with a slip in it is not to hide flights in a folder of its own.
pub fn want_folder(path: &Path) -> Result<(), StoreError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder {
        Some(folder) if !folder.is_dir() => Err(StoreError::Unwritable {
            database: path.display().to_string(),
            reason: format!("there is no folder {}", folder.display()),
        }),
        _ => Ok(()),
    }
}

/// Looks into the file without changing a byte of it. No file, an empty one and an empty database are fine.
pub async fn refuse_what_is_not_ours(path: &Path) -> Result<(), StoreError> {
    if std::fs::metadata(path).is_ok_and(|meta| meta.is_file() && meta.len() > 0) {
        refuse_cut_off(path)?;
        refuse_foreign(path).await?;
    }
    Ok(())
}

/// The header says how many pages there should be. It may be behind while a `-wal` file holds newer pages.
fn refuse_cut_off(path: &Path) -> Result<(), StoreError> {
    use std::io::Read;
    let unreadable = |error: std::io::Error| StoreError::Unwritable {
        database: path.display().to_string(),
        reason: error.to_string(),
    };
    let mut file = std::fs::File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    let mut header = Vec::new();
    file.by_ref().take(100).read_to_end(&mut header).map_err(unreadable)?;
    if !header.starts_with(b"SQLite format 3\0") {
        return Err(StoreError::Foreign { database: path.display().to_string() });
    }
    let damaged = |reason: String| StoreError::Damaged { database: path.display().to_string(), reason };
    if header.len() < 100 {
        return Err(damaged(format!("it is cut off after {length} bytes")));
    }
    let page = match u64::from(u16::from_be_bytes([header[16], header[17]])) {
        1 => 65_536,
        bytes => bytes,
    };
    let pages = u64::from(u32::from_be_bytes([header[28], header[29], header[30], header[31]]));
    let newer_elsewhere = std::fs::metadata(wal(path)).is_ok_and(|meta| meta.len() > 0);
    if length < pages * page && !newer_elsewhere {
        return Err(damaged(format!("it is cut off: {length} of {} bytes are there", pages * page)));
    }
    Ok(())
}

/// The file that holds what is not yet in the database's own.
fn wal(path: &Path) -> PathBuf {
    let mut wal = path.as_os_str().to_owned();
    wal.push("-wal");
    wal.into()
}

async fn refuse_foreign(path: &Path) -> Result<(), StoreError> {
    let wrong = |error| self::error(path, error);
    let options = SqliteConnectOptions::new().filename(path).read_only(true).busy_timeout(PATIENCE);
    let mut connection = options.connect().await.map_err(wrong)?;
    let id: i64 =
        sqlx::query_scalar("PRAGMA application_id").fetch_one(&mut connection).await.map_err(wrong)?;
    let tables: i64 = sqlx::query_scalar("SELECT COUNT(*) FROM sqlite_master")
        .fetch_one(&mut connection)
        .await
        .map_err(wrong)?;
    connection.close().await.map_err(wrong)?;
    let new = id == 0 && tables == 0;
    if id == APPLICATION_ID || new {
        Ok(())
    } else {
        Err(StoreError::Foreign { database: path.display().to_string() })
    }
}

/// Opens the file as we use it.
pub async fn connect(path: &Path) -> Result<SqlitePool, StoreError> {
    let options = SqliteConnectOptions::new()
        .filename(path)
        .create_if_missing(true)
        .foreign_keys(true)
        .busy_timeout(PATIENCE)
        .journal_mode(SqliteJournalMode::Wal)
        // What is deleted is overwritten with zeros: people may withdraw what they gave.
        .pragma("secure_delete", "ON")
        // With less, a commit that was acknowledged may be gone after a loss of power.
        .synchronous(SqliteSynchronous::Full);
    let pool = SqlitePoolOptions::new().max_connections(CONNECTIONS).connect_with(options).await;
    let pool = pool.map_err(|error| self::error(path, error))?;
    sqlx::query("PRAGMA application_id = 1128811597")
        .execute(&pool)
        .await
        .map_err(|error| self::error(path, error))?;
    Ok(pool)
}

/// Ends what closing left undone. The last connection takes the `-wal` file into the database; but of several that close
/// at the same moment each takes another for the last, and the file stays. Nothing is lost by that, yet whoever then
/// copies the database's file alone would not have all. One connection by itself is the last. (While another program has
/// the database open the file stays, as it must.)
pub async fn take_the_wal_in(path: &Path) {
    if !wal(path).exists() {
        return;
    }
    let taken = async {
        let options = SqliteConnectOptions::new().filename(path).busy_timeout(PATIENCE);
        let mut connection = options.connect().await?;
        sqlx::query("PRAGMA wal_checkpoint").execute(&mut connection).await?;
        connection.close().await
    };
    if let Err(error) = taken.await {
        let wal = wal(path);
        warn!(file = %wal.display(), %error, "the last writes stay in this file; keep it beside the database");
    }
}

/// How long this connection waits from now on.
pub async fn wait_for_others(
    connection: &mut SqliteConnection,
    patience: Duration,
) -> Result<(), sqlx::Error> {
    let sql = format!("PRAGMA busy_timeout = {}", patience.as_millis());
    // Safe to execute: it holds a number and nothing else.
    sqlx::query(AssertSqlSafe(sql)).execute(connection).await.map(drop)
}

/// What an error of the database means.
pub fn error(path: &Path, error: sqlx::Error) -> StoreError {
    let database = path.display().to_string();
    let sqlx::Error::Database(told) = &error else {
        return StoreError::Other { database, reason: error.to_string() };
    };
    let reason = told.message().to_owned();
    let code: i64 = told.code().and_then(|code| code.parse().ok()).unwrap_or(0);
    // Extended codes have the kind of error in their lowest byte (https://sqlite.org/rescode.html).
    match (code & 0xff, code) {
        (_, 787) => StoreError::ModelNotStored,
        (_, 2067) if reason.contains("flight_key") => StoreError::KeyInUse,
        (_, 2067 | 1555) if reason.contains("participants.") => StoreError::ParticipantExists,
        (5 | 6, _) => StoreError::Locked { database, waited_s: PATIENCE.as_secs() },
        (3 | 8 | 14, _) => StoreError::Unwritable { database, reason },
        (13, _) => StoreError::Full { database },
        (11, _) => StoreError::Damaged { database, reason },
        (26, _) => StoreError::Foreign { database },
        _ => StoreError::Other { database, reason },
    }
}

/// What an error of a migration means.
pub fn migration_error(path: &Path, known: i64, error: MigrateError) -> StoreError {
    match error {
        MigrateError::VersionMissing(found) => {
            StoreError::Newer { database: path.display().to_string(), found, known }
        }
        MigrateError::Execute(error) | MigrateError::ExecuteMigration(error, _) => self::error(path, error),
        other => StoreError::Other { database: path.display().to_string(), reason: other.to_string() },
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_application_id_is_the_one_that_is_written() {
        assert_eq!(super::APPLICATION_ID, 1_128_811_597);
    }
}
