//! What a researcher sees and does.

use crate::protocol::{FromPage, ToPage};
use crate::study::testing::line::{Line, begin, flight, listen, until_flight};
use crate::study::testing::{Browser, SECRET, running, running_at};
use crate::testing::{Disk, Page};
use axum::http::StatusCode;
use futures_util::StreamExt;
use serde_json::{Value, json};
use std::time::Duration;
use tokio::time::timeout;
use tokio_tungstenite::connect_async;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};

#[tokio::test]
async fn a_link_is_made_shown_once_and_replaced() {
    let disk = Disk::new().await;
    let server = running_at(&disk, "https://study.example.org/").await;
    let mut desk = Browser::researcher(&server).await;
    let made = desk.post("/api/desk/participants", json!({ "test": true, "language": "de" })).await;
    let link = made.json()["link"].as_str().unwrap().to_owned();
    let path = link.strip_prefix("https://study.example.org").expect("the public address").to_owned();
    let mut browser = Browser::new(&server);
    let entered = browser.get(&path).await;
    assert_eq!(entered.status, StatusCode::SEE_OTHER);
    assert!(entered.headers["set-cookie"].to_str().unwrap().contains("; Secure"));
    let session = browser.open().await;
    assert_eq!(
        (&session["participant"]["test"], &session["participant"]["language"]),
        (&true.into(), &"de".into())
    );
    let again = desk.post("/api/desk/participants/1/link", json!({})).await.json();
    assert_ne!(again["link"].as_str().unwrap(), link);
    assert_eq!(browser.get("/api/session").await.status, StatusCode::UNAUTHORIZED);
    assert_eq!(Browser::new(&server).get(&path).await.status, StatusCode::NOT_FOUND);
    let rows = desk.get("/api/desk/participants").await;
    assert!(!String::from_utf8_lossy(&rows.body).contains("/p/"), "no list shows a link");
}

#[tokio::test]
async fn people_are_left_out_taken_in_again_and_noted_with_a_reason() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let mut browser = Browser::participant(&server).await;
    let mut desk = Browser::researcher(&server).await;
    let mut decide =
        async |what: &str, said: Value| desk.post(&format!("/api/desk/participants/1/{what}"), said).await;
    assert_eq!(decide("exclude", json!({})).await.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert_eq!(decide("reinstate", json!({})).await.status, StatusCode::CONFLICT);
    assert_eq!(decide("note", json!({ "text": "asked about the keys" })).await.status, StatusCode::OK);
    assert_eq!(decide("exclude", json!({ "reason": "fell asleep" })).await.json()["status"], "excluded");
    let session = browser.get("/api/session").await.json();
    assert_eq!((&session["status"], &session["steps"]), (&"excluded".into(), &json!([])));
    assert_eq!(decide("reinstate", json!({})).await.json()["status"], "invited");
    assert_eq!(decide("promote", json!({})).await.status, StatusCode::NOT_FOUND);
    assert_eq!(
        decide("note", json!({ "text": "x".repeat(2_001) })).await.status,
        StatusCode::UNPROCESSABLE_ENTITY
    );
    assert_eq!(browser.answer("consent", json!({ "agreed": true })).await.status, StatusCode::OK);
    let row = desk.get("/api/desk/participants").await.json()["participants"][0].clone();
    assert_eq!((&row["notes"], &row["remarks"][0]["text"]), (&1.into(), &"asked about the keys".into()));
    let log = desk.get("/api/desk/participants/1/log").await.json();
    assert_eq!(log["events"][3]["reason"], "fell asleep");
    assert_eq!(desk.get("/api/desk/participants/77/log").await.status, StatusCode::NOT_FOUND);
}

