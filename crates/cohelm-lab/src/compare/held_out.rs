//! What tuning may see, and what is held out from it: a file that was there before anything was tuned.

use cohelm::human::Population;
use serde::{Deserialize, Serialize};

/// A draw of simulated people.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Draw {
    /// Fixes participants, terrain, goals and starts.
    pub seed: u64,
    /// Kinds of people.
    pub populations: Vec<Population>,
}

/// Two draws that share neither seed nor kind of people.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct HeldOut {
    /// What tuning sees.
    pub tuning: Draw,
    /// What the table is about.
    pub held_out: Draw,
}

impl HeldOut {
    /// The two draws that `held-out.toml` names.
    pub fn committed() -> Self {
        toml::from_str(include_str!("held-out.toml")).expect("a test reads this very file")
    }
}

#[cfg(test)]
mod tests {
    use super::HeldOut;

    #[test]
    fn nobody_is_on_both_sides() {
        let HeldOut { tuning, held_out } = HeldOut::committed();
        assert_ne!(tuning.seed, held_out.seed);
        assert!(!tuning.populations.is_empty() && !held_out.populations.is_empty());
        assert!(held_out.populations.iter().all(|population| !tuning.populations.contains(population)));
    }
}
