//! Colours and marks of conditions: the same ones in every figure of a study.
//!
//! The colours are those of Okabe and Ito (2008), which stay apart for every common kind of colour blindness; yellow is
//! left out, as it does not show on white, and grey is added for the condition that the others are held against. Marks
//! differ too, so that a figure also survives a black-and-white printer.

/// An opaque sRGB colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// For the condition that the others are held against (human alone).
    pub const GREY: Colour = Colour(0x8a, 0x8a, 0x8a);
    /// Okabe–Ito orange.
    pub const ORANGE: Colour = Colour(0xe6, 0x9f, 0x00);
    /// Okabe–Ito blue.
    pub const BLUE: Colour = Colour(0x00, 0x72, 0xb2);
    /// Okabe–Ito bluish green.
    pub const GREEN: Colour = Colour(0x00, 0x9e, 0x73);
    /// Okabe–Ito vermillion.
    pub const VERMILLION: Colour = Colour(0xd5, 0x5e, 0x00);
    /// Okabe–Ito sky blue.
    pub const SKY: Colour = Colour(0x56, 0xb4, 0xe9);
    /// Okabe–Ito reddish purple.
    pub const PURPLE: Colour = Colour(0xcc, 0x79, 0xa7);
    /// Nearly black, for a condition (robot alone) as for the text.
    pub const INK: Colour = Colour(0x1f, 0x23, 0x28);

    /// Text that names a green surface.
    pub(crate) const DARK_GREEN: Colour = Colour(0x00, 0x6b, 0x4e);
    pub(crate) const WHITE: Colour = Colour(0xff, 0xff, 0xff);
    /// Secondary text: subtitles, tick labels (contrast 7:1 on white).
    pub(crate) const QUIET: Colour = Colour(0x55, 0x5b, 0x63);
    /// Grid lines.
    pub(crate) const GRID: Colour = Colour(0xe4, 0xe6, 0xe9);
    /// Lines of single participants behind the summary.
    pub(crate) const THREAD: Colour = Colour(0xb6, 0xbb, 0xc2);

    /// As `#rrggbb`.
    pub fn hex(self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// Shape of a condition's points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// ●
    Disc,
    /// ■
    Square,
    /// ◆
    Diamond,
    /// ▲
    Up,
    /// ▼
    Down,
}

/// A condition as figures show it.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// Name in legends, axes and data files.
    pub name: String,
    /// Its colour in every figure.
    pub colour: Colour,
    /// Its mark in every figure.
    pub marker: Marker,
}

/// The conditions of a study with their looks. Make one for the study and hand it to every figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditions(Vec<Condition>);

const COLOURS: [Colour; 8] = [
    Colour::GREY,
    Colour::ORANGE,
    Colour::BLUE,
    Colour::GREEN,
    Colour::VERMILLION,
    Colour::SKY,
    Colour::PURPLE,
    Colour::INK,
];
const MARKERS: [Marker; 5] = [Marker::Disc, Marker::Square, Marker::Diamond, Marker::Up, Marker::Down];

impl Conditions {
    /// Looks given in order: grey for the first, which is the one to compare with, then orange, blue, green, …
    /// Beyond eight, colours come again with another mark.
    pub fn in_order<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        Self::with_colours(names.into_iter().enumerate().map(|(i, name)| (name, COLOURS[i % COLOURS.len()])))
    }

    /// Looks with chosen colours; marks are given in order.
    pub fn with_colours<'a>(names: impl IntoIterator<Item = (&'a str, Colour)>) -> Self {
        let condition = |(i, (name, colour)): (usize, (&str, Colour))| Condition {
            name: name.to_owned(),
            colour,
            marker: MARKERS[i % MARKERS.len()],
        };
        Conditions(names.into_iter().enumerate().map(condition).collect())
    }

    /// The conditions of one figure, with the looks they have in the study; names that are not among them are left out.
    pub fn only(&self, names: &[&str]) -> Self {
        Conditions(names.iter().filter_map(|name| self.0.iter().find(|c| c.name == *name)).cloned().collect())
    }

    /// The conditions, in order.
    pub fn as_slice(&self) -> &[Condition] {
        &self.0
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_looks_the_same_in_a_figure_of_fewer() {
        let all = Conditions::in_order(["HIC", "LASC", "MISC"]);
        let two = all.only(&["MISC", "LASC", "unknown"]);
        assert_eq!(two.as_slice(), [all.as_slice()[2].clone(), all.as_slice()[1].clone()]);
    }

    #[test]
    fn forty_conditions_never_share_both_colour_and_mark() {
        let names: Vec<String> = (0..40).map(|i| i.to_string()).collect();
        let all = Conditions::in_order(names.iter().map(String::as_str));
        for (i, a) in all.as_slice().iter().enumerate() {
            assert!(all.as_slice()[..i].iter().all(|b| (a.colour, a.marker) != (b.colour, b.marker)));
        }
    }

    #[test]
    fn text_colours_have_contrast_on_white() {
        let channel = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
        };
        let luminance = |c: Colour| 0.2126 * channel(c.0) + 0.7152 * channel(c.1) + 0.0722 * channel(c.2);
        let contrast = |c: Colour| 1.05 / (luminance(c) + 0.05);
        assert!(contrast(Colour::INK) > 12.0 && contrast(Colour::QUIET) > 6.5);
    }
}
