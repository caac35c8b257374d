//! The models that come with the program, made from a list of recipes.

use crate::checkpoint::replace;
use crate::evaluate::{Evaluation, evaluate};
use crate::intent::train_intent;
use crate::intent_options::IntentOptions;
use crate::job::{Job, LearnError};
use crate::options::ValueOptions;
use crate::progress::Watch;
use crate::values::train_values;
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::{Card, Model};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Fresh episodes whose outcome goes into a shipped model's card; see [`evaluate`].
pub const FRESH_EPISODES: usize = 300;
/// The set that they are.
pub const FRESH_SET: u64 = 1;

/// How one shipped co-pilot is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Name of its models.
    pub name: String,
    /// See [`Card::variant`].
    #[serde(default)]
    pub variant: Option<String>,
    /// Plant and options.
    pub task: Task,
    /// The seed.
    pub seed: u64,
    /// A preset of [`ValueOptions::preset`].
    #[serde(default = "usual_preset")]
    pub preset: String,
    /// Name of an earlier recipe, for whose values intent is trained; then no values are.
    #[serde(default)]
    pub values_of: Option<String>,
    /// Options of intent training, if it gets an intent model of its own.
    #[serde(default)]
    pub intent: Option<IntentOptions>,
}

fn usual_preset() -> String {
    "default".into()
}

/// One shipped file.
#[derive(Clone, Debug)]
pub struct Shipped {
    /// Where it was written.
    pub path: PathBuf,
    /// The model.
    pub model: Model,
    /// How values did on fresh episodes.
    pub fresh: Option<Evaluation>,
}

/// Makes the simulated pilot of a number for a task.
pub type TaskPilots<'a> = &'a (dyn Fn(&Task, &dyn Plant, u64) -> Result<Box<dyn Pilot>, String> + Sync);

/// With what recipes are carried out.
#[derive(Clone, Copy)]
pub struct Yard<'a> {
    /// The plants there are.
    pub plants: &'a Plants,
    /// Makes the simulated pilot of a number for a task: the same person for the same number.
    pub pilots: TaskPilots<'a>,
    /// Threads to use.
    pub threads: NonZeroUsize,
    /// Where models and cards go.
    pub folder: &'a Path,
}

/// Makes the models of one recipe and writes them, each with its card beside it.
pub fn ship(yard: &Yard<'_>, recipe: &Recipe, watch: Watch<'_>) -> Result<Vec<Shipped>, LearnError> {
    let job = Job {
        plants: yard.plants,
        task: &recipe.task,
        seed: recipe.seed,
        threads: yard.threads,
        checkpoints: None,
        name: &recipe.name,
        variant: recipe.variant.as_deref(),
    };
    let pilots = |plant: &dyn Plant, number: u64| (yard.pilots)(&recipe.task, plant, number);
    let mut shipped = Vec::new();
    let values = match &recipe.values_of {
        Some(name) => read(&yard.folder.join(format!("{name}.values.safetensors")))?,
        None => {
            let options = ValueOptions::preset(&recipe.preset)?;
            let trained = train_values(&job, &options, Some(&pilots), watch)?.model;
            let fresh = evaluate(&job, &trained, FRESH_SET, FRESH_EPISODES)?;
            let values = with_score(&trained, "fresh", json!(fresh))?;
            shipped.push(write(yard.folder, values.clone(), Some(fresh))?);
            values
        }
    };
    if let Some(options) = &recipe.intent {
        let intent = train_intent(&job, &values, options, &pilots, watch)?;
        shipped.push(write(yard.folder, intent.model, None)?);
    }
    Ok(shipped)
}

/// Reads a model that another recipe has made.
fn read(path: &Path) -> Result<Model, LearnError> {
    let bytes = std::fs::read(path).map_err(|error| LearnError::Option {
        option: "values_of",
        reason: format!("{}: {error}; its recipe has to come before", path.display()),
    })?;
    Ok(Model::from_bytes(&bytes)?)
}

/// The same model with one more score on its card.
fn with_score(model: &Model, name: &str, score: Value) -> Result<Model, LearnError> {
    let mut card = model.card().clone();
    if let Value::Object(scores) = &mut card.scores {
        scores.insert(name.into(), score);
    }
    Ok(model.with_card(&card)?)
}

fn write(folder: &Path, model: Model, fresh: Option<Evaluation>) -> Result<Shipped, LearnError> {
    let Card { name, kind, .. } = model.card();
    let path = folder.join(format!("{name}.{}.safetensors", kind.word()));
    write_model(&path, &model)?;
    Ok(Shipped { path, model, fresh })
}

/// Writes a model to a file, and its card beside it as `NAME.card.json` for people; each as a whole or not at all.
pub fn write_model(path: &Path, model: &Model) -> Result<(), LearnError> {
    let card = serde_json::to_string_pretty(&json!(model.card())).unwrap_or_default() + "\n";
    for (path, bytes) in
        [(path.to_owned(), model.bytes()), (path.with_extension("card.json"), card.as_bytes())]
    {
        let wrong =
            |error: std::io::Error| LearnError::Write { path: path.clone(), reason: error.to_string() };
        replace(&path, bytes).map_err(wrong)?;
    }
    Ok(())
}
