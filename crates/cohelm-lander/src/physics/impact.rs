//! Time of impact: when, within a step, does a moving polygon come within a target distance of an edge?
//!
//! Conservative advancement: take the closest features, follow their separation in time until it reaches the target, look
//! again for the closest features there.

use super::body::Sweep;
use super::distance::{Pair, SimplexCache};
use super::tuning::{LINEAR_SLOP, MAX_POLYGON_CORNERS, SKIN};
use super::vector::{Transform, Vec2};

const MAX_AXES: u32 = 20;
const MAX_ROOT_STEPS: u32 = 50;
/// Separation at which shapes count as just touching, so that the solver afterwards finds them in contact.
const TARGET: f32 = {
    let beneath_skins = (SKIN + SKIN) - 3.0 * LINEAR_SLOP;
    if LINEAR_SLOP > beneath_skins { LINEAR_SLOP } else { beneath_skins }
};
const TOLERANCE: f32 = 0.25 * LINEAR_SLOP;

/// The share of the sweep after which the two touch. `None`: not within this sweep, or they overlap from the beginning.
pub(crate) fn time_of_impact(pair: Pair, sweep: &Sweep) -> Option<f32> {
    let sweep = sweep.normalized();
    let mut cache = SimplexCache::default();
    let mut earliest = 0.0;
    for _ in 0..MAX_AXES {
        let distance = pair.distance(sweep.transform(earliest), &mut cache);
        if distance <= 0.0 {
            return None;
        }
        if distance < TARGET + TOLERANCE {
            return Some(earliest);
        }
        let axis = Axis::new(pair, &sweep, &cache, earliest);
        match axis.advance(earliest) {
            Advance::To(time) => earliest = time,
            Advance::Touching => return Some(earliest),
            Advance::Apart => return None,
        }
    }
    None
}

/// What following one separating axis led to.
enum Advance {
    /// Nothing happens before this time: look again for the closest features there.
    To(f32),
    /// They touch at the beginning.
    Touching,
    /// They do not touch within the sweep, or the search failed.
    Apart,
}

/// A direction in which the shapes are measured while the polygon moves.
enum Direction {
    /// Fixed in the world, between two corners.
    Points(Vec2),
    /// Normal of the edge, and a point on it.
    Edge { normal: Vec2, point: Vec2 },
    /// Normal of a polygon's side and a point on it, in the polygon's frame.
    Side { normal: Vec2, point: Vec2 },
}

struct Axis<'a> {
    pair: Pair<'a>,
    sweep: &'a Sweep,
    direction: Direction,
}

impl<'a> Axis<'a> {
    /// The axis between the features that are closest at `time`.
    fn new(pair: Pair<'a>, sweep: &'a Sweep, cache: &SimplexCache, time: f32) -> Axis<'a> {
        let place = sweep.transform(time);
        let direction = match *cache.closest() {
            [[end, corner]] => {
                let apart = place.apply(pair.corners[corner]) - pair.edge_end(end);
                Direction::Points(apart.normalized())
            }
            [[end, corner1], [end2, corner2], ..] if end == end2 => {
                let (from, to) = (pair.corners[corner1], pair.corners[corner2]);
                let normal = (to - from).turned_right().normalized();
                let point = 0.5 * (from + to);
                let outside = pair.edge_end(end) - place.apply(point);
                let flip = outside.dot(place.rotation.apply(normal)) < 0.0;
                Direction::Side { normal: if flip { -normal } else { normal }, point }
            }
            [[end1, corner], [end2, _], ..] => {
                let (from, to) = (pair.edge_end(end1), pair.edge_end(end2));
                let normal = (to - from).turned_right().normalized();
                let point = 0.5 * (from + to);
                let outside = place.apply(pair.corners[corner]) - point;
                let flip = outside.dot(normal) < 0.0;
                Direction::Edge { normal: if flip { -normal } else { normal }, point }
            }
            [] => unreachable!("a distance query always leaves a simplex"),
        };
        Axis { pair, sweep, direction }
    }

    /// The deepest corners (of edge, of polygon) when the polygon is at `place`.
    fn deepest(&self, place: Transform) -> [usize; 2] {
        match self.direction {
            Direction::Points(axis) => {
                [self.pair.edge_support(axis), self.pair.corner_support(place.rotation.apply_inverse(-axis))]
            }
            Direction::Edge { normal, .. } => {
                [0, self.pair.corner_support(place.rotation.apply_inverse(-normal))]
            }
            Direction::Side { normal, .. } => [self.pair.edge_support(-place.rotation.apply(normal)), 0],
        }
    }

    /// Separation of two corners along the axis.
    fn separation(&self, [end, corner]: [usize; 2], place: Transform) -> f32 {
        match self.direction {
            Direction::Points(axis) => {
                (place.apply(self.pair.corners[corner]) - self.pair.edge_end(end)).dot(axis)
            }
            Direction::Edge { normal, point } => (place.apply(self.pair.corners[corner]) - point).dot(normal),
            Direction::Side { normal, point } => {
                (self.pair.edge_end(end) - place.apply(point)).dot(place.rotation.apply(normal))
            }
        }
    }

    /// Follows the deepest corners back in time from the end of the sweep, again and again until none is too deep.
    fn advance(&self, earliest: f32) -> Advance {
        let mut time = 1.0;
        for _ in 0..MAX_POLYGON_CORNERS {
            let place = self.sweep.transform(time);
            let corners = self.deepest(place);
            let at_end = self.separation(corners, place);
            if at_end > TARGET + TOLERANCE {
                return Advance::Apart;
            }
            if at_end > TARGET - TOLERANCE {
                return Advance::To(time);
            }
            let at_start = self.separation(corners, self.sweep.transform(earliest));
            if at_start < TARGET - TOLERANCE {
                return Advance::Apart;
            }
            if at_start <= TARGET + TOLERANCE {
                return Advance::Touching;
            }
            time = self.root(corners, (earliest, at_start), (time, at_end));
        }
        Advance::To(earliest)
    }

    /// When the corners are at the target distance, between a time when they are farther and one when they are nearer:
    /// bisection and secant steps by turns. Without success, the later time.
    fn root(&self, corners: [usize; 2], far: (f32, f32), near: (f32, f32)) -> f32 {
        let ((mut t1, mut s1), (mut t2, mut s2)) = (far, near);
        for step in 0..MAX_ROOT_STEPS {
            let time =
                if step % 2 == 1 { t1 + (TARGET - s1) * (t2 - t1) / (s2 - s1) } else { 0.5 * (t1 + t2) };
            let separation = self.separation(corners, self.sweep.transform(time));
            if (separation - TARGET).abs() < TOLERANCE {
                return time;
            }
            if separation > TARGET {
                (t1, s1) = (time, separation);
            } else {
                (t2, s2) = (time, separation);
            }
        }
        near.0
    }
}
