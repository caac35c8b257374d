//! Worlds of any plant side by side, each with a co-pilot of its own or with none: one call steps all of them, on all
//! cores, into arrays that exist already.

use crate::action::Actions;
use crate::errors::Kind;
use crate::vector::{Autoreset, autoreset_of, expect_length};
use crate::world::{Help, Relay, plants};
use cohelm::action::{Action, ActionSpace};
use cohelm::cockpit::{Cockpit, Intervention};
use cohelm::plant::{Ending, Plant};
use cohelm::registry::Task;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use sync_wrapper::SyncWrapper;

/// Most worlds of one vector.
const MOST_WORLDS: usize = 1 << 16;

/// One world of a vector, and what its last step brought.
struct Seat {
    plant: Box<dyn Plant>,
    cockpit: Option<Cockpit>,
    over: bool,
    restarted: bool,
    observation: Vec<f32>,
    last: Vec<f32>,
    reward: f64,
    ending: Option<Ending>,
    told: Record,
}

/// What of a tick's record goes into arrays.
#[derive(Clone, Copy, Default)]
struct Record {
    asked: Option<Action>,
    executed: Option<Action>,
    goal: usize,
    confidence: f32,
    intervention: Intervention,
}

/// What is the same for all worlds of a vector.
struct Rules {
    help: Option<Help>,
    autoreset: Autoreset,
    goal_visible: bool,
}

impl Seat {
    fn new(plant: Box<dyn Plant>) -> Self {
        Self {
            plant,
            cockpit: None,
            over: false,
            restarted: false,
            observation: Vec::new(),
            last: Vec::new(),
            reward: 0.0,
            ending: None,
            told: Record::default(),
        }
    }

    fn begin(&mut self, seed: u64, rules: &Rules) -> PyResult<()> {
        self.plant.reset(seed);
        if let Some(help) = &rules.help {
            let mut cockpit = help.cockpit(self.plant.as_ref())?;
            cockpit.begin();
            self.cockpit = Some(cockpit);
        }
        (self.reward, self.ending, self.over, self.restarted) = (0.0, None, false, true);
        self.told = Record::default();
        self.observe(rules);
        Ok(())
    }

    fn step(&mut self, asked: Option<Action>, seed: u64, rules: &Rules) -> PyResult<()> {
        if self.over && rules.autoreset == Autoreset::NextStep {
            return self.begin(seed, rules);
        }
        self.restarted = false;
        let step = match &mut self.cockpit {
            None => {
                self.told = Record { asked, executed: asked, ..Record::default() };
                self.plant.step(asked)
            }
            Some(cockpit) => {
                let tick = cockpit.tick(self.plant.as_mut(), &mut Relay(asked));
                self.told = Record {
                    asked,
                    executed: tick.executed,
                    goal: tick.belief.goal,
                    confidence: tick.belief.confidence,
                    intervention: tick.intervention.unwrap_or_default(),
                };
                tick.step
            }
        };
        (self.reward, self.ending, self.over) = (step.reward, step.ending, step.ending.is_some());
        self.observe(rules);
        if self.over && rules.autoreset == Autoreset::SameStep {
            std::mem::swap(&mut self.last, &mut self.observation);
            self.begin_behind(seed, rules)?;
        }
        Ok(())
    }

    /// Begins the next episode, while reward, ending and stages are still those of the one that is over.
    fn begin_behind(&mut self, seed: u64, rules: &Rules) -> PyResult<()> {
        let (reward, ending, told) = (self.reward, self.ending, self.told);
        self.begin(seed, rules)?;
        (self.reward, self.ending, self.told) = (reward, ending, told);
        Ok(())
    }

    /// State, every goal relative to the plant, and where it may be seen which is the pilot's own.
    fn observe(&mut self, rules: &Rules) {
        let view = self.plant.view();
        self.observation.clear();
        self.observation.extend_from_slice(view.state);
        for goal in view.goals {
            let [x, y] = view.position;
            self.observation.extend([goal.position[0] - x, goal.position[1] - y]);
        }
        if rules.goal_visible {
            let own = self.plant.pilot_goal();
            self.observation.extend((0..view.goals.len()).map(|goal| f32::from(u8::from(goal == own))));
        }
    }
}

/// Worlds of a plant side by side. The arrays it returns are its own and are written anew by the next call.
#[pyclass(module = "cohelm")]
pub struct PlantVector {
    /// (Only ever borrowed exclusively, so it needs no lock.)
    seats: SyncWrapper<Vec<Seat>>,
    rules: Rules,
    space: ActionSpace,
    pool: Option<ThreadPool>,
    actions: Vec<Option<Action>>,
    width: usize,
    begun: bool,
    arrays: Arrays,
}

struct Arrays {
    observations: Py<PyArray2<f32>>,
    last: Py<PyArray2<f32>>,
    rewards: Py<PyArray1<f64>>,
    terminated: Py<PyArray1<bool>>,
    truncated: Py<PyArray1<bool>>,
    restarted: Py<PyArray1<bool>>,
}

