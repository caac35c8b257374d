//! What the arm looks like, from above.

use crate::{Arm, CUP_M, ELBOW_RAD, HAND_M, Joints, LINK_M, MIDDLE_M, SHOULDER_RAD, UNIT_M};
use cohelm::scene::{Part, Pose, Role, Scene, Shape};

/// Half the width of a link, m.
const HALF_LINK_M: f32 = 0.032;

/// The base, where the hand is when a joint is at its stop, the cups, the arm.
pub fn scene(arm: &Arm) -> Scene {
    let base = Shape::Polygon { points: vec![[-0.09, 0.03], [0.09, 0.03], [0.09, -0.09], [-0.09, -0.09]] };
    let mut fixed = vec![part(Role::Decor, vec![Shape::Line { points: limit() }, base])];
    fixed.extend(arm.cups.iter().enumerate().map(|(goal, cup)| Part {
        role: Role::Goal,
        goal: Some(goal as u32),
        shapes: vec![Shape::Disc { center: cup.map(|at| at as f32), radius: CUP_M as f32 }],
    }));
    let joint = |radius| part(Role::Decor, vec![Shape::Disc { center: [0.0; 2], radius }]);
    Scene {
        bounds: [-1.05, -0.15, 1.05, 1.05],
        fixed,
        movable: vec![
            part(Role::Limb, vec![link()]),
            part(Role::Limb, vec![link()]),
            joint(1.7 * HALF_LINK_M),
            joint(1.4 * HALF_LINK_M),
            part(Role::Limb, vec![finger(-1.0), finger(1.0)]),
            part(Role::Body, vec![Shape::Disc { center: [0.0; 2], radius: HAND_M as f32 }]),
        ],
        origin: MIDDLE_M.map(|at| at as f32),
        scale: [UNIT_M as f32; 2],
    }
}

/// In the order of the movable parts: upper arm, fore-arm, shoulder, elbow, fingers, hand.
pub fn poses(arm: &Arm, poses: &mut Vec<Pose>) {
    let (elbow, hand) = (arm.joints.elbow_at(), arm.joints.hand_at());
    let at = |[x, y]: [f64; 2], angle: f64| Pose {
        x: x as f32,
        y: y as f32,
        angle_rad: angle as f32,
        strength: 1.0,
    };
    let (upper_arm, fore_arm) = (arm.joints.shoulder, arm.joints.shoulder + arm.joints.elbow);
    let shoulder = [0.0; 2];
    poses.clear();
    poses.extend([at(shoulder, upper_arm), at(elbow, fore_arm), at(shoulder, 0.0), at(elbow, 0.0)]);
    // The hand is round: upright, so that whoever reads its tilt reads none.
    poses.extend([at(hand, fore_arm), at(hand, 0.0)]);
}

fn part(role: Role, shapes: Vec<Shape>) -> Part {
    Part { role, goal: None, shapes }
}

/// Once around where the hand can be: the elbow stretched, the shoulder turned back, the elbow folded, the shoulder turned
/// forwards.
fn limit() -> Vec<[f32; 2]> {
    let ([stretched, folded], [least, most]) = (ELBOW_RAD, SHOULDER_RAD);
    let corners =
        [[least, stretched], [most, stretched], [most, folded], [least, folded], [least, stretched]];
    let sides = corners.windows(2).flat_map(|side| {
        let part = move |i: usize, share: f64| side[0][i] + share * (side[1][i] - side[0][i]);
        (0..=64).map(move |step| [0, 1].map(|i| part(i, f64::from(step) / 64.0)))
    });
    let hand = |[shoulder, elbow]: [f64; 2]| Joints { shoulder, elbow, ..Joints::default() }.hand_at();
    sides.map(|joints| hand(joints).map(|at| at as f32)).collect()
}

fn link() -> Shape {
    let (length, half) = (LINK_M as f32, HALF_LINK_M);
    Shape::Polygon { points: vec![[0.0, half], [length, 0.7 * half], [length, -0.7 * half], [0.0, -half]] }
}

fn finger(side: f32) -> Shape {
    let hand = HAND_M as f32;
    let points = vec![
        [0.4 * hand, 0.9 * side * hand],
        [1.3 * hand, 1.1 * side * hand],
        [1.9 * hand, 0.6 * side * hand],
    ];
    Shape::Line { points }
}
