//! Conversations over channels: what a page says and what it is answered.

use super::*;
use crate::protocol::{Begin, MAX_MESSAGE};
use crate::store::{EpisodeId, Page as ListPage, Progress, Store, unpack};
use crate::testing::{Disk, Page, flown, key, setup};
use cohelm::trajectory::{Setup, Trajectory};
use futures_channel::mpsc::{UnboundedReceiver, UnboundedSender, unbounded};
use proptest::prelude::*;
use std::convert::Infallible;
use tokio::task::JoinHandle;

/// The page's end of a connection.
struct Line {
    to_server: UnboundedSender<Result<Message, Infallible>>,
    from_server: UnboundedReceiver<Message>,
    conversation: JoinHandle<()>,
}

impl Line {
    /// Connects, and hears the welcome.
    async fn new(server: &Server) -> Self {
        let ((to_server, incoming), (outgoing, from_server)) = (unbounded(), unbounded());
        let server = server.clone();
        let conversation = tokio::spawn(async move { converse(&server, None, incoming, outgoing).await });
        let mut line = Self { to_server, from_server, conversation };
        assert!(matches!(line.hear().await, ToPage::Welcome(_)));
        line
    }

    fn send(&self, message: Message) {
        // A server that has closed hears nothing more.
        let _ = self.to_server.unbounded_send(Ok(message));
    }

    fn say(&self, words: FromPage) {
        self.send(Message::Binary(words.to_bytes().into()));
    }

    async fn next(&mut self) -> Message {
        let next = timeout(Duration::from_secs(20), self.from_server.next()).await;
        next.expect("the server answers in time").expect("the server has not gone")
    }

    async fn hear(&mut self) -> ToPage {
        match self.next().await {
            Message::Binary(bytes) => ToPage::from_bytes(&bytes).unwrap(),
            other => panic!("expected a message, got {other:?}"),
        }
    }

    async fn ask(&mut self, words: FromPage) -> ToPage {
        self.say(words);
        self.hear().await
    }

    /// The code and reason with which the server closes; what it says before is passed over.
    async fn closed(&mut self) -> (u16, String) {
        loop {
            if let Message::Close(frame) = self.next().await {
                let frame = frame.expect("a close has a reason");
                return (frame.code, frame.reason.to_string());
            }
        }
    }

    /// The connection breaks.
    async fn cut(self) {
        drop((self.to_server, self.from_server));
        self.conversation.await.unwrap();
    }
}

fn begin(number: u8, setup: Setup) -> FromPage {
    FromPage::Begin(Begin { key: key(number), age_ms: 0, setup })
}

fn episode_of(answer: &ToPage) -> EpisodeId {
    match answer {
        ToPage::Begun { episode, .. } | ToPage::Finished { episode } => *episode,
        other => panic!("expected a number, got {other:?}"),
    }
}

async fn stored(disk: &Disk, episode: EpisodeId) -> Trajectory {
    let packed = disk.store.record(episode).await.unwrap().expect("there is a record");
    Trajectory::from_bytes(&unpack(&packed).unwrap()).unwrap()
}

/// Flies to the end, a second a piece.
async fn fly_on(line: &mut Line, page: &mut Page) -> ToPage {
    while !page.ended() {
        let chunk = page.fly(50);
        let committed_tick = chunk.to_tick;
        assert_eq!(line.ask(FromPage::Chunk(chunk)).await, ToPage::Ack { committed_tick });
    }
    line.ask(FromPage::End(page.end())).await
}

#[tokio::test]
async fn a_flight_is_followed_acknowledged_and_stored_bit_for_bit() {
    let disk = Disk::new().await;
    let mut line = Line::new(&disk.server().await).await;
    let begun = line.ask(begin(1, setup(3))).await;
    assert!(matches!(begun, ToPage::Begun { committed_tick: 0, .. }));
    let episode = episode_of(&begun);
    assert_eq!(fly_on(&mut line, &mut Page::new(setup(3))).await, ToPage::Finished { episode });
    assert_eq!(stored(&disk, episode).await, flown(3));
    assert_eq!(disk.store.chunks(episode).await.unwrap(), []);
}

#[tokio::test]
async fn several_flights_go_over_one_connection_without_waiting_for_answers() {
    let disk = Disk::new().await;
    let mut line = Line::new(&disk.server().await).await;
    for number in 0..3 {
        let mut page = Page::new(setup(number.into()));
        line.say(begin(number, setup(number.into())));
        line.say(FromPage::Chunk(page.fly(10_000)));
        line.say(FromPage::End(page.end()));
    }
    for number in 0..3 {
        let episode = episode_of(&line.hear().await);
        assert!(matches!(line.hear().await, ToPage::Ack { .. }));
        assert_eq!(line.hear().await, ToPage::Finished { episode });
        assert_eq!(stored(&disk, episode).await, flown(number));
    }
}

