//! Pilots made worse on purpose: one that knows what every action is worth, and wrappers that lag or stray (Reddy,
//! Dragan and Levine 2018, "Shared Autonomy via Deep Reinforcement Learning", Section IV-A).

use crate::action::{Action, ActionSpace};
use crate::pilot::Pilot;
use crate::plant::View;
use crate::random::Draws;
use crate::value::ValueModel;

/// Asks at every tick for the action that a value model finds best for the pilot's own goal.
///
/// Not a person: it knows the goal, sees everything at once and never rests. Made worse by [`Laggy`] or [`Noisy`] it is
/// the pilot of Reddy 2018.
pub struct Greedy {
    values: Box<dyn ValueModel>,
}

impl Greedy {
    /// A pilot that trusts these values.
    pub fn new(values: Box<dyn ValueModel>) -> Self {
        Self { values }
    }
}

impl Pilot for Greedy {
    fn begin(&mut self, _seed: u64) {}

    fn ask(&mut self, view: &View<'_>, goal: usize) -> Option<Action> {
        let values = self.values.estimate(view, goal, None);
        Some(values.candidates()[values.best()])
    }
}

/// A probability that is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("expected a probability from 0 to 1, got {0}")]
pub struct NotAProbability(
    /// What came.
    pub f64,
);

fn probability(p: f64) -> Result<f64, NotAProbability> {
    if (0.0..=1.0).contains(&p) { Ok(p) } else { Err(NotAProbability(p)) }
}

/// Asks again for what it asked last with some probability, otherwise for what the pilot underneath asks.
pub struct Laggy {
    pilot: Box<dyn Pilot>,
    probability: f64,
    last: Option<Option<Action>>,
    draws: Draws,
}

impl Laggy {
    /// `probability` of repeating, at each tick: 0 changes nothing, 0.85 is Reddy's, 1 repeats the first request for
    /// ever.
    pub fn new(pilot: Box<dyn Pilot>, probability: f64) -> Result<Self, NotAProbability> {
        let probability = self::probability(probability)?;
        Ok(Self { pilot, probability, last: None, draws: Draws::new(0) })
    }
}

impl Pilot for Laggy {
    fn begin(&mut self, seed: u64) {
        self.pilot.begin(seed);
        self.last = None;
        self.draws = Draws::fork(seed, 0x006c_6167);
    }

    fn ask(&mut self, view: &View<'_>, goal: usize) -> Option<Action> {
        let fresh = self.pilot.ask(view, goal);
        let repeats = self.draws.chance(self.probability);
        let asked = self.last.filter(|_| repeats).unwrap_or(fresh);
        self.last = Some(asked);
        asked
    }

    fn key_presses(&self) -> u32 {
        self.pilot.key_presses()
    }
}

/// Asks for a random action with some probability, otherwise for what the pilot underneath asks.
pub struct Noisy {
    pilot: Box<dyn Pilot>,
    probability: f64,
    space: ActionSpace,
    draws: Draws,
}

impl Noisy {
    /// `probability` of straying, at each tick: 0 changes nothing, 0.3 is Reddy's, 1 is a random pilot. All commands
    /// are as likely; axes are uniform between their bounds.
    pub fn new(
        pilot: Box<dyn Pilot>,
        probability: f64,
        space: &ActionSpace,
    ) -> Result<Self, NotAProbability> {
        let probability = self::probability(probability)?;
        Ok(Self { pilot, probability, space: space.clone(), draws: Draws::new(0) })
    }

    fn random_action(&mut self) -> Action {
        match &self.space {
            ActionSpace::Axes { low, high, .. } => {
                let mut axes = [0.0; 4];
                for (axis, (&low, &high)) in axes.iter_mut().zip(low.iter().zip(high)) {
                    *axis = (self.draws.uniform(low.into(), high.into()) as f32).clamp(low, high);
                }
                Action::Axes(axes)
            }
            space => Action::Command(self.draws.below(space.commands()) as u8),
        }
    }
}

impl Pilot for Noisy {
    fn begin(&mut self, seed: u64) {
        self.pilot.begin(seed);
        self.draws = Draws::fork(seed, 0x006e_6f69_7365);
    }

    fn ask(&mut self, view: &View<'_>, goal: usize) -> Option<Action> {
        let asked = self.pilot.ask(view, goal);
        if self.draws.chance(self.probability) { Some(self.random_action()) } else { asked }
    }

    fn key_presses(&self) -> u32 {
        self.pilot.key_presses()
    }
}
