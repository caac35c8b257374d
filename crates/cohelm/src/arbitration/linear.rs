//! Linear arbitration (LASC). Formula: a = c · a_r + (1 − c) · a_h. Source: the paper's rival, Section IV; Dragan and
//! Srinivasa 2013, "A policy-blending formalism for shared control". At c = 0 the person, at c = 1 the robot.

use super::blend::blend;
use super::{Arbiter, Pick, Stage};

/// Linear arbitration (LASC): c · robot + (1 − c) · human. Where no fused action exists it is a switch: the robot's if
/// c > 0.5, otherwise the person's.
#[derive(Clone, Copy, Debug)]
pub struct Linear;

impl Arbiter for Linear {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        blend(stage, stage.confidence(), allowed)
    }
}
