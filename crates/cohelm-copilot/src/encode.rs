//! What the networks see, as numbers. Each encoding has a version that belongs to the model: whoever changes the
//! meaning of an input counts it up, and models of the older version are refused instead of misread.

use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Goal, View};

/// Version of [`ValueEncoder`].
pub const VALUES_VERSION: u32 = 1;
/// Version of [`IntentEncoder`], the ticks at which it is read included.
pub const INTENT_VERSION: u32 = 1;

/// Control ticks from one tick of the intent network to the next: 80 ms at 50 Hz, less than a person's reaction. Fewer
/// cost time and make sequences long; more make the co-pilot slow to understand.
pub const INTENT_TICKS: u32 = 4;

/// What a value network sees: the state, the goal relative to the plant, and perhaps what is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValueEncoder {
    state: usize,
    asked: usize,
}

impl ValueEncoder {
    /// For a plant with that many numbers in its state. `asked` is the number of commands if the network takes what is
    /// asked as input, otherwise 0.
    pub fn new(state: usize, asked: usize) -> Self {
        Self { state, asked }
    }

    /// Numbers it gives.
    pub fn len(&self) -> usize {
        self.state + 2 + self.asked
    }

    /// Never true: there is always the goal.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the state, the goal's position minus the plant's (0 where there is no such goal) and, if the network takes
    /// it, a 1 at the command that is asked (none if nothing is).
    ///
    /// # Panics
    /// If `input` is not [`len`](Self::len) long or the state has another length than announced.
    pub fn encode(&self, view: &View<'_>, goal: usize, asked: Option<Action>, input: &mut [f32]) {
        let (state, rest) = input.split_at_mut(self.state);
        let (to_goal, one_hot) = rest.split_at_mut(2);
        state.copy_from_slice(view.state);
        let goal = view.goals.get(goal).map_or(view.position, |goal| goal.position);
        to_goal[0] = goal[0] - view.position[0];
        to_goal[1] = goal[1] - view.position[1];
        one_hot[..self.asked].fill(0.0);
        let command = asked.and_then(|action| action.command()).filter(|&command| command < self.asked);
        if let Some(command) = command {
            one_hot[command] = 1.0;
        }
    }
}

/// What the intent networks see: what was asked since their last tick (how often each command, or the mean of each axis,
/// in shares of its larger end), how often nothing was, the state, and for the one that may compare goals their positions.
#[derive(Clone, Debug, PartialEq)]
pub struct IntentEncoder {
    /// What a value of 1 on an axis counts for; empty for commands.
    scales: Vec<f32>,
    state: usize,
    goals: usize,
    /// Of each command or axis, and last of silence.
    sums: Vec<f32>,
    noted: u32,
}

impl IntentEncoder {
    /// For the actions of a plant, with that many numbers in its state, and goals; `None` for a space without actions.
    pub fn new(space: &ActionSpace, state: usize, goals: usize) -> Option<Self> {
        let scale = |(low, high): (&f32, &f32)| {
            let larger = low.abs().max(high.abs());
            if larger.is_finite() && larger > 0.0 { 1.0 / larger } else { 0.0 }
        };
        let scales: Vec<f32> = match space {
            ActionSpace::Axes { low, high, .. } => low.iter().zip(high).map(scale).collect(),
            _ => Vec::new(),
        };
        let requests = space.commands().max(scales.len());
        let sums = vec![0.0; requests + 1];
        (requests > 0).then_some(Self { scales, state, goals, sums, noted: 0 })
    }

    /// Numbers that say what was asked: one a command or axis.
    pub fn requests(&self) -> usize {
        self.sums.len() - 1
    }

    /// Numbers that the network sees which knows no goals: what was asked and silence, then the state.
    pub fn without_goals(&self) -> usize {
        self.sums.len() + self.state
    }

    /// Numbers that the network sees which knows the goals: the same, then x and y of every goal.
    pub fn with_goals(&self) -> usize {
        self.without_goals() + 2 * self.goals
    }

    /// Forgets everything.
    pub fn begin(&mut self) {
        self.sums.fill(0.0);
        self.noted = 0;
    }

    /// True at the control ticks before whose decision the networks tick.
    pub fn is_due(tick: u32) -> bool {
        tick > 0 && tick % INTENT_TICKS == 0
    }

    /// Notes what is asked at one control tick.
    pub fn note(&mut self, asked: Option<Action>) {
        let silence = self.requests();
        match asked {
            Some(Action::Axes(axes)) if !self.scales.is_empty() => {
                for (sum, (value, scale)) in self.sums.iter_mut().zip(axes.iter().zip(&self.scales)) {
                    *sum += value * scale;
                }
            }
            Some(Action::Command(command)) if self.scales.is_empty() && usize::from(command) < silence => {
                self.sums[usize::from(command)] += 1.0;
            }
            _ => self.sums[silence] += 1.0,
        }
        self.noted += 1;
    }

    /// Writes [`with_goals`](Self::with_goals) numbers, of which the first [`without_goals`](Self::without_goals) are
    /// for the other network, and begins to count anew.
    ///
    /// The network has as many places as there were goals in training. Where there are fewer goals now, the last one
    /// stands in the places that are left (zeros where there is none); where there are more, those nearest to the plant are
    /// shown, in their order. Heads compare all goals of the moment, shown or not.
    ///
    /// # Panics
    /// If `input` has another length or the state has another length than announced.
    pub fn encode(&mut self, view: &View<'_>, input: &mut [f32]) {
        let (shares, rest) = input.split_at_mut(self.sums.len());
        let (state, positions) = rest.split_at_mut(self.state);
        for (share, &sum) in shares.iter_mut().zip(&self.sums) {
            *share = sum / self.noted.max(1) as f32;
        }
        state.copy_from_slice(view.state);
        show_goals(view, &mut positions[..2 * self.goals]);
        self.begin();
    }
}

