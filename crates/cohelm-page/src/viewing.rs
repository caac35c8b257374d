//! A record that is watched: any moment of it, forwards and backwards.

use crate::fleet::Crew;
use cohelm::action::Action;
use cohelm::pilot::Pilot;
use cohelm::plant::View;
use cohelm::report::{Opening, TickReport};
use cohelm::trajectory::Trajectory;

/// A record and how far it was flown again. Going backwards flies it again from the beginning, which takes
/// milliseconds.
pub struct Viewing {
    trajectory: Trajectory,
    crew: Crew,
    ticks: usize,
    last: Option<TickReport>,
}

impl Viewing {
    /// A record at its beginning, with the plant and the cockpit of its setup.
    pub fn new(trajectory: Trajectory, crew: Crew) -> Self {
        let mut viewing = Self { trajectory, crew, ticks: 0, last: None };
        viewing.rewind();
        viewing
    }

    /// The record.
    pub fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// What to know before the first tick. Right only at the beginning.
    pub fn opening(&self) -> Opening {
        let ticks = self.trajectory.ticks() as u32;
        Opening::of(&self.trajectory.setup, self.crew.plant.as_ref(), Some(ticks))
    }

    /// Goes to where the record stands after that many ticks, or to its end.
    pub fn seek(&mut self, ticks: u32) -> Option<TickReport> {
        let wanted = (ticks as usize).min(self.trajectory.ticks());
        if wanted < self.ticks {
            self.rewind();
        }
        while self.ticks < wanted {
            self.advance(self.ticks + 1 == wanted);
        }
        self.last.clone()
    }

    fn rewind(&mut self) {
        self.crew.plant.reset(self.trajectory.setup.seed);
        self.crew.cockpit.begin();
        (self.ticks, self.last) = (0, None);
    }

    /// One tick on. A report is made only of a tick that somebody sees.
    fn advance(&mut self, seen: bool) {
        let Crew { plant, cockpit, median_range } = &mut self.crew;
        let space = seen.then(|| plant.space().clone());
        let mut pilot = AsRecorded(self.trajectory.asked[self.ticks]);
        let tick = cockpit.tick(plant.as_mut(), &mut pilot);
        let differs = tick.executed != self.trajectory.executed[self.ticks];
        let rule = &self.trajectory.setup.rule;
        let report = space.map(|space| TickReport::of(&tick, &space, rule, *median_range));
        self.last = report.map(|report| TickReport { differs, ..report.placed(plant.as_ref()) });
        self.ticks += 1;
    }
}

/// Asks once for what was asked then.
struct AsRecorded(Option<Action>);

impl Pilot for AsRecorded {
    fn begin(&mut self, _seed: u64) {}

    fn ask(&mut self, _view: &View<'_>, _goal: usize) -> Option<Action> {
        self.0
    }
}
