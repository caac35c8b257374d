//! A study's records as a data set: every flight is flown again from its record and measured.
//!
//! What a record does not give bit for bit is not measured; the data set says why. The same records give the same data set
//! for any number of threads.

mod tally;
#[cfg(test)]
mod tests;

pub use tally::FlightTally;

use crate::parallel;
use cohelm::action::Action;
use cohelm::cockpit::Cockpit;
use cohelm::keys::{KeyEvent, Keyboard};
use cohelm::pilot::{Pilot, Recorded};
use cohelm::plant::{Plant, View};
use cohelm::registry::Plants;
use cohelm::trajectory::{Recorder, Trajectory};
use cohelm_copilot::{Model, Models, cockpit};
use cohelm_study::dataset::{Dataset, Flown, Measured, StudyRecords, TrialRecord};

/// Why records give no data set.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A model's bytes are no model.
    #[error("the model {hash} of the study cannot be read: {reason}")]
    Model {
        /// Its hash, as the records name it.
        hash: String,
        /// What is wrong.
        reason: String,
    },
    /// A model's bytes have another hash than the records say.
    #[error("the model {hash} of the study has the hash {found}: the file was changed")]
    OtherModel {
        /// The hash that the records name.
        hash: String,
        /// That of the bytes.
        found: String,
    },
}

/// The data set of a study's records. `threads` is the number of workers; 0 for one a core.
///
/// # Errors
/// A model that is damaged. A flight that cannot be flown again is no error here: the data set says so of the flight.
pub fn dataset(records: &StudyRecords, plants: &Plants, threads: usize) -> Result<Dataset, StudyError> {
    let models = models(records)?;
    let flown =
        parallel::run(records.trials.len(), threads, |index| flown(&records.trials[index], plants, &models));
    Ok(Dataset::assemble(records, flown))
}

/// The models that a study's records bring along.
///
/// # Errors
/// Bytes that are no model, or of another hash than the records say.
pub fn models(records: &StudyRecords) -> Result<Models, StudyError> {
    let mut models = Models::default();
    for (hash, bytes) in &records.models {
        let damaged = |error: cohelm_copilot::ModelError| StudyError::Model {
            hash: hash.clone(),
            reason: error.to_string(),
        };
        let model = Model::from_bytes(bytes).map_err(damaged)?;
        if model.hash() != hash {
            return Err(StudyError::OtherModel { hash: hash.clone(), found: model.hash().to_owned() });
        }
        models.add_model(model);
    }
    Ok(models)
}

fn flown(trial: &TrialRecord, plants: &Plants, models: &Models) -> Option<Flown> {
    let bytes = trial.record.as_ref()?;
    Some(match Trajectory::from_bytes(bytes) {
        Ok(trajectory) => {
            Flown { seed: trajectory.setup.seed, measured: measure(&trajectory, plants, models) }
        }
        Err(error) => Flown { seed: 0, measured: Err(error.to_string()) },
    })
}

/// Flies a record again and measures it; or says why that cannot be done exactly.
///
/// # Errors
/// A plant or model that is not there or of another version; bits that differ from those of the record.
pub fn measure(trajectory: &Trajectory, plants: &Plants, models: &Models) -> Result<Measured, String> {
    let setup = &trajectory.setup;
    let mut plant = plants.make(&setup.task).map_err(|error| error.to_string())?;
    plant.reset(setup.seed);
    let mut cockpit = cockpit(setup, plant.as_ref(), plants, models).map_err(|error| error.to_string())?;
    let mut tally = FlightTally::default();
    let (presses, recorder) = fly_again(trajectory, plant.as_mut(), &mut cockpit, &mut tally);
    if recorder.digests() != trajectory.digests || recorder.ticks() != trajectory.ticks() {
        return Err("flown again, the record gives other bits than those it was stored with; it was written by another \
                    version of the program, or changed"
            .to_owned());
    }
    Ok(tally.finish(presses, plant.ticks_per_second()))
}

/// The flight from the person's keys, or from what a simulated pilot asked; with the number of key presses.
fn fly_again(
    trajectory: &Trajectory,
    plant: &mut dyn Plant,
    cockpit: &mut Cockpit,
    tally: &mut FlightTally,
) -> (u32, Recorder) {
    let person = trajectory.setup.pilot == "person" || !trajectory.keys.is_empty();
    let mut keys = KeyLog::new(plant, &trajectory.keys);
    let mut asked = Recorded::new(&trajectory.asked);
    let pilot: &mut dyn Pilot = if person { &mut keys } else { &mut asked };
    cockpit.begin();
    let mut recorder = Recorder::new(plant);
    while recorder.ending().is_none() && recorder.ticks() < trajectory.ticks() {
        let tick = cockpit.tick(plant, pilot);
        recorder.note(&tick, plant);
        tally.note(&tick, plant);
    }
    (keys.keyboard.key_presses(), recorder)
}

/// A person's keys, pressed again at the ticks at which they were.
struct KeyLog<'a> {
    keyboard: Keyboard,
    events: std::iter::Peekable<std::slice::Iter<'a, KeyEvent>>,
}

impl<'a> KeyLog<'a> {
    fn new(plant: &dyn Plant, events: &'a [KeyEvent]) -> Self {
        Self { keyboard: Keyboard::new(plant.space()), events: events.iter().peekable() }
    }
}

impl Pilot for KeyLog<'_> {
    /// A log begins with its first event, whatever the seed.
    fn begin(&mut self, _seed: u64) {}

    fn ask(&mut self, view: &View<'_>, _goal: usize) -> Option<Action> {
        while let Some(event) = self.events.next_if(|event| event.tick <= view.tick) {
            self.keyboard.change(event.change);
        }
        self.keyboard.next_request()
    }
}
