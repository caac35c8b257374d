//! Small trainings from beginning to end, on a line with a goal at each end.

mod line;

use cohelm::flight::fly;
use cohelm::intent::{Head, Inference};
use cohelm::trajectory::{Setup, Trajectory};
use cohelm_copilot::{Model, Models, Network, cockpit};
use cohelm_learn::options::{Target, Updates};
use cohelm_learn::{
    IntentOptions, LearnError, LiveLearner, LiveOptions, RecordedFlight, TrainedIntent, ValueOptions,
    evaluate, train_intent, train_intent_from, train_values,
};
use line::{Bench, small, small_intent, walker};
use std::ops::ControlFlow;
use std::path::Path;

fn values(bench: &Bench, options: &ValueOptions, seed: u64, threads: usize, folder: Option<&Path>) -> Model {
    let job = bench.job(seed, threads, folder);
    let trained = train_values(&job, options, Some(&walker), &mut |_| ControlFlow::Continue(()));
    trained.expect("a small training succeeds").model
}

fn intent(bench: &Bench, values: &Model, threads: usize, folder: Option<&Path>) -> TrainedIntent {
    let job = bench.job(3, threads, folder);
    let trained = train_intent(&job, values, &small_intent(), &walker, &mut |_| ControlFlow::Continue(()));
    trained.expect("a small training succeeds")
}

#[test]
fn values_learn_to_reach_the_goal_and_the_card_tells_how() {
    for bench in BENCHES {
        let bench = bench();
        let model = values(&bench, &small(), 1, 2, None);
        let fresh = evaluate(&bench.job(1, 2, None), &model, 7, 100).unwrap();
        assert_eq!((fresh.landed, fresh.mean_steps), (1.0, Some(8.0)), "{fresh:?}");
        let card = model.card();
        assert_eq!(card.options, serde_json::to_value(small()).unwrap());
        assert!(card.median_range.is_some_and(|range| range > 0.0));
        assert_eq!(Model::from_bytes(model.bytes()).unwrap().hash(), model.hash());
    }
}

/// The line with commands, and with an axis.
const BENCHES: [fn() -> Bench; 2] = [Bench::new, Bench::with_an_axis];

#[test]
fn values_on_an_axis_learn_from_teachers_and_from_pilots_who_steer_too() {
    let bench = Bench::with_an_axis();
    for options in [
        ValueOptions { teacher: 0.5, advantage: 0.0, double: false, ..small() },
        ValueOptions { pilots: 1.0, mirror: false, ..small() },
    ] {
        let model = values(&bench, &options, 2, 2, None);
        let fresh = evaluate(&bench.job(1, 2, None), &model, 7, 100).unwrap();
        assert!(fresh.landed > 0.95, "{options:?}: {fresh:?}");
    }
    let heard = ValueOptions { sees_asked: true, pilots: 1.0, ..small() };
    let refused =
        train_values(&bench.job(1, 1, None), &heard, Some(&walker), &mut |_| ControlFlow::Continue(()));
    assert!(refused.unwrap_err().to_string().contains("sees_asked"));
}

