//! One of the worlds that are flown side by side to collect transitions.
//!
//! Everything random about an episode comes from the number of the world and of the episode, everything random about
//! the choices in a round from the number of the world and of the round. So a log of what was carried out is enough to make all transitions again: that is how training goes on after an interruption.

use crate::choices::{Choices, Pupil};
use crate::curriculum::Curriculum;
use crate::job::{Job, LearnError, PilotFactory};
use crate::memory::Memory;
use crate::options::ValueOptions;
use crate::window::Window;
use cohelm::action::{Action, ActionSpace};
use cohelm::arbitration::{Arbiter, Likeness, MinimalIntervention, Pick, Stage};
use cohelm::intent::Belief;
use cohelm::pilot::Pilot;
use cohelm::plant::{Ending, Plant};
use cohelm::random::{Draws, mix_seed};
use cohelm::value::ActionValues;
use cohelm_copilot::encode::ValueEncoder;
use cohelm_copilot::outputs::Outputs;
use cohelm_copilot::search::Search;
use cohelm_nn::mlp::MlpScratch;
use cohelm_nn::weights::{TensorFile, WeightsError};

/// c in Eq. 3 where pilots steer in training: the mean of the paper's confidence.
const CONFIDENCE_IN_TRAINING: f32 = 0.6;
/// How often a teacher's command is replaced by a random one, so that its flights also show how to recover.
const TEACHER_SLIPS: f64 = 0.04;

/// Streams of random numbers, apart from each other.
mod stream {
    pub const EPISODES: u64 = 0x1000;
    pub const STARTS: u64 = 0x2000;
    pub const CHOICES: u64 = 0x3000;
    pub const PILOTS: u64 = 0x4000;
}

/// What was carried out and where episodes began.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Log {
    /// The start of each episode: its difficulty, or `None` for an ordinary one.
    pub starts: Vec<Option<f32>>,
    /// The action of each step.
    pub executed: Vec<Action>,
}

impl Log {
    /// Puts the log of a world into a checkpoint.
    pub fn save(&self, world: usize, space: &ActionSpace, file: &mut TensorFile) {
        let starts: Vec<f32> = self.starts.iter().map(|start| start.unwrap_or(ORDINARY)).collect();
        file.insert(format!("log.{world}.starts"), &[starts.len()], starts);
        let width = width(space);
        let executed: Vec<f32> = self.executed.iter().flat_map(|&action| numbers(action, width)).collect();
        file.insert(format!("log.{world}.executed"), &[executed.len() / width, width], executed);
    }

    /// Takes it out again: that many episodes and steps, of actions of a space.
    pub fn load(
        file: &TensorFile,
        world: usize,
        [episodes, steps]: [usize; 2],
        space: &ActionSpace,
    ) -> Result<Self, WeightsError> {
        let starts = file.tensor(&format!("log.{world}.starts"), &[episodes])?;
        let width = width(space);
        let executed = file.tensor(&format!("log.{world}.executed"), &[steps, width])?;
        Ok(Self {
            starts: starts.iter().map(|&start| (start >= 0.0).then_some(start)).collect(),
            executed: executed.chunks_exact(width).map(|numbers| action(numbers, space)).collect(),
        })
    }
}

/// Numbers that an action of a space is in a checkpoint.
fn width(space: &ActionSpace) -> usize {
    if let ActionSpace::Axes { names, .. } = space { names.len().max(1) } else { 1 }
}

fn numbers(action: Action, width: usize) -> impl Iterator<Item = f32> {
    let numbers = match action {
        Action::Command(command) => [command.into(), 0.0, 0.0, 0.0],
        Action::Axes(axes) => axes,
    };
    numbers.into_iter().take(width)
}

/// A float becomes the nearest command there is, or a value within its axis, whatever it is.
fn action(numbers: &[f32], space: &ActionSpace) -> Action {
    if let ActionSpace::Axes { low, high, .. } = space {
        let bounded: Vec<f32> =
            numbers.iter().zip(low.iter().zip(high)).map(|(x, (low, high))| x.max(*low).min(*high)).collect();
        Action::axes(&bounded)
    } else {
        Action::Command((numbers[0] as usize).min(space.commands().saturating_sub(1)) as u8)
    }
}

/// Stands for an ordinary start in a checkpoint.
const ORDINARY: f32 = -1.0;

/// How a finished episode went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Flown {
    pub start: Option<f32>,
    /// `None` if the trainer's own limit cut it off.
    pub ending: Option<Ending>,
    pub steps: u32,
    /// Nobody but the network chose (but for exploration), so that it says how good the network is.
    pub own: bool,
}

/// What decides in a round.
#[derive(Clone, Copy)]
pub(crate) enum Policy<'a> {
    /// The network, as it was when the round began.
    Network { network: &'a Pupil, curriculum: &'a Curriculum, epsilon: f64, round: u64 },
    /// What was logged before, a log for each world.
    Logged(&'a [Log]),
}

