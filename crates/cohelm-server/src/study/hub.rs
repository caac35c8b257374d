//! What happens, told to whoever watches: news for the researcher's page, flights for its live view, markers for
//! recorders of other signals. Nothing waits for a watcher: one that falls behind is told so.

use crate::protocol::FromPage;
use crate::store::{EpisodeId, ParticipantId};
use serde::Serialize;
use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::broadcast;

/// Words that may wait for a slow watcher.
const BACKLOG: usize = 1024;

/// What the server just believed of a flight.
#[derive(Clone, Debug)]
pub struct Air {
    /// Whose.
    pub participant: ParticipantId,
    /// Which.
    pub episode: EpisodeId,
    /// What the page said of it; a Begin has no key.
    pub words: Arc<FromPage>,
}

/// A moment of the study that other recordings are aligned by.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Marker {
    /// By this machine's clock, milliseconds since 1970.
    pub t_server_ms: i64,
    /// The participant's code.
    pub participant: String,
    /// What happened, as in the event log.
    pub event: String,
    /// At which step.
    pub step: Option<String>,
    /// Under which condition, if the step belongs to one.
    pub condition: Option<String>,
    /// In which episode.
    pub episode: Option<i64>,
    /// At which of its ticks.
    pub tick: Option<u32>,
    /// The clock of the participant's page minus this machine's, milliseconds, as the page measured it.
    pub clock_offset_ms: Option<f64>,
}

/// A flight in the air as lists show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Flying {
    /// Its number.
    pub episode: EpisodeId,
    /// Ticks that are committed.
    pub ticks: u32,
}

/// Who is here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Presence {
    /// Sockets that are open.
    pub sockets: u32,
    /// The flight in the air.
    pub in_air: Option<Flying>,
}

/// All of it.
pub struct Hub {
    news: broadcast::Sender<ParticipantId>,
    air: broadcast::Sender<Air>,
    markers: broadcast::Sender<Marker>,
    present: Mutex<HashMap<ParticipantId, Presence>>,
}

impl Default for Hub {
    fn default() -> Self {
        Self {
            news: broadcast::Sender::new(BACKLOG),
            air: broadcast::Sender::new(BACKLOG),
            markers: broadcast::Sender::new(BACKLOG),
            present: Mutex::default(),
        }
    }
}

impl Hub {
    /// Something about a participant is new.
    pub fn tell(&self, participant: ParticipantId) {
        // Nobody may be listening, here and below.
        let _ = self.news.send(participant);
    }

    /// A moment to align other recordings by.
    pub fn mark(&self, marker: Marker) {
        let _ = self.markers.send(marker);
    }

    /// Where the participant's flight in the air stands.
    pub fn note_flight(&self, participant: ParticipantId, in_air: Option<Flying>) {
        self.with(participant, |presence| presence.in_air = in_air);
        self.tell(participant);
    }

    /// What was just believed of a flight.
    pub fn show(&self, air: Air) {
        let _ = self.air.send(air);
    }

    /// A socket of the participant opened; it counts until the answer is dropped.
    pub fn enter(self: &Arc<Self>, participant: ParticipantId) -> Here {
        self.with(participant, |presence| presence.sockets += 1);
        self.tell(participant);
        Here { hub: self.clone(), participant }
    }

    /// Whether the participant is connected, and what is in the air.
    pub fn presence(&self, participant: ParticipantId) -> Presence {
        // A panic elsewhere leaves the counts as they were.
        let present = self.present.lock().unwrap_or_else(PoisonError::into_inner);
        present.get(&participant).copied().unwrap_or_default()
    }

    /// Whose rows changed, from now on.
    pub fn news(&self) -> News {
        News { changes: self.news.subscribe() }
    }

    /// Flights, from now on.
    pub fn air(&self) -> broadcast::Receiver<Air> {
        self.air.subscribe()
    }

    /// Markers, from now on.
    pub fn markers(&self) -> broadcast::Receiver<Marker> {
        self.markers.subscribe()
    }

    fn with(&self, participant: ParticipantId, change: impl FnOnce(&mut Presence)) {
        let mut present = self.present.lock().unwrap_or_else(PoisonError::into_inner);
        let presence = present.entry(participant).or_default();
        change(presence);
        if *presence == Presence::default() {
            present.remove(&participant);
        }
    }
}

/// A socket that is open.
pub struct Here {
    hub: Arc<Hub>,
    participant: ParticipantId,
}

impl Drop for Here {
    fn drop(&mut self) {
        self.hub.with(self.participant, |presence| presence.sockets = presence.sockets.saturating_sub(1));
        self.hub.tell(self.participant);
    }
}

/// Changes of rows.
pub struct News {
    changes: broadcast::Receiver<ParticipantId>,
}

/// What changed since the last time.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Changed {
    /// These rows.
    pub participants: BTreeSet<ParticipantId>,
    /// Perhaps all of them: more changed than could wait.
    pub all: bool,
}

impl News {
    /// Waits for a change and gives it with everything that has changed by then; `None` once there will be no more.
    pub async fn next(&mut self) -> Option<Changed> {
        use broadcast::error::{RecvError, TryRecvError};
        let mut changed = Changed { participants: BTreeSet::new(), all: false };
        match self.changes.recv().await {
            Ok(id) => drop(changed.participants.insert(id)),
            Err(RecvError::Lagged(_)) => changed.all = true,
            Err(RecvError::Closed) => return None,
        }
        loop {
            match self.changes.try_recv() {
                Ok(id) => drop(changed.participants.insert(id)),
                Err(TryRecvError::Lagged(_)) => changed.all = true,
                Err(_) => return Some(changed),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn news_are_gathered_and_too_many_mean_everything() {
        let hub = Hub::default();
        let mut news = hub.news();
        for id in [3, 1, 3] {
            hub.tell(ParticipantId(id));
        }
        let gathered = news.next().await.unwrap();
        assert_eq!(
            gathered,
            Changed { participants: [ParticipantId(1), ParticipantId(3)].into(), all: false }
        );
        (0..2 * BACKLOG as i64).for_each(|id| hub.tell(ParticipantId(id)));
        assert!(news.next().await.unwrap().all);
    }

    #[test]
    fn a_participant_is_here_while_a_socket_is_open() {
        let hub = Arc::new(Hub::default());
        let id = ParticipantId(7);
        let (one, other) = (hub.enter(id), hub.enter(id));
        drop(one);
        assert_eq!(hub.presence(id).sockets, 1);
        drop(other);
        assert_eq!(hub.presence(id), Presence::default());
        assert!(hub.present.lock().unwrap().is_empty());
    }
}
