//! The rules, one short type each: formula, source, and what it does at its extremes.

use super::choose::{most_alike_of, share_of_best};
use super::{Arbiter, Pick, Stage};

/// The person flies (HIC): what is asked is carried out; with no input nothing changes.
#[derive(Clone, Copy, Debug)]
pub struct HumanAlone;

impl Arbiter for HumanAlone {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        allowed.fill(true);
        if stage.likeness.is_some() { Pick::Asked } else { Pick::Nothing }
    }
}

/// The robot flies to the goal it infers, whatever is asked.
#[derive(Clone, Copy, Debug)]
pub struct RobotAlone;

impl Arbiter for RobotAlone {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        allowed[stage.values.best()] = true;
        Pick::Candidate(stage.values.best())
    }
}

/// Linear arbitration (LASC, Section IV): c · robot + (1 − c) · human. Where no fused action exists it is a switch:
/// the robot's if c > 0.5, otherwise the person's. c = 0: the person; c = 1: the robot.
#[derive(Clone, Copy, Debug)]
pub struct Linear;

impl Arbiter for Linear {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        allowed[stage.values.best()] = true;
        let robot = stage.values.best();
        if stage.likeness.is_some() {
            Pick::Blend { robot, weight: stage.confidence() }
        } else {
            Pick::Candidate(robot)
        }
    }
}

/// Minimal intervention (MISC, Eqs. 3–4): among the actions with Q′(s, a) ≥ c · Q′(s, a_max) the most similar to what
/// was asked. c = 0: whatever was asked; c = 1: only a best action; all values equal: whatever was asked.
#[derive(Clone, Copy, Debug)]
pub struct MinimalIntervention;

impl Arbiter for MinimalIntervention {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        share_of_best(f64::from(stage.confidence()), stage, allowed)
    }
}

/// Constant tolerance (Reddy et al. 2018): the same with Q′(s, a) ≥ (1 − α) · Q′(s, a_max), whatever the confidence.
/// α = 0: only a best action; α = 1: whatever was asked.
#[derive(Clone, Copy, Debug)]
pub struct ConstantTolerance {
    /// In [0, 1].
    pub alpha: f64,
}

impl Arbiter for ConstantTolerance {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        share_of_best(1.0 - self.alpha, stage, allowed)
    }
}

/// Minimal intervention with a regret threshold (MISC-R, ours): among the actions with max Q − Q(s, a) ≤ ε the most
/// similar to what was asked. It steps in only where a bad action costs something, which Q′ divides away. ε = 0: only a
/// best action; ε → ∞: whatever was asked.
#[derive(Clone, Copy, Debug)]
pub struct RegretThreshold {
    /// Regret allowed, in the values' units, at least 0: κ · median range.
    pub epsilon: f64,
}

impl Arbiter for RegretThreshold {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        most_alike_of(stage, allowed, |i| stage.values.regret(i) <= self.epsilon)
    }
}
