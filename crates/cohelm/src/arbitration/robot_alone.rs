//! Robot alone. Formula: a = argmax Q(s, a). Source: the paper's autonomy at c = 1. The robot flies to the goal it infers,
//! whatever is asked. It has no extremes.

use super::{Arbiter, Pick, Stage};

/// The robot flies to the goal it infers, whatever is asked.
#[derive(Clone, Copy, Debug)]
pub struct RobotAlone;

impl Arbiter for RobotAlone {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        allowed[stage.values.best()] = true;
        Pick::Candidate(stage.values.best())
    }
}
