//! Where an edge of the ground and a convex polygon touch: at most two points and one normal.
//!
//! Separating axes first (the edge's normal, then the polygon's), then the face of the other shape is clipped against the
//! chosen reference face. The ground's frame is the world's. Both sides of an edge collide.

use super::shape::{Edge, MAX_CORNERS, Polygon};
use super::tuning::{ANGULAR_SLOP, SKIN};
use super::vector::{Transform, Vec2, smaller};

/// Distance below which the two skins touch.
const REACH: f32 = 2.0 * SKIN;
/// A polygon's axis must beat the edge's by this factor and this length, so that the choice does not flicker.
const AXIS_PREFERENCE: (f32, f32) = (0.98, 0.001);

/// Which shape has the reference face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Face {
    Ground,
    Body,
}

/// The pair of features that meet in a contact point: equal names in two steps mean that impulses carry over.
///
/// Box2D's naming is kept even where it is loose (both uncut ends of an edge against a body's face have one name):
/// it decides which impulses are found again.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Features {
    ground: Feature,
    body: Feature,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Feature {
    Corner(u8),
    Side(u8),
}

/// One point of contact and the impulses that held it in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ManifoldPoint {
    /// In the frame of the shape that has not the reference face.
    pub local_point: Vec2,
    pub normal_impulse: f32,
    pub tangent_impulse: f32,
    features: Features,
}

/// A contact's geometry in the frames of its shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Manifold {
    pub face: Face,
    /// Normal of the reference face in its shape's frame.
    pub local_normal: Vec2,
    /// A point on the reference face in its shape's frame.
    pub local_point: Vec2,
    points: [ManifoldPoint; 2],
    count: usize,
}

impl Manifold {
    /// No contact.
    pub const EMPTY: Manifold = Manifold {
        face: Face::Ground,
        local_normal: Vec2::ZERO,
        local_point: Vec2::ZERO,
        points: [ManifoldPoint {
            local_point: Vec2::ZERO,
            normal_impulse: 0.0,
            tangent_impulse: 0.0,
            features: Features { ground: Feature::Corner(0), body: Feature::Corner(0) },
        }; 2],
        count: 0,
    };

    pub fn points(&self) -> &[ManifoldPoint] {
        &self.points[..self.count]
    }

    pub fn points_mut(&mut self) -> &mut [ManifoldPoint] {
        &mut self.points[..self.count]
    }

    pub fn touching(&self) -> bool {
        self.count > 0
    }

    /// Takes over the impulses of points that were there in the step before.
    pub fn warm_up_from(&mut self, old: &Manifold) {
        for point in self.points_mut() {
            if let Some(same) = old.points().iter().find(|same| same.features == point.features) {
                point.normal_impulse = same.normal_impulse;
                point.tangent_impulse = same.tangent_impulse;
            }
        }
    }

    fn add(&mut self, local_point: Vec2, features: Features) {
        self.points[self.count] =
            ManifoldPoint { local_point, normal_impulse: 0.0, tangent_impulse: 0.0, features };
        self.count += 1;
    }
}

/// The polygon in the ground's frame.
struct Placed {
    corners: [Vec2; MAX_CORNERS],
    normals: [Vec2; MAX_CORNERS],
    count: usize,
}

impl Placed {
    fn new(polygon: &Polygon, place: Transform) -> Placed {
        let (mut corners, mut normals) = ([Vec2::ZERO; MAX_CORNERS], [Vec2::ZERO; MAX_CORNERS]);
        let count = polygon.corners().len();
        for i in 0..count {
            corners[i] = place.apply(polygon.corners()[i]);
            normals[i] = place.rotation.apply(polygon.normals()[i]);
        }
        Placed { corners, normals, count }
    }

    fn next(&self, i: usize) -> usize {
        if i + 1 < self.count { i + 1 } else { 0 }
    }
}

/// An end of the incident face on its way through the clipping.
#[derive(Clone, Copy)]
struct ClipPoint {
    at: Vec2,
    /// What cut it off: a corner of the reference face, or what it was named at first.
    cut: Feature,
    /// What it belongs to.
    of: Feature,
}

/// The face that others are clipped against.
struct ReferenceFace {
    from: Vec2,
    to: Vec2,
    normal: Vec2,
    /// Numbers of its two corners.
    ends: [u8; 2],
}

