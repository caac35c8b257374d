//! Where a plant listens: a port of this machine, or a Unix socket.

use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::str::FromStr;

/// Where a plant listens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// TCP, on this machine only: what goes over it is neither hidden nor signed.
    Loopback(SocketAddr),
    /// A Unix socket.
    Unix(PathBuf),
}

/// Why a text is no such address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    /// It is none at all.
    #[error("expected the plant's address as 127.0.0.1:PORT, [::1]:PORT or unix:PATH, got {0:?}")]
    Unreadable(String),
    /// It is another machine's.
    #[error(
        "{0} is not on this machine, and what goes over the socket is neither hidden nor signed: let the plant listen \
         here, or bring its port here with ssh -L"
    )]
    Elsewhere(SocketAddr),
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        if let Some(path) = text.strip_prefix("unix:").filter(|path| !path.is_empty()) {
            return Ok(Self::Unix(path.into()));
        }
        let named = text.strip_prefix("localhost:").map(|port| format!("127.0.0.1:{port}"));
        let address: SocketAddr =
            named.as_deref().unwrap_or(text).parse().map_err(|_| AddressError::Unreadable(text.into()))?;
        if address.ip().is_loopback() {
            Ok(Self::Loopback(address))
        } else {
            Err(AddressError::Elsewhere(address))
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Loopback(address) => write!(f, "{address}"),
            Self::Unix(path) => write!(f, "unix:{}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_of_this_machine_and_unix_sockets_are_addresses() {
        for (text, shown) in [
            ("127.0.0.1:5005", "127.0.0.1:5005"),
            ("localhost:5005", "127.0.0.1:5005"),
            ("[::1]:5005", "[::1]:5005"),
            ("unix:/run/plant.sock", "unix:/run/plant.sock"),
        ] {
            assert_eq!(text.parse::<Address>().unwrap().to_string(), shown);
        }
    }

    #[test]
    fn other_machines_and_other_texts_are_refused() {
        assert!(matches!("10.0.0.7:5005".parse::<Address>(), Err(AddressError::Elsewhere(_))));
        for text in ["", "5005", "127.0.0.1", "unix:", "http://127.0.0.1:5005"] {
            assert!(matches!(text.parse::<Address>(), Err(AddressError::Unreadable(_))), "{text}");
        }
    }
}
