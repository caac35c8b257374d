//! The models that a description means by its words.

use super::description::{Description, Planned};
use super::job::Work;
use super::{Folder, SweepError};
use cohelm::action::ActionSpace;
use cohelm::registry::Task;
use cohelm_copilot::{Kind, Model, Models};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The models at hand: those that come with the program, and those that a sweep brings along.
#[derive(Clone, Default)]
pub struct Shelf {
    /// All of them.
    pub models: Models,
    /// Those that come with the program.
    shipped: Models,
    /// Word of the description → hash, for those read from files.
    named: BTreeMap<String, String>,
}

impl Shelf {
    /// The program's models and the files that a description names, relative to the folder it lies in.
    pub fn new(models: Models, description: &Description, base: &Path) -> Result<Self, SweepError> {
        let mut shelf = Self { shipped: models.clone(), models, named: BTreeMap::new() };
        for word in description.model_words().filter(|word| word.ends_with(".safetensors")) {
            let model = read(&base.join(word))?;
            shelf.named.insert(word.clone(), model.hash().into());
            shelf.models.add_model(model);
        }
        Ok(shelf)
    }

    /// The program's models and those that a folder brings along for the jobs planned in it.
    pub fn of_folder(models: Models, folder: &Folder, planned: &[Planned]) -> Result<Self, SweepError> {
        let mut shelf = Self { shipped: models.clone(), models, named: BTreeMap::new() };
        for model in brought(folder, planned)? {
            shelf.models.add_model(model);
        }
        Ok(shelf)
    }

    /// The hash that a word means: `shipped` for the usual model of the task, a file that the description names, or a hash.
    pub fn choose(&self, kind: Kind, word: &str, task: &Task, space: &ActionSpace) -> Result<String, String> {
        if let Some(hash) = self.named.get(word) {
            return Ok(hash.clone());
        }
        let found = match word {
            "shipped" => self.shipped.newest_for(kind, task, space),
            hash => self.models.get(hash).filter(|model| model.card().kind == kind),
        };
        let none = || {
            let kind = kind.word();
            format!(
                "there is no {kind} model {word:?} for these actions; write \"shipped\", a file (….safetensors) or the hash of a shipped model"
            )
        };
        found.map(|model| model.hash().into()).ok_or_else(none)
    }

    /// Those that were read from files, which workers elsewhere do not have.
    pub fn brought(&self) -> Vec<&Model> {
        self.named.values().filter_map(|hash| self.models.get(hash)).collect()
    }
}

/// The models in a folder that its planned jobs name.
pub fn brought(folder: &Folder, planned: &[Planned]) -> Result<Vec<Model>, SweepError> {
    let mut models = BTreeMap::new();
    for planned in planned {
        let Work::Fly(flights) = &planned.job.work else { continue };
        for hash in flights.values.iter().chain(&flights.intent) {
            let path = folder.path().join(format!("models/{hash}.safetensors"));
            if !models.contains_key(hash) && path.is_file() {
                models.insert(hash.clone(), read(&path)?);
            }
        }
    }
    Ok(models.into_values().collect())
}

fn read(path: &Path) -> Result<Model, SweepError> {
    let failed = |reason: String| SweepError::File { path: path.into(), reason };
    let bytes = fs::read(path).map_err(|error| failed(error.to_string()))?;
    Model::from_bytes(&bytes).map_err(|error| failed(error.to_string()))
}
