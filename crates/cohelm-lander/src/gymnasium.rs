//! Gymnasium's LunarLander-v3 (1.4.0), bit for bit: the same seed and actions give the same observations and rewards.
//!
//! ```
//! use cohelm_lander::gymnasium::{Action, GymnasiumLander};
//!
//! let mut lander = GymnasiumLander::usual();
//! let mut observation = lander.reset(42);
//! let ending = loop {
//!     let falls = observation[3] < -0.2;
//!     let outcome = lander.step(if falls { Action::Main } else { Action::Nothing });
//!     observation = outcome.observation;
//!     if let Some(ending) = outcome.ending {
//!         break ending;
//!     }
//! };
//! println!("{} after {} ticks", ending.word(), lander.ticks());
//! ```

use cohelm::plant::Ending;

use crate::craft::{
    Controls, Craft, Dispersion, Engines, Ground, SCALE, Settings, Start, TICKS_PER_S, WORLD_HEIGHT,
    WORLD_WIDTH,
};
use crate::random::Generator;

/// Ticks after which Gymnasium's registration cuts an episode off.
pub const TIME_LIMIT: u32 = 1000;
/// Largest initial push in each direction.
const INITIAL_PUSH: f64 = 1000.0;
/// Height of the pad.
const PAD_Y: f64 = WORLD_HEIGHT / 4.0;
/// Height of the hull over the pad when y counts as 0.
const LEG_DOWN: f64 = 18.0 / SCALE;
/// Points that a tick of the main engine costs at full throttle.
const MAIN_ENGINE_COST: f64 = 0.30;
/// Points that a tick of a side engine costs at full throttle.
const SIDE_ENGINE_COST: f64 = 0.03;
/// Points of the last tick of a flight that came to rest; a crash or leaving the view costs as much.
const LAST_TICK_POINTS: f64 = 100.0;

/// What can be chosen when a lander is made; the default is `LunarLander-v3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GymnasiumOptions {
    /// Vertical acceleration, between −12 and 0 (both excluded); default −10.
    pub gravity: f64,
    /// Whether wind blows until a leg touches the ground; default not.
    pub enable_wind: bool,
    /// Largest sideways force of the wind, 0 to 20 is usual; default 15.
    pub wind_power: f64,
    /// Largest torque of the wind, 0 to 2 is usual; default 1.5.
    pub turbulence_power: f64,
}

impl Default for GymnasiumOptions {
    fn default() -> Self {
        GymnasiumOptions { gravity: -10.0, enable_wind: false, wind_power: 15.0, turbulence_power: 1.5 }
    }
}

/// Why options were refused.
#[derive(Clone, Copy, Debug, thiserror::Error, PartialEq)]
pub enum OptionError {
    /// Gymnasium refuses it too.
    #[error("gravity is {0}: it must be between -12 and 0, both excluded")]
    Gravity(f64),
    /// Not a finite number.
    #[error("{name} is {value}: it must be a finite number")]
    NotFinite {
        /// Which option.
        name: &'static str,
        /// What it was.
        value: f64,
    },
}

/// What the pilot does in a tick. Gymnasium's two action spaces mean the same engines, so both are accepted at any tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Discrete action 0.
    Nothing,
    /// Discrete action 1: the side engine that pushes to the left, full throttle.
    Left,
    /// Discrete action 2: main engine, full throttle.
    Main,
    /// Discrete action 3: the side engine that pushes to the right, full throttle.
    Right,
    /// Continuous action `[main, lateral]`, each clipped to [−1, 1]: main burns above 0 with half to full throttle, a side
    /// engine burns beyond ±0.5 (negative: to the left) with as much throttle. NaN burns nothing.
    Throttles([f32; 2]),
}

impl Action {
    /// Gymnasium's discrete action 0, 1, 2 or 3.
    pub const DISCRETE: [Action; 4] = [Action::Nothing, Action::Left, Action::Main, Action::Right];

