//! Convex polygons, straight edges, and the mass of a polygon.

use super::tuning::SKIN;
use super::vector::{Aabb, Transform, Vec2, vec2};

/// Most corners that any shape of the scene has (the hull's six).
pub(crate) const MAX_CORNERS: usize = 6;

/// A convex polygon, corners counter-clockwise in the body's frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Polygon {
    corners: [Vec2; MAX_CORNERS],
    /// Outward normal of the side from each corner to the next.
    normals: [Vec2; MAX_CORNERS],
    count: usize,
    /// Centre of the area.
    pub centroid: Vec2,
}

/// What a shape weighs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MassData {
    pub mass: f32,
    pub center: Vec2,
    /// About the body's origin.
    pub inertia: f32,
}

impl Polygon {
    /// From at most [`MAX_CORNERS`] corners, counter-clockwise, the rightmost lower one first.
    pub fn new(outline: &[Vec2]) -> Polygon {
        let count = outline.len();
        let mut corners = [Vec2::ZERO; MAX_CORNERS];
        corners[..count].copy_from_slice(outline);
        let mut normals = [Vec2::ZERO; MAX_CORNERS];
        for i in 0..count {
            normals[i] = (corners[(i + 1) % count] - corners[i]).turned_right().normalized();
        }
        let centroid = centroid(outline);
        Polygon { corners, normals, count, centroid }
    }

    /// A rectangle about the origin, given half its width and height. Its normals and centre are exact.
    pub fn rectangle(half_width: f32, half_height: f32) -> Polygon {
        let (w, h) = (half_width, half_height);
        let mut polygon = Polygon::new(&[vec2(-w, -h), vec2(w, -h), vec2(w, h), vec2(-w, h)]);
        polygon.normals[..4].copy_from_slice(&[
            vec2(0.0, -1.0),
            vec2(1.0, 0.0),
            vec2(0.0, 1.0),
            vec2(-1.0, 0.0),
        ]);
        polygon.centroid = Vec2::ZERO;
        polygon
    }

    pub fn corners(&self) -> &[Vec2] {
        &self.corners[..self.count]
    }

    pub fn normals(&self) -> &[Vec2] {
        &self.normals[..self.count]
    }

    pub fn aabb(&self, place: Transform) -> Aabb {
        Aabb::around(self.corners().iter().map(|corner| place.apply(*corner)), SKIN)
    }

    pub fn mass_data(&self, density: f32) -> MassData {
        let reference = mean(self.corners());
        let (mut area, mut center, mut inertia) = (0.0_f32, Vec2::ZERO, 0.0_f32);
        for [e1, e2] in fan(self.corners(), reference) {
            let cross = e1.cross(e2);
            let triangle = 0.5 * cross;
            area += triangle;
            center += (triangle * THIRD) * (e1 + e2);
            let x_moment = e1.x * e1.x + e2.x * e1.x + e2.x * e2.x;
            let y_moment = e1.y * e1.y + e2.y * e1.y + e2.y * e2.y;
            inertia += (0.25 * THIRD * cross) * (x_moment + y_moment);
        }
        let mass = density * area;
        let offset = (1.0 / area) * center;
        let center = offset + reference;
        let inertia = density * inertia + mass * (center.dot(center) - offset.dot(offset));
        MassData { mass, center, inertia }
    }
}

const THIRD: f32 = 1.0 / 3.0;

/// Mean of the corners: a point inside.
fn mean(corners: &[Vec2]) -> Vec2 {
    let sum = corners.iter().fold(Vec2::ZERO, |sum, corner| sum + *corner);
    (1.0 / corners.len() as f32) * sum
}

/// The triangles between `apex` and each side, as the two vectors from the apex.
fn fan(corners: &[Vec2], apex: Vec2) -> impl Iterator<Item = [Vec2; 2]> + '_ {
    (0..corners.len()).map(move |i| [corners[i] - apex, corners[(i + 1) % corners.len()] - apex])
}

/// Centre of area. Another sum than the one in [`Polygon::mass_data`], with other rounding, as in the reference.
fn centroid(corners: &[Vec2]) -> Vec2 {
    let (mut area, mut center) = (0.0_f32, Vec2::ZERO);
    for i in 0..corners.len() {
        let (p2, p3) = (corners[i], corners[(i + 1) % corners.len()]);
        let triangle = 0.5 * p2.cross(p3);
        area += triangle;
        center += (triangle * THIRD) * ((Vec2::ZERO + p2) + p3);
    }
    (1.0 / area) * center
}

/// A straight piece of ground, from left to right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    pub from: Vec2,
    pub to: Vec2,
    pub friction: f32,
    /// Box of the broad phase; the ground never moves.
    pub aabb: Aabb,
}
