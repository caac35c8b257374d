//! Vectors, rotations, rigid transforms and boxes in the plane, all `f32`.
//!
//! The order of every sum is part of the contract: another order gives other bits.

use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use super::angle::sin_cos;

/// A vector or a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Vec2 {
    pub x: f32,
    pub y: f32,
}

pub(crate) const fn vec2(x: f32, y: f32) -> Vec2 {
    Vec2 { x, y }
}

impl Vec2 {
    pub const ZERO: Vec2 = vec2(0.0, 0.0);

    pub fn dot(self, other: Vec2) -> f32 {
        self.x * other.x + self.y * other.y
    }

    /// z of the cross product of two vectors in the plane.
    pub fn cross(self, other: Vec2) -> f32 {
        self.x * other.y - self.y * other.x
    }

    /// The vector turned by −90°: its cross product with the unit vector out of the plane.
    pub fn turned_right(self) -> Vec2 {
        vec2(self.y, -self.x)
    }

    /// The velocity at arm `self` of a body that turns with `omega`.
    pub fn swung(self, omega: f32) -> Vec2 {
        vec2(-omega * self.y, omega * self.x)
    }

    pub fn length_squared(self) -> f32 {
        self.x * self.x + self.y * self.y
    }

    pub fn length(self) -> f32 {
        self.length_squared().sqrt()
    }

    /// Of length one; unchanged when it is too short to have a direction.
    pub fn normalized(self) -> Vec2 {
        let length = self.length();
        if length < f32::EPSILON {
            return self;
        }
        let inverse = 1.0 / length;
        vec2(self.x * inverse, self.y * inverse)
    }

    /// The smaller of each coordinate.
    pub fn min(self, other: Vec2) -> Vec2 {
        vec2(smaller(self.x, other.x), smaller(self.y, other.y))
    }

    /// The larger of each coordinate.
    pub fn max(self, other: Vec2) -> Vec2 {
        vec2(larger(self.x, other.x), larger(self.y, other.y))
    }
}

impl Add for Vec2 {
    type Output = Vec2;
    fn add(self, other: Vec2) -> Vec2 {
        vec2(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Vec2 {
    type Output = Vec2;
    fn sub(self, other: Vec2) -> Vec2 {
        vec2(self.x - other.x, self.y - other.y)
    }
}

impl Mul<Vec2> for f32 {
    type Output = Vec2;
    fn mul(self, vector: Vec2) -> Vec2 {
        vec2(self * vector.x, self * vector.y)
    }
}

impl Neg for Vec2 {
    type Output = Vec2;
    fn neg(self) -> Vec2 {
        vec2(-self.x, -self.y)
    }
}

impl AddAssign for Vec2 {
    fn add_assign(&mut self, other: Vec2) {
        *self = *self + other;
    }
}

impl SubAssign for Vec2 {
    fn sub_assign(&mut self, other: Vec2) {
        *self = *self - other;
    }
}

/// `a` if it is smaller, else `b`. (`f32::min` treats NaN and zeros in another way, and differs between targets.)
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `a` if it is larger, else `b`.
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `value` within `[low, high]`.
pub(crate) fn clamp(value: f32, low: f32, high: f32) -> f32 {
    larger(low, smaller(value, high))
}

/// A rotation, as sine and cosine of its angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rotation {
    pub sin: f32,
    pub cos: f32,
}

impl Rotation {
    pub fn of(angle_rad: f32) -> Rotation {
        let (sin, cos) = sin_cos(angle_rad);
        Rotation { sin, cos }
    }

    pub fn apply(self, v: Vec2) -> Vec2 {
        vec2(self.cos * v.x - self.sin * v.y, self.sin * v.x + self.cos * v.y)
    }

    pub fn apply_inverse(self, v: Vec2) -> Vec2 {
        vec2(self.cos * v.x + self.sin * v.y, -self.sin * v.x + self.cos * v.y)
    }
}

/// A rotation followed by a shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transform {
    pub origin: Vec2,
    pub rotation: Rotation,
}

impl Transform {
    /// Of a body whose centre of mass, `local_center` in its own frame, is at `center`.
    pub fn about_center(center: Vec2, rotation: Rotation, local_center: Vec2) -> Transform {
        Transform { origin: center - rotation.apply(local_center), rotation }
    }

    pub fn apply(self, v: Vec2) -> Vec2 {
        vec2(
            (self.rotation.cos * v.x - self.rotation.sin * v.y) + self.origin.x,
            (self.rotation.sin * v.x + self.rotation.cos * v.y) + self.origin.y,
        )
    }

    pub fn apply_inverse(self, v: Vec2) -> Vec2 {
        let (px, py) = (v.x - self.origin.x, v.y - self.origin.y);
        vec2(
            self.rotation.cos * px + self.rotation.sin * py,
            -self.rotation.sin * px + self.rotation.cos * py,
        )
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Aabb {
    pub lower: Vec2,
    pub upper: Vec2,
}

impl Aabb {
    /// Around `points`, widened by `margin` on every side.
    pub fn around(points: impl IntoIterator<Item = Vec2>, margin: f32) -> Aabb {
        let mut points = points.into_iter();
        let first = points.next().unwrap_or(Vec2::ZERO);
        let (lower, upper) =
            points.fold((first, first), |(lower, upper), point| (lower.min(point), upper.max(point)));
        Aabb { lower, upper }.widened(margin)
    }

    pub fn widened(self, margin: f32) -> Aabb {
        let margin = vec2(margin, margin);
        Aabb { lower: self.lower - margin, upper: self.upper + margin }
    }

    pub fn joined(self, other: Aabb) -> Aabb {
        Aabb { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    pub fn contains(self, other: Aabb) -> bool {
        self.lower.x <= other.lower.x
            && self.lower.y <= other.lower.y
            && other.upper.x <= self.upper.x
            && other.upper.y <= self.upper.y
    }

    pub fn overlaps(self, other: Aabb) -> bool {
        let (right, left) = (other.lower - self.upper, self.lower - other.upper);
        !(right.x > 0.0 || right.y > 0.0 || left.x > 0.0 || left.y > 0.0)
    }
}
