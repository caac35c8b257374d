//! Safe-nearest by roll-outs. Formula: the a most similar to a_h after which, carried out for `hold` ticks and followed by
//! the robot's best actions, the plant is still whole at `horizon`; if there is none, the robot's best. Source: minimal
//! intervention by sampled trajectories, Broad, Murphey and Argall 2019, "Highly parallelized data-driven MPC for minimal
//! intervention shared control" (RSS), which learns a model of the plant where we fly a copy of it. At `horizon` = 0 whatever
//! is asked; as `hold` grows it steps in earlier. It cares about crashes, not about goals. Of more
//! candidates than [`FLIGHTS`], as on axes, only every so many are tried, in order of likeness.

use super::{Arbiter, Needs, Pick, Stage};

/// Most flights ahead at one tick: a flight of forty ticks costs thirty times all else that is decided there.
pub const FLIGHTS: usize = 10;

/// The most similar action after which the robot can still save the plant; the robot's best if there is none.
#[derive(Clone, Copy, Debug)]
pub struct SafeNearest {
    /// Ticks for which the action is thought to be held: how long the person may stay with it.
    pub hold: u32,
    /// Ticks that are flown ahead, those of `hold` included: how late a crash may come and still count.
    pub horizon: u32,
}

impl Arbiter for SafeNearest {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        let robot = stage.values.best();
        let every = allowed.len().div_ceil(FLIGHTS);
        let nearest = match (stage.likeness, stage.ahead) {
            // While none is found, `allowed` marks those that were passed by or broke the plant.
            (Some(_), Some(ahead)) => std::iter::from_fn(|| {
                let next = stage.most_alike_but(allowed)?;
                allowed[next] = true;
                Some(next)
            })
            .step_by(every.max(1))
            .find(|&candidate| ahead.is_safe(candidate, self.hold, self.horizon)),
            _ => None,
        };
        allowed.fill(false);
        allowed[nearest.unwrap_or(robot)] = true;
        Pick::Candidate(nearest.unwrap_or(robot))
    }

    fn needs(&self) -> Needs {
        Needs { look_ahead: true, ..Needs::default() }
    }
}
