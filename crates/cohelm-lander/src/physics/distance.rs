//! Distance between an edge and a polygon by the algorithm of Gilbert, Johnson and Keerthi: walk a simplex of differences of
//! corners towards the origin.

use super::shape::Edge;
use super::vector::{Transform, Vec2};

/// Support points that one query may try.
const MAX_ITERATIONS: u32 = 20;

/// The corners of the polygon that is measured, and of the edge.
#[derive(Clone, Copy)]
pub(crate) struct Pair<'a> {
    pub edge: &'a Edge,
    pub corners: &'a [Vec2],
}

/// Corners that were closest in one query: a good beginning for the next.
#[derive(Clone, Copy, Default)]
pub(crate) struct SimplexCache {
    metric: f32,
    count: usize,
    /// Index of the edge's end, index of the polygon's corner.
    pub indices: [[usize; 2]; 3],
}

impl SimplexCache {
    /// The corners that were closest: one or two.
    pub fn closest(&self) -> &[[usize; 2]] {
        &self.indices[..self.count]
    }
}

#[derive(Clone, Copy)]
struct SimplexVertex {
    on_edge: Vec2,
    on_polygon: Vec2,
    /// `on_polygon` − `on_edge`.
    difference: Vec2,
    /// Barycentric weight of the closest point.
    weight: f32,
    indices: [usize; 2],
}

struct Simplex {
    vertices: [SimplexVertex; 3],
    count: usize,
}

impl<'a> Pair<'a> {
    pub fn edge_end(&self, index: usize) -> Vec2 {
        if index == 0 { self.edge.from } else { self.edge.to }
    }

    /// The end of the edge furthest in this direction.
    pub fn edge_support(&self, direction: Vec2) -> usize {
        usize::from(self.edge.to.dot(direction) > self.edge.from.dot(direction))
    }

    /// The polygon's corner furthest in this direction (in its own frame).
    pub fn corner_support(&self, direction: Vec2) -> usize {
        let mut best = (self.corners[0].dot(direction), 0);
        for (index, corner) in self.corners.iter().enumerate().skip(1) {
            let value = corner.dot(direction);
            if value > best.0 {
                best = (value, index);
            }
        }
        best.1
    }

    fn vertex(&self, indices: [usize; 2], place: Transform) -> SimplexVertex {
        let on_edge = self.edge_end(indices[0]);
        let on_polygon = place.apply(self.corners[indices[1]]);
        SimplexVertex { on_edge, on_polygon, difference: on_polygon - on_edge, weight: 0.0, indices }
    }

    /// Distance of edge and polygon without their skins; 0 when they overlap. `cache` is read and written.
    pub fn distance(&self, place: Transform, cache: &mut SimplexCache) -> f32 {
        let mut simplex = Simplex::from_cache(self, place, cache);
        for _ in 0..MAX_ITERATIONS {
            let known = simplex.vertices.map(|vertex| vertex.indices);
            let known = &known[..simplex.count];
            simplex.reduce();
            if simplex.count == 3 {
                break;
            }
            let direction = simplex.towards_origin();
            if direction.length_squared() < f32::EPSILON * f32::EPSILON {
                break;
            }
            let end = self.edge_support(-direction);
            let corner = self.corner_support(place.rotation.apply_inverse(direction));
            let vertex = self.vertex([end, corner], place);
            // The new vertex is written even when it is known already, as in the reference; it is not counted then.
            simplex.vertices[simplex.count] = vertex;
            if known.contains(&vertex.indices) {
                break;
            }
            simplex.count += 1;
        }
        let [on_edge, on_polygon] = simplex.witnesses();
        simplex.write_cache(cache);
        (on_edge - on_polygon).length()
    }
}

impl Simplex {
    fn from_cache(pair: &Pair, place: Transform, cache: &SimplexCache) -> Simplex {
        let vertices = cache.indices.map(|indices| pair.vertex(indices, place));
        let mut simplex = Simplex { vertices, count: cache.count };
        if simplex.count > 1 {
            let (old, new) = (cache.metric, simplex.metric());
            if new < 0.5 * old || 2.0 * old < new || new < f32::EPSILON {
                simplex.count = 0;
            }
        }
        if simplex.count == 0 {
            simplex.vertices[0] = pair.vertex([0, 0], place);
            simplex.count = 1;
        }
        simplex
    }

