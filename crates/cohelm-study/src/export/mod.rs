//! A study's data for other programs.

mod sheet;

pub use sheet::{Column, Kind, Sheet};

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
}
