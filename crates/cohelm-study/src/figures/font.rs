//! The type of all figures: Inter (SIL Open Font License, `fonts/`), embedded, so that a figure looks the same everywhere
//! and needs no font installed.

use std::sync::LazyLock;
use ttf_parser::{Face, OutlineBuilder};

/// Weight of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    Regular,
    SemiBold,
}

/// A face parsed once; `None` only if the embedded file were damaged, which a test excludes.
static REGULAR: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("../../fonts/Inter-Regular.ttf"), 0).ok());
static SEMI_BOLD: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("../../fonts/Inter-SemiBold.ttf"), 0).ok());

/// The same faces for browsers.
pub(crate) const REGULAR_WOFF2: &[u8] = include_bytes!("../../fonts/Inter-Regular.woff2");
pub(crate) const SEMI_BOLD_WOFF2: &[u8] = include_bytes!("../../fonts/Inter-SemiBold.woff2");

fn face(weight: Weight) -> Option<&'static Face<'static>> {
    match weight {
        Weight::Regular => REGULAR.as_ref(),
        Weight::SemiBold => SEMI_BOLD.as_ref(),
    }
}

/// Width of a text in the unit of `size`.
pub(crate) fn width(text: &str, weight: Weight, size: f64) -> f64 {
    let Some(face) = face(weight) else { return 0.0 };
    let units: f64 = text.chars().map(|c| f64::from(advance(face, c))).sum();
    units * size / f64::from(face.units_per_em())
}

fn advance(face: &Face<'_>, c: char) -> u16 {
    let glyph = face.glyph_index(c).unwrap_or_default();
    face.glyph_hor_advance(glyph).unwrap_or(0)
}

/// The text, or as much of its beginning and end as fits `room` around an ellipsis: what tells names apart often stands at
/// their end.
pub(crate) fn fitted(text: &str, weight: Weight, size: f64, room: f64) -> String {
    if width(text, weight, size) <= room {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let shortened = |kept: usize| {
        let (head, tail) = (kept.div_ceil(2), kept / 2);
        let end = letters[letters.len() - tail..].iter();
        letters[..head].iter().chain(['…'].iter()).chain(end).collect::<String>()
    };
    let mut fitting = (1..letters.len()).rev().map(shortened);
    fitting.find(|candidate| width(candidate, weight, size) <= room).unwrap_or_default()
}

/// The text in lines of at most `room`, broken at spaces; a longer word stands alone.
pub(crate) fn wrapped(text: &str, weight: Weight, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), weight, size) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Feeds the outlines of a text to `sink`, y upwards, in font units; `move_to` tells it before each glyph how far right of
/// the text's beginning the glyph stands. Returns the font units of one em.
pub(crate) fn outline<B: OutlineBuilder>(
    text: &str,
    weight: Weight,
    sink: &mut B,
    move_to: impl Fn(&mut B, f32),
) -> f64 {
    let Some(face) = face(weight) else { return 1.0 };
    let mut x = 0_u32;
    for c in text.chars() {
        move_to(sink, x as f32);
        face.outline_glyph(face.glyph_index(c).unwrap_or_default(), sink);
        x += u32::from(advance(face, c));
    }
    f64::from(face.units_per_em())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_faces_parse_and_have_what_figures_write() {
        for weight in [Weight::Regular, Weight::SemiBold] {
            let face = face(weight).unwrap();
            for c in "Az09 äß ηεχκα ²−–…±≤≥≠×→↑%\u{202f}".chars() {
                assert!(face.glyph_index(c).is_some(), "{c:?} is missing");
            }
        }
    }

    #[test]
    fn text_is_cut_and_broken_to_fit() {
        let long = "a participant with a very long name";
        let cut = fitted(long, Weight::Regular, 13.0, 100.0);
        assert!(width(&cut, Weight::Regular, 13.0) <= 100.0);
        assert!(cut.starts_with("a p") && cut.contains('…') && cut.ends_with("ame"), "{cut}");
        assert_eq!(fitted("P1", Weight::Regular, 13.0, 100.0), "P1");
        assert_eq!(fitted("W", Weight::Regular, 13.0, 1.0), "");
        let lines = wrapped(long, Weight::Regular, 13.0, 100.0);
        assert!(lines.len() > 1 && lines.join(" ") == long);
    }
}
