//! Line-graph blend. Formula: a = w(c) · a_r + (1 − w(c)) · a_h with w = 0 up to `start`, rising linearly to `most` at
//! `full`, constant beyond. Source: Gopinath, Jain and Argall 2017, "Human-in-the-loop optimization of shared autonomy in
//! assistive robotics" (IEEE RA-L 2), whose users tune these three numbers. At `start` = 1 or `most` = 0 the person flies; at
//! `start` = 0, `full` = 1, `most` = 1 it is LASC; at `start` = `full` it is a step.

use super::blend::blend;
use super::{Arbiter, Pick, Stage};

/// A blend whose weight follows a broken line over the confidence.
///
/// Where no fused action exists it is a switch, as LASC is: the robot's if its weight is above 0.5; with `most` of 0.5 or
/// less it never is.
#[derive(Clone, Copy, Debug)]
pub struct LineGraph {
    /// Confidence up to which the person alone flies, in [0, 1].
    pub start: f64,
    /// Confidence from which the robot has its largest weight, from `start` to 1.
    pub full: f64,
    /// The robot's largest weight, in [0, 1].
    pub most: f64,
}

impl LineGraph {
    /// The robot's weight at a confidence.
    pub fn weight(&self, confidence: f64) -> f64 {
        if confidence <= self.start {
            0.0
        } else if confidence >= self.full {
            self.most
        } else {
            self.most * (confidence - self.start) / (self.full - self.start)
        }
    }
}

impl Arbiter for LineGraph {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        blend(stage, self.weight(stage.confidence().into()) as f32, allowed)
    }
}
