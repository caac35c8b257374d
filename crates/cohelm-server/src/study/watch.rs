//! Flights watched live by the researcher, and markers for whoever records something else at the same time.

use super::hub::{Air, Marker};
use crate::app::{OfStudy, Problem};
use crate::protocol::{Begin, FromPage};
use crate::server::Server;
use crate::store::{EpisodeId, FlightKey, ParticipantId, StoreError};
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::Response;
use std::time::Duration;
use tokio::sync::broadcast::{self, error::RecvError};
use tokio::time::{interval, timeout};
use tokio_util::sync::CancellationToken;

/// How long a watcher may take to accept a message: longer, and it is lost.
const SEND_WITHIN: Duration = Duration::from_secs(10);
/// How often a watcher hears that the connection is there: proxies close those that are silent for a minute.
const PING_EVERY: Duration = Duration::from_secs(15);
/// Most bytes of what a watcher says: nothing is expected.
const MOST_BYTES: usize = 1024;

/// The participant's flights, as the server believes them: that in the air from its first tick, then each as it comes.
pub async fn watch(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Path(id): Path<ParticipantId>,
    upgrade: WebSocketUpgrade,
) -> Result<Response, Problem> {
    drop(study.people().meet(id).await?);
    with_place(&server.clone(), upgrade, move |socket| async move {
        let air = study.hub().air();
        let in_air = study.hub().presence(id).in_air.map(|flying| flying.episode);
        let mut watcher = Watcher { server, id, socket, shown: None };
        let end = watcher.watch(air, in_air).await;
        watcher.farewell(end).await;
    })
}

/// Moments of the study as lines of JSON.
pub async fn markers(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    upgrade: WebSocketUpgrade,
) -> Result<Response, Problem> {
    let markers = study.hub().markers();
    let closing = server.closing().clone();
    with_place(&server, upgrade, move |socket| tell_markers(socket, markers, closing))
}

/// Upgrades if there is a place for one more connection, which counts among those that the server waits for.
fn with_place<F>(
    server: &Server,
    upgrade: WebSocketUpgrade,
    talk: impl FnOnce(WebSocket) -> F + Send + 'static,
) -> Result<Response, Problem>
where
    F: Future<Output = ()> + Send + 'static,
{
    let place = server.places().try_acquire_owned().map_err(|_| {
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "too many pages are connected; try again later")
    })?;
    let tracker = server.connections().clone();
    let upgrade = upgrade.max_message_size(MOST_BYTES).max_frame_size(MOST_BYTES);
    Ok(upgrade.on_upgrade(move |socket| {
        tracker.track_future(async move {
            talk(socket).await;
            drop(place);
        })
    }))
}

/// Why watching ended.
enum End {
    Gone,
    Closing,
    Behind,
    Store(StoreError),
}

struct Watcher {
    server: Server,
    id: ParticipantId,
    socket: WebSocket,
    /// The episode that is shown, and how many of its ticks.
    shown: Option<(EpisodeId, u32)>,
}

impl Watcher {
    async fn watch(&mut self, mut air: broadcast::Receiver<Air>, in_air: Option<EpisodeId>) -> End {
        if let Some(episode) = in_air
            && let Err(end) = self.catch_up(episode).await
        {
            return end;
        }
        let closing = self.server.closing().clone();
        let mut pings = interval(PING_EVERY);
        loop {
            let next = tokio::select! {
                () = closing.cancelled() => return End::Closing,
                _ = pings.tick() => match send(&mut self.socket, Message::Ping(Default::default())).await {
                    Ok(()) => continue,
                    Err(end) => return end,
                },
                heard = self.socket.recv() => match heard {
                    Some(Ok(Message::Close(_)) | Err(_)) | None => return End::Gone,
                    Some(Ok(_)) => continue,
                },
                next = air.recv() => next,
            };
            let shown = match next {
                Ok(air) if air.participant == self.id => self.show(air).await,
                Ok(_) => continue,
                Err(RecvError::Lagged(_)) => return End::Behind,
                Err(RecvError::Closed) => return End::Closing,
            };
            if let Err(end) = shown {
                return end;
            }
        }
    }

