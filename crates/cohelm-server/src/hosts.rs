//! Who may talk to the server: pages of its own, under names that it knows.
//!
//! A page of another site may send requests to this machine, and may have its own name point here (DNS rebinding). The
//! first is told by `Origin`, the second by `Host`.

use axum::http::HeaderMap;
use axum::http::header::{HOST, ORIGIN};

/// Under which names the server may be asked for.
#[derive(Clone, Debug, Default)]
pub struct Hosts {
    named: Vec<String>,
}

impl Hosts {
    /// Only those of this machine itself: `localhost`, `127.0.0.1`, `[::1]`, on any port.
    pub fn loopback() -> Self {
        Self::default()
    }

    /// These names too, without a port.
    pub fn and(mut self, name: &str) -> Self {
        self.named.push(name.to_ascii_lowercase());
        self
    }

    /// True if the request asks for one of the names.
    pub(crate) fn know(&self, headers: &HeaderMap) -> bool {
        host(headers).is_some_and(|host| {
            let name = without_port(&host);
            ["localhost", "127.0.0.1", "[::1]"].contains(&name)
                || self.named.iter().any(|named| named == name)
        })
    }
}

/// True if the request comes from a page that this server itself gave out.
pub(crate) fn same_origin(headers: &HeaderMap) -> bool {
    let origin = headers.get(ORIGIN).and_then(|origin| origin.to_str().ok()).map(str::to_ascii_lowercase);
    let origin = origin.as_deref().and_then(|o| o.strip_prefix("http://").or(o.strip_prefix("https://")));
    origin.is_some() && origin == host(headers).as_deref()
}

fn host(headers: &HeaderMap) -> Option<String> {
    headers.get(HOST)?.to_str().ok().map(str::to_ascii_lowercase)
}

fn without_port(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(host: &str, origin: Option<&str>) -> HeaderMap {
        let mut headers = HeaderMap::new();
        headers.insert(HOST, host.parse().unwrap());
        if let Some(origin) = origin {
            headers.insert(ORIGIN, origin.parse().unwrap());
        }
        headers
    }

    #[test]
    fn names_of_this_machine_and_those_that_were_named_are_known() {
        let hosts = Hosts::loopback().and("Study.example.org");
        for known in ["localhost:8080", "127.0.0.1", "[::1]:9", "LOCALHOST", "study.example.org:443"] {
            assert!(hosts.know(&headers(known, None)), "{known}");
        }
        for unknown in ["evil.example", "localhost.evil.example:80", "127.0.0.1.evil", "", "localhost:x"] {
            assert!(!hosts.know(&headers(unknown, None)), "{unknown}");
        }
        assert!(!hosts.know(&HeaderMap::new()));
    }

    #[test]
    fn only_pages_of_this_server_are_of_the_same_origin() {
        let same = |origin| same_origin(&headers("localhost:8080", origin));
        assert!(same(Some("http://localhost:8080")) && same(Some("https://LocalHost:8080")));
        for other in
            ["http://localhost:8081", "http://evil.example", "null", "localhost:8080", "ws://localhost:8080"]
        {
            assert!(!same(Some(other)), "{other}");
        }
        assert!(!same(None));
    }
}
