//! The candidates of a decision on axes, and what a critic says of each.
//!
//! | candidates | where they lie |
//! |---|---|
//! | 1 | what is asked, bit for bit (nothing, if nothing is) |
//! | [`GRID`] | always the same: nothing, the ends, the corners, and points of low discrepancy |
//! | twice [`AROUND`] | around the best so far, within a quarter and then within a sixteenth of each axis |
//! | [`BRIDGE`] | on the way from what is asked to the best |
//!
//! What is asked comes first, so that it wins every tie. The bridge is there for arbitration: an action that is allowed
//! and near to what was asked lies on it if one lies anywhere between the two.

use crate::axes::{AxesEncoder, Spread};
use cohelm::action::{Action, ActionSpace};
use cohelm::value::ActionValues;
use cohelm_nn::critic::{Critic, CriticScratch, CriticShape, Embedded};

/// Candidates that are always the same.
pub const GRID: usize = 64;
/// Candidates around the best so far, each of the two times.
pub const AROUND: usize = 24;
/// Candidates between what is asked and the best.
pub const BRIDGE: usize = 15;
/// All candidates.
pub const CANDIDATES: usize = 1 + GRID + 2 * AROUND + BRIDGE;
/// How far around the best, in halves of an axis.
const REACH: [f32; 2] = [0.5, 0.125];

/// Candidates and their values, decision after decision, without allocating.
#[derive(Clone, Debug)]
pub struct Search {
    axes: AxesEncoder,
    grid: Vec<Action>,
    /// Steps around the best: along each axis, then of low discrepancy; coordinates in [−1, 1].
    around: Vec<[f32; 4]>,
    of_grid: Embedded,
    of_asked: Embedded,
    of_around: [Embedded; 2],
    of_bridge: Embedded,
    of_other: Embedded,
    /// True if what is embedded are the candidates of `values`.
    embedded: bool,
    mean: Vec<f32>,
    phi: Vec<f32>,
    scratch: CriticScratch,
    found: Vec<f32>,
    values: ActionValues,
}

impl Search {
    /// For a space and a critic of its actions; `None` if the space has no axes that a critic can see.
    pub fn new(space: &ActionSpace, critic: &Critic) -> Option<Self> {
        let axes = AxesEncoder::of(space)?;
        let shape = critic.shape();
        let grid = axes.grid(GRID);
        let candidates = vec![Action::Axes([0.0; 4]); CANDIDATES];
        let mut search = Self {
            around: around(axes.axes()),
            of_grid: Embedded::new(shape, GRID),
            of_asked: Embedded::new(shape, 1),
            of_around: [Embedded::new(shape, AROUND), Embedded::new(shape, AROUND)],
            of_bridge: Embedded::new(shape, BRIDGE),
            of_other: Embedded::new(shape, 1),
            embedded: false,
            mean: vec![0.0; shape.width()],
            phi: vec![0.0; shape.width()],
            scratch: CriticScratch::new(shape),
            found: vec![0.0; CANDIDATES],
            values: ActionValues::equal(candidates).ok()?,
            axes,
            grid,
        };
        search.learn(critic);
        Some(search)
    }

    /// The actions of reference of a critic: the grid.
    pub fn reference(space: &ActionSpace) -> Option<Vec<Action>> {
        Some(AxesEncoder::of(space)?.grid(GRID))
    }

    /// The shape of a critic of a state of that many numbers; `None` as in [`new`](Self::new) or for widths that no
    /// network can have.
    pub fn shape(space: &ActionSpace, input: usize, hidden: &[usize]) -> Option<CriticShape> {
        let width = hidden.last().copied()?;
        CriticShape::new(input, hidden, AxesEncoder::of(space)?.len(), width).ok()
    }

    /// Takes in what a critic thinks of the grid; to be called whenever its weights have changed.
    pub fn learn(&mut self, critic: &Critic) {
        self.embedded = false;
        self.mean.fill(0.0);
        for &action in &self.grid {
            critic.embed(self.axes.encode(action).features(), &mut self.phi);
            self.mean.iter_mut().zip(&self.phi).for_each(|(mean, phi)| *mean += phi);
        }
        self.mean.iter_mut().for_each(|mean| *mean /= GRID as f32);
        for (index, &action) in self.grid.iter().enumerate() {
            critic.embed(self.axes.encode(action).features(), &mut self.phi);
            self.of_grid.set(index, &self.phi, &self.mean);
            self.values.set_candidate(1 + index, action);
        }
    }

