//! From a request to a conversation.

use super::{Problem, Who};
use crate::protocol::MAX_MESSAGE;
use crate::server::Server;
use crate::session::converse;
use crate::study::flights::Passenger;
use axum::Extension;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use serde::Deserialize;
use std::sync::atomic::{AtomicU64, Ordering};
use tracing::Instrument;

/// Most bytes that the socket itself takes: what lies between this and [`MAX_MESSAGE`] is closed with a reason.
const MOST_BYTES: usize = 4 * MAX_MESSAGE;
/// Bytes of buffer a connection: messages are small, and there are many connections.
const BUFFER: usize = 4 * 1024;

static CONNECTIONS: AtomicU64 = AtomicU64::new(1);

/// Which tab connects, in a study.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct From {
    tab: Option<String>,
}

pub async fn upgrade(
    State(server): State<Server>,
    Extension(who): Extension<Who>,
    Query(From { tab }): Query<From>,
    upgrade: WebSocketUpgrade,
) -> Response {
    if server.closing().is_cancelled() {
        return (StatusCode::SERVICE_UNAVAILABLE, "the server stops\n").into_response();
    }
    let Ok(place) = server.places().try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many pages are connected; try again later\n")
            .into_response();
    };
    let passenger = match passenger(&server, who, tab).await {
        Ok(passenger) => passenger,
        Err(problem) => return problem.into_response(),
    };
    let span = tracing::info_span!("page", connection = CONNECTIONS.fetch_add(1, Ordering::Relaxed));
    let upgrade = upgrade.max_message_size(MOST_BYTES).max_frame_size(MOST_BYTES);
    upgrade.read_buffer_size(BUFFER).write_buffer_size(BUFFER).on_upgrade(move |socket| {
        let tracker = server.connections().clone();
        let conversation = async move {
            let (outgoing, incoming) = socket.split();
            converse(&server, passenger, incoming, outgoing).await;
            drop(place);
        };
        tracker.track_future(conversation.instrument(span))
    })
}

/// The participant who connects; in a study nobody else flies.
async fn passenger(server: &Server, who: Who, tab: Option<String>) -> Result<Option<Passenger>, Problem> {
    match (server.study(), who.participant) {
        (None, _) => Ok(None),
        (Some(study), Some(id)) => Passenger::board(study, id, tab).await.map(Some),
        (Some(_), None) => Err(Problem::new(
            StatusCode::FORBIDDEN,
            "only participants of the study fly here; open your link",
        )),
    }
}
