//! The plants and models of this program, as a study's design asks for them.

use crate::rig;
use anyhow::{Context, Result, anyhow};
use cohelm::action::ActionSpace;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::{Models, cockpit};
use cohelm_server::study::resolve;
use cohelm_study::design::schedule::Assignment;
use cohelm_study::design::timeline::{FlightPlace, setup};
use cohelm_study::design::{Catalogue, Condition, Design, DesignError, PlantFacts};
use std::path::{Path, PathBuf};

/// What can be flown here.
pub struct Shelf {
    /// The plants.
    pub plants: Plants,
    /// The shipped models, and those that were named.
    pub models: Models,
}

impl Shelf {
    /// Everything that comes with the program, and the models of these files and folders.
    pub fn new(more: &[PathBuf]) -> Result<Self> {
        Ok(Self { plants: rig::plants(), models: rig::models(more)? })
    }

    /// A design that can be flown here, read from its file, and what is known of its plant.
    pub fn design(&self, file: &Path) -> Result<(Design, PlantFacts)> {
        let design = read(file)?;
        let facts = design.check_with(self).map_err(|error| told(file, &error))?;
        Ok((design, facts))
    }
}

/// The design in a file; what is wrong with it is told line by line.
pub fn read(file: &Path) -> Result<Design> {
    let bytes = std::fs::read(file).with_context(|| format!("cannot read {}", file.display()))?;
    let text = String::from_utf8(bytes).map_err(|_| {
        anyhow!(
            "{} is no text: expected a study's file, in TOML (studies/ has some); of a database, use `cohelm study report` \
             or `export`",
            file.display()
        )
    })?;
    Design::from_toml(&text).map_err(|error| told(file, &error))
}

/// Everything that is wrong with a file, a line each.
fn told(file: &Path, error: &DesignError) -> anyhow::Error {
    let line = |problem: &cohelm_study::design::Problem| format!("{}: {problem}", file.display());
    anyhow!(error.problems.iter().map(line).collect::<Vec<_>>().join("\n"))
}

impl Catalogue for Shelf {
    fn check_task(&self, task: &Task) -> Result<PlantFacts, String> {
        let plant = self.plants.make(task).map_err(|error| error.to_string())?;
        Ok(PlantFacts {
            ticks_per_second: plant.ticks_per_second(),
            limit_ticks: plant.limit_ticks(),
            axes: matches!(plant.space(), ActionSpace::Axes { .. }),
        })
    }

    fn check_condition(&self, design: &Design, condition: &Condition) -> Result<(), String> {
        let place = design.conditions.iter().position(|known| known.name == condition.name);
        let condition = place.ok_or_else(|| format!("the design has no condition {:?}", condition.name))?;
        let told = |reason: String| format!("condition {:?}: {reason}", design.conditions[condition].name);
        let resolved = resolve(design, &self.plants, &self.models).map_err(|error| error.to_string())?;
        let assignment = Assignment { cell: 0, order: (0..design.conditions.len()).collect(), seed: 0 };
        let place = FlightPlace { block: 1, condition, practice: false, number: 1, of: 1 };
        let setup = setup(design, &assignment, &resolved, &place).map_err(|error| error.to_string())?;
        let plant = self.plants.make(&setup.task).map_err(|error| error.to_string())?;
        let made = cockpit(&setup, plant.as_ref(), &self.plants, &self.models);
        made.map(drop).map_err(|error| told(error.to_string()))
    }
}
