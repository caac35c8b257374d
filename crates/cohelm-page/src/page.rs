//! Everything the page can ask for, as safe Rust.

use crate::answers::{DigestReport, ModelReport, ReplayReport};
use crate::branching::{Branching, Hands, Means, Wish};
use crate::fleet::{Crew, plants};
use crate::viewing::Viewing;
use cohelm::action::{Action, ActionSpace};
use cohelm::branch::BranchError;
use cohelm::flight::{Flight, replay};
use cohelm::human::ParticipantError;
use cohelm::keys::Change;
use cohelm::registry::{PlantEntry, Plants, TaskError};
use cohelm::report::{Opening, TickReport};
use cohelm::trajectory::{MAX_SEED, Setup, Trajectory, TrajectoryError, put_event};
use cohelm_copilot::{CockpitError, ModelError, Models};

/// One page: it flies one flight, shows one record, or flies one on, at a time.
///
/// ```
/// use cohelm::keys::Change;
/// use cohelm_page::page::Page;
/// let setup = br#"{"task": {"plant": "point"}, "plant_version": 1, "seed": 5, "rule": {"rule": "misc"},
///     "inference": "nearest", "time_scale": 1.0, "values": null, "intent": null, "pilot": "person"}"#;
/// let mut page = Page::new();
/// let opening = page.begin(setup)?;
/// assert_eq!(opening.controls[3].name, "y +");
/// page.change(Change::Down(3), 12.5)?;
/// let report = page.tick()?.expect("a flight that has just begun goes on");
/// assert_eq!(report.asked.unwrap().axes, Some([0.0, 1.0, 0.0, 0.0]));
/// let record = page.finish()?;
/// assert!(page.replay(&record)?.identical);
/// # Ok::<(), cohelm_page::page::PageError>(())
/// ```
pub struct Page {
    plants: Plants,
    models: Models,
    showing: Showing,
}

enum Showing {
    Nothing,
    Flight(Box<Flown>),
    Record(Box<Viewing>),
    Branch(Box<Branching>),
}

struct Flown {
    flight: Flight,
    space: ActionSpace,
    median_range: Option<f64>,
}

