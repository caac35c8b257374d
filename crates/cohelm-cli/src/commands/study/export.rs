//! `cohelm study export` and `report`: what a study gave, as tables, an archive and a report.

use super::data::Source;
use crate::commands::reproduce::write;
use crate::numbers::whole;
use crate::output::Format;
use crate::rig;
use anyhow::{Context, Result};
use clap::Args;
use cohelm_lab::study::dataset;
use cohelm_study::analysis::Options;
use cohelm_study::dataset::{Dataset, StudyRecords};
use cohelm_study::export::{write_archive, write_folder};
use cohelm_study::report::study_report;
use serde_json::json;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Writes tables (CSV and Parquet), a data dictionary and an archive. Every flight is flown again for it; what is not
/// the same bit for bit is not measured, and the tables say so.
#[derive(Args)]
pub struct Export {
    /// Where the study is stored, a file or postgres://…, or an archive.
    from: OsString,
    /// Which study, by name or by the beginning of its file's hash; needed if there are several.
    #[arg(long, value_name = "NAME|HASH")]
    study: Option<String>,
    /// The folder to write; the study's name and -export unless given.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Threads, which change nothing but the time; 0 for one a core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>)]
    threads: usize,
    #[command(flatten)]
    format: Format,
}

/// Writes the report: one HTML file, the same as Markdown, and each figure as SVG, PNG and data. The same data and version
/// give the same bytes.
#[derive(Args)]
pub struct Report {
    /// Where the study is stored, a file or postgres://…, or an archive.
    from: OsString,
    /// Which study, by name or by the beginning of its file's hash; needed if there are several.
    #[arg(long, value_name = "NAME|HASH")]
    study: Option<String>,
    /// The folder to write; the study's name and -report unless given.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Threads, which change nothing but the time; 0 for one a core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>)]
    threads: usize,
    #[command(flatten)]
    format: Format,
}

impl Export {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        let records = Source { from: &self.from, study: self.study.as_deref() }.records()?;
        let data = dataset(&records, &rig::plants(), self.threads)?;
        let out = self.out.unwrap_or_else(|| format!("{}-export", records.design.name).into());
        let files = export(&records, &data, &out)?;
        print(self.format, &data, &out, &files);
        Ok(ExitCode::SUCCESS)
    }
}

impl Report {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        let records = Source { from: &self.from, study: self.study.as_deref() }.records()?;
        let data = dataset(&records, &rig::plants(), self.threads)?;
        let out = self.out.unwrap_or_else(|| format!("{}-report", records.design.name).into());
        let files = report(&data, &out)?;
        print(self.format, &data, &out, &files);
        Ok(ExitCode::SUCCESS)
    }
}

/// Writes tables and archive into a folder; gives the names of the files.
pub fn export(records: &StudyRecords, data: &Dataset, out: &Path) -> Result<Vec<String>> {
    let mut files = write_folder(out, data)?;
    let archive = format!("{}.zip", records.design.name);
    write(&out.join(&archive), &write_archive(records, data)?)?;
    files.push(archive);
    Ok(files)
}

/// Writes the report into a folder; gives the names of the files.
pub fn report(data: &Dataset, out: &Path) -> Result<Vec<String>> {
    std::fs::create_dir_all(out).with_context(|| format!("cannot make the folder {}", out.display()))?;
    let mut names = Vec::new();
    for (name, bytes) in study_report(data, &Options::default()).files("report") {
        write(&out.join(&name), &bytes)?;
        names.push(name);
    }
    Ok(names)
}

/// How many were analysed, and what was written.
fn print(format: Format, data: &Dataset, out: &Path, files: &[String]) {
    let (participants, analysed) = (data.participants.len(), data.analysed().len());
    let unmeasured = data.trials.iter().filter(|trial| trial.counts && trial.measured.is_err()).count();
    let summary = json!({
        "study": data.design.name, "simulated": data.simulated(), "participants": participants,
        "analysed": analysed, "flights": data.trials.len(), "flights_not_measured": unmeasured,
        "folder": out, "files": files,
    });
    format.print(&summary, |_| {
        let who = if data.simulated() { "simulated participants" } else { "participants" };
        let flights = data.trials.len();
        let not_measured =
            if unmeasured == 0 { String::new() } else { format!(", {unmeasured} of them not measured") };
        let listed = files.iter().map(|file| format!("  {file}")).collect::<Vec<_>>().join("\n");
        format!(
            "{}: {participants} {who}, {analysed} analysed; {flights} flights flown again{not_measured}\n\
             written to {}\n{listed}",
            data.design.name,
            out.display()
        )
    });
}
