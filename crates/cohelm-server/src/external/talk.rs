//! One connection with a page that flies a plant elsewhere.

use super::Elsewhere;
use super::crew::{crew, why_alone};
use super::drive::Drive;
use super::presence::Presence;
use super::words::{Ended, Flown, FromPage, Ready, ToPage, Wish};
use crate::limits::{Bucket, Rate};
use crate::server::Server;
use crate::store::{EpisodeId, FlightKey, Record, StoreError, Write, now_ms};
use axum::extract::ws::{Message, WebSocket};
use cohelm::action::ActionSpace;
use cohelm::flight::Flight;
use cohelm::keys::Change;
use cohelm::plant::Plant;
use cohelm::report::Opening;
use cohelm::trajectory::{MAX_SEED, Setup, Trajectory};
use cohelm_external::External;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use std::pin::pin;
use std::sync::mpsc::{self, Sender};
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, watch};
use tokio::time::{sleep, timeout};

/// Messages of a page: a stick that moves at every tick, and a word ten times a second.
const OF_A_PAGE: Rate = Rate { per_s: 150.0, burst: 300.0 };
/// How long a page may take to accept a message: one that shows what was two seconds ago cannot be steered by.
const SEND_WITHIN: Duration = Duration::from_secs(2);

/// How long a plant that is ready waits for its start: others may want it.
const READY_FOR: Duration = Duration::from_secs(120);
/// How long a page that wants nothing is kept: one whose machine is off says nothing either.
const IDLE_FOR: Duration = Duration::from_secs(30 * 60);

/// The page is gone, or must go.
struct Gone;

/// A plant that is ready, and the turn to fly it.
struct Prepared {
    flight: Flight,
    median_range: Option<f64>,
    turn: OwnedSemaphorePermit,
}

/// Talks with a page until it goes: one episode after the other.
pub async fn converse(server: &Server, plant: Elsewhere, socket: WebSocket) {
    let (sink, stream) = socket.split();
    let mut page = Page { sink, stream, allowance: Bucket::new(OF_A_PAGE) };
    let closing = server.closing().clone();
    // A flight in the air sees for itself that the server stops, and ends first.
    let Err(Gone) = talk(server, &plant, &mut page).await;
    let reason = if closing.is_cancelled() { "the server stops" } else { "" };
    tracing::info!(reason, "a page leaves the plant elsewhere");
    let _ = timeout(SEND_WITHIN, page.sink.close()).await;
}

async fn talk(server: &Server, plant: &Elsewhere, page: &mut Page) -> Result<std::convert::Infallible, Gone> {
    let mut prepared: Option<Prepared> = None;
    loop {
        let patience = if prepared.is_some() { READY_FOR } else { IDLE_FOR };
        let heard = tokio::select! {
            () = server.closing().cancelled() => return Err(Gone),
            heard = timeout(patience, page.hear()) => match heard {
                Ok(heard) => heard?,
                Err(_) if prepared.take().is_some() => {
                    let reason = "nobody started for two minutes, so the plant was let go of".into();
                    page.say(&ToPage::Refused { reason }).await?;
                    continue;
                }
                Err(_) => return Err(Gone),
            },
        };
        match (heard, prepared.take()) {
            (FromPage::Begin(wish), before) => {
                // The plant before this one is told the end before it is asked to begin again.
                drop(before);
                prepared = page.prepare(server, plant, wish).await?;
            }
            (FromPage::Start, Some(ready)) => page.fly(server, ready).await?,
            (FromPage::Start, None) => {
                page.say(&ToPage::Refused { reason: "no plant is ready; try again".into() }).await?;
            }
            // What was still on its way from the last flight.
            (FromPage::Stop | FromPage::Change { .. } | FromPage::Here { .. }, ready) => prepared = ready,
        }
    }
}

struct Page {
    sink: SplitSink<WebSocket, Message>,
    stream: SplitStream<WebSocket>,
    allowance: Bucket,
}

impl Page {
    /// The next message. Whoever says what is none is hung up on.
    async fn hear(&mut self) -> Result<FromPage, Gone> {
        hear(&mut self.stream, &mut self.allowance).await
    }

