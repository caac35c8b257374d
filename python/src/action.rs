//! Actions: a whole number or an array of axes in Python, None for nothing; of many worlds, an array.

use crate::errors::Kind;
use cohelm::action::{Action, ActionSpace};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
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

/// What many worlds are asked at once.
pub struct Actions<'a> {
    /// The actions there are.
    pub space: &'a ActionSpace,
    /// How many worlds.
    pub worlds: usize,
}

impl Actions<'_> {
    /// Reads an array: an index a world, one beyond the last command for nothing; or a row of axes a world.
    pub fn read(&self, array: &Bound<'_, PyAny>, into: &mut [Option<Action>]) -> PyResult<()> {
        match self.space {
            ActionSpace::Axes { low, .. } => self.read_axes(array, low.len(), into),
            _ => self.read_commands(array, into),
        }
    }

    fn read_axes(&self, array: &Bound<'_, PyAny>, axes: usize, into: &mut [Option<Action>]) -> PyResult<()> {
        let worlds = self.worlds;
        let wrong = || Kind::Action.error(format!("expected a float32 array of shape ({worlds}, {axes})"));
        let rows: PyReadonlyArray2<'_, f32> = array.extract().map_err(|_| wrong())?;
        let rows = rows.as_array();
        if rows.dim() != (worlds, axes) {
            return Err(wrong());
        }
        for (world, (into, row)) in into.iter_mut().zip(rows.rows()).enumerate() {
            let action = Action::axes(&row.to_vec());
            if !self.space.contains(action) {
                let message =
                    format!("world {world}: expected axes within their bounds, all finite, got {row}");
                return Err(Kind::Action.error(message));
            }
            *into = Some(action);
        }
        Ok(())
    }

    fn read_commands(&self, array: &Bound<'_, PyAny>, into: &mut [Option<Action>]) -> PyResult<()> {
        let (worlds, nothing) = (self.worlds, self.space.commands() as i64);
        let wrong = |came: &str| {
            let expected = format!("an int64 array of shape ({worlds},), each from 0 to {nothing} (nothing)");
            Kind::Action.error(format!("expected {expected}{came}"))
        };
        let indices: PyReadonlyArray1<'_, i64> = array.extract().map_err(|_| wrong(""))?;
        let indices = indices.as_array();
        if indices.len() != worlds {
            return Err(wrong(&format!(", got {}", indices.len())));
        }
        for (into, &index) in into.iter_mut().zip(indices) {
            if !(0..=nothing).contains(&index) {
                return Err(wrong(&format!(", got {index}")));
            }
            *into = (index < nothing).then_some(Action::Command(index as u8));
        }
        Ok(())
    }
}

/// Actions of many worlds: an int64 index each, −1 for nothing; or float32 rows of axes, NaN for nothing.
pub fn to_array<'py>(
    py: Python<'py>,
    space: &ActionSpace,
    actions: Vec<Option<Action>>,
) -> PyResult<Bound<'py, PyAny>> {
    let ActionSpace::Axes { low, .. } = space else {
        let index = |action: &Option<Action>| match action {
            Some(Action::Command(command)) => i64::from(*command),
            _ => -1,
        };
        return Ok(PyArray1::from_vec(py, actions.iter().map(index).collect()).into_any());
    };
    let row = |action: &Option<Action>| match action {
        Some(Action::Axes(axes)) => axes[..low.len()].to_vec(),
        _ => vec![f32::NAN; low.len()],
    };
    let rows: Vec<Vec<f32>> = actions.iter().map(row).collect();
    Ok(PyArray2::from_vec2(py, &rows).map_err(|error| Kind::Array.error(error))?.into_any())
}
