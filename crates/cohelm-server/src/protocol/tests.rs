//! Messages come back as they were; whatever else comes is an error and never a panic. The examples of
//! `docs/records.md` are held against the code: `COHELM_BLESS=1 cargo test -p cohelm-server` writes them anew.

use super::*;
use crate::testing::{Page, setup};
use proptest::prelude::*;
use std::fmt::Write;

fn from_page() -> Vec<(&'static str, FromPage)> {
    let key = FlightKey(core::array::from_fn(|i| i as u8));
    let mut page = Page::new(setup(5));
    let chunk = page.fly(30);
    vec![
        ("Begin", FromPage::Begin(Begin { key, age_ms: 40, setup: setup(5) })),
        ("Chunk", FromPage::Chunk(chunk)),
        ("End", FromPage::End(page.end())),
    ]
}

fn to_page() -> Vec<(&'static str, ToPage)> {
    let welcome = Welcome { cohelm: "0.1.0".into(), format: 1, learning: false, values: None };
    vec![
        ("Welcome", ToPage::Welcome(welcome)),
        ("Begun", ToPage::Begun { episode: EpisodeId(7), committed_tick: 0 }),
        ("Ack", ToPage::Ack { committed_tick: 30 }),
        ("Refused", ToPage::Refused { reason: "the page flies another version".into() }),
        ("Finished", ToPage::Finished { episode: EpisodeId(7) }),
        ("NewModel", ToPage::NewModel { hash: core::array::from_fn(|i| i as u8) }),
    ]
}

#[test]
fn every_message_comes_back_as_it_was() {
    for (name, message) in from_page() {
        assert_eq!(FromPage::from_bytes(&message.to_bytes()), Ok(message), "{name}");
    }
    for (name, message) in to_page() {
        assert_eq!(ToPage::from_bytes(&message.to_bytes()), Ok(message), "{name}");
    }
}

#[test]
fn what_is_no_message_is_told_apart() {
    let begin = from_page()[0].1.to_bytes();
    let end = from_page()[2].1.to_bytes();
    let changed = |bytes: &[u8], at: usize, value: u8| {
        let mut bytes = bytes.to_vec();
        bytes[at] = value;
        FromPage::from_bytes(&bytes)
    };
    assert_eq!(FromPage::from_bytes(&[]), Err(ProtocolError::CutOff));
    assert_eq!(changed(&end, 0, 2), Err(ProtocolError::Version(2)));
    assert_eq!(changed(&end, 1, 99), Err(ProtocolError::Kind(99)));
    assert_eq!(changed(&end, 6, 6), Err(ProtocolError::Ending(6)));
    assert!(matches!(changed(&begin, 22, b'!'), Err(ProtocolError::Text { what: "setup", .. })));
    assert_eq!(FromPage::from_bytes(&[&end[..], b"!!"].concat()), Err(ProtocolError::TooLong(2)));
    assert_eq!(FromPage::from_bytes(&end[..end.len() - 1]), Err(ProtocolError::CutOff));
    let large = vec![1; MAX_MESSAGE + 1];
    let error = ProtocolError::TooLarge { bytes: MAX_MESSAGE + 1, most: MAX_MESSAGE };
    assert_eq!(FromPage::from_bytes(&large), Err(error));
    let long_setup = [&begin[..22], &vec![b' '; MAX_SETUP], &begin[22..]].concat();
    assert!(matches!(FromPage::from_bytes(&long_setup), Err(ProtocolError::TooLarge { .. })));
    assert_eq!(
        FromPage::from_bytes(&ToPage::Ack { committed_tick: 1 }.to_bytes()),
        Err(ProtocolError::Kind(131))
    );
}

#[test]
fn a_long_reason_is_cut_between_characters() {
    let bytes = ToPage::Refused { reason: "ü".repeat(MAX_REASON) + "x" }.to_bytes();
    assert_eq!(ToPage::from_bytes(&bytes), Ok(ToPage::Refused { reason: "ü".repeat(MAX_REASON / 2) }));
}

#[test]
fn deeply_nested_json_is_refused() {
    let begin = from_page()[0].1.to_bytes();
    let nested =
        [&begin[..22], br#"{"task":{"plant":"point","options":"#, "[".repeat(10_000).as_bytes()].concat();
    assert!(matches!(FromPage::from_bytes(&nested), Err(ProtocolError::Text { .. })));
}

proptest! {
    /// Whatever bytes come, reading them gives a message or an error.
    #[test]
    fn any_bytes_are_read_without_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = FromPage::from_bytes(&bytes);
        let _ = ToPage::from_bytes(&bytes);
    }

    /// A valid message that was damaged is an error, or a message that says the same when it is written again.
    #[test]
    fn damaged_messages_are_read_without_a_panic(
        which in 0_usize..3,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        kept in any::<prop::sample::Index>(),
    ) {
        let mut bytes = from_page()[which].1.to_bytes();
        damage.iter().for_each(|(at, value)| *at.get_mut(&mut bytes) = *value);
        bytes.truncate(kept.index(bytes.len()) + 1);
        if let Ok(message) = FromPage::from_bytes(&bytes) {
            prop_assert_eq!(FromPage::from_bytes(&message.to_bytes()), Ok(message));
        }
    }
}

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/records.md");
const OPENING: &str = "<!-- examples: written by a test of cohelm-server -->\n";
const CLOSING: &str = "<!-- end of examples -->\n";

#[test]
fn the_examples_in_the_documentation_are_what_the_code_writes() {
    let document = std::fs::read_to_string(DOCUMENT).unwrap();
    let (before, rest) = document.split_once(OPENING).expect("the document has a place for the examples");
    let (_, after) = rest.split_once(CLOSING).expect("the examples end somewhere");
    let written = format!("{before}{OPENING}{}{CLOSING}{after}", examples());
    if std::env::var_os("COHELM_BLESS").is_some() {
        std::fs::write(DOCUMENT, &written).unwrap();
        return;
    }
    assert!(
        document == written,
        "docs/records.md is out of date: COHELM_BLESS=1 cargo test -p cohelm-server"
    );
}

fn examples() -> String {
    let mut text = String::new();
    for (name, message) in from_page() {
        example(&mut text, "page to server", name, &message.to_bytes());
    }
    for (name, message) in to_page() {
        example(&mut text, "server to page", name, &message.to_bytes());
    }
    text
}

/// Sixteen bytes a line, with what of them is printable beside them.
fn example(text: &mut String, direction: &str, name: &str, bytes: &[u8]) {
    writeln!(text, "\n{name}, {direction}, {} bytes:\n\n```text", bytes.len()).unwrap();
    for line in bytes.chunks(16) {
        let hex = line.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ");
        let readable: String =
            line.iter().map(|&b| if b.is_ascii_graphic() { char::from(b) } else { '.' }).collect();
        writeln!(text, "{hex:<47}  {readable}").unwrap();
    }
    writeln!(text, "```").unwrap();
}
