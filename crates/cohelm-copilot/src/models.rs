//! A set of models, found by hash.

use crate::card::{Card, Kind};
use crate::model::{Model, ModelError};
use cohelm::action::ActionSpace;
use cohelm::intent::Inference;
use cohelm::registry::Task;

/// Models by hash, in the order in which they were added. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct Models {
    models: Vec<Model>,
}

impl Models {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Reads a model and adds it; one that is there already moves to the end, as the newest.
    pub fn add(&mut self, bytes: &[u8]) -> Result<&Model, ModelError> {
        let model = Model::from_bytes(bytes)?;
        Ok(self.add_model(model))
    }

    /// Adds a model that was read already.
    pub fn add_model(&mut self, model: Model) -> &Model {
        self.models.retain(|known| known.hash() != model.hash());
        self.models.push(model);
        self.models.last().expect("one was pushed")
    }

    /// The model of a hash.
    pub fn get(&self, hash: &str) -> Option<&Model> {
        self.models.iter().find(|model| model.hash() == hash)
    }

    /// The newest model of a kind and name (see [`Card::name`](crate::card::Card::name)).
    pub fn named(&self, kind: Kind, name: &str) -> Option<&Model> {
        self.iter().rev().find(|model| model.card().kind == kind && model.card().name == name)
    }

    /// All of them, the oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Model> {
        self.models.iter()
    }

    /// The newest model of a kind for a task's plant and its action space. Variants (see
    /// [`Card::variant`](crate::card::Card::variant)) count only where there is nothing else.
    pub fn newest_for(&self, kind: Kind, task: &Task, space: &ActionSpace) -> Option<&Model> {
        self.newest(task, space, |card| card.kind == kind)
    }

    /// The newest intent model that serves an inference, in the same way; `None` for an inference without networks.
    pub fn newest_intent(&self, inference: Inference, task: &Task, space: &ActionSpace) -> Option<&Model> {
        inference.head()?;
        self.newest(task, space, |card| card.kind == Kind::Intent && card.serves(inference))
    }

    fn newest(&self, task: &Task, space: &ActionSpace, is: impl Fn(&Card) -> bool) -> Option<&Model> {
        let fits = |card: &Card| is(card) && card.task.plant == task.plant && card.space == *space;
        let fitting = || self.iter().rev().filter(|model| fits(model.card()));
        fitting().find(|model| model.card().variant.is_none()).or_else(|| fitting().next())
    }
}
