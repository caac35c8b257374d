//! Flights of a plant's teacher: long ones, with legs on the ground and a craft at rest.

use cohelm::action::Action;
use cohelm::arbitration::Rule;
use cohelm::cockpit::{Cockpit, Silence};
use cohelm::flight::fly;
use cohelm::intent::Inference;
use cohelm::pilot::Pilot;
use cohelm::plant::{Plant, View};
use cohelm::registry::{Plants, Task, TaskError};
use cohelm::trajectory::Setup;

/// The record of a flight by the teacher of a task's plant, nobody helping; `None` if it has no teacher.
pub fn demonstration(
    plants: &Plants,
    task: &Task,
    seed: u64,
) -> Result<Option<Vec<u8>>, Box<dyn std::error::Error>> {
    let setup = Setup {
        task: task.clone(),
        plant_version: plants.entry(task)?.version,
        seed,
        rule: Rule::Hic,
        inference: Inference::Nearest,
        silence: Silence::Best,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: "teacher".into(),
    };
    let mut plant = plants.make(task)?;
    let mut cockpit = Cockpit::unassisted(plant.as_ref(), setup.rule.arbiter(f64::NAN)?);
    let mut teacher = Teacher::new(plants, &setup)?;
    if teacher.shadow.teacher(0).is_none() {
        return Ok(None);
    }
    Ok(Some(fly(setup, plant.as_mut(), &mut cockpit, &mut teacher, |_, _| {}).to_bytes()))
}

/// A pilot that is the teacher of a plant of its own, which does what this pilot asks, as the flown one does when
/// nobody helps.
struct Teacher {
    shadow: Box<dyn Plant>,
}

impl Teacher {
    fn new(plants: &Plants, setup: &Setup) -> Result<Self, TaskError> {
        let mut shadow = plants.make(&setup.task)?;
        shadow.reset(setup.seed);
        Ok(Self { shadow })
    }
}

impl Pilot for Teacher {
    fn begin(&mut self, _seed: u64) {}

    fn ask(&mut self, _view: &View<'_>, goal: usize) -> Option<Action> {
        let asked = self.shadow.teacher(goal);
        self.shadow.step(asked);
        asked
    }
}
