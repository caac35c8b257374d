//! What the blending rules share: the robot's best action, weighed against what is asked.

use super::{Pick, Stage};

/// The robot's best action with that weight and what is asked with the rest; the robot's alone if nothing is asked.
pub(super) fn blend(stage: &Stage<'_>, weight: f32, allowed: &mut [bool]) -> Pick {
    let robot = stage.values.best();
    allowed[robot] = true;
    if stage.likeness.is_some() { Pick::Blend { robot, weight } } else { Pick::Candidate(robot) }
}