    async fn say(&mut self, words: &ToPage) -> Result<(), Gone> {
        say(&mut self.sink, words).await
    }

    /// Gets the plant ready, or says why that cannot be.
    async fn prepare(
        &mut self,
        server: &Server,
        plant: &Elsewhere,
        wish: Wish,
    ) -> Result<Option<Prepared>, Gone> {
        match ready(server, plant, wish).await {
            Ok((ready, words)) => {
                self.say(&ToPage::Ready(Box::new(words))).await?;
                Ok(Some(ready))
            }
            Err(reason) => {
                self.say(&ToPage::Refused { reason }).await?;
                Ok(None)
            }
        }
    }

    /// Flies to the end, stores what was flown and tells it.
    async fn fly(&mut self, server: &Server, ready: Prepared) -> Result<(), Gone> {
        let Prepared { flight, median_range, turn } = ready;
        let episode = match begin(server, flight.setup().clone()).await {
            Ok(episode) => episode,
            Err(error) => {
                let reason = format!("the flight could not be stored, so it did not begin: {error}");
                return self.say(&ToPage::Refused { reason }).await;
            }
        };
        let flown = self.steer(server, flight, median_range).await;
        drop(turn);
        let Some((flown, mut ended)) = flown else {
            let reason = "the loop stopped, which is a bug; the server's log says more".into();
            return self.say(&ToPage::Refused { reason }).await;
        };
        match finish(server, episode, flown).await {
            Ok(stored) => ended.episode = stored.map(|id| id.0),
            Err(error) => ended.why = Some(format!("the record could not be stored: {error}")),
        }
        self.say(&ToPage::Ended(ended)).await
    }

    /// The loop on its thread, the page's hands and eyes beside it.
    async fn steer(
        &mut self,
        server: &Server,
        flight: Flight,
        median_range: Option<f64>,
    ) -> Option<(Trajectory, Ended)> {
        let (hands, changes) = mpsc::channel();
        let (frames, shown) = watch::channel(None);
        let presence = Presence::new();
        let drive = Drive { flight, changes, presence: presence.clone(), median_range };
        let mut driven = tokio::task::spawn_blocking(move || drive.fly(&frames));
        let Self { sink, stream, allowance } = self;
        let mut hands = pin!(steer_by(stream, allowance, hands, &presence));
        let mut eyes = pin!(show(sink, shown, &presence));
        let (mut lost, mut blind) = (false, false);
        loop {
            tokio::select! {
                flown = &mut driven => return flown.inspect_err(|error| tracing::error!(%error, "driving")).ok(),
                _ = &mut hands, if !lost => {
                    presence.lose("the page was closed");
                    lost = true;
                }
                seen = &mut eyes, if !blind => {
                    if seen.is_err() {
                        presence.lose("the page takes no picture");
                    }
                    blind = true;
                }
                () = server.closing().cancelled(), if !lost => {
                    presence.lose("the server stops");
                    lost = true;
                }
            }
        }
    }
}

/// Passes on what the person does, until the page goes.
async fn steer_by(
    stream: &mut SplitStream<WebSocket>,
    allowance: &mut Bucket,
    hands: Sender<(Change, f32)>,
    presence: &Presence,
) -> Gone {
    loop {
        match hear(stream, allowance).await {
            Ok(FromPage::Change { change, at_ms }) if at_ms.is_finite() => {
                // No sign of a person: a stick may be sent by a page that nobody looks at. The loop has ended if nobody
                // takes it.
                let _ = hands.send((change, at_ms));
            }
            Ok(FromPage::Stop) => presence.stop(),
            Ok(FromPage::Here { shown }) => presence.here(shown),
            Ok(_) => {}
            Err(gone) => return gone,
        }
    }
}

