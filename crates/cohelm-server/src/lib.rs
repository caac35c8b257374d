//! The server of flights that people fly in the page: the only async crate.
//!
//! Physics and co-pilot run in the page, so that a key acts at the next tick whatever the network does. The server
//! follows: it flies each piece of the key log again, refuses what differs, stores what fits, and acknowledges it.
//!
//! | module | what it explains |
//! |---|---|
//! | [`mod@app`] | the routes |
//! | [`mod@serve`] | a listener and its end |
//! | [`server`] | what all connections share |
//! | `session` | one connection with a page |
//! | [`protocol`] | what page and server say to each other, as bytes |
//! | [`follow`] | the page's key log flown again, which must give the same bits |
//! | [`hangar`] | what can be flown here: plants and models |
//! | `lease` | one connection a flight |
//! | [`external`] | a plant elsewhere, whose loop runs here |
//! | [`store`] | where episodes and models are kept |
//! | [`mod@recover`] | flights that were interrupted |
//! | [`verify`] | every stored episode flown again |
//! | [`learn`] | values that learn while people fly |
//! | [`page`] | the built page, inside the program |
//! | [`hosts`] | who may talk to the server |
//! | [`study`] | a study that is run: participants, their sessions, the researcher's desk |
//! | [`secret`] | tokens, and the researcher's secret |
//! | `cookies` | the participant's and the researcher's cookie |
//! | [`limits`] | how often somebody may ask |
//! | [`tls`] | TLS of the server's own |
//! | `visit` | a participant without a browser, for dry runs and for measuring (feature `visit`) |
//!
//! Where a plant is elsewhere, the loop runs here instead, and the page steers and shows.
//!
//! It knows no plant and trains nothing; no request reaches the file system, and none makes it panic.
#![forbid(unsafe_code)]

pub mod app;
mod cookies;
pub mod external;
pub mod follow;
pub mod hangar;
pub mod hosts;
pub mod learn;
mod lease;
pub mod limits;
pub mod page;
pub mod protocol;
pub mod recover;
pub mod secret;
pub mod serve;
pub mod server;
mod session;
pub mod store;
pub mod study;
#[cfg(test)]
mod testing;
pub mod tls;
pub mod verify;
#[cfg(feature = "visit")]
pub mod visit;

pub use app::app;
pub use serve::{bind, serve, serve_tls};
pub use server::{Parts, Server, StartError};
pub use study::StudyRun;
pub use verify::verify_episodes;
