//! Which network output stands for which command.
//!
//! With n switches there are 2n commands, but at any moment n of them change nothing and cannot be told apart. Free
//! outputs for all of them would break that tie by noise, and arbitration would replace one command by another that
//! does the same. So the network has n + 1 outputs, *change nothing* and *toggle i*, and a command's value is that of
//! what it would do: commands that change nothing tie exactly.

use cohelm::action::{Action, ActionSpace};

/// The mapping between a network's outputs and the commands of a space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outputs {
    /// Output 0 changes nothing, output 1 + i toggles switch i.
    Toggles {
        /// How many switches there are.
        switches: usize,
    },
    /// One output a command.
    Commands {
        /// How many commands there are.
        commands: usize,
        /// The command that does nothing.
        neutral: usize,
    },
}

impl Outputs {
    /// The mapping of a space; `None` for axes, which have no list of commands.
    pub fn of(space: &ActionSpace) -> Option<Self> {
        match space {
            ActionSpace::Switches { switches } if !switches.is_empty() => {
                Some(Self::Toggles { switches: switches.len() })
            }
            _ => Self::free(space),
        }
    }

    /// One output a command even where some commands cannot be told apart: what Algorithm 1 as printed would have.
    pub fn free(space: &ActionSpace) -> Option<Self> {
        let (commands, neutral) = (space.commands(), usize::from(space.neutral()));
        (commands > 0).then_some(Self::Commands { commands, neutral })
    }

    /// How many outputs the network has.
    pub fn len(self) -> usize {
        match self {
            Self::Toggles { switches } => switches + 1,
            Self::Commands { commands, .. } => commands,
        }
    }

    /// True if there are none, which [`Outputs::of`] never gives.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// How many commands there are.
    pub fn commands(self) -> usize {
        match self {
            Self::Toggles { switches } => 2 * switches,
            Self::Commands { commands, .. } => commands,
        }
    }

    /// The output that stands for a command, given how the switches stand.
    pub fn output(self, command: usize, switches: u8) -> usize {
        match self {
            Self::Toggles { .. } => {
                let (switch, on) = (command / 2, command % 2 == 0);
                let is_on = (switches >> switch) & 1 == 1;
                if on == is_on { 0 } else { switch + 1 }
            }
            Self::Commands { .. } => command,
        }
    }

    /// The output that stands for what was carried out, or for nothing.
    pub fn output_of(self, executed: Option<Action>, switches: u8) -> usize {
        match (executed.and_then(|action| action.command()), self) {
            (Some(command), _) => self.output(command, switches),
            (None, Self::Toggles { .. }) => 0,
            (None, Self::Commands { neutral, .. }) => neutral,
        }
    }

    /// A command that does what an output stands for. For *change nothing* it is the one that confirms switch 0.
    pub fn command(self, output: usize, switches: u8) -> Action {
        let command = match self {
            Self::Commands { .. } => output,
            Self::Toggles { .. } => {
                let switch = output.saturating_sub(1);
                let is_on = usize::from((switches >> switch) & 1);
                let confirms = usize::from(output == 0);
                2 * switch + (is_on ^ confirms)
            }
        };
        Action::Command(command as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohelm::action::{Push, Switch};

    fn three_switches() -> Outputs {
        let switch = |axis| Switch { name: "s".into(), push: Push { axis, forwards: true } };
        Outputs::of(&ActionSpace::Switches { switches: vec![switch(0), switch(1), switch(2)] }).unwrap()
    }

    #[test]
    fn three_of_six_commands_share_the_output_that_changes_nothing() {
        for switches in 0..8 {
            let outputs: Vec<usize> = (0..6).map(|c| three_switches().output(c, switches)).collect();
            assert_eq!(outputs.iter().filter(|&&o| o == 0).count(), 3);
            assert!((1..4).all(|toggle| outputs.contains(&toggle)), "{switches:03b}: {outputs:?}");
        }
    }

    #[test]
    fn a_command_made_from_an_output_stands_for_that_output() {
        for (output, switches) in (0..4).flat_map(|o| (0..8).map(move |s| (o, s))) {
            let command = three_switches().command(output, switches);
            assert_eq!(three_switches().output_of(Some(command), switches), output);
        }
    }

    #[test]
    fn the_outputs_effects_are_the_spaces() {
        let switch = |axis| Switch { name: "s".into(), push: Push { axis, forwards: true } };
        let space = ActionSpace::Switches { switches: vec![switch(0), switch(1)] };
        let outputs = Outputs::of(&space).unwrap();
        for (a, b, switches) in
            (0..4_u8).flat_map(|a| (0..4).flat_map(move |b| (0..4).map(move |s| (a, b, s))))
        {
            let effect = |c| space.effect(Some(Action::Command(c)), switches);
            let same = outputs.output(a.into(), switches) == outputs.output(b.into(), switches);
            assert_eq!(same, effect(a) == effect(b));
        }
    }

    #[test]
    fn doing_nothing_has_an_output_in_every_set() {
        assert_eq!(three_switches().output_of(None, 0b101), 0);
        let single = ActionSpace::Single { names: vec!["none".into(), "go".into()], pushes: vec![None; 2] };
        assert_eq!(Outputs::of(&single).unwrap().output_of(None, 0), 0);
        let axes = ActionSpace::Axes { names: vec!["x".into()], low: vec![-1.0], high: vec![1.0] };
        assert_eq!(Outputs::of(&axes), None);
    }
}
