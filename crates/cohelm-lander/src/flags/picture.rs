//! What the lander looks like, for whoever draws scenes: the same for both of its plants.
//!
//! Movable parts keep their order: main, left and right flame, the right and the left leg, hull, window.

use super::state::{ORIGIN, SCALE_OF_POSITION};
use super::surface::Surface;
use crate::craft::{Craft, Engines, HULL_OUTLINE, LEG_OUTLINE, Motion, WORLD_WIDTH};
use crate::physics::body::{LEG_AWAY, LEG_DOWN};
use cohelm::scene::{Part, Pose, Role, Scene, Shape};

/// Top of what is shown, world units: the start and the first leap of a strong push fit in, and the picture is 4:3.
const SHOWN_HEIGHT: f64 = 15.0;
/// The ground is filled down to here, below what is shown.
const BOTTOM: f64 = -2.0;
/// Height of a flag's pole, world units: Gymnasium's 50 pixels.
const POLE: f64 = 50.0 / 30.0;
/// Length and width of a flag's cloth, world units.
const CLOTH: [f64; 2] = [25.0 / 30.0, 12.0 / 30.0];
/// How thick a pad is drawn, world units.
const PAD_THICKNESS: f64 = 0.12;

/// The flame of the main engine in the hull's frame, world units.
const MAIN_FLAME: [[f64; 2]; 5] =
    [[0.24, -0.33], [0.12, -0.95], [0.0, -1.35], [-0.12, -0.95], [-0.24, -0.33]];
/// The flame of the engine that pushes to the left, and so burns to the right; the other one's is its mirror image.
const LEFT_FLAME: [[f64; 2]; 4] = [[0.48, 0.38], [0.75, 0.40], [1.1, 0.467], [0.48, 0.55]];
/// The window's middle and radius in the hull's frame, world units.
const WINDOW: ([f32; 2], f32) = ([0.0, 0.18], 0.15);

/// The whole picture around some goals' parts.
pub(crate) fn scene(surface: &Surface, goals: impl Iterator<Item = Part>) -> Scene {
    Scene {
        bounds: [0.0, 0.0, WORLD_WIDTH, SHOWN_HEIGHT].map(|bound| bound as f32),
        fixed: [ground(surface)].into_iter().chain(goals).collect(),
        movable: craft_parts(),
        origin: ORIGIN.map(|at| at as f32),
        scale: SCALE_OF_POSITION.map(|at| at as f32),
    }
}

/// A pad between two flags; `x` and `y` are the middle of its surface.
pub(crate) fn pad(goal: u32, [x, y]: [f64; 2], half_width: f64) -> Part {
    let (left, right) = (x - half_width, x + half_width);
    let below = y - PAD_THICKNESS;
    let mut shapes = vec![polygon(&[[left, y], [left, below], [right, below], [right, y]])];
    shapes.extend(flag([left, y], 1.0).into_iter().chain(flag([right, y], -1.0)));
    Part { role: Role::Goal, goal: Some(goal), shapes }
}

/// Clears `poses` and puts the craft's in, in the order of the movable parts.
pub(crate) fn craft_poses(craft: &Craft, engines: &Engines, poses: &mut Vec<Pose>) {
    let (hull, legs) = (craft.hull(), craft.legs());
    poses.clear();
    poses.extend([engines.main, engines.left, engines.right].map(|throttle| pose(&hull, throttle)));
    poses.extend(legs.iter().chain([&hull, &hull]).map(|body| pose(body, 1.0)));
}

fn pose(body: &Motion, strength: f64) -> Pose {
    Pose { x: body.x, y: body.y, angle_rad: body.angle_rad, strength: strength as f32 }
}

fn craft_parts() -> Vec<Part> {
    let part = |role, shape| Part { role, goal: None, shapes: vec![shape] };
    let right_flame = LEFT_FLAME.map(|[x, y]| [-x, y]);
    let flames = [polygon(&MAIN_FLAME), polygon(&LEFT_FLAME), polygon(&right_flame)];
    let (center, radius) = WINDOW;
    let mut parts: Vec<Part> = flames.into_iter().map(|flame| part(Role::Thrust, flame)).collect();
    parts.extend([leg(1.0), leg(-1.0)]);
    parts.push(part(Role::Body, polygon(&HULL_OUTLINE)));
    parts.push(part(Role::Decor, Shape::Disc { center, radius }));
    parts
}

fn ground(surface: &Surface) -> Part {
    let vertices = surface.vertices();
    let (first, last) = (vertices[0][0], vertices[vertices.len() - 1][0]);
    let outline = [vertices, &[[last, BOTTOM], [first, BOTTOM]]].concat();
    Part { role: Role::Ground, goal: None, shapes: vec![polygon(&outline)] }
}

/// A pole with a cloth that flies to the given side: inwards, so that the cloths of neighbouring pads never meet.
fn flag([x, y]: [f64; 2], side: f64) -> [Shape; 2] {
    let top = y + POLE;
    let [length, width] = CLOTH;
    let cloth = polygon(&[[x, top], [x, top - width], [x + side * length, top - width / 2.0]]);
    [line(&[[x, y], [x, top]]), cloth]
}

/// A leg and the strut on which it hangs; the hull is drawn over the strut's end.
fn leg(side: f64) -> Part {
    let strut = line(&[[0.0, LEG_OUTLINE[2][1]], [-side * LEG_AWAY, LEG_DOWN]]);
    Part { role: Role::Limb, goal: None, shapes: vec![strut, polygon(&LEG_OUTLINE)] }
}

fn line(points: &[[f64; 2]]) -> Shape {
    Shape::Line { points: single(points) }
}

fn polygon(points: &[[f64; 2]]) -> Shape {
    Shape::Polygon { points: single(points) }
}

fn single(points: &[[f64; 2]]) -> Vec<[f32; 2]> {
    points.iter().map(|point| point.map(|p| p as f32)).collect()
}
