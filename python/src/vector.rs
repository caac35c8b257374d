//! Many of Gymnasium's landers at once: one call steps all of them, on all cores, into arrays that exist already.

use crate::errors::Kind;
use crate::lander::{continuous, discrete, options};
use cohelm::plant::Ending;
use cohelm_lander::gymnasium::{Action, GymnasiumLander, Observation};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Numbers of an observation.
const WIDTH: usize = 8;
/// Most worlds of one vector.
const MOST_WORLDS: usize = 1 << 20;

/// When a world whose episode ended begins the next one.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Autoreset {
    /// At the next step, which then carries no action out.
    NextStep,
    /// At once: the observation is the new episode's first, the last one is kept apart.
    SameStep,
    /// Never: whoever steps it resets it.
    Disabled,
}

/// One world of a vector, and what its last step brought.
struct Seat {
    world: GymnasiumLander,
    over: bool,
    observation: Observation,
    last: Observation,
    reward: f64,
    terminated: bool,
    truncated: bool,
}

impl Seat {
    fn reset(&mut self, seed: Option<u64>) {
        self.observation = match seed {
            Some(seed) => self.world.reset(seed),
            None => self.world.restart(),
        };
        (self.reward, self.terminated, self.truncated, self.over) = (0.0, false, false, false);
    }

    fn step(&mut self, action: Action, autoreset: Autoreset) {
        if self.over && autoreset == Autoreset::NextStep {
            return self.reset(None);
        }
        let outcome = self.world.step(action);
        self.observation = outcome.observation;
        self.reward = outcome.reward;
        self.terminated = outcome.ending.is_some_and(Ending::is_terminal);
        self.truncated = outcome.ending.is_some_and(|ending| !ending.is_terminal());
        self.over = outcome.ending.is_some();
        if self.over && autoreset == Autoreset::SameStep {
            self.last = self.observation;
            self.observation = self.world.restart();
        }
    }
}

/// Landers side by side. The arrays it returns are its own and are written anew by the next call.
#[pyclass(module = "cohelm")]
pub struct LanderVector {
    seats: Vec<Seat>,
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
        let nothing: Observation = [0.0; WIDTH];
        let seat = || Seat {
            world: world.clone(),
            over: false,
            observation: nothing,
            last: nothing,
            reward: 0.0,
            terminated: false,
            truncated: false,
        };
        Ok(Self {
            seats: std::iter::repeat_with(seat).take(worlds).collect(),
            pool: pool(threads, worlds)?,
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
        self.seats.len()
    }

    /// Begins the episodes of these seeds, or the next ones where a seed is None; where `mask` is given only those.
    #[pyo3(signature = (seeds=None, mask=None))]
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        seeds: Option<Vec<Option<u64>>>,
        mask: Option<PyReadonlyArray1<'_, bool>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let worlds = self.seats.len();
        let seeds = seeds.unwrap_or_else(|| vec![None; worlds]);
        expect_length("seeds", seeds.len(), worlds)?;
        if !self.begun && seeds.contains(&None) {
            return Err(Kind::Closed.error("the first reset needs a seed for every world"));
        }
        let mask = mask.map(|mask| mask.as_array().to_vec());
        if let Some(mask) = &mask {
            expect_length("mask", mask.len(), worlds)?;
        }
        for (index, (seat, seed)) in self.seats.iter_mut().zip(seeds).enumerate() {
            if mask.as_ref().is_none_or(|mask| mask[index]) {
                seat.reset(seed);
            }
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
        let Self { seats, actions, pool, autoreset, .. } = self;
        py.detach(|| step_all(seats, actions, pool.as_ref(), *autoreset));
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
        let worlds = self.seats.len();
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
        for (index, ((seat, row), last)) in self.seats.iter().zip(rows).zip(last_rows).enumerate() {
            row.copy_from_slice(&seat.observation);
            last.copy_from_slice(if self.autoreset == Autoreset::SameStep {
                &seat.last
            } else {
                &seat.observation
            });
            rewards[index] = seat.reward;
            terminated[index] = seat.terminated;
            truncated[index] = seat.truncated;
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

fn step_all(seats: &mut [Seat], actions: &[Action], pool: Option<&ThreadPool>, autoreset: Autoreset) {
    let Some(pool) = pool else {
        seats.iter_mut().zip(actions).for_each(|(seat, action)| seat.step(*action, autoreset));
        return;
    };
    // Pieces smaller than a core's share let a core whose worlds are in the air, and quick, help the others. The thread
    // that asks works too, so that one thread less has to be woken.
    let piece = seats.len().div_ceil(8 * (pool.current_num_threads() + 1)).max(1);
    let pieces: Vec<_> =
        seats.chunks_mut(piece).zip(actions.chunks(piece)).map(|one| Mutex::new(Some(one))).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some(piece) = pieces.get(next.fetch_add(1, Ordering::Relaxed)) {
            let taken = piece.lock().unwrap_or_else(PoisonError::into_inner).take();
            if let Some((seats, actions)) = taken {
                seats.iter_mut().zip(actions).for_each(|(seat, action)| seat.step(*action, autoreset));
            }
        }
    };
    pool.in_place_scope(|scope| {
        (0..pool.current_num_threads()).for_each(|_| scope.spawn(|_| work()));
        work();
    });
}

/// Threads beside the one that asks; none where it does all.
fn pool(threads: usize, worlds: usize) -> PyResult<Option<ThreadPool>> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { cores } else { threads }.min(worlds);
    if threads < 2 {
        return Ok(None);
    }
    let pool =
        ThreadPoolBuilder::new().num_threads(threads - 1).thread_name(|i| format!("cohelm-{i}")).build();
    pool.map(Some).map_err(|error| Kind::Run.error(error))
}

fn autoreset_of(word: &str) -> PyResult<Autoreset> {
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

fn expect_length(what: &str, came: usize, expected: usize) -> PyResult<()> {
    if came == expected {
        Ok(())
    } else {
        Err(Kind::Array.error(format!("expected {expected} {what}, one a world, got {came}")))
    }
}
