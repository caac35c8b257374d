//! A study's data for other programs, and all of it in one archive.
//!
//! Three tables, each as CSV and as Parquet: a row a flight, a row a participant and condition, a row an answer. A data
//! dictionary says what every column means. The archive holds these, and everything they follow from: design, events,
//! records and models, so that another copy of the program makes the same report from it, byte for byte.
//!
//! Equal data give equal bytes: no time of writing is stored, no name of a machine.

mod archive;
mod sheet;
mod tables;

pub use archive::{ArchiveError, Flights, flights, read_archive, write_archive};
pub use sheet::{Column, Kind, Sheet};
pub use tables::{answers, dictionary, participants, trials};

use crate::dataset::Dataset;
use std::io;
use std::path::Path;

/// Why data cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The Parquet library refused.
    #[error("the table {table} cannot be written as Parquet: {reason}")]
    Parquet {
        /// Which table.
        table: &'static str,
        /// What the library says.
        reason: String,
    },
    /// The archive cannot be put together.
    #[error("the archive cannot be put together: {0}")]
    Archive(String),
    /// A file cannot be written.
    #[error(
        "{path} cannot be written: {error}; is the folder there, may it be written to, is the disk full?"
    )]
    File {
        /// Which file.
        path: String,
        /// What the system says.
        error: io::Error,
    },
}

/// The tables with their names: `trials.csv`, `trials.parquet`, …, `dictionary.csv`.
///
/// # Errors
/// A table that cannot be written as Parquet.
pub fn tables(dataset: &Dataset) -> Result<Vec<(String, Vec<u8>)>, ExportError> {
    let sheets = [trials(dataset), participants(dataset), answers(dataset)];
    let mut files = Vec::new();
    for sheet in &sheets {
        files.push((format!("{}.csv", sheet.name), sheet.csv().to_string().into_bytes()));
        files.push((format!("{}.parquet", sheet.name), sheet.parquet()?));
    }
    files.push(("dictionary.csv".to_owned(), dictionary(&sheets).csv().to_string().into_bytes()));
    Ok(files)
}

/// Writes the tables into a folder, which is made if it is not there. Returns the names of the files.
///
/// # Errors
/// A table that cannot be written as Parquet; a file that cannot be written.
pub fn write_folder(folder: &Path, dataset: &Dataset) -> Result<Vec<String>, ExportError> {
    let at = |path: &Path, error| ExportError::File { path: path.display().to_string(), error };
    std::fs::create_dir_all(folder).map_err(|error| at(folder, error))?;
    let mut names = Vec::new();
    for (name, bytes) in tables(dataset)? {
        let path = folder.join(&name);
        std::fs::write(&path, bytes).map_err(|error| at(&path, error))?;
        names.push(name);
    }
    Ok(names)
}
