//! The way of the participants through a study: who came, who was lost where and why, who is analysed.

use super::font::{Weight, wrapped};
use super::frame::{self, Heading, MARGIN, SMALL, TEXT};
use super::palette::{Colour, Conditions};
use super::scene::{Anchor, Fill, Label, Scene, Stroke};
use super::{Figure, FigureError, require_some};
use crate::csv::{Cell, Csv};

/// Boxes from top to bottom, with who was lost between them at the side (as CONSORT draws it).
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    /// Title and reading aid.
    pub heading: Heading,
    /// The stages, from the first to the last.
    pub stages: Vec<Stage>,
    /// Into what the last stage divides, side by side; may be empty.
    pub groups: Vec<(String, usize)>,
}

/// A stage that participants reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stage {
    /// What they did, as "Gave consent".
    pub name: String,
    /// How many reached it.
    pub count: usize,
    /// Who got no farther: reason and how many. Reasons nobody had may be left out.
    pub lost: Vec<(String, usize)>,
}

const WIDTH: f64 = 960.0;
const BOX_WIDTH: f64 = 330.0;
const BOX_HEIGHT: f64 = 56.0;
const LINE: f64 = 20.0;
const GAP: f64 = 30.0;
const GROUPS_A_ROW: usize = 6;
const MOST_GROUPS: usize = 12;

impl Flow {
    /// Draws the figure.
    ///
    /// # Errors
    /// No stage.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        require_some("stages", self.stages.len())?;
        let mut scene = Scene::new(WIDTH, 0.0);
        let mut top = frame::head(&mut scene, &self.heading, &Conditions::in_order([])) + 4.0;
        for (i, stage) in self.stages.iter().enumerate() {
            self.draw_stage(&mut scene, stage, top);
            top += BOX_HEIGHT;
            if i + 1 < self.stages.len() {
                let height = side_height(stage).max(0.0) + GAP;
                self.draw_way_on(&mut scene, stage, (top, top + height));
                top += height;
            }
        }
        scene.height = self.draw_groups(&mut scene, top) + MARGIN;
        Ok(Figure { scene, description: self.description(), data: self.data() })
    }

    fn draw_stage(&self, scene: &mut Scene, stage: &Stage, top: f64) {
        let edge = Stroke::solid(Colour::INK, 1.6);
        let corners = ((MARGIN, top), (MARGIN + BOX_WIDTH, top + BOX_HEIGHT));
        scene.rectangle(corners.0, corners.1, Fill::solid(Colour::WHITE), Some(edge));
        let (x, y) = (MARGIN + BOX_WIDTH / 2.0, top + BOX_HEIGHT / 2.0);
        scene.label(Label::new(&stage.name, x, y - 10.0, TEXT).anchored(Anchor::Middle).on_middle());
        let count = format!("n = {}", stage.count);
        scene.label(Label::new(count, x, y + 12.0, TEXT).strong().anchored(Anchor::Middle).on_middle());
    }

    /// The arrow to the next stage and, at its side, who was lost.
    fn draw_way_on(&self, scene: &mut Scene, stage: &Stage, (from, to): (f64, f64)) {
        let x = MARGIN + BOX_WIDTH / 2.0;
        arrow(scene, (x, from), (x, to));
        if stage.lost.is_empty() {
            return;
        }
        let height = side_height(stage);
        let (left, top) = (MARGIN + BOX_WIDTH + 60.0, from + GAP / 2.0);
        let middle = top + height / 2.0;
        arrow(scene, (x, middle), (left, middle));
        let edge = Stroke::solid(Colour::THREAD, 1.4);
        scene.rectangle((left, top), (WIDTH - MARGIN, top + height), Fill::solid(Colour::WHITE), Some(edge));
        let total: usize = stage.lost.iter().map(|(_, count)| count).sum();
        let mut y = top + 22.0;
        scene.label(Label::new(format!("Not further: n = {total}"), left + 16.0, y, SMALL).strong());
        for (reason, count) in &stage.lost {
            for (i, line) in reason_lines(reason).into_iter().enumerate() {
                y += LINE;
                scene.label(Label::new(line, left + 66.0, y, SMALL));
                if i == 0 {
                    let number = Label::new(count.to_string(), left + 50.0, y, SMALL);
                    scene.label(number.strong().anchored(Anchor::End));
                }
            }
        }
    }

    /// The groups of the last stage; returns the lower end.
    fn draw_groups(&self, scene: &mut Scene, top: f64) -> f64 {
        if self.groups.is_empty() || self.groups.len() > MOST_GROUPS {
            return top;
        }
        let from = MARGIN + BOX_WIDTH / 2.0;
        let across = self.groups.len().min(GROUPS_A_ROW);
        let width = (WIDTH - 2.0 * MARGIN - 16.0 * (across - 1) as f64) / across as f64;
        let width = width.min(BOX_WIDTH);
        arrow(scene, (from, top), (from, top + GAP));
        let mut y = top + GAP;
        for row in self.groups.chunks(across) {
            let lines: Vec<Vec<String>> =
                row.iter().map(|(name, _)| wrapped(name, Weight::Regular, SMALL, width - 16.0)).collect();
            let tallest = lines.iter().map(Vec::len).max().unwrap_or(1);
            let height = LINE * (tallest + 1) as f64 + 16.0;
            for (i, ((_, count), lines)) in row.iter().zip(lines).enumerate() {
                let left = MARGIN + i as f64 * (width + 16.0);
                let edge = Stroke::solid(Colour::THREAD, 1.4);
                scene.rectangle(
                    (left, y),
                    (left + width, y + height),
                    Fill::solid(Colour::WHITE),
                    Some(edge),
                );
                let mut baseline = y + 6.0;
                for line in lines {
                    baseline += LINE;
                    scene.label(
                        Label::new(line, left + width / 2.0, baseline, SMALL).anchored(Anchor::Middle),
                    );
                }
                let count = Label::new(format!("n = {count}"), left + width / 2.0, y + height - 12.0, SMALL);
                scene.label(count.strong().anchored(Anchor::Middle));
            }
            y += height + 12.0;
        }
        y - 12.0
    }

    fn description(&self) -> String {
        let stages: Vec<String> = self
            .stages
            .iter()
            .map(|stage| {
                let lost: Vec<String> =
                    stage.lost.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
                let lost = if lost.is_empty() {
                    String::new()
                } else {
                    format!(" (not further: {})", lost.join(", "))
                };
                format!("{}: {}{lost}", stage.name, stage.count)
            })
            .collect();
        format!("{}. {}.", self.heading.title, stages.join("; "))
    }

    fn data(&self) -> Csv {
        let mut csv = Csv::new(["stage", "reason", "participants"]);
        for stage in &self.stages {
            csv.push([Cell::from(stage.name.as_str()), Cell::Empty, Cell::from(stage.count)]);
            for (reason, count) in &stage.lost {
                csv.push([Cell::from(stage.name.as_str()), Cell::from(reason.as_str()), Cell::from(*count)]);
            }
        }
        for (name, count) in &self.groups {
            csv.push([Cell::from(name.as_str()), Cell::Empty, Cell::from(*count)]);
        }
        csv
    }
}

