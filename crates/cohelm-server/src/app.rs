//! The routes. No request reaches the file system: the page is a table in memory, everything else the database.

mod api;
mod socket;
#[cfg(test)]
mod tests;

use crate::hosts::same_origin;
use crate::server::Server;
use axum::Router;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{any, get, post};
use tower_http::limit::RequestBodyLimitLayer;
use tower_http::trace::TraceLayer;

/// Most bytes of a request's body: nothing here takes one.
const MAX_BODY: usize = 4 * 1024;
/// Scripts and styles only from files of ours; WebAssembly may be compiled; nothing may be framed or sent elsewhere.
const CONTENT_POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
    img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; manifest-src 'self'; worker-src 'self'; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The routes of a server.
pub fn app(server: Server) -> Router {
    Router::new()
        .route("/ws", any(socket::upgrade))
        .route("/healthz", get(api::health))
        .route("/api/plants", get(api::plants))
        .route("/api/models", get(api::models))
        .route("/api/models/{hash}", get(api::model))
        .route("/api/episodes", get(api::episodes))
        .route("/api/episodes/{id}", get(api::episode))
        .route("/api/learn", get(api::learning))
        .route("/api/learn/keep", post(api::keep))
        .route("/api/learn/reset", post(api::reset))
        .fallback(page)
        .layer(RequestBodyLimitLayer::new(MAX_BODY))
        .layer(from_fn_with_state(server.clone(), guard))
        .layer(TraceLayer::new_for_http())
        .with_state(server)
}

/// The page's files; there is no other path.
async fn page(State(server): State<Server>, method: Method, uri: Uri, headers: HeaderMap) -> Response {
    let Some(answer) = server.assets().answer(uri.path(), &headers) else {
        return (StatusCode::NOT_FOUND, "there is nothing under this path\n").into_response();
    };
    if method != Method::GET && method != Method::HEAD {
        let allowed = [(header::ALLOW, "GET, HEAD")];
        return (StatusCode::METHOD_NOT_ALLOWED, allowed, "this can only be read\n").into_response();
    }
    answer
}

/// Refuses what other sites send, and tells the browser what a page of ours may do.
async fn guard(State(server): State<Server>, request: Request, next: Next) -> Response {
    let reads = request.method().is_safe() && request.uri().path() != "/ws";
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
