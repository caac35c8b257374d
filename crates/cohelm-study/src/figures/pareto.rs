//! A scatter of two goods that pull against each other, with the front of what nothing beats on both.

use super::axis::{Axis, Scale};
use super::font::{Weight, width};
use super::frame::{self, Area, Heading, MARGIN, SMALL, TICK_ROOM};
use super::palette::{Colour, Conditions};
use super::scene::{Anchor, Label, Scene, Stroke};
use super::{Figure, FigureError, require_some};
use crate::csv::{Cell, Csv};
use crate::statistics::Interval;

/// Which direction of an axis is good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// Less is better.
    Lower,
    /// More is better.
    Higher,
}

/// One point.
#[derive(Debug, Clone, PartialEq)]
pub struct ParetoPoint {
    /// Written beside the point.
    pub label: String,
    /// Index into the figure's conditions, for colour and mark.
    pub condition: usize,
    /// Horizontal and vertical value.
    pub at: (f64, f64),
    /// Intervals of both, where known.
    pub intervals: (Option<Interval>, Option<Interval>),
}

/// Points with the Pareto front drawn through those that no other beats on both axes.
#[derive(Debug, Clone, PartialEq)]
pub struct ParetoScatter {
    /// Title and reading aid.
    pub heading: Heading,
    /// The horizontal axis and its good direction.
    pub x: (Axis, Better),
    /// The vertical axis and its good direction.
    pub y: (Axis, Better),
    /// The conditions with their looks.
    pub conditions: Conditions,
    /// The points.
    pub points: Vec<ParetoPoint>,
    /// A curve to read the points against, if there is one.
    pub behind: Option<Behind>,
}

/// A curve behind the points, such as what one parameter alone reaches.
#[derive(Debug, Clone, PartialEq)]
pub struct Behind {
    /// What it is, in a few words; written above the points.
    pub name: String,
    /// Its corners, in order.
    pub line: Vec<(f64, f64)>,
}

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 600.0;

