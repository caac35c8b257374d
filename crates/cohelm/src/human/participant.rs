//! Participants drawn from a seed: traits from a population, a technique from the plant's skill.

use super::{HumanError, HumanPilot, Population, Skill};
use crate::action::ActionSpace;
use crate::random::{Draws, mix_seed};

/// Makes the skill of one person at the keys of a set of actions, with whatever differs between people drawn, or says
/// why nobody can steer with these actions.
pub type MakeSkill = fn(&ActionSpace, &mut Draws) -> Result<Box<dyn Skill>, String>;

/// Which simulated person: number `index` of those that `seed` draws from a population.
///
/// The same seed and index make the same person in every population, but for the traits in which the population
/// differs, so that populations may be compared person by person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Person {
    /// Where the traits come from.
    pub population: Population,
    /// Fixes everybody who is drawn.
    pub seed: u64,
    /// Which of them.
    pub index: u64,
}

/// Why there is no such participant.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParticipantError {
    /// Nobody knows how the plant is steered by its keys.
    #[error("plant {plant:?} has no simulated people: its entry names no skill")]
    NoSkill {
        /// Which plant.
        plant: &'static str,
    },
    /// The plant cannot be steered by these keys.
    #[error("{0}")]
    Skill(String),
    /// The pilot itself is impossible.
    #[error(transparent)]
    Human(#[from] HumanError),
}

/// Sets what is drawn about a person apart from what is drawn about its technique.
const TRAITS: u64 = 0;
/// See [`TRAITS`].
const TECHNIQUE: u64 = 1;

/// A participant with a skill, at the keys of a set of actions.
///
/// ```
/// use cohelm::human::{Person, Population, participant};
/// use cohelm::pilot::Pilot;
/// use cohelm::plant::Plant;
/// use cohelm::point::{self, Point};
///
/// let point = Point::new();
/// let skill = point::entry().skill.expect("the point can be steered by hand");
/// let third = Person { population: Population::Ordinary, seed: 2024, index: 2 };
/// let mut pilot = participant(skill, point.space(), third)?;
/// pilot.begin(7);
/// assert_eq!(pilot.ask(&point.view(), point.pilot_goal()), None, "nobody reacts within a tick");
/// # Ok::<(), cohelm::human::ParticipantError>(())
/// ```
pub fn participant(
    skill: MakeSkill,
    space: &ActionSpace,
    who: Person,
) -> Result<HumanPilot, ParticipantError> {
    let person = mix_seed(who.seed, who.index);
    let traits = who.population.ranges().draw(&mut Draws::fork(person, TRAITS));
    let skill = skill(space, &mut Draws::fork(person, TECHNIQUE)).map_err(ParticipantError::Skill)?;
    Ok(HumanPilot::new(traits, skill, space)?)
}
