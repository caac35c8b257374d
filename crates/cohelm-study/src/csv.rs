//! Tables as comma-separated values that a spreadsheet cannot be tricked with.
//!
//! Cells are typed: a number is written as a number and never touched, while a text that a spreadsheet would take for a
//! formula gets an apostrophe in front. Lines end with `\n`, the encoding is UTF-8, quoting follows RFC 4180.

use std::fmt::{self, Display, Write};

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Text, quoted and defused where needed.
    Text(String),
    /// A number, with as many digits as bring the same `f64` back; NaN and infinities become an empty cell.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// Nothing: a missing value.
    Empty,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Cell::Number(number)
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Cell::Empty, Cell::Number)
    }
}

impl From<i64> for Cell {
    fn from(number: i64) -> Self {
        Cell::Integer(number)
    }
}

impl From<u32> for Cell {
    fn from(number: u32) -> Self {
        Cell::Integer(i64::from(number))
    }
}

impl From<usize> for Cell {
    fn from(number: usize) -> Self {
        i64::try_from(number).map_or(Cell::Number(number as f64), Cell::Integer)
    }
}

impl From<bool> for Cell {
    fn from(truth: bool) -> Self {
        Cell::from(if truth { "true" } else { "false" })
    }
}

/// A table with named columns. Its `Display` is the file.
///
/// ```
/// use cohelm_study::csv::{Cell, Csv};
/// let mut csv = Csv::new(["participant", "difference"]);
/// csv.push([Cell::from("=HYPERLINK(1)"), Cell::from(-0.25)]);
/// assert_eq!(csv.to_string(), "participant,difference\n'=HYPERLINK(1),-0.25\n");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Csv {
    columns: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

impl Csv {
    /// An empty table.
    pub fn new<'a>(columns: impl IntoIterator<Item = &'a str>) -> Self {
        Csv { columns: columns.into_iter().map(str::to_owned).collect(), rows: Vec::new() }
    }

    /// Adds a row. Missing cells at its end are left empty; cells beyond the last column are a mistake of the caller
    /// and are dropped, so that the file stays rectangular.
    pub fn push(&mut self, cells: impl IntoIterator<Item = Cell>) {
        let mut row: Vec<Cell> = cells.into_iter().collect();
        debug_assert!(row.len() <= self.columns.len(), "{row:?} is wider than {:?}", self.columns);
        row.resize(self.columns.len(), Cell::Empty);
        self.rows.push(row);
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The rows.
    pub fn rows(&self) -> &[Vec<Cell>] {
        &self.rows
    }
}

impl Display for Csv {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_line(f, self.columns.iter().map(|name| Cell::from(name.as_str())))?;
        self.rows.iter().try_for_each(|row| write_line(f, row.iter().cloned()))
    }
}

fn write_line(f: &mut fmt::Formatter<'_>, cells: impl Iterator<Item = Cell>) -> fmt::Result {
    for (i, cell) in cells.enumerate() {
        if i > 0 {
            f.write_char(',')?;
        }
        match cell {
            Cell::Text(text) => f.write_str(&quoted(&defused(&text)))?,
            Cell::Number(number) if number.is_finite() => f.write_str(&shortest(number))?,
            Cell::Integer(number) => write!(f, "{number}")?,
            Cell::Number(_) | Cell::Empty => {}
        }
    }
    f.write_char('\n')
}

/// The shortest decimal that reads back as the same number, without exponent where that stays short.
fn shortest(number: f64) -> String {
    let plain = number == 0.0 || (1e-6..1e15).contains(&number.abs());
    if plain { format!("{number}") } else { format!("{number:e}") }
}

/// Text that begins like a formula (also with the full-width signs that some programs accept) is marked as text.
fn defused(text: &str) -> String {
    let first = text.trim_start_matches([' ', '\u{a0}', '\u{feff}']).chars().next();
    let dangerous =
        matches!(first, Some('=' | '+' | '-' | '@' | '\t' | '\r' | '\n' | '＝' | '＋' | '－' | '＠'));
    if dangerous { format!("'{text}") } else { text.to_owned() }
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(cell: impl Into<Cell>) -> String {
        let mut csv = Csv::new(["c"]);
        csv.push([cell.into()]);
        csv.to_string().strip_prefix("c\n").unwrap().trim_end_matches('\n').to_owned()
    }

    #[test]
    fn formulas_in_text_are_defused_and_numbers_untouched() {
        for text in ["=1+1", "+1", "-1", "@SUM(A1)", "  =1", "＝1", "\u{feff}=1"] {
            assert_eq!(cell(text), format!("'{text}"));
        }
        assert_eq!(cell("\t=1"), "'\t=1");
        assert_eq!(cell(-1.5), "-1.5");
        assert_eq!(cell(-7_i64), "-7");
        assert_eq!(cell("a=1 – b"), "a=1 – b");
    }

    #[test]
    fn quoting_keeps_commas_quotes_and_line_breaks() {
        assert_eq!(cell("a,b"), "\"a,b\"");
        assert_eq!(cell("say \"hi\"\nnow"), "\"say \"\"hi\"\"\nnow\"");
        assert_eq!(cell("=\"x\",1"), "\"'=\"\"x\"\",1\"");
    }

    #[test]
    fn numbers_come_back_exactly_and_non_finite_ones_are_missing() {
        for number in [0.1 + 0.2, 1e-300, -1.7976931348623157e308, 1e15, 123456.75, 0.0, 5e-7] {
            assert_eq!(cell(number).parse::<f64>().unwrap(), number);
        }
        assert_eq!(
            (cell(f64::NAN), cell(f64::INFINITY), cell(None)),
            (String::new(), String::new(), String::new())
        );
        assert_eq!((cell(3.0), cell(1e-7)), ("3".to_owned(), "1e-7".to_owned()));
    }

    #[test]
    fn short_rows_are_filled_up() {
        let mut csv = Csv::new(["a", "b"]);
        csv.push([Cell::from(1_u32)]);
        assert_eq!(csv.to_string(), "a,b\n1,\n");
    }
}
