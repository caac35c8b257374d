//! Gymnasium's plain task as a plant: one goal, the pad in the middle, and Gymnasium's own state and reward.
//!
//! Flights from [`reset`](Plant::reset) are [`GymnasiumLander`]'s, bit for bit. Endings say more than Gymnasium does: a
//! craft that came to rest beside the flags ended [`Ending::Elsewhere`], though it is paid the same 100 points.
//!
//! ```
//! use cohelm::plant::Plant;
//! use cohelm_lander::gymnasium_plant::{GymnasiumPlant, GymnasiumTask};
//!
//! let mut lander = GymnasiumPlant::new(GymnasiumTask { enable_wind: true, ..GymnasiumTask::default() })?;
//! lander.reset(42);
//! assert_eq!((lander.view().state.len(), lander.view().goals.len()), (8, 1));
//! # Ok::<(), cohelm_lander::flags::OptionsError>(())
//! ```

use crate::craft::{Engines, WORLD_WIDTH};
use crate::flags::actions::gymnasium_action;
use crate::flags::layout::purpose;
use crate::flags::options::{in_range, read};
use crate::flags::state::{self, STATE_LENGTH};
use crate::flags::surface::Surface;
use crate::flags::{ActionSet, Burning, OptionsError, picture, starts, teacher};
use crate::gymnasium::{GymnasiumLander, GymnasiumOptions, Observation, TIME_LIMIT};
use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Ending, Goal, Mirror, Plant, Step, View};
use cohelm::random::Draws;
use cohelm::registry::{OfferedActions, PlantEntry};
use cohelm::scene::{Pose, Scene};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Changes whenever equal seeds and actions no longer give equal bits, or the state vector means something else.
pub const GYMNASIUM_LANDER_VERSION: u32 = 1;
/// The pad: where the hull is when the craft stands on it is the origin of Gymnasium's coordinates.
const PAD: Goal = Goal { id: 0, position: [0.0, 0.0] };
/// Half the distance of the two flags, world units.
const PAD_HALF_WIDTH: f64 = WORLD_WIDTH / 10.0;
/// The mirrored observation has component `.0` of the observation, times `.1`, at each place.
const MIRRORED: [(usize, f32); 8] =
    [(0, -1.0), (1, 1.0), (2, -1.0), (3, 1.0), (4, -1.0), (5, -1.0), (7, 1.0), (6, 1.0)];

/// How the task is flown: Gymnasium's options under Gymnasium's names. What is left out has Gymnasium's default.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GymnasiumTask {
    /// Two axes, main and side, instead of four commands.
    pub continuous: bool,
    /// Whether wind blows until a leg touches the ground.
    pub enable_wind: bool,
    /// Vertical acceleration, units/s², between −12 and 0.
    pub gravity: f64,
    /// Largest sideways force of the wind, 0 to 20 is usual.
    pub wind_power: f64,
    /// Largest torque of the wind, 0 to 2 is usual.
    pub turbulence_power: f64,
    /// Ticks after which the time is up, at most Gymnasium's 1000.
    pub limit: u32,
}

impl Default for GymnasiumTask {
    fn default() -> Self {
        let GymnasiumOptions { gravity, enable_wind, wind_power, turbulence_power } =
            GymnasiumOptions::default();
        Self { continuous: false, enable_wind, gravity, wind_power, turbulence_power, limit: TIME_LIMIT }
    }
}

impl GymnasiumTask {
    /// Reads them; whether they can be flown [`GymnasiumPlant::new`] says.
    pub fn from_json(value: &Value) -> Result<Self, OptionsError> {
        read(value)
    }

    fn actions(&self) -> ActionSet {
        if self.continuous { ActionSet::Continuous } else { ActionSet::Gymnasium }
    }
}

/// A flight of the plain task. A clone is a snapshot: it goes on with the same bits.
#[derive(Clone, Debug)]
pub struct GymnasiumPlant {
    task: GymnasiumTask,
    space: ActionSpace,
    lander: GymnasiumLander,
    engines: Engines,
    shown: Observation,
}

impl GymnasiumPlant {
    /// The flight of seed 0.
    pub fn new(task: GymnasiumTask) -> Result<Self, OptionsError> {
        in_range("limit", task.limit.into(), [1.0, TIME_LIMIT.into()], TIME_LIMIT.into())?;
        let GymnasiumTask { enable_wind, gravity, wind_power, turbulence_power, .. } = task;
        let options = GymnasiumOptions { gravity, enable_wind, wind_power, turbulence_power };
        let mut lander = GymnasiumLander::new(options)?;
        let shown = lander.reset(0);
        Ok(Self { task, space: task.actions().space(), lander, engines: Engines::OFF, shown })
    }

