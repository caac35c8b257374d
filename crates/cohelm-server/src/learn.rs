//! Values that learn while people fly (Algorithm 1, live): episodes go to a learner on a thread of its own; the weights
//! that come back are stored under their hash and assist from the next flight on.
//!
//! Knows no network and no training: what learns is handed in.

use crate::store::{Origin, Store, StoreError, Write, Writer, now_ms};
use cohelm::trajectory::Trajectory;
use cohelm_copilot::Model;
use serde::Serialize;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::runtime::Handle;
use tokio::sync::watch;

/// Episodes that may wait for the learner: people land more slowly than it learns; if not, the newest are left out.
const MOST_WAITING: usize = 64;

/// What learns from episodes.
pub trait Learner: Send {
    /// Learns from an episode; the bytes of the new model file if the weights changed.
    fn learn(&mut self, flown: &Trajectory) -> Option<Vec<u8>>;

    /// Goes back to the weights of a model.
    fn return_to(&mut self, model: &Model);
}

/// A learner and where it stands.
pub struct Lessons {
    /// What learns.
    pub learner: Box<dyn Learner>,
    /// The model whose weights it has now.
    pub current: Model,
    /// The model that it returns to when asked.
    pub shipped: Model,
}

/// How learning stands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Status {
    /// The plant that it learns to assist on.
    pub plant: String,
    /// Hash of the values that assist now.
    pub current: String,
    /// Hash of the values that it returns to.
    pub shipped: String,
    /// Hash of the values that the next start goes on from, if somebody chose to keep some.
    pub kept: Option<String>,
    /// Episodes that changed the weights since the last return.
    pub learned: u32,
    /// Episodes that wait or are being learned from.
    pub waiting: u32,
    /// Episodes that came when too many waited, and were left out.
    pub left_out: u32,
    /// What went wrong, if learning has stopped.
    pub failure: Option<String>,
}

/// The learner at work. Dropping it ends its thread after the episode it is at.
pub struct Learning {
    orders: SyncSender<Order>,
    shipped: Model,
    writer: Writer,
    shared: Arc<Shared>,
}

/// What is to be done, and after how many returns it was ordered: what an earlier episode taught is no news any more.
enum Order {
    Learn { flown: Box<Trajectory>, returns: u32 },
    Return,
}

struct Shared {
    state: Mutex<State>,
    news: watch::Sender<String>,
}

struct State {
    status: Status,
    returns: u32,
}

impl Learning {
    /// Starts the thread. Stores both models first.
    pub(crate) async fn start(
        lessons: Lessons,
        store: &Arc<dyn Store>,
        writer: Writer,
    ) -> Result<Self, StoreError> {
        let Lessons { learner, current, shipped } = lessons;
        let keep = |model: &Model, origin| Write::Model { model: model.clone(), origin, at_ms: now_ms() };
        store.commit(&[keep(&shipped, Origin::Shipped), keep(&current, Origin::Learned)]).await?;
        let plant = shipped.card().task.plant.clone();
        let status = Status {
            kept: kept(store.as_ref(), &plant).await?,
            plant,
            current: current.hash().into(),
            shipped: shipped.hash().into(),
            learned: 0,
            waiting: 0,
            left_out: 0,
            failure: None,
        };
        let news = watch::Sender::new(status.current.clone());
        let shared = Arc::new(Shared { state: Mutex::new(State { status, returns: 0 }), news });
        let (orders, received) = sync_channel(MOST_WAITING);
        let worker =
            Worker { learner, shipped: shipped.clone(), writer: writer.clone(), shared: shared.clone() };
        let runtime = Handle::current();
        std::thread::Builder::new()
            .name("learner".into())
            .spawn(move || worker.work(&received, &runtime))
            .map_err(|error| StoreError::Value { what: "the learner's thread", value: error.to_string() })?;
        Ok(Self { orders, shipped, writer, shared })
    }

    /// How it stands.
    pub fn status(&self) -> Status {
        self.shared.state().status.clone()
    }

