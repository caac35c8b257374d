//! A real listener on loopback, and pages that speak WebSocket to it.

use super::*;
use crate::learn::{Learner, Lessons};
use crate::page::Assets;
use crate::protocol::{Begin, FromPage, MAX_MESSAGE, ToPage};
use crate::store::{EpisodeId, Page as ListPage, Progress, Store, unpack};
use crate::testing::{Disk, Page, assisted, buttons, flown, key, setup};
use cohelm::trajectory::{Setup, Trajectory};
use cohelm_copilot::{Model, Models};
use futures_util::{SinkExt, StreamExt};
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::task::JoinHandle;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};
use tokio_util::sync::CancellationToken;

/// A server that runs.
struct Running {
    address: SocketAddr,
    stop: CancellationToken,
    done: JoinHandle<io::Result<()>>,
}

impl Running {
    async fn new(server: Server) -> Self {
        let listener = bind("127.0.0.1:0".parse().unwrap()).await.unwrap();
        let address = listener.local_addr().unwrap();
        let stop = CancellationToken::new();
        let stopped = stop.clone();
        let done = tokio::spawn(serve(listener, server, async move { stopped.cancelled().await }));
        Self { address, stop, done }
    }

    async fn stop(self) {
        self.stop.cancel();
        timeout(Duration::from_secs(20), self.done).await.expect("it stops in time").unwrap().unwrap();
    }

    /// As a killed process would: without a farewell, without finishing anything.
    fn kill(self) {
        self.done.abort();
    }

    async fn connect(&self) -> Line {
        self.connect_from(&format!("http://{}", self.address)).await.expect("the server takes its own page")
    }

    async fn connect_from(&self, origin: &str) -> Result<Line, Error> {
        let mut request = format!("ws://{}/ws", self.address).into_client_request()?;
        request.headers_mut().insert("Origin", origin.parse().unwrap());
        let (socket, _) = connect_async(request).await?;
        let mut line = Line { socket };
        assert!(matches!(line.hear().await, ToPage::Welcome(_)));
        Ok(line)
    }
}

struct Line {
    socket: WebSocketStream<MaybeTlsStream<TcpStream>>,
}

impl Line {
    async fn say(&mut self, words: FromPage) {
        self.socket.send(Message::Binary(words.to_bytes().into())).await.unwrap();
    }

    async fn next(&mut self) -> Result<Message, Error> {
        timeout(Duration::from_secs(20), self.socket.next())
            .await
            .expect("an answer in time")
            .expect("a message")
    }

    async fn hear(&mut self) -> ToPage {
        match self.next().await {
            Ok(Message::Binary(bytes)) => ToPage::from_bytes(&bytes).unwrap(),
            other => panic!("expected a message, got {other:?}"),
        }
    }

    async fn ask(&mut self, words: FromPage) -> ToPage {
        self.say(words).await;
        self.hear().await
    }

    async fn closed(&mut self) -> (u16, String) {
        loop {
            if let Message::Close(frame) = self.next().await.expect("a close") {
                let frame = frame.expect("with a reason");
                return (frame.code.into(), frame.reason.to_string());
            }
        }
    }

    async fn fly_on(&mut self, page: &mut Page) -> ToPage {
        while !page.ended() {
            let chunk = page.fly(50);
            let committed_tick = chunk.to_tick;
            assert_eq!(self.ask(FromPage::Chunk(chunk)).await, ToPage::Ack { committed_tick });
        }
        self.ask(FromPage::End(page.end())).await
    }
}

fn begin(number: u8, setup: Setup) -> FromPage {
    FromPage::Begin(Begin { key: key(number), age_ms: 0, setup })
}

async fn stored(store: &dyn Store, episode: EpisodeId) -> Trajectory {
    let packed = store.record(episode).await.unwrap().expect("there is a record");
    Trajectory::from_bytes(&unpack(&packed).unwrap()).unwrap()
}

#[tokio::test]
async fn a_page_flies_loses_its_connection_and_lands() {
    let disk = Disk::new().await;
    let running = Running::new(disk.server().await).await;
    let mut page = Page::new(setup(6));
    let mut line = running.connect().await;
    let ToPage::Begun { episode, .. } = line.ask(begin(1, setup(6))).await else { panic!("not begun") };
    line.ask(FromPage::Chunk(page.fly(50))).await;
    drop(line);
    page.fly(50);
    let mut line = running.connect().await;
    assert_eq!(line.ask(begin(1, setup(6))).await, ToPage::Begun { episode, committed_tick: 50 });
    line.ask(FromPage::Chunk(page.piece_since(50))).await;
    assert_eq!(line.fly_on(&mut page).await, ToPage::Finished { episode });
    assert_eq!(stored(disk.store.as_ref(), episode).await, flown(6));
    running.stop().await;
}

#[tokio::test]
async fn a_tampered_digest_is_refused_over_the_wire() {
    let disk = Disk::new().await;
    let running = Running::new(disk.server().await).await;
    let mut page = Page::new(setup(6));
    let mut line = running.connect().await;
    line.ask(begin(1, setup(6))).await;
    let mut chunk = page.fly(50);
    chunk.digests.decisions ^= 1;
    assert!(
        matches!(line.ask(FromPage::Chunk(chunk)).await, ToPage::Refused { reason } if reason.contains("decisions"))
    );
    running.stop().await;
}