/// A plant, who flies it, and its episode.
pub(crate) struct World {
    number: usize,
    seed: u64,
    plant: Box<dyn Plant>,
    teacher: bool,
    pilot: Option<Box<dyn Pilot>>,
    pilots_steer: bool,
    cap: u32,
    reward_scale: f32,
    encoder: ValueEncoder,
    choices: Choices,
    mind: Mind,
    window: Window,
    input: Vec<f32>,
    episodes: u64,
    episode: Option<Episode>,
    /// Transitions of this round.
    pub memory: Memory,
    /// Episodes that ended in this round.
    pub flown: Vec<Flown>,
    /// Everything since the first round.
    pub log: Log,
}

#[derive(Clone, Copy, Debug)]
struct Episode {
    start: Option<f32>,
    steps: u32,
}

impl World {
    /// World `number` of a training; the first ones have the teacher, the next ones pilots.
    pub fn new(
        job: &Job<'_>,
        options: &ValueOptions,
        pilots: Option<PilotFactory<'_>>,
        network: &Pupil,
        number: usize,
    ) -> Result<Self, LearnError> {
        let mut plant = job.plant()?;
        let choices = Choices::of(job, options, plant.as_ref())?;
        let worlds = options.worlds as f64;
        let with_teacher = (options.teacher * worlds).round() as usize;
        let with_pilot = (options.pilots * worlds).round() as usize;
        plant.reset(0);
        let teacher = number < with_teacher && plant.teacher(0).is_some();
        let piloted = (with_teacher..with_teacher + with_pilot).contains(&number);
        let pilot = match pilots.filter(|_| piloted) {
            Some(make) => Some(make(plant.as_ref(), number as u64).map_err(LearnError::Pilot)?),
            None => None,
        };
        let encoder = ValueEncoder::new(plant.view().state.len(), choices.asked(options.sees_asked));
        let mind = Mind::new(&choices, plant.space(), network);
        Ok(Self {
            number,
            seed: job.seed,
            plant,
            teacher,
            pilot,
            pilots_steer: options.pilots_steer,
            cap: options.episode_cap,
            reward_scale: options.reward_scale,
            encoder,
            mind: mind.ok_or_else(|| LearnError::NoActions(job.task.plant.clone()))?,
            window: Window::new(options.n_step, options.discount),
            input: vec![0.0; encoder.len()],
            episodes: 0,
            episode: None,
            memory: Memory::new([encoder.len(), choices.width()], usize::MAX),
            choices,
            flown: Vec::new(),
            log: Log::default(),
        })
    }

    /// Flies that many steps; transitions and episodes of earlier rounds are forgotten.
    pub fn fly(&mut self, steps: usize, policy: Policy<'_>) {
        self.memory.clear();
        self.flown.clear();
        let mut draws = match policy {
            Policy::Network { round, network, .. } => {
                self.mind.learn(network);
                Draws::fork(mix_seed(self.seed, stream::CHOICES + self.number as u64), round)
            }
            Policy::Logged(_) => Draws::new(0),
        };
        for _ in 0..steps {
            self.step(policy, &mut draws);
        }
    }

    fn step(&mut self, policy: Policy<'_>, draws: &mut Draws) {
        let Episode { start, steps } = match self.episode {
            Some(episode) => episode,
            None => self.begin(policy),
        };
        let asked = self.look();
        self.window.see(&self.input, &mut self.memory);
        let executed = match policy {
            Policy::Network { network, epsilon, .. } => self.choose(network, asked, epsilon, draws),
            Policy::Logged(logs) => logs[self.number].executed[self.log.executed.len()],
        };
        self.log.executed.push(executed);
        let choice = self.choices.of_executed(Some(executed), self.plant.view().switches);
        let step = self.plant.step(Some(executed));
        self.window.act(&self.input, choice, step.reward as f32 * self.reward_scale);
        let steps = steps + 1;
        self.episode = Some(Episode { start, steps });
        if step.ending.is_some() || steps >= self.cap {
            self.end(start, step.ending, steps);
        }
    }

    fn begin(&mut self, policy: Policy<'_>) -> Episode {
        let start = match policy {
            Policy::Network { curriculum, .. } => {
                let starts = mix_seed(self.seed, stream::STARTS + self.number as u64);
                curriculum.next_start(&mut Draws::fork(starts, self.episodes))
            }
            Policy::Logged(logs) => logs[self.number].starts.get(self.log.starts.len()).copied().flatten(),
        };
        let seed = mix_seed(mix_seed(self.seed, stream::EPISODES + self.number as u64), self.episodes);
        let near = start.filter(|&difficulty| self.plant.reset_near_goal(seed, difficulty.into()));
        if near.is_none() {
            self.plant.reset(seed);
        }
        if let Some(pilot) = &mut self.pilot {
            pilot.begin(mix_seed(seed, stream::PILOTS));
        }
        self.log.starts.push(near);
        Episode { start: near, steps: 0 }
    }

    /// Lets the pilot ask, and turns what is to be seen into the network's input.
    fn look(&mut self) -> Option<Action> {
        let (view, goal) = (self.plant.view(), self.plant.pilot_goal());
        let asked = self.pilot.as_mut().and_then(|pilot| pilot.ask(&view, goal));
        self.encoder.encode(&view, goal, asked, &mut self.input);
        asked
    }

