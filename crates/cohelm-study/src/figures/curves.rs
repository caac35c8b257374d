//! Small multiples of curves: how a measure moves over trials, time or training.

use super::axis::{Axis, Scale};
use super::frame::{self, Area, Heading, MARGIN, SMALL, TICK_ROOM};
use super::palette::{Colour, Conditions};
use super::scene::{Fill, Label, Scene, Stroke};
use super::{Figure, FigureError, require_some};
use crate::csv::{Cell, Csv};

/// Panels side by side with common axes, each with a curve a condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// Title and reading aid.
    pub heading: Heading,
    /// The horizontal axis of all panels.
    pub x: Axis,
    /// The vertical axis of all panels.
    pub y: Axis,
    /// The conditions with their looks.
    pub conditions: Conditions,
    /// The panels, in reading order.
    pub panels: Vec<CurvePanel>,
}

/// One of the small multiples.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePanel {
    /// Whose or what panel it is.
    pub title: String,
    /// Its curves.
    pub curves: Vec<Curve>,
}

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Index into the figure's conditions.
    pub condition: usize,
    /// Points from left to right.
    pub points: Vec<(f64, f64)>,
    /// Lower and upper end of an interval at each point, or empty.
    pub band: Vec<(f64, f64)>,
}

const WIDTH: f64 = 960.0;
const GAP: f64 = 26.0;

impl Curves {
    /// Draws the figure.
    ///
    /// # Errors
    /// No panel, an unknown condition, a band of another length than its curve, values that are not finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        self.check()?;
        let curves = || self.panels.iter().flat_map(|panel| &panel.curves);
        let x = self.x.scale(curves().flat_map(|c| &c.points).map(|p| p.0), 4)?;
        let ends = curves().flat_map(|c| c.band.iter().flat_map(|(low, high)| [*low, *high]));
        let y = self.y.scale(curves().flat_map(|c| &c.points).map(|p| p.1).chain(ends), 4)?;
        let mut scene = Scene::new(WIDTH, 0.0);
        let top = frame::head(&mut scene, &self.heading, &self.shown()) + 54.0;
        let columns = columns(self.panels.len());
        let rows = self.panels.len().div_ceil(columns);
        let width = (WIDTH - 2.0 * MARGIN - TICK_ROOM - GAP * (columns - 1) as f64) / columns as f64;
        let height = if columns < 3 { 300.0 } else { 170.0 };
        for (i, panel) in self.panels.iter().enumerate() {
            let (row, column) = (i / columns, i % columns);
            let left = MARGIN + TICK_ROOM + column as f64 * (width + GAP);
            let top = top + row as f64 * (height + 44.0);
            let area = Area { left, top, right: left + width, bottom: top + height };
            let last = i + columns >= self.panels.len();
            self.draw(&mut scene, panel, &Place { area, x: &x, y: &y, first: column == 0, last });
        }
        let all = Area {
            left: MARGIN + TICK_ROOM,
            top,
            right: WIDTH - MARGIN,
            bottom: top + rows as f64 * (height + 44.0) - 44.0,
        };
        scene.label(Label::new(&self.y.title, MARGIN, top - 36.0, SMALL).strong());
        frame::x_title(&mut scene, &all, &self.x.title);
        scene.height = all.bottom + 43.0 + MARGIN - 8.0;
        Ok(Figure { scene, description: self.description(), data: self.data() })
    }

    fn check(&self) -> Result<(), FigureError> {
        require_some("panels", self.panels.len())?;
        for curve in self.panels.iter().flat_map(|panel| &panel.curves) {
            if curve.condition >= self.conditions.len() {
                let (expected, found) = (curve.condition + 1, self.conditions.len());
                return Err(FigureError::Length { of: "conditions", expected, found });
            }
            if !curve.band.is_empty() {
                super::require_length("intervals", curve.points.len(), curve.band.len())?;
            }
        }
        Ok(())
    }

    /// The conditions that occur, for the legend; none if there is only one, which the title names.
    fn shown(&self) -> Conditions {
        let occurs = |i: usize| self.panels.iter().flat_map(|p| &p.curves).any(|c| c.condition == i);
        let all = self.conditions.as_slice().iter().enumerate();
        let names: Vec<&str> = all.filter(|(i, _)| occurs(*i)).map(|(_, c)| c.name.as_str()).collect();
        if names.len() > 1 { self.conditions.only(&names) } else { self.conditions.only(&[]) }
    }

    fn draw(&self, scene: &mut Scene, panel: &CurvePanel, place: &Place<'_>) {
        place.draw_axes(scene);
        let room = place.area.width();
        let title = super::font::fitted(&panel.title, super::font::Weight::SemiBold, SMALL, room);
        scene.label(Label::new(title, place.area.left, place.area.top - 9.0, SMALL).strong());
        for curve in &panel.curves {
            let colour = self.conditions.as_slice()[curve.condition].colour;
            if !curve.band.is_empty() {
                scene.area(place.band(curve), Fill::faded(colour, 0.18));
            }
        }
        for curve in &panel.curves {
            let condition = &self.conditions.as_slice()[curve.condition];
            let points: Vec<(f64, f64)> = curve.points.iter().map(|&p| place.at(p)).collect();
            scene.line(points.clone(), Stroke::solid(condition.colour, 2.4));
            if points.len() <= 12 {
                points.into_iter().for_each(|at| frame::dot(scene, condition, at, 4.2));
            }
        }
    }

    fn description(&self) -> String {
        let panels: Vec<&str> = self.panels.iter().map(|p| p.title.as_str()).collect();
        format!(
            "{}. {} over {}. Panels: {}.",
            self.heading.title,
            self.y.title,
            self.x.title,
            panels.join("; ")
        )
    }

    fn data(&self) -> Csv {
        let mut csv = Csv::new(["panel", "condition", "x", "y", "low", "high"]);
        for panel in &self.panels {
            for curve in &panel.curves {
                for (i, (x, y)) in curve.points.iter().enumerate() {
                    let band = curve.band.get(i);
                    csv.push([
                        Cell::from(panel.title.as_str()),
                        Cell::from(self.conditions.as_slice()[curve.condition].name.as_str()),
                        Cell::from(*x),
                        Cell::from(*y),
                        Cell::from(band.map(|b| b.0)),
                        Cell::from(band.map(|b| b.1)),
                    ]);
                }
            }
        }
        csv
    }
}

