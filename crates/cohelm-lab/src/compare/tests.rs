//! A comparison on the lander with the shipped models, small: the same numbers for any number of threads, and a report.

use super::*;
use cohelm::human::Population;
use cohelm::intent::Head;
use cohelm::registry::Plants;
use cohelm_copilot::{Models, shipped};

struct World {
    plants: Plants,
    models: Models,
}

impl World {
    fn new() -> Self {
        let mut plants = Plants::default();
        cohelm_lander::register(&mut plants);
        plants.register(cohelm::point::entry());
        Self { plants, models: shipped::models().0 }
    }

    fn comparison(&self, threads: usize) -> Comparison<'_> {
        let draws = HeldOut {
            tuning: Draw { seed: 1, populations: vec![Population::Ordinary] },
            held_out: Draw { seed: 2, populations: vec![Population::Skilled] },
        };
        let budget = Budget { participants: 2, episodes: 1, tuning_episodes: 1 };
        Comparison { plants: &self.plants, models: &self.models, draws, budget, threads }
    }
}

#[test]
fn benches_are_the_plants_that_people_can_fly_with_models() {
    let world = World::new();
    let benches = Bench::all(&world.plants, &world.models);
    let names: Vec<&str> = benches.iter().map(|bench| bench.name.as_str()).collect();
    assert!(names.starts_with(&["flag-lander-switches", "flag-lander-main-side"]), "{names:?}");
    assert!(!names.contains(&"point"), "there are people for the point, but no models");
    assert!(Bench::all(&world.plants, &Models::new()).is_empty());
}

#[test]
fn a_setting_flies_the_same_for_any_number_of_threads() {
    let world = World::new();
    let bench = &Bench::all(&world.plants, &world.models)[0];
    let settings: Vec<Setting> = contenders(Head::Softmax).iter().map(|settings| settings[0]).collect();
    let fly = |threads| {
        let comparison = world.comparison(threads);
        comparison.fly(bench, &comparison.draws.held_out, &settings, 1).unwrap()
    };
    let [one, three] = [fly(1), fly(3)];
    for (one, three) in one.iter().zip(&three) {
        assert_eq!(one.units, three.units, "{:?}", one.setting);
        assert_eq!(one.units.len(), 2);
    }
    let of_kinds = comparison_of_kinds(&world, bench);
    assert_ne!(of_kinds[0].units[0].means, of_kinds[0].units[2].means, "each kind flies episodes of its own");
    let alone = &one[0];
    assert_eq!((alone.mean("interventions"), alone.setting.rule.word()), (0.0, "hic"));
}

/// The robot alone, flown for two kinds of people.
fn comparison_of_kinds(world: &World, bench: &Bench) -> Vec<Stand> {
    let kinds = Draw { seed: 2, populations: vec![Population::Skilled, Population::Insisting] };
    world.comparison(0).fly(bench, &kinds, &robots()[..1], 1).unwrap()
}

#[test]
fn a_small_comparison_is_tuned_told_and_written() {
    let world = World::new();
    let bench = &Bench::all(&world.plants, &world.models)[0];
    let comparison = world.comparison(0);
    let compared = [comparison.run(bench).unwrap()];
    for entered in &compared[0].entered {
        let best = entered.tried.iter().map(|tried| tried.score).fold(f64::NEG_INFINITY, f64::max);
        let entered_with =
            entered.tried.iter().find(|tried| tried.setting == entered.held_out.setting).unwrap();
        assert_eq!(entered_with.score, best, "{}", entered.word());
        assert_eq!(entered.seen.setting, entered.held_out.setting);
    }
    let heads = |word: &str| {
        let entered = compared[0].entered.iter().find(|entered| entered.word() == word).unwrap();
        entered
            .tried
            .iter()
            .map(|tried| tried.setting.inference.word())
            .collect::<std::collections::BTreeSet<_>>()
    };
    assert_eq!((heads("robot").len(), heads("misc").len()), (3, 3));
    let robot = compared[0].entered.iter().find(|entered| entered.word() == "robot").unwrap();
    let head = robot.held_out.setting.inference;
    assert_eq!(heads("misc-h").into_iter().collect::<Vec<_>>(), [head.word()]);
    assert!(compared[0].curve.stands.iter().all(|stand| stand.setting.inference == head));
    // A tolerance lies on its own line.
    let on_line = compared[0].curve.margin(&compared[0].curve.stands[4]).unwrap();
    assert!(on_line.success.abs() < 1e-12 && on_line.against() == Against::On, "{on_line:?}");
    let making = Making { command: "cohelm compare".into(), program: "cohelm".into() };
    let markdown = document(&compared, &comparison, &making).unwrap().markdown();
    for expected in ["misc-r: success", "flag-lander-switches", "Constant tolerances", "skilled"] {
        assert!(markdown.to_lowercase().contains(&expected.to_lowercase()), "{expected}: {markdown}");
    }
    let written = files(&compared).unwrap();
    assert_eq!(written.len(), 8);
    assert!(written.iter().all(|(name, bytes)| !name.ends_with("parquet") || bytes.starts_with(b"PAR1")));
}
