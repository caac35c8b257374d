//! `cohelm study backup` and `restore`: everything that is stored, as one SQLite file.

use super::run::shown;
use crate::output::say;
use anyhow::{Result, bail};
use clap::Args;
use cohelm_server::store::{open_existing, restore};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Copies everything that is stored into a new SQLite file, as of one moment, while the study goes on.
#[derive(Args)]
pub struct Backup {
    /// Where the study is stored: a file or postgres://….
    database: OsString,
    /// The file to write; it must not be there yet.
    to: PathBuf,
}

/// Puts a backup into a database, which must be new or empty.
#[derive(Args)]
pub struct Restore {
    /// The file that `backup` wrote.
    backup: PathBuf,
    /// The database to fill: a file or postgres://….
    database: OsString,
}

impl Backup {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        runtime.block_on(async {
            let store = open_existing(&self.database).await?;
            let copied = store.backup(&self.to).await;
            store.close().await;
            copied
        })?;
        say(&format!("{} is copied to {}", shown(&self.database), self.to.display()));
        Ok(ExitCode::SUCCESS)
    }
}

impl Restore {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        if !self.backup.exists() {
            bail!(
                "there is no backup {}: name the file that `cohelm study backup` wrote",
                self.backup.display()
            );
        }
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        runtime.block_on(restore(&self.backup, &self.database))?;
        say(&format!("{} is filled from {}", shown(&self.database), self.backup.display()));
        Ok(ExitCode::SUCCESS)
    }
}
