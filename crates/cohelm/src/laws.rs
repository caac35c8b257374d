//! What every plant must keep, for the tests of whoever writes one.
//!
//! ```
//! use cohelm::laws::check;
//! use cohelm::point::Point;
//! check(&mut Point::new(), 0..5)?;
//! # Ok::<(), cohelm::laws::Broken>(())
//! ```

use crate::action::{Action, ActionSpace};
use crate::intent::MAX_GOALS;
use crate::plant::Plant;
use crate::random::Draws;
use crate::scene::Role;
use std::ops::Range;

/// Flown by random actions for so many ticks at most; a random flight seldom lasts longer.
const MOST_TICKS: u32 = 3000;
/// At this tick a copy is taken, to be compared with the plant later.
const COPIED_AT: u32 = 20;

/// A law that a plant breaks.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("seed {seed}, tick {tick}: {law}")]
pub struct Broken {
    /// What should hold, and what was found.
    pub law: String,
    /// In the episode of which seed.
    pub seed: u64,
    /// At which tick.
    pub tick: u32,
}

/// Flies random actions through the episodes of some seeds and says which law the plant breaks, if any:
///
/// - state, positions, rewards and poses are finite, and the state keeps its length;
/// - there are 1 to [`MAX_GOALS`] goals, each with an id of its own, and the pilot's is one of them;
/// - ticks count up from 0, and an episode is over at [`limit_ticks`](Plant::limit_ticks);
/// - there is one pose a movable part, of strength 0 to 1, and every goal has a part that marks it;
/// - the same seed and actions give the same bits again, from a reset and from a snapshot;
/// - all of it holds after a start near the goal, too.
pub fn check(plant: &mut dyn Plant, seeds: Range<u64>) -> Result<(), Broken> {
    for seed in seeds {
        plant.reset(seed);
        let flown = fly(plant, seed)?;
        plant.reset(seed);
        if fly(plant, seed)? != flown {
            return Err(broken(plant, seed, "a reset to the same seed and the same actions give other bits"));
        }
        if plant.reset_near_goal(seed, 0.5) {
            fly(plant, seed)?;
        }
    }
    Ok(())
}

/// One episode by the random actions of a seed: the bits of every state and reward.
fn fly(plant: &mut dyn Plant, seed: u64) -> Result<Vec<u64>, Broken> {
    let mut draws = Draws::fork(seed, 0x6c61_7773);
    let (space, length) = (plant.space().clone(), plant.view().state.len());
    let mut copy: Option<Box<dyn Plant>> = None;
    let mut bits = seen(plant);
    situation(plant, length, 0).map_err(|law| broken(plant, seed, &law))?;
    for tick in 1..=MOST_TICKS {
        let action = any_action(&space, &mut draws);
        let step = plant.step(action);
        bits.push(step.reward.to_bits());
        bits.extend(seen(plant));
        situation(plant, length, tick).map_err(|law| broken(plant, seed, &law))?;
        if !step.reward.is_finite() {
            return Err(broken(plant, seed, &format!("a reward is finite, found {}", step.reward)));
        }
        if let Some(copy) = &mut copy {
            if copy.step(action) != step || seen(copy.as_ref()) != seen(plant) {
                return Err(broken(plant, seed, "a snapshot goes on with the same bits"));
            }
        } else if tick == COPIED_AT {
            copy = plant.snapshot();
        }
        if step.ending.is_some() {
            return Ok(bits);
        }
        if plant.limit_ticks().is_some_and(|limit| tick >= limit) {
            return Err(broken(plant, seed, "the episode goes on beyond limit_ticks"));
        }
    }
    Ok(bits)
}

/// The bits of all that is seen.
fn seen(plant: &dyn Plant) -> Vec<u64> {
    let view = plant.view();
    let places = view.goals.iter().flat_map(|goal| goal.position);
    let numbers = view.state.iter().copied().chain(view.position).chain(places);
    numbers.map(|value| u64::from(value.to_bits())).chain([plant.pilot_goal() as u64]).collect()
}

/// What holds at every tick.
fn situation(plant: &dyn Plant, length: usize, tick: u32) -> Result<(), String> {
    let view = plant.view();
    if view.tick != tick {
        return Err(format!("view().tick counts the steps, {tick}; found {}", view.tick));
    }
    if view.state.len() != length {
        return Err(format!("the state keeps its {length} numbers, found {}", view.state.len()));
    }
    let places = view.goals.iter().flat_map(|goal| goal.position);
    if let Some(wrong) =
        view.state.iter().copied().chain(view.position).chain(places).find(|value| !value.is_finite())
    {
        return Err(format!("state and positions are finite, found {wrong}"));
    }
    goals(plant)?;
    picture(plant)
}

