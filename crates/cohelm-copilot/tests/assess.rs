//! Given actions are valued as the candidates are, bit for bit, for every goal.

mod made;

use cohelm::action::Action;
use cohelm::plant::Plant;
use cohelm::point::Point;
use cohelm::value::ValueModel;
use cohelm_copilot::values::NetworkValues;
use cohelm_copilot::{Model, Network};

fn agrees(plant: &dyn Plant, model: &mut dyn ValueModel, asked: Option<Action>) {
    let view = plant.view();
    let mut values = vec![9.0; 3];
    for goal in 0..view.goals.len() {
        let estimate = model.estimate(&view, goal, asked).clone();
        model.assess(&view, goal, estimate.candidates(), asked, &mut values);
        assert_eq!(values, estimate.values(), "goal {goal}");
        let last = estimate.candidates().len() - 1;
        model.assess(&view, goal, &estimate.candidates()[last..], asked, &mut values);
        assert_eq!(values, estimate.values()[last..], "an action alone, goal {goal}");
    }
}

#[test]
fn a_network_values_given_commands_as_it_values_its_candidates() {
    let mut plant = made::plants().make(&made::task()).unwrap();
    for sees_asked in [false, true] {
        let card =
            cohelm_copilot::Card { sees_asked, ..made::card(cohelm_copilot::Kind::Values, &made::task()) };
        let network = made::values_network(&card, 4);
        let model = Model::of_values(&card, &network).unwrap();
        let mut values = NetworkValues::new(model.card(), (&network).into()).unwrap();
        for seed in 0..5 {
            plant.reset(seed);
            plant.step(Some(Action::Command(2)));
            agrees(plant.as_ref(), &mut values, (seed % 2 == 0).then_some(Action::Command(1)));
        }
    }
}

#[test]
fn a_critic_values_given_actions_as_it_values_its_candidates() {
    let model = made::values_on_axes(4);
    let Network::Values(network) = model.network() else { panic!("a value model") };
    let mut values = NetworkValues::new(model.card(), network.clone()).unwrap();
    let mut plant = made::plants().make(&made::axes_task()).unwrap();
    for seed in 0..5 {
        plant.reset(seed);
        plant.step(Some(Action::axes(&[0.5, -0.75])));
        agrees(plant.as_ref(), &mut values, (seed % 2 == 0).then_some(Action::axes(&[0.3, -0.1])));
    }
}

#[test]
fn hand_made_values_do_too() {
    let mut point = Point::new();
    for seed in 0..5 {
        point.reset(seed);
        point.step(Some(Action::axes(&[0.5, -0.25])));
        agrees(&point, (cohelm::point::entry().values.unwrap())().as_mut(), Some(Action::axes(&[0.3, 0.1])));
    }
}
