//! What commands print: tables for people, or one JSON object with `--json`.

use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;

/// Whether a command prints for people or for programs.
#[derive(Args, Clone, Copy, Debug)]
pub struct Format {
    /// Print one JSON object instead of text.
    #[arg(long)]
    pub json: bool,
}

impl Format {
    /// Prints a result as JSON, or the text that `text` makes of it.
    pub fn print<Data: Serialize>(self, data: &Data, text: impl FnOnce(&Data) -> String) {
        if self.json {
            say(&serde_json::to_string_pretty(data).expect("results have a JSON form"));
        } else {
            say(text(data).trim_end());
        }
    }

    /// Whether progress bars are wanted: a person looks on.
    pub fn shows_progress(self) -> bool {
        !self.json && std::io::stderr().is_terminal()
    }
}

/// Prints lines on standard output. A reader that has gone away, as `head` does, has what it wanted; any other failure
/// ends the program.
pub fn say(lines: &str) {
    let mut output = std::io::stdout().lock();
    match writeln!(output, "{lines}").and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            eprintln!("cohelm: cannot print: {error}");
            std::process::exit(1)
        }
        _ => {}
    }
}

/// Makes a folder and works in it. If that fails, whatever folders were made for it go again, as far as they are empty.
pub fn in_folder<Done>(folder: &Path, work: impl FnOnce() -> Result<Done>) -> Result<Done> {
    let is_new = |path: &&Path| !path.as_os_str().is_empty() && !path.exists();
    let made: Vec<&Path> = folder.ancestors().take_while(is_new).collect();
    let begun = std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()));
    let done = begun.and_then(|()| work());
    if done.is_err() {
        // A folder that holds something stays, and so do those above it.
        let _ = made.into_iter().try_for_each(std::fs::remove_dir);
    }
    done
}

/// Rows of cells as aligned columns; the first column to the left, the others, which hold numbers, to the right.
pub fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    columns(head, rows, 1)
}

/// The same for words: all columns to the left.
pub fn words_table(head: &[&str], rows: &[Vec<String>]) -> String {
    columns(head, rows, head.len())
}

/// Rows of cells as aligned columns, the first `left` of them to the left.
fn columns(head: &[&str], rows: &[Vec<String>], left: usize) -> String {
    let columns = head.len();
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        cells.chain([head[column].chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |cells: Vec<&str>| {
        let aligned = cells.iter().enumerate().map(|(column, cell)| {
            let padding = " ".repeat(widths[column] - cell.chars().count());
            if column < left { format!("{cell}{padding}") } else { format!("{padding}{cell}") }
        });
        aligned.collect::<Vec<_>>().join("  ").trim_end().to_string()
    };
    let rule = widths.iter().map(|&width| "─".repeat(width)).collect::<Vec<_>>().join("──");
    let body = rows.iter().map(|row| line(row.iter().map(String::as_str).collect()));
    [line(head.to_vec()), rule].into_iter().chain(body).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::{in_folder, table, words_table};
    use anyhow::bail;

    #[test]
    fn what_fails_leaves_no_empty_folder() {
        let here = tempfile::tempdir().unwrap();
        let out = here.path().join("a/b");
        let failed = |write: bool| {
            let work = || {
                if write {
                    std::fs::write(out.join("checkpoint"), "half")?;
                }
                bail!("no")
            };
            in_folder::<()>(&out, work).unwrap_err();
        };
        failed(false);
        assert!(!here.path().join("a").exists());
        failed(true);
        assert!(out.join("checkpoint").exists(), "what was written stays");
        assert_eq!(in_folder(&out, || Ok(1)).unwrap(), 1);
    }

    #[test]
    fn words_stand_to_the_left() {
        let rows =
            [vec!["a".to_string(), "one".into(), "x".into()], vec!["b".into(), "seven".into(), "y".into()]];
        assert_eq!(
            words_table(&["", "number", "z"], &rows),
            "   number  z\n────────────\na  one     x\nb  seven   y"
        );
    }

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows = [vec!["α".to_string(), "1.25".into()], vec!["long name".into(), "3".into()]];
        assert_eq!(
            table(&["rule", "n"], &rows),
            "rule          n\n───────────────\nα          1.25\nlong name     3"
        );
    }
}
