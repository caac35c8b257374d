//! The four action sets, all on the same three engines.

use crate::craft::Engines;
use crate::gymnasium;
use cohelm::action::{Action, ActionSpace, Lever, Push, Switch};
use serde::{Deserialize, Serialize};

/// Sideways: larger is to the right.
const SIDE_AXIS: u8 = 0;
/// Along the hull: larger is upwards.
const MAIN_AXIS: u8 = 1;

/// Which actions pilot and co-pilot may take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ActionSet {
    /// The paper's six commands {left, main, right} × {on, off}, one a tick; an engine stays as it was set.
    #[default]
    Switches,
    /// Two levers, main {off, on} × side {left, none, right}, set anew at every tick (Reddy et al. 2018).
    MainSide,
    /// Gymnasium's four: nothing, left, main, right; one engine at most.
    Gymnasium,
    /// Gymnasium's two axes, main and side, each in −1..1.
    Continuous,
}

/// Which engines burn, one bit each, in the order of the switches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Burning(u8);

impl Burning {
    /// None of them.
    pub const NONE: Burning = Burning(0);
    /// The one that pushes and rolls to the left.
    pub const LEFT: Burning = Burning(1);
    /// The one that pushes upwards along the hull.
    pub const MAIN: Burning = Burning(2);
    /// The one that pushes and rolls to the right.
    pub const RIGHT: Burning = Burning(4);

    /// Those that burn at any throttle.
    pub fn of(engines: &Engines) -> Burning {
        let bit = |throttle: f64, burning| if throttle > 0.0 { burning } else { Burning::NONE };
        bit(engines.left, Burning::LEFT)
            .with(bit(engines.main, Burning::MAIN))
            .with(bit(engines.right, Burning::RIGHT))
    }

    /// These and those.
    #[must_use]
    pub fn with(self, other: Burning) -> Burning {
        Burning(self.0 | other.0)
    }

    /// Whether all of `other` burn.
    pub fn contains(self, other: Burning) -> bool {
        self.0 & other.0 == other.0
    }

    /// The bits: left 1, main 2, right 4.
    pub fn bits(self) -> u8 {
        self.0
    }

    /// How many engines differ.
    pub fn differences(self, other: Burning) -> u32 {
        (self.0 ^ other.0).count_ones()
    }

    /// Full throttle where it burns.
    pub fn full_throttle(self) -> Engines {
        let on = |engine| self.contains(engine);
        Engines::burning(on(Burning::MAIN), on(Burning::LEFT), on(Burning::RIGHT))
    }
}

impl ActionSet {
    /// The set in the words of the loop.
    pub fn space(self) -> ActionSpace {
        match self {
            Self::Switches => {
                ActionSpace::Switches { switches: engines().map(|(name, push)| Switch { name, push }).into() }
            }
            Self::MainSide => ActionSpace::Levers {
                levers: vec![lever("main", &["off", "on"], 0), lever("side", &["left", "none", "right"], 1)],
            },
            Self::Gymnasium => {
                let (names, pushes): (Vec<_>, Vec<_>) =
                    engines().map(|(name, push)| (name, Some(push))).into_iter().unzip();
                ActionSpace::Single {
                    names: [vec!["nothing".into()], names].concat(),
                    pushes: [vec![None], pushes].concat(),
                }
            }
            Self::Continuous => ActionSpace::Axes {
                names: vec!["main".into(), "side".into()],
                low: vec![-1.0; 2],
                high: vec![1.0; 2],
            },
        }
    }

    /// What burns during the tick that carries `executed` out, after `before` has burnt. Nothing executed leaves
    /// switches as they are and turns everything off in the other sets; so does an action of another set.
    pub fn engines(self, executed: Option<Action>, before: &Engines) -> Engines {
        match (self, executed) {
            (Self::Switches, Some(Action::Command(command))) => {
                switched(Burning::of(before), command).full_throttle()
            }
            (Self::Switches, _) => *before,
            (Self::MainSide, Some(Action::Command(command))) => main_side(command).full_throttle(),
            (Self::Gymnasium, Some(Action::Command(_))) | (Self::Continuous, Some(Action::Axes(_))) => {
                gymnasium_action(executed).engines()
            }
            _ => Engines::OFF,
        }
    }

