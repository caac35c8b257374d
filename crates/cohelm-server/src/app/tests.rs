//! Every route, asked rightly and wrongly.

use super::*;
use crate::hangar::is_hash;
use crate::hosts::Hosts;
use crate::page::Assets;
use crate::server::Parts;
use crate::store::{Origin, Store, Write, now_ms};
use crate::testing::{Disk, buttons::model, flown, key, plants, record, setup};
use axum::body::{Body, to_bytes};
use cohelm::trajectory::Trajectory;
use cohelm_copilot::Models;
use serde_json::Value;
use std::sync::Arc;
use tower::ServiceExt;

const FILES: &[(&str, &[u8])] = &[
    ("/index.html", b"<!doctype html>the page"),
    ("/app.js", b"export {}"),
    ("/cohelm.wasm", b"\0asm"),
    ("/style.css", b"body {}"),
    ("/notices/third-party.txt", b"thanks"),
];

struct Answer {
    status: StatusCode,
    headers: HeaderMap,
    body: Vec<u8>,
}

impl Answer {
    fn header(&self, name: impl header::AsHeaderName) -> &str {
        self.headers.get(name).map_or("", |value| value.to_str().unwrap())
    }

    fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("no JSON: {}", self.text()))
    }
}

async fn send(app: &Router, request: Request) -> Answer {
    let response = app.clone().oneshot(request).await.unwrap();
    let (parts, body) = response.into_parts();
    let body = to_bytes(body, usize::MAX).await.unwrap().to_vec();
    Answer { status: parts.status, headers: parts.headers, body }
}

fn request(method: Method, path: &str) -> axum::http::request::Builder {
    Request::builder().method(method).uri(path).header(header::HOST, "localhost:1234")
}

async fn get(app: &Router, path: &str) -> Answer {
    send(app, request(Method::GET, path).body(Body::empty()).unwrap()).await
}

async fn from_own_page(app: &Router, method: Method, path: &str, body: Body) -> Answer {
    let request = request(method, path).header(header::ORIGIN, "http://localhost:1234");
    send(app, request.body(body).unwrap()).await
}

/// A server with a page and three episodes: two finished, the newest in the air.
async fn with_episodes() -> (Disk, Router) {
    let disk = Disk::new().await;
    let writes = [
        Write::Episode { record: record(1), at_ms: 10 },
        Write::Episode { record: record(2), at_ms: 20 },
        Write::Begin { key: key(3), setup: setup(3), at_ms: now_ms() },
    ];
    disk.store.commit(&writes).await.unwrap();
    let server = disk.server_with(None, Assets::of(FILES)).await;
    (disk, app(server))
}

#[tokio::test]
async fn the_page_comes_with_its_types_and_a_tag() {
    let (_disk, app) = with_episodes().await;
    for (path, content_type) in [
        ("/", "text/html; charset=utf-8"),
        ("/index.html", "text/html; charset=utf-8"),
        ("/app.js", "text/javascript; charset=utf-8"),
        ("/cohelm.wasm", "application/wasm"),
        ("/style.css", "text/css; charset=utf-8"),
        ("/favicon.ico", "image/svg+xml"),
    ] {
        let answer = get(&app, path).await;
        assert_eq!(
            (answer.status, answer.header(header::CONTENT_TYPE)),
            (StatusCode::OK, content_type),
            "{path}"
        );
        assert_eq!(answer.header(header::CACHE_CONTROL), "no-cache");
        let tag = answer.header(header::ETAG);
        let again = request(Method::GET, path).header(header::IF_NONE_MATCH, format!("\"x\", W/{tag}"));
        let again = send(&app, again.body(Body::empty()).unwrap()).await;
        assert_eq!((again.status, again.body.len()), (StatusCode::NOT_MODIFIED, 0), "{path}");
        assert_eq!(again.header(header::ETAG), tag);
    }
    assert_eq!(get(&app, "/").await.text(), "<!doctype html>the page");
}

#[tokio::test]
async fn without_a_page_the_command_that_builds_it_is_said() {
    let disk = Disk::new().await;
    let app = app(disk.server().await);
    let answer = get(&app, "/").await;
    assert_eq!(answer.status, StatusCode::SERVICE_UNAVAILABLE);
    assert!(answer.text().contains("npm ci"), "{}", answer.text());
    assert_eq!(get(&app, "/app.js").await.status, StatusCode::NOT_FOUND);
    assert_eq!(get(&app, "/healthz").await.status, StatusCode::OK);
}

