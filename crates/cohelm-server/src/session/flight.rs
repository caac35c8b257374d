//! A flight in the air on one connection: begun, followed, ended; every answer is given after what it says is stored.

use super::Hangup;
use crate::follow::{Disbelief, End, Follower};
use crate::hangar::HangarError;
use crate::lease::Lease;
use crate::protocol::{Begin, ToPage};
use crate::server::Server;
use crate::store::{Chunk, Episode, EpisodeId, Progress, Record, StoreError, Write, now_ms};
use cohelm::flight::Flight;
use cohelm::trajectory::Setup;
use std::time::Duration;
use tokio::task::JoinError;
use tokio::time::timeout;

/// How long the connection that holds a flight may take to let go of it.
const LET_GO_WITHIN: Duration = Duration::from_secs(15);

/// The flight, and the right to go on with it.
pub(super) struct InTheAir {
    episode: EpisodeId,
    follower: Follower,
    lease: Lease,
}

impl From<StoreError> for Hangup {
    fn from(error: StoreError) -> Self {
        Self::cannot_write(error)
    }
}

impl From<JoinError> for Hangup {
    fn from(_: JoinError) -> Self {
        Self::cannot_write("following the flight failed; the server's log says why")
    }
}

impl InTheAir {
    /// Begins a flight, or goes on with it: what is stored under its key tells which. No flight, if it is over.
    pub async fn begin(server: &Server, begin: Begin) -> Result<(Option<Self>, ToPage), Hangup> {
        let lease = timeout(LET_GO_WITHIN, server.leases().take(begin.key)).await;
        let lease = lease.map_err(|_| Hangup::away("another connection does not let go of this flight"))?;
        match server.store().flight(begin.key).await? {
            None => Self::take_off(server, begin, lease).await,
            Some(known) => Self::go_on(server, begin.setup, known, lease).await,
        }
    }

    async fn take_off(server: &Server, begin: Begin, lease: Lease) -> Result<(Option<Self>, ToPage), Hangup> {
        let Begin { key, age_ms, setup } = begin;
        let flight = match flight_of(server, setup.clone()).await? {
            Ok(flight) => flight,
            Err(reason) => return Ok((None, ToPage::Refused { reason })),
        };
        let at_ms = now_ms().saturating_sub(age_ms.into());
        tracing::info!(
            plant = setup.task.plant,
            rule = setup.rule.word(),
            seed = setup.seed,
            "flight begins"
        );
        let made = server.writer().write(vec![Write::Begin { key, setup, at_ms }]).await?;
        let episode = made.into_iter().flatten().next();
        let episode =
            episode.ok_or_else(|| Hangup::cannot_write("the database gave the episode no number"))?;
        let begun = Self { episode, follower: Follower::new(flight), lease };
        Ok((Some(begun), ToPage::Begun { episode, committed_tick: 0 }))
    }

    async fn go_on(
        server: &Server,
        setup: Setup,
        known: Episode,
        lease: Lease,
    ) -> Result<(Option<Self>, ToPage), Hangup> {
        let episode = known.id;
        match known.progress {
            Progress::Finished { .. } => return Ok((None, ToPage::Finished { episode })),
            Progress::Refused { reason } => return Ok((None, ToPage::Refused { reason })),
            Progress::InTheAir => {}
        }
        if serde_json::from_value::<Setup>(known.setup).ok().as_ref() != Some(&setup) {
            let reason = "the flight of this key began with another setup; begin a new one".into();
            return Ok((None, ToPage::Refused { reason }));
        }
        let flight = match flight_of(server, setup).await? {
            Ok(flight) => flight,
            Err(reason) => return Ok((None, ToPage::Refused { reason })),
        };
        let chunks = server.store().chunks(episode).await?;
        match server.compute(move || again(flight, &chunks)).await? {
            Ok(follower) => {
                let committed_tick = follower.ticks();
                tracing::info!(%episode, committed_tick, "flight goes on");
                let begun = Self { episode, follower, lease };
                Ok((Some(begun), ToPage::Begun { episode, committed_tick }))
            }
            Err(why) => refuse(server, episode, why).await.map(|answer| (None, answer)),
        }
    }

    /// The right to go on with it.
    pub fn lease(&self) -> &Lease {
        &self.lease
    }

    /// The page went on to another flight: this one can be taken up again, unless there is nothing of it.
    pub async fn leave(self, server: &Server) -> Result<(), Hangup> {
        let Self { episode, follower, lease } = self;
        tracing::info!(%episode, ticks = follower.ticks(), "flight left");
        if follower.ticks() == 0 {
            server.writer().write(vec![Write::Forget(episode)]).await?;
        }
        drop(lease);
        Ok(())
    }

    /// Follows a piece of the log and stores what was new. No flight comes back if it is not believed.
    pub async fn follow(self, server: &Server, chunk: Chunk) -> Result<(Option<Self>, ToPage), Hangup> {
        let Self { episode, mut follower, lease } = self;
        let work = move || {
            let followed = follower.follow(&chunk);
            (follower, followed)
        };
        let (follower, followed) = server.compute(work).await?;
        match followed {
            Ok(new) => {
                if let Some(chunk) = new {
                    server.writer().write(vec![Write::Chunk { episode, chunk }]).await?;
                }
                let committed_tick = follower.ticks();
                Ok((Some(Self { episode, follower, lease }), ToPage::Ack { committed_tick }))
            }
            Err(why @ Disbelief::Gap { .. }) => Err(Hangup::out_of_turn(why)),
            Err(why) => refuse(server, episode, why).await.map(|answer| (None, answer)),
        }
    }

    /// Follows the flight to its end and stores its record.
    pub async fn land(self, server: &Server, end: End) -> Result<ToPage, Hangup> {
        let Self { episode, follower, lease } = self;
        let work = move || follower.land(end).map(|flown| (Record::new(&flown), flown));
        let (record, flown) = match server.compute(work).await? {
            Ok(landed) => landed,
            Err(why) => return refuse(server, episode, why).await,
        };
        let (ticks, ending) = (flown.ticks(), flown.ending.word());
        server.writer().write(vec![Write::Finish { episode, record, at_ms: now_ms() }]).await?;
        tracing::info!(%episode, ticks, ending, "flight ends");
        drop(lease);
        if let Some(learning) = server.learning() {
            learning.hand_in(flown);
        }
        Ok(ToPage::Finished { episode })
    }
}

/// The beginning of the flight of a setup, or why it cannot be flown here. A database that fails is no such reason.
async fn flight_of(server: &Server, setup: Setup) -> Result<Result<Flight, String>, Hangup> {
    match server.hangar().begin(setup).await {
        Ok(flight) => Ok(Ok(flight)),
        Err(HangarError::Store(error)) => Err(error.into()),
        Err(error) => Ok(Err(error.to_string())),
    }
}

/// Follows again what was followed and stored before.
fn again(flight: Flight, chunks: &[Chunk]) -> Result<Follower, Disbelief> {
    let mut follower = Follower::new(flight);
    for chunk in chunks {
        follower.follow(chunk)?;
    }
    Ok(follower)
}

async fn refuse(server: &Server, episode: EpisodeId, why: Disbelief) -> Result<ToPage, Hangup> {
    let reason = why.to_string();
    tracing::warn!(%episode, reason, "flight refused");
    server.writer().write(vec![Write::Refuse { episode, reason: reason.clone(), at_ms: now_ms() }]).await?;
    Ok(ToPage::Refused { reason })
}
