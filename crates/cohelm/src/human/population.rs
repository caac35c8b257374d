//! Kinds of simulated participants, by name.

use super::traits::Ranges;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// From whom participants are drawn: ordinary people, or such as differ from them in one respect.
///
/// ```
/// use cohelm::human::Population;
/// let slow: Population = "slow".parse()?;
/// assert_eq!(slow.ranges().delay_ticks, [16, 25]);
/// # Ok::<(), cohelm::human::UnknownPopulation>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Population {
    /// [`Ranges::ORDINARY`].
    #[default]
    Ordinary,
    /// Neither resists help nor relaxes under it.
    Indifferent,
    /// Fights help that gets in the way two to three times as hard as the most resistant ordinary participant.
    Fighters,
    /// Lets go two to three times as far as the most trusting ordinary participant while all goes well.
    Relaxers,
    /// Reacts within 100 to 160 ms and moves its attention quickly.
    Skilled,
    /// Reacts within 320 to 500 ms.
    Slow,
    /// Presses at the slightest error.
    PressHappy,
    /// Hits a wrong key at 15 to 30 % of its presses.
    WrongKeys,
    /// Holds each key until it has seen it working, for 1.5 s at most: the paper's explanation of why people press more
    /// against an intervening robot, taken literally.
    Insisting,
    /// Insists and fights.
    InsistingFighters,
}

/// No population has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no population of pilots is called {name:?}; there are: {}", known_names())]
pub struct UnknownPopulation {
    /// What was asked for.
    pub name: String,
}

impl Population {
    /// All populations, in the order of tables.
    pub const ALL: [Self; 10] = [
        Self::Ordinary,
        Self::Indifferent,
        Self::Fighters,
        Self::Relaxers,
        Self::Skilled,
        Self::Slow,
        Self::PressHappy,
        Self::WrongKeys,
        Self::Insisting,
        Self::InsistingFighters,
    ];

    /// The word for it in options, files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Ordinary => "ordinary",
            Self::Indifferent => "indifferent",
            Self::Fighters => "fighters",
            Self::Relaxers => "relaxers",
            Self::Skilled => "skilled",
            Self::Slow => "slow",
            Self::PressHappy => "press-happy",
            Self::WrongKeys => "wrong-keys",
            Self::Insisting => "insisting",
            Self::InsistingFighters => "insisting-fighters",
        }
    }

    /// The ranges its participants are drawn from.
    pub fn ranges(self) -> Ranges {
        let ordinary = Ranges::ORDINARY;
        let (strong, none, insist_ticks) = ([2.0, 3.0], [0.0, 0.0], [75, 75]);
        match self {
            Self::Ordinary => ordinary,
            Self::Indifferent => Ranges { resist: none, trust: none, ..ordinary },
            Self::Fighters => Ranges { resist: strong, ..ordinary },
            Self::Relaxers => Ranges { trust: strong, ..ordinary },
            Self::Skilled => Ranges { delay_ticks: [5, 8], dwell_ticks: [10.0, 20.0], ..ordinary },
            Self::Slow => Ranges { delay_ticks: [16, 25], ..ordinary },
            Self::PressHappy => Ranges { dead_band: [0.3, 0.6], ..ordinary },
            Self::WrongKeys => Ranges { wrong_key: [0.15, 0.3], ..ordinary },
            Self::Insisting => Ranges { insist_ticks, ..ordinary },
            Self::InsistingFighters => Ranges { insist_ticks, resist: strong, ..ordinary },
        }
    }
}

fn known_names() -> String {
    Population::ALL.map(Population::word).join(", ")
}

impl FromStr for Population {
    type Err = UnknownPopulation;

    fn from_str(name: &str) -> Result<Self, UnknownPopulation> {
        let known = Self::ALL.into_iter().find(|population| population.word() == name);
        known.ok_or_else(|| UnknownPopulation { name: name.into() })
    }
}

impl fmt::Display for Population {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.pad(self.word())
    }
}
