//! A participant without a browser: joins over HTTP, flies over a WebSocket, sees nothing but what a page sees.
//!
//! For dry runs of a study and for measuring a server. Its flights are flown by simulated people; what a questionnaire
//! asks it leaves unanswered, since there is nobody to ask.

mod aloft;
mod desk;
mod http;
mod line;
pub mod load;
mod planned;
mod session;
#[cfg(test)]
mod testing;
mod visitor;

pub use aloft::{Aloft, NoKeys};
pub use desk::Desk;
pub use line::Line;
pub use planned::Planned;
pub use visitor::{Heard, Manner, Pace, TakeOff, Visited, Visitor, Witness};

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
    /// A request was answered with an error.
    #[error("{what}: the server answers {status}: {reason}")]
    Answer {
        /// What was asked for.
        what: String,
        /// The code of the answer.
        status: u16,
        /// The server's words.
        reason: String,
    },
    /// An answer that means nothing here.
    #[error("the server's answer is not understood: {0}")]
    Unclear(String),
    /// The link belongs to a person.
    #[error("participant {0} is not marked as simulated; no program may take the place of a person")]
    NotSimulated(String),
    /// No simulated person can fly this.
    #[error("no simulated person can fly this: {0}")]
    TakeOff(String),
}

impl VisitError {
    /// True if the server may only be away for a moment.
    fn is_absence(&self) -> bool {
        match self {
            Self::Connect { .. } | Self::Gone(_) | Self::Silence(_) => true,
            Self::Answer { status, .. } => *status == 503,
            _ => false,
        }
    }
}

/// The path of a link.
fn path_of(link: &str) -> Option<String> {
    let (_, rest) = link.split_once("://")?;
    rest.find('/').map(|at| rest[at..].to_owned())
}
