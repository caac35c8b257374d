//! What must be true of every belief, whatever goals there are and however they come and go.

use cohelm::action::{Action, ActionSpace, Push, Switch};
use cohelm::intent::{
    Belief, Evidence, EvidenceError, Head, IMAGINED, IntentModel, MAX_GOALS, NearestGoal, Product, Told,
    ValueIntent,
};
use cohelm::plant::{Goal, View, Wish};
use cohelm::value::{ActionValues, ValueModel};
use proptest::prelude::*;

/// Four directions and standing still: an action is worth how far it goes towards the goal.
struct Compass(ActionValues);

const WAYS: [[f32; 2]; 5] = [[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];

impl Compass {
    fn new() -> Self {
        Self(ActionValues::equal((0..5).map(Action::Command).collect()).unwrap())
    }

    fn worth(view: &View<'_>, goal: usize, action: Action) -> f32 {
        let goal = view.goals[goal].position;
        let way = WAYS[action.command().unwrap()];
        (0..2).map(|i| way[i] * (goal[i] - view.position[i])).sum()
    }
}

impl ValueModel for Compass {
    fn estimate(&mut self, view: &View<'_>, goal: usize, _asked: Option<Action>) -> &ActionValues {
        let values: Vec<f32> =
            self.0.candidates().iter().map(|&action| Self::worth(view, goal, action)).collect();
        self.0.refill(&values).unwrap();
        &self.0
    }

    fn assess(
        &mut self,
        view: &View<'_>,
        goal: usize,
        actions: &[Action],
        _asked: Option<Action>,
        values: &mut Vec<f32>,
    ) {
        values.clear();
        values.extend(actions.iter().map(|&action| Self::worth(view, goal, action)));
    }
}

/// Pushes in a plane: worth is how near a push is to the way to the goal. Most candidates lie near the best of the goal that
/// was asked about, as those of a critic do.
struct Needle(ActionValues);

impl Needle {
    fn way(view: &View<'_>, goal: usize) -> [f32; 2] {
        let goal = view.goals[goal].position;
        [0, 1].map(|i| (goal[i] - view.position[i]).clamp(-1.0, 1.0))
    }

    fn worth(way: [f32; 2], action: Action) -> f32 {
        -(action.axis(0) - way[0]).abs() - (action.axis(1) - way[1]).abs()
    }
}

impl ValueModel for Needle {
    fn estimate(&mut self, view: &View<'_>, goal: usize, asked: Option<Action>) -> &ActionValues {
        let way = Self::way(view, goal);
        let near = (-4..=4).map(|i| Action::axes(&[way[0], way[1] + 0.01 * i as f32]));
        let candidates: Vec<Action> = asked.into_iter().chain(near).collect();
        let values = candidates.iter().map(|&action| Self::worth(way, action)).collect();
        self.0 = ActionValues::new(candidates, values).unwrap();
        &self.0
    }

    fn assess(
        &mut self,
        view: &View<'_>,
        goal: usize,
        actions: &[Action],
        _asked: Option<Action>,
        values: &mut Vec<f32>,
    ) {
        let way = Self::way(view, goal);
        values.clear();
        values.extend(actions.iter().map(|&action| Self::worth(way, action)));
    }
}

#[test]
fn on_axes_no_goal_is_favoured_by_its_place_among_the_others() {
    let axes = ActionSpace::Axes {
        names: ["x", "y"].map(String::from).into(),
        low: vec![-1.0; 2],
        high: vec![1.0; 2],
    };
    let needle = Box::new(Needle(ActionValues::equal(vec![Action::axes(&[])]).unwrap()));
    let mut model = ValueIntent::new(needle, &axes, 1.0, Evidence::default()).unwrap();
    let mut ask = |push: [f32; 2]| {
        model.begin();
        let belief = model.infer(&view(0, &two()), Some(Action::axes(&push)));
        [belief.probabilities()[0], belief.probabilities()[1]]
    };
    // The two goals lie as far to the left as to the right.
    let [up, left, right] = [[0.0, 0.5], [-0.5, 0.0], [0.5, 0.0]].map(&mut ask);
    assert!((up[0] - 0.5).abs() < 1e-6, "{up:?}");
    assert!(left[0] > 0.5 && (left[0] - right[1]).abs() < 1e-6, "{left:?} {right:?}");
}

fn space() -> ActionSpace {
    let names = ["stay", "left", "right", "down", "up"].map(String::from).into();
    ActionSpace::Single { names, pushes: vec![None; 5] }
}

fn by_values() -> ValueIntent {
    ValueIntent::new(Box::new(Compass::new()), &space(), 1.0, Evidence::default()).unwrap()
}

fn view(tick: u32, goals: &[Goal]) -> View<'_> {
    View { tick, state: &[0.0, 0.0], position: [0.0, 0.0], switches: 0, goals }
}

fn goal(id: u32, x: f32, y: f32) -> Goal {
    Goal { id, position: [x, y] }
}

