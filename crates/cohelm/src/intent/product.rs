//! Two inferences multiplied.

use super::{Belief, IntentModel, MAX_GOALS};
use crate::action::Action;
use crate::plant::View;

/// The product of two beliefs, normalised: right where both see different evidence, too sure where they see the same.
pub struct Product {
    first: Box<dyn IntentModel>,
    second: Box<dyn IntentModel>,
}

impl Product {
    /// Of two inferences, each of which sees everything.
    pub fn new(first: Box<dyn IntentModel>, second: Box<dyn IntentModel>) -> Self {
        Self { first, second }
    }
}

impl IntentModel for Product {
    fn begin(&mut self) {
        self.first.begin();
        self.second.begin();
    }

    /// Where the two exclude each other (a sum of 0), or agree that nothing is known, the first has the say.
    fn infer(&mut self, view: &View<'_>, asked: Option<Action>) -> Belief {
        let (first, second) = (self.first.infer(view, asked), self.second.infer(view, asked));
        let mut product = [0.0_f32; MAX_GOALS];
        let product = &mut product[..first.probabilities().len()];
        for (p, (a, b)) in product.iter_mut().zip(first.probabilities().iter().zip(second.probabilities())) {
            *p = a * b;
        }
        let sum: f32 = product.iter().sum();
        if !(sum.is_finite() && sum > 0.0) || first.imagined_goal().is_some() {
            return first;
        }
        product.iter_mut().for_each(|p| *p /= sum);
        let mut belief = Belief::from_probabilities(product);
        if belief.confidence == 0.0 {
            belief.goal = first.goal;
        }
        belief
    }
}
