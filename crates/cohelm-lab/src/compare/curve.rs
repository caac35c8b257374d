//! The line of constant tolerances, and how far above or below it a rule stands.

use super::stand::{REPLACED, SUCCESS, Stand};
use cohelm_study::statistics::{Interval, Undefined};
use serde::Serialize;

/// Success of constant tolerances over how much they replace, joined by straight lines.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// The tolerances, flown by the same people.
    pub stands: Vec<Stand>,
}

/// A rule against the curve where that replaces as much.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Margin {
    /// Success of the rule minus that of the curve.
    pub success: f64,
    /// Its interval over people.
    pub interval: Interval,
}

/// What a margin says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Against {
    /// The whole interval lies above the curve.
    Above,
    /// It holds the curve.
    On,
    /// The whole interval lies below the curve.
    Below,
}

impl Margin {
    /// What it says.
    pub fn against(&self) -> Against {
        match (self.interval.low > 0.0, self.interval.high < 0.0) {
            (true, _) => Against::Above,
            (_, true) => Against::Below,
            _ => Against::On,
        }
    }
}

impl Against {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Above => "above the line",
            Self::On => "not told apart from the line",
            Self::Below => "below the line",
        }
    }
}

impl Curve {
    /// How a rule that the same people flew stands against it.
    pub(super) fn margin(&self, stand: &Stand) -> Result<Margin, Undefined> {
        let above = |chosen: &[usize]| {
            let points = self.points(chosen);
            let at = stand.mean_of(REPLACED, chosen);
            Some(stand.mean_of(SUCCESS, chosen) - on_line(&points, at))
        };
        let margin = stand.resampled(above)?;
        Ok(Margin { success: margin.estimate, interval: margin.interval })
    }

    /// How much each tolerance replaces and its success among all people, by the former.
    pub fn line(&self) -> Vec<(f64, f64)> {
        let everybody: Vec<usize> = (0..self.stands.first().map_or(0, |stand| stand.units.len())).collect();
        self.points(&everybody)
    }

    pub(super) fn among(&self, populations: &[cohelm::human::Population]) -> Self {
        Self { stands: self.stands.iter().map(|stand| stand.among(populations)).collect() }
    }

    fn points(&self, chosen: &[usize]) -> Vec<(f64, f64)> {
        let point = |stand: &Stand| (stand.mean_of(REPLACED, chosen), stand.mean_of(SUCCESS, chosen));
        let mut points: Vec<(f64, f64)> = self.stands.iter().map(point).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    }
}

/// The height of a line through points sorted by x; beyond its ends that of the nearer end.
fn on_line(points: &[(f64, f64)], x: f64) -> f64 {
    let after = points.partition_point(|point| point.0 <= x);
    match (after.checked_sub(1).and_then(|before| points.get(before)), points.get(after)) {
        (Some(&(x0, y0)), Some(&(x1, y1))) => y0 + (x - x0) / (x1 - x0) * (y1 - y0),
        (Some(&(_, y)), None) | (None, Some(&(_, y))) => y,
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::on_line;

    #[test]
    fn the_line_is_straight_between_points_and_flat_beyond() {
        let points = [(0.2, 0.5), (0.4, 0.9), (0.4, 0.8), (0.8, 1.0)];
        for (x, y) in [(0.0, 0.5), (0.2, 0.5), (0.3, 0.7), (0.6, 0.9), (0.8, 1.0), (1.0, 1.0)] {
            assert!((on_line(&points, x) - y).abs() < 1e-12, "{x}: {}", on_line(&points, x));
        }
    }
}