    /// What it burns.
    pub fn engines(self) -> Engines {
        match self {
            Action::Nothing => Engines::OFF,
            Action::Left => Engines::LEFT,
            Action::Main => Engines::MAIN,
            Action::Right => Engines::RIGHT,
            Action::Throttles([main, lateral]) => {
                let (main, lateral) = (f64::from(main.clamp(-1.0, 1.0)), f64::from(lateral.clamp(-1.0, 1.0)));
                Engines {
                    main: if main > 0.0 { (main + 1.0) * 0.5 } else { 0.0 },
                    left: if lateral < -0.5 { -lateral } else { 0.0 },
                    right: if lateral > 0.5 { lateral } else { 0.0 },
                }
            }
        }
    }
}

/// x, y, vx, vy, angle, angular velocity (all scaled as in Gymnasium; the pad is at 0, 0), two leg contacts (0 or 1).
pub type Observation = [f32; 8];

/// What a tick brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The state after the tick.
    pub observation: Observation,
    /// Gymnasium's reward.
    pub reward: f64,
    /// [`Ending::Goal`] when the craft came to rest (anywhere, as in Gymnasium), [`Ending::Crash`], [`Ending::OutOfBounds`]
    /// or, as the only truncation, [`Ending::TimeLimit`].
    pub ending: Option<Ending>,
}

/// What a world does in one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// [`GymnasiumLander::step`].
    Step(Action),
    /// [`GymnasiumLander::reset`].
    Reset(u64),
    /// [`GymnasiumLander::restart`].
    Restart,
}

/// The environment. A clone is a snapshot.
#[derive(Clone, Debug, PartialEq)]
pub struct GymnasiumLander {
    options: GymnasiumOptions,
    random: Generator,
    heights: [f64; 11],
    craft: Craft,
    /// Positions in the patterns of wind and of turbulence; drawn only if there is wind.
    gusts: [i64; 2],
    shaping: f64,
    ticks: u32,
}

impl GymnasiumLander {
    /// With the episode of seed 0 begun.
    pub fn new(options: GymnasiumOptions) -> Result<GymnasiumLander, OptionError> {
        if !(options.gravity > -12.0 && options.gravity < 0.0) {
            return Err(OptionError::Gravity(options.gravity));
        }
        for (name, value) in
            [("wind_power", options.wind_power), ("turbulence_power", options.turbulence_power)]
        {
            if !value.is_finite() {
                return Err(OptionError::NotFinite { name, value });
            }
        }
        Ok(GymnasiumLander::begun(options))
    }

    /// `LunarLander-v3` as registered, with the episode of seed 0 begun.
    pub fn usual() -> GymnasiumLander {
        GymnasiumLander::begun(GymnasiumOptions::default())
    }

    /// With options that were checked.
    fn begun(options: GymnasiumOptions) -> GymnasiumLander {
        let heights = [0.0; 11];
        let mut lander = GymnasiumLander {
            options,
            random: Generator::new(0),
            heights,
            craft: Craft::place(&Ground::gymnasium(&heights), &Start::at(0.0, 0.0), Settings::EXACT),
            gusts: [0; 2],
            shaping: 0.0,
            ticks: 0,
        };
        lander.restart();
        lander
    }

    /// `reset(seed=seed)`: begins the episode that this seed fixes.
    pub fn reset(&mut self, seed: u64) -> Observation {
        self.obey(Order::Reset(seed)).observation
    }

    /// Begins the episode that these random numbers fix: what [`GymnasiumLander::random`] gave before another began it.
    pub fn restart_with(&mut self, random: Generator) -> Observation {
        self.random = random;
        self.restart()
    }

    /// `reset()`: begins another episode with the random numbers that follow.
    pub fn restart(&mut self) -> Observation {
        self.obey(Order::Restart).observation
    }

    /// Begins the episode again from a start of one's own, with the legs hanging; ground, wind and random numbers go on.
    /// Not in Gymnasium: for training that begins near the pad.
    pub fn start_from(&mut self, start: &Start) -> Observation {
        self.craft = Craft::place_hanging(&Ground::gymnasium(&self.heights), start, self.settings());
        self.steer(Engines::OFF);
        self.craft.coast();
        self.first().observation
    }

    /// `step(action)`. After an ending the world goes on as Gymnasium's does; call [`GymnasiumLander::reset`] instead.
    pub fn step(&mut self, action: Action) -> Outcome {
        self.obey(Order::Step(action))
    }

    /// A whole tick.
    fn obey(&mut self, order: Order) -> Outcome {
        self.begin_tick(order);
        self.craft.coast();
        self.end_tick(order)
    }

