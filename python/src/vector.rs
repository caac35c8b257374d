//! Many of Gymnasium's landers at once: one call steps all of them, on all cores and in vector registers, into arrays that exist
//! already.

use crate::errors::Kind;
use crate::lander::{continuous, discrete, options};
use cohelm::plant::Ending;
use cohelm_lander::gymnasium::{Action, GymnasiumLander, Observation, Order, Outcome};
use cohelm_lander::together::{WORLDS, tick};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Numbers of an observation.
const WIDTH: usize = 8;
/// Most worlds that one thread steps before it looks for more: with more, the last thread to finish works longer alone.
const LARGEST_ROW: usize = 2 * WORLDS;
/// Most worlds of one vector.
const MOST_WORLDS: usize = 1 << 20;

/// When a world whose episode ended begins the next one.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Autoreset {
    /// At the next step, which then carries no action out.
    NextStep,
    /// At once: the observation is the new episode's first, the last one is kept apart.
    SameStep,
    /// Never: whoever steps it resets it.
    Disabled,
}

/// Worlds that one thread steps together, and what their last tick brought.
struct Row {
    worlds: Vec<GymnasiumLander>,
    outcomes: Vec<Outcome>,
    /// The last observations of episodes that ended in the last tick; only with [`Autoreset::SameStep`].
    last: Vec<Observation>,
}

impl Row {
    fn new(worlds: Vec<GymnasiumLander>) -> Self {
        let nothing = Outcome { observation: [0.0; WIDTH], reward: 0.0, ending: None };
        Self { outcomes: vec![nothing; worlds.len()], last: vec![nothing.observation; worlds.len()], worlds }
    }

    fn step(&mut self, actions: &[Action], autoreset: Autoreset) {
        let resets = autoreset == Autoreset::NextStep;
        let order = |(before, action): (&Outcome, &Action)| {
            Some(if resets && before.ending.is_some() { Order::Restart } else { Order::Step(*action) })
        };
        let orders: Vec<_> = self.outcomes.iter().zip(actions).map(order).collect();
        self.obey(&orders);
        if autoreset == Autoreset::SameStep {
            self.begin_anew();
        }
    }

    /// One tick of the worlds that have an order.
    fn obey(&mut self, orders: &[Option<Order>]) {
        for (outcome, new) in self.outcomes.iter_mut().zip(tick(&mut self.worlds, orders)) {
            *outcome = new.unwrap_or(*outcome);
        }
    }

    /// Begins the next episodes where one has ended.
    fn begin_anew(&mut self) {
        let orders: Vec<_> =
            self.outcomes.iter().map(|outcome| outcome.ending.map(|_| Order::Restart)).collect();
        let first = tick(&mut self.worlds, &orders);
        for ((outcome, last), first) in self.outcomes.iter_mut().zip(&mut self.last).zip(first) {
            *last = outcome.observation;
            outcome.observation = first.map_or(outcome.observation, |first| first.observation);
        }
    }
}

/// Landers side by side. The arrays it returns are its own and are written anew by the next call.
#[pyclass(module = "cohelm")]
pub struct LanderVector {
    rows: Vec<Row>,
    worlds: usize,
    pool: Option<ThreadPool>,
    autoreset: Autoreset,
    is_continuous: bool,
    begun: bool,
    actions: Vec<Action>,
    arrays: Arrays,
}

struct Arrays {
    observations: Py<PyArray2<f32>>,
    last: Py<PyArray2<f32>>,
    rewards: Py<PyArray1<f64>>,
    terminated: Py<PyArray1<bool>>,
    truncated: Py<PyArray1<bool>>,
}

type Stepped<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray2<f32>>,
);

