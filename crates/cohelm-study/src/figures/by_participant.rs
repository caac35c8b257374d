//! Every participant under every condition, with the means beside: the paper's Fig. 2.

use super::axis::{Axis, Scale};
use super::frame::{self, Area, Heading, MARGIN, SMALL, TICK_ROOM};
use super::palette::{Colour, Conditions};
use super::scene::{Anchor, Fill, Label, Scene, Stroke};
use super::{Figure, FigureError, require_length, require_some};
use crate::csv::{Cell, Csv};
use crate::statistics::describe;

/// One or more measures, one panel each, of every participant under every condition.
///
/// Up to four conditions are drawn as bars, more (or more than bars have room for) as points. On the right stands the mean over participants with its 95 %
/// interval (Student's t), so that the figure answers "on average?" as well as "for whom?".
#[derive(Debug, Clone, PartialEq)]
pub struct ByParticipant {
    /// Title and reading aid.
    pub heading: Heading,
    /// Names of the participants, in order.
    pub participants: Vec<String>,
    /// The conditions with their looks.
    pub conditions: Conditions,
    /// One panel a measure, from top to bottom.
    pub panels: Vec<Panel>,
}

/// One measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// What is measured.
    pub axis: Axis,
    /// `values[condition][participant]`; `None` where there is none.
    pub values: Vec<Vec<Option<f64>>>,
}

const WIDTH: f64 = 960.0;
const PANEL_HEIGHT: f64 = 230.0;
const PANEL_GAP: f64 = 52.0;
const MOST_BARS: usize = 4;
const THINNEST_BAR: f64 = 6.0;