#[tokio::test]
async fn the_embedded_page_is_whole_or_absent() {
    let assets = Assets::embedded();
    let (disk, headers) = (Disk::new().await, HeaderMap::new());
    let index = assets.answer("/", &headers).unwrap().status();
    assert_eq!(index == StatusCode::OK, assets.has_page());
    drop(disk);
}

#[tokio::test]
async fn every_answer_says_what_a_page_may_do() {
    let (_disk, app) = with_episodes().await;
    for path in ["/", "/api/episodes", "/api/nothing", "/ws", "/favicon.ico", "/api/models/xyz"] {
        let answer = get(&app, path).await;
        let policy = answer.header(header::CONTENT_SECURITY_POLICY);
        assert!(policy.contains("default-src 'none'") && policy.contains("'wasm-unsafe-eval'"), "{path}");
        assert!(!policy.contains("'unsafe-inline'") && !policy.contains("'unsafe-eval'"), "{path}");
        assert_eq!(answer.header(header::X_CONTENT_TYPE_OPTIONS), "nosniff", "{path}");
        assert!(!answer.header(header::CACHE_CONTROL).is_empty(), "{path}");
    }
}

#[tokio::test]
async fn no_path_leads_anywhere_else() {
    let (_disk, app) = with_episodes().await;
    for path in [
        "/../Cargo.toml",
        "/..%2f..%2fetc%2fpasswd",
        "/app.js/../../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "//etc/passwd",
        "/index.html/",
        "/api",
        "/api/",
        "/api/models/../episodes",
        "/api/models/..%2f..%2fCargo.toml",
        "/api/models/%00",
        "/api/episodes/..%2f1",
        "/api/episodes/1/2",
        "/api/episodes/-1",
        "/api/episodes/99999999999999999999",
        "/api/episodes/one",
        "/api/episodes/99",
        "/notices/",
    ] {
        let answer = get(&app, path).await;
        assert_eq!(answer.status, StatusCode::NOT_FOUND, "{path}: {}", answer.text());
        assert!(!answer.text().contains("[package]") && !answer.text().contains("root:"), "{path}");
    }
}

#[tokio::test]
async fn wrong_methods_are_refused_everywhere() {
    let (_disk, app) = with_episodes().await;
    let routes = [
        "/",
        "/app.js",
        "/healthz",
        "/api/plants",
        "/api/models",
        "/api/episodes",
        "/api/episodes/1",
        "/api/learn",
    ];
    for path in routes {
        for method in [Method::POST, Method::PUT, Method::DELETE, Method::PATCH] {
            let answer = from_own_page(&app, method.clone(), path, Body::empty()).await;
            assert_eq!(answer.status, StatusCode::METHOD_NOT_ALLOWED, "{method} {path}");
            assert!(answer.header(header::ALLOW).contains("GET"), "{method} {path}");
        }
    }
    for path in ["/api/learn/keep", "/api/learn/reset"] {
        assert_eq!(get(&app, path).await.status, StatusCode::METHOD_NOT_ALLOWED, "{path}");
    }
    let head = send(&app, request(Method::HEAD, "/app.js").body(Body::empty()).unwrap()).await;
    assert_eq!((head.status, head.body.len()), (StatusCode::OK, 0));
}

#[tokio::test]
async fn only_our_own_page_may_change_anything_or_open_a_socket() {
    let (_disk, app) = with_episodes().await;
    for origin in [None, Some("http://evil.example"), Some("null"), Some("http://localhost:4321")] {
        for (method, path) in
            [(Method::POST, "/api/learn/reset"), (Method::POST, "/api/learn/keep"), (Method::GET, "/ws")]
        {
            let mut request = request(method, path);
            if let Some(origin) = origin {
                request = request.header(header::ORIGIN, origin);
            }
            let answer = send(&app, request.body(Body::empty()).unwrap()).await;
            assert_eq!(answer.status, StatusCode::FORBIDDEN, "{path} from {origin:?}");
        }
    }
    let own = from_own_page(&app, Method::POST, "/api/learn/reset", Body::empty()).await;
    assert_eq!(own.status, StatusCode::CONFLICT, "allowed, but nothing learns here");
    let no_upgrade = from_own_page(&app, Method::GET, "/ws", Body::empty()).await;
    assert!(no_upgrade.status.is_client_error() && no_upgrade.status != StatusCode::FORBIDDEN);
}

