//! The server of flights that people fly in the page.
//!
//! | module | what it explains |
//! |---|---|
//! | [`store`] | where episodes and models are kept |
//! | [`hangar`] | what can be flown here: plants and models |
//! | [`follow`] | the page's key log flown again, which must give the same bits |
#![forbid(unsafe_code)]

pub mod follow;
pub mod hangar;
pub mod store;
#[cfg(test)]
mod testing;
