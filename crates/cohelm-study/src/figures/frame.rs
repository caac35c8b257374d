//! What all figures share: the head with title, reading aid and legend, panels, axes.

use super::axis::Scale;
use super::font::{Weight, fitted, width, wrapped};
use super::palette::{Colour, Condition, Conditions, Marker};
use super::scene::{Anchor, Fill, Label, Scene, Stroke};

/// Sizes of type in points of a drawing 960 wide, chosen to be read from the back of a room.
pub(crate) const TITLE: f64 = 21.0;
pub(crate) const TEXT: f64 = 14.5;
pub(crate) const SMALL: f64 = 13.5;
/// Space around everything.
pub(crate) const MARGIN: f64 = 28.0;
/// Room for tick labels left of a panel.
pub(crate) const TICK_ROOM: f64 = 52.0;

/// A region of the drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Area {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Area {
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// Where a value of the vertical axis lies.
    pub fn y(&self, scale: &Scale, value: f64) -> f64 {
        self.bottom - scale.share(value) * self.height()
    }

    /// Where a value of the horizontal axis lies.
    pub fn x(&self, scale: &Scale, value: f64) -> f64 {
        self.left + scale.share(value) * self.width()
    }

    /// Middle of the i-th of n equal columns.
    pub fn column(&self, i: usize, n: usize) -> f64 {
        self.left + self.width() * (i as f64 + 0.5) / n as f64
    }
}

/// Title and reading aid of a figure.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Heading {
    /// One line that says what is to be seen.
    pub title: String,
    /// How to read it: what a bar, a line or a point stands for, and how many episodes lie behind it.
    pub subtitle: String,
}

impl Heading {
    /// A title with a reading aid.
    pub fn new(title: impl Into<String>, subtitle: impl Into<String>) -> Self {
        Heading { title: title.into(), subtitle: subtitle.into() }
    }
}

/// Draws the head; returns where the content may begin.
pub(crate) fn head(scene: &mut Scene, heading: &Heading, legend: &Conditions) -> f64 {
    let room = scene.width - 2.0 * MARGIN;
    let mut y = MARGIN - 6.0;
    for line in wrapped(&heading.title, Weight::SemiBold, TITLE, room) {
        y += TITLE * 1.2;
        scene.label(Label::new(line, MARGIN, y, TITLE).strong());
    }
    for line in wrapped(&heading.subtitle, Weight::Regular, TEXT, room) {
        y += TEXT * 1.45;
        scene.label(Label::new(line, MARGIN, y, TEXT).quiet());
    }
    legend_rows(scene, legend, y + 10.0) + 18.0
}

/// A row, or several, of marks with names; returns the lower end.
fn legend_rows(scene: &mut Scene, legend: &Conditions, top: f64) -> f64 {
    let (mut x, mut y) = (MARGIN, top);
    for (i, condition) in legend.as_slice().iter().enumerate() {
        let name = fitted(&condition.name, Weight::Regular, TEXT, 260.0);
        let needed = 20.0 + width(&name, Weight::Regular, TEXT) + 24.0;
        if i == 0 {
            y += 16.0;
        } else if x + needed > scene.width - MARGIN {
            (x, y) = (MARGIN, y + 22.0);
        }
        dot(scene, condition, (x + 6.0, y), 5.6);
        scene.label(Label::new(name, x + 19.0, y, TEXT).on_middle());
        x += needed;
    }
    y
}

/// A condition's mark, with a white edge that keeps overlapping marks apart.
pub(crate) fn dot(scene: &mut Scene, condition: &Condition, at: (f64, f64), radius: f64) {
    let edge = Stroke::solid(Colour::WHITE, radius * 0.22);
    scene.marker(condition.marker, at, radius, Fill::solid(condition.colour), Some(edge));
}

/// A vertical interval with caps, which stay visible where a mark covers the line.
pub(crate) fn interval(scene: &mut Scene, colour: Colour, x: f64, ends: (f64, f64), cap: f64) {
    let stroke = Stroke::solid(colour, 2.2);
    scene.line([(x, ends.0), (x, ends.1)], stroke);
    for y in [ends.0, ends.1] {
        scene.line([(x - cap, y), (x + cap, y)], stroke);
    }
}

