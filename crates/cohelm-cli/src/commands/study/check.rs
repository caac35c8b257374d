//! `cohelm study check` and `schema`: what a study's file says, and how one is written.

use super::shelf::Shelf;
use crate::output::{Format, say, words_table};
use anyhow::Result;
use clap::Args;
use cohelm_study::design::explain::{Explanation, Table, explain};
use cohelm_study::design::schema::schema;
use std::path::PathBuf;
use std::process::ExitCode;

/// Explains a study's file in words and tables. Fails if it cannot be run, and says line and column.
#[derive(Args)]
pub struct Check {
    /// The study's file.
    file: PathBuf,
    /// More models, files or folders, beside the shipped ones.
    #[arg(long = "model", value_name = "PATH")]
    models: Vec<PathBuf>,
    #[command(flatten)]
    format: Format,
}

/// Prints the JSON Schema of study files. Editors that know it complete keys and underline mistakes.
#[derive(Args)]
pub struct Schema {}

impl Check {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        let (design, facts) = Shelf::new(&self.models)?.design(&self.file)?;
        self.format.print(&explain(&design, Some(&facts)), text);
        Ok(ExitCode::SUCCESS)
    }
}

impl Schema {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        say(&serde_json::to_string_pretty(&schema())?);
        Ok(ExitCode::SUCCESS)
    }
}

fn text(explanation: &Explanation) -> String {
    let Explanation { heading, hash, sentences, conditions, orders, way, cautions, .. } = explanation;
    let mut parts = vec![format!("{heading}\nSHA-256 {hash}"), sentences.join("\n")];
    for (title, table) in [("Conditions", conditions), ("Orders", orders), ("One participant", way)] {
        parts.push(format!("{title}\n\n{}", aligned(table)));
    }
    if !cautions.is_empty() {
        let lines = cautions.iter().map(|caution| format!("- {caution}"));
        parts.push(format!("To think about\n\n{}", lines.collect::<Vec<_>>().join("\n")));
    }
    parts.join("\n\n")
}

fn aligned(table: &Table) -> String {
    let head: Vec<&str> = table.head.iter().map(String::as_str).collect();
    words_table(&head, &table.rows)
}
