//! A WebSocket to the server, as a page has one.

use super::VisitError;
use crate::protocol::{FromPage, ToPage};
use futures_util::{SinkExt, StreamExt};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::http::HeaderValue;
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::tungstenite::{self, Message};
use tokio_tungstenite::{WebSocketStream, client_async_with_config};

/// How long an answer may take: a server that is started again needs some seconds, and more means that it hangs.
pub const ANSWER_WITHIN: Duration = Duration::from_secs(30);
/// Bytes of buffer a connection: messages are small, and there may be hundreds of connections.
const BUFFER: usize = 4 * 1024;

/// A connection on which the server has said its welcome.
pub struct Line {
    socket: WebSocketStream<TcpStream>,
}

impl Line {
    /// Connects as the page of that address would, with the participant's cookies if there are any.
    pub async fn connect(address: SocketAddr, cookies: Option<&str>) -> Result<Self, VisitError> {
        let refused = |reason: String| VisitError::Connect { address, reason };
        let stream = TcpStream::connect(address).await.map_err(|error| refused(error.to_string()))?;
        stream.set_nodelay(true).map_err(|error| refused(error.to_string()))?;
        let request = request(address, cookies).map_err(|error| refused(error.to_string()))?;
        let config = WebSocketConfig::default().read_buffer_size(BUFFER).write_buffer_size(0);
        let connecting = timeout(ANSWER_WITHIN, client_async_with_config(request, stream, Some(config)));
        let (socket, _) = connecting
            .await
            .map_err(|_| VisitError::Silence(ANSWER_WITHIN))?
            .map_err(|error| refused(refusal(error)))?;
        let mut line = Self { socket };
        match line.hear().await? {
            ToPage::Welcome(_) => Ok(line),
            said => Err(VisitError::OutOfTurn { expected: "a welcome".into(), said }),
        }
    }

    /// Says something; returns once it is handed to the system.
    pub async fn say(&mut self, words: &FromPage) -> Result<(), VisitError> {
        self.socket.send(Message::Binary(words.to_bytes().into())).await.map_err(gone)
    }

    /// The next thing that the server says, however long it takes. May be dropped and called again.
    pub async fn listen(&mut self) -> Result<ToPage, VisitError> {
        loop {
            match self.socket.next().await {
                Some(Ok(Message::Binary(bytes))) => return Ok(ToPage::from_bytes(&bytes)?),
                Some(Ok(Message::Close(Some(frame)))) => {
                    return Err(VisitError::Gone(format!("{} {}", u16::from(frame.code), frame.reason)));
                }
                Some(Ok(_)) => {}
                Some(Err(error)) => return Err(gone(error)),
                None => return Err(VisitError::Gone("the server hung up".into())),
            }
        }
    }

    /// The next thing that the server says about a flight; an error if it takes too long.
    pub async fn answer(&mut self) -> Result<ToPage, VisitError> {
        loop {
            match self.hear().await? {
                ToPage::NewModel { .. } => {}
                said => return Ok(said),
            }
        }
    }

    /// The next thing that the server says; an error if it takes too long.
    pub async fn hear(&mut self) -> Result<ToPage, VisitError> {
        timeout(ANSWER_WITHIN, self.listen()).await.map_err(|_| VisitError::Silence(ANSWER_WITHIN))?
    }
}

fn request(
    address: SocketAddr,
    cookies: Option<&str>,
) -> Result<tungstenite::handshake::client::Request, tungstenite::Error> {
    let mut request = format!("ws://{address}/ws").into_client_request()?;
    let headers = request.headers_mut();
    headers.insert("Origin", HeaderValue::try_from(format!("http://{address}"))?);
    if let Some(cookies) = cookies {
        headers.insert("Cookie", HeaderValue::try_from(cookies)?);
    }
    Ok(request)
}

fn gone(error: tungstenite::Error) -> VisitError {
    VisitError::Gone(error.to_string())
}

/// What the server says where it does not open a socket.
fn refusal(error: tungstenite::Error) -> String {
    match &error {
        tungstenite::Error::Http(answer) => {
            let words = answer.body().as_deref().map(String::from_utf8_lossy).unwrap_or_default();
            format!("{} {}", answer.status().as_u16(), words.trim())
        }
        _ => error.to_string(),
    }
}
