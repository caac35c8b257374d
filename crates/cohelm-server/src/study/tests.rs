//! A participant goes from the link to thanks over a real listener, with flights over a real socket.

use super::testing::{Browser, running, some_answer};
use crate::protocol::{Begin, FromPage, ToPage};
use crate::server::Server;
use crate::store::{FlightKey, Progress, Studies};
use crate::testing::{Disk, Page};
use crate::{bind, serve};
use axum::http::StatusCode;
use cohelm::trajectory::Setup;
use futures_util::{SinkExt, StreamExt};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

/// A listener of the server; its task ends with the runtime.
async fn listen(server: &Server) -> SocketAddr {
    let listener = bind("127.0.0.1:0".parse().unwrap()).await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(serve(listener, server.clone(), std::future::pending()));
    address
}

struct Line(WebSocketStream<MaybeTlsStream<TcpStream>>);

impl Line {
    async fn connect(address: SocketAddr, browser: &Browser) -> Result<Self, Error> {
        Self::connect_to(address, browser, &format!("/ws?tab={}", browser.tab)).await
    }

    async fn connect_to(address: SocketAddr, browser: &Browser, path: &str) -> Result<Self, Error> {
        let mut request = format!("ws://{address}{path}").into_client_request()?;
        request.headers_mut().insert("Origin", format!("http://{address}").parse().unwrap());
        request.headers_mut().insert("Cookie", browser.cookie().parse().unwrap());
        Ok(Self(connect_async(request).await?.0))
    }

    async fn next(&mut self) -> Message {
        timeout(Duration::from_secs(20), self.0.next()).await.expect("in time").expect("a message").unwrap()
    }

    async fn hear(&mut self) -> ToPage {
        match self.next().await {
            Message::Binary(bytes) => ToPage::from_bytes(&bytes).unwrap(),
            other => panic!("expected a message, got {other:?}"),
        }
    }

    async fn ask(&mut self, words: FromPage) -> ToPage {
        self.0.send(Message::Binary(words.to_bytes().into())).await.unwrap();
        self.hear().await
    }

    /// What a watcher sees.
    async fn see(&mut self) -> FromPage {
        match self.next().await {
            Message::Binary(bytes) => FromPage::from_bytes(&bytes).unwrap(),
            other => panic!("expected a message, got {other:?}"),
        }
    }

    async fn closed(&mut self) -> (u16, String) {
        loop {
            if let Message::Close(frame) = self.next().await {
                let frame = frame.expect("with a reason");
                return (frame.code.into(), frame.reason.to_string());
            }
        }
    }
}

/// The flight that a session shows first.
fn flight(session: &Value) -> (FlightKey, Setup) {
    let step = &session["steps"][0];
    let text = step["flight_key"].as_str().unwrap_or_else(|| panic!("no flight: {step}"));
    let byte = |pair: usize| u8::from_str_radix(&text[2 * pair..2 * pair + 2], 16).unwrap();
    (FlightKey(std::array::from_fn(byte)), serde_json::from_value(step["setup"].clone()).unwrap())
}

fn begin(key: FlightKey, setup: &Setup) -> FromPage {
    FromPage::Begin(Begin { key, age_ms: 0, setup: setup.clone() })
}

/// Flies the session's flight to its end; gives the episode.
async fn fly(line: &mut Line, session: &Value) -> i64 {
    let (key, setup) = flight(session);
    let mut page = Page::new(setup.clone());
    let answer = line.ask(begin(key, &setup)).await;
    let ToPage::Begun { episode, .. } = answer else { panic!("{answer:?}") };
    line.ask(FromPage::Chunk(page.fly(10_000))).await;
    assert_eq!(line.ask(FromPage::End(page.end())).await, ToPage::Finished { episode });
    episode.0
}

/// Answers step after step until a flight is due or nothing is.
async fn until_flight(browser: &mut Browser) -> Value {
    let mut session = browser.get("/api/session").await.json();
    while !["flight", "thanks"].contains(&session["steps"][0]["kind"].as_str().unwrap()) {
        let step = &session["steps"][0];
        let answer = browser.answer(step["id"].as_str().unwrap(), some_answer(step)).await;
        assert_eq!(answer.status, StatusCode::OK, "{answer:?}");
        session = answer.json();
    }
    session
}

#[tokio::test]
async fn a_participant_goes_from_the_link_through_consent_forms_and_flights_to_thanks() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let address = listen(&server).await;
    let mut browser = Browser::new(&server);
    let pid = "5f3a9c0d1e2b4a6788990011";
    let joined = browser.get(&format!("/join?PROLIFIC_PID={pid}&STUDY_ID=7&lang=de")).await;
    assert_eq!((joined.status, joined.headers["location"].to_str().unwrap()), (StatusCode::SEE_OTHER, "/study"));
    let session = browser.open().await;
    assert_eq!((session["status"].as_str(), session["steps"].as_array().unwrap().len()), (Some("invited"), 1));
    assert_eq!(session["study"]["title"], "Eine kleine Studie");
    let mut flown = Vec::new();
    let mut line = Line::connect(address, &browser).await.unwrap();
    assert!(matches!(line.hear().await, ToPage::Welcome(_)));
    loop {
        let session = until_flight(&mut browser).await;
        let step = session["steps"][0].clone();
        if step["kind"] == "thanks" {
            let code = step["code"].as_str().unwrap();
            let back = format!("https://panel.example/done?cc={code}&who={pid}");
            assert_eq!((session["status"].as_str(), step["return_address"].as_str()), (Some("completed"), Some(&*back)));
            break;
        }
        let id = step["id"].as_str().unwrap();
        let early = browser.answer(id, json!({})).await;
        assert_eq!(early.status, StatusCode::CONFLICT, "a flight is flown before it is noted");
        flown.push((id.to_owned(), fly(&mut line, &session).await));
        let landed = browser.get("/api/session").await.json();
        assert!(landed["steps"][0]["flown"].is_string(), "{landed}");
        let noted = browser.answer(id, json!({ "late_ticks": 2 })).await;
        assert_eq!(noted.status, StatusCode::OK, "{noted:?}");
    }
    assert_eq!(flown.len(), 3);
    let trials = disk.store.trials(crate::store::ParticipantId(1)).await.unwrap();
    let stored: Vec<_> =
        trials.iter().map(|row| (row.trial.as_ref().unwrap().step.clone(), row.id.0)).collect();
    assert_eq!(stored, flown);
    assert!(trials.iter().all(|row| matches!(row.progress, Progress::Finished { .. })));
    // Another server on the same database folds the same log.
    let again = Browser { cookies: browser.cookies.clone(), ..Browser::new(&running(&disk).await) }.get("/api/session").await;
    let (mut again, mut before) = (again.json(), browser.get("/api/session").await.json());
    (again["server_ms"], before["server_ms"]) = (0.into(), 0.into());
    assert_eq!(again, before);
}
