//! Every option of value training, with its reason and what too low and too high do.
//!
//! The presets differ in nothing but these options. [`ValueOptions::paper`] is Algorithm 1 as printed, repaired only
//! where it must be; [`ValueOptions::default`] adds what it needed to land. `docs/training.md` numbers the departures.

use crate::job::LearnError;
use cohelm::action::ActionSpace;
use cohelm::registry::PlantEntry;
use serde::{Deserialize, Serialize};

/// Options of [`train_values`](crate::train_values).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ValueOptions {
    /// Environment steps altogether. Fewer than 120 k: landings are still rough; more costs time and gains little.
    pub steps: u64,
    /// Worlds flown side by side. One: neighbouring transitions are much alike when learning begins; many: each sees
    /// few episodes.
    pub worlds: usize,
    /// Longest episode in training, in steps; the plant's own limit may be shorter. Running into it is a truncation,
    /// beyond which values go on. High: a robot that hovers fills the replay memory with hovering.
    pub episode_cap: u32,
    /// Widths of the hidden layers.
    pub hidden: Vec<usize>,
    /// Dueling head (Wang et al. 2016): state value and advantages apart. At 50 decisions a second one action matters
    /// little beside the state; apart, the little is learnt sooner.
    pub dueling: bool,
    /// One output for everything that changes nothing, one for each switch to toggle. Off: as many outputs as commands,
    /// whose ties are broken by noise. Only spaces of switches differ.
    pub effective_outputs: bool,
    /// The values take the asked command as input too (a sentence of Section III-B). Needs pilots to ask.
    pub sees_asked: bool,
    /// Discount γ a step. 0.99 forgets the landing 5 s ahead (0.99²⁵⁰ = 0.08) and hovering looks as good.
    pub discount: f32,
    /// Factor on the plant's rewards. Values should come out near 1: the step of the Huber loss and of Adam are of
    /// that size.
    pub reward_scale: f32,
    /// Choosing the next action with the online network and valuing it with the target network (Algorithm 1 does).
    /// Off: values come out too high.
    pub double: bool,
    /// Steps n over which rewards are summed before bootstrapping. 1: rewards travel back a step an update; 10 and
    /// more: the past behaviour's mistakes are learnt as if they were necessary.
    pub n_step: usize,
    /// Advantage learning (Bellemare et al. 2016): y −= α(max Q⁻(s) − Q⁻(s, a)). Widens the gaps between actions, at 50
    /// decisions a second hardly larger than the errors, by 1/(1 − α). 0: off.
    pub advantage: f32,
    /// Huber loss with this bound on the error's gradient; 0 for the squared loss. Without it one crash outweighs many
    /// small corrections.
    pub huber: f32,
    /// Adam's learning rate at the beginning and at the end, linear between.
    pub learning_rate: [f32; 2],
    /// Transitions in an update.
    pub batch: usize,
    /// Transitions remembered; the oldest are forgotten first.
    pub memory: usize,
    /// How the target network follows.
    pub target: Target,
    /// The weights that are kept follow those that learn at this rate an update (Polyak averaging): they differ less
    /// from one moment to the next, and a flight is not spoilt by the last batch. 1: they are the same.
    pub average: f32,
    /// Updates at an episode's end: K of Algorithm 1.
    pub updates: Updates,
    /// Updates whose targets are prepared together while the ones before are done, so that two threads share the work;
    /// the targets come from weights up to two such blocks old. 0: each from the newest weights, on one thread. A block
    /// should be short beside the 1/rate updates in which the target network follows.
    pub ahead: u64,
    /// Steps before the first update.
    pub warm_up: u64,
    /// Mirrors every second transition with the plant's symmetry, if it has one: each flight teaches two.
    pub mirror: bool,
    /// How often a random command is carried out.
    pub exploration: Exploration,
    /// Starts near the goal that widen as they succeed, if the plant can; `None` for ordinary starts only.
    pub near_goal: Option<NearGoal>,
    /// Share of the worlds in which the plant's teacher acts instead of the network, for plants that have one.
    pub teacher: f64,
    /// Share of the worlds in which a simulated pilot asks.
    pub pilots: f64,
    /// Where a pilot asks, Eq. 4 chooses what is carried out, as Algorithm 1 has it; the goal is known and c is 0.6, the
    /// mean that the paper's confidence has. Off: the robot flies and only hears what is asked.
    pub pilots_steer: bool,
    /// Fresh episodes by which checkpoints of the second half are compared; the best is kept.
    pub validation_episodes: usize,
    /// Checkpoints compared.
    pub validations: u32,
}

