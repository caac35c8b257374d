//! docs/your-own-plant.md holds the files of this crate as they are; `UPDATE_DOCS=1 cargo test -p your-own-plant` copies
//! them in.

use std::fs;
use std::path::Path;

const PAGE: &str = "../../docs/your-own-plant.md";

/// The page with the code below each mark replaced by the file that the mark names.
fn with_files(page: &str) -> String {
    let mut parts = page.split("<!-- file: ");
    let mut made = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once(" -->").expect("a mark ends");
        let (_, after) = rest.split_once("\n<!-- end of file -->").expect("a file ends");
        let code = fs::read_to_string(here(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let language = if name.ends_with(".toml") { "toml" } else { "rust" };
        made.push_str(&format!(
            "<!-- file: {name} -->\n\n```{language}\n{code}```\n\n<!-- end of file -->{after}"
        ));
    }
    made
}

fn here(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

#[test]
fn the_guide_holds_the_files_that_are_compiled_and_run() {
    let page = fs::read_to_string(here(PAGE)).unwrap();
    let expected = with_files(&page);
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(here(PAGE), &expected).unwrap();
    } else {
        let hint = "run `UPDATE_DOCS=1 cargo test -p your-own-plant --test guide`";
        assert!(page == expected, "docs/your-own-plant.md is not what is compiled: {hint}");
    }
    assert_eq!(expected.matches("```rust\n").count(), 2, "the plant and its afternoon");
}

#[test]
fn a_plant_takes_less_than_150_lines() {
    let lines = fs::read_to_string(here("src/lib.rs")).unwrap().lines().count();
    assert!(lines < 150, "the guide promises less than 150 lines, the plant has {lines}");
}

/// What the guide says of the workspace and of the three lists of plants.
#[test]
fn the_lists_that_the_guide_names_are_where_it_says() {
    let workspace = fs::read_to_string(here("../../Cargo.toml")).unwrap();
    let page = fs::read_to_string(here(PAGE)).unwrap();
    let members = workspace.lines().find(|line| line.starts_with("members = ")).expect("members");
    assert!(page.contains(members), "the guide does not show {members}");
    for list in ["crates/cohelm-cli/src/rig.rs", "crates/cohelm-page/src/fleet.rs", "python/src/world.rs"] {
        let text = fs::read_to_string(here("../..").join(list)).unwrap();
        assert!(text.contains("    plants.register(cohelm::point::entry());\n"), "{list}");
        assert!(page.contains(list), "{list}");
    }
}