    fn write_cache(&self, cache: &mut SimplexCache) {
        cache.metric = self.metric();
        cache.count = self.count;
        cache.indices = self.vertices.map(|vertex| vertex.indices);
    }

    /// Length or area: how far a cached simplex may have changed before it is thrown away.
    fn metric(&self) -> f32 {
        let [a, b, c] = self.vertices.map(|vertex| vertex.difference);
        match self.count {
            2 => (a - b).length(),
            3 => (b - a).cross(c - a),
            _ => 0.0,
        }
    }

    fn towards_origin(&self) -> Vec2 {
        let [a, b, _] = self.vertices.map(|vertex| vertex.difference);
        if self.count == 1 {
            return -a;
        }
        let along = b - a;
        if along.cross(-a) > 0.0 { -along.turned_right() } else { along.turned_right() }
    }

    /// The closest points on edge and polygon.
    fn witnesses(&self) -> [Vec2; 2] {
        let [a, b, c] = &self.vertices;
        match self.count {
            1 => [a.on_edge, a.on_polygon],
            2 => [
                a.weight * a.on_edge + b.weight * b.on_edge,
                a.weight * a.on_polygon + b.weight * b.on_polygon,
            ],
            _ => {
                let inside = a.weight * a.on_edge + b.weight * b.on_edge + c.weight * c.on_edge;
                [inside, inside]
            }
        }
    }

    /// Keeps the part of the simplex that is closest to the origin.
    fn reduce(&mut self) {
        match self.count {
            2 => self.reduce_segment(),
            3 => self.reduce_triangle(),
            _ => {}
        }
    }

    /// Keeps these vertices, weighted.
    fn keep<const N: usize>(&mut self, kept: [(usize, f32); N]) {
        let old = self.vertices;
        for (place, (index, weight)) in kept.into_iter().enumerate() {
            self.vertices[place] = SimplexVertex { weight, ..old[index] };
        }
        self.count = N;
    }

    /// Keeps two vertices, given the unnormalised weights of the closest point between them.
    fn keep_segment(&mut self, (first, second): (usize, usize), weights: [f32; 2]) {
        let inverse = 1.0 / (weights[0] + weights[1]);
        self.keep([(first, weights[0] * inverse), (second, weights[1] * inverse)]);
    }

    /// Unnormalised weights of the point of the line through two vertices that is closest to the origin.
    fn line_weights(&self, first: usize, second: usize) -> [f32; 2] {
        let (a, b) = (self.vertices[first].difference, self.vertices[second].difference);
        let along = b - a;
        [b.dot(along), -a.dot(along)]
    }

    fn reduce_segment(&mut self) {
        let [w1, w2] = self.line_weights(0, 1);
        if w2 <= 0.0 {
            self.keep([(0, 1.0)]);
        } else if w1 <= 0.0 {
            self.keep([(1, 1.0)]);
        } else {
            self.keep_segment((0, 1), [w1, w2]);
        }
    }

    fn reduce_triangle(&mut self) {
        let [a, b, c] = self.vertices.map(|vertex| vertex.difference);
        let [ab1, ab2] = self.line_weights(0, 1);
        let [ac1, ac2] = self.line_weights(0, 2);
        let [bc1, bc2] = self.line_weights(1, 2);
        let area = (b - a).cross(c - a);
        let [abc1, abc2, abc3] = [area * b.cross(c), area * c.cross(a), area * a.cross(b)];
        if ab2 <= 0.0 && ac2 <= 0.0 {
            self.keep([(0, 1.0)]);
        } else if ab1 > 0.0 && ab2 > 0.0 && abc3 <= 0.0 {
            self.keep_segment((0, 1), [ab1, ab2]);
        } else if ac1 > 0.0 && ac2 > 0.0 && abc2 <= 0.0 {
            self.keep_segment((0, 2), [ac1, ac2]);
        } else if ab1 <= 0.0 && bc2 <= 0.0 {
            self.keep([(1, 1.0)]);
        } else if ac1 <= 0.0 && bc1 <= 0.0 {
            self.keep([(2, 1.0)]);
        } else if bc1 > 0.0 && bc2 > 0.0 && abc1 <= 0.0 {
            // The third vertex takes the first place, as in the reference.
            self.keep_segment((2, 1), [bc2, bc1]);
        } else {
            let inverse = 1.0 / (abc1 + abc2 + abc3);
            self.keep([(0, abc1 * inverse), (1, abc2 * inverse), (2, abc3 * inverse)]);
        }
    }
}
