//! Boxes with every participant's point: how a measure is spread under each condition.

use super::axis::{Axis, Scale};
use super::frame::{self, Area, Heading, MARGIN, TICK_ROOM};
use super::palette::{Colour, Condition, Conditions};
use super::scene::{Fill, Mark, Scene, Stroke};
use super::{Figure, FigureError, require_length, require_some};
use crate::csv::{Cell, Csv};
use crate::statistics::{Summary, describe};

/// A box for each condition, with every participant's value.
///
/// The box reaches from the first to the third quartile, its line is the median, the diamond the mean. Whiskers end at the
/// outermost *values* within one and a half box lengths of the box, never at a fence where no value is.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxPlot {
    /// Title and reading aid.
    pub heading: Heading,
    /// What is measured.
    pub axis: Axis,
    /// Names of the participants, for the data file.
    pub participants: Vec<String>,
    /// The conditions with their looks.
    pub conditions: Conditions,
    /// `values[condition][participant]`; `None` where there is none.
    pub values: Vec<Vec<Option<f64>>>,
}

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 560.0;
const POINT: f64 = 3.9;

impl BoxPlot {
    /// Draws the figure.
    ///
    /// # Errors
    /// No condition or value; lists of unequal length; values that are not finite.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        require_some("conditions", self.conditions.len())?;
        require_length("conditions", self.conditions.len(), self.values.len())?;
        for values in &self.values {
            require_length("participants", self.participants.len(), values.len())?;
        }
        let scale = self.axis.scale(self.values.iter().flatten().flatten().copied(), 6)?;
        let mut scene = Scene::new(WIDTH, HEIGHT);
        let top = frame::head(&mut scene, &self.heading, &Conditions::in_order([])) + 30.0;
        let area =
            Area { left: MARGIN + TICK_ROOM, top, right: WIDTH - MARGIN, bottom: HEIGHT - MARGIN - 34.0 };
        frame::y_title(&mut scene, &area, &self.axis.title);
        frame::y_axis(&mut scene, &area, &scale);
        for (i, condition) in self.conditions.as_slice().iter().enumerate() {
            let values: Vec<f64> = self.values[i].iter().flatten().copied().collect();
            let Ok(summary) = describe(&values) else { continue };
            let column =
                Column { area: &area, scale: &scale, x: area.column(i, self.conditions.len()), condition };
            let slot = (area.width() / self.conditions.len() as f64).min(230.0);
            column.draw_box(&mut scene, &summary, &values, slot * 0.17);
            column.draw_points(&mut scene, &values, slot * 0.38);
        }
        frame::base_line(&mut scene, &area, area.bottom);
        frame::condition_names(&mut scene, &area, &self.conditions);
        Ok(Figure { scene, description: self.description(), data: self.data() })
    }

    fn description(&self) -> String {
        let boxes: Vec<String> = self
            .conditions
            .as_slice()
            .iter()
            .zip(&self.values)
            .filter_map(|(condition, values)| {
                let values: Vec<f64> = values.iter().flatten().copied().collect();
                let s = describe(&values).ok()?;
                Some(format!(
                    "{}: median {:.3}, quartiles {:.3} and {:.3}",
                    condition.name, s.median, s.q1, s.q3
                ))
            })
            .collect();
        format!("{}. {}. {}.", self.heading.title, self.axis.title, boxes.join("; "))
    }

    fn data(&self) -> Csv {
        let mut csv = Csv::new(["condition", "participant", "value"]);
        for (condition, values) in self.conditions.as_slice().iter().zip(&self.values) {
            for (participant, value) in self.participants.iter().zip(values) {
                csv.push([
                    Cell::from(condition.name.as_str()),
                    Cell::from(participant.as_str()),
                    Cell::from(*value),
                ]);
            }
        }
        csv
    }
}

/// The place of one box.
struct Column<'a> {
    area: &'a Area,
    scale: &'a Scale,
    x: f64,
    condition: &'a Condition,
}

impl Column<'_> {
    fn y(&self, value: f64) -> f64 {
        self.area.y(self.scale, value)
    }

    fn draw_box(&self, scene: &mut Scene, s: &Summary, values: &[f64], half: f64) {
        let (low, high) = whiskers(s, values);
        let line = Stroke::solid(self.condition.colour, 2.0);
        let x = self.x - half;
        for (from, to) in [(s.q1, low), (s.q3, high)] {
            scene.line([(x, self.y(from)), (x, self.y(to))], line);
            scene.line([(x - half * 0.3, self.y(to)), (x + half * 0.3, self.y(to))], line);
        }
        let (left, right) = (x - half * 0.75, x + half * 0.75);
        let fill = Fill::faded(self.condition.colour, 0.22);
        scene.rectangle((left, self.y(s.q3)), (right, self.y(s.q1)), fill, Some(line));
        scene.line([(left, self.y(s.median)), (right, self.y(s.median))], Stroke::solid(Colour::INK, 2.6));
        let mean = Mark::Area(
            [(0.0, -5.5), (5.5, 0.0), (0.0, 5.5), (-5.5, 0.0)]
                .map(|(dx, dy)| (x + dx, self.y(s.mean) + dy))
                .to_vec(),
            Fill::solid(Colour::WHITE),
            Some(Stroke::solid(Colour::INK, 1.6)),
        );
        scene.marks.push(mean);
    }

    /// Every value beside the box, moved sideways no farther than it takes to see each.
    fn draw_points(&self, scene: &mut Scene, values: &[f64], room: f64) {
        let mut ys: Vec<f64> = values.iter().map(|&v| self.y(v)).collect();
        ys.sort_unstable_by(f64::total_cmp);
        for (dx, y) in swarm(&ys, POINT, room) {
            frame::speck(scene, self.condition.colour, (self.x + room * 0.2 + dx, y), POINT);
        }
    }
}

/// The outermost values within one and a half interquartile ranges of the box.
fn whiskers(s: &Summary, values: &[f64]) -> (f64, f64) {
    let reach = 1.5 * (s.q3 - s.q1);
    let inside = |v: &&f64| **v >= s.q1 - reach && **v <= s.q3 + reach;
    let low = values.iter().filter(inside).copied().fold(s.q1, f64::min);
    let high = values.iter().filter(inside).copied().fold(s.q3, f64::max);
    (low, high)
}

/// Offsets to the right (up to `room`) that keep sorted points of the given radius apart where they can.
fn swarm(ys: &[f64], radius: f64, room: f64) -> Vec<(f64, f64)> {
    let mut placed: Vec<(f64, f64)> = Vec::with_capacity(ys.len());
    let apart = 2.05 * radius;
    for &y in ys {
        let free =
            |x: f64| placed.iter().rev().all(|(px, py)| (px - x).abs() >= apart || (py - y).abs() >= apart);
        let x =
            (0..).map(|step| f64::from(step) * radius * 0.5).take_while(|x| *x <= room).find(|&x| free(x));
        placed.push((x.unwrap_or(room), y));
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whiskers_end_at_values() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0, 30.0];
        assert_eq!(whiskers(&describe(&values).unwrap(), &values), (1.0, 5.0));
        assert_eq!(whiskers(&describe(&[2.0; 4]).unwrap(), &[2.0; 4]), (2.0, 2.0));
    }

    #[test]
    fn points_of_equal_value_lie_side_by_side_until_the_room_is_used() {
        let placed = swarm(&[10.0; 4], 2.0, 9.0);
        assert_eq!(placed[0].0, 0.0);
        assert!(placed[1].0 >= 4.1 && placed[2].0 >= placed[1].0 + 4.0);
        assert_eq!(placed[3].0, 9.0);
    }
}