#[tokio::test]
async fn what_was_acknowledged_survives_a_server_that_is_killed_and_the_flight_goes_on() {
    let disk = Disk::new().await;
    let running = Running::new(disk.server().await).await;
    let mut page = Page::new(setup(6));
    let mut line = running.connect().await;
    let ToPage::Begun { episode, .. } = line.ask(begin(1, setup(6))).await else { panic!("not begun") };
    for _ in 0..2 {
        line.ask(FromPage::Chunk(page.fly(50))).await;
    }
    line.say(FromPage::Chunk(page.fly(50))).await;
    running.kill();

    let folder = disk.folder;
    let store = crate::store::SqliteStore::open_existing(&folder.path().join("flights.db")).await.unwrap();
    let row = store.episode(episode).await.unwrap().unwrap();
    assert!(row.progress == Progress::InTheAir && row.ticks >= 100, "{row:?}");
    let disk = Disk { folder, store: store.into() };
    let running = Running::new(disk.server().await).await;
    let mut line = running.connect().await;
    let ToPage::Begun { committed_tick, .. } = line.ask(begin(1, setup(6))).await else {
        panic!("not begun")
    };
    assert!(committed_tick == 100 || committed_tick == 150, "{committed_tick}");
    line.ask(FromPage::Chunk(page.piece_since(committed_tick))).await;
    assert_eq!(line.fly_on(&mut page).await, ToPage::Finished { episode });
    assert_eq!(stored(disk.store.as_ref(), episode).await, flown(6));
}

#[tokio::test]
async fn a_server_that_stops_tells_its_pages() {
    let disk = Disk::new().await;
    let running = Running::new(disk.server().await).await;
    let mut line = running.connect().await;
    running.stop.cancel();
    assert_eq!(line.closed().await, (1001, "the server stops; connect again later".into()));
    running.stop().await;
}

#[tokio::test]
async fn pages_of_other_sites_are_not_let_in() {
    let disk = Disk::new().await;
    let running = Running::new(disk.server().await).await;
    for origin in ["http://evil.example", "null", "http://127.0.0.1:1"] {
        match running.connect_from(origin).await {
            Err(Error::Http(response)) => assert_eq!(response.status(), 403, "{origin}"),
            other => panic!("{origin}: {:?}", other.map(|_| "let in")),
        }
    }
    running.stop().await;
}

#[tokio::test]
async fn oversized_messages_close_the_connection_with_a_reason() {
    let disk = Disk::new().await;
    let running = Running::new(disk.server().await).await;
    for (bytes, codes) in [(MAX_MESSAGE + 1, [1009, 1009]), (8 * MAX_MESSAGE, [1009, 1002])] {
        let mut line = running.connect().await;
        line.socket.send(Message::Binary(vec![1; bytes].into())).await.unwrap();
        let (code, reason) = line.closed().await;
        assert!(codes.contains(&code) && !reason.is_empty(), "{bytes}: {code} {reason}");
    }
    assert!(matches!(running.connect().await.ask(begin(1, setup(1))).await, ToPage::Begun { .. }));
    running.stop().await;
}

#[tokio::test]
async fn a_port_in_use_is_said_with_what_to_do() {
    let first = bind("127.0.0.1:0".parse().unwrap()).await.unwrap();
    let error = bind(first.local_addr().unwrap()).await.unwrap_err();
    assert!(matches!(error, BindError::InUse { .. }));
    assert!(error.to_string().contains("--port"), "{error}");
}

#[tokio::test]
async fn many_pages_fly_at_once() {
    let disk = Disk::new().await;
    let running = Running::new(disk.server().await).await;
    let pages = (0..40_u8).map(|number| async move { number });
    let running_ref = &running;
    let flights = pages.map(|number| async move {
        let number = number.await;
        let mut line = running_ref.connect().await;
        line.ask(begin(number, setup(number.into()))).await;
        line.fly_on(&mut Page::new(setup(number.into()))).await
    });
    let landed = futures_util::future::join_all(flights).await;
    assert!(landed.iter().all(|answer| matches!(answer, ToPage::Finished { .. })));
    let episodes = disk.store.episodes(ListPage::newest(100)).await.unwrap();
    assert_eq!(episodes.len(), 40);
    for episode in episodes {
        assert_eq!(stored(disk.store.as_ref(), episode.id).await, flown(episode.seed));
    }
    running.stop().await;
}

/// Gives models 1, 2, 3...
struct Counting(u32);

impl Learner for Counting {
    fn learn(&mut self, _flown: &Trajectory) -> Option<Vec<u8>> {
        self.0 += 1;
        Some(buttons::model(self.0).bytes().to_vec())
    }

    fn return_to(&mut self, _model: &Model) {
        self.0 = 0;
    }
}