    fn choose(&mut self, network: &Pupil, asked: Option<Action>, epsilon: f64, draws: &mut Draws) -> Action {
        if self.teacher {
            let goal = self.plant.pilot_goal();
            let taught = self.plant.teacher(goal);
            let slips = draws.chance(TEACHER_SLIPS);
            return taught.filter(|_| !slips).unwrap_or_else(|| self.choices.random(draws));
        }
        if draws.chance(epsilon) {
            return self.choices.random(draws);
        }
        let switches = self.plant.view().switches;
        if self.pilots_steer && asked.is_some() {
            let values = self.mind.values(network, &self.input, asked, switches);
            return by_equation_4(self.plant.as_ref(), values, asked);
        }
        self.mind.best(network, &self.input, switches)
    }

    fn end(&mut self, start: Option<f32>, ending: Option<Ending>, steps: u32) {
        self.look();
        let terminal = ending.is_some_and(Ending::is_terminal);
        self.window.end(&self.input, terminal, &mut self.memory);
        let own = !(self.teacher || self.pilots_steer && self.pilot.is_some());
        self.flown.push(Flown { start, ending, steps, own });
        self.episodes += 1;
        self.episode = None;
    }
}

/// What a world thinks with: the rooms that a network's answers take.
enum Mind {
    Commands { outputs: Outputs, scratch: MlpScratch, of_commands: Vec<f32>, values: ActionValues },
    Axes(Box<Search>),
}

impl Mind {
    fn new(choices: &Choices, space: &ActionSpace, network: &Pupil) -> Option<Self> {
        match (choices, network) {
            (Choices::Commands(outputs), Pupil::Commands(network)) => {
                let commands = outputs.commands();
                let candidates = (0..commands).map(|command| Action::Command(command as u8)).collect();
                Some(Self::Commands {
                    outputs: *outputs,
                    scratch: MlpScratch::new(network.shape()),
                    of_commands: vec![0.0; commands],
                    values: ActionValues::equal(candidates).ok()?,
                })
            }
            (_, Pupil::Axes(critic)) => Some(Self::Axes(Box::new(Search::new(space, critic)?))),
            (Choices::Axes { .. }, Pupil::Commands(_)) => None,
        }
    }

    /// Takes in that a network's weights have changed.
    fn learn(&mut self, network: &Pupil) {
        if let (Self::Axes(search), Pupil::Axes(critic)) = (self, network) {
            search.learn(critic);
        }
    }

    /// Values of all candidates. Those of a network that diverges stay what they were; training notices at the next update.
    fn values(
        &mut self,
        network: &Pupil,
        input: &[f32],
        asked: Option<Action>,
        switches: u8,
    ) -> &ActionValues {
        match (self, network) {
            (Self::Commands { outputs, scratch, of_commands, values }, Pupil::Commands(network)) => {
                let found = network.forward(input, scratch);
                for (command, value) in of_commands.iter_mut().enumerate() {
                    *value = found[outputs.output(command, switches)];
                }
                let refilled = values.refill(of_commands);
                debug_assert!(refilled.is_ok() || of_commands.iter().any(|value| !value.is_finite()));
                values
            }
            (Self::Axes(search), Pupil::Axes(critic)) => search.estimate(critic, input, asked),
            _ => unreachable!("a mind is made for its network"),
        }
    }

    /// The best action there is.
    fn best(&mut self, network: &Pupil, input: &[f32], switches: u8) -> Action {
        match (self, network) {
            (Self::Commands { outputs, scratch, .. }, Pupil::Commands(network)) => {
                let values = network.forward(input, scratch);
                let best =
                    (1..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best });
                outputs.command(best, switches)
            }
            (Self::Axes(search), Pupil::Axes(critic)) => {
                let values = search.estimate(critic, input, None);
                values.candidates()[values.best()]
            }
            _ => unreachable!("a mind is made for its network"),
        }
    }
}

/// The choice of Eqs. 3 and 4 at the confidence of training.
fn by_equation_4(plant: &dyn Plant, values: &ActionValues, asked: Option<Action>) -> Action {
    let likeness: Option<Vec<Likeness>> = asked.map(|asked| {
        let wanted = plant.effect(Some(asked));
        let like = |&candidate: &Action| Likeness {
            similarity: plant.similarity(candidate, asked),
            same_label: candidate == asked,
            same_effect: plant.effect(Some(candidate)) == wanted,
        };
        values.candidates().iter().map(like).collect()
    });
    let mut belief = Belief::certain(1, 0);
    belief.confidence = CONFIDENCE_IN_TRAINING;
    let stage = Stage::new(values, likeness.as_deref(), &belief);
    let mut allowed = vec![false; values.candidates().len()];
    match MinimalIntervention.decide(&stage, &mut allowed) {
        Pick::Candidate(index) => values.candidates()[index],
        _ => values.candidates()[values.best()],
    }
}