    /// The candidates of a decision with their values: those of a state that is given as the critic sees it.
    ///
    /// Finite inputs and bounded weights give finite values. Should they ever not, there is no opinion: all are equal.
    pub fn estimate(&mut self, critic: &Critic, input: &[f32], asked: Option<Action>) -> &ActionValues {
        critic.look(input, &mut self.scratch);
        let asked = asked.unwrap_or(Action::Axes([0.0; 4]));
        self.values.set_candidate(0, asked);
        embed(critic, &self.axes, asked, (&self.mean, &mut self.phi), (&mut self.of_asked, 0));
        critic.values(&self.scratch, &self.of_asked, &mut self.found[..1]);
        critic.values(&self.scratch, &self.of_grid, &mut self.found[1..1 + GRID]);
        for (turn, reach) in REACH.into_iter().enumerate() {
            let best = self.best(1 + GRID + turn * AROUND);
            let of_around = &mut self.of_around[turn];
            for index in 0..AROUND {
                let action = self.axes.moved(best, self.around[index], reach);
                self.values.set_candidate(1 + GRID + turn * AROUND + index, action);
                embed(critic, &self.axes, action, (&self.mean, &mut self.phi), (of_around, index));
            }
            let place = &mut self.found[1 + GRID + turn * AROUND..][..AROUND];
            critic.values(&self.scratch, of_around, place);
        }
        let best = self.best(CANDIDATES - BRIDGE);
        for index in 0..BRIDGE {
            let action = self.axes.between(asked, best, (index + 1) as f32 / (BRIDGE + 1) as f32);
            self.values.set_candidate(CANDIDATES - BRIDGE + index, action);
            embed(critic, &self.axes, action, (&self.mean, &mut self.phi), (&mut self.of_bridge, index));
        }
        critic.values(&self.scratch, &self.of_bridge, &mut self.found[CANDIDATES - BRIDGE..]);
        self.embedded = true;
        if self.values.refill(&self.found).is_err() {
            self.found.fill(0.0);
            let equal = self.values.refill(&self.found);
            debug_assert!(equal.is_ok(), "zeros are finite");
        }
        &self.values
    }

    /// Q of given actions, one after the other into `values`, which is cleared. Those of the last decision cost little: what
    /// the critic thinks of them is known but for the state.
    pub fn assess(&mut self, critic: &Critic, input: &[f32], actions: &[Action], values: &mut Vec<f32>) {
        critic.look(input, &mut self.scratch);
        values.clear();
        values.resize(actions.len(), 0.0);
        if self.embedded && actions == self.values.candidates() {
            self.assess_candidates(critic, values);
        } else {
            for (&action, value) in actions.iter().zip(values.chunks_exact_mut(1)) {
                embed(critic, &self.axes, action, (&self.mean, &mut self.phi), (&mut self.of_other, 0));
                critic.values(&self.scratch, &self.of_other, value);
            }
        }
        if values.iter().any(|value| !value.is_finite()) {
            values.fill(0.0);
        }
    }

    /// Q of the candidates of the last decision in the state that was looked at last.
    fn assess_candidates(&self, critic: &Critic, values: &mut [f32]) {
        let parts = [&self.of_asked, &self.of_grid, &self.of_around[0], &self.of_around[1], &self.of_bridge];
        let mut rest = values;
        for part in parts {
            let (values, others) = rest.split_at_mut(part.count());
            critic.values(&self.scratch, part, values);
            rest = others;
        }
    }

    /// The best of the first candidates, the first of equals.
    fn best(&self, of: usize) -> Action {
        let found = &self.found[..of];
        let best = (1..of).fold(0, |best, i| if found[i] > found[best] { i } else { best });
        self.values.candidates()[best]
    }
}

/// Puts φ(a) − φ̄ of one action in its place.
fn embed(
    critic: &Critic,
    axes: &AxesEncoder,
    action: Action,
    (mean, phi): (&[f32], &mut [f32]),
    (embedded, index): (&mut Embedded, usize),
) {
    critic.embed(axes.encode(action).features(), phi);
    embedded.set(index, phi, mean);
}

/// The steps of a refinement: one along each axis to either side, the rest spread over the cube.
fn around(axes: usize) -> Vec<[f32; 4]> {
    let mut steps = Vec::with_capacity(AROUND);
    for axis in 0..axes {
        for side in [-1.0, 1.0] {
            let mut step = [0.0; 4];
            step[axis] = side;
            steps.push(step);
        }
    }
    let spread = Spread::over(axes);
    steps.extend((0..AROUND).map(|index| spread.point(index, [0.0; 4]).map(|x| 2.0 * x - 1.0)));
    steps.truncate(AROUND);
    steps
}