type Stepped<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<bool>>,
);

#[pymethods]
impl PlantVector {
    /// `help` is a world with the co-pilot that each world is to have, or with none; nothing else of it is used.
    #[new]
    #[pyo3(signature = (help, worlds, *, goal_visible=true, autoreset="next-step", threads=0))]
    fn new(
        py: Python<'_>,
        help: &crate::world::World,
        worlds: usize,
        goal_visible: bool,
        autoreset: &str,
        threads: usize,
    ) -> PyResult<Self> {
        if !(1..=MOST_WORLDS).contains(&worlds) {
            return Err(Kind::Option.error(format!("expected 1 to {MOST_WORLDS} worlds, got {worlds}")));
        }
        let (task, help) = help.recipe(py);
        let make = |task: &Task| plants().make(task).map_err(|error| Kind::Option.error(error));
        let rules = Rules { help, autoreset: autoreset_of(autoreset)?, goal_visible };
        let mut seats: Vec<Seat> =
            (0..worlds).map(|_| make(&task).map(Seat::new)).collect::<PyResult<_>>()?;
        seats[0].observe(&rules);
        let (width, space) = (seats[0].observation.len(), seats[0].plant.space().clone());
        seats.iter_mut().for_each(|seat| seat.last.resize(width, 0.0));
        Ok(Self {
            seats: SyncWrapper::new(seats),
            rules,
            space,
            pool: pool(threads, worlds)?,
            actions: vec![None; worlds],
            width,
            begun: false,
            arrays: Arrays::new(py, worlds, width),
        })
    }

    /// How many worlds.
    #[getter]
    fn worlds(&self) -> usize {
        self.actions.len()
    }

    /// Numbers of one observation.
    #[getter]
    fn width(&self) -> usize {
        self.width
    }

    /// Begins the episodes of these seeds; a world whose seed is None goes on.
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        seeds: Vec<Option<u64>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        expect_length("seeds", seeds.len(), self.actions.len())?;
        if !self.begun && seeds.contains(&None) {
            return Err(Kind::Closed.error("the first reset needs a seed for every world"));
        }
        for (seat, seed) in self.seats.get_mut().iter_mut().zip(seeds) {
            seat.restarted = false;
            if let Some(seed) = seed {
                seat.begin(seed, &self.rules)?;
            }
        }
        self.begun = true;
        self.write(py)?;
        Ok(self.arrays.observations.bind(py).clone())
    }

    /// One tick of every world: observations, rewards, terminated, truncated, the last observations of the episodes that
    /// ended in this step (with autoreset "same-step"), and which worlds began the episode of their seed.
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        actions: &Bound<'py, PyAny>,
        seeds: PyReadonlyArray1<'py, u64>,
    ) -> PyResult<Stepped<'py>> {
        let worlds = self.actions.len();
        if !self.begun {
            return Err(Kind::Closed.error("no episode has begun: call reset first"));
        }
        Actions { space: &self.space, worlds }.read(actions, &mut self.actions)?;
        let seeds = seeds.as_array().to_vec();
        expect_length("seeds", seeds.len(), worlds)?;
        let (seats, rules) = (self.seats.get_mut(), &self.rules);
        if rules.autoreset == Autoreset::Disabled
            && let Some(over) = seats.iter().position(|seat| seat.over)
        {
            let message =
                format!("the episode of world {over} is over: reset it (options={{'reset_mask': …}})");
            return Err(Kind::Closed.error(message));
        }
        let (asked, pool) = (&self.actions, self.pool.as_ref());
        py.detach(|| step_all(seats, asked, &seeds, rules, pool))?;
        self.write(py)?;
        let Arrays { observations, last, rewards, terminated, truncated, restarted } = &self.arrays;
        Ok((
            observations.bind(py).clone(),
            rewards.bind(py).clone(),
            terminated.bind(py).clone(),
            truncated.bind(py).clone(),
            last.bind(py).clone(),
            restarted.bind(py).clone(),
        ))
    }

    /// The stages of the last tick in every world, as new arrays: `asked` and `executed`, and with a co-pilot `goal`,
    /// `confidence`, `intervened` and `opposed`. Nothing is −1, and NaN among axes. A world that has begun an episode and not
    /// flown yet has nothing to tell; with autoreset "same-step" they are those of the tick that ended the episode before.
    fn stages<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let told: Vec<Record> = self.seats.get_mut().iter().map(|seat| seat.told).collect();
        let stages = PyDict::new(py);
        let space = &self.space;
        let actions = |choose: fn(&Record) -> Option<Action>| {
            crate::action::to_array(py, space, told.iter().map(choose).collect())
        };
        stages.set_item("asked", actions(|told| told.asked)?)?;
        stages.set_item("executed", actions(|told| told.executed)?)?;
        if self.rules.help.is_some() {
            let goals = told.iter().map(|told| told.goal as i64).collect();
            stages.set_item("goal", PyArray1::from_vec(py, goals))?;
            let confidence = told.iter().map(|told| told.confidence).collect();
            stages.set_item("confidence", PyArray1::from_vec(py, confidence))?;
            let truths =
                |choose: fn(&Record) -> bool| PyArray1::from_vec(py, told.iter().map(choose).collect());
            stages.set_item("intervened", truths(|told| told.intervention.effective))?;
            stages.set_item("opposed", truths(|told| told.intervention.opposed))?;
        }
        Ok(stages)
    }

    /// How the episode of each world ended in the last step; None where it goes on.
    fn endings(&mut self) -> Vec<Option<&'static str>> {
        self.seats.get_mut().iter().map(|seat| seat.ending.map(Ending::word)).collect()
    }

    /// Index of the pilot's own goal in every world.
    fn pilot_goals<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let goals = self.seats.get_mut().iter().map(|seat| seat.plant.pilot_goal() as i64).collect();
        PyArray1::from_vec(py, goals)
    }
}

