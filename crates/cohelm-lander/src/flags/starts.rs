//! Starts of a given difficulty: from standing at the goal to a wide random start.

use super::surface::Surface;
use crate::craft::{Start, WORLD_HEIGHT, WORLD_WIDTH};
use cohelm::random::Draws;

/// Hull height above its pad at difficulty 0, world units: standing is 0.59, and from here it stands after a soft drop.
const LOWEST: f64 = 0.75;
/// How far from the hull's middle a leg may reach, world units.
const REACH: f64 = 1.2;

/// A start that is interpolated between standing on a pad (difficulty 0) and anywhere at any moderate speed
/// (difficulty 1); upright, without spin, engines off.
///
/// With d the difficulty and u uniform draws: x = x_pad + d·(u(2, 18) − x_pad), y = y_pad + 0.75 + d·(1 + u(0, 9)) but
/// at least 0.75 + 0.5·d above the ground and within the world, vx = d·u(−3, 3), vy = d·u(−4, 1). "The ground" is the
/// highest under the craft, not under its middle: beside a step the legs would otherwise start inside of it.
pub(crate) fn near_goal(
    [pad_x, pad_y]: [f64; 2],
    surface: &Surface,
    difficulty: f64,
    draws: &mut Draws,
) -> Start {
    let d = difficulty;
    let x = pad_x + d * (draws.uniform(2.0, WORLD_WIDTH - 2.0) - pad_x);
    let height = pad_y + LOWEST + d * (1.0 + draws.uniform(0.0, 9.0));
    let lowest = surface.highest_between(x - REACH, x + REACH) + LOWEST + 0.5 * d;
    let [vx, vy] = [[-3.0, 3.0], [-4.0, 1.0]].map(|[low, high]| d * draws.uniform(low, high));
    Start { vx, vy, ..Start::at(x, height.max(lowest).min(WORLD_HEIGHT)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start(difficulty: f64, seed: u64) -> Start {
        let surface = Surface::new(vec![[0.0, 1.0], [12.0, 1.0], [12.5, 5.0], [20.0, 5.0]]);
        near_goal([10.0, 1.0], &surface, difficulty, &mut Draws::new(seed))
    }

    #[test]
    fn difficulty_zero_stands_on_the_pad() {
        assert!((0..50).all(|seed| start(0.0, seed) == Start::at(10.0, 1.75)));
    }

    #[test]
    fn harder_starts_are_wider_and_never_inside_the_ground() {
        for seed in 0..300 {
            let (easy, hard) = (start(0.2, seed), start(1.0, seed));
            assert!((easy.x - 10.0).abs() <= 1.6 && easy.vx.abs() <= 0.6 && easy.y <= 5.85);
            assert!(
                (2.0..18.0).contains(&hard.x) && hard.y <= WORLD_HEIGHT && (-4.0..1.0).contains(&hard.vy)
            );
            assert!(hard.x < 10.8 || hard.y >= 5.0 + 1.25 || hard.x + 1.2 < 12.5);
        }
        let far = (0..300).filter(|&seed| (start(1.0, seed).x - 10.0).abs() > 5.0).count();
        assert!(far > 50, "{far}");
    }
}
