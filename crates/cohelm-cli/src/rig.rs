//! What this program knows: its plants, its models, its simulated pilots. The only place that names a plant.

use anyhow::{Context, Result, bail};
use cohelm::action::ActionSpace;
use cohelm::human::Person;
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::{Kind, Model, Models, shipped};
use std::path::{Path, PathBuf};

/// The plants there are.
pub fn plants() -> Plants {
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    plants.register(cohelm_drone::entry());
    plants.register(cohelm_arm::entry());
    plants.register(cohelm::point::entry());
    plants
}

/// The shipped models, then those of the given files and folders.
pub fn models(more: &[PathBuf]) -> Result<Models> {
    let (mut models, unusable) = shipped::models();
    for left_out in unusable {
        eprintln!("cohelm: the shipped model {} is left out: {}", left_out.file, left_out.error);
    }
    for path in more {
        for file in model_files(path)? {
            models.add_model(model(&file)?);
        }
    }
    Ok(models)
}

/// The model in a file.
pub fn model(path: &Path) -> Result<Model> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read the model {}", path.display()))?;
    Model::from_bytes(&bytes).with_context(|| format!("{} is no model", path.display()))
}

fn model_files(path: &Path) -> Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.into()]);
    }
    let entries = std::fs::read_dir(path).with_context(|| format!("cannot list {}", path.display()))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "safetensors"));
    files.sort();
    Ok(files)
}

/// The usual model for a task, or what to do about there being none.
pub fn model_for<'a>(models: &'a Models, kind: Kind, task: &Task, space: &ActionSpace) -> Result<&'a Model> {
    let found = models.newest_for(kind, task, space);
    found.with_context(|| {
        format!(
            "there is no {} model for {} with these actions; train one with `cohelm train` and name it with --model",
            kind.word(),
            task.plant
        )
    })
}

/// A task on the command line: a plant's name and its options.
pub fn task(plant: &str, options: &[String]) -> Result<Task> {
    let mut task = Task::new(plant);
    for option in options {
        let Some((name, value)) = option.split_once('=') else {
            bail!("an option of the plant is written NAME=VALUE, got {option:?}");
        };
        let value = serde_json::from_str(value).unwrap_or_else(|_| serde_json::Value::from(value));
        task = task.with(name, value);
    }
    Ok(task)
}

/// A simulated person at the keys of a task's plant.
pub fn simulated_person(
    plants: &Plants,
    task: &Task,
    plant: &dyn Plant,
    who: Person,
) -> Result<Box<dyn Pilot>, String> {
    let entry = plants.entry(task).map_err(|error| error.to_string())?;
    let pilot = entry.participant(plant.space(), who).map_err(|error| error.to_string())?;
    Ok(Box::new(pilot))
}

/// The draw from which the pilots that intent learns from come; no participant comes from it.
pub const TRAINING_PILOTS: u64 = 0x7261_696e;
