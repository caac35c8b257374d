//! From values to places: axes with round ticks and the text beside them.

use super::FigureError;

/// What an axis shows, in words, and how its values are written.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Title with its unit, as "Steps per episode" or "Episode length (s)".
    pub title: String,
    /// Whether values are shares of one and are written as percent.
    pub percent: bool,
    /// Where the axis begins and ends.
    pub extent: Extent,
}

/// Where an axis begins and ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// From 0 to 1, whatever the data.
    Unit,
    /// From zero to the data.
    FromZero,
    /// The data and no more: for differences, and where zero means nothing.
    Data,
}

impl Axis {
    /// An axis of shares from 0 to 1.
    pub fn share(title: impl Into<String>) -> Self {
        Axis { title: title.into(), percent: true, extent: Extent::Unit }
    }

    /// An axis of amounts, from zero.
    pub fn amount(title: impl Into<String>) -> Self {
        Axis { title: title.into(), percent: false, extent: Extent::FromZero }
    }

    /// An axis that covers the data only.
    pub fn free(title: impl Into<String>) -> Self {
        Axis { title: title.into(), percent: false, extent: Extent::Data }
    }

    /// The same axis, but from zero to the data: where shares are all small.
    pub fn from_zero(self) -> Self {
        Axis { extent: Extent::FromZero, ..self }
    }

    /// The same axis, but covering the data only: shows small differences between large values.
    pub fn zoomed(self) -> Self {
        Axis { extent: Extent::Data, ..self }
    }

    /// The scale of this axis over `values`, with about `ticks` ticks.
    pub(crate) fn scale(
        &self,
        values: impl IntoIterator<Item = f64>,
        ticks: usize,
    ) -> Result<Scale, FigureError> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values {
            if value.is_nan() || value.abs() > crate::statistics::LARGEST_VALUE {
                return Err(FigureError::NotFinite { axis: self.title.clone() });
            }
            low = low.min(value);
            high = high.max(value);
        }
        if low > high {
            return Err(FigureError::NoValues { axis: self.title.clone() });
        }
        let (low, high) = match self.extent {
            Extent::Unit => (low.min(0.0), high.max(1.0)),
            Extent::FromZero => (low.min(0.0), high.max(0.0)),
            Extent::Data => (low, high),
        };
        Ok(Scale::round(low, high, ticks, if self.percent { Writing::Percent } else { Writing::Plain }))
    }
}

/// How a value is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Writing {
    Plain,
    Percent,
    /// Differences between shares, in percentage points: the axis title has the unit.
    Points,
}

/// A range that ends on ticks.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scale {
    pub low: f64,
    pub high: f64,
    step: f64,
    writing: Writing,
}

impl Scale {
    fn round(low: f64, high: f64, ticks: usize, writing: Writing) -> Self {
        let magnitude = low.abs().max(high.abs());
        // One value alone, or values that differ by rounding, still need an axis with some length.
        let span = if high - low > 1e-9 * magnitude { high - low } else { magnitude.max(1.0) };
        let step = round_step(span / ticks.max(1) as f64);
        let (below, above) = ((low / step + 1e-9).floor() * step, (high / step - 1e-9).ceil() * step);
        let high = if above > below { above } else { below + step };
        Scale { low: below, high, step, writing }
    }

    /// The same scale for differences between values of `other`, and what to add to its title: differences of percent are
    /// percentage points.
    pub fn of_differences(self, other: &Scale) -> (Self, &'static str) {
        match other.writing {
            Writing::Plain => (self, ""),
            Writing::Percent | Writing::Points => {
                (Scale { writing: Writing::Points, ..self }, " (percentage points)")
            }
        }
    }

    /// Where a value lies between the ends, 0 to 1; values beyond lie at the end.
    pub fn share(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// The ticks, lowest first.
    pub fn ticks(&self) -> Vec<f64> {
        let count = ((self.high - self.low) / self.step + 0.5).floor() as usize;
        let first = (self.low / self.step).round();
        (0..=count.min(50)).map(|i| (first + i as f64) * self.step).collect()
    }

    /// A tick's text.
    pub fn text(&self, value: f64) -> String {
        written(value, self.step, self.writing)
    }

    /// A value's text, with a digit more than ticks need.
    pub fn value_text(&self, value: f64) -> String {
        written(value, self.step / 10.0, self.writing)
    }
}

/// The smallest of 1, 2, 2.5, 5 or 10 times a power of ten that is at least `raw`.
fn round_step(raw: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(raw)));
    let factor = [1.0, 2.0, 2.5, 5.0].into_iter().find(|f| f * power >= raw * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// A number with as many decimals as a step of that size needs, a true minus sign and thin spaces between thousands.
fn written(value: f64, step: f64, writing: Writing) -> String {
    let factor = if writing == Writing::Plain { 1.0 } else { 100.0 };
    let (value, step) = (value * factor, step * factor);
    let decimals = (0..9).find(|&d| is_whole(step * libm::pow(10.0, f64::from(d)))).unwrap_or(9);
    let decimals = usize::try_from(decimals).unwrap_or(0);
    let number = format!("{:.decimals$}", value.abs());
    let zero = number.bytes().all(|b| matches!(b, b'0' | b'.'));
    let sign = if value < 0.0 && !zero { "−" } else { "" };
    let unit = if writing == Writing::Percent { "\u{202f}%" } else { "" };
    format!("{sign}{}{unit}", grouped(&number))
}

fn is_whole(value: f64) -> bool {
    value > 0.5 && (value - value.round()).abs() < 1e-6 * value
}

fn grouped(number: &str) -> String {
    let (whole, rest) = number.split_at(number.find('.').unwrap_or(number.len()));
    if whole.len() < 5 {
        return number.to_owned();
    }
    let mut out = String::new();
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i) % 3 == 0 {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis, values: &[f64]) -> Vec<String> {
        let scale = axis.scale(values.iter().copied(), 5).unwrap();
        scale.ticks().into_iter().map(|tick| scale.text(tick)).collect()
    }

    #[test]
    fn shares_always_reach_from_nothing_to_all() {
        let texts = texts(&Axis::share("success"), &[0.3, 0.4]);
        assert_eq!(
            texts,
            ["0\u{202f}%", "20\u{202f}%", "40\u{202f}%", "60\u{202f}%", "80\u{202f}%", "100\u{202f}%"]
        );
    }

    #[test]
    fn amounts_begin_at_zero_and_end_on_a_tick() {
        assert_eq!(texts(&Axis::amount("steps"), &[150.0, 238.0]), ["0", "50", "100", "150", "200", "250"]);
        assert_eq!(texts(&Axis::amount("steps"), &[12_345.0]).last().unwrap(), "12\u{202f}500");
    }

    #[test]
    fn free_axes_cover_the_data_with_true_minus_signs() {
        assert_eq!(
            texts(&Axis::free("difference"), &[-0.02, 0.05]),
            ["−0.02", "0.00", "0.02", "0.04", "0.06"]
        );
    }

    #[test]
    fn degenerate_data_still_have_an_axis_or_a_reason() {
        assert!(texts(&Axis::amount("steps"), &[0.0]).len() >= 2);
        assert!(texts(&Axis::free("x"), &[7.0, 7.0]).len() >= 2);
        assert!(texts(&Axis::free("x"), &[1e99]).len() >= 2);
        assert!(Axis::free("x").scale([], 5).is_err());
        assert!(Axis::free("x").scale([f64::NAN], 5).is_err());
        assert!(Axis::free("x").scale([f64::INFINITY], 5).is_err());
    }
}
