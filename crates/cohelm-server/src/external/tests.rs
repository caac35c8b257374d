//! The example in Python, flown from a page that these tests are, through a real socket.

use super::*;
use crate::hangar::Hangar;
use crate::serve::{bind, serve};
use crate::store::{Page as ListPage, Progress, Store, unpack};
use crate::testing::{Disk, buttons, pumps};
use crate::verify::verify_episodes;
use cohelm::keys::Change;
use cohelm::plant::Ending;
use cohelm::registry::Plants;
use cohelm::tape;
use cohelm::trajectory::{MAX_SEED, Trajectory};
use cohelm_copilot::Models;
use cohelm_external::other_end::answer;
use futures_util::{SinkExt, StreamExt};
use python::Python;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

#[path = "../../../cohelm-external/tests/support/python.rs"]
mod python;

/// A server that flies the example, and waits for it as long as a busy machine may take.
async fn flying(python: &Python) -> (Disk, SocketAddr) {
    flying_within(python, TimeOut::of_ms(2000).unwrap()).await
}

async fn flying_within(python: &Python, time_out: TimeOut) -> (Disk, SocketAddr) {
    let disk = Disk::new().await;
    let server = disk.server().await;
    let plant = Elsewhere::new(python.address.clone(), time_out);
    let address = run(server.with_plant_elsewhere(plant)).await;
    (disk, address)
}

/// Where a server listens from now on.
async fn run(server: Server) -> SocketAddr {
    let listener = bind("127.0.0.1:0".parse().unwrap()).await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(serve(listener, server, std::future::pending()));
    address
}

struct Page {
    socket: WebSocketStream<MaybeTlsStream<TcpStream>>,
}

impl Page {
    async fn open(address: SocketAddr) -> Self {
        let mut request = format!("ws://{address}/ws/external").into_client_request().unwrap();
        request.headers_mut().insert("Origin", format!("http://{address}").parse().unwrap());
        Self { socket: connect_async(request).await.unwrap().0 }
    }

    async fn say(&mut self, words: Value) {
        self.socket.send(Message::Text(words.to_string().into())).await.unwrap();
    }

    async fn hear(&mut self) -> Value {
        let heard = timeout(Duration::from_secs(20), self.socket.next()).await.expect("an answer in time");
        match heard.expect("a message").unwrap() {
            Message::Text(text) => serde_json::from_str(&text).unwrap(),
            other => panic!("expected a message, got {other:?}"),
        }
    }

    /// Says that the person is there and has seen that tick.
    async fn here(&mut self, tick: u64) {
        self.say(json!({ "here": { "shown": tick } })).await;
    }

    async fn stick(&mut self, position: i16) {
        let change = Change::Stick([position, 0, 0, 0]);
        self.say(json!({ "change": { "change": change, "at_ms": 0.0 } })).await;
    }

    /// The next tick, as it is told.
    async fn tick(&mut self) -> Value {
        let heard = self.hear().await;
        heard.get("tick").unwrap_or_else(|| panic!("expected a tick, got {heard}")).clone()
    }

    /// What comes until the flight has ended; gives how it did.
    async fn end(&mut self) -> Value {
        loop {
            if let Some(ended) = self.hear().await.get("ended") {
                return ended.clone();
            }
        }
    }

    async fn begin(&mut self, seed: u64, rule: &str) -> Value {
        let rule =
            if rule == "misc-r" { json!({ "rule": rule, "kappa": 0.7 }) } else { json!({ "rule": rule }) };
        self.say(json!({ "begin": { "seed": seed, "rule": rule } })).await;
        self.hear().await
    }

