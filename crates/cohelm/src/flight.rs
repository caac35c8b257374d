//! Whole episodes: flown by keys as the page flies them and the server follows them, flown by a simulated pilot, and
//! flown again from their record.

use crate::action::Action;
use crate::cockpit::{Cockpit, Tick};
use crate::keys::{Change, KeyEvent, Keyboard};
use crate::pilot::{Pilot, Recorded};
use crate::plant::{Ending, Plant};
use crate::trajectory::{Digests, MAX_EVENTS, Recorder, Setup, Trajectory, plant_digest};

/// An episode that a person flies. The same changes before the same ticks give the same bits, in the page that flies
/// it and in the server that follows it.
pub struct Flight {
    setup: Setup,
    plant: Box<dyn Plant>,
    cockpit: Cockpit,
    keyboard: Keyboard,
    keys: Vec<KeyEvent>,
    recorder: Recorder,
}

impl Flight {
    /// Begins the episode of `setup` with a plant made from its task and a cockpit made from its rule and models.
    pub fn new(setup: Setup, mut plant: Box<dyn Plant>, mut cockpit: Cockpit) -> Self {
        plant.reset(setup.seed);
        cockpit.begin();
        let keyboard = Keyboard::new(plant.space());
        let recorder = Recorder::new(plant.as_ref());
        Self { setup, plant, cockpit, keyboard, keys: Vec::new(), recorder }
    }

    /// A key or stick changed; it takes effect at the next tick. Once the log is full nothing more is taken in; its last
    /// place is kept for a release of everything, after which nothing is held that would need another.
    pub fn change(&mut self, change: Change, at_ms: f32) {
        let places = MAX_EVENTS - usize::from(change != Change::ReleaseAll);
        if self.keys.len() < places && self.recorder.ending().is_none() {
            self.keyboard.change(change);
            self.keys.push(KeyEvent { tick: self.ticks(), change, at_ms });
        }
    }

    /// Flies one tick; `None` once the episode has ended.
    pub fn tick(&mut self) -> Option<Tick<'_>> {
        if self.recorder.ending().is_some() {
            return None;
        }
        let tick = self.cockpit.tick(self.plant.as_mut(), &mut self.keyboard);
        self.recorder.note(&tick, self.plant.as_ref());
        Some(tick)
    }

    /// Ticks flown.
    pub fn ticks(&self) -> u32 {
        self.recorder.ticks() as u32
    }

    /// How the episode ended, if it did.
    pub fn ending(&self) -> Option<Ending> {
        self.recorder.ending()
    }

    /// Digests of all bits so far.
    pub fn digests(&self) -> Digests {
        self.recorder.digests()
    }

    /// What fixed the episode.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The plant as it is now.
    pub fn plant(&self) -> &dyn Plant {
        self.plant.as_ref()
    }

    /// The key log so far.
    pub fn keys(&self) -> &[KeyEvent] {
        &self.keys
    }

    /// The record; an episode that had not ended is abandoned.
    pub fn finish(self) -> Trajectory {
        let tape = self.plant.tape().cloned();
        Trajectory { tape, ..self.recorder.finish(self.setup, self.keys) }
    }
}

/// Flies a whole episode with a simulated pilot, which the caller has begun; `each` sees every tick and the plant after
/// it.
pub fn fly(
    setup: Setup,
    plant: &mut dyn Plant,
    cockpit: &mut Cockpit,
    pilot: &mut dyn Pilot,
    mut each: impl FnMut(&Tick<'_>, &dyn Plant),
) -> Trajectory {
    plant.reset(setup.seed);
    cockpit.begin();
    let mut recorder = Recorder::new(plant);
    while recorder.ending().is_none() {
        let tick = cockpit.tick(plant, pilot);
        recorder.note(&tick, plant);
        each(&tick, plant);
    }
    recorder.finish(setup, Vec::new())
}

/// What flying an episode again from its record showed. `None` stands for what could not be checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Replay {
    /// What was carried out leads through the same states and rewards to the same ending, bit for bit.
    pub plant_identical: bool,
    /// What was asked leads to the same beliefs, values and executed actions, bit for bit.
    pub decisions_identical: Option<bool>,
    /// The key log gives the same requests.
    pub requests_identical: Option<bool>,
}

