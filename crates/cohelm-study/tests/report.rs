//! Reports: self-contained, well-formed and safe whatever stands in the data; the same content as HTML and Markdown.

use cohelm_study::figures::{Axis, BoxPlot, Conditions, Figure, Heading};
use cohelm_study::measures::OF_A_PARTICIPANT;
use cohelm_study::report::{Align, Block, Document, Table, VerdictRow};
use cohelm_study::text::Text;
use cohelm_study::verdict::{Judgement, Verdict, needs_people};
use proptest::prelude::*;
use std::collections::BTreeMap;

fn figure(name: &str) -> Figure {
    let figure = BoxPlot {
        heading: Heading::new(name, name),
        axis: Axis::share(name),
        participants: vec![name.to_owned()],
        conditions: Conditions::in_order([name]),
        values: vec![vec![Some(0.5)]],
    };
    figure.figure().unwrap()
}

fn judgement(verdict: Verdict, text: &str) -> Judgement {
    Judgement { verdict, ours: Text::from(text), sentence: Text::from(text), numbers: BTreeMap::new() }
}

/// A document that says `text` in every place where text can stand.
fn everywhere(text: &str) -> Document {
    let rich = || {
        Text::from(text)
            .em(text)
            .strong(text)
            .code(text)
            .lowered(text)
            .raised(text)
            .line_break()
            .link(text, text)
    };
    let row = |verdict| VerdictRow { claim: rich(), paper: rich(), judgement: judgement(verdict, text) };
    let mut document = Document::new(text);
    document.lead = rich();
    document.facts = vec![(text.to_owned(), text.to_owned())];
    document
        .with(Block::heading(text))
        .with(Block::subheading(text))
        .with(Block::paragraph(rich()))
        .with(Block::warning(text, rich()))
        .with(Block::List(vec![rich(), rich()]))
        .with(Block::Code(text.to_owned()))
        .with(Block::Table(Table {
            caption: rich(),
            columns: vec![(rich(), Align::Left), (rich(), Align::Right)],
            rows: vec![vec![rich(), rich()], vec![rich()]],
            notes: vec![rich()],
        }))
        .with(Block::figure(figure(text), rich(), text))
        .with(Block::Verdicts(vec![
            row(Verdict::Reproduces),
            row(Verdict::DoesNot),
            row(Verdict::OnlyIf(text.to_owned())),
            row(Verdict::CannotBeJudged(text.to_owned())),
        ]))
        .with(Block::Definitions(vec![(text.to_owned(), rich())]))
}

/// The tags of an HTML document; fails on a tag that is not closed or closed twice.
fn tags(html: &str) -> Vec<&str> {
    const VOID: [&str; 3] = ["meta", "br", "!doctype"];
    let (mut tags, mut open, mut rest) = (Vec::new(), Vec::new(), html);
    while let Some(start) = rest.find('<') {
        let end = start + rest[start..].find('>').expect("an open tag");
        let tag = &rest[start + 1..end];
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let name = tag.trim_end_matches('/').split(' ').next().unwrap();
        match name.strip_prefix('/') {
            Some(name) => assert_eq!(open.pop(), Some(name)),
            None if tag.ends_with('/') || VOID.contains(&name) => tags.push(name),
            None => {
                open.push(name);
                tags.push(name);
            }
        }
        rest = &rest[end + 1..];
        if name == "style" {
            rest = &rest[rest.find("</style>").expect("the end of the style")..];
        }
    }
    assert!(open.is_empty(), "{open:?}");
    tags
}

#[test]
fn nothing_is_loaded_and_nothing_runs() {
    let html = everywhere("plain").html();
    let tags = tags(&html);
    assert!(!tags.iter().any(|tag| ["script", "img", "link", "iframe", "object"].contains(tag)));
    assert!(html.contains("default-src 'none'"));
    let urls = html.match_indices("url(").map(|(at, _)| &html[at..at + 9]);
    assert!(urls.clone().count() == 5 && urls.into_iter().all(|url| url == "url(data:"));
    assert!(html.len() < 400_000, "{}", html.len());
}

#[test]
fn names_in_the_data_stay_names() {
    let clean = tags(&everywhere("x").html()).len();
    let hostile = "</text></style></td><script>alert(\"1\")</script> & 'x' | `y`\u{0}";
    let html = everywhere(hostile).html();
    // Of the places, only the links and the file names become plain text.
    assert!(tags(&html).len() <= clean && !html.contains("<script"));
    for target in ["javascript:alert(1)", "data:text/html,x", "//evil.example", "\\\\evil"] {
        let html = everywhere(target).html();
        assert!(!html.contains(&format!("href=\"{target}")), "{target}");
        assert!(!everywhere(target).markdown().contains(&format!("](<{target}")), "{target}");
    }
}