    /// Hash of the values that assist now.
    pub fn current(&self) -> String {
        self.shared.state().status.current.clone()
    }

    /// Tells of every change of the values.
    pub(crate) fn news(&self) -> watch::Receiver<String> {
        self.shared.news.subscribe()
    }

    /// Hands an episode to the learner, if it is one of its plant.
    pub fn hand_in(&self, flown: Trajectory) {
        let mut state = self.shared.state();
        if flown.setup.task.plant != state.status.plant {
            return;
        }
        let order = Order::Learn { flown: Box::new(flown), returns: state.returns };
        match self.orders.try_send(order) {
            Ok(()) => state.status.waiting += 1,
            Err(TrySendError::Full(_)) => state.status.left_out += 1,
            Err(TrySendError::Disconnected(_)) => {
                state.status.failure.get_or_insert("the learner stopped; the server's log says why".into());
            }
        }
    }

    /// Goes back to the shipped values, now and at the next start.
    pub async fn return_to_shipped(&self) -> Result<Status, StoreError> {
        let plant = {
            let mut state = self.shared.state();
            state.returns += 1;
            state.status.current = self.shipped.hash().into();
            state.status.learned = 0;
            self.shared.news.send_replace(self.shipped.hash().into());
            state.status.plant.clone()
        };
        // Blocks while the queue is full, hence not on a thread of the runtime; a learner that stopped needs no order.
        let orders = self.orders.clone();
        let _ = tokio::task::spawn_blocking(move || orders.send(Order::Return)).await;
        self.keep(plant, None).await
    }

    /// Chooses the values of now for the next start to go on from.
    pub async fn keep_current(&self) -> Result<Status, StoreError> {
        let Status { plant, current, .. } = self.status();
        self.keep(plant, Some(current)).await
    }

    async fn keep(&self, plant: String, hash: Option<String>) -> Result<Status, StoreError> {
        self.writer.write(vec![Write::Keep { plant, hash: hash.clone(), at_ms: now_ms() }]).await?;
        let mut state = self.shared.state();
        state.status.kept = hash;
        Ok(state.status.clone())
    }
}

/// Hash of the model of a plant that somebody chose to go on from.
pub async fn kept(store: &dyn Store, plant: &str) -> Result<Option<String>, StoreError> {
    let models = store.models().await?;
    Ok(models
        .into_iter()
        .find(|model| model.plant == plant && model.kept_at_ms.is_some())
        .map(|model| model.hash))
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        // A panic elsewhere leaves the numbers as they were.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

struct Worker {
    learner: Box<dyn Learner>,
    shipped: Model,
    writer: Writer,
    shared: Arc<Shared>,
}

impl Worker {
    fn work(mut self, orders: &Receiver<Order>, runtime: &Handle) {
        while let Ok(order) = orders.recv() {
            match order {
                Order::Return => self.learner.return_to(&self.shipped),
                Order::Learn { flown, returns } => {
                    if self.shared.state().returns == returns {
                        self.learn(&flown, returns, runtime);
                    }
                    self.shared.state().status.waiting -= 1;
                }
            }
        }
    }

    fn learn(&mut self, flown: &Trajectory, returns: u32, runtime: &Handle) {
        let Some(bytes) = self.learner.learn(flown) else { return };
        let stored = Model::from_bytes(&bytes).map_err(|error| error.to_string()).and_then(|model| {
            let write = Write::Model { model: model.clone(), origin: Origin::Learned, at_ms: now_ms() };
            runtime.block_on(self.writer.write(vec![write])).map(|_| model).map_err(|error| error.to_string())
        });
        let mut state = self.shared.state();
        match stored {
            Ok(model) if state.returns == returns => {
                tracing::info!(hash = model.hash(), "new values");
                state.status.current = model.hash().into();
                state.status.learned += 1;
                state.status.failure = None;
                self.shared.news.send_replace(model.hash().into());
            }
            Ok(_) => {}
            Err(failure) => {
                tracing::error!(failure, "learned values cannot be used");
                state.status.failure = Some(failure);
            }
        }
    }
}

#[cfg(test)]
mod tests;
