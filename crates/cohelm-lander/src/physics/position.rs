//! Where a body is while positions are being corrected.

use super::vector::{Rotation, Vec2};

/// Centre of mass and angle; the rotation always belongs to the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Position {
    pub center: Vec2,
    pub angle_rad: f32,
    pub rotation: Rotation,
}

impl Position {
    /// The same centre at another angle. Sine and cosine are the costly part, so an unchanged angle keeps them.
    pub fn turned(self, angle_rad: f32) -> Position {
        if angle_rad == self.angle_rad {
            return self;
        }
        Position { angle_rad, rotation: Rotation::of(angle_rad), ..self }
    }
}
