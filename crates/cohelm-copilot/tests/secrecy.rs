//! The pilot's goal never reaches intent or decision: flights that differ in nothing but that goal, with the same
//! requests, give the same beliefs, values and decisions, bit for bit.

mod made;

use cohelm::action::{Action, ActionSpace};
use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::intent::Inference;
use cohelm::pilot::Recorded;
use cohelm::plant::{Goal, Plant, Step, View};
use cohelm::random::Draws;
use cohelm::scene::{Pose, Scene};
use cohelm::trajectory::Setup;
use cohelm_copilot::{Models, cockpit};

/// A plant whose pilot wants something else.
struct Wanting {
    plant: Box<dyn Plant>,
    goal: usize,
    /// What goals are shown instead of its own.
    shown: Option<Vec<Goal>>,
}

impl Plant for Wanting {
    fn reset(&mut self, seed: u64) {
        self.plant.reset(seed);
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        self.plant.step(executed)
    }

    fn view(&self) -> View<'_> {
        let view = self.plant.view();
        View { goals: self.shown.as_deref().unwrap_or(view.goals), ..view }
    }

    fn pilot_goal(&self) -> usize {
        self.goal
    }

    fn space(&self) -> &ActionSpace {
        self.plant.space()
    }

    fn scene(&self) -> Scene {
        self.plant.scene()
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        self.plant.poses(poses);
    }

    fn snapshot(&self) -> Option<Box<dyn Plant>> {
        let mut plant = self.plant.snapshot()?;
        plant.set_pilot_goal(self.goal);
        Some(plant)
    }
}

fn setup(rule: Rule, inference: Inference, models: &Models) -> Setup {
    let hash = |i| models.iter().nth(i).map(|model| model.hash().to_owned());
    Setup {
        task: made::task(),
        plant_version: made::plants().entry(&made::task()).unwrap().version,
        seed: 11,
        rule,
        inference,
        silence: Silence::Best,
        time_scale: 1.0,
        values: hash(0),
        intent: hash(if inference.hides_goals() { 2 } else { 1 }),
        pilot: "test".into(),
    }
}

/// Every bit of what the co-pilot did in a flight whose pilot wants `goal` and asks these things.
fn decisions(setup: &Setup, models: &Models, goal: usize, asked: &[Option<Action>]) -> Vec<u32> {
    let plant = made::plants().make(&setup.task).unwrap();
    decisions_in(Wanting { plant, goal, shown: None }, setup, models, asked)
}

fn decisions_in(mut plant: Wanting, setup: &Setup, models: &Models, asked: &[Option<Action>]) -> Vec<u32> {
    plant.reset(setup.seed);
    let mut cockpit = cockpit(setup, &plant, &made::plants(), models).unwrap();
    cockpit.begin();
    let mut pilot = Recorded::new(asked);
    let mut bits = Vec::new();
    for _ in asked {
        let tick = cockpit.tick(&mut plant, &mut pilot);
        bits.extend(tick.belief.probabilities().iter().chain([&tick.belief.confidence]).map(|p| p.to_bits()));
        bits.extend(tick.values.values().iter().map(|value| value.to_bits()));
        bits.extend([
            tick.belief.goal as u32,
            tick.executed.and_then(|e| e.command()).map_or(99, |c| c as u32),
        ]);
        if tick.step.ending.is_some() {
            break;
        }
    }
    bits
}

#[test]
fn another_goal_with_the_same_requests_changes_no_bit_of_belief_or_decision() {
    let mut models = Models::new();
    models.add_model(made::values(3));
    models.add_model(made::intent(4));
    models.add_model(made::imagining(5));
    let mut draws = Draws::new(5);
    let asked: Vec<Option<Action>> =
        (0..150).map(|_| draws.chance(0.6).then(|| Action::Command(draws.below(6) as u8))).collect();
    for inference in Inference::ALL.into_iter().filter(|&inference| inference != Inference::Known) {
        for rule in Rule::USUAL {
            let setup = setup(rule, inference, &models);
            let [a, b] = [0, 2].map(|goal| decisions(&setup, &models, goal, &asked));
            assert!(a.len() > 100 && a == b, "{rule:?} with {inference:?}");
        }
    }
}

#[test]
fn who_imagines_a_goal_decides_the_same_whatever_goals_there_are() {
    let mut models = Models::new();
    models.add_model(made::values(3));
    models.add_model(made::intent(4));
    models.add_model(made::imagining(5));
    let asked = [Some(Action::Command(2)), None, Some(Action::Command(0))].repeat(40);
    let flown = |inference, shown: Option<Vec<Goal>>| {
        let plant = made::plants().make(&made::task()).unwrap();
        let setup = setup(Rule::Misc, inference, &models);
        decisions_in(Wanting { plant, goal: 0, shown }, &setup, &models, &asked)
    };
    let elsewhere = || Some(vec![Goal { id: 7, position: [0.9, 0.9] }; 2]);
    let own = flown(Inference::Imagined, None);
    assert!(own.len() > 100 && own == flown(Inference::Imagined, elsewhere()));
    assert_eq!(own, flown(Inference::Imagined, Some(vec![])));
    assert_ne!(
        flown(Inference::Softmax, None),
        flown(Inference::Softmax, elsewhere()),
        "it would be noticed"
    );
}

#[test]
fn this_test_would_notice() {
    let mut models = Models::new();
    models.add_model(made::values(3));
    let setup = setup(Rule::Robot, Inference::Known, &models);
    let of_seed = |seed| decisions(&Setup { seed, ..setup.clone() }, &models, 0, &[None; 20]);
    // Who is told the goal decides by it: seeds differ in the goal, so some decisions must.
    assert!((0..5).any(|seed| of_seed(seed) != of_seed(seed + 5)));
}
