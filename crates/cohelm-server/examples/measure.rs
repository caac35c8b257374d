//! cargo run --release -p cohelm-server --example measure -- [PAGES] [SECONDS]
//!
//! Prints how many episodes a second the database commits, one a transaction and together, and how long a page waits
//! for the acknowledgement of a second of flight, with pages that fly the point on an absolute schedule over real
//! sockets. Pages and server share this process and its cores.

use cohelm::arbitration::Rule;
use cohelm::cockpit::{Cockpit, Silence};
use cohelm::flight::{Flight, fly};
use cohelm::intent::Inference;
use cohelm::keys::Change;
use cohelm::pilot::Silent;
use cohelm::point;
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::{Setup, Trajectory, put_event};
use cohelm_copilot::{Models, cockpit};
use cohelm_server::follow::End;
use cohelm_server::hosts::Hosts;
use cohelm_server::page::Assets;
use cohelm_server::protocol::{Begin, FromPage, ToPage};
use cohelm_server::store::{Chunk, FlightKey, Record, SqliteStore, Store, Write, Writer};
use cohelm_server::{Parts, Server, bind, serve};
use futures_util::{SinkExt, StreamExt, future::join_all};
use std::error::Error;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::time::sleep_until;
use tokio_tungstenite::connect_async;
use tokio_tungstenite::tungstenite::{Message, client::IntoClientRequest};

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

#[tokio::main]
async fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u32>());
    let pages = arguments.next().transpose()?.unwrap_or(100);
    let seconds = arguments.next().transpose()?.unwrap_or(8);
    let folder = tempfile::tempdir()?;
    let store: Arc<dyn Store> = Arc::new(SqliteStore::open(&folder.path().join("flights.db")).await?);
    commits(&store).await?;
    acknowledgements(store, 1, seconds).await?;
    let store: Arc<dyn Store> = Arc::new(SqliteStore::open(&folder.path().join("more.db")).await?);
    acknowledgements(store, pages, seconds).await
}

async fn commits(store: &Arc<dyn Store>) -> Outcome<()> {
    let record = Record::new(&flown()?);
    let write = || vec![Write::Episode { record: record.clone(), at_ms: 0 }];
    let began = Instant::now();
    for _ in 0..300 {
        store.commit(&write()).await?;
    }
    println!("episodes committed one a transaction: {:.0} a second", 300.0 / began.elapsed().as_secs_f64());
    let writer = Writer::start(store.clone());
    let began = Instant::now();
    for committed in join_all((0..4_000).map(|_| writer.write(write()))).await {
        committed?;
    }
    println!(
        "episodes committed through the writer: {:.0} a second",
        4_000.0 / began.elapsed().as_secs_f64()
    );
    Ok(())
}

async fn acknowledgements(store: Arc<dyn Store>, pages: u32, seconds: u32) -> Outcome<()> {
    let parts = Parts {
        store,
        plants: plants(),
        models: Models::new(),
        lessons: None,
        hosts: Hosts::loopback(),
        assets: Assets::embedded(),
        study: None,
    };
    let listener = bind("127.0.0.1:0".parse()?).await?;
    let address = listener.local_addr()?;
    let served = tokio::spawn(serve(listener, Server::start(parts).await?, std::future::pending()));
    let begin = Instant::now() + Duration::from_millis(500);
    let flights = (0..pages).map(|number| {
        // Spread over a second, as people are.
        let begin = begin + Duration::from_secs_f64(f64::from(number) / f64::from(pages));
        tokio::spawn(page(address, number, begin, seconds))
    });
    let mut waits_ms = Vec::new();
    for flight in join_all(flights).await {
        waits_ms.extend(flight??);
    }
    served.abort();
    waits_ms.sort_by(f64::total_cmp);
    let at = |part: f64| waits_ms[((waits_ms.len() - 1) as f64 * part) as usize];
    let (count, p50, p99, most) = (waits_ms.len(), at(0.5), at(0.99), at(1.0));
    println!(
        "{pages} pages, {count} acknowledgements: p50 {p50:.1} ms, p99 {p99:.1} ms, longest {most:.1} ms"
    );
    Ok(())
}