impl PlantVector {
    fn write(&mut self, py: Python<'_>) -> PyResult<()> {
        if self.seats.get_mut().iter().any(|seat| seat.observation.len() != self.width) {
            let why = "the number of goals changed in mid-episode, and with it the size of an observation";
            return Err(Kind::Array.error(format!("{why}: fly such a task with cohelm.World")));
        }
        let busy = |error: numpy::BorrowError| Kind::Array.error(format!("the arrays are in use: {error}"));
        let odd = |error: numpy::AsSliceError| Kind::Array.error(error);
        let arrays = &self.arrays;
        let mut observations = arrays.observations.bind(py).try_readwrite().map_err(busy)?;
        let mut last = arrays.last.bind(py).try_readwrite().map_err(busy)?;
        let mut rewards = arrays.rewards.bind(py).try_readwrite().map_err(busy)?;
        let mut truths = [&arrays.terminated, &arrays.truncated, &arrays.restarted]
            .map(|array| array.bind(py).try_readwrite().map_err(busy));
        let [Ok(terminated), Ok(truncated), Ok(restarted)] = &mut truths else {
            return Err(Kind::Array.error("the arrays are in use"));
        };
        let rows = observations.as_slice_mut().map_err(odd)?.chunks_exact_mut(self.width);
        let last_rows = last.as_slice_mut().map_err(odd)?.chunks_exact_mut(self.width);
        let rewards = rewards.as_slice_mut().map_err(odd)?;
        let terminated = terminated.as_slice_mut().map_err(odd)?;
        let truncated = truncated.as_slice_mut().map_err(odd)?;
        let restarted = restarted.as_slice_mut().map_err(odd)?;
        for (index, ((seat, row), last)) in self.seats.get_mut().iter().zip(rows).zip(last_rows).enumerate() {
            row.copy_from_slice(&seat.observation);
            last.copy_from_slice(&seat.last);
            rewards[index] = seat.reward;
            terminated[index] = seat.ending.is_some_and(Ending::is_terminal);
            truncated[index] = seat.ending.is_some_and(|ending| !ending.is_terminal());
            restarted[index] = seat.restarted;
        }
        Ok(())
    }
}

impl Arrays {
    fn new(py: Python<'_>, worlds: usize, width: usize) -> Self {
        let table = || PyArray2::zeros(py, [worlds, width], false).unbind();
        let truths = || PyArray1::from_vec(py, vec![false; worlds]).unbind();
        Self {
            observations: table(),
            last: table(),
            rewards: PyArray1::zeros(py, worlds, false).unbind(),
            terminated: truths(),
            truncated: truths(),
            restarted: truths(),
        }
    }
}

fn step_all(
    seats: &mut [Seat],
    asked: &[Option<Action>],
    seeds: &[u64],
    rules: &Rules,
    pool: Option<&ThreadPool>,
) -> PyResult<()> {
    match pool {
        None => seats
            .iter_mut()
            .zip(asked.iter().zip(seeds))
            .try_for_each(|(seat, (asked, seed))| seat.step(*asked, *seed, rules)),
        Some(pool) => pool.install(|| {
            seats
                .par_iter_mut()
                .zip(asked.par_iter().zip(seeds))
                .try_for_each(|(seat, (asked, seed))| seat.step(*asked, *seed, rules))
        }),
    }
}

/// Threads that step; none where the one that asks does it all.
fn pool(threads: usize, worlds: usize) -> PyResult<Option<ThreadPool>> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { cores } else { threads }.min(worlds);
    if threads < 2 {
        return Ok(None);
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).thread_name(|i| format!("cohelm-{i}")).build();
    pool.map(Some).map_err(|error| Kind::Run.error(error))
}
