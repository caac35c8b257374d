//! A scene as PNG, painted by tiny-skia without SIMD: the same bytes on every CPU.

use super::font;
use super::palette::Colour;
use super::scene::{Anchor, Fill, Label, Mark, Scene, Stroke};
use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};
use ttf_parser::OutlineBuilder;

/// Largest side in pixels: a poster at 300 dpi, and little enough memory (4 × 16 000²) to be refused by nobody.
const LARGEST_SIDE: f64 = 16_000.0;

/// Paints a scene with `scale` pixels a point. A scale that is not positive, or makes a side longer than 16 000 pixels, is
/// brought within bounds.
pub(crate) fn write(scene: &Scene, scale: f64) -> Vec<u8> {
    let largest = LARGEST_SIDE / scene.width.max(scene.height);
    let scale = if scale > 0.0 { scale.min(largest) } else { 1.0 };
    let pixels = |length: f64| ((length * scale).round() as u32).max(1);
    let Some(mut pixmap) = Pixmap::new(pixels(scene.width), pixels(scene.height)) else { return Vec::new() };
    pixmap.fill(tiny_skia::Color::WHITE);
    let transform = Transform::from_scale(scale as f32, scale as f32);
    for mark in &scene.marks {
        paint_mark(&mut pixmap, mark, transform);
    }
    // Encoding into memory cannot fail for a pixmap of valid size.
    pixmap.encode_png().unwrap_or_default()
}

fn paint_mark(pixmap: &mut Pixmap, mark: &Mark, transform: Transform) {
    match mark {
        Mark::Line(points, stroke) => {
            if let Some(path) = polygon(points, false) {
                paint_stroke(pixmap, &path, Some(stroke), transform);
            }
        }
        Mark::Area(points, fill, stroke) => {
            if let Some(path) = polygon(points, true) {
                paint_fill(pixmap, &path, fill, transform);
                paint_stroke(pixmap, &path, stroke.as_ref(), transform);
            }
        }
        Mark::Disc { x, y, radius, fill, stroke } => {
            if let Some(path) = PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32) {
                paint_fill(pixmap, &path, fill, transform);
                paint_stroke(pixmap, &path, stroke.as_ref(), transform);
            }
        }
        Mark::Label(label) => paint_label(pixmap, label, transform),
    }
}

fn polygon(points: &[(f64, f64)], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (i, (x, y)) in points.iter().enumerate() {
        if i == 0 {
            builder.move_to(*x as f32, *y as f32);
        } else {
            builder.line_to(*x as f32, *y as f32);
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

fn paint(colour: Colour, opacity: f64) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(colour.0, colour.1, colour.2, (opacity.clamp(0.0, 1.0) * 255.0).round() as u8);
    paint
}

fn paint_fill(pixmap: &mut Pixmap, path: &Path, fill: &Fill, transform: Transform) {
    pixmap.fill_path(path, &paint(fill.colour, fill.opacity), FillRule::Winding, transform, None);
}

fn paint_stroke(pixmap: &mut Pixmap, path: &Path, stroke: Option<&Stroke>, transform: Transform) {
    let Some(stroke) = stroke else { return };
    let look = tiny_skia::Stroke {
        width: stroke.width as f32,
        line_cap: LineCap::Butt,
        line_join: LineJoin::Round,
        dash: stroke.dash.and_then(|dash| StrokeDash::new(vec![dash as f32, dash as f32], 0.0)),
        ..tiny_skia::Stroke::default()
    };
    pixmap.stroke_path(path, &paint(stroke.colour, stroke.opacity), &look, transform, None);
}

fn paint_label(pixmap: &mut Pixmap, label: &Label, transform: Transform) {
    let width = font::width(&label.text, label.weight, label.size);
    let start = match label.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -width / 2.0,
        Anchor::End => -width,
    };
    let mut glyphs = Glyphs { path: PathBuilder::new(), x: 0.0 };
    let units_per_em = font::outline(&label.text, label.weight, &mut glyphs, |glyphs, x| glyphs.x = x);
    let Some(path) = glyphs.path.finish() else { return };
    let size = (label.size / units_per_em) as f32;
    // Font units point upwards.
    let placed = Transform::from_row(size, 0.0, 0.0, -size, (label.x + start) as f32, label.y as f32);
    let fill = paint(label.colour, 1.0);
    pixmap.fill_path(&path, &fill, FillRule::Winding, placed.post_concat(transform), None);
}

/// Collects the outlines of a text; the glyph at hand is moved right by `x` font units.
struct Glyphs {
    path: PathBuilder,
    x: f32,
}

impl OutlineBuilder for Glyphs {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.x + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.x + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.x + x1, y1, self.x + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.cubic_to(self.x + x1, y1, self.x + x2, y2, self.x + x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