/// Writes the positions of goals into the places that there are for them.
fn show_goals(view: &View<'_>, positions: &mut [f32]) {
    let places = positions.len() / 2;
    let squared = |goal: &Goal| {
        let (dx, dy) = (goal.position[0] - view.position[0], goal.position[1] - view.position[1]);
        dx * dx + dy * dy
    };
    let nearer = |index: usize, goal: &Goal| {
        let before = |(i, other): &(usize, &Goal)| (squared(other), *i) < (squared(goal), index);
        view.goals.iter().enumerate().filter(before).count()
    };
    let shown = view.goals.iter().enumerate().filter(|(index, goal)| nearer(*index, goal) < places);
    let last = view.goals.last().map_or([0.0; 2], |goal| goal.position);
    let shown = shown.map(|(_, goal)| goal.position).chain(std::iter::repeat(last));
    for (position, goal) in positions.chunks_exact_mut(2).zip(shown) {
        position.copy_from_slice(&goal);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    const GOALS: [Goal; 2] = [Goal { id: 0, position: [0.5, 0.25] }, Goal { id: 1, position: [-0.5, 0.0] }];

    fn view() -> View<'static> {
        View { tick: 8, state: &[0.25, 1.0, -3.0], position: [0.25, 1.0], switches: 0, goals: &GOALS }
    }

    #[test]
    fn values_see_the_state_the_way_to_the_goal_and_what_is_asked() {
        let mut input = [9.0; 5];
        ValueEncoder::new(3, 0).encode(&view(), 0, None, &mut input);
        assert_eq!(input, [0.25, 1.0, -3.0, 0.25, -0.75]);
        let mut input = [9.0; 7];
        let encoder = ValueEncoder::new(3, 2);
        encoder.encode(&view(), 1, Some(Action::Command(1)), &mut input);
        assert_eq!(input[3..], [-0.75, -1.0, 0.0, 1.0]);
        encoder.encode(&view(), 1, None, &mut input);
        assert_eq!(input[5..], [0.0, 0.0]);
    }

    #[test]
    fn intent_sees_shares_of_commands_and_of_silence_since_its_last_tick() {
        let space = ActionSpace::Single { names: vec!["a".into(), "b".into()], pushes: vec![None; 2] };
        let mut encoder = IntentEncoder::new(&space, 3, 3).unwrap();
        for asked in [Some(1), Some(1), None, Some(0)] {
            encoder.note(asked.map(Action::Command));
        }
        let mut input = [9.0; 12];
        encoder.encode(&view(), &mut input);
        assert_eq!(input[..3], [0.25, 0.5, 0.25]);
        assert_eq!(input[3..6], [0.25, 1.0, -3.0]);
        assert_eq!(
            input[6..],
            [0.5, 0.25, -0.5, 0.0, -0.5, 0.0],
            "the last goal stands in the place that is left"
        );
        encoder.note(None);
        encoder.encode(&view(), &mut input);
        assert_eq!(input[..3], [0.0, 0.0, 1.0]);
    }

    #[test]
    fn intent_sees_the_mean_of_each_axis_in_shares_of_its_larger_end() {
        let names = vec!["a".into(), "b".into()];
        let space = ActionSpace::Axes { names, low: vec![-1.0, 0.0], high: vec![1.0, 4.0] };
        let mut encoder = IntentEncoder::new(&space, 3, 0).unwrap();
        for asked in [Some([1.0, 4.0]), Some([-0.5, 2.0]), None, Some([0.5, 2.0])] {
            encoder.note(asked.map(|axes| Action::axes(&axes)));
        }
        let mut input = [9.0; 6];
        encoder.encode(&view(), &mut input);
        assert_eq!(input, [0.25, 0.5, 0.25, 0.25, 1.0, -3.0]);
        assert_eq!(IntentEncoder::new(&ActionSpace::Switches { switches: vec![] }, 3, 0), None);
    }

    #[test]
    fn with_fewer_places_than_goals_the_nearest_are_shown_in_their_order() {
        let goals = [-0.9, -0.3, 0.2, 0.6].map(|x| Goal { id: 0, position: [x, 0.0] });
        let one = ActionSpace::Single { names: vec!["a".into()], pushes: vec![None] };
        let mut input = [9.0; 11];
        for (position, shown) in [([0.2, 0.5], [-0.3, 0.2, 0.6]), ([-0.7, 0.5], [-0.9, -0.3, 0.2])] {
            let view = View { goals: &goals, position, ..view() };
            IntentEncoder::new(&one, 3, 3).unwrap().encode(&view, &mut input);
            assert_eq!([input[5], input[7], input[9]], shown);
        }
        let none = View { goals: &[], ..view() };
        IntentEncoder::new(&one, 3, 3).unwrap().encode(&none, &mut input);
        assert_eq!(input[5..], [0.0; 6]);
    }

    #[test]
    fn the_networks_tick_before_the_decisions_at_ticks_4_8_and_12() {
        let due: Vec<u32> = (0..14).filter(|&tick| IntentEncoder::is_due(tick)).collect();
        assert_eq!(due, [4, 8, 12]);
    }
}
