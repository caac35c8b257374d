//! cohelm for Python: conversion only. What is computed is computed in the other crates; what is checked here is what
//! comes from Python, so that nothing panics across the border.
#![forbid(unsafe_code)]

mod action;
mod arbitration;
mod errors;
mod lander;
mod models;
mod picture;
mod pilot;
mod plant_vector;
mod sweep;
mod training;
mod vector;
mod world;

use pyo3::prelude::*;

/// The native half of the package `cohelm`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<lander::Lander>()?;
    module.add_class::<vector::LanderVector>()?;
    module.add_class::<world::World>()?;
    module.add_class::<plant_vector::PlantVector>()?;
    module.add_class::<arbitration::Rule>()?;
    module.add_class::<models::ValueModel>()?;
    module.add_class::<models::IntentModel>()?;
    module.add_class::<pilot::SimulatedPilot>()?;
    module.add_function(wrap_pyfunction!(models::shipped, module)?)?;
    module.add_function(wrap_pyfunction!(models::shipped_for, module)?)?;
    module.add_function(wrap_pyfunction!(world::plant_names, module)?)?;
    module.add_function(wrap_pyfunction!(training::train_values, module)?)?;
    module.add_function(wrap_pyfunction!(training::train_intent, module)?)?;
    module.add_function(wrap_pyfunction!(training::reproduce, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_plan, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_open, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_keep, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_locally, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_report, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::run_job, module)?)
}
