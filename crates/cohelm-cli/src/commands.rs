//! The commands, one a module.

pub mod bench;
pub mod compare;
pub mod episodes;
pub mod evaluate;
pub mod fly;
pub mod intents;
mod kills;
pub mod reproduce;
pub mod study;
pub mod sweep;
pub mod train;
pub mod verify;