#[test]
fn links_lead_to_the_web_to_places_and_to_files() {
    for target in ["https://example.org/a?b=1&c=2", "#steps", "tables/episodes.csv"] {
        let html = Document::new("t").with(Block::paragraph(Text::new().link("there", target))).html();
        assert!(
            html.contains(&format!("<a href=\"{}\">there</a>", target.replace('&', "&amp;"))),
            "{target}"
        );
    }
}

#[test]
fn headings_get_places_of_their_own_and_a_list_of_contents() {
    let document = ["Steps", "Steps", "η²", "Steps"]
        .map(Block::heading)
        .into_iter()
        .fold(Document::new("t"), Document::with);
    let html = document.html();
    for anchor in ["\"steps\"", "\"steps-2\"", "\"steps-3\"", "\"section\""] {
        assert_eq!(html.matches(&format!("id={anchor}")).count(), 1, "{anchor}");
        assert!(html.contains(&format!("href=\"#{}", &anchor[1..])), "{anchor}");
    }
    let short = Document::new("t").with(Block::heading("Only one"));
    assert!(!short.html().contains("<nav"));
}

#[test]
fn tables_and_figures_are_numbered_alike_in_both() {
    let table = || {
        Block::Table(Table {
            caption: "cap".into(),
            columns: vec![("a".into(), Align::Centre)],
            rows: vec![],
            notes: vec![],
        })
    };
    let document =
        Document::new("t").with(table()).with(Block::figure(figure("x"), "cap", "figures/x")).with(table());
    let (html, markdown) = (document.html(), document.markdown());
    for number in ["Table 1.", "Figure 1.", "Table 2."] {
        assert!(
            html.contains(&format!("<b>{number}</b> cap")) && markdown.contains(&format!("**{number}** cap"))
        );
    }
    let files: Vec<String> = document.files("report").into_iter().map(|(name, _)| name).collect();
    assert_eq!(files, ["report.html", "report.md", "figures/x.svg", "figures/x.png", "figures/x.csv"]);
    assert!(markdown.contains("](<figures/x.png>)") && html.contains("<a href=\"figures/x.csv\">CSV</a>"));
}

#[test]
fn verdicts_have_word_sign_and_count() {
    let claim =
        |verdict| VerdictRow { claim: "c".into(), paper: "p".into(), judgement: judgement(verdict, "s") };
    let rows = vec![
        claim(Verdict::Reproduces),
        claim(Verdict::Reproduces),
        claim(Verdict::OnlyIf("the confidence is peaked".into())),
        VerdictRow {
            claim: "t".into(),
            paper: "p".into(),
            judgement: needs_people(0, || judgement(Verdict::DoesNot, "s")),
        },
    ];
    let document = Document::new("t").with(Block::Verdicts(rows));
    let html = document.html();
    assert!(
        html.contains("<span>Only if the confidence is peaked</span>")
            && html.contains("</svg>2</span>reproduce")
    );
    let markdown = document.markdown();
    assert!(markdown.contains("Of 4 claims: 2 reproduce, 1 only under a condition, 1 cannot be judged."));
    assert!(markdown.contains("| c | p | s | **Only if the confidence is peaked** |"));
}

#[test]
fn measures_are_printed_with_their_definitions() {
    let markdown = Document::new("t").with(Block::measures(&OF_A_PARTICIPANT)).markdown();
    assert!(markdown.contains("- **Success rate**: Share of the episodes that ended at the pilot’s own goal. Unit: share of one. Column `success`."));
}

/// Bars that end a cell: those without a backslash before them.
fn cells(row: &str) -> usize {
    row.replace("\\\\", "").replace("\\|", "").matches('|').count()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_safe_anywhere(text in "(?s).{0,12}|[<>&\"'|`*_\\\\\\[\\](){}#!\n-]{0,12}") {
        let plain = everywhere("x").html();
        let clean = tags(&plain);
        let html = everywhere(&text).html();
        let found = tags(&html);
        prop_assert!(found.iter().all(|tag| clean.contains(tag)), "{text:?}");
        prop_assert!(found.len() <= clean.len(), "{text:?}");
        let markdown = everywhere(&text).markdown();
        for row in markdown.lines().filter(|line| line.starts_with("| ")) {
            let count = cells(row);
            prop_assert!(count == 3 || count == 5, "{row:?}");
        }
    }
}