/// Sends the newest tick whenever the page has shown all but a few of those before, until the loop has ended. What is
/// sent and not yet shown may wait anywhere on its way, so that it says nothing of what the person sees.
async fn show(
    sink: &mut SplitSink<WebSocket, Message>,
    mut frames: watch::Receiver<Option<Flown>>,
    presence: &Presence,
) -> Result<(), Gone> {
    while frames.changed().await.is_ok() {
        presence.keeps_up().await;
        let newest = frames.borrow_and_update().clone();
        if let Some(newest) = newest {
            presence.sent(newest.report.tick);
            say(sink, &ToPage::Tick(Box::new(newest))).await?;
        }
    }
    Ok(())
}

async fn hear(stream: &mut SplitStream<WebSocket>, allowance: &mut Bucket) -> Result<FromPage, Gone> {
    loop {
        let text = match stream.next().await {
            Some(Ok(Message::Text(text))) => text,
            Some(Ok(Message::Ping(_) | Message::Pong(_))) => continue,
            _ => return Err(Gone),
        };
        while let Err(wait) = allowance.take() {
            sleep(wait).await;
        }
        return serde_json::from_str(&text).map_err(|error| {
            tracing::warn!(%error, "a page says what is no message");
            Gone
        });
    }
}

async fn say(sink: &mut SplitSink<WebSocket, Message>, words: &ToPage) -> Result<(), Gone> {
    let text = serde_json::to_string(words).map_err(|_| Gone)?;
    match timeout(SEND_WITHIN, sink.send(Message::Text(text.into()))).await {
        Ok(Ok(())) => Ok(()),
        _ => Err(Gone),
    }
}

/// Connects with the plant and puts a crew into it.
async fn ready(server: &Server, plant: &Elsewhere, wish: Wish) -> Result<(Prepared, Ready), String> {
    // The plant and the record must be given the same one.
    if wish.seed > MAX_SEED {
        return Err(format!("expected a seed of at most 2⁵³ = {MAX_SEED}, got {}", wish.seed));
    }
    let turn = plant.turn.clone().try_acquire_owned();
    let turn = turn.map_err(|_| "somebody else is at this plant; wait until that flight is over")?;
    let Elsewhere { address, time_out, .. } = plant.clone();
    let begun = tokio::task::spawn_blocking(move || External::begin(&address, wish.seed, time_out)).await;
    let external = begun.map_err(|panic| panic.to_string())?.map_err(|error| error.to_string())?;
    let models = server.hangar().models();
    let (setup, cockpit) = crew(wish, &external, models)?;
    let values = setup.values.as_ref().and_then(|hash| models.get(hash));
    let median_range = values.and_then(|model| model.card().median_range);
    let opening = Opening::of(&setup, &external as &dyn Plant, None);
    let has_axes = matches!(external.space(), ActionSpace::Axes { .. });
    let (name, has_values) = (external.name().to_owned(), values.is_some());
    let why_alone = (!has_values).then(|| why_alone(&external).to_owned());
    let ready = Ready { name, has_axes, has_values, why_alone, opening };
    let flight = Flight::new(setup, Box::new(external), cockpit);
    Ok((Prepared { flight, median_range, turn }, ready))
}

async fn begin(server: &Server, setup: Setup) -> Result<EpisodeId, StoreError> {
    let mut key = FlightKey([0; 16]);
    getrandom::fill(&mut key.0)
        .map_err(|_| StoreError::Value { what: "a random key", value: "none".into() })?;
    let write = Write::Begin { key, setup, at_ms: now_ms() };
    let made = server.writer().write(vec![write]).await?;
    let number = made.into_iter().flatten().next();
    number.ok_or(StoreError::Value { what: "the number of an episode", value: "none".into() })
}

/// Stores the record; one without a tick is forgotten.
async fn finish(
    server: &Server,
    episode: EpisodeId,
    flown: Trajectory,
) -> Result<Option<EpisodeId>, StoreError> {
    if flown.ticks() == 0 {
        server.writer().write(vec![Write::Forget(episode)]).await?;
        return Ok(None);
    }
    let packed = tokio::task::spawn_blocking(move || Record::new(&flown)).await;
    let record = packed.map_err(|panic| StoreError::Unpack(panic.to_string()))?;
    server.writer().write(vec![Write::Finish { episode, record, at_ms: now_ms() }]).await?;
    Ok(Some(episode))
}
