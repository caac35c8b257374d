//! Steering in a plane: the same two directions by levers or by axes, for plants that offer both.
//!
//! Knows no physics: what a push to the right or upwards does is the plant's.

use crate::action::{Action, ActionSpace, Lever};
use serde::{Deserialize, Serialize};

/// What can be asked for. In a plant's options it is called `levers` or `continuous`.
///
/// ```
/// use cohelm::steering::{Steering, asked};
/// let right_and_down = [1.0, -1.0];
/// for steering in [Steering::Levers, Steering::Continuous] {
///     assert_eq!(asked(Some(steering.action(right_and_down))), right_and_down);
/// }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Steering {
    /// Two levers of three positions, upwards first: nine commands.
    #[default]
    Levers,
    /// Two axes, x to the right and y upwards, each from −1 to 1.
    Continuous,
}

impl Steering {
    /// The set of actions. `upwards` and `across` name the levers, `rest` what each is called between its ends: down and up,
    /// left and right.
    pub fn space(self, [upwards, across]: [&str; 2], rest: [&str; 2]) -> ActionSpace {
        let lever = |name: &str, positions: [&str; 3]| Lever {
            name: name.into(),
            positions: positions.map(String::from).to_vec(),
            neutral: 1,
        };
        match self {
            Self::Levers => ActionSpace::Levers {
                levers: vec![
                    lever(upwards, ["down", rest[0], "up"]),
                    lever(across, ["left", rest[1], "right"]),
                ],
            },
            Self::Continuous => {
                let names = vec!["x".into(), "y".into()];
                ActionSpace::Axes { names, low: vec![-1.0; 2], high: vec![1.0; 2] }
            }
        }
    }

    /// The action that asks for this, x and y from −1 to 1; a lever goes to the nearest position.
    pub fn action(self, asked: [f64; 2]) -> Action {
        match self {
            Self::Continuous => Action::axes(&asked.map(|axis| axis as f32)),
            Self::Levers => {
                let [x, y] = asked.map(|axis| (libm::round(axis) + 1.0) as u8);
                Action::Command(3 * y + x)
            }
        }
    }
}

/// What an action of either set asks for: x and y, from −1 to 1.
pub fn asked(action: Option<Action>) -> [f64; 2] {
    match action {
        None => [0.0; 2],
        Some(Action::Command(command)) => [f64::from(command % 3) - 1.0, f64::from(command / 3) - 1.0],
        Some(action) => [action.axis(0), action.axis(1)].map(|axis| f64::from(axis.clamp(-1.0, 1.0))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_asks_for_what_its_name_says() {
        let space = Steering::Levers.space(["lift", "roll"], ["hover", "none"]);
        for (command, name, expected) in
            [(0, "down left", [-1.0, -1.0]), (4, "hover none", [0.0, 0.0]), (7, "up none", [0.0, 1.0])]
        {
            let action = Action::Command(command);
            let label = space.label(action);
            assert!(name.split(' ').all(|word| label.contains(word)), "{command} is called {label}");
            assert_eq!((asked(Some(action)), Steering::Levers.action(expected)), (expected, action));
        }
        assert_eq!(space.commands(), 9);
        assert_eq!(asked(None), [0.0; 2]);
    }

    #[test]
    fn levers_go_to_the_nearest_position_and_axes_are_held_within_their_ends() {
        assert_eq!(Steering::Levers.action([0.6, -0.4]), Action::Command(5));
        assert_eq!(asked(Some(Action::axes(&[2.0, -3.0]))), [1.0, -1.0]);
    }
}
