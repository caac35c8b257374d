//! What the drone looks like.

use crate::{ARM_M, Drone, HEIGHT_M, PAD_HALF_WIDTH_M, UNIT_M, WIDTH_M};
use cohelm::scene::{Part, Pose, Role, Scene, Shape};

/// Thickness of a pad, m.
const PAD_M: f32 = 0.15;
/// Half the length of a rotor, m.
const ROTOR_M: f32 = 0.28;

/// Ground, pillars with pads, the drone.
pub fn scene(drone: &Drone) -> Scene {
    let ground = polygon(&[[-1.0, 0.0], [17.0, 0.0], [17.0, -2.0], [-1.0, -2.0]]);
    let mut fixed = vec![part(Role::Ground, vec![ground])];
    fixed.extend(drone.pads.iter().map(|&pad| part(Role::Ground, vec![pillar(pad)])));
    fixed.extend(drone.pads.iter().enumerate().map(|(goal, &pad)| Part {
        role: Role::Goal,
        goal: Some(goal as u32),
        shapes: vec![surface(pad), mark(pad, -1.0), mark(pad, 1.0)],
    }));
    let body =
        polygon(&[[-0.2, -0.12], [0.2, -0.12], [0.26, 0.02], [0.16, 0.14], [-0.16, 0.14], [-0.26, 0.02]]);
    let arm = ARM_M as f32;
    let leg = |side: f32| line(&[[side * 0.12, -0.1], [side * 0.3, -0.25], [side * 0.38, -0.25]]);
    // A thrust that is only a line is a rotor: whoever draws it lets it spin.
    let rotor = |side: f32| line(&[[side * arm - ROTOR_M, 0.1], [side * arm + ROTOR_M, 0.1]]);
    let mast = |side: f32| line(&[[side * arm, 0.02], [side * arm, 0.1]]);
    Scene {
        bounds: [0.0, -0.6, WIDTH_M as f32, HEIGHT_M as f32],
        fixed,
        movable: vec![
            part(
                Role::Limb,
                vec![line(&[[-arm, 0.02], [arm, 0.02]]), leg(-1.0), leg(1.0), mast(-1.0), mast(1.0)],
            ),
            part(Role::Thrust, vec![rotor(-1.0)]),
            part(Role::Thrust, vec![rotor(1.0)]),
            part(Role::Body, vec![body]),
            part(Role::Decor, vec![Shape::Disc { center: [0.0, 0.02], radius: 0.08 }]),
        ],
        origin: [(WIDTH_M / 2.0) as f32, (HEIGHT_M / 2.0) as f32],
        scale: [UNIT_M as f32; 2],
    }
}

/// In the order of the movable parts: arms and legs, the left and the right rotor, body, lamp.
pub fn poses(drone: &Drone, poses: &mut Vec<Pose>) {
    let [roll, lift] = drone.thrust;
    let strength = |side: f64| (0.45 + 0.4 * lift - 0.25 * side * roll).clamp(0.05, 1.0) as f32;
    let (x, y) = (drone.motion.x as f32, drone.motion.y as f32);
    let pose = |strength| Pose { x, y, angle_rad: drone.motion.tilt as f32, strength };
    poses.clear();
    poses.extend([1.0, strength(-1.0), strength(1.0), 1.0, 1.0].map(pose));
}

fn part(role: Role, shapes: Vec<Shape>) -> Part {
    Part { role, goal: None, shapes }
}

fn pillar([x, y]: [f64; 2]) -> Shape {
    let (x, y, half) = (x as f32, y as f32, PAD_HALF_WIDTH_M as f32);
    polygon(&[[x - half, y], [x + half, y], [x + half, -1.0], [x - half, -1.0]])
}

fn surface([x, y]: [f64; 2]) -> Shape {
    let (x, y, half) = (x as f32, y as f32, PAD_HALF_WIDTH_M as f32);
    polygon(&[[x - half, y], [x - half, y - PAD_M], [x + half, y - PAD_M], [x + half, y]])
}

/// A lamp at each end of a pad.
fn mark([x, y]: [f64; 2], side: f32) -> Shape {
    let x = x as f32 + side * PAD_HALF_WIDTH_M as f32;
    line(&[[x, y as f32], [x, y as f32 + 0.45]])
}

fn polygon(points: &[[f32; 2]]) -> Shape {
    Shape::Polygon { points: points.to_vec() }
}

fn line(points: &[[f32; 2]]) -> Shape {
    Shape::Line { points: points.to_vec() }
}