/// How the target network follows the online one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Target {
    /// target += rate · (online − target) at every update: no jumps. Too high follows its own errors, too low is old.
    Follow(f32),
    /// target = online every so many steps, as Algorithm 1 has it.
    CopyEvery(u64),
}

/// Updates at an episode's end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Updates {
    /// As many a step of the episode: long and short episodes are learnt from alike.
    PerStep(f64),
    /// As many an episode, however long: K as printed.
    PerEpisode(f64),
}

/// How often a random command is carried out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exploration {
    /// Probability at the beginning.
    pub first: f64,
    /// Probability once `steps` are over.
    pub then: f64,
    /// Steps over which it falls, linearly.
    pub steps: u64,
    /// Probability in the last part of the run: a robot that never acts cleanly learns what it costs to be disturbed.
    pub last: f64,
    /// Where the last part begins, as a share of the run.
    pub last_from: f64,
}

/// Starts near the goal (a reverse curriculum): from "at the goal already" outwards, as far as they succeed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NearGoal {
    /// Largest difficulty at the beginning.
    pub first: f64,
    /// Factor on the step by which it grows: step = growth · max(1, difficulty / 0.25).
    pub growth: f64,
    /// Share of successes that lets it grow. Low: hurries past what is not learnt; high: waits for luck.
    pub promote_at: f64,
    /// Episodes over which that share is taken, of those whose difficulty was in the upper half.
    pub episodes: usize,
    /// Share of ordinary starts while it grows. 0: the robot does not know them when they come.
    pub ordinary: f64,
    /// Share of ordinary starts once it has grown to 1.
    pub ordinary_at_last: f64,
}

impl Default for ValueOptions {
    fn default() -> Self {
        Self {
            steps: 200_000,
            worlds: 16,
            episode_cap: 600,
            hidden: vec![64, 64],
            dueling: true,
            effective_outputs: true,
            sees_asked: false,
            discount: 0.995,
            reward_scale: 1.0,
            double: true,
            n_step: 5,
            advantage: 0.8,
            huber: 1.0,
            learning_rate: [1e-3, 5e-5],
            batch: 128,
            memory: 400_000,
            target: Target::Follow(0.005),
            average: 5e-4,
            updates: Updates::PerStep(0.5),
            ahead: 16,
            warm_up: 5_000,
            mirror: true,
            exploration: Exploration { first: 1.0, then: 0.05, steps: 20_000, last: 0.02, last_from: 0.7 },
            near_goal: Some(NearGoal {
                first: 0.05,
                growth: 0.1,
                promote_at: 0.6,
                episodes: 30,
                ordinary: 0.1,
                ordinary_at_last: 0.7,
            }),
            teacher: 0.0,
            pilots: 0.0,
            pilots_steer: true,
            validation_episodes: 200,
            validations: 5,
        }
    }
}

/// Names of the presets.
pub const PRESETS: [&str; 5] = ["default", "axes", "paper", "sees-asked", "gymnasium"];

impl ValueOptions {
    /// The preset of a name.
    pub fn preset(name: &str) -> Result<Self, LearnError> {
        match name {
            "default" => Ok(Self::default()),
            "axes" => Ok(Self::axes()),
            "paper" => Ok(Self::paper()),
            "sees-asked" => Ok(Self::seeing_what_is_asked()),
            "gymnasium" => Ok(Self::gymnasium()),
            _ => Err(LearnError::Option {
                option: "preset",
                reason: format!("there is none called {name:?}; there are: {}", PRESETS.join(", ")),
            }),
        }
    }