#[tokio::test]
async fn a_name_that_points_here_from_elsewhere_is_not_answered() {
    let (_disk, app) = with_episodes().await;
    let request = Request::builder().uri("/api/episodes").header(header::HOST, "evil.example:1234");
    let answer = send(&app, request.body(Body::empty()).unwrap()).await;
    assert_eq!(answer.status, StatusCode::MISDIRECTED_REQUEST);
    let request = Request::builder().uri("/api/episodes");
    assert_eq!(
        send(&app, request.body(Body::empty()).unwrap()).await.status,
        StatusCode::MISDIRECTED_REQUEST
    );
}

#[tokio::test]
async fn oversize_bodies_are_refused() {
    let (_disk, app) = with_episodes().await;
    for path in ["/api/learn/reset", "/api/episodes", "/"] {
        let large = request(Method::POST, path)
            .header(header::ORIGIN, "http://localhost:1234")
            .header(header::CONTENT_LENGTH, MAX_BODY + 1);
        let answer = send(&app, large.body(Body::from(vec![b' '; MAX_BODY + 1])).unwrap()).await;
        assert_eq!(answer.status, StatusCode::PAYLOAD_TOO_LARGE, "{path}");
    }
}

#[tokio::test]
async fn episodes_are_listed_newest_first_in_parts() {
    let (_disk, app) = with_episodes().await;
    let all = get(&app, "/api/episodes").await.json();
    let ids: Vec<i64> =
        all["episodes"].as_array().unwrap().iter().map(|e| e["id"].as_i64().unwrap()).collect();
    assert_eq!((ids, &all["next"]), (vec![3, 2, 1], &Value::Null));
    let newest = &all["episodes"][0];
    assert_eq!((newest["state"].as_str(), newest["seed"].as_u64()), (Some("in-the-air"), Some(3)));
    assert_eq!(all["episodes"][1]["state"], "finished");
    assert_eq!(all["episodes"][1]["ending"], flown(2).ending.word());
    assert_eq!(all["episodes"][1]["setup"]["task"]["plant"], "point");
    let first = get(&app, "/api/episodes?limit=2").await.json();
    assert_eq!((first["episodes"].as_array().unwrap().len(), first["next"].as_i64()), (2, Some(2)));
    let second = get(&app, "/api/episodes?limit=2&before=2").await.json();
    assert_eq!((&second["episodes"][0]["id"], &second["next"]), (&1.into(), &Value::Null));
    for wrong in ["?limit=-1", "?limit=many", "?before=x", "?colour=red", "?limit=1&limit=2"] {
        let answer = get(&app, &format!("/api/episodes{wrong}")).await;
        assert_eq!(answer.status, StatusCode::BAD_REQUEST, "{wrong}");
    }
}

#[tokio::test]
async fn a_record_is_given_as_its_bytes() {
    let (_disk, app) = with_episodes().await;
    let answer = get(&app, "/api/episodes/2").await;
    assert_eq!(answer.status, StatusCode::OK);
    assert_eq!(Trajectory::from_bytes(&answer.body).unwrap(), flown(2));
    assert!(answer.header(header::CONTENT_DISPOSITION).contains("episode-2.cohelm"));
    let in_the_air = get(&app, "/api/episodes/3").await;
    assert_eq!(in_the_air.status, StatusCode::CONFLICT);
    assert!(in_the_air.json()["error"].as_str().unwrap().contains("in the air"));
}

#[tokio::test]
async fn plants_are_described_with_what_a_person_can_press() {
    let (_disk, app) = with_episodes().await;
    let plants = get(&app, "/api/plants").await.json();
    let point = &plants["plants"][0];
    assert_eq!((&point["name"], &point["version"]), (&"point".into(), &1.into()));
    assert_eq!(point["controls"].as_array().unwrap().len(), 4);
    assert_eq!((&point["ticks_per_second"], &point["hand_made_values"]), (&50.0.into(), &true.into()));
}

#[tokio::test]
async fn without_models_there_are_none_and_without_a_learner_nothing_learns() {
    let (_disk, app) = with_episodes().await;
    assert_eq!(get(&app, "/api/models").await.json()["models"], Value::Array(vec![]));
    let hash = "ab".repeat(32);
    assert!(is_hash(&hash));
    assert_eq!(get(&app, &format!("/api/models/{hash}")).await.status, StatusCode::NOT_FOUND);
    assert_eq!(get(&app, "/api/learn").await.json()["learning"], false);
}

