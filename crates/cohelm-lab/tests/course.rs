//! Goals that come and go and a mind that changes, in the loop: the shipped networks, every inference, several rules, a
//! simulated person.

use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::flight::{fly, replay};
use cohelm::human::{Person, Population};
use cohelm::intent::Inference;
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::Setup;
use cohelm_copilot::{Kind, cockpit, shipped};
use serde_json::json;

const APPEARS: u32 = 30;
const VANISHES: u32 = 90;

fn task() -> Task {
    let options = json!({ "appears_at": APPEARS, "vanishes_at": VANISHES, "changes_mind": [60, 120] });
    Task { plant: "flag-lander".into(), options }
}

fn plants() -> Plants {
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    plants
}

fn setup(inference: Inference, rule: Rule, seed: u64) -> Setup {
    let (models, plant) = (shipped::models().0, plants().make(&task()).unwrap());
    let hash = |model: Option<&cohelm_copilot::Model>| model.map(|model| model.hash().to_owned());
    Setup {
        plant_version: plants().entry(&task()).unwrap().version,
        values: hash(models.newest_for(Kind::Values, &task(), plant.space())),
        intent: hash(models.newest_intent(inference, &task(), plant.space())),
        task: task(),
        seed,
        rule,
        inference,
        silence: Silence::Best,
        time_scale: 1.0,
        pilot: "simulated person".into(),
    }
}

fn person(plant: &dyn Plant, seed: u64) -> impl Pilot + use<> {
    let who = Person { population: Population::Ordinary, seed, index: 0 };
    let mut person = plants().entry(&task()).unwrap().participant(plant.space(), who).unwrap();
    person.begin(seed);
    person
}

#[test]
fn beliefs_follow_the_goals_of_the_moment_and_the_flight_replays() {
    let (plants, models) = (plants(), shipped::models().0);
    let rules = [Rule::Misc, Rule::MiscH { kappa: 1.25, release: 0.5 }, Rule::Hindsight { likeness: 0.3 }];
    for inference in Inference::ALL {
        let mut counts = std::collections::BTreeSet::new();
        for (seed, rule) in rules.into_iter().enumerate() {
            let setup = setup(inference, rule, seed as u64);
            let mut plant = plants.make(&setup.task).unwrap();
            let mut cockpit = cockpit(&setup, plant.as_ref(), &plants, &models).unwrap();
            let mut pilot = person(plant.as_ref(), setup.seed);
            let record = fly(setup.clone(), plant.as_mut(), &mut cockpit, &mut pilot, |tick, plant| {
                let p = tick.belief.probabilities();
                let what = format!("{inference:?}, {rule:?}, tick {}", tick.tick);
                assert!(p.iter().all(|p| (0.0..=1.0).contains(p)), "{what}: {p:?}");
                assert!((0.0..=1.0).contains(&tick.belief.confidence), "{what}");
                if inference != Inference::Imagined {
                    let sum: f32 = p.iter().sum();
                    assert!((sum - 1.0).abs() < 1e-4 && tick.belief.goal < p.len(), "{what}: {p:?}");
                    // The belief is from before the step, the plant as the step left it.
                    let changed = [APPEARS, VANISHES].contains(&(tick.tick + 1));
                    assert!(changed || p.len() == plant.view().goals.len(), "{what}: {p:?}");
                    counts.insert(p.len());
                }
            });
            let replayed = replay(&record, plant.as_mut(), Some(&mut cockpit));
            assert!(
                replayed.identical() && replayed.decisions_identical == Some(true),
                "{inference:?}, {rule:?}"
            );
        }
        assert!(inference == Inference::Imagined || counts.len() == 2, "{inference:?} saw {counts:?} goals");
    }
}
