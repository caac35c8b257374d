//! Where things are in an episode: terrain, the pads, and which of them the pilot wants at first.
//!
//! Sizes follow Gymnasium's world (20 × 13.3 units); what is drawn at random is drawn from the seed and nothing else.

use super::state::position_of_world;
use super::surface::Surface;
use crate::craft::{Ground, Start, WORLD_HEIGHT, WORLD_WIDTH};
use cohelm::plant::Goal;
use cohelm::random::Draws;

/// How many pads there are unless the options say otherwise.
pub const PADS: usize = 3;
/// The most there can be.
pub const MOST_PADS: usize = 4;
/// Terrain heights between these shares of the world's height, before smoothing.
const HEIGHT_SHARES: [f64; 2] = [0.10, 0.40];
/// Evenly spaced terrain vertices before pads are cut in.
const VERTICES: usize = 11;
/// Pad centres stay this far from the sides of the world.
const MARGIN: f64 = 2.5;
/// Pads of usual width have their centres at least this far apart.
const CENTRE_DISTANCE: f64 = 3.6;
/// At least this much ground lies between two pads, and between a pad and the next vertex about half of it.
const GAP: f64 = 0.6;
/// The ground goes on beyond the sides, so that a leg at the edge does not fall into nothing.
const OVERHANG: f64 = 2.0;
/// Largest component of the random push at the start, as in Gymnasium.
const LARGEST_PUSH: f64 = 1000.0;

/// Each purpose draws from a stream of its own, so that drawing more for one shifts no other.
pub(crate) mod purpose {
    pub const SCENERY: u64 = 0;
    pub const START: u64 = 1;
    pub const SCATTER: u64 = 2;
    pub const COURSE: u64 = 3;
}

/// One episode's scenery. Shared by all snapshots of the episode.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    /// The ground's surface with the pads in it.
    pub surface: Surface,
    /// The same for the physics.
    pub ground: Ground,
    /// Centres of the pads on the ground, by x, world units.
    pub pads: Vec<[f64; 2]>,
    /// The pads as goals: where the hull is when the craft stands on them, normalised.
    pub goals: Vec<Goal>,
    /// Which of them the pilot wants at first.
    pub first_wish: usize,
    /// Half of each pad's width, world units.
    pub half_width: f64,
}

impl Layout {
    /// The scenery of a seed.
    pub fn draw(seed: u64, half_width: f64, pads: usize) -> Self {
        let mut draws = Draws::fork(seed, purpose::SCENERY);
        let terrain = terrain(&mut draws);
        let centres = pad_centres(&mut draws, half_width, pads);
        Self::new(&terrain, &centres, half_width, draws.below(pads))
    }

    /// Pads cut into a terrain at the given x, from left to right.
    pub fn new(terrain: &Surface, centres: &[f64], half_width: f64, first_wish: usize) -> Self {
        let pads: Vec<[f64; 2]> = centres.iter().map(|&x| [x, terrain.height_at(x)]).collect();
        let surface = terrain.with_flats(&pads, half_width, GAP / 2.0);
        let ground =
            Ground::polyline(surface.vertices()).expect("pads and vertices are kept apart and in order");
        let goal = |(id, &pad): (usize, &[f64; 2])| Goal { id: id as u32, position: standing_at(pad) };
        let goals = pads.iter().enumerate().map(goal).collect();
        Self { surface, ground, pads, goals, first_wish, half_width }
    }

    /// Gymnasium's start: top centre, with a random push.
    pub fn start_at_the_top(&self, seed: u64) -> Start {
        let mut draws = Draws::fork(seed, purpose::START);
        let mut push = || draws.uniform(-LARGEST_PUSH, LARGEST_PUSH);
        let push = [push(), push()];
        Start { push, ..Start::at(WORLD_WIDTH / 2.0, WORLD_HEIGHT) }
    }

    /// Whether a craft whose hull is at `x` stands on the pad of that index.
    pub fn is_at(&self, pad: usize, x: f64) -> bool {
        (x - self.pads[pad][0]).abs() <= self.half_width
    }
}

/// Where the hull is when the craft stands on a point of the ground, normalised.
fn standing_at([x, y]: [f64; 2]) -> [f32; 2] {
    position_of_world([x, y + super::state::STANDING_HEIGHT]).map(|p| p as f32)
}

