//! What an intent network learns from: a flight as it sees it, and which goal was the pilot's.

use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Mirror, Plant};
use cohelm_copilot::encode::IntentEncoder;

/// A flight, one row of numbers for each tick of the network.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sequence {
    width: usize,
    goals: usize,
    /// Index of the pilot's own goal: what is to be learnt. It is in none of the rows.
    pub truth: usize,
    rows: Vec<f32>,
}

impl Sequence {
    /// Ticks of the network.
    pub fn ticks(&self) -> usize {
        self.rows.len() / self.width
    }

    /// What is seen at a tick; the goals' positions come last.
    pub fn row(&self, tick: usize) -> &[f32] {
        &self.rows[tick * self.width..][..self.width]
    }

    /// Where the goals are at a tick.
    pub fn goals(&self, tick: usize) -> impl Iterator<Item = [f32; 2]> + '_ {
        let row = self.row(tick);
        row[row.len() - 2 * self.goals..].chunks_exact(2).map(|position| [position[0], position[1]])
    }

    /// Where the pilot's goal is at a tick.
    pub fn wanted(&self, tick: usize) -> [f32; 2] {
        let row = self.row(tick);
        let at = row.len() - 2 * (self.goals - self.truth);
        [row[at], row[at + 1]]
    }
}

/// A plant's symmetry, as it shows in sequences.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MirroredSequence {
    /// Where each number of a row comes from, and its sign.
    row: Vec<(usize, f32)>,
    /// A mirror that exchanges left and right reverses the order of goals that are listed by x.
    reverses: bool,
}

impl MirroredSequence {
    /// For rows of what was asked and the share of silence, the state, and the positions of `goals`; `None` if the mirror
    /// does not tell what becomes of the actions.
    pub fn new(mirror: &Mirror, space: &ActionSpace, goals: usize) -> Option<Self> {
        let reverses = mirror.position[0] < 0.0;
        let shares: Vec<(usize, f32)> = match space {
            ActionSpace::Axes { .. } => mirror.axes.clone(),
            _ => mirror.commands.iter().map(|&command| (usize::from(command), 1.0)).collect(),
        };
        let commands = shares.len();
        let told = match space {
            ActionSpace::Axes { names, .. } => commands == names.len(),
            _ => commands == space.commands(),
        };
        let state = mirror.state.iter().map(|&(place, sign)| (commands + 1 + place, sign));
        let first = commands + 1 + mirror.state.len();
        let positions = (0..goals).flat_map(|goal| {
            let from = if reverses { goals - 1 - goal } else { goal };
            [0, 1].map(|i| (first + 2 * from + i, mirror.position[i]))
        });
        let row = shares.into_iter().chain([(commands, 1.0)]).chain(state).chain(positions).collect();
        told.then_some(Self { row, reverses })
    }

    /// The same flight in a mirror.
    pub fn of(&self, sequence: &Sequence) -> Sequence {
        let rows = sequence.rows.chunks_exact(sequence.width);
        let mirrored =
            |row: &[f32]| self.row.iter().map(|&(place, sign)| sign * row[place]).collect::<Vec<_>>();
        let truth = if self.reverses { sequence.goals - 1 - sequence.truth } else { sequence.truth };
        Sequence { rows: rows.flat_map(mirrored).collect(), truth, ..*sequence }
    }
}

/// Writes a sequence down while a flight goes on.
pub(crate) struct Scribe {
    encoder: IntentEncoder,
    row: Vec<f32>,
    sequence: Sequence,
}

impl Scribe {
    /// For the episode that a plant has just begun; `None` if it has no actions.
    pub fn new(plant: &dyn Plant) -> Option<Self> {
        let view = plant.view();
        let goals = view.goals.len();
        let encoder = IntentEncoder::new(plant.space(), view.state.len(), goals)?;
        let width = encoder.with_goals();
        let sequence = Sequence { width, goals, truth: plant.pilot_goal(), rows: Vec::new() };
        Some(Self { encoder, row: vec![0.0; width], sequence })
    }

    /// Before each tick: what the network would see if it is due.
    pub fn look(&mut self, plant: &dyn Plant) {
        let view = plant.view();
        if IntentEncoder::is_due(view.tick) {
            self.encoder.encode(&view, &mut self.row);
            self.sequence.rows.extend_from_slice(&self.row);
        }
    }

    /// After each tick: what was asked at it.
    pub fn note(&mut self, asked: Option<Action>) {
        self.encoder.note(asked);
    }

    /// The sequence.
    pub fn finish(self) -> Sequence {
        self.sequence
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_commands() -> ActionSpace {
        ActionSpace::Single { names: vec!["a".into(), "b".into()], pushes: vec![None; 2] }
    }

    #[test]
    fn in_a_mirror_the_pilot_wants_the_goal_on_the_other_side_and_presses_the_other_keys() {
        // Two commands, silence, two numbers of state, three goals.
        let rows = vec![0.5, 0.25, 0.25, 0.1, 0.2, -0.5, 1.0, 0.0, 2.0, 0.7, 3.0];
        let sequence = Sequence { width: 11, goals: 3, truth: 2, rows };
        let state = vec![(0, -1.0), (1, 1.0)];
        let mirror = Mirror { state, position: [-1.0, 1.0], commands: vec![1, 0], axes: vec![] };
        let mirrored = MirroredSequence::new(&mirror, &two_commands(), 3).unwrap();
        let twin = mirrored.of(&sequence);
        assert_eq!(twin.rows, [0.25, 0.5, 0.25, -0.1, 0.2, -0.7, 3.0, 0.0, 2.0, 0.5, 1.0]);
        assert_eq!((twin.truth, twin.wanted(0)), (0, [-0.7, 3.0]));
        assert_eq!(mirrored.of(&twin), sequence);
    }
}
