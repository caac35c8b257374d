//! A network as a value model.

use crate::card::Card;
use crate::encode::ValueEncoder;
use crate::model::ValueNetwork;
use crate::outputs::Outputs;
use crate::search::Search;
use cohelm::action::Action;
use cohelm::plant::View;
use cohelm::value::{ActionValues, ValueModel};
use cohelm_nn::critic::Critic;
use cohelm_nn::mlp::{Mlp, MlpScratch};
use std::sync::Arc;

/// Q(s, a) from a network: of every command, or of candidate actions on axes.
///
/// Finite states and bounded weights give finite values. Should they ever not (a network deep enough to overflow), it
/// has no opinion at that tick: all values are equal, and every rule of minimal intervention lets the person through.
#[derive(Clone, Debug)]
pub struct NetworkValues(Estimator);

#[derive(Clone, Debug)]
enum Estimator {
    Commands(Box<OfCommands>),
    Axes(Box<OfAxes>),
}

impl NetworkValues {
    /// A network with the card it came with; `None` if it does not fit the card's space. Widths are those that
    /// [`Model`](crate::model::Model) checked.
    pub fn new(card: &Card, network: ValueNetwork) -> Option<Self> {
        Some(Self(match network {
            ValueNetwork::Commands(network) => Estimator::Commands(Box::new(OfCommands::new(card, network)?)),
            ValueNetwork::Axes(critic) => Estimator::Axes(Box::new(OfAxes::new(card, critic)?)),
        }))
    }
}

impl ValueModel for NetworkValues {
    fn estimate(&mut self, view: &View<'_>, goal: usize, asked: Option<Action>) -> &ActionValues {
        match &mut self.0 {
            Estimator::Commands(values) => values.estimate(view, goal, asked),
            Estimator::Axes(values) => values.estimate(view, goal, asked),
        }
    }

    fn assess(
        &mut self,
        view: &View<'_>,
        goal: usize,
        actions: &[Action],
        asked: Option<Action>,
        values: &mut Vec<f32>,
    ) {
        match &mut self.0 {
            Estimator::Commands(model) => {
                model.value_commands(view, goal, asked);
                values.clear();
                let value = |command: usize| model.of_commands.get(command).copied();
                values.extend(actions.iter().map(|action| action.command().and_then(value).unwrap_or(0.0)));
            }
            Estimator::Axes(model) => model.assess(view, goal, actions, values),
        }
    }
}

/// Of every command, from one forward pass.
#[derive(Clone, Debug)]
struct OfCommands {
    network: Arc<Mlp>,
    encoder: ValueEncoder,
    outputs: Outputs,
    scratch: MlpScratch,
    input: Vec<f32>,
    of_commands: Vec<f32>,
    values: ActionValues,
}

impl OfCommands {
    fn new(card: &Card, network: Arc<Mlp>) -> Option<Self> {
        let outputs = card.outputs()?;
        let commands = outputs.commands();
        let encoder = ValueEncoder::new(card.state, if card.sees_asked { commands } else { 0 });
        let candidates = (0..commands).map(|command| Action::Command(command as u8)).collect();
        Some(Self {
            scratch: MlpScratch::new(network.shape()),
            network,
            input: vec![0.0; encoder.len()],
            encoder,
            outputs,
            of_commands: vec![0.0; commands],
            values: ActionValues::equal(candidates).ok()?,
        })
    }

    /// Q of every command; zeros if one of them is not finite.
    fn value_commands(&mut self, view: &View<'_>, goal: usize, asked: Option<Action>) {
        self.encoder.encode(view, goal, asked, &mut self.input);
        let outputs = self.network.forward(&self.input, &mut self.scratch);
        for (command, value) in self.of_commands.iter_mut().enumerate() {
            *value = outputs[self.outputs.output(command, view.switches)];
        }
        if !self.of_commands.iter().all(|value| value.is_finite()) {
            self.of_commands.fill(0.0);
        }
    }

    fn estimate(&mut self, view: &View<'_>, goal: usize, asked: Option<Action>) -> &ActionValues {
        self.value_commands(view, goal, asked);
        let filled = self.values.refill(&self.of_commands);
        debug_assert!(filled.is_ok(), "what is not finite was made zero");
        &self.values
    }
}

/// Of candidate actions on axes, from a critic.
#[derive(Clone, Debug)]
struct OfAxes {
    critic: Arc<Critic>,
    encoder: ValueEncoder,
    input: Vec<f32>,
    search: Search,
}

impl OfAxes {
    fn new(card: &Card, critic: Arc<Critic>) -> Option<Self> {
        let encoder = ValueEncoder::new(card.state, 0);
        let search = Search::new(&card.space, &critic)?;
        Some(Self { critic, input: vec![0.0; encoder.len()], encoder, search })
    }

    fn estimate(&mut self, view: &View<'_>, goal: usize, asked: Option<Action>) -> &ActionValues {
        self.encoder.encode(view, goal, None, &mut self.input);
        self.search.estimate(&self.critic, &self.input, asked)
    }

    fn assess(&mut self, view: &View<'_>, goal: usize, actions: &[Action], values: &mut Vec<f32>) {
        self.encoder.encode(view, goal, None, &mut self.input);
        self.search.assess(&self.critic, &self.input, actions, values);
    }
}