#[pymethods]
impl LanderVector {
    #[new]
    #[pyo3(signature = (worlds, *, continuous=false, gravity=-10.0, enable_wind=false, wind_power=15.0,
        turbulence_power=1.5, autoreset="next-step", threads=0))]
    #[allow(clippy::too_many_arguments, reason = "they are Gymnasium's keyword arguments")]
    fn new(
        py: Python<'_>,
        worlds: usize,
        continuous: bool,
        gravity: f64,
        enable_wind: bool,
        wind_power: f64,
        turbulence_power: f64,
        autoreset: &str,
        threads: usize,
    ) -> PyResult<Self> {
        if !(1..=MOST_WORLDS).contains(&worlds) {
            return Err(Kind::Option.error(format!("expected 1 to {MOST_WORLDS} worlds, got {worlds}")));
        }
        let options = options(gravity, (enable_wind, wind_power, turbulence_power))?;
        let world = GymnasiumLander::new(options).map_err(|error| Kind::Option.error(error))?;
        let threads = threads_for(threads, worlds);
        let size = worlds.div_ceil(threads).min(LARGEST_ROW);
        let rows =
            (0..worlds).step_by(size).map(|first| Row::new(vec![world.clone(); size.min(worlds - first)]));
        Ok(Self {
            rows: rows.collect(),
            worlds,
            pool: pool(threads)?,
            autoreset: autoreset_of(autoreset)?,
            is_continuous: continuous,
            begun: false,
            actions: vec![Action::Nothing; worlds],
            arrays: Arrays::new(py, worlds),
        })
    }

    /// How many worlds.
    #[getter]
    fn worlds(&self) -> usize {
        self.worlds
    }

    /// Begins the episodes of these seeds, or the next ones where a seed is None; where `mask` is given only those.
    #[pyo3(signature = (seeds=None, mask=None))]
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        seeds: Option<Vec<Option<u64>>>,
        mask: Option<PyReadonlyArray1<'_, bool>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let worlds = self.worlds;
        let seeds = seeds.unwrap_or_else(|| vec![None; worlds]);
        expect_length("seeds", seeds.len(), worlds)?;
        if !self.begun && seeds.contains(&None) {
            return Err(Kind::Closed.error("the first reset needs a seed for every world"));
        }
        let mask = mask.map(|mask| mask.as_array().to_vec());
        if let Some(mask) = &mask {
            expect_length("mask", mask.len(), worlds)?;
        }
        let order = |(index, seed): (usize, Option<u64>)| {
            let chosen = mask.as_ref().is_none_or(|mask| mask[index]);
            chosen.then(|| seed.map_or(Order::Restart, Order::Reset))
        };
        let orders: Vec<_> = seeds.into_iter().enumerate().map(order).collect();
        let mut left = orders.as_slice();
        for row in &mut self.rows {
            let (orders, rest) = left.split_at(row.worlds.len());
            row.obey(orders);
            left = rest;
        }
        self.begun = true;
        self.write(py)?;
        Ok(self.arrays.observations.bind(py).clone())
    }

    /// One tick of every world: observations, rewards, terminated, truncated, and the last observations of the episodes
    /// that ended in this step (only with autoreset "same-step"; otherwise they are the observations).
    fn step<'py>(&mut self, py: Python<'py>, actions: &Bound<'py, PyAny>) -> PyResult<Stepped<'py>> {
        if !self.begun {
            return Err(Kind::Closed.error("no episode has begun: call reset first"));
        }
        self.read_actions(actions)?;
        let Self { rows, actions, pool, autoreset, .. } = self;
        py.detach(|| step_all(rows, actions, pool.as_ref(), *autoreset));
        self.write(py)?;
        let Arrays { observations, last, rewards, terminated, truncated } = &self.arrays;
        Ok((
            observations.bind(py).clone(),
            rewards.bind(py).clone(),
            terminated.bind(py).clone(),
            truncated.bind(py).clone(),
            last.bind(py).clone(),
        ))
    }
}