#[tokio::test]
async fn models_are_listed_with_their_cards_and_given_as_their_bytes() {
    let disk = Disk::new().await;
    let (older, usual, learned) = (model(0), model(1), model(2));
    let mut models = Models::new();
    models.add_model(older.clone());
    models.add_model(usual.clone());
    let keep = Write::Model { model: learned.clone(), origin: Origin::Learned, at_ms: 0 };
    disk.store.commit(&[keep]).await.unwrap();
    let store: Arc<dyn Store> = disk.store.clone();
    let (hosts, assets) = (Hosts::loopback(), Assets::of(FILES));
    let parts = Parts { store, plants: plants(), models, lessons: None, hosts, assets, study: None };
    let app = app(Server::start(parts).await.unwrap());
    let list = get(&app, "/api/models").await.json();
    let rows = list["models"].as_array().unwrap();
    assert_eq!(rows.len(), 3);
    for (model, offered, is_usual) in [(&older, true, false), (&usual, true, true), (&learned, false, false)]
    {
        let row = rows.iter().find(|row| row["hash"] == model.hash()).unwrap();
        assert_eq!((&row["offered"], &row["usual"]), (&offered.into(), &is_usual.into()), "{row}");
        // No test's model is one of those that come with the program.
        let origin = if offered { "given" } else { "learned" };
        assert_eq!(row["origin"], origin);
        assert_eq!((&row["kind"], &row["card"]["seed"]), (&"values".into(), &model.card().seed.into()));
        let answer = get(&app, &format!("/api/models/{}", model.hash())).await;
        assert_eq!((answer.status, answer.body.as_slice()), (StatusCode::OK, model.bytes()));
        assert!(answer.header(header::CACHE_CONTROL).contains("immutable"));
    }
    let upper = get(&app, &format!("/api/models/{}", usual.hash().to_uppercase())).await;
    assert_eq!(upper.status, StatusCode::NOT_FOUND);
}

#[tokio::test]
async fn health_tells_of_a_database_that_is_gone() {
    let (disk, app) = with_episodes().await;
    assert_eq!(get(&app, "/healthz").await.json()["status"], "ok");
    disk.store.close().await;
    let answer = get(&app, "/healthz").await;
    assert_eq!(answer.status, StatusCode::SERVICE_UNAVAILABLE);
    assert_eq!(get(&app, "/api/episodes").await.status, StatusCode::INTERNAL_SERVER_ERROR);
}

/// A path of each route, with something in the place of its names.
fn example_of(route: &Route) -> String {
    let path = route.path.replace("{hash}", &"ab".repeat(32)).replace("{token}", &"0".repeat(32));
    let path = path.replace("{key}", &"0".repeat(32)).replace("{*step}", "consent").replace("{what}", "note");
    path.replace("{participant}", "1").replace("{id}", "1")
}

/// Asks for a route as a browser would, sockets with the headers of an upgrade.
async fn ask(app: &Router, route: &Route, cookie: &str, from_own_page: bool) -> StatusCode {
    let method = if route.method == "POST" { Method::POST } else { Method::GET };
    let mut asked = request(method, &example_of(route)).header(header::COOKIE, cookie);
    if from_own_page {
        asked = asked.header(header::ORIGIN, "http://localhost:1234").header("x-cohelm-desk", "1");
    }
    if route.method == "WS" {
        for (name, value) in [
            ("connection", "upgrade"),
            ("upgrade", "websocket"),
            ("sec-websocket-version", "13"),
            ("sec-websocket-key", "dGhlIHNhbXBsZSBub25jZQ=="),
        ] {
            asked = asked.header(name, value);
        }
    }
    let asked = asked.header(header::CONTENT_TYPE, "application/json").body(Body::from("{}")).unwrap();
    app.clone().oneshot(asked).await.unwrap().status()
}

/// Who may ask for a route: nobody in particular, a participant, the researcher.
fn expected(right: Right) -> [bool; 3] {
    match right {
        Right::Anyone | Right::Entrance => [true, true, true],
        Right::Flyer => [false, true, true],
        Right::Participant => [false, true, false],
        Right::Owner | Right::Researcher | Right::Recorder => [false, false, true],
    }
}

