//! `cohelm sweep`: many small experiments, on this machine or on a Ray cluster.

use crate::output::{Format, table};
use crate::rig;
use anyhow::{Context, Result, bail};
use clap::{Args, Subcommand, ValueEnum};
use cohelm_lab::sweep::{
    Description, Finished, Folder, Lab, Planned, Ran, Shelf, nodes, run_locally, write_report,
};
use indicatif::ProgressBar;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

/// Runs and reports sweeps.
#[derive(Subcommand)]
pub enum Sweep {
    /// Run the jobs of a description that have not finished.
    Run(Run),
    /// Write tables, figures and the report of what has finished.
    Report(Report),
}

/// Runs the jobs of a description that have not finished.
#[derive(Args)]
pub struct Run {
    /// The description (TOML); docs/sweeps.md explains every key.
    file: PathBuf,
    /// The folder to keep results in; what has finished there does not run again.
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
    /// Where the jobs run.
    #[arg(long, value_enum, default_value = "local")]
    executor: Executor,
    /// Threads of the local executor; 0 for one a core.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Address of the Ray cluster; one of this machine alone is started unless given.
    #[arg(long, value_name = "ADDRESS")]
    address: Option<String>,
    /// The Python that has the packages cohelm and ray.
    #[arg(long, value_name = "PYTHON", default_value = "python3")]
    python: PathBuf,
    #[command(flatten)]
    format: Format,
}

/// Writes tables, figures and the report of what has finished.
#[derive(Args)]
pub struct Report {
    /// The folder that a sweep ran in.
    folder: PathBuf,
    #[command(flatten)]
    format: Format,
}

/// Where jobs run.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Executor {
    /// The cores of this machine.
    Local,
    /// A Ray cluster, through the Python package.
    Ray,
}

impl Sweep {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        match self {
            Self::Run(run) => run.run(),
            Self::Report(report) => report.run(),
        }
    }
}

impl Run {
    fn run(self) -> Result<ExitCode> {
        let begun = Instant::now();
        let (folder, shelf, planned) = plan(&self.file, &self.out)?;
        let open = folder.open_jobs(&planned);
        let before = planned.len() - open.len();
        match self.executor {
            Executor::Local => self.locally(&folder, &shelf, &open)?,
            Executor::Ray => self.on_ray(&folder, open.len())?,
        }
        let summary = json!({
            "folder": self.out, "jobs": planned.len(), "finished_before": before, "ran": open.len(),
            "took_s": begun.elapsed().as_secs_f64(), "nodes": where_it_ran(&folder)?,
        });
        self.format.print(&summary, |_| {
            let ran = format!("{} jobs: {before} had finished before, {} ran now", planned.len(), open.len());
            let rows = where_it_ran(&folder).unwrap_or_default();
            let next = format!("report: cohelm sweep report {}", self.out.display());
            format!("{ran} in {:.1} s\n\n{}\n\n{next}", begun.elapsed().as_secs_f64(), nodes_text(&rows))
        });
        Ok(ExitCode::SUCCESS)
    }

    fn locally(&self, folder: &Folder, shelf: &Shelf, open: &[&Planned]) -> Result<()> {
        let plants = rig::plants();
        let lab = Lab { plants: &plants, models: &shelf.models };
        let bar = if self.format.shows_progress() {
            ProgressBar::new(open.len() as u64)
        } else {
            ProgressBar::hidden()
        };
        run_locally(open, folder, &lab, self.threads, &|_: &Ran| bar.inc(1))?;
        bar.finish_and_clear();
        Ok(())
    }

    /// The package does what is left in the folder; a job is the same function of its record there as here.
    fn on_ray(&self, folder: &Folder, open: usize) -> Result<()> {
        if open == 0 {
            return Ok(());
        }
        let mut command = Command::new(&self.python);
        command.args(["-m", "cohelm.sweep"]).arg(folder.path());
        if let Some(address) = &self.address {
            command.args(["--address", address]);
        }
        // What the package prints goes beside what this prints for programs.
        let status = command.stdout(std::io::stderr()).status();
        let status = status.with_context(|| format!("cannot start {}", self.python.display()))?;
        if !status.success() {
            bail!(
                "the jobs did not all run on Ray ({status}); what finished is kept: the same command goes on. It needs a Python with the packages cohelm and ray: --python"
            );
        }
        Ok(())
    }
}

fn plan(file: &Path, out: &Path) -> Result<(Folder, Shelf, Vec<Planned>)> {
    let text = std::fs::read_to_string(file)
        .with_context(|| format!("cannot read the description {}", file.display()))?;
    let description = Description::from_toml(&text)?;
    let base = file.parent().unwrap_or(Path::new("."));
    let (plants, shelf) = (rig::plants(), Shelf::new(rig::models(&[])?, &description, base)?);
    let lab = Lab { plants: &plants, models: &shelf.models };
    let planned = description.jobs(&lab, &|kind, word, task, space| shelf.choose(kind, word, task, space))?;
    let folder = Folder::new(out)?;
    folder.plan(&text, &planned, &shelf.brought())?;
    Ok((folder, shelf, planned))
}

impl Report {
    fn run(self) -> Result<ExitCode> {
        let folder = Folder::open(&self.folder)?;
        let files = write_report(&folder)?;
        let rows = where_it_ran(&folder)?;
        let summary = json!({ "folder": self.folder, "files": files, "nodes": rows });
        self.format.print(&summary, |_| {
            format!("{}\n\nreport: {}", nodes_text(&rows), self.folder.join("report.html").display())
        });
        Ok(ExitCode::SUCCESS)
    }
}

/// Executor, node, jobs, seconds of work, and jobs of these that an attempt before had lost.
type NodeRow = (String, String, usize, f64, usize);

fn where_it_ran(folder: &Folder) -> Result<Vec<NodeRow>> {
    let rows = nodes(&Finished::all(folder)?).into_iter();
    Ok(rows
        .map(|((executor, node), (jobs, seconds, again))| (executor, node, jobs, seconds, again))
        .collect())
}

fn nodes_text(rows: &[NodeRow]) -> String {
    let cells = |(executor, node, jobs, seconds, again): &NodeRow| {
        let numbers = [jobs.to_string(), format!("{seconds:.1}"), again.to_string()];
        [format!("{executor}: {node}")].into_iter().chain(numbers).collect()
    };
    let rows: Vec<Vec<String>> = rows.iter().map(cells).collect();
    table(&["where it ran", "jobs", "seconds of work", "again after a lost worker"], &rows)
}
