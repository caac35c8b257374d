//! What the tests of this crate share: a page that flies the point, and a database in a folder of its own.

pub mod buttons;
pub mod pumps;

use crate::follow::End;
use crate::hangar::Hangar;
use crate::hosts::Hosts;
use crate::learn::Lessons;
use crate::page::Assets;
use crate::server::{Parts, Server};
use crate::store::{Chunk, FlightKey, Record, SqliteStore, Store};
use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::flight::Flight;
use cohelm::intent::Inference;
use cohelm::keys::Change;
use cohelm::plant::Ending;
use cohelm::point;
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::{Setup, Trajectory, put_event};
use cohelm_copilot::{Model, Models};
use std::sync::Arc;

pub fn plants() -> Plants {
    let mut plants = Plants::default();
    plants.register(point::entry());
    plants.register(buttons::entry());
    plants
}

pub fn setup(seed: u64) -> Setup {
    Setup {
        task: Task::new("point"),
        plant_version: point::entry().version,
        seed,
        rule: Rule::Tolerance { alpha: 0.6 },
        inference: Inference::Known,
        silence: Silence::Best,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: "person".into(),
    }
}

/// A flight of the buttons that a model assists.
pub fn assisted(seed: u64, model: &Model) -> Setup {
    Setup {
        task: Task::new("buttons"),
        plant_version: buttons::entry().version,
        values: Some(model.hash().into()),
        ..setup(seed)
    }
}

pub fn key(number: u8) -> FlightKey {
    FlightKey([number; 16])
}

/// The beginning of a flight.
pub fn flight(setup: Setup) -> Flight {
    flight_with(setup, &Models::new())
}

fn flight_with(setup: Setup, models: &Models) -> Flight {
    let plants = plants();
    let plant = plants.make(&setup.task).unwrap();
    let cockpit = cohelm_copilot::cockpit(&setup, plant.as_ref(), &plants, models).unwrap();
    Flight::new(setup, plant, cockpit)
}

/// A page: the same flight, and the log that it would send.
pub struct Page {
    flight: Flight,
    sent: u32,
}

impl Page {
    pub fn new(setup: Setup) -> Self {
        Self { flight: flight(setup), sent: 0 }
    }

    /// A page that was given models.
    pub fn with(setup: Setup, models: &Models) -> Self {
        Self { flight: flight_with(setup, models), sent: 0 }
    }

    /// Flies up to so many ticks with scripted keys; gives the piece of the log since the last time.
    pub fn fly(&mut self, ticks: u32) -> Chunk {
        for _ in 0..ticks {
            let tick = self.flight.ticks();
            match tick % 40 {
                5 => self.flight.change(Change::Down(3), tick as f32 * 20.0),
                25 => self.flight.change(Change::Up(3), tick as f32 * 20.0),
                30 => self.flight.change(Change::Stick([9_000, -4_000, 0, 0]), tick as f32 * 20.0),
                38 => self.flight.change(Change::ReleaseAll, tick as f32 * 20.0),
                _ => {}
            }
            if self.flight.tick().is_none() {
                break;
            }
        }
        self.piece_since(self.sent)
    }

    /// The piece of the log from a tick on.
    pub fn piece_since(&mut self, from_tick: u32) -> Chunk {
        let mut events = Vec::new();
        let since = self.flight.keys().iter().filter(|event| event.tick >= from_tick);
        since.for_each(|event| put_event(&mut events, event));
        self.sent = self.flight.ticks();
        Chunk { from_tick, to_tick: self.sent, digests: self.flight.digests(), events }
    }

    pub fn ended(&self) -> bool {
        self.flight.ending().is_some()
    }

    pub fn end(&self) -> End {
        let ending = self.flight.ending().unwrap_or(Ending::Abandoned);
        End { ticks: self.flight.ticks(), ending, digests: self.flight.digests() }
    }

    pub fn trajectory(self) -> Trajectory {
        self.flight.finish()
    }
}

/// A whole flight of the point.
pub fn flown(seed: u64) -> Trajectory {
    let mut page = Page::new(setup(seed));
    page.fly(10_000);
    page.trajectory()
}

pub fn record(seed: u64) -> Record {
    Record::new(&flown(seed))
}

/// A database in a folder that goes when this does.
pub struct Disk {
    pub folder: tempfile::TempDir,
    pub store: Arc<SqliteStore>,
}

impl Disk {
    pub async fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let store = SqliteStore::open(&folder.path().join("flights.db")).await.unwrap();
        Self { folder, store: Arc::new(store) }
    }
}

impl Disk {
    pub fn hangar(&self) -> Hangar {
        Hangar::new(plants(), Models::new(), self.store.clone())
    }

    /// A server on this database, for the point.
    pub async fn server(&self) -> Server {
        self.server_with(None, Assets::of(&[])).await
    }

    /// A server with models of its own.
    pub async fn server_of(&self, models: Models) -> Server {
        let store: Arc<dyn Store> = self.store.clone();
        let (hosts, assets) = (Hosts::loopback(), Assets::of(&[]));
        let parts = Parts { store, plants: plants(), models, lessons: None, hosts, assets, study: None };
        Server::start(parts).await.unwrap()
    }

    pub async fn server_with(&self, lessons: Option<Lessons>, assets: Assets) -> Server {
        let store: Arc<dyn Store> = self.store.clone();
        let hosts = Hosts::loopback();
        let parts =
            Parts { store, plants: plants(), models: Models::new(), lessons, hosts, assets, study: None };
        Server::start(parts).await.unwrap()
    }
}