#[tokio::test]
async fn a_flight_is_watched_from_its_first_tick_and_markers_tell_of_it() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let address = listen(&server).await;
    let desk = Browser::researcher(&server).await;
    let mut request = format!("ws://{address}/ws/markers").into_client_request().unwrap();
    request.headers_mut().insert("Authorization", format!("Bearer {SECRET}").parse().unwrap());
    let (mut markers, _) = connect_async(request).await.expect("a program shows the secret");
    let mut browser = Browser::participant(&server).await;
    let session = until_flight(&mut browser).await;
    let (key, setup) = flight(&session);
    let path = format!("/api/session/flight/{}", session["steps"][0]["flight_key"].as_str().unwrap());
    browser.post(&path, json!({ "tab": "tab-1", "begun": { "clock_offset_ms": -12.5 } })).await;
    let mut line = Line::connect(address, &browser).await.unwrap();
    line.hear().await;
    let mut page = Page::new(setup.clone());
    let ToPage::Begun { episode, .. } = line.ask(begin(key, &setup)).await else { panic!("not begun") };
    let first = page.fly(30);
    line.ask(FromPage::Chunk(first.clone())).await;
    let mut watcher = Line::connect_to(address, &desk, "/ws/desk/watch/1").await.unwrap();
    let FromPage::Begin(seen) = watcher.see().await else { panic!("no beginning") };
    assert_eq!((seen.setup, seen.key.0), (setup.clone(), [0; 16]), "the key is the participant's alone");
    assert_eq!(watcher.see().await, FromPage::Chunk(first));
    let row = desk.clone().get("/api/desk/participants").await.json()["participants"][0].clone();
    assert_eq!(
        (&row["connected"], &row["in_air"]),
        (&true.into(), &json!({ "episode": episode, "ticks": 30 }))
    );
    let second = page.fly(10_000);
    line.ask(FromPage::Chunk(second.clone())).await;
    assert_eq!(watcher.see().await, FromPage::Chunk(second));
    line.ask(FromPage::End(page.end())).await;
    assert_eq!(watcher.see().await, FromPage::End(page.end()));
    let mut told = Vec::new();
    while told.last().is_none_or(|marker: &Value| marker["event"] != "flight-ended") {
        let next = timeout(Duration::from_secs(20), markers.next()).await.expect("in time").unwrap().unwrap();
        let Message::Text(text) = next else { continue };
        told.push(serde_json::from_str(&text).unwrap());
    }
    let begun = told.iter().find(|marker| marker["event"] == "flight-begun").unwrap();
    assert_eq!((&begun["clock_offset_ms"], &begun["episode"]), (&json!(-12.5), &json!(episode)));
    assert!(begun["condition"].is_string() && begun["step"] == session["steps"][0]["id"], "{begun}");
    assert_eq!(told.last().unwrap()["tick"], page.end().ticks);
}

#[tokio::test]
async fn markers_and_flights_are_for_the_researcher_alone() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let address = listen(&server).await;
    let browser = Browser::participant(&server).await;
    for path in ["/ws/markers", "/ws/desk/watch/1"] {
        match Line::connect_to(address, &browser, path).await.map(drop) {
            Err(Error::Http(response)) => assert_eq!(response.status(), 401, "{path}"),
            other => panic!("{path}: {other:?}"),
        }
    }
    let mut request = format!("ws://{address}/ws/markers").into_client_request().unwrap();
    request.headers_mut().insert("Authorization", "Bearer wrong secret".parse().unwrap());
    assert!(connect_async(request).await.is_err());
    let mut request = format!("ws://{address}/ws/markers").into_client_request().unwrap();
    request.headers_mut().insert("Authorization", format!("Bearer {SECRET}").parse().unwrap());
    request.headers_mut().insert("Origin", "http://evil.example".parse().unwrap());
    assert!(connect_async(request).await.is_err(), "a page of another site");
}

#[tokio::test]
async fn news_come_as_they_happen() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let mut desk = Browser::researcher(&server).await;
    let answer = desk.begin("/api/desk/news").await;
    assert_eq!(answer.headers()["content-type"], "text/event-stream");
    let mut news = answer.into_body().into_data_stream();
    let mut heard = String::new();
    news.next().await;
    desk.post("/api/desk/participants", json!({})).await;
    while !heard.contains("\"participants\":[1]") {
        let piece = timeout(Duration::from_secs(20), news.next()).await.expect("in time").unwrap().unwrap();
        heard.push_str(&String::from_utf8_lossy(&piece));
    }
}
