//! One action, and the sets of actions that a plant may take.

use serde::{Deserialize, Serialize};

/// What is carried out at one tick: a command from a short list, or up to four axes.
///
/// ```
/// use cohelm::action::Action;
/// let push = Action::axes(&[1.0, -0.5]);
/// assert_eq!(push.axis(1), -0.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// The index of a command in its [`ActionSpace`].
    Command(u8),
    /// Axis values; unused axes are zero.
    Axes([f32; 4]),
}

impl Action {
    /// An action on at most four axes; further values are ignored.
    pub fn axes(values: &[f32]) -> Self {
        let mut axes = [0.0; 4];
        for (axis, value) in axes.iter_mut().zip(values) {
            *axis = *value;
        }
        Self::Axes(axes)
    }

    /// The value of one axis; 0 for a command or an axis beyond the fourth.
    pub fn axis(&self, index: usize) -> f32 {
        match self {
            Self::Axes(axes) => axes.get(index).copied().unwrap_or(0.0),
            Self::Command(_) => 0.0,
        }
    }

    /// The index of the command, or `None` for axes.
    pub fn command(&self) -> Option<usize> {
        match self {
            Self::Command(index) => Some(usize::from(*index)),
            Self::Axes(_) => None,
        }
    }
}

/// Which way something pushes: along a numbered axis of the plant, forwards or backwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Push {
    /// Index of the axis of motion: things that push along the same axis can oppose each other.
    pub axis: u8,
    /// True if it pushes towards larger values.
    pub forwards: bool,
}

/// A switch that stays as it was set: an engine, a pump, a brake.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Switch {
    /// Its name in the plant's words, such as `left`.
    pub name: String,
    /// Where it pushes while on.
    pub push: Push,
}

/// One part of a composed command: a lever with a few positions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lever {
    /// Its name, such as `side`.
    pub name: String,
    /// What its positions are called, from the most negative to the most positive.
    pub positions: Vec<String>,
    /// Index of the position in which it does nothing.
    pub neutral: u8,
}

/// The set of actions of a plant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ActionSpace {
    /// Switches that stay as they were set. Command 2·i turns switch i on, command 2·i + 1 turns it off.
    Switches {
        /// The switches, at most eight.
        switches: Vec<Switch>,
    },
    /// Levers that are all set at every tick; the last lever's position varies fastest.
    Levers {
        /// The levers.
        levers: Vec<Lever>,
    },
    /// One command of a list at every tick; command 0 does nothing.
    Single {
        /// Names of the commands.
        names: Vec<String>,
        /// Where each of them pushes; `None` for one that does nothing.
        pushes: Vec<Option<Push>>,
    },
    /// Axes, each in [low, high] and 0 when nothing is asked.
    Axes {
        /// Names of the axes, at most four.
        names: Vec<String>,
        /// The smallest value of each.
        low: Vec<f32>,
        /// The largest value of each.
        high: Vec<f32>,
    },
}

impl ActionSpace {
    /// How many commands there are; 0 for axes, whose actions are sampled.
    pub fn commands(&self) -> usize {
        match self {
            Self::Switches { switches } => 2 * switches.len(),
            Self::Levers { levers } => levers.iter().map(|lever| lever.positions.len()).product(),
            Self::Single { names, .. } => names.len(),
            Self::Axes { .. } => 0,
        }
    }

    /// True if `action` belongs to this space and is finite and within its bounds.
    pub fn contains(&self, action: Action) -> bool {
        match (self, action) {
            (Self::Axes { low, high, .. }, Action::Axes(axes)) => {
                let bounded = low
                    .iter()
                    .zip(high)
                    .zip(axes)
                    .all(|((low, high), value)| (*low..=*high).contains(&value));
                bounded && axes[low.len()..].iter().all(|unused| *unused == 0.0)
            }
            (Self::Axes { .. }, _) | (_, Action::Axes(_)) => false,
            (_, Action::Command(index)) => usize::from(index) < self.commands(),
        }
    }

