//! Threshold blend. Formula: a = a_r if c > `confidence`, else a_h. Source: the "timid" and "aggressive" assistance of
//! Dragan and Srinivasa 2013, and the predict-then-blend rival of Javdani, Srinivasa and Bagnell 2015. At 0 the robot
//! flies as soon as it believes anything at all; at 1 the person flies.

use super::{Arbiter, Pick, Stage};

/// The robot takes over above a confidence, below it the person flies.
#[derive(Clone, Copy, Debug)]
pub struct Threshold {
    /// Confidence above which the robot takes over, in [0, 1].
    pub confidence: f64,
}

impl Arbiter for Threshold {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        let robot = stage.values.best();
        if stage.likeness.is_some() && f64::from(stage.confidence()) <= self.confidence {
            allowed.fill(true);
            Pick::Asked
        } else {
            allowed[robot] = true;
            Pick::Candidate(robot)
        }
    }
}
