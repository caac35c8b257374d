//! The ground: a chain of straight edges that never moves.

use std::sync::Arc;

use super::body::SCALE;
use super::shape::Edge;
use super::tuning::{BOX_MARGIN, SKIN};
use super::vector::{Aabb, vec2};

/// Width of Gymnasium's world, in world units.
pub const WORLD_WIDTH: f64 = 600.0 / SCALE;
/// Friction of Gymnasium's moon. A contact's friction is the geometric mean of both bodies'.
const MOON_FRICTION: f32 = 0.1;
/// Friction of the base line under Gymnasium's moon, which takes Box2D's default.
const BASE_FRICTION: f32 = 0.2;
/// Coordinates beyond this would lose the precision that contacts need.
const MAX_COORDINATE: f64 = 1000.0;
/// Shorter edges have no reliable normal.
const MIN_RUN: f64 = 0.01;

/// What the craft stands on: a chain of straight edges that never moves. Cheap to clone (shared).
#[derive(Clone, Debug, PartialEq)]
pub struct Ground(Arc<[Edge]>);

/// Why a list of vertices is no ground.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum GroundError {
    /// Fewer than two vertices.
    #[error("a ground needs at least 2 vertices, {0} given")]
    TooFewVertices(usize),
    /// A coordinate is not finite or beyond ±1000 world units.
    #[error("vertex {index} is ({x}, {y}): coordinates must be finite and within ±1000 world units")]
    OutOfRange {
        /// Position of the vertex in the list.
        index: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
    },
    /// Vertices must go from left to right, at least 0.01 units apart.
    #[error(
        "vertex {index} lies less than 0.01 units to the right of the one before it: list the vertices from left to right"
    )]
    NotRightwards {
        /// Position of the vertex in the list.
        index: usize,
    },
}

impl Ground {
    /// Edges between neighbouring vertices `[x, y]` (world units), which must go from left to right.
    /// Friction is that of Gymnasium's moon (0.1).
    pub fn polyline(vertices: &[[f64; 2]]) -> Result<Ground, GroundError> {
        if vertices.len() < 2 {
            return Err(GroundError::TooFewVertices(vertices.len()));
        }
        for (index, [x, y]) in vertices.iter().copied().enumerate() {
            // Written so that NaN is refused too.
            if !(x.abs() <= MAX_COORDINATE && y.abs() <= MAX_COORDINATE) {
                return Err(GroundError::OutOfRange { index, x, y });
            }
            if index > 0 && x - vertices[index - 1][0] < MIN_RUN {
                return Err(GroundError::NotRightwards { index });
            }
        }
        Ok(Ground(chain(vertices).collect()))
    }

    /// Gymnasium's moon: its base line at y = 0 and ten edges over eleven smoothed `heights` (world units), evenly spaced over
    /// [`WORLD_WIDTH`].
    pub fn gymnasium(heights: &[f64; 11]) -> Ground {
        let mut vertices = [[0.0; 2]; 11];
        for (index, vertex) in vertices.iter_mut().enumerate() {
            *vertex = [WORLD_WIDTH / 10.0 * index as f64, heights[index]];
        }
        let base = edge([0.0, 0.0], [WORLD_WIDTH, 0.0], BASE_FRICTION);
        Ground(std::iter::once(base).chain(chain(&vertices)).collect())
    }

    /// Left to right; Gymnasium's base line first.
    pub(crate) fn edges(&self) -> &[Edge] {
        &self.0
    }
}

fn chain(vertices: &[[f64; 2]]) -> impl Iterator<Item = Edge> + '_ {
    vertices.windows(2).map(|pair| edge(pair[0], pair[1], MOON_FRICTION))
}

fn edge(from: [f64; 2], to: [f64; 2], friction: f32) -> Edge {
    let [from, to] = [from, to].map(|[x, y]| vec2(x as f32, y as f32));
    Edge { from, to, friction, aabb: Aabb::around([from, to], SKIN).widened(BOX_MARGIN) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_needs_two_vertices_from_left_to_right_within_range() {
        assert_eq!(Ground::polyline(&[[0.0, 1.0]]), Err(GroundError::TooFewVertices(1)));
        assert_eq!(
            Ground::polyline(&[[0.0, 1.0], [1.0, 1.0], [1.0, 2.0]]),
            Err(GroundError::NotRightwards { index: 2 })
        );
        for bad in [f64::NAN, f64::INFINITY, 1001.0] {
            let refused = Ground::polyline(&[[0.0, 1.0], [5.0, bad]]);
            assert!(matches!(refused, Err(GroundError::OutOfRange { index: 1, .. })), "{bad}");
        }
        assert_eq!(
            Ground::polyline(&[[0.0, 1.0], [5.0, 1.0], [9.0, 2.0]]).map(|ground| ground.edges().len()),
            Ok(2)
        );
    }
}
