//! A document as Markdown.

use super::{Align, Block, Document, Placed, Table, Tone, VerdictRow, safe_file, safe_target, tally};
use crate::text::{Span, Text};
use std::fmt::Write;

/// Writing to a `String` cannot fail, hence the results dropped here and below.
pub(super) fn write(document: &Document) -> String {
    let mut writer = Writer { out: format!("# {}\n", literal(&document.title)), tables: 0, figures: 0 };
    if !document.lead.is_empty() {
        writer.paragraph(&inline(&document.lead));
    }
    if !document.facts.is_empty() {
        let facts: Vec<String> = document
            .facts
            .iter()
            .map(|(name, value)| format!("{}: {}", literal(name), literal(value)))
            .collect();
        writer.paragraph(&facts.join(" · "));
    }
    for block in &document.blocks {
        writer.block(block);
    }
    writer.out
}

/// A title that a sentence follows on the same line.
fn stopped(title: &str) -> String {
    if title.ends_with(['.', '!', '?', ':']) { title.to_owned() } else { format!("{title}.") }
}

struct Writer {
    out: String,
    tables: u32,
    figures: u32,
}

impl Writer {
    fn paragraph(&mut self, text: &str) {
        let _ = write!(self.out, "\n{}\n", unlike_a_block(text));
    }

    fn block(&mut self, block: &Block) {
        match block {
            Block::Heading { text, within_section } => {
                let level = if *within_section { "###" } else { "##" };
                let _ = write!(self.out, "\n{level} {}\n", literal(text));
            }
            Block::Paragraph(text) => self.paragraph(&inline(text)),
            Block::Callout { tone, title, text } => {
                let kind = if *tone == Tone::Warning { "WARNING" } else { "NOTE" };
                let _ =
                    write!(self.out, "\n> [!{kind}]\n> **{}** {}\n", literal(&stopped(title)), inline(text));
            }
            Block::List(items) => {
                self.out.push('\n');
                items.iter().for_each(|item| {
                    let _ = writeln!(self.out, "- {}", unlike_a_block(&inline(item)));
                });
            }
            Block::Code(code) => {
                let fence = "`".repeat(longest_run(code, '`').max(2) + 1);
                let _ = write!(self.out, "\n{fence}text\n{}\n{fence}\n", code.trim_end_matches('\n'));
            }
            Block::Table(table) => self.table(table),
            Block::Figure(placed) => self.figure(placed),
            Block::Verdicts(rows) => self.verdicts(rows),
            Block::Definitions(terms) => {
                self.out.push('\n');
                terms.iter().for_each(|(term, meaning)| {
                    let _ = writeln!(self.out, "- **{}**: {}", literal(term), inline(meaning));
                });
            }
        }
    }

    fn table(&mut self, table: &Table) {
        self.tables += 1;
        let caption = format!("**Table {}.** {}", self.tables, inline(&table.caption));
        self.paragraph(&caption);
        let heads: Vec<String> = table.columns.iter().map(|(text, _)| inline(text)).collect();
        let rules: Vec<&str> = table.columns.iter().map(|(_, align)| rule(*align)).collect();
        let _ = write!(self.out, "\n| {} |\n| {} |\n", heads.join(" | "), rules.join(" | "));
        for row in &table.rows {
            let cells: Vec<String> =
                (0..table.columns.len()).map(|i| row.get(i).map_or(String::new(), inline)).collect();
            let _ = writeln!(self.out, "| {} |", cells.join(" | "));
        }
        for note in &table.notes {
            self.paragraph(&inline(note));
        }
    }

    fn figure(&mut self, placed: &Placed) {
        self.figures += 1;
        let caption = format!("**Figure {}.** {}", self.figures, inline(&placed.caption));
        if safe_file(&placed.file) {
            let (description, file) = (literal(placed.figure.description()), address(&placed.file));
            let _ = write!(self.out, "\n![{description}](<{file}.png>)\n");
        }
        self.paragraph(&caption);
    }

    fn verdicts(&mut self, rows: &[VerdictRow]) {
        let counts: Vec<String> = tally(rows)
            .into_iter()
            .filter(|(_, _, count)| *count > 0)
            .map(|(_, words, count)| format!("{count} {words}"))
            .collect();
        self.paragraph(&format!("Of {} claims: {}.", rows.len(), counts.join(", ")));
        self.out.push_str("\n| Claim | Paper | Ours | Verdict |\n| :--- | :--- | :--- | :--- |\n");
        for row in rows {
            let verdict = literal(&row.judgement.verdict.words());
            let cells = [inline(&row.claim), inline(&row.paper), inline(&row.judgement.ours)];
            let _ = writeln!(self.out, "| {} | **{verdict}** |", cells.join(" | "));
        }
        self.out.push('\n');
        for row in rows {
            let _ =
                writeln!(self.out, "- **{}** {}", inline_plain(&row.claim), inline(&row.judgement.sentence));
        }
    }
}

fn rule(align: Align) -> &'static str {
    match align {
        Align::Left => ":---",
        Align::Right => "---:",
        Align::Centre => ":---:",
    }
}

fn inline(text: &Text) -> String {
    text.spans().iter().map(span).collect()
}

/// Text without emphases, for places that are emphasised as a whole.
fn inline_plain(text: &Text) -> String {
    literal(&text.to_string())
}

fn span(span: &Span) -> String {
    match span {
        Span::Plain(text) => literal(text),
        Span::Emphasis(text) => format!("*{}*", literal(text)),
        Span::Strong(text) => format!("**{}**", literal(text)),
        Span::Code(text) => code(text),
        Span::Subscript(text) => format!("<sub>{}</sub>", literal(text)),
        Span::Superscript(text) => format!("<sup>{}</sup>", literal(text)),
        Span::Break => "<br>".to_owned(),
        Span::Link { text, target } => match safe_target(target) {
            Some(target) => format!("[{}](<{}>)", literal(text), address(target)),
            None => literal(text),
        },
    }
}

/// A target between angle brackets, with what would end it or a table's cell percent-encoded.
fn address(target: &str) -> String {
    let mut out = String::with_capacity(target.len());
    for c in target.chars() {
        match c {
            '<' | '>' | '|' | '\\' | '`' => {
                let _ = write!(out, "%{:02X}", u32::from(c));
            }
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// Code in as many backticks as it takes; with a bar, which between backticks would end a table's cell, as HTML.
fn code(text: &str) -> String {
    if text.contains('|') {
        return format!("<code>{}</code>", literal(text));
    }
    let ticks = "`".repeat(longest_run(text, '`') + 1);
    let pad = if text.starts_with('`') || text.ends_with('`') { " " } else { "" };
    format!("{ticks}{pad}{}{pad}{ticks}", text.replace(['\n', '\r'], " "))
}

fn longest_run(text: &str, of: char) -> usize {
    text.split(|c| c != of).map(str::len).max().unwrap_or(0)
}

/// Text in which nothing is markup. Line breaks become spaces.
fn literal(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '~' | '#' | '$' => {
                out.push('\\');
                out.push(c);
            }
            '&' => out.push_str("&amp;"),
            '\n' | '\r' => out.push(' '),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// A line that begins like a list, a quotation or a rule is kept from being one.
fn unlike_a_block(line: &str) -> String {
    let line = line.trim_start();
    let digits = line.chars().take_while(char::is_ascii_digit).count();
    let numbered = digits > 0 && line[digits..].starts_with(['.', ')']);
    if numbered {
        return format!("{}\\{}", &line[..digits], &line[digits..]);
    }
    if line.starts_with(['-', '+', '=']) { format!("\\{line}") } else { line.to_owned() }
}