fn reason_lines(reason: &str) -> Vec<String> {
    let room = WIDTH - 2.0 * MARGIN - BOX_WIDTH - 60.0 - 82.0;
    wrapped(reason, Weight::Regular, SMALL, room)
}

fn side_height(stage: &Stage) -> f64 {
    if stage.lost.is_empty() {
        return 0.0;
    }
    let lines: usize = stage.lost.iter().map(|(reason, _)| reason_lines(reason).len()).sum();
    LINE * lines as f64 + 36.0
}

/// A line with a head at its end, straight down or to the right.
fn arrow(scene: &mut Scene, from: (f64, f64), to: (f64, f64)) {
    const HEAD: f64 = 7.0;
    let down = (to.1 - from.1).abs() > (to.0 - from.0).abs();
    let base = if down { (to.0, to.1 - HEAD) } else { (to.0 - HEAD, to.1) };
    scene.line([from, base], Stroke::solid(Colour::INK, 1.6));
    let (dx, dy) = if down { (HEAD * 0.6, 0.0) } else { (0.0, HEAD * 0.6) };
    let head = vec![to, (base.0 - dx, base.1 - dy), (base.0 + dx, base.1 + dy)];
    scene.area(head, Fill::solid(Colour::INK));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow(lost: Vec<(String, usize)>) -> Flow {
        let stages = vec![
            Stage { name: "Invited".into(), count: 12, lost },
            Stage { name: "Analysed".into(), count: 10, lost: Vec::new() },
        ];
        Flow { heading: Heading::new("Participants", ""), stages, groups: vec![("A first".into(), 5)] }
    }

    #[test]
    fn every_count_and_reason_is_in_the_drawing_its_words_and_its_data() {
        let figure = flow(vec![("declined".into(), 2)]).figure().unwrap();
        let svg = figure.svg();
        for text in ["n = 12", "n = 10", "declined", "A first", "Not further: n = 2"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(figure.description().contains("Invited: 12 (not further: 2 declined)"));
        assert_eq!(figure.csv().rows().len(), 4);
    }

    #[test]
    fn reasons_make_the_figure_taller_and_no_stage_makes_none() {
        let taller = |reasons: usize| {
            flow((0..reasons).map(|i| (format!("reason {i}"), 1)).collect()).figure().unwrap().size().1
        };
        assert!(taller(4) > taller(1) && taller(1) > taller(0));
        let none = Flow { stages: Vec::new(), ..flow(Vec::new()) };
        assert!(none.figure().is_err());
    }
}
