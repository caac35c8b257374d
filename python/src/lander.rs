//! Gymnasium's lander, one world.

use crate::errors::Kind;
use crate::picture::picture;
use cohelm::plant::Ending;
use cohelm_lander::craft::Engines;
use cohelm_lander::gymnasium::{Action, GymnasiumLander, GymnasiumOptions, Observation, Outcome};
use cohelm_lander::gymnasium_plant::GymnasiumPlant;
use cohelm_lander::random::Generator;
use numpy::{PyArray1, PyArray3, PyReadonlyArray1};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

/// Gymnasium's options, checked.
pub fn options(gravity: f64, wind: (bool, f64, f64)) -> PyResult<GymnasiumOptions> {
    let (enable_wind, wind_power, turbulence_power) = wind;
    let options = GymnasiumOptions { gravity, enable_wind, wind_power, turbulence_power };
    GymnasiumLander::new(options).map(|_| options).map_err(|error| Kind::Option.error(error))
}

/// A discrete action.
pub fn discrete(index: i64) -> PyResult<Action> {
    let action = usize::try_from(index).ok().and_then(|index| Action::DISCRETE.get(index));
    action.copied().ok_or_else(|| Kind::Action.error(format!("expected an action from 0 to 3, got {index}")))
}

/// A continuous action: two finite numbers, cut to [−1, 1] as Gymnasium cuts them.
pub fn continuous(throttles: &[f32]) -> PyResult<Action> {
    match *throttles {
        [main, lateral] if main.is_finite() && lateral.is_finite() => Ok(Action::Throttles([main, lateral])),
        _ => {
            Err(Kind::Action
                .error(format!("expected two finite throttles [main, lateral], got {throttles:?}")))
        }
    }
}

/// Gymnasium's LunarLander-v3, bit for bit. A copy, or a pickle, goes on with the same bits.
#[pyclass(module = "cohelm", from_py_object)]
#[derive(Clone)]
pub struct Lander {
    world: GymnasiumLander,
    options: GymnasiumOptions,
    is_continuous: bool,
    burning: Engines,
    begun: bool,
    /// From what the episode can be flown again: the random numbers before it, and its actions.
    born: Generator,
    actions: Vec<Action>,
}

/// A lander as it is pickled: nothing of the world, which the episode flown again brings back.
#[derive(Serialize, Deserialize)]
struct Pickled {
    continuous: bool,
    gravity: f64,
    wind: (bool, f64, f64),
    begun: bool,
    born: Generator,
    actions: Vec<Flown>,
}

/// An action as it is pickled.
#[derive(Serialize, Deserialize)]
enum Flown {
    /// The index of a discrete one.
    D(u8),
    /// Main and lateral throttle.
    C(f32, f32),
}

/// Observation, reward, and how the episode ended, if it did.
type Stepped<'py> = (Bound<'py, PyArray1<f32>>, f64, Option<&'static str>);

#[pymethods]
impl Lander {
    #[new]
    #[pyo3(signature = (*, continuous=false, gravity=-10.0, enable_wind=false, wind_power=15.0, turbulence_power=1.5))]
    fn new(
        continuous: bool,
        gravity: f64,
        enable_wind: bool,
        wind_power: f64,
        turbulence_power: f64,
    ) -> PyResult<Self> {
        let options = options(gravity, (enable_wind, wind_power, turbulence_power))?;
        let world = GymnasiumLander::new(options).map_err(|error| Kind::Option.error(error))?;
        let (is_continuous, burning, born) = (continuous, Engines::OFF, world.random().clone());
        Ok(Self { world, options, is_continuous, burning, begun: false, born, actions: Vec::new() })
    }

