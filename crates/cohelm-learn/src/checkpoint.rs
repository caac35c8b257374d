//! Checkpoints: files from which a training goes on after Ctrl-C, or after a kill at any moment, to the same weights.
//!
//! A checkpoint names the training that wrote it, to the last option; another training refuses it instead of going on
//! with something else. It is written beside its place and then moved there, so that there is always a whole one.

use crate::job::{Job, LearnError};
use cohelm_nn::weights::{TensorFile, WeightsError};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Key of the training's identity among the metadata.
const TRAINING: &str = "training";
/// Key of where it is.
const STATE: &str = "state";
/// Time between two checkpoints. Short: writing takes time; long: more is lost.
const PERIOD: Duration = Duration::from_secs(1);

/// The place of a training's checkpoints.
pub(crate) struct Checkpoints {
    path: Option<PathBuf>,
    training: Value,
    last: Instant,
}

impl Checkpoints {
    /// In the job's folder, if it has one. `options` is whatever else decides what the training gives.
    pub fn new(job: &Job<'_>, file: &str, options: &impl Serialize) -> Result<Self, LearnError> {
        let training = json!({
            "task": job.task,
            "plant_version": job.plants.entry(job.task)?.version,
            "seed": job.seed,
            "options": options,
            "cohelm": env!("CARGO_PKG_VERSION"),
            "kernel": cohelm_nn::kernel_name(),
        });
        Ok(Self { path: job.checkpoints.map(|folder| folder.join(file)), training, last: Instant::now() })
    }

    /// True once it is time for the next one.
    pub fn is_due(&self) -> bool {
        self.path.is_some() && self.last.elapsed() >= PERIOD
    }

    /// Writes one, if there is a place for it.
    pub fn write(&mut self, mut file: TensorFile, state: &impl Serialize) -> Result<(), LearnError> {
        let Some(path) = &self.path else { return Ok(()) };
        file.set(TRAINING, self.training.to_string());
        file.set(STATE, json!(state).to_string());
        let bytes = file.to_bytes().map_err(|error| wrong(path, &error))?;
        replace(path, &bytes).map_err(|error| wrong(path, &error))?;
        self.last = Instant::now();
        Ok(())
    }

    /// Reads the one that is there, if any, and where the training was.
    pub fn read<S: DeserializeOwned>(&self) -> Result<Option<(TensorFile, S)>, LearnError> {
        let Some(path) = &self.path else { return Ok(None) };
        let bytes = match fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(wrong(path, &error)),
        };
        let file = TensorFile::from_bytes(&bytes).map_err(|error| wrong(path, &error))?;
        let text = |key| file.get(key).map_err(|error| wrong(path, &error));
        let training: Value = serde_json::from_str(text(TRAINING)?).map_err(|error| wrong(path, &error))?;
        if let Some(what) = difference(&training, &self.training) {
            let hint = "delete it, or keep checkpoints elsewhere";
            return Err(wrong(
                path,
                &format!("it belongs to another training, whose {what} differs: {hint}"),
            ));
        }
        let state = serde_json::from_str(text(STATE)?).map_err(|error| wrong(path, &error))?;
        Ok(Some((file, state)))
    }

    /// Passes on what a file says, or says in which file it is wrong.
    pub fn check<T>(&self, read: Result<T, WeightsError>) -> Result<T, LearnError> {
        read.map_err(|error| self.wrong(&error))
    }

    /// An error about the file.
    pub fn wrong(&self, reason: &dyn ToString) -> LearnError {
        wrong(self.path.as_deref().unwrap_or(Path::new("")), reason)
    }
}

fn wrong(path: &Path, reason: &dyn ToString) -> LearnError {
    LearnError::Checkpoint { path: path.into(), reason: reason.to_string() }
}

/// The first part in which two trainings differ.
fn difference(a: &Value, b: &Value) -> Option<String> {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            let keys = a.keys().chain(b.keys());
            let differing = |key: &String| a.get(key) != b.get(key);
            keys.into_iter().find(|key| differing(key)).map(|key| {
                let deeper = a.get(key).zip(b.get(key)).and_then(|(a, b)| difference(a, b));
                deeper.map_or_else(|| key.clone(), |deeper| format!("{key}.{deeper}"))
            })
        }
        _ => None,
    }
}

/// Puts bytes into a file so that whoever looks, even after a crash, finds the old bytes or the new ones.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let mut beside = path.as_os_str().to_owned();
    beside.push(".partial");
    let beside = PathBuf::from(beside);
    let mut file = File::create(&beside)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    fs::rename(&beside, path)?;
    // That the new name is on the disk too is as good as this system lets it be.
    File::open(folder).and_then(|folder| folder.sync_all()).or(Ok(()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_named_down_to_the_option() {
        let a = json!({"seed": 1, "options": {"steps": 5, "batch": 2}});
        assert_eq!(difference(&a, &a), None);
        assert_eq!(difference(&a, &json!({"seed": 2, "options": a["options"]})).as_deref(), Some("seed"));
        let other = json!({"seed": 1, "options": {"steps": 5, "batch": 3}});
        assert_eq!(difference(&a, &other).as_deref(), Some("options.batch"));
        assert_eq!(difference(&a, &json!({"seed": 1})).as_deref(), Some("options"));
    }
}
