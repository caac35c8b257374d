//! Shared control on axes, with a critic of random weights: what the person is promised.

mod made;

use cohelm::action::{Action, ActionSpace};
use cohelm::arbitration::{Arbiter, Rule};
use cohelm::cockpit::Cockpit;
use cohelm::intent::{Belief, IntentModel};
use cohelm::pilot::Recorded;
use cohelm::plant::{Plant, View};
use cohelm::value::ValueModel;
use cohelm_copilot::model::ValueNetwork;
use cohelm_copilot::search::CANDIDATES;
use cohelm_copilot::values::NetworkValues;
use cohelm_copilot::{Model, ModelError, Network};
use cohelm_nn::critic::Critic;
use proptest::prelude::*;

/// Believes in the first goal, as much as it is told.
struct Sure(f32);

impl IntentModel for Sure {
    fn begin(&mut self) {}

    fn infer(&mut self, view: &View<'_>, _asked: Option<Action>) -> Belief {
        let mut belief = Belief::unknown(view.goals.len(), 0);
        belief.confidence = self.0;
        belief
    }
}

fn values(seed: u64) -> NetworkValues {
    let model = made::values_on_axes(seed);
    let Network::Values(network) = model.network() else { panic!("a value model") };
    NetworkValues::new(model.card(), network.clone()).unwrap()
}

fn lander(seed: u64) -> Box<dyn Plant> {
    let mut plant = made::plants().make(&made::axes_task()).unwrap();
    plant.reset(seed);
    plant
}

/// A critic whose weights are all 0: every action is worth the same.
fn no_opinion() -> NetworkValues {
    let card = made::card(cohelm_copilot::Kind::Values, &made::axes_task());
    let Network::Values(ValueNetwork::Axes(critic)) = made::values_on_axes(0).network().clone() else {
        panic!("a critic")
    };
    let zeros = Critic::zeros(critic.shape());
    NetworkValues::new(&card, (&zeros).into()).unwrap()
}

/// What is carried out at the first tick of an episode.
fn executed(rule: Rule, confidence: f32, seed: u64, asked: Option<Action>) -> Option<Action> {
    executed_by(values(seed), rule, confidence, seed, asked)
}

fn executed_by(
    values: NetworkValues,
    rule: Rule,
    confidence: f32,
    seed: u64,
    asked: Option<Action>,
) -> Option<Action> {
    let arbiter: Box<dyn Arbiter> = rule.arbiter(0.05).unwrap();
    let mut cockpit = Cockpit::new(Box::new(Sure(confidence)), Box::new(values), arbiter);
    cockpit.begin();
    cockpit.tick(lander(seed).as_mut(), &mut Recorded::new(&[asked])).executed
}

fn bits(action: Action) -> [u32; 4] {
    core::array::from_fn(|axis| action.axis(axis).to_bits())
}

fn pushes() -> impl Strategy<Value = Action> {
    // Also what a stick at rest and keys give: the middle, with either sign of zero, and the ends.
    let axis = prop_oneof![-1.0_f32..=1.0, prop::sample::select(vec![-1.0, -0.0, 0.0, 1.0])];
    (axis.clone(), axis).prop_map(|(main, side)| Action::axes(&[main, side]))
}

