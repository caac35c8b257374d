//! The pilot's goal never reaches intent or decision: flights that differ in nothing but that goal, with the same
//! requests, give the same beliefs, values and decisions, bit for bit.

mod made;

use cohelm::action::{Action, ActionSpace};
use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::intent::Inference;
use cohelm::pilot::Recorded;
use cohelm::plant::{Plant, Step, View};
use cohelm::random::Draws;
use cohelm::scene::{Pose, Scene};
use cohelm::trajectory::Setup;
use cohelm_copilot::{Models, cockpit};

/// A plant whose pilot wants something else.
struct Wanting {
    plant: Box<dyn Plant>,
    goal: usize,
}

impl Plant for Wanting {
    fn reset(&mut self, seed: u64) {
        self.plant.reset(seed);
    }

    fn step(&mut self, executed: Option<Action>) -> Step {
        self.plant.step(executed)
    }

    fn view(&self) -> View<'_> {
        self.plant.view()
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
        intent: hash(1),
        pilot: "test".into(),
    }
}

/// Every bit of what the co-pilot did in a flight whose pilot wants `goal` and asks these things.
fn decisions(setup: &Setup, models: &Models, goal: usize, asked: &[Option<Action>]) -> Vec<u32> {
    let plant = made::plants().make(&setup.task).unwrap();
    let mut plant = Wanting { plant, goal };
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
    let mut draws = Draws::new(5);
    let asked: Vec<Option<Action>> =
        (0..150).map(|_| draws.chance(0.6).then(|| Action::Command(draws.below(6) as u8))).collect();
    for inference in
        [Inference::Nearest, Inference::InverseDistance, Inference::Softmax, Inference::Calibrated]
    {
        for rule in Rule::USUAL {
            let setup = setup(rule, inference, &models);
            let [a, b] = [0, 2].map(|goal| decisions(&setup, &models, goal, &asked));
            assert!(a.len() > 100 && a == b, "{rule:?} with {inference:?}");
        }
    }
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
