//! Sweeps: many small experiments, each with a record in and a record out, on one machine or on many.
//!
//! A [`Description`] (TOML) is expanded into [`Job`]s. A job names its models by hash and the code by version, so the same
//! job gives the same bits wherever, whenever and beside whatever it runs. A [`Folder`] keeps what is finished under the
//! job's own hash: nothing runs twice, and a sweep that was killed goes on. How jobs reach other machines is not decided
//! here; [`run_job`] is all that a worker needs.

mod description;
mod folder;
mod job;
mod local;
mod report;
mod run;
mod sheets;
mod shelf;
mod tables;
#[cfg(test)]
mod tests;

pub use description::{Choose, Description, Planned, Seeds};
pub use folder::{Folder, Ran};
pub use job::{Code, Flights, Job, Training, Work};
pub use local::run_locally;
pub use report::{document, write_report};
pub use run::{Done, Lab, run_job};
pub use shelf::{Shelf, brought};
pub use tables::{Finished, by_episode, by_job, dictionary, nodes, where_it_ran};

use crate::experiment::ExperimentError;
use cohelm::registry::TaskError;
use cohelm_learn::LearnError;
use std::path::PathBuf;

/// Why a sweep cannot be planned, run or reported.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The description is no TOML of the right form.
    #[error("the description of the sweep cannot be read: {0}")]
    Toml(#[from] toml::de::Error),
    /// It can be read, but asks for something that cannot be.
    #[error("{place}: {reason}")]
    Description {
        /// Where in the description.
        place: String,
        /// What is wrong and what to try.
        reason: String,
    },
    /// There is no such plant.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// The flights of a job cannot be flown.
    #[error(transparent)]
    Flights(#[from] ExperimentError),
    /// The training of a job failed.
    #[error(transparent)]
    Training(#[from] LearnError),
    /// A job for another program.
    #[error(
        "the job was planned for {planned}, this worker is {here}: the bits could differ; build planner and workers from the same sources, or plan the sweep anew with this program"
    )]
    Code {
        /// What the job says.
        planned: String,
        /// What runs here.
        here: String,
    },
    /// A file could not be written or read.
    #[error("{}: {reason}", .path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A record is none of ours.
    #[error("no record of a job: {0}")]
    Record(#[from] serde_json::Error),
    /// Nothing has finished yet.
    #[error("no job of this sweep has finished; run it first: cohelm sweep run FILE --out DIR")]
    Nothing,
    /// A table cannot be written as Parquet.
    #[error(transparent)]
    Parquet(#[from] cohelm_study::export::ExportError),
    /// A figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] cohelm_study::figures::FigureError),
}