impl LanderVector {
    fn read_actions(&mut self, actions: &Bound<'_, PyAny>) -> PyResult<()> {
        let worlds = self.worlds;
        if self.is_continuous {
            let throttles: PyReadonlyArray2<'_, f32> = actions.extract().map_err(|_| {
                Kind::Action.error(format!("expected throttles as a float32 array of shape ({worlds}, 2)"))
            })?;
            let throttles = throttles.as_array();
            expect_length("actions", throttles.nrows(), worlds)?;
            for (action, row) in self.actions.iter_mut().zip(throttles.rows()) {
                *action = continuous(&row.to_vec())?;
            }
        } else {
            let indices: PyReadonlyArray1<'_, i64> = actions.extract().map_err(|_| {
                Kind::Action.error(format!(
                    "expected actions as an int64 array of shape ({worlds},), each from 0 to 3"
                ))
            })?;
            let indices = indices.as_array();
            expect_length("actions", indices.len(), worlds)?;
            for (action, &index) in self.actions.iter_mut().zip(indices) {
                *action = discrete(index)?;
            }
        }
        Ok(())
    }

    fn write(&self, py: Python<'_>) -> PyResult<()> {
        let busy = |error: numpy::BorrowError| Kind::Array.error(format!("the arrays are in use: {error}"));
        let arrays = &self.arrays;
        let mut observations = arrays.observations.bind(py).try_readwrite().map_err(busy)?;
        let mut last = arrays.last.bind(py).try_readwrite().map_err(busy)?;
        let mut rewards = arrays.rewards.bind(py).try_readwrite().map_err(busy)?;
        let mut terminated = arrays.terminated.bind(py).try_readwrite().map_err(busy)?;
        let mut truncated = arrays.truncated.bind(py).try_readwrite().map_err(busy)?;
        let odd = |error: numpy::AsSliceError| Kind::Array.error(error);
        let rows = observations.as_slice_mut().map_err(odd)?.chunks_exact_mut(WIDTH);
        let last_rows = last.as_slice_mut().map_err(odd)?.chunks_exact_mut(WIDTH);
        let rewards = rewards.as_slice_mut().map_err(odd)?;
        let terminated = terminated.as_slice_mut().map_err(odd)?;
        let truncated = truncated.as_slice_mut().map_err(odd)?;
        let all = self.rows.iter().flat_map(|row| row.outcomes.iter().zip(&row.last));
        for (index, (((outcome, ended_with), row), last)) in all.zip(rows).zip(last_rows).enumerate() {
            row.copy_from_slice(&outcome.observation);
            last.copy_from_slice(if self.autoreset == Autoreset::SameStep {
                ended_with
            } else {
                &outcome.observation
            });
            rewards[index] = outcome.reward;
            terminated[index] = outcome.ending.is_some_and(Ending::is_terminal);
            truncated[index] = outcome.ending.is_some_and(|ending| !ending.is_terminal());
        }
        Ok(())
    }
}

impl Arrays {
    fn new(py: Python<'_>, worlds: usize) -> Self {
        let table = || PyArray2::zeros(py, [worlds, WIDTH], false).unbind();
        let truths = || PyArray1::from_vec(py, vec![false; worlds]).unbind();
        Self {
            observations: table(),
            last: table(),
            rewards: PyArray1::zeros(py, worlds, false).unbind(),
            terminated: truths(),
            truncated: truths(),
        }
    }
}

fn step_all(rows: &mut [Row], actions: &[Action], pool: Option<&ThreadPool>, autoreset: Autoreset) {
    let mut left = actions;
    let mut shares = Vec::with_capacity(rows.len());
    for row in rows {
        let (actions, rest) = left.split_at(row.worlds.len());
        shares.push(Mutex::new(Some((row, actions))));
        left = rest;
    }
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some(share) = shares.get(next.fetch_add(1, Ordering::Relaxed)) {
            let taken = share.lock().unwrap_or_else(PoisonError::into_inner).take();
            if let Some((row, actions)) = taken {
                row.step(actions, autoreset);
            }
        }
    };
    let Some(pool) = pool else { return work() };
    // The thread that asks works too, so that one thread less has to be woken.
    pool.in_place_scope(|scope| {
        (0..pool.current_num_threads()).for_each(|_| scope.spawn(|_| work()));
        work();
    });
}

/// As many as asked for, or one a core, or one a world where there are fewer.
fn threads_for(asked: usize, worlds: usize) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if asked == 0 { cores } else { asked }.min(worlds)
}

/// Threads beside the one that asks; none where it does all.
fn pool(threads: usize) -> PyResult<Option<ThreadPool>> {
    if threads < 2 {
        return Ok(None);
    }
    let pool =
        ThreadPoolBuilder::new().num_threads(threads - 1).thread_name(|i| format!("cohelm-{i}")).build();
    pool.map(Some).map_err(|error| Kind::Run.error(error))
}

/// Reads the word for one.
pub fn autoreset_of(word: &str) -> PyResult<Autoreset> {
    match word {
        "next-step" => Ok(Autoreset::NextStep),
        "same-step" => Ok(Autoreset::SameStep),
        "disabled" => Ok(Autoreset::Disabled),
        _ => {
            let message = format!("autoreset is \"next-step\", \"same-step\" or \"disabled\", got {word:?}");
            Err(Kind::Option.error(message))
        }
    }
}

/// Refuses a list that is not one a world.
pub fn expect_length(what: &str, came: usize, expected: usize) -> PyResult<()> {
    if came == expected {
        Ok(())
    } else {
        Err(Kind::Array.error(format!("expected {expected} {what}, one a world, got {came}")))
    }
}