    /// A flight that somebody else flies, with what burnt in its last tick: for drawing it.
    pub fn of(lander: GymnasiumLander, burning: Engines) -> Self {
        let task = GymnasiumTask::default();
        let mut plant = Self {
            task,
            space: task.actions().space(),
            lander,
            engines: burning,
            shown: Observation::default(),
        };
        plant.shown = plant.lander.observation();
        plant
    }

    fn surface(&self) -> Surface {
        let heights = self.lander.heights();
        let spacing = WORLD_WIDTH / (heights.len() - 1) as f64;
        Surface::new(heights.iter().enumerate().map(|(i, &y)| [i as f64 * spacing, y]).collect())
    }

    fn pad(&self) -> [f64; 2] {
        let middle = WORLD_WIDTH / 2.0;
        [middle, self.surface().height_at(middle)]
    }

    fn is_at_the_pad(&self) -> bool {
        let from_the_middle = f64::from(self.lander.craft().hull().x) - WORLD_WIDTH / 2.0;
        from_the_middle.abs() <= PAD_HALF_WIDTH
    }
}

impl Plant for GymnasiumPlant {
    fn reset(&mut self, seed: u64) {
        self.shown = self.lander.reset(seed);
        self.engines = Engines::OFF;
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        let action = gymnasium_action(executed);
        let outcome = self.lander.step(action);
        self.engines = action.engines();
        self.shown = outcome.observation;
        let late = (self.lander.ticks() >= self.task.limit).then_some(Ending::TimeLimit);
        let ending = match outcome.ending.or(late) {
            Some(Ending::Goal) if !self.is_at_the_pad() => Some(Ending::Elsewhere),
            ending => ending,
        };
        Step { reward: outcome.reward, ending }
    }

    fn view(&self) -> View<'_> {
        View {
            tick: self.lander.ticks(),
            state: &self.shown,
            position: [self.shown[state::X], self.shown[state::Y]],
            switches: 0,
            goals: &[PAD],
        }
    }

    fn pilot_goal(&self) -> usize {
        0
    }

    fn space(&self) -> &ActionSpace {
        &self.space
    }

    fn limit_ticks(&self) -> Option<u32> {
        Some(self.task.limit)
    }

    fn scene(&self) -> Scene {
        picture::scene(&self.surface(), [picture::pad(PAD.id, self.pad(), PAD_HALF_WIDTH)].into_iter())
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        picture::craft_poses(self.lander.craft(), &self.engines, poses);
    }

    fn snapshot(&self) -> Option<Box<dyn Plant>> {
        Some(Box::new(self.clone()))
    }

    fn reset_near_goal(&mut self, seed: u64, difficulty: f64) -> bool {
        if difficulty.is_nan() {
            return false;
        }
        self.reset(seed);
        let mut draws = Draws::fork(seed, purpose::START);
        let start = starts::near_goal(self.pad(), &self.surface(), difficulty.clamp(0.0, 1.0), &mut draws);
        self.shown = self.lander.start_from(&start);
        true
    }

    fn mirror(&self) -> Option<Mirror> {
        let (commands, axes) = self.task.actions().mirrored();
        Some(Mirror { state: MIRRORED.to_vec(), position: [-1.0, 1.0], commands, axes })
    }

    fn teacher(&mut self, goal: usize) -> Option<Action> {
        let goal = (goal == 0).then_some([0.0, 0.0])?;
        let flags_state: [f64; STATE_LENGTH] = state::observe(self.lander.craft(), &self.engines);
        let wanted = teacher::wanted(&flags_state, goal);
        Some(self.task.actions().towards(wanted, Burning::of(&self.engines)))
    }
}

/// The plain task's entry in a registry, under the name `gymnasium-lander`.
pub fn entry() -> PlantEntry {
    PlantEntry {
        name: "gymnasium-lander",
        version: GYMNASIUM_LANDER_VERSION,
        summary: "Gymnasium's LunarLander-v3, bit for bit: one pad in the middle.",
        make: |options| {
            let plant = GymnasiumTask::from_json(options).and_then(GymnasiumPlant::new);
            plant.map(|plant| Box::new(plant) as _).map_err(|error| error.to_string())
        },
        values: None,
        skill: Some(crate::pilots::skill),
        actions: &[
            OfferedActions {
                name: "four",
                label: "nothing, left, main, right",
                option: "continuous",
                value: "false",
            },
            OfferedActions {
                name: "axes",
                label: "axes, stick or keys",
                option: "continuous",
                value: "true",
            },
        ],
        preset: "gymnasium",
    }
}
