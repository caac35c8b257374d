//! Sessions that do not go straight on: other tabs, lost flights, refused ones, somebody who leaves for good.

use crate::protocol::{FromPage, ToPage};
use crate::store::{ParticipantId, Progress, SqliteStore, Store, Studies};
use crate::study::testing::line::{Line, begin, flight, fly, listen, until_flight};
use crate::study::testing::{Browser, STUDY, running, some_answer, start};
use crate::testing::{Disk, Page};
use axum::http::StatusCode;
use cohelm::trajectory::read_events;
use serde_json::json;

const FIRST: ParticipantId = ParticipantId(1);

/// The words of the events that are stored.
async fn log(disk: &Disk) -> Vec<String> {
    let word = |json: &str| {
        serde_json::from_str::<serde_json::Value>(json).unwrap()["event"].as_str().unwrap().to_owned()
    };
    disk.store.events(FIRST, 0).await.unwrap().iter().map(|event| word(&event.json)).collect()
}

#[tokio::test]
async fn one_tab_is_live_and_another_takes_over_cleanly() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let address = listen(&server).await;
    let mut old = Browser::participant(&server).await;
    let mut line = Line::connect(address, &old).await.unwrap();
    line.hear().await;
    let mut new = Browser { tab: "tab-2".into(), ..old.clone() };
    new.open().await;
    assert_eq!(line.closed().await.0, 4001);
    let late = old.answer("consent", json!({ "agreed": true })).await;
    assert_eq!((late.status, &late.json()["taken_over"]), (StatusCode::CONFLICT, &true.into()));
    assert!(late.error().contains("another tab"), "{}", late.error());
    // What only tells where things stand is answered in any tab; a socket of the old one closes at once.
    assert_eq!(old.get("/api/session").await.status, StatusCode::OK);
    assert_eq!(Line::connect(address, &old).await.unwrap().closed().await.0, 4001);
    assert_eq!(new.answer("consent", json!({ "agreed": true })).await.status, StatusCode::OK);
    assert_eq!(log(&disk).await, ["invited", "opened", "taken-over", "opened", "step-done", "assigned"]);
}

#[tokio::test]
async fn an_answer_comes_twice_and_counts_once_and_one_out_of_turn_says_where_the_session_is() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let mut browser = Browser::participant(&server).await;
    let early = browser.answer("device", json!({})).await;
    assert_eq!(
        (early.status, &early.json()["session"]["steps"][0]["id"]),
        (StatusCode::CONFLICT, &"consent".into())
    );
    for _ in 0..2 {
        let answer = browser.answer("consent", json!({ "agreed": true })).await;
        assert_eq!((answer.status, &answer.json()["place"]), (StatusCode::OK, &1.into()));
    }
    browser.answer("device", json!({})).await;
    let young = browser.answer("demographics", json!({ "age": 7 })).await;
    assert_eq!(young.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert_eq!(young.json()["items"]["age"], "out-of-range");
    browser.answer("demographics", json!({ "age": 70 })).await;
    browser.answer("instructions", json!({})).await;
    let wrong = browser.answer("quiz", json!({ "goal": "elsewhere" })).await;
    assert_eq!((wrong.status, &wrong.json()["wrong"]), (StatusCode::OK, &json!(["goal"])));
    assert!(!wrong.json().to_string().contains("\"right\":\"there\""), "the answer stays with the server");
    assert_eq!(browser.answer("nonsense/step", json!({})).await.status, StatusCode::CONFLICT);
}