    /// What the person or a report calls an action.
    pub fn label(&self, action: Action) -> String {
        match (self, action) {
            (Self::Switches { switches }, Action::Command(index)) => {
                let name = switches.get(usize::from(index / 2)).map_or("?", |switch| &switch.name);
                format!("{name} {}", if index % 2 == 0 { "on" } else { "off" })
            }
            (Self::Levers { levers }, Action::Command(index)) => {
                let parts = lever_positions(levers, index);
                let named =
                    levers.iter().zip(parts).map(|(lever, at)| lever.positions[usize::from(at)].as_str());
                named.collect::<Vec<_>>().join(" + ")
            }
            (Self::Single { names, .. }, Action::Command(index)) => {
                names.get(usize::from(index)).cloned().unwrap_or_else(|| "?".into())
            }
            (Self::Axes { names, .. }, Action::Axes(axes)) => {
                let named = names.iter().zip(axes).map(|(name, value)| format!("{name} {value:+.2}"));
                named.collect::<Vec<_>>().join(", ")
            }
            _ => "?".into(),
        }
    }

    /// What carrying out `action` (or nothing) would leave the plant set to, given how its switches stand: two actions
    /// with equal effects cannot be told apart by the plant.
    pub fn effect(&self, action: Option<Action>, switches: u8) -> Effect {
        match (self, action) {
            (Self::Switches { .. }, Some(Action::Command(index))) => {
                let bit = 1_u8 << (index / 2);
                Effect::Setting(u32::from(if index % 2 == 0 { switches | bit } else { switches & !bit }))
            }
            (Self::Switches { .. }, _) => Effect::Setting(u32::from(switches)),
            (_, Some(Action::Command(index))) => Effect::Setting(u32::from(index)),
            (Self::Axes { .. }, Some(Action::Axes(axes))) => Effect::Axes(axes.map(|x| x + 0.0)),
            (Self::Axes { .. }, None) => Effect::Axes([0.0; 4]),
            (_, _) => Effect::Setting(u32::from(self.neutral())),
        }
    }

    /// How much `action` is like what was `asked`, in [−1, 1] for commands: f(a, a_h) of Eq. 4.
    ///
    /// Switches and single commands (the paper's definition, Section IV): +1 for the same direction of push, −1 for
    /// the opposite one on the same axis, otherwise 0; so turning the left engine on is like turning the right one
    /// off. Levers: the mean over levers of +1 for the same position, −1 for opposite sides of neutral, otherwise 0.
    /// Axes: minus the Euclidean distance.
    pub fn similarity(&self, action: Action, asked: Action) -> f32 {
        match (self, action, asked) {
            (Self::Axes { .. }, Action::Axes(a), Action::Axes(b)) => -distance(&a, &b),
            (Self::Levers { levers }, Action::Command(a), Action::Command(b)) => {
                let (a, b) = (lever_positions(levers, a), lever_positions(levers, b));
                let agreement = levers.iter().zip(a.zip(b)).map(|(lever, (a, b))| lever.agreement(a, b));
                agreement.sum::<f32>() / levers.len() as f32
            }
            (Self::Single { .. }, a, b) if a == b => 1.0,
            (_, a, b) => match (self.push(a), self.push(b)) {
                (Some(a), Some(b)) if a == b => 1.0,
                (Some(a), Some(b)) if a.axis == b.axis => -1.0,
                _ => 0.0,
            },
        }
    }

    /// How much of what was asked is replaced by what is carried out, from 0 to 1, given the effect of each: on axes their
    /// distance as a share of the longest that there is, between opposite corners; with commands all (1) or nothing (0).
    pub fn replaced(&self, executed: Effect, asked: Effect) -> f32 {
        match (self, executed, asked) {
            (Self::Axes { low, high, .. }, Effect::Axes(executed), Effect::Axes(asked)) => {
                let corner = |ends: &[f32]| core::array::from_fn(|i| ends.get(i).copied().unwrap_or(0.0));
                distance(&executed, &asked) / distance(&corner(low), &corner(high))
            }
            _ => f32::from(u8::from(executed != asked)),
        }
    }

