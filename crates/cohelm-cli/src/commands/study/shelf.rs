//! The plants and models of this program, as a study's design asks for them.

use crate::rig;
use anyhow::{Context, Result, anyhow, bail};
use cohelm::registry::{Plants, Task};
use cohelm_copilot::{Models, cockpit};
use cohelm_server::study::resolve;
use cohelm_study::design::schedule::Assignment;
use cohelm_study::design::timeline::{FlightPlace, setup};
use cohelm_study::design::{Catalogue, Condition, Design, PlantFacts};
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
        let facts = self.check(&design).with_context(|| file.display().to_string())?;
        Ok((design, facts))
    }

    fn check(&self, design: &Design) -> Result<PlantFacts> {
        let facts = self.check_task(&design.task.task).map_err(|reason| anyhow!(reason))?;
        let wrong = |condition| self.check_condition(design, condition).err();
        let wrong: Vec<String> = design.conditions.iter().filter_map(wrong).collect();
        if wrong.is_empty() { Ok(facts) } else { bail!(wrong.join("; ")) }
    }
}

/// The design in a file; what is wrong with it is told line by line.
pub fn read(file: &Path) -> Result<Design> {
    let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
    Design::from_toml(&text).map_err(|error| {
        let line = |problem: &cohelm_study::design::Problem| format!("{}: {problem}", file.display());
        anyhow!(error.problems.iter().map(line).collect::<Vec<_>>().join("\n"))
    })
}

impl Catalogue for Shelf {
    fn check_task(&self, task: &Task) -> Result<PlantFacts, String> {
        let plant = self.plants.make(task).map_err(|error| error.to_string())?;
        Ok(PlantFacts { ticks_per_second: plant.ticks_per_second(), limit_ticks: plant.limit_ticks() })
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