fn distance(a: Action, b: Action) -> f32 {
    (a.axis(0) - b.axis(0)).hypot(a.axis(1) - b.axis(1))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_is_asked_is_the_first_candidate_bit_for_bit_and_all_are_within_bounds(seed in 0_u64..20, asked in pushes()) {
        let plant = lander(seed);
        let mut values = values(seed);
        let estimate = values.estimate(&plant.view(), 1, Some(asked));
        prop_assert_eq!(estimate.candidates().len(), CANDIDATES);
        prop_assert_eq!(bits(estimate.candidates()[0]), bits(asked));
        prop_assert!(estimate.candidates().iter().all(|&action| plant.space().contains(action)));
    }

    #[test]
    fn without_confidence_the_person_flies_bit_for_bit(seed in 0_u64..20, asked in pushes()) {
        for rule in [Rule::Misc, Rule::Lasc, Rule::Tolerance { alpha: 1.0 }, Rule::MiscR { kappa: 1e6 }] {
            prop_assert_eq!(executed(rule, 0.0, seed, Some(asked)).map(bits), Some(bits(asked)), "{:?}", rule);
        }
    }

    #[test]
    fn what_is_carried_out_is_within_bounds_and_moves_away_from_the_person_with_confidence(
        seed in 0_u64..20,
        asked in pushes(),
        confidence in 0.0_f32..=1.0,
        more in 0.0_f32..=1.0,
    ) {
        let plant = lander(seed);
        for rule in [Rule::Misc, Rule::Lasc] {
            let moved = |c: f32| executed(rule, c, seed, Some(asked)).unwrap();
            let (low, high) = (moved(confidence.min(more)), moved(confidence.max(more)));
            prop_assert!(plant.space().contains(low) && plant.space().contains(high));
            prop_assert!(distance(low, asked) <= distance(high, asked) + 1e-6, "{:?}: {:?} {:?}", rule, low, high);
        }
    }

    #[test]
    fn a_sure_co_pilot_and_a_silent_person_get_the_best_candidate(seed in 0_u64..20, asked in pushes()) {
        let plant = lander(seed);
        let mut model = values(seed);
        for asked in [None, Some(asked)] {
            let estimate = model.estimate(&plant.view(), 0, asked);
            let best = estimate.candidates()[estimate.best()];
            prop_assert_eq!(executed(Rule::Misc, 1.0, seed, asked), Some(best));
            prop_assert!(distance(executed(Rule::Lasc, 1.0, seed, asked).unwrap(), best) < 1e-6);
        }
    }

    #[test]
    fn values_that_are_all_equal_let_the_person_through_bit_for_bit(
        seed in 0_u64..20,
        asked in pushes(),
        confidence in 0.0_f32..=1.0,
    ) {
        let rules = [
            Rule::Misc,
            Rule::Tolerance { alpha: 0.0 },
            Rule::MiscR { kappa: 0.0 },
            Rule::MiscH { kappa: 0.0, release: 0.5 },
            Rule::Ida,
        ];
        for rule in rules {
            let executed = executed_by(no_opinion(), rule, confidence, seed, Some(asked));
            prop_assert_eq!(executed.map(bits), Some(bits(asked)), "{:?}", rule);
        }
    }

    #[test]
    fn candidates_are_worth_the_same_whether_valued_together_or_one_by_one(
        seed in 0_u64..20,
        asked in pushes(),
        goal in 0_usize..3,
    ) {
        let plant = lander(seed);
        let mut model = values(seed);
        let estimate = model.estimate(&plant.view(), 0, Some(asked)).clone();
        let mut together = Vec::new();
        model.assess(&plant.view(), goal, estimate.candidates(), Some(asked), &mut together);
        prop_assert!(goal != 0 || together == estimate.values());
        let mut alone = Vec::new();
        for (&action, &value) in estimate.candidates().iter().zip(&together) {
            model.assess(&plant.view(), goal, &[action], Some(asked), &mut alone);
            prop_assert_eq!(&alone, &[value]);
        }
    }

    #[test]
    fn refining_never_finds_less_than_the_grid(seed in 0_u64..20, asked in pushes()) {
        let plant = lander(seed);
        let mut values = values(seed);
        let estimate = values.estimate(&plant.view(), 2, Some(asked)).clone();
        let grid = estimate.values()[1..65].iter().copied().fold(f32::NEG_INFINITY, f32::max);
        prop_assert!(estimate.values()[estimate.best()] >= grid);
    }
}

#[test]
fn a_model_on_axes_is_read_back_with_its_bits_and_refused_where_it_does_not_fit() {
    let model = made::values_on_axes(7);
    let again = Model::from_bytes(model.bytes()).unwrap();
    assert_eq!((again.hash(), again.card()), (model.hash(), model.card()));
    let Network::Values(network) = model.network() else { panic!("a value model") };
    let card = made::card(cohelm_copilot::Kind::Values, &made::axes_task());
    let refused = |change: &dyn Fn(&mut cohelm_copilot::Card)| {
        let mut card = card.clone();
        change(&mut card);
        Model::of_values(&card, network).unwrap_err()
    };
    assert!(matches!(refused(&|card| card.sees_asked = true), ModelError::Axes { .. }));
    assert!(matches!(refused(&|card| card.state += 1), ModelError::Shape { .. }));
    let one = ActionSpace::Axes { names: vec!["x".into()], low: vec![-1.0], high: vec![1.0] };
    assert!(matches!(refused(&|card| card.space = one.clone()), ModelError::Shape { .. }));
    let beyond = ActionSpace::Axes { names: vec!["x".into()], low: vec![1.0], high: vec![2.0] };
    assert!(matches!(refused(&|card| card.space = beyond.clone()), ModelError::Axes { .. }));
    assert!(matches!(
        refused(&|card| card.space = made::card(card.kind, &made::task()).space),
        ModelError::Weights(_)
    ));
}
