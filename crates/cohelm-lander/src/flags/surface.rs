//! The ground as a line of heights: to cut pads into, to start above, to draw.

/// Vertices from left to right, world units; straight in between.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Surface(Vec<[f64; 2]>);

impl Surface {
    /// A surface through at least one vertex; x must grow.
    pub fn new(vertices: Vec<[f64; 2]>) -> Self {
        debug_assert!(!vertices.is_empty() && vertices.windows(2).all(|pair| pair[0][0] < pair[1][0]));
        Self(vertices)
    }

    /// The vertices.
    pub fn vertices(&self) -> &[[f64; 2]] {
        &self.0
    }

    /// Height of the ground at `x`; beyond the ends that of the end.
    pub fn height_at(&self, x: f64) -> f64 {
        let right = self.0.partition_point(|vertex| vertex[0] <= x);
        match (right.checked_sub(1).map(|left| self.0[left]), self.0.get(right)) {
            (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
            (Some([_, y]), None) => y,
            (None, right) => right.map_or(0.0, |vertex| vertex[1]),
        }
    }

    /// The greatest height between `left` and `right`.
    pub fn highest_between(&self, left: f64, right: f64) -> f64 {
        let ends = self.height_at(left).max(self.height_at(right));
        let within = self.0.iter().filter(|vertex| (left..=right).contains(&vertex[0]));
        within.fold(ends, |highest, vertex| highest.max(vertex[1]))
    }

    /// The surface with flats around `centres` (in order, not overlapping); vertices within a flat or less than
    /// `clear` beside it give way.
    pub fn with_flats(&self, centres: &[[f64; 2]], half_width: f64, clear: f64) -> Surface {
        let gives_way = |vertex: &[f64; 2]| {
            centres.iter().any(|centre| (vertex[0] - centre[0]).abs() < half_width + clear)
        };
        let mut vertices: Vec<[f64; 2]> =
            self.0.iter().copied().filter(|vertex| !gives_way(vertex)).collect();
        vertices.extend(centres.iter().flat_map(|&[x, y]| [[x - half_width, y], [x + half_width, y]]));
        vertices.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Surface::new(vertices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope() -> Surface {
        Surface::new(vec![[0.0, 1.0], [2.0, 3.0], [4.0, 2.0]])
    }

    #[test]
    fn heights_are_linear_between_vertices_and_level_beyond() {
        let at = |x| slope().height_at(x);
        assert_eq!(
            [at(-1.0), at(0.0), at(1.0), at(2.0), at(3.0), at(4.0), at(9.0)],
            [1.0, 1.0, 2.0, 3.0, 2.5, 2.0, 2.0]
        );
    }

    #[test]
    fn the_highest_point_may_be_an_end_or_a_vertex() {
        assert_eq!(slope().highest_between(1.0, 3.0), 3.0);
        assert_eq!(slope().highest_between(0.0, 1.0), 2.0);
    }

    #[test]
    fn a_flat_replaces_the_vertices_beside_it() {
        let flat = slope().with_flats(&[[2.5, 2.75]], 0.5, 0.3);
        assert_eq!(flat.vertices(), [[0.0, 1.0], [2.0, 2.75], [3.0, 2.75], [4.0, 2.0]]);
    }
}
