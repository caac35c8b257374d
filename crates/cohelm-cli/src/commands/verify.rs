//! `cohelm verify`: hold flights, statistics and stored episodes against what was recorded.

use crate::output::Format;
use anyhow::{Context, Result};
use clap::{Args, Subcommand};
use cohelm_lander::recording;
use serde::Serialize;
use serde_json::{Value, json};
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
    /// Kill a server again and again while simulated participants fly; nothing that it acknowledged may be lost.
    Kills(super::kills::Kills),
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
            Self::Kills(kills) => kills.run(),
            Self::Episodes(episodes) => episodes.run(),
        }
    }
}

/// What one file showed.
#[derive(Serialize)]
struct Seen {
    file: PathBuf,
    all_agree: bool,
    report: Value,
    #[serde(skip)]
    text: String,
}

impl Files {
    fn verify(self, look: fn(&Path) -> Result<Seen>) -> Result<ExitCode> {
        let seen = self.files.iter().map(|file| look(file)).collect::<Result<Vec<_>>>()?;
        let all_agree = seen.iter().all(|seen| seen.all_agree);
        self.format.print(&json!({ "all_agree": all_agree, "files": seen }), |_| {
            let texts = seen.iter().map(|seen| format!("{}: {}", seen.file.display(), seen.text));
            texts.collect::<Vec<_>>().join("\n")
        });
        Ok(if all_agree { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}

fn flights(file: &Path) -> Result<Seen> {
    let report = recording::verify(open(file)?).with_context(|| file.display().to_string())?;
    let first = report.first_difference.as_ref().map(ToString::to_string);
    let (flights, steps, identical) = (report.flights, report.steps, report.identical);
    let difference = first.as_ref().map_or(String::new(), |first| format!("\n  first difference: {first}"));
    Ok(Seen {
        file: file.into(),
        all_agree: report.all_identical(),
        report: json!({ "flights": flights, "steps": steps, "identical": identical, "first_difference": first }),
        text: format!("{flights} flights, {steps} steps, {identical} identical{difference}"),
    })
}

fn statistics(file: &Path) -> Result<Seen> {
    let report = cohelm_study::verify::statistics(open(file)?).with_context(|| file.display().to_string())?;
    let text = report.to_string();
    Ok(Seen { file: file.into(), all_agree: report.all_within(), report: json!(report), text })
}

fn open(file: &Path) -> Result<File> {
    File::open(file).with_context(|| format!("cannot open {}", file.display()))
}