    /// Flies with the stick towards the goal; `each` is told every tick that came, and may do more.
    async fn fly(&mut self, ready: &Value, mut each: impl FnMut(u64)) -> Value {
        let own = &ready["ready"]["opening"]["pilot_goal"];
        let goals = ready["ready"]["opening"]["goals"].as_array().unwrap();
        let goal = goals.iter().find(|goal| goal["id"] == *own).unwrap()["position"][0].as_f64().unwrap();
        self.say(json!("start")).await;
        let mut before = 0.0;
        loop {
            let heard = self.hear().await;
            if heard.get("ended").is_some() {
                return heard["ended"].clone();
            }
            let report = &heard["tick"]["report"];
            let tick = report["tick"].as_u64().unwrap();
            let x = report["poses"][0]["x"].as_f64().unwrap();
            let push = (3.0 * (goal - x) - 150.0 * (x - before)).clamp(-1.0, 1.0);
            before = x;
            let change = Change::Stick([(push * 32767.0) as i16, 0, 0, 0]);
            self.say(json!({ "change": { "change": change, "at_ms": 20.0 * tick as f32 } })).await;
            self.here(tick).await;
            each(tick);
        }
    }

    /// Flies, and after some ticks says nothing more; gives how it ended.
    async fn fall_silent(&mut self, after: u64) -> Value {
        self.say(json!("start")).await;
        loop {
            let heard = self.hear().await;
            if heard.get("ended").is_some() {
                return heard["ended"].clone();
            }
            let tick = heard["tick"]["report"]["tick"].as_u64().unwrap();
            if tick < after {
                self.stick(20_000 + tick as i16).await;
                self.here(tick).await;
            }
        }
    }
}

