//! From a study's file to a design, or to what is wrong with it and where.

use super::{Design, DesignError, Problem};

/// Reads and checks a study's file.
pub(super) fn read(text: &str) -> Result<Design, DesignError> {
    let mut design: Design = toml::from_str(text).map_err(|error| unreadable(text, &error))?;
    design.text = text.to_owned();
    Ok(design)
}

fn unreadable(text: &str, error: &toml::de::Error) -> DesignError {
    let at = error.span().map(|span| line_and_column(text, span.start));
    DesignError { problems: vec![Problem { at, message: error.message().to_owned() }] }
}

/// Line and column of a byte, both from 1; columns count characters.
fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = &text[..byte.min(text.len())];
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    (line, column)
}