/// A small grey point: one participant behind a summary.
pub(crate) fn speck(scene: &mut Scene, colour: Colour, at: (f64, f64), radius: f64) {
    let edge = Stroke::solid(Colour::WHITE, 0.8);
    scene.marker(Marker::Disc, at, radius, Fill::faded(colour, 0.75), Some(edge));
}

/// The title of a vertical axis, written level above its panel.
pub(crate) fn y_title(scene: &mut Scene, area: &Area, title: &str) {
    let title = fitted(title, Weight::SemiBold, SMALL, area.width() + TICK_ROOM);
    scene.label(Label::new(title, area.left - TICK_ROOM, area.top - 17.0, SMALL).strong());
}

/// The title of a horizontal axis, centred below its tick labels.
pub(crate) fn x_title(scene: &mut Scene, area: &Area, title: &str) {
    let title = fitted(title, Weight::SemiBold, SMALL, area.width());
    let x = (area.left + area.right) / 2.0;
    scene.label(Label::new(title, x, area.bottom + 43.0, SMALL).strong().anchored(Anchor::Middle));
}

/// Grid lines and tick labels of a vertical axis.
pub(crate) fn y_axis(scene: &mut Scene, area: &Area, scale: &Scale) {
    for tick in scale.ticks() {
        let y = area.y(scale, tick);
        scene.line([(area.left, y), (area.right, y)], Stroke::solid(Colour::GRID, 1.0));
        let label = Label::new(scale.text(tick), area.left - 9.0, y, SMALL);
        scene.label(label.quiet().anchored(Anchor::End).on_middle());
    }
}

/// Grid lines and tick labels of a horizontal axis.
pub(crate) fn x_axis(scene: &mut Scene, area: &Area, scale: &Scale) {
    for tick in scale.ticks() {
        let x = area.x(scale, tick);
        scene.line([(x, area.top), (x, area.bottom)], Stroke::solid(Colour::GRID, 1.0));
    }
    x_labels(scene, area, scale);
    base_line(scene, area, area.bottom);
}

/// Tick labels of a horizontal axis alone.
pub(crate) fn x_labels(scene: &mut Scene, area: &Area, scale: &Scale) {
    for tick in scale.ticks() {
        let label = Label::new(scale.text(tick), area.x(scale, tick), area.bottom + 20.0, SMALL);
        scene.label(label.quiet().anchored(Anchor::Middle));
    }
}

/// A dark line over the width of a panel.
pub(crate) fn base_line(scene: &mut Scene, area: &Area, y: f64) {
    scene.line([(area.left, y), (area.right, y)], Stroke::solid(Colour::QUIET, 1.2));
}

/// Names below equal columns; where they are too many, only every second, third, … is written.
pub(crate) fn column_names<'a>(
    scene: &mut Scene,
    area: &Area,
    names: impl ExactSizeIterator<Item = &'a str>,
) {
    let count = names.len();
    let room = area.width() / count.max(1) as f64;
    let names: Vec<&str> = names.collect();
    let widest = names.iter().map(|name| width(name, Weight::Regular, SMALL)).fold(0.0, f64::max);
    let every = if count > 8 { (((widest.min(64.0) + 8.0) / room).ceil() as usize).max(1) } else { 1 };
    for (i, name) in names.iter().enumerate().step_by(every) {
        let name = fitted(name, Weight::Regular, SMALL, room * every as f64 - 4.0);
        let label = Label::new(name, area.column(i, count), area.bottom + 20.0, SMALL);
        scene.label(label.anchored(Anchor::Middle));
    }
}

/// Column names coloured as their conditions, with the mark before each.
pub(crate) fn condition_names(scene: &mut Scene, area: &Area, conditions: &Conditions) {
    let count = conditions.len();
    let room = area.width() / count.max(1) as f64 - 10.0;
    for (i, condition) in conditions.as_slice().iter().enumerate() {
        let mut lines = wrapped(&condition.name, Weight::Regular, SMALL, room);
        if lines.len() > 2 {
            lines = vec![lines[0].clone(), lines[1..].join(" ")];
        }
        for (line, text) in lines.iter().enumerate() {
            let text = fitted(text, Weight::Regular, SMALL, room);
            let y = area.bottom + 21.0 + 17.0 * line as f64;
            scene.label(Label::new(text, area.column(i, count), y, SMALL).anchored(Anchor::Middle));
        }
    }
}
