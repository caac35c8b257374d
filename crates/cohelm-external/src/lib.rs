//! A plant that is elsewhere: a process in any language, over a socket. docs/external-plants.md has the protocol.
//!
//! | module | the noun it explains |
//! |---|---|
//! | [`address`] | where the plant listens |
//! | [`words`] | what is said over the socket |
//! | [`mod@line`] | one line out, one line in, before a deadline |
//! | [`external`] | the plant at the other end, as a [`Plant`](cohelm::plant::Plant) |
//! | [`other_end`] | the other end, for a simulator in Rust |
//!
//! Blocking, without any async: a tick waits for its answer, and for no longer than the time-out. Whatever goes wrong at
//! the other end is an ending of the episode and never an error inside the tick. It knows no page and no database.
#![forbid(unsafe_code)]

pub mod address;
pub mod external;
pub mod line;
pub mod other_end;
pub mod words;

pub use address::Address;
pub use external::{External, ExternalError, TimeOut};
