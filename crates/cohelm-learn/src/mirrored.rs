//! A plant's symmetry, as it shows in a value network's input and outputs.

use cohelm::plant::Mirror;
use cohelm_copilot::outputs::Outputs;

/// Turns what is seen, and what was chosen, into the same in a mirror.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MirroredInput {
    /// Where each number comes from, and its sign.
    input: Vec<(usize, f32)>,
    /// The output that each output becomes.
    outputs: Vec<usize>,
}

impl MirroredInput {
    /// For inputs made of a state, the way to the goal, and `asked` commands.
    pub fn new(mirror: &Mirror, outputs: Outputs, asked: usize) -> Self {
        let state = mirror.state.len();
        let to_goal = [0, 1].map(|i| (state + i, mirror.position[i]));
        let one_hot =
            mirror.commands.iter().take(asked).map(|&command| (state + 2 + usize::from(command), 1.0));
        let mirrored = |output| {
            let command = outputs.command(output, 0).command().unwrap_or(0);
            outputs.output(usize::from(mirror.commands[command]), 0)
        };
        Self {
            input: mirror.state.iter().copied().chain(to_goal).chain(one_hot).collect(),
            outputs: (0..outputs.len()).map(mirrored).collect(),
        }
    }

    /// Writes the mirrored input.
    pub fn apply(&self, from: &[f32], to: &mut [f32]) {
        for (to, &(place, sign)) in to.iter_mut().zip(&self.input) {
            *to = sign * from[place];
        }
    }

    /// The mirrored output.
    pub fn output(&self, output: usize) -> usize {
        self.outputs[output]
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
        let mirrored = MirroredInput::new(&mirror, outputs, 6);
        let seen = [0.5, 0.25, 1.0, 0.0, 0.1, 0.2, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut twin = [9.0; 12];
        mirrored.apply(&seen, &mut twin);
        assert_eq!(twin, [-0.5, 0.25, 0.0, 1.0, -0.1, 0.2, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let mut back = [9.0; 12];
        mirrored.apply(&twin, &mut back);
        assert_eq!(back, seen);
        assert_eq!([0, 1, 2, 3].map(|output| mirrored.output(output)), [0, 3, 2, 1]);
    }
}