    /// The preset for a plant and its actions unless another is named: the plant's own, or `axes` where that is `default`
    /// and the actions are on axes.
    pub fn usual_preset(entry: &PlantEntry, space: &ActionSpace) -> &'static str {
        match space {
            ActionSpace::Axes { .. } if entry.preset == "default" => "axes",
            _ => entry.preset,
        }
    }

    /// What a model's card calls values that were trained with a preset; `None` for the usual ones of a plant.
    pub fn variant<'a>(preset: &'a str, entry: &PlantEntry) -> Option<&'a str> {
        (preset != entry.preset && !["default", "axes"].contains(&preset)).then_some(preset)
    }

    /// The default for actions on axes. A critic learns them at half the rate: at the rate of commands it forgets again and
    /// again, and its landings go up and down until the end. The gaps between actions are widened less: at 0.8 what is
    /// seldom tried drifts, and on some seeds the values run away. And it flies half as long again, which the slower rate asks
    /// for.
    pub fn axes() -> Self {
        Self { learning_rate: [5e-4, 2e-5], advantage: 0.5, steps: 300_000, ..Self::default() }
    }

    /// The default for values that take the human command as input: pilots ask in every world, the robot flies and
    /// hears them. What is asked then says nothing about what the robot's command will bring, since nobody carries it
    /// out; it is there because the paper says so.
    pub fn seeing_what_is_asked() -> Self {
        Self { sees_asked: true, pilots: 1.0, pilots_steer: false, ..Self::default() }
    }

    /// The default for plants whose rewards are of the size of Gymnasium's, some hundreds an episode.
    pub fn gymnasium() -> Self {
        Self { reward_scale: 0.01, ..Self::default() }
    }

    /// Algorithm 1 as printed, repaired only where it must be: commands are explored at random (as printed nothing
    /// explores), and nothing follows a terminal state.
    pub fn paper() -> Self {
        Self {
            episode_cap: u32::MAX,
            dueling: false,
            effective_outputs: false,
            discount: 0.99,
            n_step: 1,
            advantage: 0.0,
            huber: 0.0,
            learning_rate: [5e-4, 5e-4],
            target: Target::CopyEvery(2_000),
            average: 1.0,
            updates: Updates::PerEpisode(100.0),
            ahead: 0,
            mirror: false,
            near_goal: None,
            pilots: 1.0,
            ..Self::default()
        }
    }

    /// Refuses what contradicts itself; `pilots` tells whether there are any.
    pub(crate) fn check(&self, pilots: bool) -> Result<(), LearnError> {
        let wrong = |option, reason: &str| Err(LearnError::Option { option, reason: reason.into() });
        self.check_ranges()?;
        if self.worlds == 0 || self.batch == 0 || self.n_step == 0 || self.memory == 0 {
            return wrong("worlds, batch, n_step, memory", "each must be at least 1");
        }
        if self.validations == 0 || self.validation_episodes == 0 {
            return wrong(
                "validations, validation_episodes",
                "each must be at least 1: one checkpoint is chosen",
            );
        }
        if !(0.0..1.0).contains(&self.advantage) {
            return wrong("advantage", "must lie in [0, 1); try 0.8, or 0 for off");
        }
        if self.pilots > 0.0 && !pilots {
            return wrong("pilots", "this plant has no simulated pilots here; set it to 0");
        }
        if self.sees_asked && self.pilots == 0.0 {
            return wrong("sees_asked", "nobody asks: set pilots to a share of the worlds, such as 1");
        }
        Ok(())
    }
    /// Refuses numbers that cannot be, each by its own range.
    fn check_ranges(&self) -> Result<(), LearnError> {
        let wrong = |option, reason: &str| Err(LearnError::Option { option, reason: reason.into() });
        if self.steps == 0 || self.episode_cap == 0 || self.hidden.is_empty() || self.hidden.contains(&0) {
            return wrong("steps, episode_cap, hidden", "each must be at least 1");
        }
        if !(self.discount > 0.0 && self.discount <= 1.0) {
            return wrong("discount", "must lie in (0, 1]; usual: 0.99 to 0.999");
        }
        if !(self.average > 0.0 && self.average <= 1.0) {
            return wrong("average", "must lie in (0, 1]; 1 keeps the weights that learn");
        }
        let positive = |number: f32| number.is_finite() && number > 0.0;
        if !(positive(self.reward_scale) && self.learning_rate.into_iter().all(positive)) {
            return wrong("reward_scale, learning_rate", "each must be a positive number");
        }
        if !(self.huber.is_finite() && self.huber >= 0.0) {
            return wrong("huber", "must be at least 0; 0 for the squared loss");
        }
        let share = |share: f64| (0.0..=1.0).contains(&share);
        if !(share(self.teacher) && share(self.pilots)) {
            return wrong("teacher, pilots", "each must be a share of the worlds, from 0 to 1");
        }
        self.check_parts()
    }

    /// The same for the options that have parts.
    fn check_parts(&self) -> Result<(), LearnError> {
        let wrong = |option, reason: &str| Err(LearnError::Option { option, reason: reason.into() });
        let share = |share: f64| (0.0..=1.0).contains(&share);
        let Exploration { first, then, last, last_from, .. } = self.exploration;
        if ![first, then, last, last_from].into_iter().all(share) {
            return wrong("exploration", "first, then, last and last_from must lie in [0, 1]");
        }
        match self.target {
            Target::Follow(rate) if !(rate > 0.0 && rate <= 1.0) => {
                return wrong("target", "must follow at a rate in (0, 1]; usual: 0.001 to 0.01");
            }
            Target::CopyEvery(0) => return wrong("target", "must be copied every 1 or more steps"),
            _ => {}
        }
        let (Updates::PerStep(updates) | Updates::PerEpisode(updates)) = self.updates;
        if !(updates.is_finite() && updates > 0.0) {
            return wrong("updates", "must be a positive number a step or an episode");
        }
        match self.near_goal {
            Some(near) if !(near.first > 0.0 && near.growth > 0.0 && near.episodes > 0) => {
                wrong("near_goal", "first, growth and episodes must be more than 0; null for ordinary starts")
            }
            Some(near) if ![near.promote_at, near.ordinary, near.ordinary_at_last].into_iter().all(share) => {
                wrong("near_goal", "promote_at, ordinary and ordinary_at_last must lie in [0, 1]")
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_possible() {
        for name in PRESETS {
            ValueOptions::preset(name).unwrap().check(true).unwrap();
        }
    }

    #[test]
    fn numbers_that_cannot_be_are_refused_by_the_name_of_their_option() {
        let usual = ValueOptions::default;
        for (option, impossible) in [
            ("steps", ValueOptions { steps: 0, ..usual() }),
            ("episode_cap", ValueOptions { episode_cap: 0, ..usual() }),
            ("hidden", ValueOptions { hidden: vec![64, 0], ..usual() }),
            ("discount", ValueOptions { discount: -3.0, ..usual() }),
            ("discount", ValueOptions { discount: f32::NAN, ..usual() }),
            ("average", ValueOptions { average: 0.0, ..usual() }),
            ("reward_scale", ValueOptions { reward_scale: 0.0, ..usual() }),
            ("learning_rate", ValueOptions { learning_rate: [1e-3, f32::INFINITY], ..usual() }),
            ("huber", ValueOptions { huber: -1.0, ..usual() }),
            ("teacher", ValueOptions { teacher: 1.5, ..usual() }),
            ("target", ValueOptions { target: Target::CopyEvery(0), ..usual() }),
            ("target", ValueOptions { target: Target::Follow(2.0), ..usual() }),
            ("updates", ValueOptions { updates: Updates::PerStep(-0.5), ..usual() }),
        ] {
            let told = impossible.check(true).unwrap_err().to_string();
            assert!(told.contains(option), "{told}");
        }
        let exploration = Exploration { first: 1.1, ..usual().exploration };
        assert!(ValueOptions { exploration, ..usual() }.check(true).is_err());
    }
}
