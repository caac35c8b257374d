//! A document as one HTML file.

use super::{Align, Block, Document, Placed, Table, Tone, VerdictRow, safe_file, safe_target, tally};
use crate::figures::{escaped, font_faces};
use crate::text::{Span, Text};
use crate::verdict::Verdict;
use base64::{Engine, engine::general_purpose::STANDARD};
use std::collections::HashSet;
use std::fmt::Write;

const STYLE: &str = include_str!("style.css");
const SERIF: [(u32, &str, &[u8]); 3] = [
    (400, "normal", include_bytes!("../../fonts/CohelmSerif-Regular.woff2")),
    (400, "italic", include_bytes!("../../fonts/CohelmSerif-Italic.woff2")),
    (600, "normal", include_bytes!("../../fonts/CohelmSerif-SemiBold.woff2")),
];
/// Nothing is loaded and nothing runs, whatever a name in the data may try.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; font-src data:";

/// Writing to a `String` cannot fail, hence the results dropped here and below.
pub(super) fn write(document: &Document) -> String {
    let mut writer = Writer::default();
    for block in &document.blocks {
        writer.block(block);
    }
    let title = escaped(&document.title);
    let mut out = String::with_capacity(writer.body.len() + 300_000);
    let _ = write!(
        out,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>{}{}\n{STYLE}</style>\n</head>\n<body>\n<div class=\"page\">\n<header>\n<h1>{title}</h1>\n",
        font_faces(),
        serif_faces()
    );
    if !document.lead.is_empty() {
        let _ = writeln!(out, "<p class=\"lead\">{}</p>", inline(&document.lead));
    }
    write_facts(&mut out, &document.facts);
    let _ = write!(out, "</header>\n{}{}</div>\n</body>\n</html>\n", contents(&writer.sections), writer.body);
    out
}

fn serif_faces() -> String {
    SERIF
        .iter()
        .map(|(weight, style, file)| {
            format!(
                "@font-face{{font-family:\"Cohelm Serif\";font-weight:{weight};font-style:{style};\
                 src:url(data:font/woff2;base64,{}) format(\"woff2\")}}",
                STANDARD.encode(file)
            )
        })
        .collect()
}

fn write_facts(out: &mut String, facts: &[(String, String)]) {
    if facts.is_empty() {
        return;
    }
    out.push_str("<dl class=\"facts\">\n");
    for (name, value) in facts {
        let _ = writeln!(out, "<div><dt>{}</dt><dd>{}</dd></div>", escaped(name), escaped(value));
    }
    out.push_str("</dl>\n");
}

/// A list of the sections, where there are enough to get lost in.
fn contents(sections: &[(String, String)]) -> String {
    if sections.len() < 3 {
        return String::new();
    }
    let items: String = sections
        .iter()
        .map(|(anchor, text)| format!("<li><a href=\"#{anchor}\">{}</a></li>\n", escaped(text)))
        .collect();
    format!("<nav aria-label=\"Contents\">\n<ol>\n{items}</ol>\n</nav>\n")
}

/// Text with its emphases.
fn inline(text: &Text) -> String {
    text.spans().iter().map(span).collect()
}

fn span(span: &Span) -> String {
    let tagged = |tag: &str, text: &str| format!("<{tag}>{}</{tag}>", escaped(text));
    match span {
        Span::Plain(text) => escaped(text),
        Span::Emphasis(text) => tagged("em", text),
        Span::Strong(text) => tagged("strong", text),
        Span::Code(text) => tagged("code", text),
        Span::Subscript(text) => tagged("sub", text),
        Span::Superscript(text) => tagged("sup", text),
        Span::Break => "<br>".to_owned(),
        Span::Link { text, target } => match safe_target(target) {
            Some(target) => format!("<a href=\"{}\">{}</a>", escaped(target), escaped(text)),
            None => escaped(text),
        },
    }
}

#[derive(Default)]
struct Writer {
    body: String,
    sections: Vec<(String, String)>,
    anchors: HashSet<String>,
    tables: u32,
    figures: u32,
}

impl Writer {
    fn block(&mut self, block: &Block) {
        match block {
            Block::Heading { text, within_section } => self.heading(text, *within_section),
            Block::Paragraph(text) => self.line(format!("<p>{}</p>", inline(text))),
            Block::Callout { tone, title, text } => {
                let class = if *tone == Tone::Warning { "callout warning" } else { "callout" };
                let (title, text) = (escaped(title), inline(text));
                self.line(format!("<aside class=\"{class}\"><b>{title}</b><p>{text}</p></aside>"));
            }
            Block::List(items) => {
                let items: String = items.iter().map(|item| format!("<li>{}</li>\n", inline(item))).collect();
                self.line(format!("<ul>\n{items}</ul>"));
            }
            Block::Code(code) => self.line(format!("<pre>{}</pre>", escaped(code))),
            Block::Table(table) => self.table(table),
            Block::Figure(placed) => self.figure(placed),
            Block::Verdicts(rows) => self.verdicts(rows),
            Block::Definitions(terms) => self.definitions(terms),
        }
    }

    fn line(&mut self, line: String) {
        self.body.push_str(&line);
        self.body.push('\n');
    }

    fn heading(&mut self, text: &str, within_section: bool) {
        let anchor = self.anchor(text);
        let level = if within_section { 3 } else { 2 };
        self.line(format!("<h{level} id=\"{anchor}\">{}</h{level}>", escaped(text)));
        if !within_section {
            self.sections.push((anchor, text.to_owned()));
        }
    }

