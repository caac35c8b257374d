//! A participant without a browser: joins over HTTP, flies over a WebSocket, sees nothing but what a page sees.
//!
//! For dry runs of a study and for measuring a server. Its flights are flown by simulated people; what a questionnaire
//! asks it leaves unanswered, since there is nobody to ask.

pub mod aloft;
pub mod line;
pub mod load;
#[cfg(test)]
mod testing;

pub use aloft::{Aloft, NoKeys};
pub use line::Line;

use crate::protocol::{ProtocolError, ToPage};
use std::net::SocketAddr;
use std::time::Duration;

/// Why a visit went wrong.
#[derive(Debug, thiserror::Error)]
pub enum VisitError {
    /// Nobody answers there.
    #[error("cannot connect to {address}: {reason}")]
    Connect {
        /// Where.
        address: SocketAddr,
        /// What the system or the server says.
        reason: String,
    },
    /// The connection ended.
    #[error("the connection ended: {0}")]
    Gone(String),
    /// The server said nothing for too long.
    #[error("the server did not answer within {0:?}")]
    Silence(Duration),
    /// A flight was not believed.
    #[error("the server refused a flight: {0}")]
    Refused(String),
    /// Bytes that are no message.
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    /// Another answer than the one that was due.
    #[error("expected {expected}, the server said {said:?}")]
    OutOfTurn {
        /// What was due.
        expected: String,
        /// What came.
        said: ToPage,
    },
    /// The pilot cannot fly as a participant.
    #[error(transparent)]
    NoKeys(#[from] NoKeys),
}