/// The record of the newest episode, once it is finished.
async fn record(disk: &Disk) -> Trajectory {
    for _ in 0..200 {
        let rows = disk.store.episodes(ListPage::newest(1)).await.unwrap();
        if let Some(row) = rows.iter().find(|row| matches!(row.progress, Progress::Finished { .. })) {
            let packed = disk.store.record(row.id).await.unwrap().expect("a record");
            return Trajectory::from_bytes(&unpack(&packed).unwrap()).unwrap();
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    panic!("no episode was finished");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_flight_from_the_page_to_the_goal_is_stored_and_verified_from_its_states() {
    let python = Python::start();
    let (disk, address) = flying(&python).await;
    let mut page = Page::open(address).await;
    for (seed, rule) in [(1, "hic"), (2, "misc-r")] {
        let ready = page.begin(seed, rule).await;
        assert_eq!((&ready["ready"]["name"], &ready["ready"]["has_values"]), (&json!("cart"), &json!(false)));
        assert_eq!(ready["ready"]["opening"]["setup"]["rule"]["rule"], "hic", "alone without values");
        let ended = page.fly(&ready, |_| ()).await;
        assert_eq!((&ended["ending"], &ended["why"]), (&json!("goal"), &Value::Null), "{ended}");
        assert!(ended["episode"].is_i64() && ended["corrected"] == 0, "{ended}");
    }
    assert_eq!(record(&disk).await.ending, Ending::Goal);
    let report = verify_episodes(&disk.hangar()).await.unwrap();
    assert!(report.holds(), "{report}");
    assert_eq!((report.finished, report.as_recorded, report.identical), (2, 2, 0));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_plant_that_dies_in_mid_flight_ends_the_episode_and_the_next_may_begin() {
    let mut python = Python::start();
    let (disk, address) = flying(&python).await;
    let mut page = Page::open(address).await;
    let ready = page.begin(1, "hic").await;
    let ended = page.fly(&ready, |tick| {
        if tick >= 5 {
            python.child.kill().unwrap();
        }
    });
    let ended = ended.await;
    assert_eq!(
        (&ended["ending"], &ended["why"]),
        (&json!("abandoned"), &json!("the plant was lost: it closed the connection"))
    );
    let flown = record(&disk).await;
    assert_eq!(flown.tape.unwrap().lost(), Some("it closed the connection"));
    assert!(verify_episodes(&disk.hangar()).await.unwrap().holds());
    let refused = page.begin(1, "hic").await;
    assert!(refused["refused"]["reason"].as_str().unwrap().ends_with("start it first"), "{refused}");
}

#[tokio::test(flavor = "multi_thread")]
async fn who_falls_silent_lets_go_and_then_the_flight_ends() {
    let python = Python::start();
    let (disk, address) = flying(&python).await;
    let mut page = Page::open(address).await;
    page.begin(1, "hic").await;
    let ended = page.fall_silent(20).await;
    assert_eq!(ended["why"], "nothing was heard from the page for 2 s");
    let flown = record(&disk).await;
    assert_eq!(flown.keys.last().unwrap().change, Change::ReleaseAll);
    let neutral = flown.executed.iter().rev().take_while(|action| action.is_none()).count();
    // Two seconds of silence less three tenths, at fifty ticks a second; less where the machine is busy.
    assert!((10..=130).contains(&neutral), "{neutral} ticks with everything let go of");
    assert!(verify_episodes(&disk.hangar()).await.unwrap().holds());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_page_that_says_it_is_there_but_shows_nothing_is_not_flown_by() {
    let python = Python::start();
    let (disk, address) = flying(&python).await;
    let mut page = Page::open(address).await;
    page.begin(1, "hic").await;
    page.say(json!("start")).await;
    page.stick(3_500).await;
    let ended = loop {
        page.say(json!({ "here": { "shown": 0 } })).await;
        match timeout(Duration::from_millis(100), page.hear()).await {
            Ok(heard) if heard.get("ended").is_some() => break heard["ended"].clone(),
            _ => {}
        }
    };
    assert_eq!(ended["why"], "the page has shown nothing new for 2 s");
    assert_eq!(record(&disk).await.keys.last().unwrap().change, Change::ReleaseAll);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_page_that_is_closed_lets_go_and_its_flight_is_stored() {
    let python = Python::start();
    let (disk, address) = flying(&python).await;
    let mut page = Page::open(address).await;
    page.begin(1, "hic").await;
    page.say(json!("start")).await;
    page.say(json!({ "change": { "change": { "down": 1 }, "at_ms": 1.0 } })).await;
    for tick in 0..10 {
        page.hear().await;
        page.here(tick).await;
    }
    drop(page);
    let flown = record(&disk).await;
    assert_eq!(flown.ending, Ending::Abandoned);
    assert_eq!(flown.executed[flown.ticks() - 10..], [None; 10]);
}

#[tokio::test(flavor = "multi_thread")]
async fn one_page_flies_at_a_time_and_nonsense_ends_the_connection() {
    let python = Python::start();
    let (_disk, address) = flying(&python).await;
    let mut first = Page::open(address).await;
    assert!(first.begin(1, "hic").await.get("ready").is_some());
    let mut second = Page::open(address).await;
    let refused = second.begin(1, "hic").await;
    assert!(refused["refused"]["reason"].as_str().unwrap().starts_with("somebody else"), "{refused}");
    first.say(json!({ "fly": "me" })).await;
    assert!(matches!(first.socket.next().await, Some(Ok(Message::Close(_)) | Err(_)) | None));
    tokio::time::sleep(Duration::from_millis(200)).await;
    assert!(second.begin(1, "hic").await.get("ready").is_some());
}

/// The buttons elsewhere, and a server that has a model whose card is for a plant of that name.
#[tokio::test(flavor = "multi_thread")]
async fn values_assist_a_plant_elsewhere_whose_name_and_shape_their_card_has() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let elsewhere = listener.local_addr().unwrap().to_string().parse().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut plant = (buttons::entry().make)(&json!({})).unwrap();
            let _ = answer(plant.as_mut(), "buttons", stream.unwrap());
        }
    });
    let (fits, other) = (tape::task("buttons"), tape::task("cart"));
    let model = buttons::model_for(1, fits, tape::VERSION);
    let mut models = Models::new();
    models.add_model(model.clone());
    models.add_model(buttons::model_for(2, other, tape::VERSION));
    let disk = Disk::new().await;
    let server = disk.server_of(models.clone()).await;
    let address =
        run(server.with_plant_elsewhere(Elsewhere::new(elsewhere, TimeOut::of_ms(2000).unwrap()))).await;
    let mut page = Page::open(address).await;
    let ready = page.begin(3, "misc-r").await;
    assert_eq!(ready["ready"]["has_values"], true, "{ready}");
    assert_eq!(ready["ready"]["opening"]["setup"]["values"], model.hash());
    page.say(json!("start")).await;
    page.say(json!({ "change": { "change": { "down": 0 }, "at_ms": 1.0 } })).await;
    // A busy machine leaves ticks out, so they are not counted by what is told.
    let mut seen = 0;
    while seen < 20 {
        let report = page.tick().await["report"].clone();
        assert_eq!(report["candidates"].as_array().unwrap().len(), 5);
        seen = report["tick"].as_u64().unwrap();
        page.here(seen).await;
    }
    page.say(json!("stop")).await;
    let flown = record(&disk).await;
    assert!(flown.executed.iter().zip(&flown.asked).any(|(done, asked)| done != asked), "it was corrected");
    let hangar = Hangar::new(Plants::default(), models, disk.store.clone());
    let report = verify_episodes(&hangar).await.unwrap();
    assert_eq!((report.as_recorded, report.holds()), (1, true), "{report}");
}

#[tokio::test(flavor = "multi_thread")]
async fn who_comes_back_is_told_that_everything_was_let_go_of_before_anything_counts_again() {
    let python = Python::start();
    let (disk, address) = flying(&python).await;
    let mut page = Page::open(address).await;
    page.begin(1, "hic").await;
    page.say(json!("start")).await;
    page.stick(3_500).await;
    for _ in 0..5 {
        let tick = page.tick().await;
        assert_eq!(tick["let_go"], false);
        page.here(tick["report"]["tick"].as_u64().unwrap()).await;
    }
    // Nothing is said until it is let go of, and then nothing newer is shown; a stick that moves is no sign of anybody.
    let mut seen = 0;
    let mut last = Value::Null;
    while timeout(Duration::from_millis(400), async { last = page.tick().await }).await.is_ok() {
        seen += 1;
    }
    assert!(seen <= 5, "{seen} ticks were sent that nobody said to have seen");
    for _ in 0..5 {
        page.stick(3_600).await;
        page.say(json!({ "here": { "shown": 4 } })).await;
        tokio::time::sleep(Duration::from_millis(80)).await;
    }
    page.here(last["report"]["tick"].as_u64().unwrap()).await;
    let mut tick = page.tick().await;
    assert_eq!((&tick["let_go"], &tick["report"]["asked"]), (&json!(true), &Value::Null), "{tick}");
    page.stick(3_700).await;
    while tick["let_go"] == true {
        page.here(tick["report"]["tick"].as_u64().unwrap()).await;
        tick = page.tick().await;
    }
    for _ in 0..10 {
        page.stick(3_800).await;
        page.here(tick["report"]["tick"].as_u64().unwrap()).await;
        tick = page.tick().await;
    }
    assert_eq!((&tick["let_go"], tick["report"]["asked"].is_null()), (&json!(false), false), "{tick}");
    page.say(json!("stop")).await;
    assert_eq!(page.end().await["why"], Value::Null);
    let keys = record(&disk).await.keys;
    let release = keys.iter().position(|event| event.change == Change::ReleaseAll).unwrap();
    let after =
        keys[release..].iter().filter(|event| event.change == Change::Stick([3_600, 0, 0, 0])).count();
    assert_eq!(after, 0, "{keys:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stop_on_the_ground_keeps_the_plant_ready_and_a_start_without_one_is_answered() {
    let python = Python::start();
    let (_disk, address) = flying(&python).await;
    let mut page = Page::open(address).await;
    page.say(json!("start")).await;
    assert_eq!(page.hear().await, json!({ "refused": { "reason": "no plant is ready; try again" } }));
    page.begin(1, "hic").await;
    page.say(json!("stop")).await;
    page.say(json!("start")).await;
    assert_eq!(page.tick().await["report"]["tick"], 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_seed_that_a_record_cannot_hold_is_refused() {
    let python = Python::start();
    let (_disk, address) = flying(&python).await;
    let mut page = Page::open(address).await;
    let refused = page.begin(MAX_SEED + 1, "hic").await;
    assert!(
        refused["refused"]["reason"].as_str().unwrap().starts_with("expected a seed of at most"),
        "{refused}"
    );
    let ready = page.begin(MAX_SEED, "hic").await;
    assert_eq!(ready["ready"]["opening"]["setup"]["seed"], MAX_SEED);
}

#[tokio::test(flavor = "multi_thread")]
async fn two_ticks_a_second_are_flown_with_the_usual_time_out() {
    let python = Python::start_with(&["--ticks-per-second", "2"]);
    let (_disk, address) = flying_within(&python, TimeOut::default()).await;
    let mut page = Page::open(address).await;
    page.begin(1, "hic").await;
    page.say(json!("start")).await;
    let begun = Instant::now();
    let mut seen = None;
    while begun.elapsed() < Duration::from_millis(2500) {
        if let Ok(tick) = timeout(Duration::from_millis(100), page.tick()).await {
            assert_eq!((&tick["report"]["ending"], &tick["let_go"]), (&Value::Null, &json!(false)), "{tick}");
            seen = tick["report"]["tick"].as_u64();
        }
        page.say(json!({ "here": { "shown": seen } })).await;
    }
    assert!(seen.is_some_and(|tick| tick >= 3), "{seen:?}");
    page.say(json!("stop")).await;
    let ended = page.end().await;
    assert_eq!((&ended["ending"], &ended["why"]), (&json!("abandoned"), &Value::Null));
}

/// Letting go of a switch asks for *off*, and a rule with values that always prefer *on* would not carry it out.
#[tokio::test(flavor = "multi_thread")]
async fn letting_go_turns_switches_off_whatever_values_prefer() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let elsewhere = listener.local_addr().unwrap().to_string().parse().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let _ = answer(&mut pumps::Pumps::new(), "pumps", stream.unwrap());
        }
    });
    let mut models = Models::new();
    models.add_model(pumps::model_that_prefers_on(tape::task("pumps"), tape::VERSION));
    let disk = Disk::new().await;
    let server = disk.server_of(models).await;
    let address =
        run(server.with_plant_elsewhere(Elsewhere::new(elsewhere, TimeOut::of_ms(2000).unwrap()))).await;
    let mut page = Page::open(address).await;
    page.say(json!({ "begin": { "seed": 3, "rule": { "rule": "tolerance", "alpha": 0.0 } } })).await;
    let ready = page.hear().await;
    page.say(json!("start")).await;
    page.say(json!({ "change": { "change": { "down": 0 }, "at_ms": 1.0 } })).await;
    for _ in 0..10 {
        let tick = page.tick().await;
        page.here(tick["report"]["tick"].as_u64().unwrap()).await;
    }
    drop(page);
    let flown = record(&disk).await;
    let seen = flown.tape.as_ref().unwrap().seen();
    assert!(seen.iter().any(|seen| seen.switches == 1), "it was on: {:?}", flown.executed);
    assert_eq!(seen.last().unwrap().switches, 0, "{:?}", flown.executed);
    let why = ready["ready"]["why_alone"].as_str().unwrap();
    assert!(ready["ready"]["has_values"] == false && why.starts_with("this plant has switches"), "{why}");
}

#[tokio::test]
async fn without_a_plant_elsewhere_there_is_none_to_fly() {
    let server = Disk::new().await.server().await;
    assert_eq!(about(State(server)).await.0, json!({ "external": null }));
}
