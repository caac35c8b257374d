//! What the tests of a study share: a small study of the point, a server that runs it, and a browser's part of it.

pub mod line;

use super::run::StudyRun;
use crate::app::app;
use crate::hosts::Hosts;
use crate::page::Assets;
use crate::secret::SecretHash;
use crate::server::{Parts, Server};
use crate::store::Store;
use crate::testing::{Disk, plants};
use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::Request;
use axum::http::{HeaderMap, Method, StatusCode, header};
use cohelm_copilot::Models;
use cohelm_study::design::Design;
use serde_json::{Value, json};
use std::sync::Arc;
use tower::ServiceExt;

/// The secret of the researcher of all tests.
pub const SECRET: &str = "correct horse";
pub const HOST: &str = "localhost:1234";

/// Two conditions of one practice and one measured flight each.
pub const STUDY: &str = r#"
cohelm-study = 1
name = "small"
title = { en = "A small study", de = "Eine kleine Studie" }
languages = ["en", "de"]
contact = "somebody@example.org"
planned-participants = 4
order = "latin-square"
open-link = true
end-questionnaires = ["remarks"]

[task]
plant = "point"

[[conditions]]
name = "alone"
rule = "hic"
inference = "nearest"
practice-episodes = 1
measured-episodes = 1

[[conditions]]
name = "helped"
rule = "tolerance"
alpha = 0.6
inference = "nearest"
measured-episodes = 1
questionnaires = ["nasa-tlx"]

[terrain]
seed = 5

[consent]
version = "1"
text = "Please take part."

[[demographics]]
id = "age"
kind = "number"
least = 18
most = 99
required = true
text = "How old are you?"

[quiz]
attempts = 2

[[quiz.questions]]
id = "goal"
text = "Where to?"
choices = ["there", "elsewhere"]
right = "there"

[[questionnaires]]
name = "remarks"
title = "Remarks"

[[questionnaires.items]]
id = "remark"
kind = "text"
text = "Anything to add?"

[primary]
measure = "success"

[panel]
parameters = ["PROLIFIC_PID", "STUDY_ID"]
participant = "PROLIFIC_PID"
completed = "https://panel.example/done?cc={code}&who={PROLIFIC_PID}"
"#;

/// The same with one order for everybody.
pub fn in_fixed_order() -> String {
    STUDY.replace("latin-square", "fixed")
}

/// A server with that study, on a database of its own.
pub async fn running(disk: &Disk) -> Server {
    running_at(disk, "http://localhost:1234").await
}

/// The same, reached under another address.
pub async fn running_at(disk: &Disk, address: &str) -> Server {
    start(disk, STUDY, address).await
}

/// A server with another study.
pub async fn start(disk: &Disk, text: &str, address: &str) -> Server {
    let store: Arc<dyn Store> = disk.store.clone();
    let design = Design::from_toml(text).unwrap_or_else(|error| panic!("{error}"));
    let secret = SecretHash::of(SECRET).unwrap();
    let study = Some(StudyRun { design, secret, address: address.into() });
    let (hosts, assets, models) = (Hosts::loopback(), Assets::of(&[]), Models::new());
    Server::start(Parts { store, plants: plants(), models, lessons: None, hosts, assets, study })
        .await
        .unwrap()
}

/// What came back.
#[derive(Debug)]
pub struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("no JSON: {self:?}"))
    }

    pub fn error(&self) -> String {
        self.json()["error"].as_str().expect("an error in words").to_owned()
    }
}

/// A browser, as far as a server sees one: it keeps cookies, and says where it comes from.
#[derive(Clone)]
pub struct Browser {
    pub app: Router,
    pub cookies: Vec<(String, String)>,
    /// Sent with what changes something.
    pub origin: Option<String>,
    /// Whether the researcher's page asks.
    pub desk: bool,
    pub tab: String,
}

impl Browser {
    pub fn new(server: &Server) -> Self {
        let origin = Some(format!("http://{HOST}"));
        Self { app: app(server.clone()), cookies: Vec::new(), origin, desk: false, tab: "tab-1".into() }
    }