/// Each vertex is the mean of three neighbouring heights, so that slopes stay moderate.
fn terrain(draws: &mut Draws) -> Surface {
    let [low, high] = HEIGHT_SHARES.map(|share| share * WORLD_HEIGHT);
    let heights: [f64; VERTICES + 2] = core::array::from_fn(|_| draws.uniform(low, high));
    let smoothed = heights.windows(3).map(|three| (three[0] + three[1] + three[2]) / 3.0);
    let spacing = WORLD_WIDTH / (VERTICES - 1) as f64;
    let mut vertices: Vec<[f64; 2]> = smoothed.enumerate().map(|(i, y)| [i as f64 * spacing, y]).collect();
    let (first, last) = (vertices[0][1], vertices[VERTICES - 1][1]);
    vertices.insert(0, [-OVERHANG, first]);
    vertices.push([WORLD_WIDTH + OVERHANG, last]);
    Surface::new(vertices)
}

/// Uniform over all places that keep the pads apart: sorted uniform draws over what is left when the distances are
/// taken out, and the distances put back in.
fn pad_centres(draws: &mut Draws, half_width: f64, pads: usize) -> Vec<f64> {
    let apart = f64::max(CENTRE_DISTANCE, 2.0 * half_width + GAP);
    let free = WORLD_WIDTH - 2.0 * MARGIN - (pads - 1) as f64 * apart;
    let mut offsets: Vec<f64> = (0..pads).map(|_| draws.uniform(0.0, free)).collect();
    offsets.sort_by(f64::total_cmp);
    offsets.iter().enumerate().map(|(i, offset)| MARGIN + offset + i as f64 * apart).collect()
}

/// The widest pads, by their half, of which that many fit side by side.
pub(crate) fn widest(pads: usize) -> f64 {
    0.5 * ((WORLD_WIDTH - 2.0 * MARGIN) / pads.saturating_sub(1).max(1) as f64 - GAP)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layouts(half_width: f64) -> impl Iterator<Item = Layout> {
        (0..300).map(move |seed| Layout::draw(seed, half_width, PADS))
    }

    #[test]
    fn pads_lie_apart_within_the_world_and_in_order_of_x() {
        for half_width in [0.8, 1.5, 2.5] {
            for layout in layouts(half_width) {
                let &[[a, _], [b, _], [c, _]] = layout.pads.as_slice() else { panic!("three pads") };
                let apart = f64::max(3.6, 2.0 * half_width + 0.6) - 1e-9;
                assert!(a >= 2.5 && c <= 17.5 && b - a >= apart && c - b >= apart, "{a} {b} {c}");
                assert!(layout.goals.windows(2).all(|pair| pair[0].position[0] < pair[1].position[0]));
                assert!((0..).zip(&layout.goals).all(|(id, goal)| goal.id == id));
            }
        }
    }

    #[test]
    fn one_to_four_pads_lie_within_the_world_as_wide_as_may_be() {
        for pads in 1..=MOST_PADS {
            for half_width in [0.8, f64::min(2.5, widest(pads))] {
                let layout = Layout::draw(7, half_width, pads);
                assert_eq!((layout.pads.len(), layout.goals.len()), (pads, pads));
                assert!(layout.pads.iter().all(|[x, _]| (2.5 - 1e-9..=17.5 + 1e-9).contains(x)), "{pads}");
            }
        }
    }

    #[test]
    fn pads_are_flat_and_the_terrain_keeps_its_height() {
        for layout in layouts(1.5) {
            for &[x, y] in &layout.pads {
                for offset in [-1.5, -0.7, 0.0, 1.2, 1.5] {
                    assert!((layout.surface.height_at(x + offset) - y).abs() < 1e-12);
                }
            }
            let low_and_high = 0.1 * WORLD_HEIGHT..=0.4 * WORLD_HEIGHT;
            assert!(layout.surface.vertices().iter().all(|[_, y]| low_and_high.contains(y)));
        }
    }

    #[test]
    fn every_pad_is_the_pilots_equally_often() {
        let mut counts = [0; PADS];
        layouts(1.5).for_each(|layout| counts[layout.first_wish] += 1);
        // 300 draws, p = 1/3: the standard deviation is 8.2.
        assert!(counts.iter().all(|&count| (70..=130).contains(&count)), "{counts:?}");
    }

    #[test]
    fn places_are_uniform_over_what_is_allowed() {
        // By symmetry the middle pad is in the middle on average: the standard deviation of its mean is 0.1.
        let middle = layouts(1.5).map(|layout| layout.pads[1][0]).sum::<f64>() / 300.0;
        assert!((middle - 10.0).abs() < 0.4, "{middle}");
        // The distance beyond 3.6 of two neighbours is (15 − 7.2)/4 on average.
        let gap = layouts(1.5).map(|layout| layout.pads[1][0] - layout.pads[0][0]).sum::<f64>() / 300.0;
        assert!((gap - 3.6 - 7.8 / 4.0).abs() < 0.4, "{gap}");
    }
}
