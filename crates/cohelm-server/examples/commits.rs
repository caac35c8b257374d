//! cargo run --release -p cohelm-server --example commits -- [DATABASE]
//!
//! Prints how many episodes and how many events of participants a database commits in a second: one a transaction, and
//! through the writer, which shares transactions. Without a name it makes a SQLite file and removes it; a database that is
//! named gets the episodes and the events, so name an empty one.

use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::flight::fly;
use cohelm::intent::Inference;
use cohelm::pilot::Silent;
use cohelm::point;
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::{Setup, Trajectory};
use cohelm_copilot::{Models, cockpit};
use cohelm_server::store::{ParticipantId, Record, Store, TokenHash, Write, Writer, open};
use futures_util::future::join_all;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Transactions of one change each.
const ALONE: u32 = 500;
/// Participants who write at the same time through the writer, and how often each of them does.
const PEOPLE: i64 = 500;
const EACH: u32 = 20;

#[tokio::main]
async fn main() -> Outcome<()> {
    let folder = tempfile::tempdir()?;
    let store = match std::env::args_os().nth(1) {
        Some(database) => open(database).await?,
        None => open(folder.path().join("commits.db")).await?,
    };
    let record = Record::new(&flown()?);
    let episode = Write::Episode { record, at_ms: 0 };
    let people = participants(store.as_ref()).await?;
    let alone: Vec<Write> = vec![episode.clone(); ALONE as usize];
    let of_one: Vec<Write> = (1..=ALONE).map(|seq| event(people[0], seq)).collect();
    say("episodes, one a transaction", ALONE, one_by_one(store.as_ref(), &alone)).await?;
    say("events, one a transaction", ALONE, one_by_one(store.as_ref(), &of_one)).await?;
    let together = PEOPLE as u32 * EACH;
    let episodes = vec![vec![episode; EACH as usize]; PEOPLE as usize];
    say("episodes, through the writer", together, through_the_writer(&store, episodes)).await?;
    let events = people.iter().skip(1).map(|id| (1..=EACH).map(|seq| event(*id, seq)).collect()).collect();
    say("events, through the writer", together, through_the_writer(&store, events)).await?;
    store.close().await;
    Ok(())
}

async fn say(what: &str, count: u32, work: impl Future<Output = Outcome<()>>) -> Outcome<()> {
    let began = Instant::now();
    work.await?;
    println!("{what}: {:.0} a second", f64::from(count) / began.elapsed().as_secs_f64());
    Ok(())
}

async fn one_by_one(store: &dyn Store, writes: &[Write]) -> Outcome<()> {
    for write in writes {
        store.commit(std::slice::from_ref(write)).await?;
    }
    Ok(())
}

/// Each of the lists in its order, one after the other; the lists beside each other, as people are.
async fn through_the_writer(store: &Arc<dyn Store>, lists: Vec<Vec<Write>>) -> Outcome<()> {
    let writer = Writer::start(store.clone());
    let write_list = |list: Vec<Write>| {
        let writer = writer.clone();
        async move {
            let handed_in = list.into_iter().map(|write| writer.write(vec![write]));
            join_all(handed_in).await.into_iter().collect::<Result<Vec<_>, _>>().map(drop)
        }
    };
    join_all(lists.into_iter().map(write_list)).await.into_iter().collect::<Result<(), _>>()?;
    Ok(())
}

/// One for the events that are committed alone, and those who write beside each other.
async fn participants(store: &dyn Store) -> Outcome<Vec<ParticipantId>> {
    let hash = "0".repeat(64);
    let study = Write::Study { hash: hash.clone(), name: "commits".into(), text: String::new(), at_ms: 0 };
    let first = store.free_participant_id().await?.0;
    let ids: Vec<ParticipantId> = (first..=first + PEOPLE).map(ParticipantId).collect();
    let participant = |id: &ParticipantId| {
        let mut token = TokenHash([0; 32]);
        token.0[..8].copy_from_slice(&id.0.to_le_bytes());
        Write::Participant { id: *id, study: hash.clone(), code: format!("c{id}"), token, at_ms: 0 }
    };
    let made: Vec<Write> = std::iter::once(study).chain(ids.iter().map(participant)).collect();
    store.commit(&made).await?;
    Ok(ids)
}

fn event(participant: ParticipantId, expected_seq: u32) -> Write {
    let event_json =
        r#"{"event":"step-done","step":"block-1/questionnaire/nasa-tlx","data":{"mental":55}}"#.into();
    Write::Event { participant, expected_seq, event_json, at_ms: 0 }
}

fn flown() -> Outcome<Trajectory> {
    let setup = Setup {
        task: Task::new("point"),
        plant_version: point::entry().version,
        seed: 1,
        rule: Rule::Hic,
        inference: Inference::Nearest,
        silence: Silence::Nothing,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: "person".into(),
    };
    let mut plants = Plants::default();
    plants.register(point::entry());
    let mut plant = plants.make(&setup.task)?;
    let mut cockpit = cockpit(&setup, plant.as_ref(), &plants, &Models::new())?;
    Ok(fly(setup, plant.as_mut(), &mut cockpit, &mut Silent, |_, _| {}))
}