#[tokio::test]
async fn an_episode_that_began_while_the_network_was_away_keeps_its_time() {
    let disk = Disk::new().await;
    let mut line = Line::new(&disk.server().await).await;
    let begin = FromPage::Begin(Begin { key: key(1), age_ms: 3_600_000, setup: setup(1) });
    let episode = episode_of(&line.ask(begin).await);
    let row = disk.store.episode(episode).await.unwrap().unwrap();
    let age_ms = crate::store::now_ms() - row.started_at_ms;
    assert!((3_600_000..3_660_000).contains(&age_ms), "{age_ms}");
}

#[tokio::test]
async fn after_a_lost_connection_the_page_goes_on_from_what_is_committed() {
    let disk = Disk::new().await;
    let server = disk.server().await;
    let mut page = Page::new(setup(3));
    let mut line = Line::new(&server).await;
    let episode = episode_of(&line.ask(begin(1, setup(3))).await);
    line.ask(FromPage::Chunk(page.fly(50))).await;
    line.cut().await;
    page.fly(50);

    let mut line = Line::new(&server).await;
    assert_eq!(line.ask(begin(1, setup(3))).await, ToPage::Begun { episode, committed_tick: 50 });
    let late = page.piece_since(50);
    assert_eq!(line.ask(FromPage::Chunk(late)).await, ToPage::Ack { committed_tick: 100 });
    assert_eq!(fly_on(&mut line, &mut page).await, ToPage::Finished { episode });
    assert_eq!(stored(&disk, episode).await, flown(3));
}

#[tokio::test]
async fn a_finished_flight_is_finished_however_often_the_page_asks() {
    let disk = Disk::new().await;
    let server = disk.server().await;
    let mut line = Line::new(&server).await;
    let episode = episode_of(&line.ask(begin(1, setup(3))).await);
    fly_on(&mut line, &mut Page::new(setup(3))).await;
    assert_eq!(line.ask(begin(1, setup(3))).await, ToPage::Finished { episode });
    // What a page sends on before it hears that is no offence.
    let mut page = Page::new(setup(3));
    line.say(FromPage::Chunk(page.fly(10)));
    assert!(matches!(line.ask(begin(2, setup(4))).await, ToPage::Begun { .. }));
    assert_eq!(disk.store.episodes(ListPage::newest(9)).await.unwrap().len(), 2);
}

#[tokio::test]
async fn a_second_connection_takes_the_flight_over() {
    let disk = Disk::new().await;
    let server = disk.server().await;
    let mut page = Page::new(setup(3));
    let mut first = Line::new(&server).await;
    let episode = episode_of(&first.ask(begin(1, setup(3))).await);
    first.ask(FromPage::Chunk(page.fly(50))).await;
    let mut second = Line::new(&server).await;
    assert_eq!(second.ask(begin(1, setup(3))).await, ToPage::Begun { episode, committed_tick: 50 });
    assert_eq!(first.closed().await, (1001, "another connection went on with this flight".into()));
    assert_eq!(fly_on(&mut second, &mut page).await, ToPage::Finished { episode });
}

#[tokio::test]
async fn a_tampered_log_is_refused_with_words_and_stays_refused() {
    let disk = Disk::new().await;
    let mut line = Line::new(&disk.server().await).await;
    let mut page = Page::new(setup(3));
    let episode = episode_of(&line.ask(begin(1, setup(3))).await);
    line.ask(FromPage::Chunk(page.fly(50))).await;
    let mut tampered = page.fly(50);
    tampered.digests.plant ^= 1;
    let ToPage::Refused { reason } = line.ask(FromPage::Chunk(tampered)).await else {
        panic!("it was believed")
    };
    assert!(reason.contains("tick 100") && reason.contains("differ"), "{reason}");
    line.say(FromPage::Chunk(page.fly(50)));
    line.say(FromPage::End(page.end()));
    assert_eq!(line.ask(begin(1, setup(3))).await, ToPage::Refused { reason: reason.clone() });
    let row = disk.store.episode(episode).await.unwrap().unwrap();
    assert_eq!(row.progress, Progress::Refused { reason });
    assert_eq!(disk.store.chunks(episode).await.unwrap().len(), 1);
    assert!(matches!(line.ask(begin(2, setup(4))).await, ToPage::Begun { .. }), "the next flight is welcome");
}

#[tokio::test]
async fn an_ending_that_was_not_reached_is_refused() {
    let disk = Disk::new().await;
    let mut line = Line::new(&disk.server().await).await;
    let mut page = Page::new(setup(3));
    line.ask(begin(1, setup(3))).await;
    line.ask(FromPage::Chunk(page.fly(50))).await;
    let end = crate::follow::End { ending: cohelm::plant::Ending::Goal, ..page.end() };
    assert!(matches!(line.ask(FromPage::End(end)).await, ToPage::Refused { .. }));
}