/// As many columns as keep panels broad enough to read.
fn columns(panels: usize) -> usize {
    match panels {
        0..=2 => panels.max(1),
        3 | 5 | 6 | 9 => 3,
        4 => 4,
        _ => 5,
    }
}

/// Where a panel is and what it shows of the axes.
struct Place<'a> {
    area: Area,
    x: &'a Scale,
    y: &'a Scale,
    /// Leftmost of its row: has the vertical axis' labels.
    first: bool,
    /// Lowest of its column: has the horizontal axis' labels.
    last: bool,
}

impl Place<'_> {
    fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.area.x(self.x, x), self.area.y(self.y, y))
    }

    fn band(&self, curve: &Curve) -> Vec<(f64, f64)> {
        let lower = curve.points.iter().zip(&curve.band).map(|(p, b)| self.at((p.0, b.0)));
        let upper = curve.points.iter().zip(&curve.band).rev().map(|(p, b)| self.at((p.0, b.1)));
        lower.chain(upper).collect()
    }

    fn draw_axes(&self, scene: &mut Scene) {
        if self.first {
            frame::y_axis(scene, &self.area, self.y);
        } else {
            for tick in self.y.ticks() {
                let y = self.area.y(self.y, tick);
                scene.line([(self.area.left, y), (self.area.right, y)], Stroke::solid(Colour::GRID, 1.0));
            }
        }
        if self.last {
            frame::x_labels(scene, &self.area, self.x);
        }
        frame::base_line(scene, &self.area, self.area.bottom);
    }
}
