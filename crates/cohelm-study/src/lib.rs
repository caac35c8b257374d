#![forbid(unsafe_code)]
//! What a study of shared control is, apart from running it: designs, sessions, records, statistics, figures, reports.
//!
//! Knows no network, no async and no plant. What needs a plant or a model is asked of whoever has them
//! ([`design::Catalogue`]); what was flown comes as tables of numbers with names.

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