    /// Shows what is committed of an episode.
    async fn catch_up(&mut self, episode: EpisodeId) -> Result<(), End> {
        let Some(row) = self.server.store().episode(episode).await.map_err(End::Store)? else {
            return Ok(());
        };
        let Ok(setup) = serde_json::from_value(row.setup) else { return Ok(()) };
        let chunks = self.server.store().chunks(episode).await.map_err(End::Store)?;
        let begin = Begin { key: FlightKey([0; 16]), age_ms: 0, setup };
        self.say(episode, 0, &FromPage::Begin(begin)).await?;
        for chunk in chunks {
            self.say(episode, chunk.to_tick, &FromPage::Chunk(chunk)).await?;
        }
        Ok(())
    }

    /// Shows what is new, each tick once.
    async fn show(&mut self, air: Air) -> Result<(), End> {
        let Air { episode, words, .. } = air;
        let ticks = self.shown.filter(|(shown, _)| *shown == episode).map(|(_, ticks)| ticks);
        match (words.as_ref(), ticks) {
            (FromPage::Begin(_), Some(_)) => Ok(()),
            (FromPage::Begin(_), None) => self.catch_up_or_begin(episode, &words).await,
            (FromPage::Chunk(chunk), Some(ticks)) if chunk.to_tick <= ticks => Ok(()),
            (FromPage::Chunk(chunk), Some(_)) => self.say(episode, chunk.to_tick, &words).await,
            (FromPage::End(_), Some(ticks)) => self.say(episode, ticks, &words).await,
            (_, None) => self.catch_up(episode).await,
        }
    }

    /// A flight that goes on after an interruption has ticks already.
    async fn catch_up_or_begin(&mut self, episode: EpisodeId, begin: &FromPage) -> Result<(), End> {
        self.catch_up(episode).await?;
        if self.shown.is_some_and(|(shown, _)| shown == episode) {
            return Ok(());
        }
        self.say(episode, 0, begin).await
    }

    async fn say(&mut self, episode: EpisodeId, ticks: u32, words: &FromPage) -> Result<(), End> {
        self.shown = Some((episode, ticks));
        send(&mut self.socket, Message::Binary(words.to_bytes().into())).await
    }

    async fn farewell(mut self, end: End) {
        let (code, reason) = match end {
            End::Gone => return,
            End::Closing => (1001, "the server stops".to_owned()),
            End::Behind => (1013, "too slow to follow; connect again".to_owned()),
            End::Store(error) => (1011, error.to_string()),
        };
        close(&mut self.socket, code, &reason).await;
    }
}

async fn tell_markers(
    mut socket: WebSocket,
    mut markers: broadcast::Receiver<Marker>,
    closing: CancellationToken,
) {
    let mut pings = interval(PING_EVERY);
    loop {
        let next = tokio::select! {
            _ = pings.tick() => match send(&mut socket, Message::Ping(Default::default())).await {
                Ok(()) => continue,
                Err(_) => return,
            },
            () = closing.cancelled() => return close(&mut socket, 1001, "the server stops").await,
            heard = socket.recv() => match heard {
                Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                Some(Ok(_)) => continue,
            },
            next = markers.recv() => next,
        };
        let sent = match next {
            Ok(marker) => match serde_json::to_string(&marker) {
                Ok(line) => send(&mut socket, Message::Text(line.into())).await,
                Err(_) => continue,
            },
            // A recorder must know that its record has a hole.
            Err(RecvError::Lagged(missed)) => {
                let line = format!("{{\"event\":\"markers-missed\",\"missed\":{missed}}}");
                send(&mut socket, Message::Text(line.into())).await
            }
            Err(RecvError::Closed) => return,
        };
        if sent.is_err() {
            return;
        }
    }
}

async fn send(socket: &mut WebSocket, message: Message) -> Result<(), End> {
    match timeout(SEND_WITHIN, socket.send(message)).await {
        Ok(Ok(())) => Ok(()),
        _ => Err(End::Gone),
    }
}

async fn close(socket: &mut WebSocket, code: u16, reason: &str) {
    let reason = crate::protocol::cut(reason, 123).into();
    let _ = timeout(SEND_WITHIN, socket.send(Message::Close(Some(CloseFrame { code, reason })))).await;
}
