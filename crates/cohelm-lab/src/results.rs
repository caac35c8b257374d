//! Flown episodes as tables: a row an episode, a row a participant, and the table that a test reads.

use crate::episode::EpisodeMeasures;
use crate::experiment::{Condition, Flown};
use cohelm_study::csv::{Cell, Csv};
use cohelm_study::measures::{OF_A_PARTICIPANT, OF_AN_EPISODE};
use cohelm_study::statistics::{Listwise, Table, TableError};

/// The episodes of an experiment.
#[derive(Clone, Copy, Debug)]
pub struct Results<'a> {
    /// The conditions, in order.
    pub conditions: &'a [Condition],
    /// How many participants flew.
    pub participants: usize,
    /// Every episode.
    pub flown: &'a [Flown],
}

impl Results<'_> {
    /// What a participant is called.
    pub fn name_of(participant: usize) -> String {
        format!("P{:02}", participant + 1)
    }

    /// Index of the condition of that name.
    pub fn condition(&self, name: &str) -> Option<usize> {
        self.conditions.iter().position(|condition| condition.name == name)
    }

    /// A participant's mean of a measure in a condition, over the episodes that have a value.
    pub fn participant_mean(&self, key: &str, participant: usize, condition: usize) -> Option<f64> {
        let of = |flown: &&Flown| flown.participant == participant && flown.condition == condition;
        mean(self.flown.iter().filter(of).filter_map(|flown| flown.measures.value(key)))
    }

    /// The mean of a measure in a condition over the participants' means.
    pub fn mean(&self, key: &str, condition: usize) -> Option<f64> {
        mean(
            (0..self.participants)
                .filter_map(|participant| self.participant_mean(key, participant, condition)),
        )
    }

    /// The participants' means of a measure in some conditions, by name, as the tests read them.
    pub fn table(&self, key: &str, conditions: &[&str]) -> Result<Listwise, TableError> {
        let index = |name: &&str| self.condition(name);
        let chosen: Vec<Option<usize>> = conditions.iter().map(index).collect();
        let row = |participant| {
            chosen.iter().map(|&condition| self.participant_mean(key, participant, condition?)).collect()
        };
        let rows = (0..self.participants).map(row).collect();
        let names = (0..self.participants).map(Self::name_of).collect();
        Table::listwise(names, conditions.iter().map(|name| name.to_string()).collect(), rows)
    }

    /// Means of a measure: `values[condition][participant]`, as figures read them.
    pub fn columns(&self, key: &str, conditions: &[usize]) -> Vec<Vec<Option<f64>>> {
        let column = |&condition: &usize| {
            (0..self.participants)
                .map(|participant| self.participant_mean(key, participant, condition))
                .collect()
        };
        conditions.iter().map(column).collect()
    }

    /// A row an episode.
    pub fn episodes_csv(&self) -> Csv {
        let identity = ["participant", "condition", "episode", "seed"];
        let mut csv = Csv::new(identity.into_iter().chain(OF_AN_EPISODE.iter().map(|measure| measure.key)));
        for flown in self.flown {
            let identity = [
                Cell::from(Self::name_of(flown.participant)),
                Cell::from(self.conditions[flown.condition].name.as_str()),
                Cell::from(flown.episode + 1),
                Cell::from(flown.trajectory.setup.seed as i64),
            ];
            csv.push(
                identity
                    .into_iter()
                    .chain(OF_AN_EPISODE.iter().map(|m| episode_cell(&flown.measures, m.key))),
            );
        }
        csv
    }

    /// A row a participant and condition: rates, then means.
    pub fn participants_csv(&self) -> Csv {
        let measures: Vec<&str> = participant_keys().collect();
        let identity = ["participant", "condition", "episodes"];
        let mut csv = Csv::new(identity.into_iter().chain(measures.iter().copied()));
        for participant in 0..self.participants {
            for (index, condition) in self.conditions.iter().enumerate() {
                let mine = |flown: &&Flown| flown.participant == participant && flown.condition == index;
                let identity = [
                    Cell::from(Self::name_of(participant)),
                    Cell::from(condition.name.as_str()),
                    Cell::from(self.flown.iter().filter(mine).count()),
                ];
                let means =
                    measures.iter().map(|key| Cell::from(self.participant_mean(key, participant, index)));
                csv.push(identity.into_iter().chain(means));
            }
        }
        csv
    }
}

/// Keys of the per-participant table: the rates, then the means of what an episode has.
pub fn participant_keys() -> impl Iterator<Item = &'static str> {
    let of_episodes = OF_AN_EPISODE.iter().map(|measure| measure.key).filter(|key| *key != "ending");
    OF_A_PARTICIPANT.iter().map(|measure| measure.key).chain(of_episodes)
}

fn episode_cell(measures: &EpisodeMeasures, key: &str) -> Cell {
    match key {
        "ending" => Cell::from(measures.ending.word()),
        "goal_right_midway" => Cell::from(measures.goal_right_midway),
        "goal_right_at_end" => Cell::from(measures.goal_right_at_end),
        _ => Cell::from(measures.value(key)),
    }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}
