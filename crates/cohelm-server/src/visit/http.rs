//! Requests to the server, as the page's scripts send them: one connection, cookies kept, JSON both ways.

use super::VisitError;
use http_body_util::{BodyExt, Full};
use hyper::body::Bytes;
use hyper::client::conn::http1::{SendRequest, handshake};
use hyper::header::{CONTENT_TYPE, COOKIE, HOST, LOCATION, ORIGIN, RETRY_AFTER, SET_COOKIE};
use hyper::{HeaderMap, Method, Request, StatusCode};
use hyper_util::rt::TokioIo;
use serde_json::Value;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::time::{sleep, timeout};

use super::line::ANSWER_WITHIN;

/// How long to wait where the server asks for patience without saying how much.
const USUAL_WAIT: Duration = Duration::from_secs(1);

/// A client with cookies, as a browser has them.
pub struct Http {
    address: SocketAddr,
    connection: Option<SendRequest<Full<Bytes>>>,
    cookies: Vec<(String, String)>,
}

/// What came back.
#[derive(Debug)]
pub struct Answer {
    /// Its code.
    pub status: StatusCode,
    /// Where it leads to, if it leads elsewhere.
    pub location: Option<String>,
    /// Its body, as JSON; null if it is none.
    pub json: Value,
    wait: Duration,
}

impl Http {
    /// A client of the server at this address.
    pub fn new(address: SocketAddr) -> Self {
        Self { address, connection: None, cookies: Vec::new() }
    }

    /// The cookies, as a request says them; `None` if there are none.
    pub fn cookies(&self) -> Option<String> {
        let pairs: Vec<String> = self.cookies.iter().map(|(name, value)| format!("{name}={value}")).collect();
        (!pairs.is_empty()).then(|| pairs.join("; "))
    }

    /// Asks for a path.
    pub async fn get(&mut self, path: &str) -> Result<Answer, VisitError> {
        self.ask(Method::GET, path, None).await
    }

    /// Posts JSON to a path.
    pub async fn post(&mut self, path: &str, body: &Value) -> Result<Answer, VisitError> {
        self.ask(Method::POST, path, Some(body)).await
    }

    /// Asks, and asks again where the server wants to be asked more slowly.
    async fn ask(&mut self, method: Method, path: &str, body: Option<&Value>) -> Result<Answer, VisitError> {
        loop {
            let answer = timeout(ANSWER_WITHIN, self.once(method.clone(), path, body)).await;
            let answer = match answer {
                Ok(Ok(answer)) => answer,
                failed => {
                    self.connection = None;
                    return failed.map_err(|_| VisitError::Silence(ANSWER_WITHIN))?;
                }
            };
            if answer.status != StatusCode::TOO_MANY_REQUESTS {
                return Ok(answer);
            }
            sleep(answer.wait).await;
        }
    }

    async fn once(&mut self, method: Method, path: &str, body: Option<&Value>) -> Result<Answer, VisitError> {
        let request = self.request(method, path, body)?;
        let connection = self.connect().await?;
        connection.ready().await.map_err(gone)?;
        let response = connection.send_request(request).await.map_err(gone)?;
        let (parts, body) = response.into_parts();
        let bytes = body.collect().await.map_err(gone)?.to_bytes();
        self.keep_cookies(&parts.headers);
        let text = |name| parts.headers.get(name)?.to_str().ok().map(str::to_owned);
        let seconds: Option<u64> = text(RETRY_AFTER).and_then(|seconds| seconds.parse().ok());
        Ok(Answer {
            status: parts.status,
            location: text(LOCATION),
            json: serde_json::from_slice(&bytes).unwrap_or(Value::Null),
            wait: seconds.map_or(USUAL_WAIT, Duration::from_secs),
        })
    }

    fn request(
        &self,
        method: Method,
        path: &str,
        body: Option<&Value>,
    ) -> Result<Request<Full<Bytes>>, VisitError> {
        let host = self.address.to_string();
        let mut request = Request::builder().method(method).uri(path).header(HOST, &host);
        if let Some(cookies) = self.cookies() {
            request = request.header(COOKIE, cookies);
        }
        let body = match body {
            Some(json) => {
                // What only scripts of the server's own pages can send.
                request = request.header(ORIGIN, format!("http://{host}")).header("x-cohelm-desk", "1");
                request = request.header(CONTENT_TYPE, "application/json");
                json.to_string()
            }
            None => String::new(),
        };
        request.body(Full::from(body)).map_err(|error| VisitError::Gone(error.to_string()))
    }

    async fn connect(&mut self) -> Result<&mut SendRequest<Full<Bytes>>, VisitError> {
        if self.connection.as_ref().is_none_or(SendRequest::is_closed) {
            let address = self.address;
            let refused = |reason: String| VisitError::Connect { address, reason };
            let stream = TcpStream::connect(address).await.map_err(|error| refused(error.to_string()))?;
            stream.set_nodelay(true).map_err(|error| refused(error.to_string()))?;
            let (sender, connection) =
                handshake(TokioIo::new(stream)).await.map_err(|error| refused(error.to_string()))?;
            // Ends with the connection; what goes wrong there the sender hears of.
            tokio::spawn(async { drop(connection.await) });
            self.connection = Some(sender);
        }
        self.connection.as_mut().ok_or_else(|| VisitError::Gone("the connection closed".into()))
    }

    fn keep_cookies(&mut self, headers: &HeaderMap) {
        let lines = headers.get_all(SET_COOKIE).iter().filter_map(|line| line.to_str().ok());
        for (name, value) in lines.filter_map(|line| line.split(';').next()?.split_once('=')) {
            self.cookies.retain(|(known, _)| known != name);
            self.cookies.push((name.to_owned(), value.to_owned()));
        }
    }
}

impl Answer {
    /// The JSON of an answer that is one; otherwise what the server says is wrong.
    pub fn expect(self, what: &str) -> Result<Value, VisitError> {
        if self.status.is_success() {
            return Ok(self.json);
        }
        let words = self.json["error"].as_str().unwrap_or("it does not say why").to_owned();
        let items = self.json.get("items").map_or(String::new(), |items| format!(" {items}"));
        let status = self.status.as_u16();
        let (what, reason) = (what.to_owned(), format!("{words}{items}"));
        Err(VisitError::Answer { what, status, reason })
    }
}

fn gone(error: hyper::Error) -> VisitError {
    VisitError::Gone(error.to_string())
}
