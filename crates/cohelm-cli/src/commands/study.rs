//! `cohelm study`: one file says what a study is; these commands check it, try it, run it and report it.

mod backup;
mod check;
pub mod data;
pub mod dry_run;
mod export;
mod neighbours;
mod power;
mod run;
pub mod shelf;

use anyhow::Result;
use clap::Subcommand;
use std::process::ExitCode;

/// What to do with a study.
#[derive(Subcommand)]
pub enum Study {
    /// Explain a study's file: who flies what when, how long it takes; or say what is wrong with it, and where.
    Check(check::Check),
    /// Print the JSON Schema of study files, for editors that complete and check.
    Schema(check::Schema),
    /// Serve a study: participants' pages, and the researcher's on a secret.
    Run(run::Run),
    /// Send simulated participants through the real server, from consent to thanks.
    DryRun(dry_run::DryRun),
    /// How many participants it takes to see an effect.
    Power(power::Power),
    /// Write a study's data: tables, data dictionary, and an archive from which everything can be computed again.
    Export(export::Export),
    /// Write the report of a study, from its database or from an archive.
    Report(export::Report),
    /// Copy a database into a file while a study runs.
    Backup(backup::Backup),
    /// Put a backup into a new or empty database.
    Restore(backup::Restore),
}

impl Study {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        match self {
            Self::Check(check) => check.run(),
            Self::Schema(schema) => schema.run(),
            Self::Run(run) => run.run(),
            Self::DryRun(dry_run) => dry_run.run(),
            Self::Power(power) => power.run(),
            Self::Export(export) => export.run(),
            Self::Report(report) => report.run(),
            Self::Backup(backup) => backup.run(),
            Self::Restore(restore) => restore.run(),
        }
    }
}
