//! `cohelm verify`: hold flights, statistics and stored episodes against what was recorded.

use crate::output::Format;
use anyhow::{Context, Result};
use clap::{Args, Subcommand};
use cohelm_lander::recording;
use serde::Serialize;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What to verify.
#[derive(Subcommand)]
pub enum Verify {
    /// Fly recorded Gymnasium flights again; every bit of every observation and reward must be the same.
    Flights(Files),
    /// Compute recorded statistics again; every number must agree to 1e-6 relative.
    Statistics(Files),
    /// Fly stored episodes again: physics from what was carried out, decisions from what was asked.
    Episodes(super::episodes::VerifyEpisodes),
}

/// Files to read.
#[derive(Args)]
pub struct Files {
    /// Recordings, one after the other.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    format: Format,
}

impl Verify {
    /// Runs the command; fails if anything differs.
    pub fn run(self) -> Result<ExitCode> {
        match self {
            Self::Flights(files) => files.verify(flights),
            Self::Statistics(files) => files.verify(statistics),
            Self::Episodes(episodes) => episodes.run(),
        }
    }
}

/// What one file showed.
#[derive(Serialize)]
struct Seen {
    file: PathBuf,
    what: &'static str,
    compared: usize,
    numbers: usize,
    agreeing: usize,
    all_agree: bool,
    first_difference: Option<String>,
    remarks: Vec<String>,
}

impl Files {
    fn verify(self, look: fn(&Path) -> Result<Seen>) -> Result<ExitCode> {
        let seen = self.files.iter().map(|file| look(file)).collect::<Result<Vec<_>>>()?;
        self.format.print(&seen, |seen| seen.iter().map(Seen::text).collect::<Vec<_>>().join("\n"));
        let all_agree = seen.iter().all(|seen| seen.all_agree);
        Ok(if all_agree { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}

impl Seen {
    fn text(&self) -> String {
        let Self { what, compared, numbers, agreeing, .. } = self;
        let file = self.file.display();
        let mut lines = vec![match *what {
            "flights" => format!("{file}: {compared} flights, {numbers} steps, {agreeing} identical"),
            _ => format!("{file}: {compared} cases, {numbers} values, {agreeing} within 1e-6"),
        }];
        lines.extend(self.first_difference.iter().map(|difference| format!("  first difference: {difference}")));
        lines.extend(self.remarks.iter().map(|remark| format!("  {remark}")));
        lines.join("\n")
    }
}

fn flights(file: &Path) -> Result<Seen> {
    let report = recording::verify(open(file)?).with_context(|| file.display().to_string())?;
    Ok(Seen {
        file: file.into(),
        what: "flights",
        compared: report.flights,
        numbers: report.steps,
        agreeing: report.identical,
        all_agree: report.all_identical(),
        first_difference: report.first_difference.map(|difference| difference.to_string()),
        remarks: Vec::new(),
    })
}

fn statistics(file: &Path) -> Result<Seen> {
    let report = cohelm_study::verify::statistics(open(file)?).with_context(|| file.display().to_string())?;
    let undefined = report.undefined_in_recording;
    let without_value = (undefined > 0).then(|| format!("{undefined} recorded values are not finite; ours are undefined too"));
    let unknown = (!report.unknown.is_empty()).then(|| format!("not known here: {}", report.unknown.join(", ")));
    Ok(Seen {
        file: file.into(),
        what: "statistics",
        compared: report.cases,
        numbers: report.values,
        agreeing: report.within,
        all_agree: report.all_within(),
        first_difference: report.first_difference.as_ref().map(ToString::to_string),
        remarks: without_value.into_iter().chain(unknown).collect(),
    })
}

fn open(file: &Path) -> Result<File> {
    File::open(file).with_context(|| format!("cannot open {}", file.display()))
}