#[test]
fn every_preset_and_option_learns_the_line() {
    let paper = ValueOptions {
        updates: Updates::PerEpisode(15.0),
        target: Target::CopyEvery(500),
        learning_rate: [3e-3, 3e-3],
        discount: 0.95,
        dueling: false,
        effective_outputs: false,
        n_step: 1,
        advantage: 0.0,
        huber: 0.0,
        ahead: 0,
        mirror: false,
        near_goal: None,
        pilots: 1.0,
        ..small()
    };
    let heard = ValueOptions { sees_asked: true, pilots: 1.0, pilots_steer: false, ..small() };
    for options in [paper, ValueOptions { teacher: 0.25, ..small() }, heard] {
        let bench = Bench::new();
        let model = values(&bench, &options, 2, 2, None);
        let fresh = evaluate(&bench.job(1, 2, None), &model, 7, 100).unwrap();
        assert!(fresh.landed > 0.95, "{options:?}: {fresh:?}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_for_any_number_of_threads() {
    for bench in BENCHES {
        let bench = bench();
        let options = ValueOptions { steps: 3_000, ..small() };
        let one = values(&bench, &options, 5, 1, None);
        for threads in [2, 4] {
            assert_eq!(values(&bench, &options, 5, threads, None).hash(), one.hash(), "{threads} threads");
        }
        assert_ne!(values(&bench, &options, 6, 1, None).hash(), one.hash(), "another seed");
        let hashes = [1, 2, 4].map(|threads| intent(&bench, &one, threads, None).model.hash().to_owned());
        assert!(hashes.iter().all(|hash| *hash == hashes[0]));
    }
}

/// Runs until `train` finishes, stopping it after every few reports.
fn interrupted<T>(
    every: u32,
    mut train: impl FnMut(&mut dyn FnMut() -> ControlFlow<()>) -> Result<T, LearnError>,
) -> T {
    for _ in 0..1_000 {
        let mut reports = 0;
        let mut stop = || {
            reports += 1;
            if reports > every { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        match train(&mut stop) {
            Err(LearnError::Stopped) => {}
            done => return done.expect("a small training succeeds"),
        }
    }
    panic!("it never came to an end");
}

#[test]
fn an_interrupted_training_gives_the_same_bytes() {
    for bench in BENCHES {
        let bench = bench();
        let options = ValueOptions { steps: 3_000, target: Target::CopyEvery(400), ..small() };
        let whole = values(&bench, &options, 5, 2, None);
        let folder = tempfile::tempdir().unwrap();
        let job = bench.job(5, 2, Some(folder.path()));
        let pieces = interrupted(4, |stop| train_values(&job, &options, Some(&walker), &mut |_| stop()));
        assert_eq!(pieces.model.hash(), whole.hash());

        let whole = intent(&bench, &whole, 1, None).model;
        let job = bench.job(3, 1, Some(folder.path()));
        let learnt = |stop: &mut dyn FnMut() -> ControlFlow<()>| {
            train_intent(&job, &pieces.model, &small_intent(), &walker, &mut |_| stop())
        };
        assert_eq!(interrupted(2, learnt).model.hash(), whole.hash());
    }
}

#[test]
fn a_checkpoint_of_another_training_is_refused_by_name_of_what_differs() {
    let bench = Bench::new();
    let folder = tempfile::tempdir().unwrap();
    let job = bench.job(5, 1, Some(folder.path()));
    let stopped = train_values(&job, &small(), None, &mut |_| ControlFlow::Break(()));
    assert!(matches!(stopped, Err(LearnError::Stopped)));
    let options = ValueOptions { batch: 16, ..small() };
    let refused =
        train_values(&job, &options, None, &mut |_| ControlFlow::Continue(())).unwrap_err().to_string();
    assert!(refused.contains("options.batch") && refused.contains("values.checkpoint"), "{refused}");
    for cut in [0, 7, 500] {
        let path = folder.path().join("values.checkpoint");
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..cut]).unwrap();
        let refused = train_values(&job, &small(), None, &mut |_| ControlFlow::Continue(()));
        assert!(matches!(refused, Err(LearnError::Checkpoint { .. })));
        std::fs::write(&path, &bytes).unwrap();
    }
}

#[test]
fn options_that_contradict_themselves_are_refused() {
    let bench = Bench::new();
    for (options, named) in [
        (ValueOptions { batch: 0, ..small() }, "batch"),
        (ValueOptions { advantage: 1.0, ..small() }, "advantage"),
        (ValueOptions { pilots: 0.5, ..small() }, "pilots"),
        (ValueOptions { sees_asked: true, ..small() }, "sees_asked"),
        (ValueOptions { hidden: vec![0], ..small() }, "hidden"),
    ] {
        let refused =
            train_values(&bench.job(1, 1, None), &options, None, &mut |_| ControlFlow::Continue(()));
        let message = refused.unwrap_err().to_string();
        assert!(message.contains(named), "{message}");
    }
}

#[test]
fn intent_learns_whose_goal_it_is_from_what_is_asked() {
    for bench in BENCHES {
        let bench = bench();
        let values = values(&bench, &small(), 1, 2, None);
        let trained = intent(&bench, &values, 2, None);
        for closed in &trained.closed_loop {
            assert!(closed.right_at_end >= 0.9, "{closed:?}");
        }
        let calibrated = &trained.scores[2];
        assert_eq!(calibrated.head, Head::Calibrated);
        assert!(calibrated.all.accuracy > 0.85, "{calibrated:?}");
        assert!(trained.scores.iter().all(|scores| scores.by_time.len() == 7));
    }
}

/// Flights of walkers under minimal intervention.
fn flights(
    bench: &Bench,
    models: &Models,
    inference: Inference,
    seeds: std::ops::Range<u64>,
) -> Vec<Trajectory> {
    let of = |kind: &dyn Fn(&Network) -> bool| {
        models.iter().find(|model| kind(model.network())).map(|model| model.hash().to_owned())
    };
    let one = |seed| {
        let setup = Setup {
            task: bench.task.clone(),
            plant_version: 1,
            seed,
            rule: cohelm::arbitration::Rule::Misc,
            inference,
            silence: Default::default(),
            time_scale: 1.0,
            values: of(&|network| matches!(network, Network::Values(_))),
            intent: of(&|network| matches!(network, Network::Intent(_))),
            pilot: "walker".into(),
        };
        let mut plant = bench.plants.make(&bench.task).unwrap();
        let mut cockpit = cockpit(&setup, plant.as_ref(), &bench.plants, models).unwrap();
        let mut pilot = walker(plant.as_ref(), seed).unwrap();
        pilot.begin(seed);
        fly(setup, plant.as_mut(), &mut cockpit, pilot.as_mut(), |_, _| {})
    };
    seeds.map(one).collect()
}

#[test]
fn intent_learns_from_recorded_flights_and_is_scored_on_others_than_those_it_learnt_from() {
    let bench = Bench::new();
    let mut models = Models::new();
    models.add_model(values(&bench, &small(), 1, 2, None));
    let recorded = flights(&bench, &models, Inference::Nearest, 0..60);
    let people: Vec<String> = (0..6).map(|i| format!("participant {i}")).collect();
    let recorded: Vec<RecordedFlight<'_>> = recorded
        .iter()
        .enumerate()
        .map(|(i, trajectory)| RecordedFlight { participant: &people[i % 6], trajectory })
        .collect();
    let options = IntentOptions { epochs: 20, ..small_intent() };
    let job = bench.job(4, 2, None);
    let mut silent = |_: &_| ControlFlow::Continue(());
    let first = train_intent_from(&job, &recorded, &options, None, &mut silent).unwrap();
    assert_eq!((first.learnt_from.len(), first.held_out.len()), (4, 2));
    assert!(first.held_out.iter().all(|name| !first.learnt_from.contains(name)));
    assert!(first.scores[2].all.accuracy > 0.8 && first.before.is_none(), "{:?}", first.scores[2].all);
    let on = train_intent_from(&job, &recorded, &options, Some(&first.model), &mut silent).unwrap();
    assert_eq!(on.before, Some(first.scores));
    let alone = &recorded[..1];
    let refused = train_intent_from(&job, alone, &options, None, &mut silent).unwrap_err().to_string();
    assert!(refused.contains("1 participants"), "{refused}");
}

#[test]
fn live_learning_gives_a_new_model_after_every_episode_and_the_same_ones_again() {
    BENCHES.iter().for_each(|bench| learns_live(&bench()));
}

fn learns_live(bench: &Bench) {
    let shipped = values(bench, &small(), 1, 2, None);
    let mut models = Models::new();
    models.add_model(shipped.clone());
    let recorded = flights(bench, &models, Inference::Nearest, 0..3);
    let options = LiveOptions { own_steps: 300, ..LiveOptions::default() };
    let learn = || {
        let mut learner = LiveLearner::new(&bench.plants, &shipped, options, 9).unwrap();
        let models: Vec<Model> = recorded.iter().map(|flight| learner.learn(flight).unwrap()).collect();
        assert_eq!(learner.episodes(), 3);
        models
    };
    let (first, again) = (learn(), learn());
    let hashes = |models: &[Model]| models.iter().map(|model| model.hash().to_owned()).collect::<Vec<_>>();
    assert_eq!(hashes(&first), hashes(&again));
    assert!(first[0].hash() != shipped.hash() && first[1].hash() != first[0].hash());
    assert_eq!(first[2].card().median_range, shipped.card().median_range);
    let after = evaluate(&bench.job(1, 1, None), &first[2], 7, 50).unwrap();
    assert!(after.landed > 0.95, "{after:?}");
}
