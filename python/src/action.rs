//! Actions: a whole number or an array of axes in Python, None for nothing.

use crate::errors::Kind;
use cohelm::action::{Action, ActionSpace};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

/// What Python asks for, checked against the space.
pub fn from_python(space: &ActionSpace, asked: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Action>> {
    let Some(asked) = asked.filter(|asked| !asked.is_none()) else { return Ok(None) };
    let action = match space {
        ActionSpace::Axes { low, .. } => {
            let wrong = || Kind::Action.error(format!("expected a float32 array of shape ({},)", low.len()));
            let axes: PyReadonlyArray1<'_, f32> = asked.extract().map_err(|_| wrong())?;
            let axes = axes.as_array();
            if axes.len() != low.len() {
                return Err(wrong());
            }
            Action::axes(&axes.to_vec())
        }
        _ => {
            let wrong =
                || Kind::Action.error(format!("expected a command from 0 to {}", space.commands() - 1));
            let index: i64 = asked.extract().map_err(|_| wrong())?;
            Action::Command(u8::try_from(index).map_err(|_| wrong())?)
        }
    };
    if space.contains(action) {
        Ok(Some(action))
    } else {
        let commands = space.commands();
        let expected = if commands == 0 {
            "axes within their bounds, all finite".into()
        } else {
            format!("a command from 0 to {}", commands - 1)
        };
        Err(Kind::Action.error(format!("expected {expected}, got {asked}")))
    }
}

/// An action as Python sees it.
pub fn to_python(py: Python<'_>, space: &ActionSpace, action: Option<Action>) -> PyResult<Py<PyAny>> {
    match action {
        None => Ok(py.None()),
        Some(Action::Command(command)) => Ok(i64::from(command).into_pyobject(py)?.into_any().unbind()),
        Some(Action::Axes(axes)) => {
            let ActionSpace::Axes { low, .. } = space else { return Ok(py.None()) };
            Ok(PyArray1::from_slice(py, &axes[..low.len()]).into_any().unbind())
        }
    }
}
