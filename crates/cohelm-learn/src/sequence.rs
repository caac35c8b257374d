//! What an intent network learns from: a flight as it sees it, and which goal was the pilot's.

use cohelm::action::Action;
use cohelm::plant::Plant;
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

/// Writes a sequence down while a flight goes on.
pub(crate) struct Scribe {
    encoder: IntentEncoder,
    row: Vec<f32>,
    sequence: Sequence,
}

impl Scribe {
    /// For the episode that a plant has just begun.
    pub fn new(plant: &dyn Plant) -> Self {
        let view = plant.view();
        let goals = view.goals.len();
        let encoder = IntentEncoder::new(plant.space().commands(), view.state.len(), goals);
        let width = encoder.with_goals();
        let sequence = Sequence { width, goals, truth: plant.pilot_goal(), rows: Vec::new() };
        Self { encoder, row: vec![0.0; width], sequence }
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