impl ParetoScatter {
    /// Draws the figure.
    ///
    /// # Errors
    /// No point, an unknown condition, values that are not finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        require_some("points", self.points.len())?;
        let largest = self.points.iter().map(|p| p.condition).max().unwrap_or(0);
        if largest >= self.conditions.len() {
            let (expected, found) = (largest + 1, self.conditions.len());
            return Err(FigureError::Length { of: "conditions", expected, found });
        }
        let ends = |i: Option<Interval>| i.into_iter().flat_map(|i| [i.low, i.high]);
        let line = || self.behind.iter().flat_map(|behind| &behind.line);
        let xs = self.points.iter().flat_map(|p| ends(p.intervals.0).chain([p.at.0]));
        let ys = self.points.iter().flat_map(|p| ends(p.intervals.1).chain([p.at.1]));
        let x = self.x.0.scale(xs.chain(line().map(|at| at.0)), 6)?;
        let y = self.y.0.scale(ys.chain(line().map(|at| at.1)), 6)?;
        let mut scene = Scene::new(WIDTH, HEIGHT);
        let top = frame::head(&mut scene, &self.heading, &Conditions::in_order([])) + 30.0;
        let area = Area {
            left: MARGIN + TICK_ROOM,
            top,
            right: WIDTH - MARGIN,
            bottom: HEIGHT - MARGIN - 43.0 + 8.0,
        };
        frame::y_title(&mut scene, &area, &self.y.0.title);
        frame::y_axis(&mut scene, &area, &y);
        frame::x_axis(&mut scene, &area, &x);
        frame::x_title(&mut scene, &area, &self.x.0.title);
        self.draw_behind(&mut scene, &area, (&x, &y));
        let front = self.draw_front(&mut scene, &area, &x, &y);
        self.draw_points(&mut scene, &area, (&x, &y), &front);
        self.draw_compass(&mut scene, &area);
        Ok(Figure { scene, description: self.description(), data: self.data() })
    }

    /// Indices of the points that no other point beats: none is at least as good on both axes and better on one. Sorted
    /// by the horizontal value.
    pub fn front(&self) -> Vec<usize> {
        let good = |p: &ParetoPoint| (signed(p.at.0, self.x.1), signed(p.at.1, self.y.1));
        let beats = |a: (f64, f64), b: (f64, f64)| a.0 >= b.0 && a.1 >= b.1 && a != b;
        let beaten = |p: &ParetoPoint| self.points.iter().any(|other| beats(good(other), good(p)));
        let mut front: Vec<usize> = (0..self.points.len()).filter(|&i| !beaten(&self.points[i])).collect();
        front.sort_by(|&i, &j| self.points[i].at.0.total_cmp(&self.points[j].at.0));
        front
    }

    /// Draws the curve behind the points, with its corners, and says what it is.
    fn draw_behind(&self, scene: &mut Scene, area: &Area, (x, y): (&Scale, &Scale)) {
        let Some(behind) = &self.behind else { return };
        let corners: Vec<(f64, f64)> =
            behind.line.iter().map(|at| (area.x(x, at.0), area.y(y, at.1))).collect();
        scene.line(corners.clone(), Stroke::solid(Colour::GREY, 5.0).faded(0.45));
        for at in corners {
            scene.line([(at.0 - 4.0, at.1), (at.0 + 4.0, at.1)], Stroke::solid(Colour::GREY, 4.0).faded(0.8));
        }
        let name = format!("grey line: {}", behind.name);
        let middle = f64::midpoint(area.left, area.right);
        scene.label(Label::new(name, middle, area.top - 17.0, SMALL).quiet().anchored(Anchor::Middle));
    }

    /// Draws the front as steps; returns its corners.
    fn draw_front(&self, scene: &mut Scene, area: &Area, x: &Scale, y: &Scale) -> Vec<(f64, f64)> {
        let front = self.front().into_iter().map(|i| &self.points[i]);
        let points: Vec<(f64, f64)> = front.map(|p| (area.x(x, p.at.0), area.y(y, p.at.1))).collect();
        let mut steps = Vec::new();
        for pair in points.windows(2) {
            // Between two points nothing better than a step is known; a straight line would claim more.
            let corner = match self.x.1 {
                Better::Lower => (pair[1].0, pair[0].1),
                Better::Higher => (pair[0].0, pair[1].1),
            };
            steps.extend([pair[0], corner, pair[1]]);
        }
        if steps.len() > 1 {
            scene.line(steps.clone(), Stroke::solid(Colour::QUIET, 1.6).dashed(5.0));
        }
        steps
    }

    fn draw_points(&self, scene: &mut Scene, area: &Area, (x, y): (&Scale, &Scale), front: &[(f64, f64)]) {
        let places: Vec<(f64, f64)> =
            self.points.iter().map(|p| (area.x(x, p.at.0), area.y(y, p.at.1))).collect();
        let mut taken: Vec<Area> = places.iter().map(|at| around(*at, 8.0)).collect();
        taken.extend(front.windows(2).map(|ends| between(ends[0], ends[1])));
        for (point, at) in self.points.iter().zip(&places) {
            let stroke = Stroke::solid(self.conditions.as_slice()[point.condition].colour, 2.0).faded(0.75);
            let across = point.intervals.0.map(|i| [(area.x(x, i.low), at.1), (area.x(x, i.high), at.1)]);
            let along = point.intervals.1.map(|i| [(at.0, area.y(y, i.low)), (at.0, area.y(y, i.high))]);
            for ends in across.into_iter().chain(along) {
                scene.line(ends, stroke);
                taken.push(between(ends[0], ends[1]));
            }
        }
        let mut labels = Vec::new();
        for (point, at) in self.points.iter().zip(&places) {
            let placed = best_label(&point.label, *at, area, &taken);
            taken.push(placed.covers);
            labels.push(placed);
        }
        for (label, at) in labels.iter().zip(&places) {
            if label.is_led {
                scene.line([*at, label.end], Stroke::solid(Colour::QUIET, 1.0));
            }
        }
        for (point, at) in self.points.iter().zip(&places) {
            frame::dot(scene, &self.conditions.as_slice()[point.condition], *at, 7.0);
        }
        labels.into_iter().for_each(|placed| scene.label(placed.label));
    }

    /// Says in a corner which way is better.
    fn draw_compass(&self, scene: &mut Scene, area: &Area) {
        let arrow = match (self.x.1, self.y.1) {
            (Better::Lower, Better::Higher) => "better: up and to the left",
            (Better::Higher, Better::Higher) => "better: up and to the right",
            (Better::Lower, Better::Lower) => "better: down and to the left",
            (Better::Higher, Better::Lower) => "better: down and to the right",
        };
        let label = Label::new(arrow, area.right, area.top - 17.0, SMALL);
        scene.label(label.quiet().anchored(Anchor::End));
    }

    fn description(&self) -> String {
        let front: Vec<&str> = self.front().into_iter().map(|i| self.points[i].label.as_str()).collect();
        format!(
            "{}. {} against {}. Beaten by nothing on both: {}.",
            self.heading.title,
            self.y.0.title,
            self.x.0.title,
            front.join("; ")
        )
    }

    fn data(&self) -> Csv {
        let front = self.front();
        let mut csv =
            Csv::new(["label", "condition", "x", "x_low", "x_high", "y", "y_low", "y_high", "on_front"]);
        for (i, p) in self.points.iter().enumerate() {
            let ends = |i: Option<Interval>| [Cell::from(i.map(|i| i.low)), Cell::from(i.map(|i| i.high))];
            let mut row = vec![
                Cell::from(p.label.as_str()),
                Cell::from(self.conditions.as_slice()[p.condition].name.as_str()),
                Cell::from(p.at.0),
            ];
            row.extend(ends(p.intervals.0));
            row.push(Cell::from(p.at.1));
            row.extend(ends(p.intervals.1));
            row.push(Cell::from(front.contains(&i)));
            csv.push(row);
        }
        csv
    }
}