/// Where `edge` and `polygon` touch now; impulses are zero.
pub(crate) fn collide(edge: &Edge, polygon: &Polygon, place: Transform) -> Manifold {
    let mut manifold = Manifold::EMPTY;
    let upwards = (edge.to - edge.from).normalized().turned_right();
    let centroid = place.apply(polygon.centroid);
    let in_front = upwards.dot(centroid - edge.from) >= 0.0;
    let normal = if in_front { upwards } else { -upwards };

    let placed = Placed::new(polygon, place);
    let edge_separation = edge_separation(edge, normal, &placed);
    if edge_separation > REACH {
        return manifold;
    }
    let body_axis = body_axis(edge, normal, &placed);
    if let Some((separation, _)) = body_axis {
        if separation > REACH {
            return manifold;
        }
    }

    let (factor, length) = AXIS_PREFERENCE;
    match body_axis {
        Some((separation, side)) if separation > factor * edge_separation + length => {
            manifold.face = Face::Body;
            manifold.local_normal = polygon.normals()[side];
            manifold.local_point = polygon.corners()[side];
            let (face, incident) = body_reference(edge, &placed, side);
            for point in face.clip(incident) {
                manifold.add(point.at, Features { ground: point.of, body: point.cut });
            }
        }
        _ => {
            let (face, incident) = ground_reference(edge, normal, in_front, &placed);
            manifold.face = Face::Ground;
            manifold.local_normal = face.normal;
            manifold.local_point = face.from;
            for point in face.clip(incident) {
                manifold.add(place.apply_inverse(point.at), Features { ground: point.cut, body: point.of });
            }
        }
    }
    manifold
}

/// How far the polygon's deepest corner is from the edge's line.
fn edge_separation(edge: &Edge, normal: Vec2, placed: &Placed) -> f32 {
    let distances = placed.corners[..placed.count].iter().map(|corner| normal.dot(*corner - edge.from));
    distances.fold(f32::MAX, |least, distance| if distance < least { distance } else { least })
}

/// The polygon's side that separates best, and by how much; the first that separates beyond reach ends the search.
/// Sides that do not face the edge are no candidates.
fn body_axis(edge: &Edge, normal: Vec2, placed: &Placed) -> Option<(f32, usize)> {
    let mut best: Option<(f32, usize)> = None;
    for side in 0..placed.count {
        let inward = -placed.normals[side];
        let corner = placed.corners[side];
        let separation = smaller(inward.dot(corner - edge.from), inward.dot(corner - edge.to));
        if separation > REACH {
            return Some((separation, side));
        }
        if (inward + normal).dot(normal) < -ANGULAR_SLOP {
            continue;
        }
        if best.is_none_or(|(least, _)| separation > least) {
            best = Some((separation, side));
        }
    }
    best
}

/// The edge is the reference; the polygon's side that faces it most is clipped.
fn ground_reference(
    edge: &Edge,
    normal: Vec2,
    in_front: bool,
    placed: &Placed,
) -> (ReferenceFace, [ClipPoint; 2]) {
    let mut facing = (normal.dot(placed.normals[0]), 0);
    for side in 1..placed.count {
        let value = normal.dot(placed.normals[side]);
        if value < facing.0 {
            facing = (value, side);
        }
    }
    let incident = [facing.1, placed.next(facing.1)].map(|corner| ClipPoint {
        at: placed.corners[corner],
        cut: Feature::Side(0),
        of: Feature::Corner(corner as u8),
    });
    let face = if in_front {
        ReferenceFace { from: edge.from, to: edge.to, normal, ends: [0, 1] }
    } else {
        ReferenceFace { from: edge.to, to: edge.from, normal, ends: [1, 0] }
    };
    (face, incident)
}

/// A side of the polygon is the reference; the edge is clipped.
fn body_reference(edge: &Edge, placed: &Placed, side: usize) -> (ReferenceFace, [ClipPoint; 2]) {
    let next = placed.next(side);
    let face = ReferenceFace {
        from: placed.corners[side],
        to: placed.corners[next],
        normal: placed.normals[side],
        ends: [side as u8, next as u8],
    };
    let incident = [edge.from, edge.to].map(|at| ClipPoint {
        at,
        cut: Feature::Corner(0),
        of: Feature::Side(side as u8),
    });
    (face, incident)
}

impl ReferenceFace {
    /// The ends of the incident face, cut off beside the reference face, as far as they are within reach.
    fn clip(&self, incident: [ClipPoint; 2]) -> impl Iterator<Item = ClipPoint> + '_ {
        let side = self.normal.turned_right();
        let cut = cut_at_line(incident, side, side.dot(self.from), self.ends[0])
            .and_then(|points| cut_at_line(points, -side, (-side).dot(self.to), self.ends[1]));
        let near = |point: &ClipPoint| self.normal.dot(point.at - self.from) <= REACH;
        cut.into_iter().flatten().filter(near)
    }
}

/// What of a segment lies behind a line, if anything of length does.
fn cut_at_line(segment: [ClipPoint; 2], normal: Vec2, offset: f32, corner: u8) -> Option<[ClipPoint; 2]> {
    let [first, second] = segment;
    let distances = segment.map(|point| normal.dot(point.at) - offset);
    // Taken apart out here because rustc 1.85 crashes on the pattern inside a closure.
    let (Feature::Corner(index) | Feature::Side(index)) = first.of;
    let crossing = || {
        let share = distances[0] / (distances[0] - distances[1]);
        ClipPoint {
            at: first.at + share * (second.at - first.at),
            cut: Feature::Corner(corner),
            of: Feature::Side(index),
        }
    };
    match (distances[0] <= 0.0, distances[1] <= 0.0, distances[0] * distances[1] < 0.0) {
        (true, true, _) => Some(segment),
        (true, false, true) => Some([first, crossing()]),
        (false, true, true) => Some([second, crossing()]),
        _ => None,
    }
}
