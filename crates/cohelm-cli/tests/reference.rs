//! `docs/cli.md` is what the program says of itself, command by command.

mod program;

use program::{folder, in_project, run};
use std::fs;

const HEAD: &str = "# The command line

Every command with all its options, as `--help` prints it. A test writes this page and fails when it is old:

```
UPDATE_DOCS=1 cargo test -p cohelm-cli --test reference
```
";

/// What `--help` prints for a command such as `["verify", "flights"]`.
fn help(command: &[String]) -> String {
    let ran = run(folder().path(), command.iter().map(String::as_str).chain(["--help"]));
    assert_eq!(ran.code, Some(0), "cohelm {} --help: {}", command.join(" "), ran.stderr);
    let lines: Vec<&str> = ran.stdout.trim_end().lines().map(str::trim_end).collect();
    lines.join("\n")
}

/// The commands that a help text lists.
fn below(help: &str) -> Vec<String> {
    let listed =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = listed.filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(String::from).collect()
}

/// A section for a command and for each command below it.
fn sections(command: &[String]) -> String {
    let help = help(command);
    let title = [&["cohelm".to_string()], command].concat().join(" ");
    let mut text = format!("\n## {title}\n\n```text\n{help}\n```\n");
    for name in below(&help) {
        text += &sections(&[command, &[name]].concat());
    }
    text
}

#[test]
fn the_reference_is_what_the_program_says() {
    let (page, path) = (format!("{HEAD}{}", sections(&[])), in_project("docs/cli.md"));
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, &page).unwrap();
    }
    let written = fs::read_to_string(&path).unwrap_or_default();
    let first =
        page.lines().zip(written.lines().chain(std::iter::repeat(""))).find(|(now, then)| now != then);
    assert!(
        page == written,
        "docs/cli.md is old. First difference, program and page:\n{first:?}\n\
         Write it anew: UPDATE_DOCS=1 cargo test -p cohelm-cli --test reference"
    );
}

#[test]
fn every_command_and_every_option_says_what_it_is_for() {
    fn walk(command: &[String]) {
        let help = help(command);
        let told = help.lines().next().unwrap_or_default();
        assert!(told.contains(' ') && !told.starts_with("Usage"), "cohelm {}: {told:?}", command.join(" "));
        below(&help).into_iter().for_each(|name| walk(&[command, &[name]].concat()));
    }
    walk(&[]);
}

#[test]
fn the_version_is_the_manifests() {
    let ran = run(folder().path(), ["--version"]);
    assert_eq!((ran.code, ran.stdout.trim_end()), (Some(0), concat!("cohelm ", env!("CARGO_PKG_VERSION"))));
}

#[test]
fn without_a_command_it_says_which_there_are() {
    let ran = run::<&str>(folder().path(), []);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("Commands:"), "{}", ran.stderr);
}