impl ByParticipant {
    /// Draws the figure.
    ///
    /// # Errors
    /// No participant, condition or panel; lists of unequal length; values that are not finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        self.check()?;
        let height_of_panels = if self.panels.len() == 1 { 330.0 } else { PANEL_HEIGHT };
        let mut scene = Scene::new(WIDTH, 0.0);
        let mut top = frame::head(&mut scene, &self.heading, &self.conditions) + 30.0;
        let strip = self.strip_width();
        for panel in &self.panels {
            let right = WIDTH - MARGIN - strip - 26.0;
            let area = Area { left: MARGIN + TICK_ROOM, top, right, bottom: top + height_of_panels };
            let means = Area { left: right + 26.0, right: WIDTH - MARGIN, ..area };
            self.draw(&mut scene, panel, &area, &means)?;
            top = area.bottom + PANEL_GAP;
        }
        self.draw_names(&mut scene, top - PANEL_GAP, strip);
        scene.height = top - PANEL_GAP + 43.0 + MARGIN - 8.0;
        Ok(Figure { scene, description: self.description(), data: self.data() })
    }

    fn check(&self) -> Result<(), FigureError> {
        require_some("participants", self.participants.len())?;
        require_some("conditions", self.conditions.len())?;
        require_some("panels", self.panels.len())?;
        for panel in &self.panels {
            require_length("conditions", self.conditions.len(), panel.values.len())?;
            for values in &panel.values {
                require_length("participants", self.participants.len(), values.len())?;
            }
        }
        Ok(())
    }

    /// Room for the means: wide enough to write each beside its mark while they are few.
    fn strip_width(&self) -> f64 {
        let each = if self.conditions.len() <= MOST_BARS { 58.0 } else { 24.0 };
        (self.conditions.len() as f64 * each).max(120.0)
    }

    fn draw(&self, scene: &mut Scene, panel: &Panel, area: &Area, means: &Area) -> Result<(), FigureError> {
        let scale = panel.axis.scale(panel.values.iter().flatten().flatten().copied(), 5)?;
        frame::y_title(scene, area, &panel.axis.title);
        frame::y_axis(scene, area, &scale);
        for tick in scale.ticks() {
            let y = means.y(&scale, tick);
            scene.line([(means.left, y), (means.right, y)], Stroke::solid(Colour::GRID, 1.0));
        }
        let zero = area.y(&scale, scale.low.max(0.0));
        frame::base_line(scene, means, zero);
        let bars = self.conditions.len() * self.participants.len();
        if self.conditions.len() <= MOST_BARS && area.width() / bars as f64 > THINNEST_BAR {
            self.draw_bars(scene, panel, area, &scale);
            frame::base_line(scene, area, zero);
        } else {
            frame::base_line(scene, area, zero);
            self.draw_points(scene, panel, area, &scale);
        }
        self.draw_means(scene, panel, means, &scale);
        Ok(())
    }

    fn draw_bars(&self, scene: &mut Scene, panel: &Panel, area: &Area, scale: &Scale) {
        let slot = area.width() / self.participants.len() as f64;
        let bar = slot * 0.8 / self.conditions.len() as f64;
        let zero = area.y(scale, scale.low.max(0.0));
        for (c, condition) in self.conditions.as_slice().iter().enumerate() {
            for (p, value) in panel.values[c].iter().enumerate() {
                let Some(value) = *value else { continue };
                let left = area.left + slot * (p as f64 + 0.1) + bar * c as f64;
                // A value of zero keeps a visible foot: "none" and "not measured" must not look alike.
                let y = area.y(scale, value).min(zero - 2.0);
                let gap = (bar * 0.06).min(1.0);
                scene.rectangle(
                    (left + gap, y),
                    (left + bar - gap, zero),
                    Fill::solid(condition.colour),
                    None,
                );
            }
        }
    }

    fn draw_points(&self, scene: &mut Scene, panel: &Panel, area: &Area, scale: &Scale) {
        let slot = area.width() / self.participants.len() as f64;
        let step = slot * 0.82 / self.conditions.len() as f64;
        for p in (1..self.participants.len()).step_by(2) {
            let (left, right) = (area.left + slot * p as f64, area.left + slot * (p + 1) as f64);
            let band = Fill::faded(Colour::GRID, 0.35);
            scene.rectangle((left, area.top), (right, area.bottom), band, None);
        }
        for (c, condition) in self.conditions.as_slice().iter().enumerate() {
            for (p, value) in panel.values[c].iter().enumerate() {
                let Some(value) = *value else { continue };
                let x = area.left + slot * (p as f64 + 0.09) + step * (c as f64 + 0.5);
                frame::dot(scene, condition, (x, area.y(scale, value)), (step * 0.62).clamp(2.2, 4.6));
            }
        }
    }

    fn draw_means(&self, scene: &mut Scene, panel: &Panel, area: &Area, scale: &Scale) {
        let few = self.conditions.len() <= MOST_BARS;
        for (c, condition) in self.conditions.as_slice().iter().enumerate() {
            let values: Vec<f64> = panel.values[c].iter().flatten().copied().collect();
            let Ok(summary) = describe(&values) else { continue };
            let x = area.column(c, self.conditions.len()) - if few { 16.0 } else { 0.0 };
            if let Some(ci) = summary.mean_ci95 {
                let ends = (area.y(scale, ci.low), area.y(scale, ci.high));
                frame::interval(scene, condition.colour, x, ends, if few { 6.0 } else { 5.0 });
            }
            let y = area.y(scale, summary.mean);
            frame::dot(scene, condition, (x, y), if few { 5.0 } else { 4.2 });
            if few {
                // Text on the base line would be struck through by it.
                let y = y.min(area.bottom - 9.0);
                scene.label(
                    Label::new(scale.value_text(summary.mean), x + 11.0, y, SMALL).strong().on_middle(),
                );
            }
        }
    }

    fn draw_names(&self, scene: &mut Scene, bottom: f64, strip: f64) {
        let right = WIDTH - MARGIN - strip - 26.0;
        let area = Area { left: MARGIN + TICK_ROOM, top: bottom, right, bottom };
        frame::column_names(scene, &area, self.participants.iter().map(String::as_str));
        frame::x_title(scene, &area, "Participant");
        let middle = (right + 26.0 + WIDTH - MARGIN) / 2.0;
        for (line, text) in ["Mean,", "95 % interval"].into_iter().enumerate() {
            let y = bottom + 20.0 + 18.0 * line as f64;
            scene.label(Label::new(text, middle, y, SMALL).strong().anchored(Anchor::Middle));
        }
    }

    fn description(&self) -> String {
        let means: Vec<String> = self
            .panels
            .iter()
            .flat_map(|panel| {
                self.conditions.as_slice().iter().zip(&panel.values).filter_map(|(condition, values)| {
                    let values: Vec<f64> = values.iter().flatten().copied().collect();
                    let mean = crate::statistics::mean(&values).ok()?;
                    Some(format!("{}, {}: mean {mean:.3}", panel.axis.title, condition.name))
                })
            })
            .collect();
        format!("{}. {} participants. {}.", self.heading.title, self.participants.len(), means.join("; "))
    }

    fn data(&self) -> Csv {
        let mut csv = Csv::new(["measure", "condition", "participant", "value"]);
        for panel in &self.panels {
            for (condition, values) in self.conditions.as_slice().iter().zip(&panel.values) {
                for (participant, value) in self.participants.iter().zip(values) {
                    csv.push([
                        Cell::from(panel.axis.title.as_str()),
                        Cell::from(condition.name.as_str()),
                        Cell::from(participant.as_str()),
                        Cell::from(*value),
                    ]);
                }
            }
        }
        csv
    }
}
