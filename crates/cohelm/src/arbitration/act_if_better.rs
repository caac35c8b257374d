//! Act only if better (IDA's intervention function). Formula: a = a_r if Q_g(s, a_r) > Q_g(s, a_h) for every goal g, else
//! a_h. Source: McMahan, Peng, Zhou and Kao 2024, "Shared autonomy with IDA: interventional diffusion assistance"; their
//! co-pilot is a diffusion model that does not know the goal, ours is the best action for the goal that is inferred. It has
//! no parameter: with one goal it is the robot wherever that is better, with goals in all directions only what is bad for
//! every one of them is changed.

use super::{Arbiter, Needs, Pick, Stage};

/// The robot's best action, if it is better than what is asked whatever the goal.
#[derive(Clone, Copy, Debug)]
pub struct ActIfBetter;

impl Arbiter for ActIfBetter {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        let robot = stage.values.best();
        let Some(asked) = stage.candidate_asked() else {
            allowed[robot] = true;
            return Pick::Candidate(robot);
        };
        let better = |values: &[f32]| values[robot] > values[asked];
        let always = match stage.of_goals {
            Some(of_goals) => (0..of_goals.goals()).all(|goal| better(of_goals.of(goal))),
            None => better(stage.values.values()),
        };
        allowed.fill(!always);
        allowed[robot] = true;
        if always { Pick::Candidate(robot) } else { Pick::Asked }
    }

    fn needs(&self) -> Needs {
        Needs { every_goal: true, ..Needs::default() }
    }
}
