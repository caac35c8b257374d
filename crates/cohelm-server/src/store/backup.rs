//! A backup: a new SQLite file with everything in it, complete from the moment it has its name.

use super::StoreError;
use super::driver::Driver;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Copies everything into a file beside `to`, and gives it that name once all of it is on the disk. What is there
/// already stays, whoever else makes backups at the same moment.
pub async fn write_new(database: &dyn Driver, to: &Path) -> Result<(), StoreError> {
    if to.symlink_metadata().is_ok() {
        return Err(StoreError::Exists { path: to.into() });
    }
    let partial = Partial(beside(to));
    // What is here is from a backup that was cut off.
    partial.remove();
    database.copy_into(&partial.0).await?;
    name(&partial.0, to)
}

/// The name while it is not complete. The process and a count are in it: two backups at once do not meet.
fn beside(to: &Path) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let mut name = to.file_name().map_or_else(OsString::new, OsString::from);
    name.push(format!(".{}-{}.partial", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
    to.with_file_name(name)
}

fn name(partial: &Path, to: &Path) -> Result<(), StoreError> {
    let named = || -> io::Result<()> {
        File::open(partial)?.sync_all()?;
        // A second name for the file is refused where one exists; renaming would overwrite.
        fs::hard_link(partial, to)?;
        sync_folder(to)
    };
    named().map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => StoreError::Exists { path: to.into() },
        ErrorKind::StorageFull => StoreError::Full { database: to.display().to_string() },
        _ => StoreError::Unwritable { database: to.display().to_string(), reason: error.to_string() },
    })
}

/// Without it the name may be gone after a loss of power. Only Unix can, and has to.
fn sync_folder(of: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    let folder = of.parent().filter(|folder| !folder.as_os_str().is_empty());
    File::open(folder.unwrap_or(Path::new(".")))?.sync_all()
}

/// A file that goes when this does, and what SQLite may have put beside it.
struct Partial(PathBuf);

impl Partial {
    fn remove(&self) {
        for ending in ["", "-wal", "-shm", "-journal"] {
            let mut name = self.0.as_os_str().to_owned();
            name.push(ending);
            // Mostly it is not there; if it cannot be removed, what comes next says why.
            let _ = fs::remove_file(name);
        }
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        self.remove();
    }
}