    /// Letters, digits and hyphens made of a heading, different for each.
    fn anchor(&mut self, text: &str) -> String {
        let plain: String = text
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' })
            .collect();
        let words: Vec<&str> = plain.split('-').filter(|word| !word.is_empty()).collect();
        let base = if words.is_empty() { "section".to_owned() } else { words.join("-") };
        let mut anchor = base.clone();
        let mut count = 1;
        while !self.anchors.insert(anchor.clone()) {
            count += 1;
            anchor = format!("{base}-{count}");
        }
        anchor
    }

    fn table(&mut self, table: &Table) {
        self.tables += 1;
        let head: String = table
            .columns
            .iter()
            .map(|(text, align)| format!("<th scope=\"col\"{}>{}</th>", class(*align), inline(text)))
            .collect();
        let wide = if table.columns.len() > 6 { " wide" } else { "" };
        self.line(format!(
            "<div class=\"table{wide}\"><table>\n<caption><b>Table {}.</b> {}</caption>\n<thead><tr>{head}</tr></thead>\n<tbody>",
            self.tables,
            inline(&table.caption)
        ));
        let empty = Text::new();
        for row in &table.rows {
            let cells = table.columns.iter().enumerate().map(|(i, (_, align))| {
                format!("<td{}>{}</td>", class(*align), inline(row.get(i).unwrap_or(&empty)))
            });
            self.line(format!("<tr>{}</tr>", cells.collect::<String>()));
        }
        let notes: String = table.notes.iter().map(|note| format!("<p>{}</p>", inline(note))).collect();
        let notes = if notes.is_empty() { notes } else { format!("<div class=\"notes\">{notes}</div>") };
        self.line(format!("</tbody></table>{notes}</div>"));
    }

    fn figure(&mut self, placed: &Placed) {
        self.figures += 1;
        let files = if safe_file(&placed.file) {
            let link = |kind: &str| {
                format!("<a href=\"{}.{kind}\">{}</a>", escaped(&placed.file), kind.to_uppercase())
            };
            format!(" <span class=\"files\">{}{}{}</span>", link("svg"), link("png"), link("csv"))
        } else {
            String::new()
        };
        self.line(format!(
            "<figure class=\"wide\">\n{}<figcaption><b>Figure {}.</b> {}{files}</figcaption>\n</figure>",
            placed.figure.inline_svg(),
            self.figures,
            inline(&placed.caption)
        ));
    }

    fn verdicts(&mut self, rows: &[VerdictRow]) {
        let counts: String = tally(rows)
            .into_iter()
            .filter(|(_, _, count)| *count > 0)
            .map(|(kind, words, count)| {
                format!("<li><span class=\"badge {kind}\">{}{count}</span>{words}</li>\n", icon(kind))
            })
            .collect();
        self.line(format!("<ul class=\"tally wide\">\n{counts}</ul>"));
        self.line(
            "<div class=\"table wide\"><table class=\"verdicts\">\n<thead><tr><th scope=\"col\">Claim</th>\
             <th scope=\"col\">Paper</th><th scope=\"col\">Ours</th><th scope=\"col\">Verdict</th></tr></thead>"
                .to_owned(),
        );
        for row in rows {
            let kind = kind(&row.judgement.verdict);
            self.line(format!(
                "<tbody class=\"claim-row\">\n<tr><td class=\"claim\">{}</td><td class=\"paper\">{}</td><td class=\"ours\">{}</td>\
                 <td><span class=\"badge {kind}\">{}<span>{}</span></span></td></tr>\n\
                 <tr class=\"why\"><td colspan=\"4\">{}</td></tr>\n</tbody>",
                inline(&row.claim),
                inline(&row.paper),
                inline(&row.judgement.ours),
                icon(kind),
                escaped(&row.judgement.verdict.words()),
                inline(&row.judgement.sentence)
            ));
        }
        self.line("</table></div>".to_owned());
    }

    fn definitions(&mut self, terms: &[(String, Text)]) {
        let items: String = terms
            .iter()
            .map(|(term, meaning)| {
                format!("<div><dt>{}</dt><dd>{}</dd></div>\n", escaped(term), inline(meaning))
            })
            .collect();
        self.line(format!("<dl class=\"definitions\">\n{items}</dl>"));
    }
}

fn class(align: Align) -> &'static str {
    match align {
        Align::Left => "",
        Align::Right => " class=\"right\"",
        Align::Centre => " class=\"centre\"",
    }
}

fn kind(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Reproduces => "yes",
        Verdict::DoesNot => "no",
        Verdict::OnlyIf(_) => "if",
        Verdict::CannotBeJudged(_) => "open",
    }
}

/// A sign beside the colour: not everybody tells the colours apart.
fn icon(kind: &str) -> String {
    let path = match kind {
        "yes" => "M2.5 8.5 6.2 12.2 13.5 4.2",
        "no" => "M3.5 3.5 12.5 12.5M12.5 3.5 3.5 12.5",
        "if" => "M8 14V9L3 3.5M8 9 13 3.5",
        _ => "M5 5.6C5 1.8 11 1.8 11 5.4 11 8 8 7.8 8 10.4M8 13.4V13.5",
    };
    format!(
        "<svg viewBox=\"0 0 16 16\" aria-hidden=\"true\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"2.2\" \
         stroke-linecap=\"round\" stroke-linejoin=\"round\"><path d=\"{path}\"/></svg>"
    )
}
