//! Models as files, and cockpits that they fit or do not fit.

mod made;

use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::intent::Inference;
use cohelm::registry::Task;
use cohelm::trajectory::Setup;
use cohelm_copilot::{Card, CockpitError, Kind, Model, ModelError, Models, cockpit};
use proptest::prelude::*;

fn setup(task: Task, inference: Inference, values: Option<&Model>, intent: Option<&Model>) -> Setup {
    let hash = |model: &Model| model.hash().to_owned();
    Setup {
        plant_version: made::plants().entry(&task).unwrap().version,
        task,
        seed: 1,
        rule: Rule::Misc,
        inference,
        silence: Silence::Best,
        time_scale: 1.0,
        values: values.map(hash),
        intent: intent.map(hash),
        pilot: "test".into(),
    }
}

fn refusal(setup: &Setup, models: &[&Model]) -> CockpitError {
    let mut known = Models::new();
    for model in models {
        known.add_model((*model).clone());
    }
    let plant = made::plants().make(&setup.task).unwrap();
    cockpit(setup, plant.as_ref(), &made::plants(), &known).err().expect("must be refused")
}

#[test]
fn a_model_is_the_same_after_it_was_written_and_read() {
    for model in [made::values(1), made::intent(1)] {
        let again = Model::from_bytes(model.bytes()).unwrap();
        assert_eq!((again.hash(), again.card(), again.bytes()), (model.hash(), model.card(), model.bytes()));
        assert_eq!(model.hash().len(), 64);
    }
    assert_ne!(made::values(1).hash(), made::values(2).hash());
}

#[test]
fn a_cockpit_says_why_a_model_does_not_fit() {
    let (values, intent) = (made::values(1), made::intent(1));
    let lander = |inference, values, intent| setup(made::task(), inference, values, intent);
    let usual = || lander(Inference::Softmax, Some(&values), Some(&intent));

    assert!(matches!(refusal(&usual(), &[&values]), CockpitError::NoModel { kind: Kind::Intent, .. }));
    let none = lander(Inference::Softmax, Some(&values), None);
    assert!(matches!(refusal(&none, &[&values]), CockpitError::NoIntent { .. }));
    let imagined = lander(Inference::Imagined, Some(&values), Some(&intent));
    assert!(refusal(&imagined, &[&values, &intent]).to_string().contains("trained seeing the goals"));
    let unvalued = lander(Inference::Bayesian, None, None);
    assert!(matches!(refusal(&unvalued, &[]), CockpitError::NoValues { .. }));
    let swapped = lander(Inference::Softmax, Some(&intent), Some(&values));
    assert!(matches!(refusal(&swapped, &[&values, &intent]), CockpitError::WrongKind { .. }));
    let older = Setup { plant_version: 0, ..usual() };
    assert!(matches!(refusal(&older, &[&values, &intent]), CockpitError::SetupVersion { .. }));
    let levers = setup(made::task().with("actions", "main-side"), Inference::Nearest, Some(&values), None);
    let wrong = refusal(&levers, &[&values]);
    assert!(matches!(wrong, CockpitError::WrongShape { part: "action space", .. }), "{wrong}");
    let point = setup(Task::new("point"), Inference::Nearest, Some(&values), None);
    let wrong = refusal(&point, &[&values]).to_string();
    assert!(wrong.contains("flag-lander") && wrong.contains("point"), "{wrong}");
}

#[test]
fn a_model_of_another_version_of_the_plant_is_refused() {
    let card = Card { plant_version: 77, ..made::card(Kind::Values, &made::task()) };
    let model = Model::of_values(&card, &made::values_network(&card, 1)).unwrap();
    let wrong = refusal(&setup(made::task(), Inference::Nearest, Some(&model), None), &[&model]);
    assert!(matches!(wrong, CockpitError::PlantVersion { trained: 77, .. }), "{wrong}");
}

#[test]
fn misc_r_needs_the_median_range_of_the_card() {
    let card = Card { median_range: None, ..made::card(Kind::Values, &made::task()) };
    let model = Model::of_values(&card, &made::values_network(&card, 1)).unwrap();
    let setup = setup(made::task(), Inference::Nearest, Some(&model), None);
    let setup = Setup { rule: Rule::MiscR { kappa: 0.7 }, ..setup };
    assert!(matches!(refusal(&setup, &[&model]), CockpitError::Rule(_)));
}

