//! The routes. No request reaches the file system: the page is a table in memory, everything else the database.

mod api;
mod problem;
mod rights;
mod socket;
#[cfg(test)]
mod tests;

pub(crate) use problem::Problem;
pub(crate) use rights::{Asking, OfStudy, Who};

use crate::external;
use crate::hosts::same_origin;
use crate::server::Server;
use crate::study::{desk, flights, join, page as participant, watch};
use axum::Router;
use axum::extract::{MatchedPath, Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get, post};
use rights::{Right, admit};
use tower_http::limit::RequestBodyLimitLayer;
use tower_http::trace::TraceLayer;

/// Most bytes of a request's body: the answers to a long form.
const MAX_BODY: usize = 64 * 1024;
/// Scripts and styles only from files of ours; WebAssembly may be compiled; nothing may be framed or sent elsewhere.
const CONTENT_POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
    img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; manifest-src 'self'; worker-src 'self'; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A path, how it may be asked for, and by whom.
struct Route {
    path: &'static str,
    /// `GET`, `POST`, or `WS` for a socket.
    #[cfg_attr(not(test), expect(dead_code, reason = "the test that asks for every route reads it"))]
    method: &'static str,
    right: Right,
    handler: MethodRouter<Server>,
}

fn route(method: &'static str, path: &'static str, right: Right, handler: MethodRouter<Server>) -> Route {
    Route { path, method, right, handler }
}

/// Every route but the page's files. There is no other list: the router is built from it, and the test that asks for each
/// without the right to.
fn table() -> Vec<Route> {
    use Right::{Anyone, Entrance, Flyer, Owner, Participant, Recorder, Researcher};
    vec![
        route("GET", "/healthz", Anyone, get(api::health)),
        route("WS", "/ws", Flyer, get(socket::upgrade)),
        route("WS", "/ws/external", Flyer, get(external::upgrade)),
        route("GET", "/api/external", Flyer, get(external::about)),
        route("GET", "/api/plants", Flyer, get(api::plants)),
        route("GET", "/api/models", Flyer, get(api::models)),
        route("GET", "/api/models/{hash}", Flyer, get(api::model)),
        route("GET", "/api/episodes", Owner, get(api::episodes)),
        route("GET", "/api/episodes/{id}", Owner, get(api::episode)),
        route("GET", "/api/learn", Owner, get(api::learning)),
        route("POST", "/api/learn/keep", Owner, post(api::keep)),
        route("POST", "/api/learn/reset", Owner, post(api::reset)),
        route("GET", "/join", Entrance, get(join::openly)),
        route("GET", "/p/{token}", Entrance, get(join::by_link)),
        route("GET", "/api/session", Participant, get(participant::session)),
        route("POST", "/api/session/open", Participant, post(participant::open)),
        route("POST", "/api/session/steps/{*step}", Participant, post(participant::answer)),
        route("POST", "/api/session/language", Participant, post(participant::language)),
        route("POST", "/api/session/withdraw", Participant, post(participant::withdraw)),
        route("GET", "/api/session/flight/{key}", Participant, get(flights::committed)),
        route("POST", "/api/session/flight/{key}", Participant, post(participant::note_flight)),
        route("POST", "/api/desk/login", Entrance, post(desk::log_in)),
        route("POST", "/api/desk/logout", Entrance, post(desk::log_out)),
        route("GET", "/api/desk/study", Researcher, get(desk::study)),
        route("GET", "/api/desk/participants", Researcher, get(desk::participants)),
        route("POST", "/api/desk/participants", Researcher, post(desk::add)),
        route("POST", "/api/desk/participants/{id}/link", Researcher, post(desk::new_link)),
        route("POST", "/api/desk/participants/{id}/{what}", Researcher, post(desk::decide)),
        route("GET", "/api/desk/participants/{id}/log", Researcher, get(desk::log)),
        route("GET", "/api/desk/episodes", Researcher, get(desk::episodes)),
        route("GET", "/api/desk/episodes/{id}", Researcher, get(api::episode)),
        route("GET", "/api/desk/news", Researcher, get(desk::news)),
        route("WS", "/ws/desk/watch/{participant}", Researcher, get(watch::watch)),
        route("WS", "/ws/markers", Recorder, get(watch::markers)),
    ]
}

/// The routes of a server.
pub fn app(server: Server) -> Router {
    let with_right = |router: Router<Server>, Route { path, right, handler, .. }: Route| {
        let admitted = from_fn_with_state((server.clone(), right), admit);
        router.route(path, handler.route_layer(admitted))
    };
    table()
        .into_iter()
        .fold(Router::new(), with_right)
        .fallback(page)
        .layer(RequestBodyLimitLayer::new(MAX_BODY))
        .layer(from_fn_with_state(server.clone(), guard))
        .layer(TraceLayer::new_for_http().make_span_with(span))
        .with_state(server)
}

/// What the log says of a request: the route, not the address that was asked for, which may hold a token.
fn span(request: &Request) -> tracing::Span {
    let route = request.extensions().get::<MatchedPath>().map_or("a file", MatchedPath::as_str);
    tracing::debug_span!("request", method = %request.method(), route)
}

/// The page's files; there is no other path.
async fn page(State(server): State<Server>, method: Method, uri: Uri, headers: HeaderMap) -> Response {
    let Some(answer) = server.assets().answer(file_of(&server, uri.path()), &headers) else {
        return (StatusCode::NOT_FOUND, "there is nothing under this path\n").into_response();
    };
    if method != Method::GET && method != Method::HEAD {
        let allowed = [(header::ALLOW, "GET, HEAD")];
        return (StatusCode::METHOD_NOT_ALLOWED, allowed, "this can only be read\n").into_response();
    }
    answer
}

/// The file behind a path: the pages of a study have addresses without an ending.
fn file_of<'a>(server: &Server, path: &'a str) -> &'a str {
    match path {
        "/study" => "/study.html",
        "/desk" => "/research.html",
        "/" if server.study().is_some() => "/welcome.html",
        other => other,
    }
}

/// True for what opens a socket. A program that is no browser shows the secret instead of an origin, which no page of
/// another site can do.
fn is_socket(request: &Request) -> bool {
    let path = request.uri().path();
    let program = path == "/ws/markers"
        && request.headers().contains_key(header::AUTHORIZATION)
        && !request.headers().contains_key(header::ORIGIN);
    (path == "/ws" || path.starts_with("/ws/")) && !program
}

/// Refuses what other sites send, and tells the browser what a page of ours may do.
async fn guard(State(server): State<Server>, request: Request, next: Next) -> Response {
    let reads = request.method().is_safe() && !is_socket(&request);
    let mut response = if !server.hosts().know(request.headers()) {
        let words = "this server does not go by that name; allow it with --host\n";
        (StatusCode::MISDIRECTED_REQUEST, words).into_response()
    } else if !reads && !same_origin(request.headers()) {
        (StatusCode::FORBIDDEN, "only this server's own page may do that\n").into_response()
    } else {
        next.run(request).await
    };
    for (name, value) in [
        (header::CONTENT_SECURITY_POLICY, CONTENT_POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "same-origin"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ] {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response.headers_mut().entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    response
}