    /// The part of a tick before time passes.
    pub(crate) fn begin_tick(&mut self, order: Order) {
        match order {
            Order::Step(action) => return self.steer(action.engines()),
            Order::Reset(seed) => self.random = Generator::new(seed),
            Order::Restart => {}
        }
        self.place();
        self.steer(Engines::OFF);
    }

    /// The part of a tick after time has passed: what it brought.
    pub(crate) fn end_tick(&mut self, order: Order) -> Outcome {
        match order {
            Order::Step(action) => self.judge(action.engines()),
            Order::Reset(_) | Order::Restart => self.first(),
        }
    }

    /// The craft, for letting its time pass.
    #[cfg(feature = "lanes")]
    pub(crate) fn craft_mut(&mut self) -> &mut Craft {
        &mut self.craft
    }

    fn settings(&self) -> Settings {
        Settings { gravity: self.options.gravity, ..Settings::EXACT }
    }

    /// Draws a ground and a push, and puts a craft over it.
    fn place(&mut self) {
        self.heights = draw_heights(&mut self.random);
        let mut start = Start::at(WORLD_WIDTH / 2.0, WORLD_HEIGHT);
        start.push = std::array::from_fn(|_| self.random.uniform(-INITIAL_PUSH, INITIAL_PUSH));
        if self.options.enable_wind {
            self.gusts = std::array::from_fn(|_| self.random.integers(-9999, 9999));
        }
        self.craft = Craft::place(&Ground::gymnasium(&self.heights), &start, self.settings());
    }

    /// What a reset shows: Gymnasium lets one tick pass and begins to count after it.
    fn first(&mut self) -> Outcome {
        self.ticks = 0;
        let state = self.state();
        self.shaping = shaping(&state);
        Outcome { observation: observation(&state), reward: 0.0, ending: None }
    }

    /// Reward and ending of a tick in which these engines burned.
    fn judge(&mut self, engines: Engines) -> Outcome {
        self.ticks += 1;
        let state = self.state();
        let shaping = shaping(&state);
        let mut reward = shaping - self.shaping;
        self.shaping = shaping;
        reward -= engines.main * MAIN_ENGINE_COST;
        reward -= (engines.left + engines.right) * SIDE_ENGINE_COST;

        let out_of_bounds = state[0].abs() >= 1.0;
        let ending = if !self.craft.awake() {
            reward = LAST_TICK_POINTS;
            Some(Ending::Goal)
        } else if self.craft.hull_touched() || out_of_bounds {
            reward = -LAST_TICK_POINTS;
            Some(if self.craft.hull_touched() { Ending::Crash } else { Ending::OutOfBounds })
        } else {
            (self.ticks >= TIME_LIMIT).then_some(Ending::TimeLimit)
        };
        Outcome { observation: observation(&state), reward, ending }
    }

    /// What the last tick, or the reset, showed.
    pub fn observation(&self) -> Observation {
        observation(&self.state())
    }

    /// The random numbers that follow.
    pub fn random(&self) -> &Generator {
        &self.random
    }

    /// Ticks flown since the episode began.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Heights of the ground, evenly spaced from the left to the right border, world units.
    pub fn heights(&self) -> &[f64; 11] {
        &self.heights
    }

    /// The craft, for drawing it.
    pub fn craft(&self) -> &Craft {
        &self.craft
    }

    /// Draws the engines' scatter and lets engines and wind act.
    fn steer(&mut self, engines: Engines) {
        let [wind_force, wind_torque] = self.wind();
        let draws = std::array::from_fn(|_| self.random.uniform(-1.0, 1.0));
        let dispersion = Dispersion::from_uniform(draws);
        self.craft.steer(&Controls { engines, dispersion, wind_force, wind_torque });
    }

    /// Force and torque of this tick; the patterns stand still while a leg touches.
    fn wind(&mut self) -> [f64; 2] {
        if !self.options.enable_wind || self.craft.leg_contacts().contains(&true) {
            return [0.0; 2];
        }
        let powers = [self.options.wind_power, self.options.turbulence_power];
        let blow = [0, 1].map(|i| gust(self.gusts[i]) * powers[i]);
        self.gusts = self.gusts.map(|gust| gust + 1);
        blow
    }