/// Why the page's wish cannot be met.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The setup is not what it should be.
    #[error("the setup of the episode is wrong: {0}")]
    Setup(serde_json::Error),
    /// No such plant, or not with these options.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// The setup's rule, inference and models do not go together, or not with its plant.
    #[error(transparent)]
    Cockpit(#[from] CockpitError),
    /// The bytes are no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The bytes are no trajectory.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// The seed would not survive JSON.
    #[error("the seed must be at most {MAX_SEED}, got {0}")]
    Seed(u64),
    /// A record holds an action that its plant does not have.
    #[error("the record holds an action that plant {plant:?} does not have: {action:?}")]
    Action {
        /// The action.
        action: Action,
        /// The plant.
        plant: String,
    },
    /// The time of a key event is no number.
    #[error("a key event's time must be a finite number of milliseconds, got {0}")]
    Time(f32),
    /// A wish for a branch is not what it should be.
    #[error("the wish for a what-if is wrong: {0}")]
    Wish(serde_json::Error),
    /// The record cannot be flown on as wished.
    #[error(transparent)]
    Branch(#[from] BranchError),
    /// Nobody knows how to fly this by its keys.
    #[error(transparent)]
    Pilot(#[from] ParticipantError),
    /// A pilot that follows values has none.
    #[error("there are no values for {0:?} that a pilot could follow; name a model")]
    NoValues(String),
    /// An answer could not be written as JSON.
    #[error("the answer has no JSON form: {0}")]
    Answer(serde_json::Error),
    /// No flight was begun.
    #[error("no flight is under way; begin one first")]
    NoFlight,
    /// No record is shown.
    #[error("no record is being watched; give one first")]
    NoRecord,
}

impl Default for Page {
    fn default() -> Self {
        Self::new()
    }
}

impl Page {
    /// Shows nothing yet.
    pub fn new() -> Self {
        Self::with_plants(plants())
    }

    /// The same for other plants, before they are among the page's own.
    pub fn with_plants(plants: Plants) -> Self {
        Self { plants, models: Models::new(), showing: Showing::Nothing }
    }

    /// The plants there are.
    pub fn plants(&self) -> &[PlantEntry] {
        self.plants.entries()
    }

    /// Takes in a model, from the bytes of its file. Setups and records find it by its hash, now and later.
    pub fn add_model(&mut self, bytes: &[u8]) -> Result<ModelReport, PageError> {
        Ok(ModelReport::of(self.models.add(bytes)?))
    }

    /// Begins the flight of a [`Setup`] in JSON; what was shown before is gone.
    pub fn begin(&mut self, setup: &[u8]) -> Result<Opening, PageError> {
        let setup: Setup = serde_json::from_slice(setup).map_err(PageError::Setup)?;
        let Crew { plant, cockpit, median_range } = Crew::of(&setup, &self.plants, &self.models)?;
        let space = plant.space().clone();
        let flight = Flight::new(setup, plant, cockpit);
        let opening = Opening::of(flight.setup(), flight.plant(), None);
        self.showing = Showing::Flight(Box::new(Flown { flight, space, median_range }));
        Ok(opening)
    }

    /// A key or stick changed, at that time by the page's clock (milliseconds since the episode began). It takes
    /// effect at the next tick.
    pub fn change(&mut self, change: Change, at_ms: f32) -> Result<(), PageError> {
        if !at_ms.is_finite() {
            return Err(PageError::Time(at_ms));
        }
        self.flown()?.flight.change(change, at_ms);
        Ok(())
    }

    /// Flies one tick, of a flight or of a branch; `None` once the episode has ended.
    pub fn tick(&mut self) -> Result<Option<TickReport>, PageError> {
        if let Showing::Branch(branching) = &mut self.showing {
            return Ok(branching.tick());
        }
        let Flown { flight, space, median_range } = self.flown()?;
        let rule = flight.setup().rule;
        let report = flight.tick().map(|tick| TickReport::of(&tick, space, &rule, *median_range));
        Ok(report.map(|report| report.placed(flight.plant())))
    }

    /// The key log from the event of that index on, as [`put_event`] writes it: what to send to the server now.
    pub fn events_from(&self, index: usize) -> Result<Vec<u8>, PageError> {
        let mut bytes = Vec::new();
        let events = self.flight()?.keys();
        events.iter().skip(index).for_each(|event| put_event(&mut bytes, event));
        Ok(bytes)
    }

    /// Digests of all bits so far, of a flight or of a branch.
    pub fn digests(&self) -> Result<DigestReport, PageError> {
        if let Showing::Branch(branching) = &self.showing {
            let branch = branching.branch();
            return Ok(DigestReport::of(branch.ticks(), branch.digests()));
        }
        let flight = self.flight()?;
        Ok(DigestReport::of(flight.ticks(), flight.digests()))
    }

    /// Ends the flight and gives its [`Trajectory`] as bytes; one that had not ended is abandoned.
    pub fn finish(&mut self) -> Result<Vec<u8>, PageError> {
        match std::mem::replace(&mut self.showing, Showing::Nothing) {
            Showing::Flight(flown) => Ok(flown.flight.finish().to_bytes()),
            other => {
                self.showing = other;
                Err(PageError::NoFlight)
            }
        }
    }

    /// Shows a record from its beginning; what was shown before is gone.
    pub fn watch(&mut self, trajectory: &[u8]) -> Result<Opening, PageError> {
        let (trajectory, crew) = self.crew_of(trajectory)?;
        let viewing = Viewing::new(trajectory, crew);
        let opening = viewing.opening();
        self.showing = Showing::Record(Box::new(viewing));
        Ok(opening)
    }

    /// Goes to where the record stands after `ticks` ticks (or at its end), forwards or backwards, and tells the last
    /// of them; `None` at the beginning.
    pub fn seek(&mut self, ticks: u32) -> Result<Option<TickReport>, PageError> {
        match &mut self.showing {
            Showing::Record(viewing) => Ok(viewing.seek(ticks)),
            _ => Err(PageError::NoRecord),
        }
    }

    /// Flies the record that is watched on from one of its ticks as a [`Wish`] in JSON says, in place of showing it; the
    /// branch is flown by [`tick`](Self::tick), and may be left for another one. What is shown stays if that cannot be.
    pub fn branch(&mut self, wish: &[u8]) -> Result<Opening, PageError> {
        let wish: Wish = serde_json::from_slice(wish).map_err(PageError::Wish)?;
        let branching = Branching::new(self.record()?, &wish, self.means())?;
        let opening = branching.opening();
        self.showing = Showing::Branch(Box::new(branching));
        Ok(opening)
    }

    /// Who can take over the record that is watched.
    pub fn pilots(&self) -> Result<Vec<Hands>, PageError> {
        self.means().pilots(&self.record()?.setup)
    }

    /// Flies a record again as fast as possible and compares every bit. What is shown stays.
    pub fn replay(&self, trajectory: &[u8]) -> Result<ReplayReport, PageError> {
        let (trajectory, Crew { mut plant, mut cockpit, .. }) = self.crew_of(trajectory)?;
        Ok(replay(&trajectory, plant.as_mut(), Some(&mut cockpit)).into())
    }

    /// A record, and what can fly it again. A plant takes only actions of its own space, so others are refused here.
    fn crew_of(&self, trajectory: &[u8]) -> Result<(Trajectory, Crew), PageError> {
        let trajectory = Trajectory::from_bytes(trajectory)?;
        let crew = Crew::again(&trajectory, &self.plants, &self.models)?;
        let space = crew.plant.space();
        let mut actions = trajectory.asked.iter().chain(&trajectory.executed).flatten();
        match actions.find(|action| !space.contains(**action)) {
            Some(&foreign) => Err(PageError::Action { action: foreign, plant: trajectory.setup.task.plant }),
            None => Ok((trajectory, crew)),
        }
    }

    fn means(&self) -> Means<'_> {
        Means { plants: &self.plants, models: &self.models }
    }

    fn record(&self) -> Result<&Trajectory, PageError> {
        match &self.showing {
            Showing::Record(viewing) => Ok(viewing.trajectory()),
            Showing::Branch(branching) => Ok(branching.record()),
            _ => Err(PageError::NoRecord),
        }
    }

    fn flight(&self) -> Result<&Flight, PageError> {
        match &self.showing {
            Showing::Flight(flown) => Ok(&flown.flight),
            _ => Err(PageError::NoFlight),
        }
    }

    fn flown(&mut self) -> Result<&mut Flown, PageError> {
        match &mut self.showing {
            Showing::Flight(flown) => Ok(flown),
            _ => Err(PageError::NoFlight),
        }
    }
}
