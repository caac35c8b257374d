//! How a critic sees an action on axes, and which actions it is asked about.
//!
//! An axis is cut by [`KNOTS`] evenly spaced knots, and a value on it is shown by how near it is to the two knots beside
//! it (tents, as in tile coding), and by its sign. A network learns from tents a little of its own about every part of an
//! axis, where from the bare number it would have to bend a line; and plants jump where an axis leaves 0, such as an
//! engine that does not burn below half of its thrust.

use cohelm::action::{Action, ActionSpace};
use cohelm_nn::critic::Feature;

/// Knots on an axis, its ends included. Few: near actions look alike; many: each is learnt from fewer flights.
pub const KNOTS: usize = 9;
/// Numbers that show one axis: the knots, and whether it is above or below 0.
const PER_AXIS: usize = KNOTS + 2;
/// Numbers of them that are not 0, at most: two knots and a sign.
const SHOWN: usize = 3;
/// Most axes that an action has.
const MOST_AXES: usize = 4;

/// Turns actions on axes into what a critic sees.
#[derive(Clone, Debug, PartialEq)]
pub struct AxesEncoder {
    low: Vec<f32>,
    high: Vec<f32>,
}

/// An encoded action, the zeros left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoded {
    features: [Feature; SHOWN * MOST_AXES],
    length: usize,
}

impl Encoded {
    /// Places and numbers.
    pub fn features(&self) -> &[Feature] {
        &self.features[..self.length]
    }
}

impl AxesEncoder {
    /// For the axes of a space; `None` if it has none, or one whose ends are not two finite numbers with 0 between or at
    /// them.
    pub fn of(space: &ActionSpace) -> Option<Self> {
        let ActionSpace::Axes { low, high, .. } = space else { return None };
        let sound = |(low, high): (&f32, &f32)| {
            low.is_finite() && high.is_finite() && low < high && *low <= 0.0 && *high >= 0.0
        };
        let fits = (1..=MOST_AXES).contains(&low.len()) && low.len() == high.len();
        (fits && low.iter().zip(high).all(sound)).then(|| Self { low: low.clone(), high: high.clone() })
    }

    /// How many axes there are.
    pub fn axes(&self) -> usize {
        self.low.len()
    }

    /// Numbers that show an action.
    pub fn len(&self) -> usize {
        PER_AXIS * self.axes()
    }

    /// Never true: there is at least one axis.
    pub fn is_empty(&self) -> bool {
        self.low.is_empty()
    }

    /// Shows an action; beyond an end of an axis it looks like the end.
    pub fn encode(&self, action: Action) -> Encoded {
        let mut features = [(0, 0.0); SHOWN * MOST_AXES];
        for (axis, shown) in features.chunks_exact_mut(SHOWN).take(self.axes()).enumerate() {
            let (first, value) = (axis * PER_AXIS, action.axis(axis));
            let span = self.high[axis] - self.low[axis];
            let at = ((value - self.low[axis]) / span * (KNOTS - 1) as f32).clamp(0.0, (KNOTS - 1) as f32);
            let knot = (at as usize).min(KNOTS - 2);
            let beyond = at - knot as f32;
            shown[0] = (first + knot, 1.0 - beyond);
            shown[1] = (first + knot + 1, beyond);
            let sign = if value == 0.0 { 0.0 } else { 1.0 };
            shown[2] = (first + KNOTS + usize::from(value < 0.0), sign);
        }
        Encoded { features, length: SHOWN * self.axes() }
    }

    /// The same with the zeros, into a row of [`len`](Self::len) numbers.
    pub fn encode_into(&self, action: Action, row: &mut [f32]) {
        row.fill(0.0);
        for &(place, number) in self.encode(action).features() {
            row[place] = number;
        }
    }

    /// The action at a point whose coordinates lie in [0, 1], from the lower to the upper end of each axis.
    pub fn at(&self, point: [f32; 4]) -> Action {
        let mut axes = [0.0; 4];
        for (axis, value) in axes.iter_mut().enumerate().take(self.axes()) {
            *value = self.within(axis, self.low[axis] + point[axis] * (self.high[axis] - self.low[axis]));
        }
        Action::Axes(axes)
    }

    /// `action` moved by a share of half of each axis, as far as the axes go.
    pub fn moved(&self, action: Action, by: [f32; 4], share: f32) -> Action {
        let mut axes = [0.0; 4];
        for (axis, value) in axes.iter_mut().enumerate().take(self.axes()) {
            let half = 0.5 * (self.high[axis] - self.low[axis]);
            *value = self.within(axis, action.axis(axis) + by[axis] * share * half);
        }
        Action::Axes(axes)
    }

    /// `from` a share of the way towards `to`.
    pub fn between(&self, from: Action, to: Action, share: f32) -> Action {
        let mut axes = [0.0; 4];
        for (axis, value) in axes.iter_mut().enumerate().take(self.axes()) {
            let (from, to) = (from.axis(axis), to.axis(axis));
            *value = self.within(axis, from + share * (to - from));
        }
        Action::Axes(axes)
    }

    fn within(&self, axis: usize, value: f32) -> f32 {
        value.clamp(self.low[axis], self.high[axis])
    }