fn goals(plant: &dyn Plant) -> Result<(), String> {
    let goals = plant.view().goals.to_vec();
    if goals.is_empty() || goals.len() > MAX_GOALS {
        return Err(format!("there are 1 to {MAX_GOALS} goals, found {}", goals.len()));
    }
    let twice = |(index, goal): (usize, &crate::plant::Goal)| goals[..index].iter().any(|g| g.id == goal.id);
    if goals.iter().enumerate().any(twice) {
        return Err("every goal has an id of its own".into());
    }
    if plant.pilot_goal() >= goals.len() {
        return Err(format!("pilot_goal() is one of {} goals, found {}", goals.len(), plant.pilot_goal()));
    }
    let scene = plant.scene();
    let marked = |id: u32| {
        scene.fixed.iter().chain(&scene.movable).any(|part| part.role == Role::Goal && part.goal == Some(id))
    };
    match goals.iter().find(|goal| !marked(goal.id)) {
        Some(goal) => Err(format!("the scene marks every goal with a part, but not goal {}", goal.id)),
        None => Ok(()),
    }
}

fn picture(plant: &dyn Plant) -> Result<(), String> {
    let (mut poses, movable) = (Vec::new(), plant.scene().movable.len());
    plant.poses(&mut poses);
    if poses.len() != movable {
        return Err(format!("there is a pose for each of {movable} movable parts, found {}", poses.len()));
    }
    let drawable = |pose: &crate::scene::Pose| {
        [pose.x, pose.y, pose.angle_rad].iter().all(|value| value.is_finite())
            && (0.0..=1.0).contains(&pose.strength)
    };
    match poses.iter().find(|pose| !drawable(pose)) {
        Some(pose) => Err(format!("poses are finite and of strength 0 to 1, found {pose:?}")),
        None => Ok(()),
    }
}

/// Anything that may be carried out: nothing, a command, axes within their range.
fn any_action(space: &ActionSpace, draws: &mut Draws) -> Option<Action> {
    if draws.chance(0.1) {
        return None;
    }
    Some(match space {
        ActionSpace::Axes { low, high, .. } => {
            let mut axes = [0.0; 4];
            for (axis, (&low, &high)) in axes.iter_mut().zip(low.iter().zip(high)) {
                *axis = draws.uniform(low.into(), high.into()) as f32;
            }
            Action::Axes(axes)
        }
        _ => Action::Command(draws.below(space.commands()) as u8),
    })
}

fn broken(plant: &dyn Plant, seed: u64, law: &str) -> Broken {
    Broken { law: law.into(), seed, tick: plant.view().tick }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::{Step, View};
    use crate::point::Point;
    use crate::scene::{Pose, Scene};

    /// A point with a fault.
    #[derive(Clone)]
    struct Faulty {
        point: Point,
        fault: &'static str,
        resets: u32,
    }

    impl Plant for Faulty {
        fn reset(&mut self, seed: u64) {
            self.resets += 1;
            self.point.reset(if self.fault == "bits" { seed + u64::from(self.resets) } else { seed });
        }

        fn step(&mut self, executed: Option<Action>) -> Step {
            let step = self.point.step(executed);
            let reward = if self.fault == "finite" { f64::NAN } else { step.reward };
            let ending = if self.fault == "limit" { None } else { step.ending };
            Step { reward, ending }
        }

        fn view(&self) -> View<'_> {
            let view = self.point.view();
            let goals = if self.fault == "goals" { &view.goals[..0] } else { view.goals };
            View { goals, ..view }
        }

        fn pilot_goal(&self) -> usize {
            self.point.pilot_goal()
        }

        fn space(&self) -> &ActionSpace {
            self.point.space()
        }

        fn limit_ticks(&self) -> Option<u32> {
            self.point.limit_ticks()
        }

        fn scene(&self) -> Scene {
            let mut scene = self.point.scene();
            if self.fault == "marks" {
                scene.fixed.clear();
            }
            scene
        }

        fn poses(&self, poses: &mut Vec<Pose>) {
            self.point.poses(poses);
            if self.fault == "pose" {
                poses.clear();
            }
        }

        fn snapshot(&self) -> Option<Box<dyn Plant>> {
            let mut copy = self.clone();
            if self.fault == "snapshot" {
                copy.step(None);
            }
            Some(Box::new(copy))
        }
    }

    #[test]
    fn every_fault_is_named() {
        for fault in ["bits", "finite", "limit", "goals", "marks", "pose", "snapshot"] {
            let error = check(&mut Faulty { point: Point::new(), fault, resets: 0 }, 0..3).unwrap_err();
            assert!(error.to_string().contains(fault), "{fault}: {error}");
        }
        check(&mut Faulty { point: Point::new(), fault: "none", resets: 0 }, 0..3).unwrap();
    }
}
