//! What a plant looks like, in shapes that any page can draw without knowing the plant.

use serde::{Deserialize, Serialize};

/// What a part stands for, from which whoever draws it chooses colours and strokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// What the plant rests on or runs into.
    Ground,
    /// The main body that is steered.
    Body,
    /// A limb of it.
    Limb,
    /// The exhaust, spin or push of an actuator: drawn brighter the larger the pose's `strength`.
    Thrust,
    /// A marker of a goal; the part's `goal` says which.
    Goal,
    /// Anything that only decorates.
    Decor,
}

/// An outline in the part's own frame, world units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Shape {
    /// A filled polygon.
    Polygon {
        /// Its corners in order.
        points: Vec<[f32; 2]>,
    },
    /// An open line.
    Line {
        /// Its points in order.
        points: Vec<[f32; 2]>,
    },
    /// A filled disc.
    Disc {
        /// Its middle.
        center: [f32; 2],
        /// Its radius.
        radius: f32,
    },
}

/// One part: shapes that move together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// What it stands for.
    pub role: Role,
    /// The id of the goal it marks, for `Role::Goal`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub goal: Option<u32>,
    /// Its outlines.
    pub shapes: Vec<Shape>,
}

/// Everything to draw, fixed for an episode; y points up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The visible world: [left, bottom, right, top] in world units.
    pub bounds: [f32; 4],
    /// Parts that never move, back to front.
    pub fixed: Vec<Part>,
    /// Parts that the poses place, back to front; pose i belongs to part i.
    pub movable: Vec<Part>,
    /// World units a normalised unit of position is, with the offset: world = origin + scale · position.
    pub origin: [f32; 2],
    /// See `origin`.
    pub scale: [f32; 2],
}

/// Where a movable part is now.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// World units.
    pub x: f32,
    /// World units, upwards.
    pub y: f32,
    /// Counter-clockwise, radians.
    pub angle_rad: f32,
    /// 0 (not to be seen) to 1 (full).
    pub strength: f32,
}
