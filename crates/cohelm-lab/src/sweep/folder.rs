//! Where a sweep lives on disk.
//!
//! | file | what it is |
//! |---|---|
//! | `sweep.toml` | the description as it was given |
//! | `plan.json` | every job with its hash and its place in the grid |
//! | `models/HASH.safetensors` | models that do not come with cohelm, and models that jobs trained |
//! | `done/HASH.json` | the outcome of a job: the same bytes whatever ran it |
//! | `ran/HASH.json` | where, when, how long, and at which attempt it ran |
//!
//! Every file is written beside its place and renamed into it, so a file is whole or is not there.

use super::SweepError;
use super::description::Planned;
use super::job::Job;
use super::run::Done;
use cohelm_copilot::Model;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// A sweep's folder.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

/// Where and when a job ran. No part of its outcome.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ran {
    /// The job.
    pub hash: String,
    /// `local` or `ray`.
    pub executor: String,
    /// Name of the machine, or of the node of a cluster.
    pub node: String,
    /// Which worker there: a thread's number or a process.
    pub worker: String,
    /// When it began, milliseconds since 1970.
    pub begun_ms: i64,
    /// How long it took, seconds, without the way there and back.
    pub seconds: f64,
    /// 1 unless attempts before were lost with their worker.
    pub attempt: u32,
}

impl Folder {
    /// A folder, made if it is not there.
    pub fn new(path: impl Into<PathBuf>) -> Result<Self, SweepError> {
        let folder = Self { path: path.into() };
        for part in ["done", "ran", "models"] {
            let part = folder.path.join(part);
            fs::create_dir_all(&part).map_err(|error| failed(&part, &error))?;
        }
        Ok(folder)
    }

    /// A folder that a sweep ran in.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self, SweepError> {
        let folder = Self { path: path.into() };
        if folder.path.join("plan.json").is_file() {
            return Ok(folder);
        }
        let reason = "no sweep ran here: there is no plan.json".into();
        Err(SweepError::File { path: folder.path, reason })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Keeps description, plan and the models that workers elsewhere may not have.
    pub fn plan(&self, description: &str, planned: &[Planned], models: &[&Model]) -> Result<(), SweepError> {
        models.iter().try_for_each(|model| self.keep_model(model))?;
        self.write("sweep.toml", description.as_bytes())?;
        self.write("plan.json", (serde_json::to_string_pretty(planned)? + "\n").as_bytes())
    }

    /// The description as it was given.
    pub fn description(&self) -> Result<String, SweepError> {
        let reason =
            |_| SweepError::File { path: self.path.join("sweep.toml"), reason: "this is not text".into() };
        String::from_utf8(self.read("sweep.toml")?).map_err(reason)
    }

    /// The plan.
    pub fn planned(&self) -> Result<Vec<Planned>, SweepError> {
        Ok(serde_json::from_slice(&self.read("plan.json")?)?)
    }

    /// Those of the planned jobs that have not finished.
    pub fn open_jobs<'a>(&self, planned: &'a [Planned]) -> Vec<&'a Planned> {
        let done = self.finished();
        planned.iter().filter(|planned| !done.contains(&planned.hash)).collect()
    }

    /// Hashes of the jobs that have finished, planned now or at some other time.
    pub fn finished(&self) -> BTreeSet<String> {
        let names = fs::read_dir(self.path.join("done")).into_iter().flatten().flatten();
        names
            .filter_map(|entry| Some(entry.file_name().to_str()?.strip_suffix(".json")?.to_string()))
            .collect()
    }

    /// Keeps what came of a job, the outcome last: a job counts as finished once that is there.
    pub fn keep(&self, done: &Done, ran: &Ran) -> Result<(), SweepError> {
        done.model.iter().try_for_each(|model| self.keep_model(model))?;
        self.write(&format!("ran/{}.json", ran.hash), (serde_json::to_string(ran)? + "\n").as_bytes())?;
        self.write(&format!("done/{}.json", ran.hash), done.record.as_bytes())
    }

    /// The outcome of a job, if it has finished.
    pub fn outcome(&self, hash: &str) -> Result<Option<serde_json::Value>, SweepError> {
        let name = format!("done/{hash}.json");
        if !self.path.join(&name).is_file() {
            return Ok(None);
        }
        let mut record: serde_json::Value = serde_json::from_slice(&self.read(&name)?)?;
        Ok(Some(record["outcome"].take()))
    }

    /// Where a job ran, if it has finished.
    pub fn ran(&self, hash: &str) -> Option<Ran> {
        serde_json::from_slice(&self.read(&format!("ran/{hash}.json")).ok()?).ok()
    }

    /// Writes a file of the folder.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), SweepError> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let path = self.path.join(name);
        let parent = path.parent().unwrap_or(&self.path);
        fs::create_dir_all(parent).map_err(|error| failed(parent, &error))?;
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let beside = parent.join(format!(".{}.{number}.part", std::process::id()));
        let written = fs::File::create(&beside).and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_data()?;
            fs::rename(&beside, &path)
        });
        written.map_err(|error| {
            let _ = fs::remove_file(&beside);
            failed(&path, &error)
        })
    }

    /// Keeps what a worker elsewhere sent: its record, which must be that of the job it is said to be, and its model.
    pub fn keep_record(&self, record: &str, model: Option<Model>, ran: &Ran) -> Result<(), SweepError> {
        let read: serde_json::Value = serde_json::from_str(record)?;
        let job: Job = serde_json::from_value(read["job"].clone())?;
        let found = job.hash()?;
        if found != ran.hash {
            let reason = format!("the record is of job {found}");
            return Err(SweepError::File { path: self.path.join(format!("done/{}.json", ran.hash)), reason });
        }
        self.keep(&Done { record: record.into(), model }, ran)
    }

    fn keep_model(&self, model: &Model) -> Result<(), SweepError> {
        self.write(&format!("models/{}.safetensors", model.hash()), model.bytes())
    }

    fn read(&self, name: &str) -> Result<Vec<u8>, SweepError> {
        let path = self.path.join(name);
        fs::read(&path).map_err(|error| failed(&path, &error))
    }
}

fn failed(path: &Path, error: &std::io::Error) -> SweepError {
    SweepError::File { path: path.into(), reason: error.to_string() }
}
