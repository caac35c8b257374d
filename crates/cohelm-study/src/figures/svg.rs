//! A scene as SVG: text stays text, so that it can be searched, read aloud and edited.

use super::font::{REGULAR_WOFF2, SEMI_BOLD_WOFF2, Weight};
use super::palette::Colour;
use super::scene::{Anchor, Fill, Label, Mark, Scene, Stroke};
use base64::{Engine, engine::general_purpose::STANDARD};
use std::fmt::Write;

/// The CSS that brings the embedded faces along.
pub(crate) fn font_faces() -> String {
    let face = |weight: u32, file: &[u8]| {
        format!(
            "@font-face{{font-family:\"Inter\";font-weight:{weight};src:url(data:font/woff2;base64,{}) format(\"woff2\")}}",
            STANDARD.encode(file)
        )
    };
    face(400, REGULAR_WOFF2) + &face(600, SEMI_BOLD_WOFF2)
}

/// Writes a scene. `description` is read aloud instead of it; `fonts` is the CSS to embed, or nothing where the document
/// around it has the faces already.
pub(crate) fn write(scene: &Scene, description: &str, fonts: &str) -> String {
    let (width, height) = (number(scene.width), number(scene.height));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         role=\"img\" aria-label=\"{}\" font-family=\"Inter, 'Helvetica Neue', Arial, sans-serif\">\n",
        escaped(description)
    );
    if !fonts.is_empty() {
        let _ = writeln!(out, "<style>{fonts}</style>");
    }
    let _ = writeln!(out, "<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", Colour::WHITE.hex());
    for mark in &scene.marks {
        write_mark(&mut out, mark);
    }
    out.push_str("</svg>\n");
    out
}

/// Writing to a `String` cannot fail, hence the results dropped here.
fn write_mark(out: &mut String, mark: &Mark) {
    let _ = match mark {
        Mark::Line(line, stroke) => match line.as_slice() {
            [a, b] => writeln!(
                out,
                "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}/>",
                number(a.0),
                number(a.1),
                number(b.0),
                number(b.1),
                stroked(Some(stroke))
            ),
            _ => writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\"{}/>",
                points(line),
                stroked(Some(stroke))
            ),
        },
        Mark::Area(outline, fill, stroke) => {
            writeln!(
                out,
                "<polygon points=\"{}\"{}{}/>",
                points(outline),
                filled(fill),
                stroked(stroke.as_ref())
            )
        }
        Mark::Disc { x, y, radius, fill, stroke } => writeln!(
            out,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}{}/>",
            number(*x),
            number(*y),
            number(*radius),
            filled(fill),
            stroked(stroke.as_ref())
        ),
        Mark::Label(label) => writeln!(out, "{}", text(label)),
    };
}

fn text(label: &Label) -> String {
    let (x, y) = (number(label.x), number(label.y));
    let anchor = match label.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let weight = if label.weight == Weight::SemiBold { " font-weight=\"600\"" } else { "" };

    format!(
        "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" fill=\"{}\"{anchor}{weight}>{}</text>",
        number(label.size),
        label.colour.hex(),
        escaped(&label.text)
    )
}

fn filled(fill: &Fill) -> String {
    format!(" fill=\"{}\"{}", fill.colour.hex(), opacity("fill-opacity", fill.opacity))
}

fn stroked(stroke: Option<&Stroke>) -> String {
    let Some(stroke) = stroke else { return String::new() };
    let dash = stroke.dash.map_or(String::new(), |dash| format!(" stroke-dasharray=\"{}\"", number(dash)));
    format!(
        " stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}{dash}",
        stroke.colour.hex(),
        number(stroke.width),
        opacity("stroke-opacity", stroke.opacity)
    )
}

fn opacity(attribute: &str, opacity: f64) -> String {
    if opacity >= 1.0 { String::new() } else { format!(" {attribute}=\"{}\"", number(opacity)) }
}

fn points(points: &[(f64, f64)]) -> String {
    let pairs: Vec<String> = points.iter().map(|(x, y)| format!("{},{}", number(*x), number(*y))).collect();
    pairs.join(" ")
}

/// Two decimals: a hundredth of a point is finer than any printer.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Text for XML content and attributes; control characters, which XML cannot hold, are dropped.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\u{fffe}' | '\u{ffff}' => {}
            c if c.is_control() && !matches!(c, '\n' | '\t') => {}
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([number(1.0), number(0.126), number(-0.001), number(12.5)], ["1", "0.13", "0", "12.5"]);
    }

    #[test]
    fn names_cannot_break_out() {
        assert_eq!(escaped("</text><script a=\"'\u{7}&"), "&lt;/text&gt;&lt;script a=&quot;&#39;&amp;");
    }
}