#[tokio::test]
async fn what_cannot_be_flown_here_is_refused_with_words() {
    let disk = Disk::new().await;
    let mut line = Line::new(&disk.server().await).await;
    let changed = |change: fn(&mut Setup)| {
        let mut setup = setup(1);
        change(&mut setup);
        setup
    };
    for (setup, words) in [
        (changed(|s| s.task.plant = "submarine".into()), "submarine"),
        (changed(|s| s.task.options = serde_json::json!({ "depth": 3 })), "options"),
        (changed(|s| s.plant_version = 99), "version"),
        (changed(|s| s.seed = u64::MAX), "seed"),
        (changed(|s| s.time_scale = 0.0), "time_scale"),
        (changed(|s| s.pilot = "x".repeat(65)), "pilot"),
        (changed(|s| s.values = Some("../../etc/passwd".into())), "SHA-256"),
        (changed(|s| s.values = Some("ab".repeat(32))), "abab"),
        (changed(|s| s.rule = cohelm::arbitration::Rule::Tolerance { alpha: 7.0 }), "α"),
    ] {
        let ToPage::Refused { reason } = line.ask(begin(1, setup)).await else {
            panic!("{words}: it was begun")
        };
        assert!(reason.contains(words), "{reason}");
    }
    assert_eq!(disk.store.episodes(ListPage::newest(9)).await.unwrap(), []);
}

#[tokio::test]
async fn a_key_with_another_setup_is_refused_and_the_flight_stays_as_it_is() {
    let disk = Disk::new().await;
    let server = disk.server().await;
    let mut page = Page::new(setup(3));
    let mut line = Line::new(&server).await;
    line.ask(begin(1, setup(3))).await;
    line.ask(FromPage::Chunk(page.fly(50))).await;
    line.cut().await;
    let mut line = Line::new(&server).await;
    assert!(matches!(line.ask(begin(1, setup(4))).await, ToPage::Refused { .. }));
    assert!(matches!(line.ask(begin(1, setup(3))).await, ToPage::Begun { committed_tick: 50, .. }));
}

#[tokio::test]
async fn a_page_that_goes_on_to_another_flight_leaves_the_first_to_be_taken_up_again() {
    let disk = Disk::new().await;
    let mut line = Line::new(&disk.server().await).await;
    let mut page = Page::new(setup(3));
    let left = episode_of(&line.ask(begin(1, setup(3))).await);
    line.ask(FromPage::Chunk(page.fly(50))).await;
    let empty = episode_of(&line.ask(begin(2, setup(4))).await);
    let next = episode_of(&line.ask(begin(3, setup(5))).await);
    let rows = disk.store.episodes(ListPage::newest(9)).await.unwrap();
    assert_eq!(rows.iter().map(|row| row.id).collect::<Vec<_>>(), [next, left], "{empty} never flew a tick");
    let again = line.ask(begin(1, setup(3))).await;
    assert_eq!(again, ToPage::Begun { episode: left, committed_tick: 50 });
    assert_eq!(fly_on(&mut line, &mut page).await, ToPage::Finished { episode: left });
}

#[tokio::test]
async fn messages_out_of_turn_close_the_connection_with_a_reason() {
    let disk = Disk::new().await;
    let server = disk.server().await;
    let mut page = Page::new(setup(3));
    let (chunk, end) = (page.fly(50), page.end());
    let later = page.fly(50);
    for (said, words) in [
        (vec![FromPage::Chunk(chunk.clone())], "has not begun"),
        (vec![FromPage::End(end)], "has not begun"),
        (vec![begin(3, setup(3)), FromPage::Chunk(later)], "send again from tick 0"),
    ] {
        let mut line = Line::new(&server).await;
        said.into_iter().for_each(|words| line.say(words));
        let (code, reason) = line.closed().await;
        assert_eq!(code, 1002, "{reason}");
        assert!(reason.contains(words), "{reason}");
    }
}

#[tokio::test]
async fn what_is_no_message_closes_the_connection_with_a_reason() {
    let disk = Disk::new().await;
    let server = disk.server().await;
    for (message, code, words) in [
        (Message::Text("hello".into()), 1003, "binary"),
        (Message::Binary(vec![1, 77].into()), 1002, "kind 77"),
        (Message::Binary(vec![9, 1].into()), 1002, "reload"),
        (Message::Binary(vec![].into()), 1002, "cut off"),
        (Message::Binary(vec![1; MAX_MESSAGE + 1].into()), 1009, "65536"),
    ] {
        let mut line = Line::new(&server).await;
        line.send(message);
        let (said, reason) = line.closed().await;
        assert_eq!(said, code, "{reason}");
        assert!(reason.contains(words) && reason.len() <= MAX_CLOSE_REASON, "{reason}");
    }
}