/// The same key again and again: pressed at even ticks, let go at odd ones.
fn tapped(tick: u32, command: u8) -> Option<Action> {
    (tick % 2 == 0).then_some(Action::Command(command))
}

const LEFT: Option<Action> = Some(Action::Command(1));
const RIGHT: Option<Action> = Some(Action::Command(2));

fn two() -> [Goal; 2] {
    [goal(4, -1.0, 0.0), goal(9, 1.0, 0.0)]
}

fn is_a_belief(belief: &Belief, goals: &[Goal]) -> Result<(), TestCaseError> {
    let p = belief.probabilities();
    prop_assert_eq!(p.len(), goals.len());
    prop_assert!(p.iter().all(|p| (0.0..=1.0).contains(p)), "{:?}", p);
    prop_assert!((0.0..=1.0).contains(&belief.confidence));
    prop_assert!(belief.goal < goals.len().max(1));
    if !goals.is_empty() {
        prop_assert!((p.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{:?}", p);
    }
    if goals.len() == 1 {
        prop_assert_eq!((p[0], belief.confidence), (1.0, 1.0), "one goal is certain");
    }
    Ok(())
}

/// Goals of a moment: some of eight, with their own places.
fn moment() -> impl Strategy<Value = Vec<Goal>> {
    let places = proptest::collection::vec((-3.0_f32..3.0, -3.0_f32..3.0), MAX_GOALS);
    (any::<u8>(), places).prop_map(|(there, places)| {
        let all = places.into_iter().enumerate().map(|(id, (x, y))| goal(id as u32, x, y));
        all.filter(|goal| (there >> goal.id) & 1 == 1).collect()
    })
}

fn requests() -> impl Strategy<Value = Vec<Option<Action>>> {
    proptest::collection::vec(proptest::option::of((0_u8..5).prop_map(Action::Command)), 1..60)
}

proptest! {
    #[test]
    fn beliefs_sum_to_one_whatever_goals_come_and_go(
        moments in proptest::collection::vec((moment(), requests()), 1..6),
    ) {
        let mut models: Vec<Box<dyn IntentModel>> = vec![
            Box::new(by_values()),
            Box::new(Product::new(Box::new(NearestGoal), Box::new(by_values()))),
            Box::new(Told::new(vec![Wish { from: 0, goal: 3 }, Wish { from: 40, goal: 5 }])),
        ];
        let mut tick = 0;
        for (goals, requests) in &moments {
            for &asked in requests {
                for model in models.iter_mut().take(2) {
                    is_a_belief(&model.infer(&view(tick, goals), asked), goals)?;
                }
                let told = models[2].infer(&view(tick, goals), asked);
                prop_assert!(told.probabilities().iter().all(|p| p.is_finite()));
                tick += 1;
            }
        }
    }

    #[test]
    fn heads_give_beliefs_over_any_goals(
        goals in moment(),
        x in -1e3_f32..1e3,
        y in -1e3_f32..1e3,
        spread in 1e-3_f32..1e2,
    ) {
        for head in Head::ALL {
            is_a_belief(&head.belief(&goals, [x, y], spread), &goals)?;
        }
    }

    #[test]
    fn the_order_of_the_goals_does_not_matter(goals in moment(), requests in requests(), turn in 0_usize..8) {
        let mut turned = goals.clone();
        turned.rotate_left(turn % goals.len().max(1));
        let (mut one, mut other) = (by_values(), by_values());
        for (tick, &asked) in requests.iter().enumerate() {
            let a = one.infer(&view(tick as u32, &goals), asked);
            let b = other.infer(&view(tick as u32, &turned), asked);
            for (goal, p) in goals.iter().zip(a.probabilities()) {
                let place = turned.iter().position(|other| other.id == goal.id).unwrap();
                prop_assert!((p - b.probabilities()[place]).abs() < 1e-5);
            }
        }
    }
}

#[test]
fn what_is_asked_tells_the_goal_and_silence_tells_nothing() {
    let mut model = by_values();
    let begun = model.infer(&view(0, &two()), None);
    assert_eq!((begun.confidence, begun.probabilities()), (0.0, &[0.5, 0.5][..]));
    let mut sure = begun;
    for tick in 1..40 {
        sure = model.infer(&view(tick, &two()), tapped(tick, 2));
    }
    assert!(sure.goal == 1 && sure.probabilities()[1] > 0.9, "{sure:?}");
    let after_silence = model.infer(&view(40, &two()), None);
    assert!(after_silence.goal == 1 && after_silence.confidence < sure.confidence);
    assert!(after_silence.confidence > sure.confidence - 0.01, "but it is not forgotten");
}

#[test]
fn a_key_that_is_held_is_one_decision() {
    let (mut held, mut pressed) = (by_values(), by_values());
    for tick in 0..10 {
        let so_far = held.infer(&view(tick, &two()), RIGHT);
        let once = pressed.infer(&view(tick, &two()), if tick == 0 { RIGHT } else { None });
        assert_eq!(so_far, once);
    }
}

#[test]
fn a_changed_mind_is_followed() {
    let mut model = by_values();
    for tick in 0..500 {
        model.infer(&view(tick, &two()), tapped(tick, 2));
    }
    let followed = (500..).find(|&tick| model.infer(&view(tick, &two()), tapped(tick, 1)).goal == 0).unwrap();
    assert!((502..550).contains(&followed), "after {} ticks", followed - 500);
}

#[test]
fn a_goal_that_appears_gets_its_share_and_one_that_vanishes_leaves_its_mass() {
    let mut model = by_values();
    for tick in 0..40 {
        model.infer(&view(tick, &two()), tapped(tick, 2));
    }
    let three = [goal(4, -1.0, 0.0), goal(7, 0.0, 1.0), goal(9, 1.0, 0.0)];
    let with_third = model.infer(&view(40, &three), None);
    let p = with_third.probabilities();
    assert!((p[1] - 1.0 / 3.0).abs() < 1e-3 && p[2] > 0.55 && with_third.goal == 2, "{p:?}");
    let without_its_goal = model.infer(&view(41, &three[..2]), None);
    assert!(without_its_goal.probabilities()[1] > 0.8, "{without_its_goal:?}");
    let alone = model.infer(&view(42, &three[..1]), LEFT);
    assert_eq!((alone.probabilities(), alone.confidence), (&[1.0][..], 1.0));
    let none = model.infer(&view(43, &[]), LEFT);
    assert_eq!((none.probabilities().len(), none.goal), (0, 0));
    let again = model.infer(&view(44, &two()), None);
    assert!((again.probabilities()[0] - 0.5).abs() < 1e-6, "{again:?}");
}

/// Values of two switches' commands under which only switching the second on is good for goal 1.
struct Toggles(ActionValues);

impl ValueModel for Toggles {
    fn estimate(&mut self, _view: &View<'_>, _goal: usize, _asked: Option<Action>) -> &ActionValues {
        &self.0
    }

    fn assess(
        &mut self,
        _view: &View<'_>,
        goal: usize,
        actions: &[Action],
        _asked: Option<Action>,
        values: &mut Vec<f32>,
    ) {
        values.clear();
        let good = Action::Command(2);
        values.extend(actions.iter().map(|&action| if goal == 1 && action == good { 1.0 } else { 0.0 }));
    }
}

#[test]
fn commands_that_change_nothing_say_the_same() {
    let switch = |name: &str, axis| Switch { name: name.into(), push: Push { axis, forwards: true } };
    let space = ActionSpace::Switches { switches: vec![switch("a", 0), switch("b", 1)] };
    let belief = |command: u8| {
        let values = ActionValues::equal((0..4).map(Action::Command).collect()).unwrap();
        let mut model =
            ValueIntent::new(Box::new(Toggles(values)), &space, 1.0, Evidence::default()).unwrap();
        model.infer(&view(0, &two()), Some(Action::Command(command)))
    };
    // Both are off: turning a off and turning b off are the same nothing.
    assert_eq!(belief(1), belief(3));
    assert!(belief(2).probabilities()[1] > 0.5 && belief(1).probabilities()[1] < 0.5);
}

#[test]
fn evidence_that_makes_no_sense_is_refused() {
    let made =
        |evidence, range| ValueIntent::new(Box::new(Compass::new()), &space(), range, evidence).map(|_| ());
    let usual = Evidence::default();
    assert!(matches!(made(usual, f64::NAN), Err(EvidenceError::NoScale(_))));
    assert!(matches!(made(usual, 0.0), Err(EvidenceError::NoScale(_))));
    for wrong in [
        Evidence { rationality: -1.0, ..usual },
        Evidence { weight: f64::NAN, ..usual },
        Evidence { change: 0.0, ..usual },
    ] {
        assert!(matches!(made(wrong, 1.0), Err(EvidenceError::Parameter { .. })), "{wrong:?}");
    }
}

#[test]
fn who_is_told_follows_every_wish_by_its_id() {
    let mut told = Told::new(vec![Wish { from: 0, goal: 9 }, Wish { from: 10, goal: 4 }]);
    assert_eq!(told.infer(&view(9, &two()), None).goal, 1);
    assert_eq!(told.infer(&view(10, &two()), None).goal, 0);
    let gone = told.infer(&view(11, &two()[1..]), None);
    assert_eq!(gone.confidence, 0.0, "what was told is not there");
}

#[test]
fn an_imagined_goal_is_judged_by_the_goal_next_to_it() {
    let belief = Belief::imagined([0.8, 0.1], 0.4);
    assert_eq!(belief.imagined_goal().map(|goal| goal.id), Some(IMAGINED));
    assert_eq!((belief.goal, belief.goal_among(&two()), belief.confidence), (0, 1, 0.4));
    assert_eq!(belief.goal_among(&[]), 0);
    let nonsense = Belief::imagined([f32::NAN, 0.0], 0.4);
    assert_eq!((nonsense.imagined_goal(), nonsense.confidence), (None, 0.0));
}
