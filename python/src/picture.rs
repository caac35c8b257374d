//! What a plant looks like as pixels, in the colours of the page.

use crate::errors::Kind;
use cohelm::plant::Plant;
use cohelm::scene::{Part, Pose, Role, Scene, Shape};
use numpy::{PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use tiny_skia::{
    Color, FillRule, GradientStop, LinearGradient, Paint, Path, PathBuilder, Pixmap, Point, Rect, SpreadMode,
    Stroke, Transform,
};

/// Most pixels a side.
const MOST_PIXELS: u32 = 4096;
/// Width of lines, pixels a hundredth of the picture's height.
const LINE_SHARE: f32 = 0.004;

/// A picture of a plant as it is now: an array of height × width × 3, uint8.
pub fn picture<'py>(
    py: Python<'py>,
    plant: &dyn Plant,
    [width, height]: [u32; 2],
) -> PyResult<Bound<'py, PyArray3<u8>>> {
    if !(1..=MOST_PIXELS).contains(&width) || !(1..=MOST_PIXELS).contains(&height) {
        let message = format!("a picture has 1 to {MOST_PIXELS} pixels a side, got {width} × {height}");
        return Err(Kind::Option.error(message));
    }
    let mut poses = Vec::new();
    plant.poses(&mut poses);
    let painted = Painter::new(
        &plant.scene(),
        [width, height],
        plant.view().goals.get(plant.pilot_goal()).map(|g| g.id),
    )
    .paint(&plant.scene(), &poses);
    let rgb = PyArray3::zeros(py, [height as usize, width as usize, 3], false);
    let mut view = rgb.try_readwrite().map_err(|error| Kind::Array.error(error))?;
    let bytes = view.as_slice_mut().map_err(|error| Kind::Array.error(error))?;
    for (to, from) in bytes.chunks_exact_mut(3).zip(painted.pixels()) {
        to.copy_from_slice(&[from.red(), from.green(), from.blue()]);
    }
    drop(view);
    Ok(rgb)
}

struct Painter {
    canvas: Pixmap,
    /// Pixels from world units: y points up in the world and down in the picture.
    to_pixels: Transform,
    unit: f32,
    own_goal: Option<u32>,
}

impl Painter {
    fn new(scene: &Scene, [width, height]: [u32; 2], own_goal: Option<u32>) -> Self {
        let [left, bottom, right, top] = scene.bounds;
        let (across, up) = (width as f32 / (right - left), height as f32 / (top - bottom));
        let unit = across.min(up);
        let (middle, foot) = (width as f32 / 2.0, height as f32);
        let to_pixels = Transform::from_row(
            unit,
            0.0,
            0.0,
            -unit,
            middle - unit * (left + right) / 2.0,
            foot + unit * bottom,
        );
        let canvas = Pixmap::new(width, height).expect("both sides were checked to be positive");
        Self { canvas, to_pixels, unit, own_goal }
    }

    fn paint(mut self, scene: &Scene, poses: &[Pose]) -> Pixmap {
        self.sky();
        for part in &scene.fixed {
            self.part(part, Transform::identity(), 1.0);
        }
        self.go_on_sideways(scene);
        for (part, pose) in scene.movable.iter().zip(poses).filter(|(_, pose)| pose.strength > 0.0) {
            let turned = Transform::from_rotate(pose.angle_rad.to_degrees());
            self.part(part, turned.post_translate(pose.x, pose.y), pose.strength);
        }
        self.canvas
    }

    /// Where the picture is wider than the world, the ground goes on as it was at the border.
    fn go_on_sideways(&mut self, scene: &Scene) {
        let [left, _, right, _] = scene.bounds;
        let pixel = |x: f32| self.to_pixels.sx * x + self.to_pixels.tx;
        let width = self.canvas.width() as usize;
        let first = (pixel(left).ceil().max(0.0) as usize).min(width - 1);
        let last = (pixel(right).floor() as usize).clamp(first + 1, width) - 1;
        for row in self.canvas.pixels_mut().chunks_exact_mut(width) {
            let (at_left, at_right) = (row[first], row[last]);
            row[..first].fill(at_left);
            row[last + 1..].fill(at_right);
        }
    }

    fn sky(&mut self) {
        let (width, height) = (self.canvas.width() as f32, self.canvas.height() as f32);
        let stop = |at, (red, green, blue)| GradientStop::new(at, Color::from_rgba8(red, green, blue, 255));
        let stops = vec![stop(0.0, (5, 9, 20)), stop(0.5, (12, 23, 51)), stop(1.0, (40, 70, 118))];
        let (top, foot) = (Point::from_xy(0.0, 0.0), Point::from_xy(0.0, height));
        let mut paint = Paint::default();
        if let Some(shader) = LinearGradient::new(top, foot, stops, SpreadMode::Pad, Transform::identity()) {
            paint.shader = shader;
        }
        if let Some(all) = Rect::from_xywh(0.0, 0.0, width, height) {
            self.canvas.fill_rect(all, &paint, Transform::identity(), None);
        }
    }

    fn part(&mut self, part: &Part, place: Transform, strength: f32) {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        let (red, green, blue, alpha) = self.colour(part);
        paint.set_color_rgba8(red, green, blue, (f32::from(alpha) * strength.min(1.0)) as u8);
        let transform = place.post_concat(self.to_pixels);
        let thick = LINE_SHARE * self.canvas.height() as f32 / self.unit;
        for shape in &part.shapes {
            let Some(path) = outline(shape) else { continue };
            if matches!(shape, Shape::Line { .. }) {
                let stroke = Stroke { width: thick.max(1.0 / self.unit), ..Stroke::default() };
                self.canvas.stroke_path(&path, &paint, &stroke, transform, None);
            } else {
                self.canvas.fill_path(&path, &paint, FillRule::Winding, transform, None);
            }
        }
    }

    /// The palette of the page: amber belongs to the pilot's own goal.
    fn colour(&self, part: &Part) -> (u8, u8, u8, u8) {
        match part.role {
            Role::Ground => (61, 74, 104, 255),
            Role::Body => (235, 240, 250, 255),
            Role::Limb => (150, 163, 196, 255),
            Role::Thrust => (255, 186, 84, 255),
            Role::Goal if part.goal.is_some() && part.goal == self.own_goal => (255, 194, 61, 255),
            Role::Goal => (190, 208, 250, 200),
            Role::Decor => (74, 168, 222, 255),
        }
    }
}

fn outline(shape: &Shape) -> Option<Path> {
    match shape {
        Shape::Disc { center: [x, y], radius } => PathBuilder::from_circle(*x, *y, *radius),
        Shape::Line { points } => through(points, false),
        Shape::Polygon { points } => through(points, true),
    }
}

fn through(points: &[[f32; 2]], close: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    let (first, rest) = points.split_first()?;
    path.move_to(first[0], first[1]);
    for [x, y] in rest {
        path.line_to(*x, *y);
    }
    if close {
        path.close();
    }
    path.finish()
}