#[tokio::test]
async fn a_server_that_stops_says_so_and_what_it_had_begun_to_write_is_written() {
    let disk = Disk::new().await;
    let server = disk.server().await;
    let mut page = Page::new(setup(3));
    let mut line = Line::new(&server).await;
    let episode = episode_of(&line.ask(begin(1, setup(3))).await);
    line.ask(FromPage::Chunk(page.fly(50))).await;
    server.stop().await;
    assert_eq!(line.closed().await.0, 1001);

    let mut line = Line::new(&disk.server().await).await;
    assert_eq!(line.ask(begin(1, setup(3))).await, ToPage::Begun { episode, committed_tick: 50 });
}

#[tokio::test]
async fn a_database_that_cannot_be_written_closes_the_connection_and_loses_nothing() {
    let disk = Disk::new().await;
    let server = disk.server().await;
    let mut page = Page::new(setup(3));
    let mut line = Line::new(&server).await;
    let episode = episode_of(&line.ask(begin(1, setup(3))).await);
    line.ask(FromPage::Chunk(page.fly(50))).await;
    let other = crate::store::SqliteStore::open(&disk.folder.path().join("flights.db")).await.unwrap();
    let lock = other.lock_for_writing().await;
    line.say(FromPage::Chunk(page.fly(50)));
    let (code, reason) = line.closed().await;
    assert!(code == 1011 && reason.contains("locked"), "{code} {reason}");
    drop(lock);

    let mut line = Line::new(&server).await;
    assert_eq!(line.ask(begin(1, setup(3))).await, ToPage::Begun { episode, committed_tick: 50 });
    line.say(FromPage::Chunk(page.piece_since(50)));
    assert!(matches!(line.hear().await, ToPage::Ack { .. }));
    assert_eq!(fly_on(&mut line, &mut page).await, ToPage::Finished { episode });
}

#[tokio::test]
async fn a_silent_page_is_asked_and_then_taken_for_lost() {
    let disk = Disk::new().await;
    let server = disk.server().await;
    let mut line = Line::new(&server).await;
    tokio::time::pause();
    assert!(matches!(line.next().await, Message::Ping(_)));
    line.send(Message::Pong(Default::default()));
    let (asked, closed) = (Instant::now(), async {
        loop {
            match line.next().await {
                Message::Ping(_) => {}
                other => break other,
            }
        }
    });
    let closed = closed.await;
    assert!(matches!(closed, Message::Close(Some(frame)) if frame.code == 1001));
    assert_eq!(asked.elapsed().as_secs(), SILENCE.as_secs());
}

#[derive(Clone, Debug)]
enum Said {
    Begin(u8),
    Chunk { from: u32, to: u32, damage: bool },
    End,
    Bytes(Vec<u8>),
}

fn said() -> impl Strategy<Value = Said> {
    prop_oneof![
        (0_u8..3).prop_map(Said::Begin),
        (0_u32..120, 0_u32..120, prop::bool::weighted(0.1)).prop_map(|(from, to, damage)| Said::Chunk {
            from,
            to,
            damage
        }),
        Just(Said::End),
        prop::collection::vec(any::<u8>(), 0..40).prop_map(Said::Bytes),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Whatever a page says in whatever order, the server neither panics nor forgets a finished episode, and the next
    /// page is served.
    #[test]
    fn no_conversation_harms_the_server(conversation in prop::collection::vec(said(), 1..12)) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let disk = Disk::new().await;
            let server = disk.server().await;
            let mut line = Line::new(&server).await;
            let episode = episode_of(&line.ask(begin(100, setup(3))).await);
            let mut page = Page::new(setup(3));
            line.ask(FromPage::Chunk(page.fly(10_000))).await;
            line.ask(FromPage::End(page.end())).await;
            let mut page = Page::new(setup(3));
            page.fly(100);
            for said in conversation {
                match said {
                    Said::Begin(number) => line.say(begin(number, setup(3))),
                    Said::Chunk { from, to, damage } => {
                        let mut chunk = page.piece_since(from);
                        chunk.to_tick = to;
                        chunk.digests.plant ^= u64::from(damage);
                        line.say(FromPage::Chunk(chunk));
                    }
                    Said::End => line.say(FromPage::End(page.end())),
                    Said::Bytes(bytes) => line.send(Message::Binary(bytes.into())),
                }
            }
            line.cut().await;
            assert_eq!(stored(&disk, episode).await, flown(3));
            let mut line = Line::new(&server).await;
            assert!(matches!(line.ask(begin(200, setup(4))).await, ToPage::Begun { .. }));
        });
    }
}
