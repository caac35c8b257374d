//! The page with networks: models are taken in once and found by their hash; the overlay tells how the rule decided.

#[path = "../examples/record_flights/random_models.rs"]
mod random_models;

use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::human::Population;
use cohelm::intent::Inference;
use cohelm::keys::Change;
use cohelm::registry::Task;
use cohelm::report::TickReport;
use cohelm::trajectory::Setup;
use cohelm_copilot::{Kind, Model};
use cohelm_page::branching::Hands;
use cohelm_page::fleet::plants;
use cohelm_page::page::Page;
use proptest::prelude::*;
use random_models::random_models;
use std::sync::LazyLock;

static MODELS: LazyLock<[Model; 2]> = LazyLock::new(|| {
    let task = Task::new("flag-lander");
    let version = plants().entry(&task).unwrap().version;
    random_models(&task, version, plants().make(&task).unwrap().as_ref()).unwrap().unwrap()
});

fn setup(rule: Rule, inference: Inference) -> Setup {
    let task = Task::new("flag-lander");
    Setup {
        plant_version: plants().entry(&task).unwrap().version,
        task,
        seed: 3,
        rule,
        inference,
        silence: Silence::Best,
        time_scale: 0.5,
        values: Some(MODELS[0].hash().into()),
        intent: inference.head().map(|_| MODELS[1].hash().into()),
        pilot: "person".into(),
    }
}

fn with_models() -> Page {
    let mut page = Page::new();
    for model in MODELS.iter() {
        page.add_model(model.bytes()).unwrap();
    }
    page
}

fn flown(page: &mut Page, setup: &Setup, ticks: u32) -> Vec<TickReport> {
    page.begin(&serde_json::to_vec(setup).unwrap()).unwrap();
    let mut reports = Vec::new();
    for tick in 0..ticks {
        let control = (tick / 24 % 3) as u8;
        let change = if tick % 24 < 15 { Change::Down(control) } else { Change::Up(control) };
        page.change(change, 0.0).unwrap();
        reports.extend(page.tick().unwrap());
    }
    reports
}

#[test]
fn a_model_is_named_by_the_hash_of_its_file() {
    let mut page = Page::new();
    let taken = page.add_model(MODELS[1].bytes()).unwrap();
    assert_eq!((taken.hash.as_str(), taken.kind), (MODELS[1].hash(), Kind::Intent));
    assert!(page.add_model(b"no model").unwrap_err().to_string().contains("this is no model"));
}

#[test]
fn a_flight_needs_its_models_and_so_does_its_record() {
    let setup = setup(Rule::Misc, Inference::Softmax);
    let bytes = serde_json::to_vec(&setup).unwrap();
    let missing = Page::new().begin(&bytes).unwrap_err().to_string();
    assert!(missing.contains(MODELS[0].hash()), "{missing}");
    let mut page = with_models();
    flown(&mut page, &setup, 60);
    let record = page.finish().unwrap();
    assert!(page.replay(&record).unwrap().identical);
    assert!(Page::new().replay(&record).is_err());
}

#[test]
fn intent_is_inferred_and_told() {
    let reports = flown(&mut with_models(), &setup(Rule::Hic, Inference::Calibrated), 30);
    assert_eq!(reports[3].belief.confidence, 0.0);
    assert!(reports[4].belief.confidence > 0.0);
    assert_eq!(reports[4].belief.probabilities.len(), reports[4].goals.len());
}