    /// The weighted sum of two actions where the space has one (Section IV, LASC): axes blend; levers blend and go to
    /// the nearest position, the robot's side winning a tie; switches and single commands have none.
    ///
    /// `weight` in [0, 1] is the robot's; at 0 the asked action comes back bit for bit.
    pub fn blend(&self, robot: Action, asked: Action, weight: f32) -> Option<Action> {
        match (self, robot, asked) {
            (Self::Axes { .. }, Action::Axes(_), Action::Axes(_)) if weight == 0.0 => Some(asked),
            (Self::Axes { low, high, .. }, Action::Axes(robot), Action::Axes(asked)) => {
                let mut blended = [0.0; 4];
                for (i, (low, high)) in low.iter().zip(high).enumerate().take(blended.len()) {
                    // Rounding may carry a sum a hair beyond both of its ends.
                    blended[i] = blend_axis(robot[i], asked[i], weight).max(*low).min(*high);
                }
                Some(Action::Axes(blended))
            }
            (Self::Levers { levers }, Action::Command(robot), Action::Command(asked)) => {
                let pairs = lever_positions(levers, robot).zip(lever_positions(levers, asked));
                let index = levers.iter().zip(pairs).fold(0, |index, (lever, (robot, asked))| {
                    index * lever.positions.len() + usize::from(blended_position(robot, asked, weight))
                });
                Some(Action::Command(index as u8))
            }
            _ => None,
        }
    }

    /// How many switches there are to know the setting of; 0 for spaces without memory.
    pub fn switch_count(&self) -> usize {
        if let Self::Switches { switches } = self { switches.len() } else { 0 }
    }

    /// The command that does nothing in spaces whose commands must be given anew at every tick.
    pub fn neutral(&self) -> u8 {
        match self {
            Self::Levers { levers } => {
                levers.iter().fold(0, |index, lever| index * lever.positions.len() as u8 + lever.neutral)
            }
            _ => 0,
        }
    }

    /// The positions of all levers under a composed command; empty for other spaces.
    pub fn levers_of(&self, command: u8) -> Vec<u8> {
        if let Self::Levers { levers } = self {
            lever_positions(levers, command).collect()
        } else {
            Vec::new()
        }
    }

    fn push(&self, action: Action) -> Option<Push> {
        let index = action.command()?;
        match self {
            Self::Switches { switches } => {
                let Push { axis, forwards } = switches.get(index / 2)?.push;
                Some(Push { axis, forwards: forwards == (index % 2 == 0) })
            }
            Self::Single { pushes, .. } => pushes.get(index).copied().flatten(),
            _ => None,
        }
    }
}

impl Lever {
    fn agreement(&self, a: u8, b: u8) -> f32 {
        let side = |at: u8| at.cmp(&self.neutral) as i8;
        if a == b {
            1.0
        } else if side(a) * side(b) < 0 {
            -1.0
        } else {
            0.0
        }
    }
}

/// What an action leaves a plant set to; see [`ActionSpace::effect`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effect {
    /// The switches' bits, or the index of a command.
    Setting(u32),
    /// The axes' values.
    Axes([f32; 4]),
}

fn lever_positions(levers: &[Lever], command: u8) -> impl Iterator<Item = u8> + use<'_> {
    levers.iter().enumerate().map(move |(i, lever)| {
        let below: usize = levers[i + 1..].iter().map(|lever| lever.positions.len()).product();
        ((usize::from(command) / below) % lever.positions.len()) as u8
    })
}

fn blended_position(robot: u8, asked: u8, weight: f32) -> u8 {
    let (robot, asked) = (f32::from(robot), f32::from(asked));
    let blended = asked + weight * (robot - asked);
    let nearest = libm::floorf(blended + 0.5);
    let tied = blended + 0.5 == nearest;
    (if tied && robot < asked { nearest - 1.0 } else { nearest }) as u8
}

fn distance(a: &[f32; 4], b: &[f32; 4]) -> f32 {
    distance_between(a, b)
}

