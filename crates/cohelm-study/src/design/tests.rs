//! The shipped studies, and what is refused with which words.

use super::*;

fn shipped(name: &str) -> String {
    let path = format!("{}/../../studies/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).expect("shipped with the project")
}

fn complaint(from: &str, to: &str) -> String {
    let text = shipped("pilot");
    assert!(text.contains(from), "{from:?} is in the file");
    Design::from_toml(&text.replacen(from, to, 1)).expect_err("must be refused").to_string()
}

#[test]
fn the_shipped_studies_are_read() {
    for name in ["pilot"] {
        let design = Design::from_toml(&shipped(name)).unwrap_or_else(|error| panic!("{name}:\n{error}"));
        assert_eq!(design.name, name);
    }
}

#[test]
fn an_unknown_key_is_named_with_its_place_and_the_nearest() {
    let said = complaint("practice-episodes", "practise-episodes");
    assert!(
        said.starts_with(
            "line 29, column 1: unknown key `practise-episodes`; did you mean `practice-episodes`?"
        ),
        "{said}"
    );
    let said = complaint("rule = \"lasc\"", "rule = \"lask\"");
    assert!(said.contains("unknown value `lask`; did you mean `lasc`?"), "{said}");
    let said = complaint("\norder =", "\nodrer =");
    assert!(said.contains("unknown key `odrer`; did you mean `order`?"), "{said}");
}
