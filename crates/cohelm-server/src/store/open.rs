//! Which kind of database a name means.

use super::{PostgresStore, SqliteStore, Store, StoreError, copy};
use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;

/// What somebody wrote after `--database`.
enum Database<'a> {
    File(&'a Path),
    Postgres(&'a str),
}

impl<'a> Database<'a> {
    fn read(name: &'a OsStr) -> Result<Self, StoreError> {
        let Some((scheme, _)) = name.to_str().and_then(|name| name.split_once("://")) else {
            return Ok(Self::File(Path::new(name)));
        };
        match name.to_str() {
            Some(address) if ["postgres", "postgresql"].contains(&scheme) => Ok(Self::Postgres(address)),
            _ => Err(StoreError::Address {
                // Not all of it: a password may be in there.
                database: format!("{scheme}://…"),
                reason: "databases are SQLite files or on a PostgreSQL server".into(),
            }),
        }
    }
}

/// Opens the database of this name, a file or `postgres://…`; makes its tables if they are not there, and a file in a
/// folder that is.
pub async fn open(database: impl AsRef<OsStr>) -> Result<Arc<dyn Store>, StoreError> {
    Ok(match Database::read(database.as_ref())? {
        Database::File(path) => Arc::new(SqliteStore::open(path).await?),
        Database::Postgres(address) => Arc::new(PostgresStore::open(address).await?),
    })
}

/// Opens the database of this name, a file or `postgres://…`; an error if there is none.
pub async fn open_existing(database: impl AsRef<OsStr>) -> Result<Arc<dyn Store>, StoreError> {
    Ok(match Database::read(database.as_ref())? {
        Database::File(path) => Arc::new(SqliteStore::open_existing(path).await?),
        Database::Postgres(address) => Arc::new(PostgresStore::open_existing(address).await?),
    })
}

/// Copies a backup ([`Store::backup`]) into the database of this name, which must be new or empty. The backup loses
/// nothing; one of an older version is brought up to date.
pub async fn restore(backup: &Path, into: impl AsRef<OsStr>) -> Result<(), StoreError> {
    let from = SqliteStore::open_existing(backup).await?;
    let copied = match Database::read(into.as_ref())? {
        Database::File(path) => {
            let to = SqliteStore::open(path).await?;
            let copied = copy::into_empty(&from.driver, &to.driver, &path.display().to_string()).await;
            to.close().await;
            copied
        }
        Database::Postgres(address) => {
            let to = PostgresStore::open(address).await?;
            let copied = copy::into_empty(&from.driver, &to.driver, to.driver.name()).await;
            Store::close(&to).await;
            copied
        }
    };
    from.close().await;
    copied
}