/// Flies in real time; gives the waits for acknowledgements, milliseconds.
async fn page(address: SocketAddr, number: u32, begin: Instant, seconds: u32) -> Outcome<Vec<f64>> {
    let mut request = format!("ws://{address}/ws").into_client_request()?;
    request.headers_mut().insert("Origin", format!("http://{address}").parse()?);
    let (mut socket, _) = connect_async(request).await?;
    let mut key = [0; 16];
    key[..4].copy_from_slice(&number.to_le_bytes());
    let mut flight = flight(number.into())?;
    let begun = Begin { key: FlightKey(key), age_ms: 0, setup: flight.setup().clone() };
    socket.send(Message::Binary(FromPage::Begin(begun).to_bytes().into())).await?;
    let mut waits_ms = Vec::new();
    for second in 1..=seconds {
        let chunk = fly_a_second(&mut flight);
        let due = begin + Duration::from_secs(second.into());
        sleep_until(due.into()).await;
        socket.send(Message::Binary(FromPage::Chunk(chunk).to_bytes().into())).await?;
        loop {
            let Message::Binary(bytes) = socket.next().await.ok_or("closed")?? else { continue };
            match ToPage::from_bytes(&bytes)? {
                ToPage::Ack { .. } => break,
                ToPage::Refused { reason } => return Err(reason.into()),
                _ => {}
            }
        }
        waits_ms.push(due.elapsed().as_secs_f64() * 1e3);
        if flight.ending().is_some() {
            break;
        }
    }
    let ending = flight.ending().unwrap_or(cohelm::plant::Ending::Abandoned);
    let end = End { ticks: flight.ticks(), ending, digests: flight.digests() };
    socket.send(Message::Binary(FromPage::End(end).to_bytes().into())).await?;
    while let Some(Ok(message)) = socket.next().await {
        let Message::Binary(bytes) = message else { continue };
        if matches!(ToPage::from_bytes(&bytes)?, ToPage::Finished { .. }) {
            return Ok(waits_ms);
        }
    }
    Err("the flight was not finished".into())
}

fn fly_a_second(flight: &mut Flight) -> Chunk {
    let from_tick = flight.ticks();
    for _ in 0..50 {
        let tick = flight.ticks();
        // A little to the left, a little to the right, so that the point stays where it may be.
        match tick % 20 {
            3 => flight.change(Change::Down(0), tick as f32 * 20.0),
            13 => flight.change(Change::Down(1), tick as f32 * 20.0),
            6 | 16 => flight.change(Change::ReleaseAll, tick as f32 * 20.0),
            _ => {}
        }
        if flight.tick().is_none() {
            break;
        }
    }
    let mut events = Vec::new();
    flight
        .keys()
        .iter()
        .filter(|event| event.tick >= from_tick)
        .for_each(|event| put_event(&mut events, event));
    Chunk { from_tick, to_tick: flight.ticks(), digests: flight.digests(), events }
}

fn plants() -> Plants {
    let mut plants = Plants::default();
    plants.register(point::entry());
    plants
}

fn setup(seed: u64) -> Setup {
    Setup {
        task: Task::new("point"),
        plant_version: point::entry().version,
        seed,
        rule: Rule::Hic,
        inference: Inference::Nearest,
        silence: Silence::Nothing,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: "person".into(),
    }
}

fn cockpit_of(setup: &Setup) -> Outcome<Cockpit> {
    let plants = plants();
    Ok(cockpit(setup, plants.make(&setup.task)?.as_ref(), &plants, &Models::new())?)
}

fn flight(seed: u64) -> Outcome<Flight> {
    let setup = setup(seed);
    let cockpit = cockpit_of(&setup)?;
    Ok(Flight::new(setup.clone(), plants().make(&setup.task)?, cockpit))
}

fn flown() -> Outcome<Trajectory> {
    let setup = setup(1);
    let (mut plant, mut cockpit) = (plants().make(&setup.task)?, cockpit_of(&setup)?);
    Ok(fly(setup, plant.as_mut(), &mut cockpit, &mut Silent, |_, _| {}))
}