    /// The action that best brings `wanted` about when `now` burns: in switches the first that differs, in the order
    /// left, right, main; in Gymnasium's four a side engine before the main one.
    pub fn towards(self, wanted: Burning, now: Burning) -> Action {
        let has = |engine| wanted.contains(engine);
        let side = i8::from(has(Burning::RIGHT)) - i8::from(has(Burning::LEFT));
        match self {
            Self::Switches => Action::Command(first_switch(wanted, now)),
            Self::MainSide => Action::Command(3 * u8::from(has(Burning::MAIN)) + (side + 1) as u8),
            Self::Gymnasium if side != 0 => Action::Command((side + 2) as u8),
            Self::Gymnasium => Action::Command(2 * u8::from(has(Burning::MAIN))),
            Self::Continuous => Action::axes(&[if has(Burning::MAIN) { 1.0 } else { -1.0 }, f32::from(side)]),
        }
    }

    /// For each command the one that does the same seen in a mirror, and for each axis its place and sign there.
    pub fn mirrored(self) -> (Vec<u8>, Vec<(usize, f32)>) {
        match self {
            Self::Switches => (vec![4, 5, 2, 3, 0, 1], Vec::new()),
            Self::MainSide => (vec![2, 1, 0, 5, 4, 3], Vec::new()),
            Self::Gymnasium => (vec![0, 3, 2, 1], Vec::new()),
            Self::Continuous => (Vec::new(), vec![(0, 1.0), (1, -1.0)]),
        }
    }
}

fn engines() -> [(String, Push); 3] {
    let push = |axis, forwards| Push { axis, forwards };
    [
        ("left".into(), push(SIDE_AXIS, false)),
        ("main".into(), push(MAIN_AXIS, true)),
        ("right".into(), push(SIDE_AXIS, true)),
    ]
}

fn lever(name: &str, positions: &[&str], neutral: u8) -> Lever {
    Lever { name: name.into(), positions: positions.iter().map(|name| name.to_string()).collect(), neutral }
}

fn switched(before: Burning, command: u8) -> Burning {
    let bit = 1_u8.checked_shl(u32::from(command / 2)).unwrap_or(0) & 0b111;
    Burning(if command % 2 == 0 { before.0 | bit } else { before.0 & !bit })
}

/// The command on the first switch that stands wrong, or one that changes nothing.
fn first_switch(wanted: Burning, now: Burning) -> u8 {
    const LEFT_RIGHT_MAIN: [u8; 3] = [0, 2, 1];
    let stands_wrong = |i: &u8| (wanted.0 ^ now.0) >> i & 1 == 1;
    let switch = LEFT_RIGHT_MAIN.into_iter().find(stands_wrong).unwrap_or(1);
    2 * switch + u8::from(wanted.0 >> switch & 1 == 0)
}

fn main_side(command: u8) -> Burning {
    let main = if command >= 3 { Burning::MAIN } else { Burning::NONE };
    main.with([Burning::LEFT, Burning::NONE, Burning::RIGHT][usize::from(command % 3)])
}

