//! `cohelm fly` as a process: from its first line to the signal that ends it.
#![cfg(unix)]

mod program;

use program::{cohelm, folder, run};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A running server; killed if a test fails before it has ended.
struct Server {
    child: Child,
    address: String,
}

impl Server {
    fn start(folder: &Path, arguments: &[&str]) -> Self {
        let arguments = [&["fly", "--port", "0", "--database", "flights.db"], arguments].concat();
        let mut child =
            cohelm(folder, arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("cohelm flies at http://").unwrap_or_else(|| {
            panic!("its first line is {line:?}");
        });
        Self { address: address.into(), child }
    }

    /// The answer to a plain HTTP request: status, head and body.
    fn get(&self, path: &str) -> (u16, String, Vec<u8>) {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", self.address).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|window| window == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8(answer[..end].to_vec()).unwrap();
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        (status, head.to_lowercase(), answer[end + 4..].to_vec())
    }

    /// Sends a signal and waits; gives what it left on standard error as well.
    fn end(mut self, signal: &str) -> (ExitStatus, String) {
        let sent = Command::new("kill").args([signal, &self.child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        let begun = Instant::now();
        let status = loop {
            match self.child.try_wait().unwrap() {
                Some(status) => break status,
                None if begun.elapsed() > Duration::from_secs(20) => panic!("{signal} did not end it"),
                None => thread::sleep(Duration::from_millis(20)),
            }
        };
        let mut told = String::new();
        self.child.stderr.take().unwrap().read_to_string(&mut told).unwrap();
        (status, told)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn files(folder: &TempDir) -> Vec<String> {
    let entries = std::fs::read_dir(folder.path()).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn it_serves_the_page_and_ends_cleanly_when_asked_to() {
    for signal in ["-TERM", "-INT"] {
        let folder = folder();
        let server = Server::start(folder.path(), &[]);
        assert_eq!(server.get("/healthz").0, 200);
        let (status, head, body) = server.get("/");
        assert_eq!(status, 200);
        assert!(head.contains("content-type: text/html"), "{head}");
        assert!(String::from_utf8(body).unwrap().contains("app.js"));
        let (status, head, body) = server.get("/cohelm_page.wasm");
        assert_eq!((status, &body[..4]), (200, &b"\0asm"[..]));
        assert!(head.contains("content-type: application/wasm"), "{head}");
        assert_eq!(server.get("/nothing-of-that-name").0, 404);
        let (status, told) = server.end(signal);
        assert_eq!((status.code(), told.as_str()), (Some(0), ""), "{signal}");
        assert_eq!(files(&folder), ["flights.db"], "{signal}: the database is closed");
    }
}

#[test]
fn its_address_names_the_plant_that_was_asked_for() {
    let folder = folder();
    for (asked, expected) in [
        (&["--task", "drone"][..], "/?task=drone"),
        (&["--option", "actions=continuous"], "/?task=flag-lander&actions=continuous"),
        (
            &["--task", "flag-lander", "--option", "changes_mind=[40,120]"],
            "/?task=flag-lander&changes_mind=%5B40%2C120%5D",
        ),
    ] {
        let server = Server::start(folder.path(), asked);
        let (host, query) = server.address.split_at(server.address.find('/').unwrap_or_default());
        assert_eq!(query, expected, "after {host}");
        assert_eq!(server.end("-TERM").0.code(), Some(0));
    }
}

#[test]
fn it_lists_plants_and_models_as_json() {
    let folder = folder();
    let server = Server::start(folder.path(), &[]);
    for path in ["/api/models", "/api/episodes"] {
        let (status, head, body) = server.get(path);
        assert_eq!(status, 200, "{path}");
        assert!(head.contains("content-type: application/json"), "{path}: {head}");
        serde_json::from_slice::<serde_json::Value>(&body).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
}

#[test]
fn after_a_kill_the_database_is_whole_and_goes_on() {
    let folder = folder();
    let server = Server::start(folder.path(), &[]);
    assert_eq!(server.get("/healthz").0, 200);
    let (status, _) = server.end("-KILL");
    assert_eq!(status.code(), None);
    let listed = run(folder.path(), ["episodes", "--database", "flights.db", "--json"]);
    assert_eq!((listed.code, listed.stderr.as_str()), (Some(0), ""));
    assert_eq!(serde_json::from_str::<serde_json::Value>(&listed.stdout).unwrap(), serde_json::json!([]));
    let server = Server::start(folder.path(), &[]);
    assert_eq!(server.get("/healthz").0, 200);
    assert_eq!(server.end("-TERM").0.code(), Some(0));
}

#[test]
fn a_database_that_was_cut_off_is_refused_and_left_alone() {
    let folder = folder();
    let path = folder.path().join("flights.db");
    assert_eq!(Server::start(folder.path(), &[]).end("-TERM").0.code(), Some(0));
    let whole = std::fs::read(&path).unwrap();
    for length in [whole.len() / 2, 3000, 50] {
        std::fs::write(&path, &whole[..length]).unwrap();
        for command in [&["fly", "--port", "0"][..], &["episodes"], &["verify", "episodes"]] {
            let ran = run(folder.path(), [command, &["--database", "flights.db"]].concat());
            assert_eq!(
                (ran.code, ran.stderr.lines().count()),
                (Some(1), 1),
                "{length} bytes: {}",
                ran.stderr
            );
            assert!(ran.stderr.starts_with("cohelm: "), "{}", ran.stderr);
        }
        assert!(std::fs::read(&path).unwrap() == whole[..length], "{length} bytes: it was changed");
    }
}
