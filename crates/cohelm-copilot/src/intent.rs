//! Networks as an intent model.

use crate::card::Card;
use crate::encode::IntentEncoder;
use crate::model::IntentNetworks;
use cohelm::action::Action;
use cohelm::intent::{Belief, Head, IntentModel};
use cohelm::plant::View;
use cohelm_nn::goal_head::LN_SIGMA_MOST;
use cohelm_nn::lstm::{Lstm, LstmState};
use cohelm_nn::math::exp;
use std::sync::Arc;

/// Infers the pilot's goal with a recurrent network that ticks before the decisions at ticks 4, 8, 12, …; before the
/// first of them nothing is known and the nearest goal is taken.
///
/// It gets what every co-pilot gets, a [`View`] and what is asked: the pilot's goal is in neither.
#[derive(Clone, Debug)]
pub struct NetworkIntent {
    networks: Arc<IntentNetworks>,
    head: Head,
    encoder: IntentEncoder,
    state: LstmState,
    input: Vec<f32>,
    prediction: Option<Prediction>,
}

/// What a network says of the pilot's goal.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Prediction {
    position: [f32; 2],
    /// Standard deviation; 1 where the network gives none.
    spread: f32,
}

impl NetworkIntent {
    /// Networks with the card they came with, read by a head; `None` if the card's space has no actions.
    pub fn new(card: &Card, networks: Arc<IntentNetworks>, head: Head) -> Option<Self> {
        let encoder = IntentEncoder::new(&card.space, card.state, card.goals)?;
        let state = LstmState::new(network(&networks, head).shape());
        let input = vec![0.0; encoder.with_goals()];
        Some(Self { networks, head, encoder, state, input, prediction: None })
    }

    fn tick(&mut self, view: &View<'_>) {
        self.encoder.encode(view, &mut self.input);
        let network = network(&self.networks, self.head);
        let outputs = network.step(&self.input[..network.shape().input()], &mut self.state);
        let spread = outputs.get(2).map_or(1.0, |&ln| exp(ln.clamp(-LN_SIGMA_MOST, LN_SIGMA_MOST)));
        self.prediction = Some(Prediction { position: [outputs[0], outputs[1]], spread });
    }
}

impl IntentModel for NetworkIntent {
    fn begin(&mut self) {
        self.encoder.begin();
        self.state.reset();
        self.prediction = None;
    }

    fn infer(&mut self, view: &View<'_>, asked: Option<Action>) -> Belief {
        if IntentEncoder::is_due(view.tick) {
            self.tick(view);
        }
        self.encoder.note(asked);
        match self.prediction {
            Some(Prediction { position, spread }) => self.head.belief(view.goals, position, spread),
            None => Belief::unknown(view.goals.len(), view.nearest_goal()),
        }
    }
}

/// Imagines a goal where a network that knows no goals expects it. c = 1 − σ/σ₀: how much narrower the network's spread is
/// than that of somebody who knows nothing ([`Card::goal_spread`]).
///
/// It needs a cockpit with hidden goals; whatever goals a view holds, it looks at none.
#[derive(Clone, Debug)]
pub struct ImaginedIntent {
    network: NetworkIntent,
    usual_spread: f32,
}

impl ImaginedIntent {
    /// Networks with the card they came with; `None` if the card's space has no commands or its networks know goals.
    pub fn new(card: &Card, networks: Arc<IntentNetworks>) -> Option<Self> {
        let usual_spread = card.goal_spread.filter(|spread| *spread > 0.0 && card.goals == 0)? as f32;
        Some(Self { network: NetworkIntent::new(card, networks, Head::Calibrated)?, usual_spread })
    }
}

impl IntentModel for ImaginedIntent {
    fn begin(&mut self) {
        self.network.begin();
    }

    fn infer(&mut self, view: &View<'_>, asked: Option<Action>) -> Belief {
        let view = View { goals: &[], ..*view };
        let nothing = self.network.infer(&view, asked);
        self.network.prediction.map_or(nothing, |Prediction { position, spread }| {
            Belief::imagined(position, 1.0 - spread / self.usual_spread)
        })
    }
}

/// The network that a head reads.
fn network(networks: &IntentNetworks, head: Head) -> &Lstm {
    match head {
        Head::InverseDistance | Head::Softmax => &networks.regression,
        Head::Calibrated => &networks.calibrated,
    }
}
