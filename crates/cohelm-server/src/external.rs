//! A plant elsewhere, flown from the page: here the loop runs in the server, and the page only steers and shows.
//!
//! | module | what it explains |
//! |---|---|
//! | `words` | what page and server say to each other about it |
//! | `crew` | its setup and its cockpit |
//! | `drive` | the loop: one tick when it is due, and the dead man |
//! | `presence` | whether somebody is at the page |
//! | `talk` | one connection with a page |
//!
//! One episode is flown at a time, by whoever came first. A page is sent the newest tick there is, and no more than a few
//! that it has not yet shown: nothing waits behind a slow page. Losing the plant ends the episode; losing the person lets go of everything, then ends it.

mod crew;
mod drive;
mod presence;
mod talk;
#[cfg(test)]
mod tests;
pub mod words;

use crate::app::Problem;
use crate::server::Server;
use axum::Json;
use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::http::StatusCode;
use axum::response::Response;
use cohelm_external::{Address, TimeOut};
use serde_json::{Value, json};
use std::sync::Arc;
use tokio::sync::Semaphore;

/// Most bytes of what a page says at once.
const MOST_BYTES: usize = 16 * 1024;

/// Where the plant is, and whose turn it is.
#[derive(Clone, Debug)]
pub struct Elsewhere {
    address: Address,
    time_out: TimeOut,
    turn: Arc<Semaphore>,
}

impl Elsewhere {
    /// A plant that listens there, and is lost when it is silent for so long.
    pub fn new(address: Address, time_out: TimeOut) -> Self {
        Self { address, time_out, turn: Arc::new(Semaphore::new(1)) }
    }
}

/// Whether there is a plant elsewhere, and where.
pub async fn about(State(server): State<Server>) -> Json<Value> {
    let about = server.elsewhere().map(|plant| {
        json!({ "address": plant.address.to_string(), "time_out_ms": plant.time_out.duration().as_millis() as u64 })
    });
    Json(json!({ "external": about }))
}

/// From a request to a conversation.
pub async fn upgrade(State(server): State<Server>, upgrade: WebSocketUpgrade) -> Result<Response, Problem> {
    let words = "no plant is flown elsewhere; start with cohelm fly --external ADDRESS";
    let plant = server.elsewhere().cloned().ok_or_else(|| Problem::not_found(words))?;
    let place = server.places().try_acquire_owned().map_err(|_| {
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "too many pages are connected; try again later")
    })?;
    let upgrade = upgrade.max_message_size(MOST_BYTES).max_frame_size(MOST_BYTES);
    Ok(upgrade.on_upgrade(move |socket| {
        let tracker = server.connections().clone();
        tracker.track_future(async move {
            talk::converse(&server, plant, socket).await;
            drop(place);
        })
    }))
}
