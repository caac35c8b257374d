//! One line out, one line in, before a deadline.

use crate::address::Address;
#[cfg(unix)]
use socket2::{Domain, SockAddr, Socket as Socket2, Type};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
#[cfg(unix)]
use std::os::{fd::OwnedFd, unix::net::UnixStream};
#[cfg(unix)]
use std::path::Path;
#[cfg(unix)]
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Shortest wait that a socket takes for one.
const LEAST_WAIT: Duration = Duration::from_millis(1);
/// How often a Unix socket is tried whose waiting line is full.
#[cfg(unix)]
const CALL_EVERY: Duration = Duration::from_millis(10);
/// Bytes taken from the socket at once.
const PIECE: usize = 16 * 1024;

/// Why no line came, or none could be sent.
#[derive(Debug, thiserror::Error)]
pub enum LineError {
    /// Nothing, or no whole line, came in time.
    #[error("nothing was heard from it for {} ms", .0.as_millis())]
    Silent(Duration),
    /// It closed the connection.
    #[error("it closed the connection")]
    Closed,
    /// Its line is too long.
    #[error("its line has more than {0} bytes")]
    TooLong(usize),
    /// Its line is no text.
    #[error("its line is not UTF-8")]
    NoText,
    /// Something followed the line that was not asked for.
    #[error("it spoke out of turn: one line answers one line")]
    OutOfTurn,
    /// The socket failed.
    #[error("the connection broke: {0}")]
    Broken(io::Error),
}

enum Socket {
    Tcp(TcpStream),
    #[cfg(unix)]
    Unix(UnixStream),
}

/// A connection on which lines are exchanged.
pub struct Line {
    socket: Socket,
    heard: Vec<u8>,
}

impl Line {
    /// Connects.
    ///
    /// # Errors
    /// What the system says: nobody listens there, nobody takes the call in time, or no Unix sockets exist here.
    pub fn connect(address: &Address, within: Duration) -> io::Result<Self> {
        let socket = match address {
            Address::Loopback(address) => {
                let stream = TcpStream::connect_timeout(address, within)?;
                // An action waits for nothing that could fill its packet.
                stream.set_nodelay(true)?;
                Socket::Tcp(stream)
            }
            #[cfg(unix)]
            Address::Unix(path) => Socket::Unix(connect_unix(path, within)?),
            #[cfg(not(unix))]
            Address::Unix(_) => {
                return Err(io::Error::new(ErrorKind::Unsupported, "there are no Unix sockets here"));
            }
        };
        Ok(Self { socket, heard: Vec::new() })
    }

    /// Sends a line, which holds no line break.
    pub fn say(&mut self, line: &str, within: Duration) -> Result<(), LineError> {
        let set = match &self.socket {
            Socket::Tcp(stream) => stream.set_write_timeout(Some(within)),
            #[cfg(unix)]
            Socket::Unix(stream) => stream.set_write_timeout(Some(within)),
        };
        set.map_err(LineError::Broken)?;
        let bytes = format!("{line}\n");
        let written = match &mut self.socket {
            Socket::Tcp(stream) => stream.write_all(bytes.as_bytes()),
            #[cfg(unix)]
            Socket::Unix(stream) => stream.write_all(bytes.as_bytes()),
        };
        written.map_err(|error| told(error, within))
    }

    /// The next line, of at most so many bytes, which must be the only one that is there.
    pub fn hear(&mut self, most: usize, within: Duration) -> Result<String, LineError> {
        let deadline = Instant::now() + within;
        let mut searched = 0;
        loop {
            if let Some(end) = self.heard[searched..].iter().position(|&byte| byte == b'\n') {
                return self.take(searched + end, most);
            }
            searched = self.heard.len();
            if searched > most {
                return Err(LineError::TooLong(most));
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(LineError::Silent(within));
            }
            self.listen(left.max(LEAST_WAIT), within)?;
        }
    }

    /// Says good-bye; what was said before still arrives.
    pub fn close(self) {
        let _ = match self.socket {
            Socket::Tcp(stream) => stream.shutdown(Shutdown::Write),
            #[cfg(unix)]
            Socket::Unix(stream) => stream.shutdown(Shutdown::Write),
        };
    }

    fn take(&mut self, end: usize, most: usize) -> Result<String, LineError> {
        if end > most {
            return Err(LineError::TooLong(most));
        }
        if self.heard.len() > end + 1 {
            return Err(LineError::OutOfTurn);
        }
        let mut line = std::mem::take(&mut self.heard);
        line.truncate(end);
        String::from_utf8(line).map_err(|_| LineError::NoText)
    }

    fn listen(&mut self, wait: Duration, within: Duration) -> Result<(), LineError> {
        let mut piece = [0; PIECE];
        let read = match &mut self.socket {
            Socket::Tcp(stream) => stream.set_read_timeout(Some(wait)).and_then(|()| stream.read(&mut piece)),
            #[cfg(unix)]
            Socket::Unix(stream) => {
                stream.set_read_timeout(Some(wait)).and_then(|()| stream.read(&mut piece))
            }
        };
        match read {
            Ok(0) => Err(LineError::Closed),
            Ok(count) => {
                self.heard.extend_from_slice(&piece[..count]);
                Ok(())
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => Ok(()),
            Err(error) => Err(told(error, within)),
        }
    }
}

/// Connects, trying until the deadline while too many wait to be taken in: the system's own call would wait for ever for
/// a plant that was stopped.
#[cfg(unix)]
fn connect_unix(path: &Path, within: Duration) -> io::Result<UnixStream> {
    let deadline = Instant::now() + within;
    let socket = Socket2::new(Domain::UNIX, Type::STREAM, None)?;
    let address = SockAddr::unix(path)?;
    socket.set_nonblocking(true)?;
    while let Err(error) = socket.connect(&address) {
        if error.kind() != ErrorKind::WouldBlock {
            return Err(error);
        }
        if Instant::now() >= deadline {
            let words = format!("it did not take the call within {} ms", within.as_millis());
            return Err(io::Error::new(ErrorKind::TimedOut, words));
        }
        sleep(CALL_EVERY);
    }
    socket.set_nonblocking(false)?;
    Ok(OwnedFd::from(socket).into())
}

fn told(error: io::Error, within: Duration) -> LineError {
    match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::TimedOut => LineError::Silent(within),
        ErrorKind::ConnectionReset | ErrorKind::BrokenPipe | ErrorKind::ConnectionAborted => {
            LineError::Closed
        }
        _ => LineError::Broken(error),
    }
}
