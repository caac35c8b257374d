//! A study through its real server: what participants and researchers do, and what goes wrong.

mod desk;
mod examples;
mod limits;
mod sessions;
mod threats;
mod walk;