    /// `count` actions that are spread over the space: nothing, each axis at either end alone, the corners, and points of
    /// low discrepancy for the rest.
    pub fn grid(&self, count: usize) -> Vec<Action> {
        let mut grid = vec![Action::Axes([0.0; 4])];
        for axis in 0..self.axes() {
            for end in [self.low[axis], self.high[axis]] {
                let mut axes = [0.0; 4];
                axes[axis] = end;
                grid.push(Action::Axes(axes));
            }
        }
        if self.axes() > 1 {
            let end = |corner: usize, axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { 0.0 };
            let corner = |corner: usize| self.at(core::array::from_fn(|axis| end(corner, axis)));
            grid.extend((0..1 << self.axes()).map(corner));
        }
        let spread = Spread::over(self.axes());
        grid.extend((0..count).map(|index| self.at(spread.point(index, [0.0; 4]))));
        grid.truncate(count);
        grid
    }
}

/// Points of low discrepancy in the unit cube: multiples of the powers of 1/φ, where φ is the positive root of
/// φᵈ⁺¹ = φ + 1 (the additive recurrence R of Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    steps: [f64; 4],
}

/// φ for one to four dimensions.
const ROOTS: [f64; MOST_AXES] =
    [1.618_033_988_749_895, 1.324_717_957_244_746, 1.220_744_084_605_76, 1.167_303_978_261_419];

impl Spread {
    /// In that many dimensions, from one to four.
    pub fn over(dimensions: usize) -> Self {
        let root = ROOTS[dimensions.clamp(1, MOST_AXES) - 1];
        let mut steps = [0.0; 4];
        let mut power = 1.0;
        for step in steps.iter_mut().take(dimensions) {
            power /= root;
            *step = power;
        }
        Self { steps }
    }

    /// The point of a number, all points being shifted alike; what leaves the cube comes in at the other side (a rotation
    /// of Cranley and Patterson).
    pub fn point(&self, number: usize, shift: [f64; 4]) -> [f32; 4] {
        core::array::from_fn(|i| {
            let at = 0.5 + (number + 1) as f64 * self.steps[i] + shift[i];
            at.fract() as f32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space(low: &[f32], high: &[f32]) -> ActionSpace {
        let names = low.iter().map(|_| "axis".to_owned()).collect();
        ActionSpace::Axes { names, low: low.to_vec(), high: high.to_vec() }
    }

    fn thrust_and_side() -> AxesEncoder {
        AxesEncoder::of(&space(&[0.0, -1.0], &[2.0, 1.0])).unwrap()
    }

    #[test]
    fn a_value_lies_between_its_two_knots_and_has_a_sign() {
        let mut row = [9.0; 22];
        thrust_and_side().encode_into(Action::axes(&[1.0625, -0.125]), &mut row);
        let mut expected = [0.0; 22];
        (expected[4], expected[5], expected[9]) = (0.75, 0.25, 1.0);
        (expected[11 + 3], expected[11 + 4], expected[11 + 10]) = (0.5, 0.5, 1.0);
        assert_eq!(row, expected);
        thrust_and_side().encode_into(Action::axes(&[2.0, 0.0]), &mut row);
        assert_eq!((row[8], row[9], row[11 + 4]), (1.0, 1.0, 1.0));
        assert_eq!(row.iter().sum::<f32>(), 3.0, "0 has no sign");
    }

    #[test]
    fn the_grid_holds_nothing_the_ends_and_the_corners_and_stays_within() {
        for (low, high) in
            [(vec![-1.0], vec![1.0]), (vec![0.0, -1.0], vec![2.0, 1.0]), (vec![-1.0; 4], vec![1.0; 4])]
        {
            let space = space(&low, &high);
            let grid = AxesEncoder::of(&space).unwrap().grid(64);
            assert_eq!(grid.len(), 64);
            assert!(grid.iter().all(|&action| space.contains(action)));
            assert!(grid.contains(&Action::axes(&[])) && grid.contains(&Action::axes(&high)));
            assert!(grid.contains(&Action::axes(&low)) && grid.contains(&Action::axes(&high[..1])));
        }
    }

    #[test]
    fn no_large_hole_is_left_in_the_grid() {
        let grid = AxesEncoder::of(&space(&[-1.0; 2], &[1.0; 2])).unwrap().grid(64);
        for (x, y) in
            (0..21).flat_map(|i| (0..21).map(move |j| (i as f32 / 10.0 - 1.0, j as f32 / 10.0 - 1.0)))
        {
            let distance = |action: &Action| (action.axis(0) - x).hypot(action.axis(1) - y);
            let nearest = grid.iter().map(distance).fold(f32::INFINITY, f32::min);
            assert!(nearest < 0.3, "({x}, {y}): {nearest}");
        }
    }

    #[test]
    fn moving_and_mixing_stay_within_the_axes() {
        let axes = thrust_and_side();
        let (a, b) = (Action::axes(&[2.0, 0.5]), Action::axes(&[0.0, -0.5]));
        assert_eq!(axes.moved(a, [1.0, -1.0, 1.0, 1.0], 0.25), Action::axes(&[2.0, 0.25]));
        assert_eq!(axes.between(a, b, 0.25), Action::axes(&[1.5, 0.25]));
    }

    #[test]
    fn axes_that_cannot_be_are_refused() {
        for (low, high) in [(1.0, 2.0), (0.0, 0.0), (f32::NEG_INFINITY, 1.0), (-1.0, f32::NAN)] {
            assert_eq!(AxesEncoder::of(&space(&[low], &[high])), None, "{low}..{high}");
        }
        assert_eq!(AxesEncoder::of(&space(&[], &[])), None);
        assert_eq!(AxesEncoder::of(&ActionSpace::Switches { switches: vec![] }), None);
    }
}