#[tokio::test]
async fn a_flight_goes_on_from_what_is_committed_after_the_page_and_the_server_were_lost() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let address = listen(&server).await;
    let mut browser = Browser::participant(&server).await;
    let session = until_flight(&mut browser).await;
    let (key, setup) = flight(&session);
    let mut line = Line::connect(address, &browser).await.unwrap();
    line.hear().await;
    let mut page = Page::new(setup.clone());
    let ToPage::Begun { episode, .. } = line.ask(begin(key, &setup)).await else { panic!("not begun") };
    line.ask(FromPage::Chunk(page.fly(60))).await;
    drop((line, page));

    let server = running(&disk).await;
    let address = listen(&server).await;
    let mut browser = Browser { tab: "after".into(), cookies: browser.cookies, ..Browser::new(&server) };
    let session = browser.open().await;
    assert_eq!(
        (&session["steps"][0]["committed_ticks"], flight(&session)),
        (&60.into(), (key, setup.clone()))
    );
    let path = format!("/api/session/flight/{}", session["steps"][0]["flight_key"].as_str().unwrap());
    let bytes = browser.get(&path).await.body;
    let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
    assert_eq!(serde_json::from_slice::<cohelm::trajectory::Setup>(&bytes[4..4 + length]).unwrap(), setup);
    assert_eq!(bytes[4 + length..8 + length], 60_u32.to_le_bytes());
    let mut page = Page::new(setup.clone());
    let again = page.fly(60);
    assert_eq!(read_events(&bytes[8 + length..]).unwrap(), read_events(&again.events).unwrap());
    for note in [
        json!({ "interrupted": { "tick": 60, "reason": "reload" } }),
        json!({ "resumed": { "tick": 60, "source": "server", "away_ms": 900 } }),
    ] {
        let mut note = note;
        note["tab"] = "after".into();
        assert_eq!(browser.post(&path, note).await.status, StatusCode::OK);
    }
    let mut line = Line::connect(address, &browser).await.unwrap();
    line.hear().await;
    assert_eq!(line.ask(begin(key, &setup)).await, ToPage::Begun { episode, committed_tick: 60 });
    line.ask(FromPage::Chunk(page.fly(10_000))).await;
    assert_eq!(line.ask(FromPage::End(page.end())).await, ToPage::Finished { episode });
    // Only the answer was lost: the flight is over, whoever asks.
    assert_eq!(line.ask(begin(key, &setup)).await, ToPage::Finished { episode });
    let log = log(&disk).await;
    let since: Vec<&str> =
        log.iter().skip_while(|word| *word != "flight-begun").map(String::as_str).collect();
    let expected =
        ["flight-begun", "taken-over", "opened", "flight-interrupted", "flight-resumed", "flight-ended"];
    assert_eq!(since, expected);
}

#[tokio::test]
async fn a_flight_that_is_not_believed_is_flown_again_under_another_key() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let address = listen(&server).await;
    let mut browser = Browser::participant(&server).await;
    let session = until_flight(&mut browser).await;
    let (key, setup) = flight(&session);
    let mut line = Line::connect(address, &browser).await.unwrap();
    line.hear().await;
    line.ask(begin(key, &setup)).await;
    let mut chunk = Page::new(setup.clone()).fly(50);
    chunk.digests.plant ^= 1;
    assert!(matches!(line.ask(FromPage::Chunk(chunk)).await, ToPage::Refused { .. }));
    let again = browser.get("/api/session").await.json();
    assert_eq!(
        (&again["steps"][0]["attempt"], &again["steps"][0]["id"]),
        (&2.into(), &session["steps"][0]["id"])
    );
    assert_ne!(flight(&again).0, key);
    assert!(
        matches!(line.ask(begin(key, &setup)).await, ToPage::Refused { .. }),
        "the old key is of no more use"
    );
    fly(&mut line, &again).await;
    let trials = disk.store.trials(FIRST).await.unwrap();
    assert!(matches!(trials[0].progress, Progress::Refused { .. }) && trials.len() == 2);
}

#[tokio::test]
async fn only_the_flight_that_is_due_may_be_flown_and_only_by_its_participant() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let address = listen(&server).await;
    let mut browser = Browser::participant(&server).await;
    let session = until_flight(&mut browser).await;
    let (key, setup) = flight(&session);
    let mut line = Line::connect(address, &browser).await.unwrap();
    line.hear().await;
    for (key, setup) in [
        (crate::testing::key(9), setup.clone()),
        (key, cohelm::trajectory::Setup { seed: setup.seed ^ 1, ..setup.clone() }),
        (key, cohelm::trajectory::Setup { rule: cohelm::arbitration::Rule::Robot, ..setup.clone() }),
    ] {
        let answer = line.ask(begin(key, &setup)).await;
        assert!(matches!(answer, ToPage::Refused { .. }), "{answer:?}");
    }
    let mut other = Browser { tab: "other".into(), ..Browser::new(&server) };
    other.get("/join?PROLIFIC_PID=aaaaaaaaaaaaaaaaaaaaaaaa").await;
    other.open().await;
    let mut others = Line::connect(address, &other).await.unwrap();
    others.hear().await;
    assert!(matches!(others.ask(begin(key, &setup)).await, ToPage::Refused { .. }));
    let path = format!("/api/session/flight/{}", session["steps"][0]["flight_key"].as_str().unwrap());
    assert_eq!(other.get(&path).await.status, StatusCode::NOT_FOUND);
    assert!(disk.store.trials(FIRST).await.unwrap().is_empty(), "nothing was begun");
    assert!(Line::connect(address, &Browser::new(&server)).await.is_err(), "nobody without a link flies");
}

