//! A plant's symmetry, as it shows in a value network's input and in what is chosen.

use crate::choices::{Choice, Choices};
use cohelm::plant::Mirror;
use cohelm_copilot::outputs::Outputs;

/// Turns what is seen, and what was chosen, into the same in a mirror.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MirroredInput {
    /// Where each number comes from, and its sign.
    input: Vec<(usize, f32)>,
    choice: MirroredChoice,
}

/// What a choice becomes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum MirroredChoice {
    /// The output that each output becomes.
    Outputs(Vec<usize>),
    /// Where each axis comes from, and its sign.
    Axes(Vec<(usize, f32)>),
}

impl MirroredChoice {
    /// For the outputs of a network of commands.
    pub fn outputs(mirror: &Mirror, outputs: Outputs) -> Self {
        let mirrored = |output| {
            let command = outputs.command(output, 0).command().unwrap_or(0);
            outputs.output(usize::from(mirror.commands[command]), 0)
        };
        Self::Outputs((0..outputs.len()).map(mirrored).collect())
    }

    fn of(&self, choice: Choice) -> Choice {
        let mut twin = [0.0; 4];
        match self {
            Self::Outputs(outputs) => twin[0] = outputs[choice[0] as usize] as f32,
            Self::Axes(axes) => {
                for (twin, &(place, sign)) in twin.iter_mut().zip(axes) {
                    *twin = sign * choice[place];
                }
            }
        }
        twin
    }
}

impl MirroredInput {
    /// For inputs made of a state, the way to the goal, and `asked` commands; `None` if the mirror does not tell what
    /// becomes of the choices.
    pub fn new(mirror: &Mirror, choices: &Choices, asked: usize) -> Option<Self> {
        let state = mirror.state.len();
        let to_goal = [0, 1].map(|i| (state + i, mirror.position[i]));
        let one_hot =
            mirror.commands.iter().take(asked).map(|&command| (state + 2 + usize::from(command), 1.0));
        Some(Self {
            input: mirror.state.iter().copied().chain(to_goal).chain(one_hot).collect(),
            choice: choices.mirrored(mirror)?,
        })
    }

    /// Writes the mirrored input.
    pub fn apply(&self, from: &[f32], to: &mut [f32]) {
        for (to, &(place, sign)) in to.iter_mut().zip(&self.input) {
            *to = sign * from[place];
        }
    }

    /// The mirrored choice.
    pub fn choice(&self, choice: Choice) -> Choice {
        self.choice.of(choice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohelm::action::{ActionSpace, Push, Switch};

    #[test]
    fn a_mirrored_input_is_the_input_of_the_mirrored_plant() {
        let switch = |axis, forwards| Switch { name: String::new(), push: Push { axis, forwards } };
        let switches = vec![switch(0, false), switch(1, true), switch(0, true)];
        let outputs = Outputs::of(&ActionSpace::Switches { switches }).unwrap();
        let mirror = Mirror {
            state: vec![(0, -1.0), (1, 1.0), (3, 1.0), (2, 1.0)],
            position: [-1.0, 1.0],
            commands: vec![4, 5, 2, 3, 0, 1],
            axes: vec![],
        };
        let mirrored = MirroredInput::new(&mirror, &Choices::Commands(outputs), 6).unwrap();
        let seen = [0.5, 0.25, 1.0, 0.0, 0.1, 0.2, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut twin = [9.0; 12];
        mirrored.apply(&seen, &mut twin);
        assert_eq!(twin, [-0.5, 0.25, 0.0, 1.0, -0.1, 0.2, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let mut back = [9.0; 12];
        mirrored.apply(&twin, &mut back);
        assert_eq!(back, seen);
        let twin_of = |output: f32| mirrored.choice([output, 0.0, 0.0, 0.0])[0];
        assert_eq!([0.0, 1.0, 2.0, 3.0].map(twin_of), [0.0, 3.0, 2.0, 1.0]);
    }

    #[test]
    fn a_mirrored_choice_on_axes_goes_to_the_other_side() {
        let twin = MirroredChoice::Axes(vec![(1, 1.0), (0, -1.0)]);
        assert_eq!(twin.of([0.5, 0.25, 0.0, 0.0]), [0.25, -0.5, 0.0, 0.0]);
    }
}