fn any_rule() -> impl Strategy<Value = Rule> {
    prop_oneof![
        Just(Rule::Misc),
        (0.0..=1.0).prop_map(|alpha| Rule::Tolerance { alpha }),
        (0.0..2.0).prop_map(|kappa| Rule::MiscR { kappa }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The threshold that the overlay draws is the one by which the rule decided.
    #[test]
    fn what_lies_above_the_threshold_is_what_is_allowed(rule in any_rule(), seed in 0_u64..1000) {
        let setup = Setup { seed, ..setup(rule, Inference::InverseDistance) };
        for report in flown(&mut with_models(), &setup, 80) {
            let threshold = report.threshold.unwrap();
            for candidate in report.candidates {
                let clear = (candidate.above_worst - threshold).abs() > 1e-9;
                prop_assert!(!clear || candidate.allowed == (candidate.above_worst > threshold));
            }
        }
    }

    /// Fuzz-like: whatever the bytes, a model is taken in or refused, and what was taken in flies.
    #[test]
    fn damaged_models_are_answered(position in 0_usize..200_000, value: u8, cut in 0_usize..4) {
        let mut bytes = MODELS[0].bytes().to_vec();
        let position = position % bytes.len();
        bytes[position] = value;
        bytes.truncate(bytes.len() - cut);
        let mut page = with_models();
        if let Ok(taken) = page.add_model(&bytes) {
            let mut setup = setup(Rule::Misc, Inference::Nearest);
            setup.values = Some(taken.hash);
            if page.begin(&serde_json::to_vec(&setup).unwrap()).is_ok() {
                prop_assert!(page.tick().unwrap().is_some());
            }
        }
    }
}

/// The lander's flight under a rule, watched, and what was reported while it was flown.
fn watched(rule: Rule, inference: Inference, ticks: u32) -> (Page, Vec<TickReport>) {
    let mut page = with_models();
    let reports = flown(&mut page, &setup(rule, inference), ticks);
    let record = page.finish().unwrap();
    page.watch(&record).unwrap();
    (page, reports)
}

fn branched(page: &mut Page, at: u32, rule: Rule, inference: Inference, pilot: Hands) -> Vec<TickReport> {
    let wish = serde_json::json!({
        "at": at, "rule": rule, "inference": inference, "pilot": pilot,
        "values": MODELS[0].hash(), "intent": MODELS[1].hash(),
    });
    page.branch(&serde_json::to_vec(&wish).unwrap()).unwrap();
    std::iter::from_fn(|| page.tick().unwrap()).collect()
}

#[test]
fn a_branch_of_the_same_networks_is_the_record_bit_for_bit() {
    let (rule, inference) = (Rule::Misc, Inference::Calibrated);
    let (mut page, reports) = watched(rule, inference, 120);
    let rest = branched(&mut page, 47, rule, inference, Hands::Recorded);
    assert!(rest.len() >= reports.len() - 47);
    for (branched, flown) in rest.iter().zip(&reports[47..]) {
        assert_eq!(serde_json::to_string(branched).unwrap(), serde_json::to_string(flown).unwrap());
    }
}

#[test]
fn human_alone_lets_recorded_keys_through_and_another_head_sees_what_came_before() {
    let (mut page, reports) = watched(Rule::Misc, Inference::Calibrated, 120);
    let rest = branched(&mut page, 47, Rule::Hic, Inference::Calibrated, Hands::Recorded);
    assert!(rest.iter().all(|tick| tick.executed == tick.asked));
    assert_eq!(rest[0].belief, reports[47].belief, "the intent was inferred from all 47 ticks before");
}

#[test]
fn who_takes_over_the_lander_lets_the_held_switch_go_first() {
    let (mut page, reports) = watched(Rule::Hic, Inference::Calibrated, 60);
    let held = reports[29].asked.clone().unwrap();
    assert_eq!(held.command, Some(2), "switch 1 is held on");
    let rest = branched(&mut page, 30, Rule::Hic, Inference::Calibrated, Hands::Nobody);
    assert_eq!(rest[0].executed.as_ref().and_then(|action| action.command), Some(3), "and is turned off");
    assert!(rest[1..].iter().all(|tick| tick.asked.is_none()));
}

#[test]
fn a_simulated_person_takes_over_after_a_reaction_time_and_the_same_one_does_the_same() {
    let (mut page, _) = watched(Rule::Hic, Inference::Calibrated, 60);
    assert_eq!(page.pilots().unwrap(), Hands::all());
    let person = |population| Hands::Person { population, person: 0 };
    let mut asked = |hands| -> Vec<_> {
        let rest = branched(&mut page, 30, Rule::Hic, Inference::Calibrated, hands);
        rest.into_iter().map(|tick| tick.asked).collect()
    };
    let first = asked(person(Population::Ordinary));
    assert!(first[1..8].iter().all(Option::is_none) && first.iter().flatten().count() > 3);
    assert_eq!(asked(person(Population::Ordinary)), first);
    assert_ne!(asked(person(Population::Slow)), first);
}