    /// Gymnasium's state before it is rounded to f32.
    fn state(&self) -> [f64; 8] {
        let hull = self.craft.hull();
        let [first, second] = self.craft.leg_contacts().map(|touches| if touches { 1.0 } else { 0.0 });
        let (half_width, half_height) = (WORLD_WIDTH / 2.0, WORLD_HEIGHT / 2.0);
        let rate = TICKS_PER_S;
        [
            (f64::from(hull.x) - half_width) / half_width,
            (f64::from(hull.y) - (PAD_Y + LEG_DOWN)) / half_height,
            f64::from(hull.vx) * half_width / rate,
            f64::from(hull.vy) * half_height / rate,
            f64::from(hull.angle_rad),
            20.0 * f64::from(hull.omega_rad_s) / rate,
            first,
            second,
        ]
    }
}

/// Twelve random heights, the pad and its neighbours made level, then each smoothed with its neighbours.
fn draw_heights(random: &mut Generator) -> [f64; 11] {
    let mut raw: [f64; 12] = std::array::from_fn(|_| random.uniform(0.0, WORLD_HEIGHT / 2.0));
    raw[3..=7].fill(PAD_Y);
    std::array::from_fn(|i| 0.33 * (raw[(i + 11) % 12] + raw[i] + raw[i + 1]))
}

/// Share of the wind's power at this place of its pattern, which never repeats.
fn gust(place: i64) -> f64 {
    let place = place as f64;
    libm::tanh(libm::sin(0.02 * place) + libm::sin(std::f64::consts::PI * 0.01 * place))
}

/// What a state is worth: near, slow, upright, standing.
fn shaping(&[x, y, vx, vy, angle, _, first_leg, second_leg]: &[f64; 8]) -> f64 {
    -100.0 * (x * x + y * y).sqrt() - 100.0 * (vx * vx + vy * vy).sqrt() - 100.0 * angle.abs()
        + 10.0 * first_leg
        + 10.0 * second_leg
}

fn observation(state: &[f64; 8]) -> Observation {
    state.map(|value| value as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_that_gymnasium_refuses_or_cannot_compute_with_are_refused() {
        let usual = GymnasiumOptions::default();
        for gravity in [0.0, -12.0, f64::NAN] {
            let refused = GymnasiumLander::new(GymnasiumOptions { gravity, ..usual });
            assert!(matches!(refused, Err(OptionError::Gravity(_))), "{gravity}");
        }
        let refused = GymnasiumLander::new(GymnasiumOptions { wind_power: f64::INFINITY, ..usual });
        let error = OptionError::NotFinite { name: "wind_power", value: f64::INFINITY };
        assert_eq!(refused.err(), Some(error));
    }

    #[test]
    fn throttles_have_dead_zones_and_start_at_half_power() {
        let engines = |main, lateral| {
            let Engines { main, left, right } = Action::Throttles([main, lateral]).engines();
            [main, left, right]
        };
        assert_eq!(engines(0.0, 0.5), [0.0, 0.0, 0.0]);
        assert_eq!(engines(0.5, -0.75), [0.75, 0.75, 0.0]);
        assert_eq!(engines(2.0, 2.0), [1.0, 0.0, 1.0]);
        assert_eq!(engines(f32::NAN, f32::NAN), [0.0, 0.0, 0.0]);
    }

    #[test]
    fn the_time_limit_cuts_off_a_flight_that_hovers() {
        let mut lander = GymnasiumLander::usual();
        let mut observation = lander.reset(4);
        let ending = loop {
            let [_, y, vx, vy, angle, spin, ..] = observation;
            let lean = angle + 0.5 * spin - 0.5 * vx;
            let side = if lean > 0.05 {
                1.0
            } else if lean < -0.05 {
                -1.0
            } else {
                0.0
            };
            let main = if vy < 0.5 * (0.7 - y) { 1.0 } else { -1.0 };
            let outcome = lander.step(Action::Throttles([main, side]));
            observation = outcome.observation;
            if let Some(ending) = outcome.ending {
                break ending;
            }
        };
        assert_eq!((ending, lander.ticks()), (Ending::TimeLimit, TIME_LIMIT));
    }
}
