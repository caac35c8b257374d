//! A record that is flown on from one of its ticks, under another rule or by another pilot.

use crate::fleet::{Crew, person, values_of};
use crate::page::PageError;
use cohelm::action::ActionSpace;
use cohelm::arbitration::Rule;
use cohelm::branch::Branch;
use cohelm::cockpit::Silence;
use cohelm::human::Population;
use cohelm::impaired::Greedy;
use cohelm::intent::Inference;
use cohelm::pilot::{Pilot, Silent};
use cohelm::plant::Plant;
use cohelm::registry::Plants;
use cohelm::report::{Opening, TickReport};
use cohelm::trajectory::{Setup, Trajectory};
use cohelm_copilot::Models;
use serde::{Deserialize, Serialize};

/// What is wished to be otherwise, and from when on.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wish {
    /// Ticks that are as recorded.
    pub at: u32,
    /// The rule from there on.
    pub rule: Rule,
    /// Where the belief about the goal comes from.
    pub inference: Inference,
    /// What is carried out when nothing is asked.
    #[serde(default)]
    pub silence: Silence,
    /// SHA-256 of the value model's file.
    pub values: Option<String>,
    /// SHA-256 of the intent model's file.
    pub intent: Option<String>,
    /// Who asks from there on.
    pub pilot: Hands,
}

/// Who asks from the branch on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "pilot", rename_all = "kebab-case")]
pub enum Hands {
    /// The recorded requests.
    Recorded,
    /// Nobody: all keys are let go.
    Nobody,
    /// A pilot that asks at every tick for the best action for the person's own goal.
    Greedy,
    /// A simulated person, new to the flight.
    Person {
        /// Drawn from whom.
        population: Population,
        /// Which of them.
        person: u64,
    },
}

impl Hands {
    /// Everybody who could be asked for, people by the first of each population.
    pub fn all() -> Vec<Self> {
        let people = Population::ALL.map(|population| Self::Person { population, person: 0 });
        [Self::Recorded, Self::Nobody, Self::Greedy].into_iter().chain(people).collect()
    }

    fn name(self) -> String {
        match self {
            Self::Recorded => "recorded".into(),
            Self::Nobody => "nobody".into(),
            Self::Greedy => "greedy".into(),
            Self::Person { population, person } => format!("simulated {population} {person}"),
        }
    }
}

impl Wish {
    /// The setup of a record with what is wished to be otherwise.
    fn setup(&self, of: &Setup) -> Setup {
        let Self { rule, inference, silence, values, intent, pilot, .. } = self.clone();
        Setup { rule, inference, silence, values, intent, pilot: pilot.name(), ..of.clone() }
    }
}

/// Whom a page can ask, and with which models.
#[derive(Clone, Copy)]
pub struct Means<'a> {
    /// The plants there are.
    pub plants: &'a Plants,
    /// The models there are.
    pub models: &'a Models,
}

impl Means<'_> {
    /// The pilot that takes over; `None` if the recorded one goes on.
    fn pilot(
        self,
        hands: Hands,
        setup: &Setup,
        space: &ActionSpace,
    ) -> Result<Option<Box<dyn Pilot>>, PageError> {
        let mut pilot: Box<dyn Pilot> = match hands {
            Hands::Recorded => return Ok(None),
            Hands::Nobody => Box::new(Silent),
            Hands::Greedy => Box::new(Greedy::new(values_of(setup, self.plants, self.models)?)),
            Hands::Person { population, person: index } => {
                person(self.plants.entry(&setup.task)?, space, population, index)?
            }
        };
        pilot.begin(setup.seed);
        Ok(Some(pilot))
    }

    /// Who can take over in a setup's plant, as far as trying tells.
    pub fn pilots(self, setup: &Setup) -> Result<Vec<Hands>, PageError> {
        let plant = self.plants.make(&setup.task)?;
        let can = |hands: &Hands| self.pilot(*hands, setup, plant.space()).is_ok();
        Ok(Hands::all().into_iter().filter(can).collect())
    }
}

/// A branch, and the record that it leaves.
pub struct Branching {
    record: Trajectory,
    branch: Branch,
    setup: Setup,
    space: ActionSpace,
    median_range: Option<f64>,
}

impl Branching {
    /// Flies a record up to the wished tick and hands over.
    pub fn new(record: &Trajectory, wish: &Wish, means: Means<'_>) -> Result<Self, PageError> {
        let Means { plants, models } = means;
        let setup = wish.setup(&record.setup);
        let Crew { plant, mut cockpit, .. } = Crew::of(&record.setup, plants, models)?;
        let other = Crew::of(&setup, plants, models)?;
        let space = plant.space().clone();
        let pilot = means.pilot(wish.pilot, &setup, &space)?;
        let branch = Branch::new(record, wish.at, plant, &mut cockpit, other.cockpit)?;
        let branch = match pilot {
            Some(pilot) => branch.flown_by(pilot),
            None => branch,
        };
        Ok(Self { record: record.clone(), branch, setup, space, median_range: other.median_range })
    }

    /// The record that it leaves.
    pub fn record(&self) -> &Trajectory {
        &self.record
    }

    /// The branch itself.
    pub fn branch(&self) -> &Branch {
        &self.branch
    }

    /// What to know where it begins: the setup with what was wished, goals and poses of that moment.
    pub fn opening(&self) -> Opening {
        Opening::of(&self.setup, self.branch.plant(), None)
    }

    /// Flies one tick; `None` once the episode has ended.
    pub fn tick(&mut self) -> Option<TickReport> {
        let Self { branch, space, setup, median_range, .. } = self;
        let report = branch.tick().map(|tick| TickReport::of(&tick, space, &setup.rule, *median_range));
        report.map(|report| report.placed(self.plant()))
    }

    fn plant(&self) -> &dyn Plant {
        self.branch.plant()
    }
}