    /// A researcher who is logged in.
    pub async fn researcher(server: &Server) -> Self {
        let mut browser = Self { desk: true, ..Self::new(server) };
        let answer = browser.post("/api/desk/login", json!({ "secret": SECRET })).await;
        assert_eq!(answer.status, StatusCode::OK, "{answer:?}");
        browser
    }

    /// A participant by the open link, whose page has opened the session.
    pub async fn participant(server: &Server) -> Self {
        let mut browser = Self::new(server);
        let answer = browser.get("/join").await;
        assert_eq!(answer.status, StatusCode::SEE_OTHER, "{answer:?}");
        browser.open().await;
        browser
    }

    pub async fn open(&mut self) -> Value {
        let tab = self.tab.clone();
        let answer =
            self.post("/api/session/open", json!({ "tab": tab, "client": { "screen": "1×1" } })).await;
        assert_eq!(answer.status, StatusCode::OK, "{answer:?}");
        answer.json()
    }

    pub async fn answer(&mut self, step: &str, data: Value) -> Answer {
        let tab = self.tab.clone();
        let path = format!("/api/session/steps/{step}");
        self.post(&path, json!({ "tab": tab, "data": data, "page_ms": 12.5 })).await
    }

    pub async fn get(&mut self, path: &str) -> Answer {
        self.send(Method::GET, path, Body::empty()).await
    }

    pub async fn post(&mut self, path: &str, body: Value) -> Answer {
        self.send(Method::POST, path, Body::from(body.to_string())).await
    }

    /// The header with all cookies.
    pub fn cookie(&self) -> String {
        let pairs = self.cookies.iter().map(|(name, value)| format!("{name}={value}"));
        pairs.collect::<Vec<_>>().join("; ")
    }

    /// An answer that does not end.
    pub async fn begin(&mut self, path: &str) -> axum::response::Response {
        let request =
            Request::builder().uri(path).header(header::HOST, HOST).header(header::COOKIE, self.cookie());
        self.app.clone().oneshot(request.body(Body::empty()).unwrap()).await.unwrap()
    }

    pub async fn send(&mut self, method: Method, path: &str, body: Body) -> Answer {
        let mut request = Request::builder().method(method.clone()).uri(path).header(header::HOST, HOST);
        if !self.cookies.is_empty() {
            request = request.header(header::COOKIE, self.cookie());
        }
        if method == Method::POST {
            request = request.header(header::CONTENT_TYPE, "application/json");
            if let Some(origin) = &self.origin {
                request = request.header(header::ORIGIN, origin);
            }
        }
        if self.desk {
            request = request.header("x-cohelm-desk", "1");
        }
        let response = self.app.clone().oneshot(request.body(body).unwrap()).await.unwrap();
        let (parts, body) = response.into_parts();
        let body = to_bytes(body, usize::MAX).await.unwrap().to_vec();
        self.keep_cookies(&parts.headers);
        Answer { status: parts.status, headers: parts.headers, body }
    }

    fn keep_cookies(&mut self, headers: &HeaderMap) {
        for line in headers.get_all(header::SET_COOKIE) {
            let line = line.to_str().unwrap();
            let (name, value) = line.split(';').next().unwrap().split_once('=').unwrap();
            self.cookies.retain(|(kept, _)| kept != name);
            if !line.contains("Max-Age=0") {
                self.cookies.push((name.into(), value.into()));
            }
        }
    }
}

/// What a participant without opinions answers to the step that is shown; a flight has none before it is flown.
pub fn some_answer(step: &Value) -> Value {
    match step["kind"].as_str().unwrap() {
        "consent" => json!({ "agreed": true }),
        "form" => json!({ "age": 30 }),
        "quiz" => json!({ "goal": "there" }),
        "questionnaire" => {
            let of = |item: &Value| (item["id"].as_str().unwrap().to_owned(), some_value(item));
            step["items"].as_array().unwrap().iter().map(of).collect()
        }
        "flight" => json!({ "late_ticks": 1 }),
        _ => json!({}),
    }
}

fn some_value(item: &Value) -> Value {
    match item["kind"].as_str().unwrap() {
        "scale" => item["least"].clone(),
        "text" => "nothing".into(),
        _ => Value::Null,
    }
}
