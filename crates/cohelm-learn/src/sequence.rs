//! What an intent network learns from: a flight as it sees it, and which goal was the pilot's.

use cohelm::action::{Action, ActionSpace};
use cohelm::intent::MAX_GOALS;
use cohelm::plant::{Mirror, Plant};
use cohelm_copilot::encode::IntentEncoder;

/// A flight, one row of numbers for each tick of the network.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sequence {
    width: usize,
    rows: Vec<f32>,
    moments: Vec<Moment>,
}

/// What was true at a tick of the network: the goals, and which of them was the pilot's own. That is what is to be
/// learnt, and in none of the rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moment {
    positions: [[f32; 2]; MAX_GOALS],
    goals: usize,
    truth: usize,
}

impl Sequence {
    /// Ticks of the network.
    pub fn ticks(&self) -> usize {
        self.moments.len()
    }

    /// What is seen at a tick; places for the goals come last.
    pub fn row(&self, tick: usize) -> &[f32] {
        &self.rows[tick * self.width..][..self.width]
    }

    /// Where the goals are at a tick.
    pub fn goals(&self, tick: usize) -> &[[f32; 2]] {
        let moment = &self.moments[tick];
        &moment.positions[..moment.goals]
    }

    /// Index of the pilot's own goal at a tick.
    pub fn truth(&self, tick: usize) -> usize {
        self.moments[tick].truth
    }

    /// Where the pilot's own goal is at a tick.
    pub fn wanted(&self, tick: usize) -> [f32; 2] {
        self.goals(tick)[self.truth(tick)]
    }
}

/// A plant's symmetry, as it shows in sequences.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MirroredSequence {
    /// Where each number of a row comes from, and its sign.
    row: Vec<(usize, f32)>,
    /// A mirror that exchanges left and right reverses the order of goals that are listed by x.
    reverses: bool,
    position: [f32; 2],
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
        told.then_some(Self { row, reverses, position: mirror.position })
    }

    /// The same flight in a mirror.
    pub fn of(&self, sequence: &Sequence) -> Sequence {
        let rows = sequence.rows.chunks_exact(sequence.width);
        let mirrored =
            |row: &[f32]| self.row.iter().map(|&(place, sign)| sign * row[place]).collect::<Vec<_>>();
        let moments = sequence.moments.iter().map(|moment| self.moment(moment));
        let rows = rows.flat_map(mirrored).collect();
        Sequence { width: sequence.width, rows, moments: moments.collect() }
    }

    fn moment(&self, moment: &Moment) -> Moment {
        let mut mirrored = *moment;
        let from = |goal: usize| if self.reverses { moment.goals - 1 - goal } else { goal };
        for (goal, position) in mirrored.positions.iter_mut().enumerate().take(moment.goals) {
            *position = [0, 1].map(|i| self.position[i] * moment.positions[from(goal)][i]);
        }
        mirrored.truth = from(moment.truth);
        mirrored
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
        let sequence = Sequence { width, rows: Vec::new(), moments: Vec::new() };
        Some(Self { encoder, row: vec![0.0; width], sequence })
    }

    /// Before each tick: what the network would see if it is due. A moment without goals teaches nothing.
    pub fn look(&mut self, plant: &dyn Plant) {
        let view = plant.view();
        if IntentEncoder::is_due(view.tick) && !view.goals.is_empty() {
            self.encoder.encode(&view, &mut self.row);
            self.sequence.rows.extend_from_slice(&self.row);
            let mut moment = Moment { goals: view.goals.len().min(MAX_GOALS), ..Moment::default() };
            for (position, goal) in moment.positions.iter_mut().zip(view.goals) {
                *position = goal.position;
            }
            moment.truth = plant.pilot_goal().min(moment.goals - 1);
            self.sequence.moments.push(moment);
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
        let mut moment = Moment { goals: 3, truth: 2, ..Moment::default() };
        moment.positions[..3].copy_from_slice(&[[-0.5, 1.0], [0.0, 2.0], [0.7, 3.0]]);
        let sequence = Sequence { width: 11, rows, moments: vec![moment] };
        let state = vec![(0, -1.0), (1, 1.0)];
        let mirror = Mirror { state, position: [-1.0, 1.0], commands: vec![1, 0], axes: vec![] };
        let mirrored = MirroredSequence::new(&mirror, &two_commands(), 3).unwrap();
        let twin = mirrored.of(&sequence);
        assert_eq!(twin.rows, [0.25, 0.5, 0.25, -0.1, 0.2, -0.7, 3.0, 0.0, 2.0, 0.5, 1.0]);
        assert_eq!((twin.truth(0), twin.wanted(0)), (0, [-0.7, 3.0]));
        assert_eq!(twin.goals(0), [[-0.7, 3.0], [0.0, 2.0], [0.5, 1.0]]);
        assert_eq!(mirrored.of(&twin), sequence);
    }
}