#[tokio::test]
async fn learned_values_are_announced_between_flights_and_assist_the_next_one() {
    let disk = Disk::new().await;
    let mut models = Models::new();
    let shipped = models.add_model(buttons::model(0)).clone();
    let lessons = Lessons { learner: Box::new(Counting(0)), current: shipped.clone(), shipped };
    let running = Running::new(disk.server_with(Some(lessons), Assets::of(&[])).await).await;
    let mut line = running.connect().await;
    let mut assists = models.get(buttons::model(0).hash()).unwrap().clone();
    for number in 1..=3_u8 {
        let setup = assisted(number.into(), &assists);
        let mut page = Page::with(setup.clone(), &models);
        let ToPage::Begun { episode, .. } = line.ask(begin(number, setup.clone())).await else {
            panic!("not begun")
        };
        assert_eq!(line.fly_on(&mut page).await, ToPage::Finished { episode });
        assert_eq!(stored(disk.store.as_ref(), episode).await.setup, setup);
        let learned = buttons::model(number.into());
        let ToPage::NewModel { hash } = line.hear().await else { panic!("no news") };
        let hash: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hash, learned.hash());
        assists = models.add(&disk.store.model(&hash).await.unwrap().unwrap()).unwrap().clone();
    }
    running.stop().await;
}

#[tokio::test]
async fn other_machines_are_served_only_where_a_secret_guards() {
    let disk = Disk::new().await;
    let listener = bind("0.0.0.0:0".parse().unwrap()).await.unwrap();
    let error = serve(listener, disk.server().await, std::future::pending()).await.unwrap_err();
    assert!(error.to_string().contains("secret"), "{error}");
    let listener = bind("0.0.0.0:0".parse().unwrap()).await.unwrap();
    let server = crate::study::testing::running(&disk).await;
    serve(listener, server, std::future::ready(())).await.expect("a study has a secret");
}

/// Certificate and key for localhost, in a folder.
fn certified(folder: &std::path::Path) -> (rcgen::CertifiedKey<rcgen::KeyPair>, Tls) {
    let own = rcgen::generate_simple_self_signed(vec!["localhost".into()]).unwrap();
    let (certificate, key) = (folder.join("certificate.pem"), folder.join("key.pem"));
    std::fs::write(&certificate, own.cert.pem()).unwrap();
    std::fs::write(&key, own.signing_key.serialize_pem()).unwrap();
    let tls = Tls::open(&certificate, &key).unwrap();
    (own, tls)
}

#[tokio::test]
async fn flights_go_over_tls_of_the_servers_own() {
    use tokio_rustls::TlsConnector;
    use tokio_rustls::rustls::crypto::ring::default_provider;
    use tokio_rustls::rustls::{ClientConfig, RootCertStore};
    let disk = Disk::new().await;
    let (own, tls) = certified(disk.folder.path());
    let listener = bind("127.0.0.1:0".parse().unwrap()).await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(serve_tls(listener, tls, disk.server().await, std::future::pending()));
    // One that never greets holds up nobody.
    let _silent = TcpStream::connect(address).await.unwrap();
    let mut roots = RootCertStore::empty();
    roots.add(own.cert.der().clone()).unwrap();
    let config = ClientConfig::builder_with_provider(std::sync::Arc::new(default_provider()))
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_root_certificates(roots)
        .with_no_client_auth();
    let stream = TcpStream::connect(address).await.unwrap();
    let name = "localhost".try_into().unwrap();
    let stream = TlsConnector::from(std::sync::Arc::new(config)).connect(name, stream).await.unwrap();
    let mut request = format!("ws://localhost:{}/ws", address.port()).into_client_request().unwrap();
    request.headers_mut().insert("Origin", format!("https://localhost:{}", address.port()).parse().unwrap());
    let (mut socket, _) = tokio_tungstenite::client_async(request, stream).await.unwrap();
    let Some(Ok(Message::Binary(bytes))) = socket.next().await else { panic!("no welcome") };
    assert!(matches!(ToPage::from_bytes(&bytes).unwrap(), ToPage::Welcome(_)));
    let mut plain = TcpStream::connect(address).await.unwrap();
    tokio::io::AsyncWriteExt::write_all(&mut plain, b"GET / HTTP/1.1\r\n\r\n").await.unwrap();
    let mut answer = Vec::new();
    let _ = tokio::io::AsyncReadExt::read_to_end(&mut plain, &mut answer).await;
    assert!(!answer.starts_with(b"HTTP"), "nothing is said in the clear");
}

#[tokio::test]
async fn files_that_are_no_certificate_or_key_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let (_, _) = certified(folder.path());
    let (certificate, key) = (folder.path().join("certificate.pem"), folder.path().join("key.pem"));
    let missing = folder.path().join("nothing.pem");
    for (certificate, key, word) in [
        (&missing, &key, "nothing.pem"),
        (&certificate, &missing, "nothing.pem"),
        (&key, &key, "no certificate"),
        (&certificate, &certificate, "key"),
    ] {
        let error = Tls::open(certificate, key).err().expect("refused").to_string();
        assert!(error.contains(word), "{error}");
    }
}