    /// Begins the episode that `seed` fixes; without one, another with the random numbers that follow.
    #[pyo3(signature = (seed=None))]
    fn reset<'py>(&mut self, py: Python<'py>, seed: Option<u64>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        if seed.is_none() && !self.begun {
            return Err(Kind::Closed.error("the first episode needs a seed: reset(seed=…)"));
        }
        let random = seed.map_or_else(|| self.world.random().clone(), Generator::new);
        Ok(array(py, &self.begin(random)))
    }

    /// One tick: observation (8 × float32), reward, and how the episode ended, if it did. The time limit of the
    /// registered environment is not its own, so it never ends by itself at tick 1000.
    fn step<'py>(&mut self, py: Python<'py>, action: &Bound<'py, PyAny>) -> PyResult<Stepped<'py>> {
        if !self.begun {
            return Err(Kind::Closed.error("no episode has begun: call reset(seed=…) first"));
        }
        let action = if self.is_continuous {
            let throttles: PyReadonlyArray1<'_, f32> = action.extract().map_err(|_| {
                Kind::Action.error("expected a float32 array of shape (2,): main and lateral throttle")
            })?;
            continuous(throttles.as_slice().map_err(|error| Kind::Action.error(error))?)?
        } else {
            discrete(action.extract().map_err(|_| {
                Kind::Action
                    .error("expected a whole number from 0 to 3; for throttles make Lander(continuous=True)")
            })?)?
        };
        let outcome = self.fly(action);
        let ending = outcome.ending.filter(|ending| *ending != Ending::TimeLimit).map(Ending::word);
        Ok((array(py, &outcome.observation), outcome.reward, ending))
    }

    /// Ticks flown since the episode began.
    #[getter]
    fn ticks(&self) -> u32 {
        self.world.ticks()
    }

    /// A copy that goes on with the same bits.
    fn snapshot(&self) -> Self {
        self.clone()
    }

    /// Goes back to a snapshot.
    fn restore(&mut self, snapshot: &Self) {
        self.clone_from(snapshot);
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let text = serde_json::to_string(&slf.borrow().pickled()).map_err(|error| Kind::Run.error(error))?;
        Ok((slf.get_type().getattr("_unpickled")?, (text,)))
    }

    /// The lander that was pickled as this text: its episode is flown again up to where it was.
    #[staticmethod]
    fn _unpickled(text: &str) -> PyResult<Self> {
        let wrong =
            |error: serde_json::Error| Kind::Option.error(format!("this is no pickled Lander: {error}"));
        let Pickled { continuous: is_continuous, gravity, wind, begun, born, actions } =
            serde_json::from_str(text).map_err(wrong)?;
        let mut lander = Self::new(is_continuous, gravity, wind.0, wind.1, wind.2)?;
        if begun {
            lander.begin(born);
        }
        for action in actions {
            lander.fly(match action {
                Flown::D(index) => discrete(index.into())?,
                Flown::C(main, lateral) => continuous(&[main, lateral])?,
            });
        }
        Ok(lander)
    }

    /// What it looks like: height × width × 3, uint8.
    #[pyo3(signature = (width=600, height=400))]
    fn render<'py>(&self, py: Python<'py>, width: u32, height: u32) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let plant = GymnasiumPlant::of(self.world.clone(), self.burning);
        picture(py, &plant, [width, height])
    }
}

impl Lander {
    fn begin(&mut self, random: Generator) -> Observation {
        (self.begun, self.burning) = (true, Engines::OFF);
        self.actions.clear();
        self.born = random.clone();
        self.world.restart_with(random)
    }

    fn fly(&mut self, action: Action) -> Outcome {
        self.burning = action.engines();
        self.actions.push(action);
        self.world.step(action)
    }

    fn pickled(&self) -> Pickled {
        let GymnasiumOptions { gravity, enable_wind, wind_power, turbulence_power } = self.options;
        let flown = |action: &Action| match *action {
            Action::Throttles([main, lateral]) => Flown::C(main, lateral),
            action => Flown::D(Action::DISCRETE.iter().position(|known| *known == action).unwrap_or(0) as u8),
        };
        Pickled {
            continuous: self.is_continuous,
            gravity,
            wind: (enable_wind, wind_power, turbulence_power),
            begun: self.begun,
            born: self.born.clone(),
            actions: self.actions.iter().map(flown).collect(),
        }
    }
}

fn array<'py>(py: Python<'py>, observation: &Observation) -> Bound<'py, PyArray1<f32>> {
    PyArray1::from_slice(py, observation)
}