#[tokio::test]
async fn who_withdraws_leaves_nothing_but_that_somebody_did() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let address = listen(&server).await;
    let mut browser = Browser::participant(&server).await;
    let session = until_flight(&mut browser).await;
    let mut line = Line::connect(address, &browser).await.unwrap();
    line.hear().await;
    let episode = fly(&mut line, &session).await;
    let cookies = browser.cookies.clone();
    let answer = browser.post("/api/session/withdraw", json!({ "tab": "tab-1" })).await;
    assert_eq!((answer.status, &answer.json()["status"]), (StatusCode::OK, &"withdrawn".into()));
    assert_eq!(line.closed().await.0, 4003);
    assert!(browser.cookies.is_empty());
    browser.cookies = cookies;
    assert_eq!(browser.get("/api/session").await.status, StatusCode::UNAUTHORIZED);
    assert_eq!(log(&disk).await, ["invited", "withdrawn"]);
    assert!(disk.store.episode(crate::store::EpisodeId(episode)).await.unwrap().is_none());
    let row = Browser::researcher(&server).await.get("/api/desk/participants").await.json()["participants"]
        [0]
    .clone();
    assert_eq!((&row["status"], &row["endings"]), (&"withdrawn".into(), &json!({})));
}

#[tokio::test]
async fn the_panel_and_the_open_link_know_who_comes_again() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let mut first = Browser::new(&server);
    first.get("/join?PROLIFIC_PID=5f3a9c0d1e2b4a6788990011").await;
    let code = first.open().await["participant"]["code"].clone();
    first.answer("consent", json!({ "agreed": true })).await;
    first.get("/join").await;
    assert_eq!(first.open().await["participant"]["code"], code, "the browser is known");
    let mut second = Browser { tab: "elsewhere".into(), ..Browser::new(&server) };
    second.get("/join?PROLIFIC_PID=5f3a9c0d1e2b4a6788990011").await;
    let there = second.open().await;
    assert_eq!(
        (&there["participant"]["code"], &there["place"]),
        (&code, &1.into()),
        "the name proves who it is"
    );
    assert_eq!(
        first.get("/api/session").await.status,
        StatusCode::UNAUTHORIZED,
        "the link is the new browser's"
    );
    Browser::new(&server).get("/join?PROLIFIC_PID=123").await;
    let guessed = Browser::new(&server).get("/join?PROLIFIC_PID=123").await;
    assert_eq!(guessed.status, StatusCode::CONFLICT, "a short name could be guessed");
    let long = format!("/join?PROLIFIC_PID={}", "x".repeat(300));
    assert_eq!(Browser::new(&server).get(&long).await.status, StatusCode::BAD_REQUEST);
    let (without_panel, _) = STUDY.split_once("[panel]").unwrap();
    let text = without_panel.replace("open-link = true", "open-link = false");
    let closed = start(&disk, &text, "http://localhost:1234").await;
    assert_eq!(Browser::new(&closed).get("/join").await.status, StatusCode::FORBIDDEN);
}

#[tokio::test]
async fn a_study_that_cannot_write_pauses_says_so_and_goes_on() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let mut browser = Browser::participant(&server).await;
    let other = SqliteStore::open(&disk.folder.path().join("flights.db")).await.unwrap();
    let lock = other.lock_for_writing().await;
    let answer = browser.answer("consent", json!({ "agreed": true })).await;
    assert_eq!((answer.status, &answer.json()["paused"]), (StatusCode::SERVICE_UNAVAILABLE, &true.into()));
    assert!(
        answer.error().contains("nothing is lost") && answer.error().contains("locked"),
        "{}",
        answer.error()
    );
    assert!(answer.headers.contains_key("retry-after"));
    drop(lock);
    let answer = browser.answer("consent", json!({ "agreed": true })).await;
    assert_eq!((answer.status, &answer.json()["place"]), (StatusCode::OK, &1.into()));
    assert_eq!(log(&disk).await, ["invited", "opened", "step-done", "assigned"]);
}

#[tokio::test]
async fn orders_are_given_out_evenly_to_people_who_come_at_once() {
    let disk = Disk::new().await;
    let server = running(&disk).await;
    let come = |number: usize| {
        let server = server.clone();
        async move {
            let mut browser = Browser { tab: number.to_string(), ..Browser::new(&server) };
            browser.get("/join").await;
            browser.open().await;
            let step = json!({ "kind": "consent" });
            assert_eq!(browser.answer("consent", some_answer(&step)).await.status, StatusCode::OK);
        }
    };
    futures_util::future::join_all((0..20).map(come)).await;
    let study = Browser::researcher(&server).await.get("/api/desk/study").await.json();
    let at_it: Vec<_> =
        study["cells"].as_array().unwrap().iter().map(|cell| cell["in_progress"].clone()).collect();
    assert_eq!(at_it, [json!(10), json!(10)]);
}