/// The Euclidean distance of two actions on any number of axes; minus this is their similarity.
pub fn distance_between(a: &[f32], b: &[f32]) -> f32 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    libm::sqrtf(squares.sum())
}

/// One axis of a blend, of which `weight` in [0, 1] is the robot's share; at 0 what was asked comes back bit for bit.
pub fn blend_axis(robot: f32, asked: f32, weight: f32) -> f32 {
    // Said apart, because −0 + 0 is +0.
    if weight == 0.0 { asked } else { asked + weight * (robot - asked) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn switch(name: &str, axis: u8, forwards: bool) -> Switch {
        Switch { name: name.into(), push: Push { axis, forwards } }
    }

    fn engines() -> ActionSpace {
        ActionSpace::Switches {
            switches: vec![switch("left", 0, false), switch("main", 1, true), switch("right", 0, true)],
        }
    }

    fn main_and_side() -> ActionSpace {
        let lever = |name: &str, positions: &[&str], neutral| Lever {
            name: name.into(),
            positions: positions.iter().map(|p| p.to_string()).collect(),
            neutral,
        };
        ActionSpace::Levers {
            levers: vec![lever("main", &["off", "on"], 0), lever("side", &["left", "none", "right"], 1)],
        }
    }

    fn alike(space: &ActionSpace, a: u8, b: u8) -> f32 {
        space.similarity(Action::Command(a), Action::Command(b))
    }

    #[test]
    fn the_papers_two_examples_of_similarity_hold() {
        let (left_on, left_off, right_off, main_on) = (0, 1, 5, 2);
        assert_eq!(alike(&engines(), left_on, right_off), 1.0);
        assert_eq!(alike(&engines(), left_on, left_off), -1.0);
        assert_eq!(alike(&engines(), left_on, main_on), 0.0);
    }

    #[test]
    fn switch_commands_that_change_nothing_have_equal_effects() {
        let effect = |command, switches| engines().effect(Some(Action::Command(command)), switches);
        assert_eq!(effect(0, 0b001), effect(3, 0b001));
        assert_ne!(effect(0, 0b000), effect(3, 0b000));
        assert_eq!(engines().effect(None, 0b101), Effect::Setting(0b101));
    }

    #[test]
    fn levers_name_compare_and_blend_by_part() {
        let space = main_and_side();
        assert_eq!(space.commands(), 6);
        assert_eq!(space.label(Action::Command(5)), "on + right");
        assert_eq!(space.neutral(), 1);
        assert_eq!(alike(&space, 0, 2), 0.0, "same main, opposite sides: (1 − 1)/2");
        assert_eq!(alike(&space, 3, 2), -0.5, "other main, opposite sides: (0 − 1)/2");
        let blend = |weight| space.blend(Action::Command(3), Action::Command(2), weight);
        assert_eq!(blend(0.0), Some(Action::Command(2)));
        assert_eq!(
            blend(0.5),
            Some(Action::Command(4)),
            "the main engine's tie goes to the robot, the sides meet in the middle"
        );
        assert_eq!(blend(1.0), Some(Action::Command(3)));
    }

    #[test]
    fn axes_blend_truly_and_a_weight_of_zero_keeps_every_bit() {
        let space = ActionSpace::Axes { names: vec!["x".into()], low: vec![-1.0], high: vec![1.0] };
        let (robot, asked) = (Action::axes(&[1.0]), Action::axes(&[0.1]));
        assert_eq!(space.blend(robot, asked, 0.0), Some(asked));
        let rest = space.blend(robot, Action::axes(&[-0.0]), 0.0).unwrap();
        assert!(rest.axis(0).is_sign_negative(), "the bits of the person's zero are theirs too");
        assert_eq!(space.blend(robot, Action::axes(&[0.0]), 0.25), Some(Action::axes(&[0.25])));
        assert!(
            space.contains(asked)
                && !space.contains(Action::axes(&[1.5]))
                && !space.contains(Action::axes(&[f32::NAN]))
        );
    }
}
