//! Calibration: how often the inferred goal was right where the co-pilot was that sure.

use super::axis::{Axis, Scale};
use super::frame::{self, Area, Heading, MARGIN, SMALL, TICK_ROOM};
use super::palette::{Colour, Condition, Conditions};
use super::scene::{Fill, Label, Scene, Stroke};
use super::{Figure, FigureError, require_length, require_some};
use crate::csv::{Cell, Csv};

/// A reliability diagram: the share of right goals over the confidence, a curve a condition, with the diagonal on which a
/// calibrated confidence lies and, below, how the ticks are spread over the confidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Reliability {
    /// Title and reading aid.
    pub heading: Heading,
    /// The conditions with their looks.
    pub conditions: Conditions,
    /// `classes[condition]`: the classes of the confidence that have ticks, lowest first.
    pub classes: Vec<Vec<Bin>>,
}

/// The ticks of one class of the confidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Mean confidence, 0 to 1.
    pub confidence: f64,
    /// Share of the ticks with the right goal, 0 to 1.
    pub right: f64,
    /// Share of the condition's ticks that lie in this class, 0 to 1.
    pub share: f64,
}

const WIDTH: f64 = 960.0;
const SIDE: f64 = 400.0;
const STRIP: f64 = 90.0;

impl Reliability {
    /// Draws the figure.
    ///
    /// # Errors
    /// No condition or class; lists of unequal length; values that are not finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        require_some("conditions", self.conditions.len())?;
        require_length("conditions", self.conditions.len(), self.classes.len())?;
        require_some("classes of the confidence", self.classes.iter().map(Vec::len).sum())?;
        let bins = || self.classes.iter().flatten();
        let x = Axis::share("Confidence c").scale(bins().map(|bin| bin.confidence), 5)?;
        let y = Axis::share("Goal inferred rightly").scale(bins().map(|bin| bin.right), 5)?;
        let spread = Axis { extent: super::Extent::FromZero, ..Axis::share("Ticks") };
        let spread = spread.scale(bins().map(|bin| bin.share), 2)?;
        let mut scene = Scene::new(WIDTH, 0.0);
        let top = frame::head(&mut scene, &self.heading, &self.conditions) + 30.0;
        let left = MARGIN + TICK_ROOM + (WIDTH - SIDE * 1.45) / 2.0 - MARGIN;
        let area = Area { left, top, right: left + SIDE * 1.3, bottom: top + SIDE };
        self.draw_curves(&mut scene, &area, (&x, &y));
        let strip = Area { top: area.bottom + 66.0, bottom: area.bottom + 66.0 + STRIP, ..area };
        self.draw_spread(&mut scene, &strip, (&x, &spread));
        scene.height = strip.bottom + 43.0 + MARGIN - 8.0;
        Ok(Figure { scene, description: self.description(), data: self.data() })
    }

    fn draw_curves(&self, scene: &mut Scene, area: &Area, (x, y): (&Scale, &Scale)) {
        frame::y_title(scene, area, "Goal inferred rightly");
        frame::y_axis(scene, area, y);
        let diagonal = [(area.x(x, 0.0), area.y(y, 0.0)), (area.x(x, 1.0), area.y(y, 1.0))];
        scene.line(diagonal, Stroke::solid(Colour::QUIET, 1.4).dashed(6.0));
        let at = (area.left + area.width() * 0.80, area.top + area.height() * 0.06);
        scene.label(Label::new("calibrated", at.0, at.1, SMALL).quiet().anchored(super::scene::Anchor::End));
        frame::base_line(scene, area, area.bottom);
        for (condition, bins) in self.conditions.as_slice().iter().zip(&self.classes) {
            let points: Vec<(f64, f64)> =
                bins.iter().map(|bin| (area.x(x, bin.confidence), area.y(y, bin.right))).collect();
            scene.line(points.clone(), Stroke::solid(condition.colour, 2.2));
            for (at, bin) in points.into_iter().zip(bins) {
                // A class of few ticks is uncertain: its mark is small.
                frame::dot(scene, condition, at, 3.0 + 5.0 * bin.share.sqrt());
            }
        }
    }

    fn draw_spread(&self, scene: &mut Scene, area: &Area, (x, y): (&Scale, &Scale)) {
        frame::y_title(scene, area, "Share of the ticks");
        frame::y_axis(scene, area, y);
        let count = self.conditions.len() as f64;
        let slot = area.width() / crate::measures::CLASSES as f64;
        for (c, (condition, bins)) in self.conditions.as_slice().iter().zip(&self.classes).enumerate() {
            for bin in bins {
                let class = class_of(bin.confidence) as f64;
                let bar = slot * 0.8 / count;
                let left = area.left + slot * (class + 0.1) + bar * c as f64;
                draw_bar(scene, condition, (left, left + bar), (area.y(y, bin.share), area.bottom));
            }
        }
        frame::base_line(scene, area, area.bottom);
        frame::x_labels(scene, area, x);
        frame::x_title(scene, area, "Confidence c");
    }

    fn description(&self) -> String {
        let curves = self.conditions.as_slice().iter().zip(&self.classes).map(|(condition, bins)| {
            let points: Vec<String> =
                bins.iter().map(|bin| format!("{:.2} at c = {:.2}", bin.right, bin.confidence)).collect();
            format!("{}: right {}", condition.name, points.join(", "))
        });
        format!("{}. {}.", self.heading.title, curves.collect::<Vec<_>>().join("; "))
    }

    fn data(&self) -> Csv {
        let mut csv = Csv::new(["condition", "confidence", "share_right", "share_of_ticks"]);
        for (condition, bins) in self.conditions.as_slice().iter().zip(&self.classes) {
            for bin in bins {
                let name = Cell::from(condition.name.as_str());
                csv.push([name, Cell::from(bin.confidence), Cell::from(bin.right), Cell::from(bin.share)]);
            }
        }
        csv
    }
}

fn draw_bar(scene: &mut Scene, condition: &Condition, (left, right): (f64, f64), (top, bottom): (f64, f64)) {
    scene.rectangle((left, top.min(bottom - 1.0)), (right, bottom), Fill::solid(condition.colour), None);
}

/// The class in which a confidence lies.
fn class_of(confidence: f64) -> usize {
    let classes = crate::measures::CLASSES;
    ((confidence * classes as f64) as usize).min(classes - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_what_it_is_given_and_refuses_nothing_at_all() {
        let bins = vec![
            Bin { confidence: 0.55, right: 0.8, share: 0.25 },
            Bin { confidence: 1.0, right: 0.9, share: 0.75 },
        ];
        let made = |classes| Reliability {
            heading: Heading::new("Calibration", ""),
            conditions: Conditions::in_order(["MISC"]),
            classes,
        };
        let figure = made(vec![bins]).figure().unwrap();
        assert!(figure.description().contains("0.80 at c = 0.55"));
        assert_eq!(figure.csv().rows().len(), 2);
        assert!(made(vec![vec![]]).figure().is_err());
        assert!(made(vec![]).figure().is_err());
    }
}
