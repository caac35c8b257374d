//! Reports: one document, written as a self-contained HTML file and as Markdown.
//!
//! A [`Document`] is a title and a list of [`Block`]s. The HTML opens from disk, runs no script, loads nothing, prints well
//! and follows the reader's light or dark setting; figures lie in it as SVG. Tables and figures are numbered in order. The
//! same document gives the same bytes; it knows no clock, so a date stands in it only if the caller gives one.
//!
//! ```
//! use cohelm_study::report::{Block, Document};
//! let document = Document::new("Reproduction").with(Block::heading("Method")).with(Block::paragraph("Ten pilots & one goal."));
//! assert!(document.html().contains("Ten pilots &amp; one goal."));
//! assert!(document.markdown().contains("## Method"));
//! ```

mod html;
mod markdown;
mod study;
pub mod tables;

pub use study::study_report;

use crate::figures::Figure;
use crate::measures::{self, Measure};
use crate::text::Text;
use crate::verdict::{Judgement, Verdict};

/// A whole report.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Document {
    /// Title.
    pub title: String,
    /// One or two sentences below the title: what this is and what came out.
    pub lead: Text,
    /// Facts on the document's making, as ("Seed", "7"): everything one needs to make it again.
    pub facts: Vec<(String, String)>,
    /// The content, in order.
    pub blocks: Vec<Block>,
}

/// A piece of a report.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// Heading of a section, or of a part of one.
    Heading {
        /// The heading.
        text: String,
        /// Whether it opens a part within a section.
        within_section: bool,
    },
    /// A paragraph.
    Paragraph(Text),
    /// A remark set apart, such as "All participants are simulated."
    Callout {
        /// How loud it is.
        tone: Tone,
        /// Its heading.
        title: String,
        /// What it says.
        text: Text,
    },
    /// A list with dots.
    List(Vec<Text>),
    /// A command or file content, as typed.
    Code(String),
    /// A table.
    Table(Table),
    /// A figure.
    Figure(Placed),
    /// Claims with their verdicts.
    Verdicts(Vec<VerdictRow>),
    /// Terms with what they mean.
    Definitions(Vec<(String, Text)>),
}

/// How loud a callout is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// Good to know.
    Note,
    /// Must not be overlooked.
    Warning,
}

/// How a column is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
    /// Marks.
    Centre,
}

/// A table. Rows shorter than the head are filled up with empty cells; longer ones are cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What it shows; its number is set before it.
    pub caption: Text,
    /// Heads of the columns and how they are set.
    pub columns: Vec<(Text, Align)>,
    /// The rows.
    pub rows: Vec<Vec<Text>>,
    /// Notes below it.
    pub notes: Vec<Text>,
}

/// A figure with its caption, and where its files lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// The figure.
    pub figure: Figure,
    /// What it shows; its number is set before it.
    pub caption: Text,
    /// Path of its files relative to the report, without extension, as `figures/fig2a`.
    pub file: String,
}

/// A claim beside what came out.
#[derive(Debug, Clone, PartialEq)]
pub struct VerdictRow {
    /// The claim, as near to its author's words as it is short.
    pub claim: Text,
    /// What the paper reports for it.
    pub paper: Text,
    /// Our judgement.
    pub judgement: Judgement,
}

impl Document {
    /// An empty document.
    pub fn new(title: impl Into<String>) -> Self {
        Document { title: title.into(), ..Self::default() }
    }

    /// Adds a block.
    #[must_use]
    pub fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    /// Adds a block in place.
    pub fn push(&mut self, block: Block) {
        self.blocks.push(block);
    }

    /// The document as one HTML file.
    pub fn html(&self) -> String {
        html::write(self)
    }

    /// The document as Markdown (GitHub's), with its figures beside it as PNG files.
    pub fn markdown(&self) -> String {
        markdown::write(self)
    }

    /// Every file of the report with its path: `NAME.html`, `NAME.md`, and each figure as SVG, PNG (two pixels a point) and CSV.
    pub fn files(&self, name: &str) -> Vec<(String, Vec<u8>)> {
        let mut files = vec![
            (format!("{name}.html"), self.html().into_bytes()),
            (format!("{name}.md"), self.markdown().into_bytes()),
        ];
        for block in &self.blocks {
            if let Block::Figure(Placed { figure, file, .. }) = block {
                files.push((format!("{file}.svg"), figure.svg().into_bytes()));
                files.push((format!("{file}.png"), figure.png(2.0)));
                files.push((format!("{file}.csv"), figure.csv().to_string().into_bytes()));
            }
        }
        files
    }
}

impl Block {
    /// Heading of a section.
    pub fn heading(text: impl Into<String>) -> Self {
        Block::Heading { text: text.into(), within_section: false }
    }

    /// Heading of a part of a section.
    pub fn subheading(text: impl Into<String>) -> Self {
        Block::Heading { text: text.into(), within_section: true }
    }

    /// A paragraph.
    pub fn paragraph(text: impl Into<Text>) -> Self {
        Block::Paragraph(text.into())
    }

    /// A warning.
    pub fn warning(title: impl Into<String>, text: impl Into<Text>) -> Self {
        Block::Callout { tone: Tone::Warning, title: title.into(), text: text.into() }
    }

    /// A note.
    pub fn note(title: impl Into<String>, text: impl Into<Text>) -> Self {
        Block::Callout { tone: Tone::Note, title: title.into(), text: text.into() }
    }

    /// A figure, whose files lie under `file` (without extension).
    pub fn figure(figure: Figure, caption: impl Into<Text>, file: impl Into<String>) -> Self {
        Block::Figure(Placed { figure, caption: caption.into(), file: file.into() })
    }

    /// The definitions of measures.
    pub fn measures<'a>(measures: impl IntoIterator<Item = &'a Measure<'a>>) -> Self {
        Block::Definitions(measures.into_iter().map(|m| (m.title(), measures::definition(m))).collect())
    }
}

/// How many claims got which verdict, in the order reproduces, only if, does not, cannot be judged.
fn tally(rows: &[VerdictRow]) -> [(&'static str, &'static str, usize); 4] {
    let count = |kind: fn(&Verdict) -> bool| rows.iter().filter(|row| kind(&row.judgement.verdict)).count();
    [
        ("yes", "reproduce", count(|v| matches!(v, Verdict::Reproduces))),
        ("if", "only under a condition", count(|v| matches!(v, Verdict::OnlyIf(_)))),
        ("no", "do not reproduce", count(|v| matches!(v, Verdict::DoesNot))),
        ("open", "cannot be judged", count(|v| matches!(v, Verdict::CannotBeJudged(_)))),
    ]
}

/// A target that leads to the web, to a place in the document or to a file beside it; nothing with another scheme.
fn safe_target(target: &str) -> Option<&str> {
    let web = target.starts_with("https://") || target.starts_with("http://");
    let scheme_free = !target.contains(':') && !target.starts_with("//") && !target.starts_with('\\');
    (web || scheme_free).then_some(target)
}

/// Whether a path can be linked to as a file beside the report.
fn safe_file(file: &str) -> bool {
    safe_target(file).is_some() && !file.is_empty()
}
