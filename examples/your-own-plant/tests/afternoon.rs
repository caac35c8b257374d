//! The afternoon: training, arbitration, and a flight in the page's loop.

use cohelm::action::Action;
use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::flight::{fly, replay};
use cohelm::intent::Inference;
use cohelm::keys::Change;
use cohelm::pilot::Pilot;
use cohelm::plant::{Ending, View};
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::{Setup, Trajectory};
use cohelm_copilot::{Model, Models, cockpit};
use cohelm_learn::{Job, ValueOptions, evaluate, train_values};
use cohelm_page::page::Page;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::OnceLock;

/// Your plant among those of a program: this line goes into `crates/cohelm-cli/src/rig.rs`, `crates/cohelm-page/src/fleet.rs`
/// and `python/src/world.rs`.
fn plants() -> Plants {
    let mut plants = Plants::default();
    plants.register(your_own_plant::entry());
    plants
}

fn job<'a>(plants: &'a Plants, task: &'a Task) -> Job<'a> {
    let threads = NonZeroUsize::new(2).expect("two threads are more than none");
    Job { plants, task, seed: 1, threads, checkpoints: None, name: "lift", variant: None }
}

/// Values, trained once for all tests: some seconds.
fn trained() -> &'static Model {
    static MODEL: OnceLock<Model> = OnceLock::new();
    MODEL.get_or_init(|| {
        let options = ValueOptions {
            steps: 60_000,
            worlds: 8,
            hidden: vec![32, 32],
            batch: 64,
            memory: 20_000,
            warm_up: 1_000,
            learning_rate: [2e-3, 2e-4],
            discount: 0.98,
            mirror: false,
            validation_episodes: 50,
            validations: 4,
            ..ValueOptions::default()
        };
        let (plants, task) = (plants(), Task::new("lift"));
        let model = train_values(&job(&plants, &task), &options, None, &mut |_| ControlFlow::Continue(()));
        model.expect("a plant that keeps to its trait can be trained on").model
    })
}

/// Somebody in a hurry: full power towards the floor, and no thought of braking.
struct Hasty;

impl Pilot for Hasty {
    fn begin(&mut self, _seed: u64) {}

    fn ask(&mut self, view: &View<'_>, goal: usize) -> Option<Action> {
        let above = view.goals[goal].position[1] > view.position[1];
        Some(Action::Command(if above { 1 } else { 2 }))
    }
}

fn setup(seed: u64, rule: Rule) -> Setup {
    Setup {
        task: Task::new("lift"),
        plant_version: 1,
        seed,
        rule,
        inference: Inference::Known,
        silence: Silence::Best,
        time_scale: 1.0,
        values: Some(trained().hash().into()),
        intent: None,
        pilot: "hasty".into(),
    }
}

/// Share of forty episodes in which the hasty pilot gets to the floor under a rule.
fn arrivals(rule: Rule) -> f64 {
    let plants = plants();
    let mut models = Models::new();
    models.add_model(trained().clone());
    let arrived = (0..40).filter(|&seed| {
        let setup = setup(seed, rule);
        let mut plant = plants.make(&setup.task).expect("the lift is registered");
        let mut cockpit = cockpit(&setup, plant.as_ref(), &plants, &models).expect("the model fits");
        fly(setup, plant.as_mut(), &mut cockpit, &mut Hasty, |_, _| ()).ending == Ending::Goal
    });
    arrived.count() as f64 / 40.0
}

#[test]
fn the_lift_keeps_the_laws_of_plants() {
    cohelm::laws::check(&mut your_own_plant::Lift::default(), 0..20).unwrap();
}

#[test]
fn training_reaches_the_floor_in_most_fresh_episodes() {
    let (plants, task) = (plants(), Task::new("lift"));
    let fresh = evaluate(&job(&plants, &task), trained(), 7, 200).expect("the model fits");
    println!("fresh episodes with the goal known: {:.1} % at the floor", 100.0 * fresh.landed);
    // 92.5 % were measured: three standard deviations of 200 episodes, and some more, lie between.
    assert!(fresh.landed >= 0.85, "{fresh:?}");
}

#[test]
fn with_the_co_pilot_somebody_in_a_hurry_does_better_than_alone() {
    let (alone, helped) = (arrivals(Rule::Hic), arrivals(Rule::Misc));
    println!("in a hurry: {:.1} % alone, {:.1} % with the co-pilot", 100.0 * alone, 100.0 * helped);
    assert!(helped >= alone + 0.3, "alone {alone}, helped {helped}");
}

#[test]
fn the_page_flies_it_with_keys_and_replays_it_to_the_last_bit() {
    let mut page = Page::with_plants(plants());
    page.add_model(trained().bytes()).expect("a model that was just trained");
    let setup = Setup { pilot: "person".into(), ..setup(3, Rule::Misc) };
    let opening = page.begin(&serde_json::to_vec(&setup).unwrap()).unwrap();
    let names: Vec<_> = opening.controls.iter().map(|control| (&*control.name, &*control.keys[0])).collect();
    assert_eq!(names, [("up", "ArrowUp"), ("down", "ArrowDown")]);
    page.change(Change::Down(0), 0.0).unwrap();
    let mut ticks = 0;
    while page.tick().unwrap().is_some() {
        ticks += 1;
    }
    let record = page.finish().unwrap();
    assert_eq!(Trajectory::from_bytes(&record).unwrap().ticks(), ticks);
    assert!(page.replay(&record).unwrap().identical);
    let flown = Trajectory::from_bytes(&record).unwrap();
    assert!(replay(&flown, &mut your_own_plant::Lift::default(), None).identical());
}
