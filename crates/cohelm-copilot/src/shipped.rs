//! The models that come with the program: the folder `models/`, which `cohelm train --ship` makes.
//!
//! A build without them, or with some that this version cannot read, is a build like any other: [`models`] says which
//! files were left out and why, and the command that needs one of them reports it.

use crate::model::{Model, ModelError};
use crate::models::Models;

/// Names and bytes of the shipped files, sorted by name.
pub const FILES: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/shipped_models.in"));

/// A shipped file that this version cannot use.
#[derive(Clone, Debug, PartialEq)]
pub struct Unusable {
    /// The file's name.
    pub file: &'static str,
    /// Why.
    pub error: ModelError,
}

/// All shipped models that this version can read, and the files that it cannot.
pub fn models() -> (Models, Vec<Unusable>) {
    let mut models = Models::new();
    let mut unusable = Vec::new();
    for &(file, bytes) in FILES {
        match Model::from_bytes(bytes) {
            Ok(model) => {
                models.add_model(model);
            }
            Err(error) => unusable.push(Unusable { file, error }),
        }
    }
    (models, unusable)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_file_is_a_model_and_named_after_it() {
        let (models, unusable) = models();
        assert_eq!(unusable, []);
        assert_eq!(models.iter().count(), FILES.len());
        for (model, (file, _)) in models.iter().zip(FILES) {
            let card = model.card();
            assert_eq!(*file, format!("{}.{}.safetensors", card.name, card.kind.word()));
        }
    }
}
