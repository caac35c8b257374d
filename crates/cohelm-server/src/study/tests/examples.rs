//! The examples of `docs/study-api.md`: `COHELM_BLESS=1 cargo test -p cohelm-server` writes them anew.

use crate::study::testing::line::{Line, fly, listen, until_flight};
use crate::study::testing::{Answer, Browser, in_fixed_order, some_answer, start};
use crate::testing::Disk;
use serde_json::{Value, json};
use std::fmt::Write;

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/study-api.md");
const OPENING: &str = "<!-- examples: written by a test of cohelm-server -->\n";
const CLOSING: &str = "<!-- end of examples -->\n";

#[tokio::test]
async fn the_examples_in_the_documentation_are_what_the_server_answers() {
    let document = std::fs::read_to_string(DOCUMENT).unwrap();
    let (before, rest) = document.split_once(OPENING).expect("the document has a place for the examples");
    let (_, after) = rest.split_once(CLOSING).expect("the examples end somewhere");
    let written = format!("{before}{OPENING}{}{CLOSING}{after}", examples().await);
    if std::env::var_os("COHELM_BLESS").is_some() {
        std::fs::write(DOCUMENT, &written).unwrap();
        return;
    }
    let line = document.lines().zip(written.lines()).find(|(old, new)| old != new);
    assert!(
        document == written,
        "docs/study-api.md is out of date ({line:?}): COHELM_BLESS=1 cargo test -p cohelm-server"
    );
}

async fn examples() -> String {
    let disk = Disk::new().await;
    let server = start(&disk, &in_fixed_order(), "http://localhost:1234").await;
    let address = listen(&server).await;
    let mut text = String::new();
    let mut desk = Browser { desk: true, ..Browser::new(&server) };
    let secret = json!({ "secret": "correct horse" });
    show(
        &mut text,
        "POST /api/desk/login",
        Some(&secret),
        &desk.post("/api/desk/login", secret.clone()).await,
    );
    let wish = json!({ "test": false, "language": "en", "note": "seat 3" });
    let made = desk.post("/api/desk/participants", wish.clone()).await;
    show(&mut text, "POST /api/desk/participants", Some(&wish), &made);
    let link = made.json()["link"].as_str().unwrap().to_owned();
    let mut page = Browser::new(&server);
    page.get(link.strip_prefix("http://localhost:1234").unwrap()).await;
    let opening = json!({ "tab": "tab-1", "client": { "browser": "Firefox", "refresh_hz": 60 } });
    let opened = page.post("/api/session/open", opening.clone()).await;
    show(&mut text, "POST /api/session/open", Some(&opening), &opened);
    for (step, data) in [("consent", json!({ "agreed": true })), ("demographics", json!({ "age": 7 }))] {
        if step == "demographics" {
            page.answer("device", json!({})).await;
        }
        let body = json!({ "tab": "tab-1", "data": data, "page_ms": 12.5 });
        let path = format!("/api/session/steps/{step}");
        show(&mut text, &format!("POST {path}"), Some(&body), &page.post(&path, body.clone()).await);
    }
    let mut session = until_flight(&mut page).await;
    let mut line = Line::connect(address, &page).await.unwrap();
    line.hear().await;
    while session["steps"][0]["kind"] == "flight" {
        fly(&mut line, &session).await;
        let step = session["steps"][0].clone();
        page.answer(step["id"].as_str().unwrap(), some_answer(&step)).await;
        session = until_flight(&mut page).await;
    }
    show(&mut text, "GET /api/session", None, &page.get("/api/session").await);
    for path in ["/api/desk/study", "/api/desk/participants", "/api/desk/participants/1/log"] {
        show(&mut text, &format!("GET {path}"), None, &desk.get(path).await);
    }
    let path = "/api/desk/episodes?participant=1&limit=1";
    show(&mut text, &format!("GET {path}"), None, &desk.get(path).await);
    text
}

fn show(text: &mut String, request: &str, body: Option<&Value>, answer: &Answer) {
    writeln!(text, "\n`{request}`\n\n```json").unwrap();
    if let Some(body) = body {
        writeln!(text, "{body}").unwrap();
    }
    let mut json = answer.json();
    settle(&mut json);
    writeln!(text, "→ {} {json:#}\n```", answer.status.as_u16()).unwrap();
}

/// What differs from one run to the next.
fn settle(json: &mut Value) {
    match json {
        Value::Object(fields) => {
            if let Some(Value::Array(items)) = fields.get_mut("items") {
                items.truncate(2);
            }
            for (name, value) in fields {
                match (name.as_str(), &*value) {
                    (_, Value::String(text)) if text.chars().count() > 80 => *value = "…".into(),
                    (_, Value::String(text)) if text.starts_with("http://localhost:1234/p/") => {
                        *value = "http://localhost:1234/p/0123456789abcdef0123456789abcdef".into();
                    }
                    ("code", Value::String(_)) => *value = "7K3QXM".into(),
                    ("flight_key", _) => *value = "0123456789abcdef0123456789abcdef".into(),
                    ("return_address", Value::String(_)) => {
                        *value = "https://panel.example/done?cc=7K3QXM".into()
                    }
                    ("hash" | "version" | "design", Value::String(text)) if text.len() == 64 => {
                        *value = "9f2c…".into()
                    }
                    ("cohelm" | "program", Value::String(_)) => *value = "0.1.0".into(),
                    ("seed", Value::Number(seed)) if seed.as_u64().is_some_and(|seed| seed > 1 << 20) => {
                        *value = 1234.into()
                    }
                    ("minutes" | "minutes_left", Value::Number(_)) => *value = 8.5.into(),
                    (name, Value::Number(_)) if name.ends_with("_ms") && name != "page_ms" => {
                        *value = 1_767_225_600_000_i64.into();
                    }
                    _ => settle(value),
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(settle),
        _ => {}
    }
}