#[tokio::test]
async fn every_route_is_closed_to_whoever_has_not_the_right_to_it() {
    use crate::study::testing::{Browser, running};
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let participant = Browser::participant(&server).await.cookie();
    let researcher = Browser::researcher(&server).await.cookie();
    let forged = format!("cohelm_participant={0}; cohelm_desk={0}", "1".repeat(32));
    let swapped = participant.replace("cohelm_participant", "cohelm_desk");
    let app = app(server);
    // Logging out comes last: it ends the researcher's session.
    let (last, mut routes): (Vec<_>, Vec<_>) =
        table().into_iter().partition(|route| route.path == "/api/desk/logout");
    routes.extend(last);
    for route in routes {
        let [nobody, flyer, desk] = expected(route.right);
        let name = format!("{} {}", route.method, route.path);
        let askers = [
            ("", nobody),
            (&*forged, nobody),
            (&*swapped, nobody),
            (&*participant, flyer),
            (&*researcher, desk),
        ];
        for (cookie, may) in askers {
            let status = ask(&app, &route, cookie, true).await;
            let closed = status == StatusCode::UNAUTHORIZED;
            // The door itself says 401 to whoever has no secret.
            let is_login = route.path == "/api/desk/login";
            assert!(closed != may || is_login, "{name} as {cookie:?}: {status}");
        }
        if route.method != "GET" {
            for cookie in ["", &*participant, &*researcher] {
                let status = ask(&app, &route, cookie, false).await;
                assert_eq!(status, StatusCode::FORBIDDEN, "{name} from another site as {cookie:?}");
            }
        }
    }
}

#[tokio::test]
async fn the_header_of_the_desk_is_asked_for_beside_the_cookie() {
    use crate::study::testing::{Browser, running};
    let disk = Disk::new().await;
    let mut desk = Browser::researcher(&running(&disk).await).await;
    desk.desk = false;
    let answer = desk.post("/api/desk/participants", serde_json::json!({})).await;
    assert_eq!((answer.status, answer.error().contains("x-cohelm-desk")), (StatusCode::FORBIDDEN, true));
}

#[tokio::test]
async fn without_a_study_there_are_no_participants_and_no_desk() {
    let (_disk, app) = with_episodes().await;
    for route in table() {
        let studies =
            matches!(route.right, Right::Entrance | Right::Participant | Right::Researcher | Right::Recorder);
        if studies {
            let name = format!("{} {}", route.method, route.path);
            assert_eq!(ask(&app, &route, "", true).await, StatusCode::NOT_FOUND, "{name}");
        }
    }
}

#[tokio::test]
async fn a_server_of_a_study_welcomes_and_does_not_fly_at_its_root() {
    use crate::study::testing::running;
    let disk = Disk::new().await;
    let app = app(running(&disk).await);
    let root = get(&app, "/").await;
    assert!(root.status == StatusCode::OK && root.text().contains("open the link"), "{}", root.text());
    assert!(
        !root.text().contains("<script") && !root.text().contains("style="),
        "the policy allows no inline script"
    );
    for page in ["/study", "/desk"] {
        assert_ne!(get(&app, page).await.status, StatusCode::NOT_FOUND, "{page}");
    }
}

/// Keeps what a request's span is made of.
#[derive(Clone, Default)]
struct Told(Arc<std::sync::Mutex<String>>);

impl tracing::field::Visit for Told {
    fn record_debug(&mut self, field: &tracing::field::Field, value: &dyn std::fmt::Debug) {
        self.0.lock().unwrap().push_str(&format!("{field}={value:?} "));
    }
}

impl tracing::Subscriber for Told {
    fn enabled(&self, _: &tracing::Metadata<'_>) -> bool {
        true
    }

    fn new_span(&self, span: &tracing::span::Attributes<'_>) -> tracing::span::Id {
        span.record(&mut self.clone());
        tracing::span::Id::from_u64(1)
    }

    fn record(&self, _: &tracing::span::Id, values: &tracing::span::Record<'_>) {
        values.record(&mut self.clone());
    }

    fn event(&self, event: &tracing::Event<'_>) {
        event.record(&mut self.clone());
    }

    fn record_follows_from(&self, _: &tracing::span::Id, _: &tracing::span::Id) {}
    fn enter(&self, _: &tracing::span::Id) {}
    fn exit(&self, _: &tracing::span::Id) {}
}

#[tokio::test]
async fn what_is_logged_of_a_request_is_its_route() {
    use crate::study::testing::{Browser, running};
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let token = "0123456789abcdef".repeat(2);
    let told = Told::default();
    let mut browser = Browser::new(&server);
    // As long as there is one listener only, `tracing` asks each thread that meets a span first whether it listens there, and
    // the other tests' threads do not. With two of them it asks all listeners.
    let _second = tracing::Dispatch::new(Told::default());
    let _guard = tracing::subscriber::set_default(told.clone());
    browser.get(&format!("/p/{token}")).await;
    browser.get("/join?PROLIFIC_PID=5f3a9c0d1e2b4a6788990011").await;
    let told = told.0.lock().unwrap().clone();
    assert!(told.contains("/p/{token}") && told.contains("/join"), "{told}");
    let cookie = browser.cookies[0].1.clone();
    for secret in [&*token, &*cookie, "5f3a9c0d"] {
        assert!(!told.contains(secret), "{told}");
    }
}