impl Replay {
    /// True if nothing that was checked differed.
    pub fn identical(&self) -> bool {
        self.plant_identical
            && self.decisions_identical != Some(false)
            && self.requests_identical != Some(false)
    }
}

/// Flies a recorded episode again and compares: the plant from what was carried out, the decisions from what was asked
/// (if there is a cockpit to make them), the requests from the keys (if a person pressed any). A record with actions that
/// the plant does not have is not flown: it cannot be one of its episodes.
pub fn replay(trajectory: &Trajectory, plant: &mut dyn Plant, cockpit: Option<&mut Cockpit>) -> Replay {
    let of_the_plant = |action: &Option<Action>| action.is_none_or(|action| plant.space().contains(action));
    if !trajectory.asked.iter().chain(&trajectory.executed).all(of_the_plant) {
        return Replay { plant_identical: false, decisions_identical: None, requests_identical: None };
    }
    plant.reset(trajectory.setup.seed);
    let (digest, ending) = plant_digest(plant, &trajectory.executed);
    let ended_alike = ending.unwrap_or(Ending::Abandoned) == trajectory.ending;
    let decisions_identical = cockpit.map(|cockpit| same_decisions(trajectory, plant, cockpit));
    let person = trajectory.setup.pilot == "person";
    Replay {
        plant_identical: ended_alike && digest == trajectory.digests.plant,
        decisions_identical,
        requests_identical: person.then(|| same_requests(trajectory, plant)),
    }
}

fn same_decisions(trajectory: &Trajectory, plant: &mut dyn Plant, cockpit: &mut Cockpit) -> bool {
    plant.reset(trajectory.setup.seed);
    cockpit.begin();
    let mut pilot = Recorded::new(&trajectory.asked);
    let mut recorder = Recorder::new(plant);
    for &executed in &trajectory.executed {
        let tick = cockpit.tick(plant, &mut pilot);
        if tick.executed != executed {
            return false;
        }
        recorder.note(&tick, plant);
    }
    recorder.digests().decisions == trajectory.digests.decisions
}

fn same_requests(trajectory: &Trajectory, plant: &dyn Plant) -> bool {
    let mut keyboard = Keyboard::new(plant.space());
    let mut events = trajectory.keys.iter().peekable();
    trajectory.asked.iter().enumerate().all(|(tick, &asked)| {
        while let Some(event) = events.next_if(|event| event.tick as usize <= tick) {
            keyboard.change(event.change);
        }
        keyboard.next_request() == asked
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arbitration::{HumanAlone, Rule};
    use crate::cockpit::Silence;
    use crate::intent::Inference;
    use crate::point::{self, Point};
    use crate::registry::Task;

    fn flight() -> Flight {
        let setup = Setup {
            task: Task::new("point"),
            plant_version: point::entry().version,
            seed: 1,
            rule: Rule::Hic,
            inference: Inference::Nearest,
            silence: Silence::Nothing,
            time_scale: 1.0,
            values: None,
            intent: None,
            pilot: "person".into(),
        };
        let cockpit = Cockpit::unassisted(&Point::new(), Box::new(HumanAlone)).with_silence(Silence::Nothing);
        Flight::new(setup, Box::new(Point::new()), cockpit)
    }

    #[test]
    fn a_full_log_still_takes_a_release_of_everything() {
        let mut flight = flight();
        (0..2 * MAX_EVENTS).for_each(|_| flight.change(Change::Stick([20_000, 0, 0, 0]), 0.0));
        assert!(flight.tick().unwrap().asked.is_some());
        (0..3).for_each(|_| flight.change(Change::ReleaseAll, 1.0));
        assert_eq!(flight.tick().unwrap().asked, None);
        assert_eq!(flight.keys().len(), MAX_EVENTS);
        assert_eq!(Trajectory::from_bytes(&flight.finish().to_bytes()).unwrap().keys.len(), MAX_EVENTS);
    }
}
