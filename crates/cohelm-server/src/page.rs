//! The built page, inside the program: a table of files, so that no request reaches the file system.

use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use cohelm_copilot::model::hash;

/// Paths and bytes of `web/dist` as it was when this was built; empty if it was not there.
const EMBEDDED: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/page.in"));
/// What a browser asks for by itself, if the page brings none.
const FAVICON: &[u8] = include_bytes!("page/favicon.svg");
const NO_PAGE: &str = include_str!("page/not-built.html");
/// What is read at the root of a server that runs a study, by whoever has no link.
const WELCOME: &str = include_str!("page/welcome.html");

/// The files of a page.
#[derive(Clone, Debug)]
pub struct Assets {
    files: Vec<Asset>,
}

#[derive(Clone, Debug)]
struct Asset {
    path: &'static str,
    bytes: &'static [u8],
    etag: HeaderValue,
}

impl Assets {
    /// The page that was built into this program.
    pub fn embedded() -> Self {
        Self::of(EMBEDDED)
    }

    /// Other files, as paths from `/` and bytes.
    pub fn of(files: &[(&'static str, &'static [u8])]) -> Self {
        let asset = |&(path, bytes): &(&'static str, &'static [u8])| Asset { path, bytes, etag: etag(bytes) };
        Self { files: files.iter().map(asset).collect() }
    }

    /// True if there is a page.
    pub fn has_page(&self) -> bool {
        self.files.iter().any(|file| file.path == "/index.html")
    }

    /// Answers a request for a path; `None` if there is no such file.
    pub(crate) fn answer(&self, path: &str, headers: &HeaderMap) -> Option<Response> {
        let path = if path == "/" { "/index.html" } else { path };
        match self.files.iter().find(|file| file.path == path) {
            Some(file) => Some(file.answer(headers)),
            None if path == "/favicon.ico" => {
                Some(Asset { path: "/favicon.svg", bytes: FAVICON, etag: etag(FAVICON) }.answer(headers))
            }
            None if path == "/welcome.html" => Some(Html(WELCOME).into_response()),
            None if ["/index.html", "/study.html", "/research.html"].contains(&path) => {
                Some((StatusCode::SERVICE_UNAVAILABLE, Html(NO_PAGE)).into_response())
            }
            None => None,
        }
    }
}

impl Asset {
    fn answer(&self, headers: &HeaderMap) -> Response {
        answer_cached(headers, &self.etag, "no-cache", content_type(self.path), self.bytes)
    }
}

/// Bytes that a browser may keep under their tag; only the tag, if it has them.
pub(crate) fn answer_cached(
    headers: &HeaderMap,
    etag: &HeaderValue,
    cache: &'static str,
    content_type: &'static str,
    bytes: impl IntoResponse,
) -> Response {
    let mut known = headers.get_all(header::IF_NONE_MATCH).iter().filter_map(|value| value.to_str().ok());
    let tag = etag.to_str().unwrap_or_default();
    let keeps = [(header::ETAG, etag.clone()), (header::CACHE_CONTROL, HeaderValue::from_static(cache))];
    if known.any(|tags| tags.split(',').any(|known| known.trim().trim_start_matches("W/") == tag)) {
        return (StatusCode::NOT_MODIFIED, keeps).into_response();
    }
    let mut response = (keeps, bytes).into_response();
    response.headers_mut().insert(header::CONTENT_TYPE, HeaderValue::from_static(content_type));
    response
}

/// The tag of bytes: a quoted part of their SHA-256.
pub(crate) fn etag(bytes: &[u8]) -> HeaderValue {
    let tag = format!("\"{}\"", &hash(bytes)[..32]);
    HeaderValue::try_from(tag).expect("hexadecimal digits in quotes are a header's value")
}

fn content_type(path: &str) -> &'static str {
    match path.rsplit_once('.').map_or("", |(_, extension)| extension) {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "wasm" => "application/wasm",
        "json" => "application/json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "ico" => "image/x-icon",
        "woff2" => "font/woff2",
        "txt" | "md" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
