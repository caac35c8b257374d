//! `docs/measures.md` says what `measures.rs` says: `COHELM_BLESS=1 cargo test -p cohelm-study --test measures_page` writes
//! it anew.

use cohelm_study::measures::{Measure, OF_A_FLIGHT, OF_A_PARTICIPANT, OF_ALL_TICKS, OF_AN_EPISODE};
use std::fmt::Write;

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/measures.md");

const HEAD: &str = "\
# What is measured

Every measure has one definition, in `crates/cohelm-study/src/measures.rs`; tables, reports, data dictionaries and this page
are made of it, and a test holds the page to it. All are computed by flying an episode again from its record
(`crates/cohelm-lab/src/episode.rs` and `crates/cohelm-lab/src/study/tally.rs`): a flight whose bits differ is not measured,
and the report says so.

A participant’s value in a condition is the mean over the measured flights that have one. Practice flights, test runs,
excluded participants and those who did not finish are in the export and in no analysis. Simulated participants are never
analysed together with people.

The three counts of input are ticks with a command, key presses and commands per second: a held key counts once a tick in
the first, once in the second, and the third does not grow merely because a flight lasts longer.

Two kinds of value follow from the design alone and are compared with nothing: of interventions under human alone, where
there are none, and of beliefs where the goal is told.
";

fn page() -> String {
    let mut page = HEAD.to_owned();
    section(&mut page, "Of an episode", &OF_AN_EPISODE);
    section(&mut page, "Of an episode in a study, besides", &OF_A_FLIGHT);
    section(&mut page, "Of a participant in a condition: rates", &OF_A_PARTICIPANT);
    section(&mut page, "Of all ticks of a participant in a condition", &OF_ALL_TICKS);
    page
}

fn section(page: &mut String, title: &str, measures: &[Measure<'_>]) {
    let _ = write!(
        page,
        "\n## {title}\n\n| column | meaning | unit | values | no value when |\n|---|---|---|---|---|\n"
    );
    for m in measures {
        let cell = |text: &str| text.replace('|', "\\|");
        let range = cell(&m.range.words());
        let _ = writeln!(
            page,
            "| `{}` | {} | {} | {range} | {} |",
            m.key,
            cell(m.meaning),
            m.unit.word(),
            m.missing_when
        );
    }
}

#[test]
fn the_page_is_current() {
    if std::env::var_os("COHELM_BLESS").is_some() {
        std::fs::write(DOCUMENT, page()).unwrap();
    }
    let written = std::fs::read_to_string(DOCUMENT).unwrap_or_default();
    assert!(
        written == page(),
        "docs/measures.md is old: COHELM_BLESS=1 cargo test -p cohelm-study --test measures_page"
    );
}