/// The same in Gymnasium's words; nothing for a command it does not have.
pub(crate) fn gymnasium_action(executed: Option<Action>) -> gymnasium::Action {
    match executed {
        Some(Action::Command(command)) => gymnasium::Action::DISCRETE.get(usize::from(command)).copied(),
        Some(Action::Axes([main, side, ..])) => Some(gymnasium::Action::Throttles([main, side])),
        None => None,
    }
    .unwrap_or(gymnasium::Action::Nothing)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETS: [ActionSet; 4] =
        [ActionSet::Switches, ActionSet::MainSide, ActionSet::Gymnasium, ActionSet::Continuous];

    fn burns(set: ActionSet, command: u8, before: Burning) -> Burning {
        Burning::of(&set.engines(Some(Action::Command(command)), &before.full_throttle()))
    }

    fn mirrored(burning: Burning) -> Burning {
        Burning((burning.0 & 2) | (burning.0 & 1) << 2 | burning.0 >> 2)
    }

    #[test]
    fn every_engine_does_what_its_name_says_in_every_set() {
        for set in SETS {
            let space = set.space();
            for command in 0..space.commands() as u8 {
                let label = space.label(Action::Command(command));
                let after = burns(set, command, Burning::NONE);
                let named = |word: &str| label.split([' ', '+']).any(|part| part == word);
                let main = named("main") || set == ActionSet::MainSide && named("on");
                let off = set == ActionSet::Switches && named("off");
                assert_eq!(after.contains(Burning::LEFT), named("left") && !off, "{set:?} {label}");
                assert_eq!(after.contains(Burning::MAIN), main && !off, "{set:?} {label}");
                assert_eq!(after.contains(Burning::RIGHT), named("right") && !off, "{set:?} {label}");
            }
        }
    }

    #[test]
    fn three_of_the_six_switch_commands_change_nothing_whatever_burns() {
        for bits in 0..8 {
            let silent =
                (0..6).filter(|&command| burns(ActionSet::Switches, command, Burning(bits)).0 == bits);
            assert_eq!(silent.count(), 3);
        }
    }

    #[test]
    fn releasing_a_switch_keeps_it_and_releasing_anything_else_turns_it_off() {
        let all = Burning(7).full_throttle();
        assert_eq!(ActionSet::Switches.engines(None, &all), all);
        for set in &SETS[1..] {
            assert_eq!(set.engines(None, &all), Engines::OFF, "{set:?}");
        }
    }

    #[test]
    fn mirrored_commands_burn_the_mirrored_engines() {
        for set in &SETS[..3] {
            let (commands, _) = set.mirrored();
            assert_eq!(commands.len(), set.space().commands());
            for (command, &other) in commands.iter().enumerate() {
                for before in (0..8).map(Burning) {
                    let seen = mirrored(burns(*set, command as u8, before));
                    assert_eq!(burns(*set, other, mirrored(before)), seen, "{set:?} {command}");
                }
            }
        }
        let at = |axes: [f32; 2]| {
            Burning::of(&ActionSet::Continuous.engines(Some(Action::axes(&axes)), &Engines::OFF))
        };
        let (_, axes) = ActionSet::Continuous.mirrored();
        for asked in [[1.0, 0.75], [0.0, -1.0], [-1.0, 0.25]] {
            let twin = [0, 1].map(|i| axes[i].1 * asked[axes[i].0]);
            assert_eq!(at(twin), mirrored(at(asked)), "{asked:?}");
        }
    }

    #[test]
    fn what_is_wanted_comes_about() {
        let possible = |set, wanted: Burning| match set {
            ActionSet::Switches => true,
            ActionSet::Gymnasium => wanted.0.count_ones() < 2,
            _ => !wanted.contains(Burning(5)),
        };
        for set in SETS {
            for (wanted, before) in (0..64).map(|i| (Burning(i % 8), Burning(i / 8))) {
                let mut now = before.full_throttle();
                for _ in 0..3 {
                    now = set.engines(Some(set.towards(wanted, Burning::of(&now))), &now);
                }
                assert!(
                    !possible(set, wanted) || Burning::of(&now) == wanted,
                    "{set:?} {wanted:?} {before:?}"
                );
            }
        }
    }

    // Gymnasium 1.4.0, LunarLander.step: main_power = (clip(a[0], 0, 1) + 1) · 0.5 if a[0] > 0,
    // side_power = clip(|a[1]|, 0.5, 1) if |a[1]| > 0.5.
    #[test]
    fn axes_are_gymnasiums() {
        let at = |main, side| ActionSet::Continuous.engines(Some(Action::axes(&[main, side])), &Engines::OFF);
        assert_eq!(at(0.0, 0.5), Engines::OFF);
        assert_eq!(at(-1.0, -0.75), Engines { left: 0.75, ..Engines::OFF });
        assert_eq!(at(0.5, 1.0), Engines { main: 0.75, left: 0.0, right: 1.0 });
    }
}
