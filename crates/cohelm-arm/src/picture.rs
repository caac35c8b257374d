//! What the arm looks like, from above.

use crate::{Arm, CUP_M, HAND_M, LINK_M, MIDDLE_M, UNIT_M};
use cohelm::scene::{Part, Pose, Role, Scene, Shape};

/// Half the width of a link, m.
const HALF_LINK_M: f32 = 0.032;

/// The table, the cups, the arm.
pub fn scene(arm: &Arm) -> Scene {
    let edge = Shape::Polygon { points: vec![[-1.4, 0.06], [1.4, 0.06], [1.4, -0.4], [-1.4, -0.4]] };
    let mut fixed = vec![part(Role::Ground, vec![edge])];
    fixed.extend(arm.cups.iter().enumerate().map(|(goal, cup)| Part {
        role: Role::Goal,
        goal: Some(goal as u32),
        shapes: vec![Shape::Disc { center: cup.map(|at| at as f32), radius: CUP_M as f32 }],
    }));
    Scene {
        bounds: [-1.0, -0.15, 1.0, 1.05],
        fixed,
        movable: vec![
            part(Role::Limb, vec![link()]),
            part(Role::Limb, vec![link()]),
            part(Role::Decor, vec![Shape::Disc { center: [0.0; 2], radius: 1.5 * HALF_LINK_M }]),
            part(Role::Body, vec![Shape::Disc { center: [0.0; 2], radius: HAND_M as f32 }]),
        ],
        origin: MIDDLE_M.map(|at| at as f32),
        scale: [UNIT_M as f32; 2],
    }
}

/// In the order of the movable parts: upper arm, fore-arm, elbow, hand.
pub fn poses(arm: &Arm, poses: &mut Vec<Pose>) {
    let (elbow, hand) = (arm.joints.elbow_at(), arm.joints.hand_at());
    let at = |[x, y]: [f64; 2], angle: f64| Pose {
        x: x as f32,
        y: y as f32,
        angle_rad: angle as f32,
        strength: 1.0,
    };
    let fore_arm = arm.joints.shoulder + arm.joints.elbow;
    poses.clear();
    poses.extend([
        at([0.0; 2], arm.joints.shoulder),
        at(elbow, fore_arm),
        at(elbow, 0.0),
        at(hand, fore_arm),
    ]);
}

fn part(role: Role, shapes: Vec<Shape>) -> Part {
    Part { role, goal: None, shapes }
}

fn link() -> Shape {
    let (length, half) = (LINK_M as f32, HALF_LINK_M);
    Shape::Polygon { points: vec![[0.0, half], [length, 0.7 * half], [length, -0.7 * half], [0.0, -half]] }
}
