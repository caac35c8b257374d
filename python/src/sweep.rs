//! Sweeps: a folder of jobs, and one job from record to record. How they are spread is Python's, in `cohelm/sweep.py`.

use crate::errors::Kind;
use crate::world::plants;
use cohelm::registry::Plants;
use cohelm_copilot::{Model, Models, shipped};
use cohelm_lab::sweep::{
    Description, Folder, Job, Lab, Planned, Ran, Shelf, SweepError, brought, run_job as run_one, run_locally,
    write_report,
};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::OnceLock;

/// What every job of this process works with.
struct Bench {
    plants: Plants,
    models: Models,
}

fn bench() -> &'static Bench {
    static BENCH: OnceLock<Bench> = OnceLock::new();
    BENCH.get_or_init(|| Bench { plants: plants(), models: shipped::models().0 })
}

fn lab(models: &Models) -> Lab<'_> {
    Lab { plants: &bench().plants, models }
}

#[allow(clippy::needless_pass_by_value, reason = "for map_err")]
fn refused(error: SweepError) -> PyErr {
    match error {
        SweepError::Toml(_) | SweepError::Description { .. } | SweepError::Task(_) => {
            Kind::Option.error(error)
        }
        _ => Kind::Run.error(error),
    }
}

/// Plans a description into a folder: how many jobs there are, and how many of them have not finished.
#[pyfunction]
pub fn sweep_plan(py: Python<'_>, description: PathBuf, out: PathBuf) -> PyResult<(usize, usize)> {
    let unreadable =
        |error| Kind::Option.error(format!("cannot read the description {}: {error}", description.display()));
    let text = std::fs::read_to_string(&description).map_err(unreadable)?;
    let base = description.parent().map(PathBuf::from).unwrap_or_default();
    let plan = || -> Result<(usize, usize), SweepError> {
        let read = Description::from_toml(&text)?;
        let shelf = Shelf::new(bench().models.clone(), &read, &base)?;
        let choose = |kind, word: &str, task: &_, space: &_| shelf.choose(kind, word, task, space);
        let planned = read.jobs(&lab(&shelf.models), &choose)?;
        let folder = Folder::new(out)?;
        folder.plan(&text, &planned, &shelf.brought())?;
        Ok((planned.len(), folder.open_jobs(&planned).len()))
    };
    py.detach(plan).map_err(refused)
}

/// The jobs in a folder that have not finished: hash and record of each; and the models that they need brought along.
#[pyfunction]
#[allow(clippy::type_complexity, reason = "a list of pairs and a list of bytes")]
pub fn sweep_open(out: PathBuf) -> PyResult<(Vec<(String, String)>, Vec<Cow<'static, [u8]>>)> {
    let folder = Folder::open(out).map_err(refused)?;
    let planned = folder.planned().map_err(refused)?;
    let open: Vec<Planned> = folder.open_jobs(&planned).into_iter().cloned().collect();
    let models = brought(&folder, &open).map_err(refused)?;
    let record = |planned: &Planned| {
        let record = serde_json::to_string(&planned.job).map_err(|error| Kind::Run.error(error))?;
        Ok((planned.hash.clone(), record))
    };
    let models = models.iter().map(|model| Cow::Owned(model.bytes().to_vec())).collect();
    Ok((open.iter().map(record).collect::<PyResult<_>>()?, models))
}

/// Runs one job on this thread: its outcome as JSON, and the file of the model that it trained, if it did.
#[pyfunction]
#[pyo3(signature = (job_json, models=Vec::new()))]
pub fn run_job<'py>(
    py: Python<'py>,
    job_json: &str,
    models: Vec<Bound<'py, PyBytes>>,
) -> PyResult<(String, Option<Bound<'py, PyBytes>>)> {
    let job: Job =
        serde_json::from_str(job_json).map_err(|error| Kind::Option.error(format!("no job: {error}")))?;
    let mut shelf = bench().models.clone();
    for bytes in &models {
        shelf.add(bytes.as_bytes()).map_err(|error| Kind::Model.error(error))?;
    }
    let done = py.detach(|| run_one(&job, &lab(&shelf))).map_err(refused)?;
    Ok((done.record, done.model.map(|model| PyBytes::new(py, model.bytes()))))
}

/// Keeps what came of a job that ran elsewhere; `ran_json` says where and when.
#[pyfunction]
#[pyo3(signature = (out, record, model, ran_json))]
pub fn sweep_keep(
    out: PathBuf,
    record: &str,
    model: Option<Bound<'_, PyBytes>>,
    ran_json: &str,
) -> PyResult<()> {
    let ran: Ran = serde_json::from_str(ran_json).map_err(|error| Kind::Option.error(error))?;
    let model = model.map(|bytes| Model::from_bytes(bytes.as_bytes())).transpose();
    let model = model.map_err(|error| Kind::Model.error(error))?;
    Folder::open(out).and_then(|folder| folder.keep_record(record, model, &ran)).map_err(refused)
}

/// Runs the jobs in a folder that have not finished on the cores of this machine.
#[pyfunction]
#[pyo3(signature = (out, threads=0))]
pub fn sweep_locally(py: Python<'_>, out: PathBuf, threads: usize) -> PyResult<()> {
    let run = || {
        let folder = Folder::open(out)?;
        let planned = folder.planned()?;
        let shelf = Shelf::of_folder(bench().models.clone(), &folder, &planned)?;
        run_locally(&folder.open_jobs(&planned), &folder, &lab(&shelf.models), threads, &|_| {})
    };
    py.detach(run).map_err(refused)
}

/// Writes tables and report of what has finished into the folder; the names of the files.
#[pyfunction]
pub fn sweep_report(py: Python<'_>, out: PathBuf) -> PyResult<Vec<String>> {
    py.detach(|| write_report(&Folder::open(out)?)).map_err(refused)
}
