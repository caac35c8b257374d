//! Running text with the few emphases that a report of statistics needs.
//!
//! Written as HTML and Markdown by [`crate::report`]; its `Display` is plain text.

use std::fmt;

/// A piece of text in one style.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Span {
    /// As it is.
    Plain(String),
    /// Emphasised: the letters of statistics, as *F* and *p*.
    Emphasis(String),
    /// Strong.
    Strong(String),
    /// Code, commands, names of columns and files.
    Code(String),
    /// A lowered letter.
    Subscript(String),
    /// A raised digit.
    Superscript(String),
    /// A link.
    Link {
        /// What is read.
        text: String,
        /// Where it leads: `https://…`, `http://…`, a relative path or `#anchor`; anything else is written as plain text.
        target: String,
    },
    /// The end of a line.
    Break,
}

/// A run of spans. Built by chaining:
///
/// ```
/// use cohelm_study::text::Text;
/// let text = Text::from("The means differ, ").em("F").plain("(1, 18) = 8.65.");
/// assert_eq!(text.to_string(), "The means differ, F(1, 18) = 8.65.");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Text(Vec<Span>);

impl Text {
    /// Empty text.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds plain text.
    #[must_use]
    pub fn plain(self, text: impl Into<String>) -> Self {
        self.with(Span::Plain(text.into()))
    }

    /// Adds emphasised text.
    #[must_use]
    pub fn em(self, text: impl Into<String>) -> Self {
        self.with(Span::Emphasis(text.into()))
    }

    /// Adds strong text.
    #[must_use]
    pub fn strong(self, text: impl Into<String>) -> Self {
        self.with(Span::Strong(text.into()))
    }

    /// Adds code.
    #[must_use]
    pub fn code(self, text: impl Into<String>) -> Self {
        self.with(Span::Code(text.into()))
    }

    /// Adds a lowered letter.
    #[must_use]
    pub fn lowered(self, text: impl Into<String>) -> Self {
        self.with(Span::Subscript(text.into()))
    }

    /// Adds a raised digit.
    #[must_use]
    pub fn raised(self, text: impl Into<String>) -> Self {
        self.with(Span::Superscript(text.into()))
    }

    /// Adds a link.
    #[must_use]
    pub fn link(self, text: impl Into<String>, target: impl Into<String>) -> Self {
        self.with(Span::Link { text: text.into(), target: target.into() })
    }

    /// Ends the line.
    #[must_use]
    pub fn line_break(self) -> Self {
        self.with(Span::Break)
    }

    /// Adds another text.
    #[must_use]
    pub fn then(mut self, other: impl Into<Text>) -> Self {
        self.0.extend(other.into().0);
        self
    }

    /// The spans.
    pub fn spans(&self) -> &[Span] {
        &self.0
    }

    /// Whether there is nothing to read.
    pub fn is_empty(&self) -> bool {
        self.to_string().is_empty()
    }

    fn with(mut self, span: Span) -> Self {
        self.0.push(span);
        self
    }
}

/// A sentence's beginning: the text with its first letter as a capital.
pub(crate) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Plain text, taken literally.
impl From<&str> for Text {
    fn from(text: &str) -> Self {
        Text::new().plain(text)
    }
}

/// Plain text, taken literally.
impl From<String> for Text {
    fn from(text: String) -> Self {
        Text::new().plain(text)
    }
}

impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|span| match span {
            Span::Superscript(text) if text == "2" => f.write_str("²"),
            Span::Break => f.write_str("\n"),
            Span::Plain(text)
            | Span::Emphasis(text)
            | Span::Strong(text)
            | Span::Code(text)
            | Span::Subscript(text)
            | Span::Superscript(text)
            | Span::Link { text, .. } => f.write_str(text),
        })
    }
}

impl serde::Serialize for Text {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
