//! A participant's page as far as sockets go: it flies, and a researcher who watches.

use super::{Browser, some_answer};
use crate::protocol::{Begin, FromPage, ToPage};
use crate::server::Server;
use crate::store::FlightKey;
use crate::testing::Page;
use crate::{bind, serve};
use axum::http::StatusCode;
use cohelm::trajectory::Setup;
use futures_util::{SinkExt, StreamExt};
use serde_json::Value;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

/// A listener of the server; its task ends with the runtime.
pub async fn listen(server: &Server) -> SocketAddr {
    let listener = bind("127.0.0.1:0".parse().unwrap()).await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(serve(listener, server.clone(), std::future::pending()));
    address
}

pub struct Line(pub WebSocketStream<MaybeTlsStream<TcpStream>>);

impl Line {
    pub async fn connect(address: SocketAddr, browser: &Browser) -> Result<Self, Error> {
        Self::connect_to(address, browser, &format!("/ws?tab={}", browser.tab)).await
    }

    pub async fn connect_to(address: SocketAddr, browser: &Browser, path: &str) -> Result<Self, Error> {
        let mut request = format!("ws://{address}{path}").into_client_request()?;
        request.headers_mut().insert("Origin", format!("http://{address}").parse().unwrap());
        request.headers_mut().insert("Cookie", browser.cookie().parse().unwrap());
        Ok(Self(connect_async(request).await?.0))
    }

    /// The next message that says something.
    pub async fn next(&mut self) -> Message {
        loop {
            let next = timeout(Duration::from_secs(20), self.0.next()).await;
            match next.expect("in time").expect("a message").unwrap() {
                Message::Ping(_) | Message::Pong(_) => {}
                message => return message,
            }
        }
    }

    pub async fn hear(&mut self) -> ToPage {
        match self.next().await {
            Message::Binary(bytes) => ToPage::from_bytes(&bytes).unwrap(),
            other => panic!("expected a message, got {other:?}"),
        }
    }

    pub async fn ask(&mut self, words: FromPage) -> ToPage {
        self.0.send(Message::Binary(words.to_bytes().into())).await.unwrap();
        self.hear().await
    }

    /// What a watcher sees.
    pub async fn see(&mut self) -> FromPage {
        match self.next().await {
            Message::Binary(bytes) => FromPage::from_bytes(&bytes).unwrap(),
            other => panic!("expected a message, got {other:?}"),
        }
    }

    pub async fn closed(&mut self) -> (u16, String) {
        loop {
            if let Message::Close(frame) = self.next().await {
                let frame = frame.expect("with a reason");
                return (frame.code.into(), frame.reason.to_string());
            }
        }
    }
}

/// The flight that a session shows first.
pub fn flight(session: &Value) -> (FlightKey, Setup) {
    let step = &session["steps"][0];
    let text = step["flight_key"].as_str().unwrap_or_else(|| panic!("no flight: {step}"));
    let byte = |pair: usize| u8::from_str_radix(&text[2 * pair..2 * pair + 2], 16).unwrap();
    (FlightKey(std::array::from_fn(byte)), serde_json::from_value(step["setup"].clone()).unwrap())
}

pub fn begin(key: FlightKey, setup: &Setup) -> FromPage {
    FromPage::Begin(Begin { key, age_ms: 0, setup: setup.clone() })
}

/// Flies the session's flight to its end; gives the episode.
pub async fn fly(line: &mut Line, session: &Value) -> i64 {
    let (key, setup) = flight(session);
    let mut page = Page::new(setup.clone());
    let answer = line.ask(begin(key, &setup)).await;
    let ToPage::Begun { episode, .. } = answer else { panic!("{answer:?}") };
    line.ask(FromPage::Chunk(page.fly(10_000))).await;
    assert_eq!(line.ask(FromPage::End(page.end())).await, ToPage::Finished { episode });
    episode.0
}

/// Answers step after step until a flight is due or nothing is.
pub async fn until_flight(browser: &mut Browser) -> Value {
    let mut session = browser.get("/api/session").await.json();
    while !["flight", "thanks"].contains(&session["steps"][0]["kind"].as_str().unwrap()) {
        let step = &session["steps"][0];
        let answer = browser.answer(step["id"].as_str().unwrap(), some_answer(step)).await;
        assert_eq!(answer.status, StatusCode::OK, "{answer:?}");
        session = answer.json();
    }
    session
}
