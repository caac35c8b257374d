//! Paired slopes: what each participant gained or lost from one condition to another.

use super::axis::{Axis, Scale};
use super::frame::{self, Area, Heading, MARGIN, SMALL, TICK_ROOM};
use super::palette::{Colour, Conditions};
use super::scene::{Anchor, Fill, Label, Scene, Stroke};
use super::{Figure, FigureError, require_length, require_some};
use crate::csv::{Cell, Csv};
use crate::statistics::{Paired, mean, paired_t};

/// Two conditions joined by a line a participant, and the differences beside them with the mean's 95 % interval.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedSlopes {
    /// Title and reading aid.
    pub heading: Heading,
    /// What is measured.
    pub axis: Axis,
    /// Names of the participants.
    pub participants: Vec<String>,
    /// The two conditions, left and right.
    pub conditions: Conditions,
    /// One pair a participant: the value under the left and under the right condition.
    pub pairs: Vec<(f64, f64)>,
    /// Differences within ± this are shown as "practically the same"; `None` shows no such band.
    pub bound: Option<f64>,
}

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 560.0;

impl PairedSlopes {
    /// Draws the figure.
    ///
    /// # Errors
    /// Not exactly two conditions, no participant, lists of unequal length, values that are not finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        require_length("conditions", 2, self.conditions.len())?;
        require_some("participants", self.pairs.len())?;
        require_length("participants", self.participants.len(), self.pairs.len())?;
        let scale = self.axis.scale(self.pairs.iter().flat_map(|(a, b)| [*a, *b]), 6)?;
        let (differences, unit) = self.difference_scale(&scale)?;
        let mut scene = Scene::new(WIDTH, HEIGHT);
        let top = frame::head(&mut scene, &self.heading, &Conditions::in_order([])) + 30.0;
        let bottom = HEIGHT - MARGIN - 38.0;
        let left = Area { left: MARGIN + TICK_ROOM, top, right: 560.0, bottom };
        let right = Area { left: 560.0 + 34.0 + TICK_ROOM, top, right: WIDTH - MARGIN, bottom };
        self.draw_slopes(&mut scene, &left, &scale);
        self.draw_differences(&mut scene, &right, &differences, unit);
        Ok(Figure { scene, description: self.description(), data: self.data() })
    }

    fn differences(&self) -> Vec<f64> {
        self.pairs.iter().map(|(a, b)| b - a).collect()
    }

    fn paired(&self) -> Option<Paired> {
        let (a, b): (Vec<f64>, Vec<f64>) = self.pairs.iter().copied().unzip();
        Paired::new(&b, &a).ok()
    }

    fn difference_scale(&self, scale: &Scale) -> Result<(Scale, &'static str), FigureError> {
        let mut values = self.differences();
        values.push(0.0);
        values.extend(self.bound.into_iter().flat_map(|bound| [-bound, bound]));
        let test = self.paired().and_then(|pairs| paired_t(&pairs).ok());
        values.extend(test.iter().flat_map(|t| [t.ci95.low, t.ci95.high]));
        Ok(Axis::free("Difference").scale(values, 6)?.of_differences(scale))
    }

    fn draw_slopes(&self, scene: &mut Scene, area: &Area, scale: &Scale) {
        frame::y_title(scene, area, &self.axis.title);
        frame::y_axis(scene, area, scale);
        let looks = self.conditions.as_slice();
        let (x_a, x_b) = (area.left + area.width() * 0.22, area.left + area.width() * 0.78);
        for (a, b) in &self.pairs {
            let ends = [(x_a, area.y(scale, *a)), (x_b, area.y(scale, *b))];
            scene.line(ends, Stroke::solid(Colour::THREAD, 1.6));
            frame::speck(scene, looks[0].colour, ends[0], 4.2);
            frame::speck(scene, looks[1].colour, ends[1], 4.2);
        }
        let (a, b): (Vec<f64>, Vec<f64>) = self.pairs.iter().copied().unzip();
        if let (Ok(a), Ok(b)) = (mean(&a), mean(&b)) {
            let ends = [(x_a - 26.0, area.y(scale, a)), (x_b + 26.0, area.y(scale, b))];
            scene.line(ends, Stroke::solid(Colour::INK, 2.8));
            for (i, (end, value)) in ends.into_iter().zip([a, b]).enumerate() {
                frame::dot(scene, &looks[i], end, 7.0);
                let (dx, anchor) = if i == 0 { (-12.0, Anchor::End) } else { (12.0, Anchor::Start) };
                let label = Label::new(scale.value_text(value), end.0 + dx, end.1, SMALL);
                scene.label(label.strong().anchored(anchor).on_middle());
            }
        }
        frame::base_line(scene, area, area.bottom);
        for (x, condition) in [x_a, x_b].into_iter().zip(looks) {
            scene.label(Label::new(&condition.name, x, area.bottom + 21.0, SMALL).anchored(Anchor::Middle));
        }
    }

    fn draw_differences(&self, scene: &mut Scene, area: &Area, scale: &Scale, unit: &str) {
        let looks = self.conditions.as_slice();
        frame::y_title(scene, area, &format!("{} − {}{unit}", looks[1].name, looks[0].name));
        if let Some(bound) = self.bound {
            let band = Fill::faded(Colour::GREEN, 0.12);
            scene.rectangle(
                (area.left, area.y(scale, bound)),
                (area.right, area.y(scale, -bound)),
                band,
                None,
            );
            let middle = (area.left + area.right) / 2.0;
            let label = Label::new("green band: practically the same", middle, area.bottom + 41.0, SMALL);
            scene.label(label.coloured(Colour::DARK_GREEN).anchored(Anchor::Middle));
        }
        frame::y_axis(scene, area, scale);
        let zero = area.y(scale, 0.0);
        scene.line([(area.left, zero), (area.right, zero)], Stroke::solid(Colour::QUIET, 1.4));
        let count = self.pairs.len() as f64;
        for (i, difference) in self.differences().into_iter().enumerate() {
            let x = area.left + area.width() * (0.08 + 0.46 * (i as f64 + 0.5) / count);
            frame::speck(scene, Colour::QUIET, (x, area.y(scale, difference)), 4.2);
        }
        self.draw_mean_difference(scene, area, scale);
        let names = [(0.31, "participants"), (0.7, "mean, 95\u{202f}%")];
        for (share, text) in names {
            let x = area.left + area.width() * share;
            scene.label(Label::new(text, x, area.bottom + 21.0, SMALL).anchored(Anchor::Middle));
        }
    }

    fn draw_mean_difference(&self, scene: &mut Scene, area: &Area, scale: &Scale) {
        let Ok(centre) = mean(&self.differences()) else { return };
        let (x, y) = (area.left + area.width() * 0.7, area.y(scale, centre));
        if let Some(test) = self.paired().and_then(|pairs| paired_t(&pairs).ok()) {
            let ends = (area.y(scale, test.ci95.low), area.y(scale, test.ci95.high));
            frame::interval(scene, Colour::INK, x, ends, 7.0);
        }
        scene.marker(super::Marker::Disc, (x, y), 6.5, Fill::solid(Colour::INK), None);
        scene.label(Label::new(scale.value_text(centre), x + 13.0, y, SMALL).strong().on_middle());
    }

    fn description(&self) -> String {
        let looks = self.conditions.as_slice();
        let rises = self.pairs.iter().filter(|(a, b)| b > a).count();
        format!(
            "{}. {}: from {} to {} it rises in {rises} of {} participants.",
            self.heading.title,
            self.axis.title,
            looks[0].name,
            looks[1].name,
            self.pairs.len()
        )
    }

    fn data(&self) -> Csv {
        let looks = self.conditions.as_slice();
        let mut csv = Csv::new(["participant", looks[0].name.as_str(), looks[1].name.as_str(), "difference"]);
        for (participant, (a, b)) in self.participants.iter().zip(&self.pairs) {
            csv.push([Cell::from(participant.as_str()), Cell::from(*a), Cell::from(*b), Cell::from(b - a)]);
        }
        csv
    }
}
