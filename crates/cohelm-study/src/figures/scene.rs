//! A drawing as plain data: what is where in which colour. Written as SVG and painted as PNG from the same marks.
//!
//! Lengths are in points of the drawing, x to the right, y downwards.

use super::font::Weight;
use super::palette::{Colour, Marker};

/// A finished drawing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scene {
    pub width: f64,
    pub height: f64,
    pub marks: Vec<Mark>,
}

/// A line's look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    pub colour: Colour,
    pub width: f64,
    pub opacity: f64,
    /// Length of dashes and gaps; `None` is solid.
    pub dash: Option<f64>,
}

/// A surface's look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fill {
    pub colour: Colour,
    pub opacity: f64,
}

/// Which point of a text lies at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A text on its baseline.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Label {
    pub text: String,
    pub x: f64,
    pub y: f64,
    pub size: f64,
    pub weight: Weight,
    pub colour: Colour,
    pub anchor: Anchor,
}

/// One thing drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Mark {
    /// Straight pieces from point to point.
    Line(Vec<(f64, f64)>, Stroke),
    /// A closed polygon, perhaps with an outline.
    Area(Vec<(f64, f64)>, Fill, Option<Stroke>),
    /// A disc, perhaps with an outline.
    Disc { x: f64, y: f64, radius: f64, fill: Fill, stroke: Option<Stroke> },
    /// A text.
    Label(Label),
}

impl Stroke {
    pub fn solid(colour: Colour, width: f64) -> Self {
        Stroke { colour, width, opacity: 1.0, dash: None }
    }

    pub fn dashed(self, dash: f64) -> Self {
        Stroke { dash: Some(dash), ..self }
    }

    pub fn faded(self, opacity: f64) -> Self {
        Stroke { opacity, ..self }
    }
}

impl Fill {
    pub fn solid(colour: Colour) -> Self {
        Fill { colour, opacity: 1.0 }
    }

    pub fn faded(colour: Colour, opacity: f64) -> Self {
        Fill { colour, opacity }
    }
}

impl Label {
    /// A dark text that starts at (x, y).
    pub fn new(text: impl Into<String>, x: f64, y: f64, size: f64) -> Self {
        Label {
            text: text.into(),
            x,
            y,
            size,
            weight: Weight::Regular,
            colour: Colour::INK,
            anchor: Anchor::Start,
        }
    }

    pub fn quiet(self) -> Self {
        Label { colour: Colour::QUIET, ..self }
    }

    pub fn strong(self) -> Self {
        Label { weight: Weight::SemiBold, ..self }
    }

    pub fn coloured(self, colour: Colour) -> Self {
        Label { colour, ..self }
    }

    pub fn anchored(self, anchor: Anchor) -> Self {
        Label { anchor, ..self }
    }

    /// Centred on y instead of standing on it: half the height of the digits lower.
    pub fn on_middle(self) -> Self {
        Label { y: self.y + 0.36 * self.size, ..self }
    }
}

impl Scene {
    pub fn new(width: f64, height: f64) -> Self {
        Scene { width, height, marks: Vec::new() }
    }

    pub fn line(&mut self, points: impl Into<Vec<(f64, f64)>>, stroke: Stroke) {
        self.marks.push(Mark::Line(points.into(), stroke));
    }

    pub fn area(&mut self, points: impl Into<Vec<(f64, f64)>>, fill: Fill) {
        self.marks.push(Mark::Area(points.into(), fill, None));
    }

    /// An axis-parallel rectangle between two corners.
    pub fn rectangle(&mut self, a: (f64, f64), b: (f64, f64), fill: Fill, stroke: Option<Stroke>) {
        self.marks.push(Mark::Area(vec![a, (b.0, a.1), b, (a.0, b.1)], fill, stroke));
    }

    pub fn label(&mut self, label: Label) {
        self.marks.push(Mark::Label(label));
    }

    /// A condition's mark, all of about one area.
    pub fn marker(
        &mut self,
        marker: Marker,
        at: (f64, f64),
        radius: f64,
        fill: Fill,
        stroke: Option<Stroke>,
    ) {
        let (x, y) = at;
        let polygon: &[(f64, f64)] = match marker {
            Marker::Disc => {
                self.marks.push(Mark::Disc { x, y, radius, fill, stroke });
                return;
            }
            Marker::Square => &[(-0.88, -0.88), (0.88, -0.88), (0.88, 0.88), (-0.88, 0.88)],
            Marker::Diamond => &[(0.0, -1.25), (1.25, 0.0), (0.0, 1.25), (-1.25, 0.0)],
            Marker::Up => &[(0.0, -1.2), (1.15, 0.85), (-1.15, 0.85)],
            Marker::Down => &[(0.0, 1.2), (1.15, -0.85), (-1.15, -0.85)],
        };
        let points = polygon.iter().map(|(px, py)| (x + px * radius, y + py * radius)).collect();
        self.marks.push(Mark::Area(points, fill, stroke));
    }
}