fn signed(value: f64, better: Better) -> f64 {
    match better {
        Better::Lower => -value,
        Better::Higher => value,
    }
}

fn around((x, y): (f64, f64), radius: f64) -> Area {
    Area { left: x - radius, right: x + radius, top: y - radius, bottom: y + radius }
}

/// What a horizontal or vertical line covers.
fn between(a: (f64, f64), b: (f64, f64)) -> Area {
    Area {
        left: a.0.min(b.0) - 1.0,
        right: a.0.max(b.0) + 1.0,
        top: a.1.min(b.1) - 1.0,
        bottom: a.1.max(b.1) + 1.0,
    }
}

/// A label that has found its place.
struct Placed {
    label: Label,
    covers: Area,
    /// Its end towards the point.
    end: (f64, f64),
    /// So far from the point that a line leads to it.
    is_led: bool,
}

/// Sides of a point on which its label may stand: where to, in the distance of the nearest, and which of its ends is there.
const SIDES: [(f64, f64, Anchor); 8] = [
    (12.0, 0.0, Anchor::Start),
    (-12.0, 0.0, Anchor::End),
    (0.0, -17.0, Anchor::Middle),
    (0.0, 17.0, Anchor::Middle),
    (11.0, -14.0, Anchor::Start),
    (11.0, 14.0, Anchor::Start),
    (-11.0, -14.0, Anchor::End),
    (-11.0, 14.0, Anchor::End),
];
/// How many times as far a label may stand, and what each costs beside what is covered, in square pixels.
const DISTANCES: [(f64, f64); 5] = [(1.0, 0.0), (2.2, 60.0), (3.5, 110.0), (5.0, 160.0), (7.0, 220.0)];

/// The label at that side and distance of its point where it covers least of what is there already.
fn best_label(text: &str, at: (f64, f64), within: &Area, taken: &[Area]) -> Placed {
    let wide = width(text, Weight::Regular, SMALL);
    let cost = |place: &Area| {
        taken.iter().map(|other| overlap(place, other)).sum::<f64>() + 10.0 * outside(place, within)
    };
    let mut best: Option<(f64, Placed)> = None;
    for (times, dear) in DISTANCES {
        for (dx, dy, anchor) in SIDES {
            let (x, y) = (at.0 + times * dx, at.1 + times * dy);
            let left = match anchor {
                Anchor::Start => x,
                Anchor::Middle => x - wide / 2.0,
                Anchor::End => x - wide,
            };
            let covers = Area { left, right: left + wide, top: y - 8.0, bottom: y + 8.0 };
            let cost = dear + cost(&covers);
            if best.as_ref().is_none_or(|(least, _)| cost + 1e-6 < *least) {
                let label = Label::new(text, x, y, SMALL).anchored(anchor).on_middle();
                let end = match anchor {
                    Anchor::Middle => (x, y - 8.0 * dy.signum()),
                    Anchor::Start => (x - 2.0, y),
                    Anchor::End => (x + 2.0, y),
                };
                best = Some((cost, Placed { label, covers, end, is_led: times > 1.0 }));
            }
        }
    }
    best.expect("there are sides").1
}

fn overlap(a: &Area, b: &Area) -> f64 {
    let wide = a.right.min(b.right) - a.left.max(b.left);
    let high = a.bottom.min(b.bottom) - a.top.max(b.top);
    wide.max(0.0) * high.max(0.0)
}

fn outside(place: &Area, within: &Area) -> f64 {
    place.width() * place.height() - overlap(place, within)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let point = |label: &str, at: (f64, f64)| ParetoPoint {
            label: label.to_owned(),
            condition: 0,
            at,
            intervals: (None, None),
        };
        let scatter = ParetoScatter {
            heading: Heading::default(),
            x: (Axis::share("interventions"), Better::Lower),
            y: (Axis::share("success"), Better::Higher),
            conditions: Conditions::in_order(["a"]),
            points: vec![
                point("dear", (0.8, 0.95)),
                point("beaten", (0.6, 0.8)),
                point("fair", (0.4, 0.9)),
                point("twin of fair", (0.4, 0.9)),
                point("cheap", (0.1, 0.3)),
            ],
            behind: Some(Behind { name: "a line".into(), line: vec![(0.0, 0.2), (0.9, 0.9)] }),
        };
        assert_eq!(scatter.front(), [4, 2, 3, 0]);
        assert!(scatter.figure().unwrap().svg().contains("grey line: a line"));
        assert!(scatter.figure().unwrap().csv().to_string().contains("beaten,a,0.6,,,0.8,,,false"));
    }
}