#[test]
fn hand_made_values_fly_where_no_network_is_named() {
    let setup = setup(Task::new("point"), Inference::Known, None, None);
    let plant = made::plants().make(&setup.task).unwrap();
    assert!(cockpit(&setup, plant.as_ref(), &made::plants(), &Models::new()).is_ok());
}

#[test]
fn a_card_that_lies_about_its_networks_is_refused() {
    let card = made::card(Kind::Values, &made::task());
    let network = made::values_network(&card, 1);
    let lies = [
        Card { state: 12, ..card.clone() },
        Card { sees_asked: true, ..card.clone() },
        Card { free_outputs: true, ..card.clone() },
    ];
    for card in lies {
        assert!(matches!(Model::of_values(&card, &network), Err(ModelError::Shape { .. })));
    }
    let future = Card { encoder_version: 9, ..card.clone() };
    assert!(matches!(Model::of_values(&future, &network), Err(ModelError::EncoderVersion { found: 9, .. })));
    let mut wild = network;
    wild.params_mut()[0] = 1e9;
    assert!(matches!(Model::of_values(&card, &wild), Err(ModelError::Weight { .. })));
}

#[test]
fn variants_are_used_only_where_they_are_asked_for() {
    let plain = made::values(1);
    let card = Card { variant: Some("paper".into()), name: "other".into(), ..plain.card().clone() };
    let variant = Model::of_values(&card, &made::values_network(&card, 2)).unwrap();
    let (mut models, space) = (Models::new(), plain.card().space.clone());
    models.add_model(variant.clone());
    let newest =
        |models: &Models| models.newest_for(Kind::Values, &made::task(), &space).map(|m| m.hash().to_owned());
    assert_eq!(newest(&models).as_deref(), Some(variant.hash()), "better than none");
    models.add_model(plain.clone());
    models.add_model(variant.clone());
    assert_eq!(newest(&models).as_deref(), Some(plain.hash()));
    assert_eq!(models.named(Kind::Values, "other").map(Model::hash), Some(variant.hash()));
    assert_eq!(models.iter().count(), 2, "one that is there already moves");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn damaged_files_are_refused_or_read_but_never_a_panic(at in 0usize..4000, byte: u8, cut in 0usize..30_000) {
        let model = made::values(1);
        let mut bytes = model.bytes().to_vec();
        bytes[at] = byte;
        if let Ok(read) = Model::from_bytes(&bytes) {
            prop_assert!(read.hash() != model.hash() || bytes == model.bytes());
        }
        let cut = cut.min(model.bytes().len() - 1);
        prop_assert!(Model::from_bytes(&model.bytes()[..cut]).is_err());
    }
}

/// A plant that cannot be copied.
struct Uncopied(Box<dyn cohelm::plant::Plant>);

impl cohelm::plant::Plant for Uncopied {
    fn reset(&mut self, seed: u64) {
        self.0.reset(seed);
    }

    fn step(&mut self, executed: Option<cohelm::action::Action>) -> cohelm::plant::Step {
        self.0.step(executed)
    }

    fn view(&self) -> cohelm::plant::View<'_> {
        self.0.view()
    }

    fn pilot_goal(&self) -> usize {
        self.0.pilot_goal()
    }

    fn space(&self) -> &cohelm::action::ActionSpace {
        self.0.space()
    }

    fn scene(&self) -> cohelm::scene::Scene {
        self.0.scene()
    }

    fn poses(&self, poses: &mut Vec<cohelm::scene::Pose>) {
        self.0.poses(poses);
    }
}

#[test]
fn a_rule_that_looks_ahead_needs_a_plant_that_can_be_copied() {
    let setup = setup(Task::new("point"), Inference::Nearest, None, None);
    let setup = Setup { rule: Rule::SafeNearest { hold: 5, horizon: 30 }, ..setup };
    let plant = made::plants().make(&setup.task).unwrap();
    assert!(cockpit(&setup, plant.as_ref(), &made::plants(), &Models::new()).is_ok());
    let refused = cockpit(&setup, &Uncopied(plant), &made::plants(), &Models::new()).err().unwrap();
    assert_eq!(refused, CockpitError::NoCopy { rule: "safe-nearest", plant: "point".into() });
}
