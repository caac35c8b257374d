//! Errors as Python's: the tree is written in `cohelm/errors.py`, so that each can also be one of Python's own.

use pyo3::prelude::*;
use pyo3::types::PyType;
use std::fmt::Display;

/// A class of `cohelm.errors`.
#[derive(Clone, Copy)]
pub enum Kind {
    /// Options of a world, a rule or a training; a kind of `ValueError`.
    Option,
    /// An action, or an array of them; a kind of `ValueError`.
    Action,
    /// An array of the wrong shape, dtype, or with numbers that are not finite; a kind of `ValueError`.
    Array,
    /// A model's file, or a model that does not fit; a kind of `ValueError`.
    Model,
    /// A world that was closed, or that was stepped before it was reset; a kind of `RuntimeError`.
    Closed,
    /// Training or a reproduction that could not be carried out; a kind of `RuntimeError`.
    Run,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Option => "OptionError",
            Self::Action => "ActionError",
            Self::Array => "ArrayError",
            Self::Model => "ModelError",
            Self::Closed => "ClosedError",
            Self::Run => "RunError",
        }
    }

    /// The exception of this kind with a message.
    pub fn error(self, message: impl Display) -> PyErr {
        let message = message.to_string();
        Python::attach(|py| {
            let class = py.import("cohelm.errors").and_then(|errors| errors.getattr(self.name()));
            match class.and_then(|class| class.cast_into::<PyType>().map_err(PyErr::from)) {
                Ok(class) => PyErr::from_type(class, message),
                Err(error) => error,
            }
        })
    }
}
