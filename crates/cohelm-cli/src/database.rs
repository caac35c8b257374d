//! The database of a name, as `--database` gives it.

use anyhow::Result;
use cohelm_server::store::{SqliteStore, Store};
use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;

/// Opens the database of this name, and makes it if it is not there.
pub async fn open(database: &OsStr) -> Result<Arc<dyn Store>> {
    Ok(Arc::new(SqliteStore::open(Path::new(database)).await?))
}

/// Opens the database of this name; an error if there is none.
pub async fn open_existing(database: &OsStr) -> Result<Arc<dyn Store>> {
    Ok(Arc::new(SqliteStore::open_existing(Path::new(database)).await?))
}
