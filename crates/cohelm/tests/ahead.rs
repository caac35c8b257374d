//! Looking ahead: what a rule is told of a copy of the plant, and what it is not.

use cohelm::action::{Action, ActionSpace};
use cohelm::arbitration::{Arbiter, Needs, Pick, Rule, Stage};
use cohelm::cockpit::Cockpit;
use cohelm::intent::{IntentModel, KnownGoal};
use cohelm::pilot::Recorded;
use cohelm::plant::{Ending, Plant, Step, View};
use cohelm::point::{self, Point};
use cohelm::scene::{Pose, Scene};
use std::sync::{Arc, Mutex};

fn values() -> Box<dyn cohelm::value::ValueModel> {
    (point::entry().values.unwrap())()
}

/// A point to which a goal that is not the pilot's is a wall.
#[derive(Clone)]
struct Walled {
    point: Point,
    /// Whether the pilot may be given another goal.
    may_be_set: bool,
}

impl Walled {
    fn new(may_be_set: bool) -> Self {
        Self { point: Point::new(), may_be_set }
    }
}

impl Plant for Walled {
    fn reset(&mut self, seed: u64) {
        self.point.reset(seed);
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        let step = self.point.step(executed);
        let wall = |ending| if ending == Ending::Elsewhere { Ending::Crash } else { ending };
        Step { ending: step.ending.map(wall), ..step }
    }

    fn view(&self) -> View<'_> {
        self.point.view()
    }

    fn pilot_goal(&self) -> usize {
        self.point.pilot_goal()
    }

    fn space(&self) -> &ActionSpace {
        self.point.space()
    }

    fn limit_ticks(&self) -> Option<u32> {
        self.point.limit_ticks()
    }

    fn scene(&self) -> Scene {
        self.point.scene()
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        self.point.poses(poses);
    }

    fn snapshot(&self) -> Option<Box<dyn Plant>> {
        Some(Box::new(self.clone()))
    }

    fn set_pilot_goal(&mut self, goal: usize) -> bool {
        self.may_be_set && self.point.set_pilot_goal(goal)
    }
}

/// A flight of a pilot who asks the same for ever, under a rule, to a goal that the co-pilot is told.
fn flown(rule: Rule, push: [f32; 2], told: usize, wanted: usize) -> (Ending, Vec<Option<Action>>) {
    let mut plant = Point::new();
    plant.reset(3);
    assert!(plant.set_pilot_goal(wanted));
    flown_in(&mut plant, rule, push, told)
}

fn flown_in(plant: &mut dyn Plant, rule: Rule, push: [f32; 2], told: usize) -> (Ending, Vec<Option<Action>>) {
    let mut cockpit = Cockpit::new(Box::new(KnownGoal(told)), values(), rule.arbiter(1.0).unwrap());
    cockpit.begin();
    let asked = [Some(Action::axes(&push)); 600];
    let mut pilot = Recorded::new(&asked);
    let mut executed = Vec::new();
    loop {
        let tick = cockpit.tick(plant, &mut pilot);
        executed.push(tick.executed);
        if let Some(ending) = tick.step.ending {
            return (ending, executed);
        }
    }
}

#[test]
fn who_pushes_off_the_plane_is_kept_on_it_and_otherwise_left_alone() {
    let out = [1.0, 0.3];
    assert_eq!(flown(Rule::Hic, out, 0, 0).0, Ending::OutOfBounds);
    let (ending, executed) = flown(Rule::SafeNearest { hold: 5, horizon: 60 }, out, 0, 0);
    assert_ne!(ending, Ending::OutOfBounds);
    let first = executed.iter().position(|&action| action != Some(Action::axes(&out))).unwrap();
    assert!(first > 20, "it waits until it must: {first}");
}

#[test]
fn without_a_horizon_whatever_is_asked_is_carried_out() {
    let blind = flown(Rule::SafeNearest { hold: 5, horizon: 0 }, [1.0, 0.3], 0, 0);
    assert_eq!(blind, flown(Rule::Hic, [1.0, 0.3], 0, 0));
}

#[test]
fn what_lies_ahead_does_not_tell_which_goal_is_the_pilots() {
    let rule = Rule::SafeNearest { hold: 20, horizon: 500 };
    let flown_with = |wanted: usize, may_be_set: bool, push| {
        let mut plant = Walled::new(may_be_set);
        plant.reset(3);
        assert!(plant.point.set_pilot_goal(wanted));
        flown_in(&mut plant, rule, push, 0).1
    };
    for push in [[1.0, 0.3], [-0.2, 1.0], [0.0, 0.4]] {
        let asked = Some(Action::axes(&push));
        let [own, other] = [0, 1].map(|wanted| flown_with(wanted, true, push));
        let both = own.len().min(other.len());
        assert!(both > 30 && own[..both] == other[..both], "{push:?}");
        assert!(
            own[..20].iter().all(|&executed| executed == asked),
            "and the person is let through: {push:?}"
        );
        let [own, other] = [0, 1].map(|wanted| flown_with(wanted, false, push));
        let both = own.len().min(other.len());
        assert!(own[..both] == other[..both], "nothing is safe where the copy would tell: {push:?}");
        assert_ne!(own[0], asked, "{push:?}");
    }
}

/// Notes what it is told, and lets the person through.
struct Noting {
    needs: Needs,
    told: Arc<Mutex<Vec<(bool, bool, bool)>>>,
}

impl Arbiter for Noting {
    fn decide(&self, stage: &Stage<'_>, _allowed: &mut [bool]) -> Pick {
        let last = stage.last.is_some_and(|last| last.executed == last.asked && !last.intervened);
        self.told.lock().unwrap().push((stage.of_goals.is_some(), stage.ahead.is_some(), last));
        if let Some(of_goals) = stage.of_goals {
            assert_eq!(of_goals.goals(), 2);
            assert_eq!(of_goals.of(stage.belief.goal), stage.values.values());
            let best = stage.values.best();
            assert_eq!(of_goals.regret(stage.belief.goal, best), 0.0);
        }
        Pick::Asked
    }

    fn needs(&self) -> Needs {
        self.needs
    }
}

#[test]
fn a_rule_is_told_what_it_needs_and_no_more() {
    for (every_goal, look_ahead) in [(false, false), (true, false), (false, true), (true, true)] {
        let told = Arc::default();
        let noting = Noting { needs: Needs { every_goal, look_ahead }, told: Arc::clone(&told) };
        let intent: Box<dyn IntentModel> = Box::new(KnownGoal(1));
        let mut cockpit = Cockpit::new(intent, values(), Box::new(noting));
        let (mut plant, asked) = (Point::new(), [Some(Action::axes(&[0.5, 0.5])); 2]);
        cockpit.begin();
        let mut pilot = Recorded::new(&asked);
        for _ in 0..2 {
            cockpit.tick(&mut plant, &mut pilot);
        }
        assert_eq!(*told.lock().unwrap(), [(every_goal, look_ahead, false), (every_goal, look_ahead, true)]);
    }
}
