//! A study that is run: participants go through its steps, a researcher watches from a desk.
//!
//! | module | what it explains |
//! |---|---|
//! | `run` | what a study is run with |
//! | `designs` | versions of the study's file |
//! | `people` | participants at hand, each the fold of its log |
//! | `join` | how somebody becomes a participant |
//! | `page` | what the participant's page asks |
//! | `flights` | flights as steps of a session |
//! | `desk` | what the researcher's page asks |
//! | `rows` | participants as the researcher sees them |
//! | `doorkeeper` | the researcher's secret and sessions |
//! | `hub` | what happens, told to whoever watches |
//! | `watch` | flights watched live, and markers for other recordings |
//!
//! The log of events is the truth: whatever is in memory here can be lost at any moment.

mod designs;
pub(crate) mod desk;
mod doorkeeper;
pub(crate) mod flights;
mod hub;
pub(crate) mod join;
pub(crate) mod page;
mod people;
mod rows;
mod run;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
pub(crate) mod watch;

pub use designs::{EditionError, ResolveError, resolve};
pub use doorkeeper::LoginError;
pub use hub::Marker;
pub(crate) use run::Study;
pub use run::{StudyRun, StudyStartError};
