#![forbid(unsafe_code)]
//! What a study of shared control is, apart from running it: records, statistics, figures, reports.
//!
//! Knows no network, no async, no plant and no rule: it gets tables of numbers with names and says what they show.

pub mod analysis;
pub mod apa;
pub mod csv;
pub mod dataset;
pub mod design;
pub mod export;
pub mod figures;
pub mod measures;
pub mod power;
pub mod questionnaires;
pub mod report;
pub mod session;
pub mod statistics;
pub mod text;
pub mod verdict;
pub mod verify;
