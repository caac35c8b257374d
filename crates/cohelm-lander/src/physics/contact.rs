//! A pair of ground edge and body whose wide boxes overlap; it may or may not touch.

use super::body::{Body, Part};
use super::manifold::{Manifold, collide};
use super::shape::Edge;

/// Lives while the boxes overlap.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Contact {
    /// Index of the edge in the ground.
    pub edge: usize,
    /// Index of the body.
    pub body: usize,
    pub manifold: Manifold,
    pub touching: bool,
    /// Cleared for the rest of a step when a predicted impact turned out not to touch.
    pub enabled: bool,
}

/// What became of a contact when it was looked at again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Change {
    None,
    Began,
    Ended,
}

impl Contact {
    pub fn new(edge: usize, body: usize) -> Contact {
        Contact { edge, body, manifold: Manifold::EMPTY, touching: false, enabled: true }
    }

    /// Finds the points of contact anew; impulses of points that stay are kept. A change wakes the body.
    pub fn update(&mut self, edge: &Edge, part: &Part, body: &mut Body) -> Change {
        let old = self.manifold;
        self.enabled = true;
        self.manifold = collide(edge, &part.shape, body.place);
        self.manifold.warm_up_from(&old);
        let was_touching = std::mem::replace(&mut self.touching, self.manifold.touching());
        if was_touching == self.touching {
            return Change::None;
        }
        body.wake();
        if self.touching { Change::Began } else { Change::Ended }
    }
}
