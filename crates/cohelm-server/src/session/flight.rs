//! A flight in the air on one connection: begun, followed, ended; every answer is given after what it says is stored.

use super::Hangup;
use crate::app::Problem;
use crate::follow::{Disbelief, End, Follower};
use crate::hangar::HangarError;
use crate::lease::Lease;
use crate::protocol::{Begin, FromPage, ToPage};
use crate::server::Server;
use crate::store::{Chunk, Episode, EpisodeId, Progress, Record, StoreError, Write, now_ms};
use crate::study::flights::{Gate as Admission, Passenger, Ticket};
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
    /// What it is of a participant's session.
    ticket: Option<Ticket>,
}

/// A flight on its way from a Begin to the air.
struct Gate<'a> {
    server: &'a Server,
    passenger: Option<&'a Passenger>,
    ticket: Option<Ticket>,
    lease: Lease,
}

impl From<StoreError> for Hangup {
    fn from(error: StoreError) -> Self {
        Self::cannot_write(error)
    }
}

impl From<Problem> for Hangup {
    fn from(problem: Problem) -> Self {
        Self::cannot_write(problem.words())
    }
}

impl From<JoinError> for Hangup {
    fn from(_: JoinError) -> Self {
        Self::cannot_write("following the flight failed; the server's log says why")
    }
}

impl Gate<'_> {
    async fn take_off(self, begin: Begin) -> Result<(Option<InTheAir>, ToPage), Hangup> {
        let Begin { key, age_ms, setup } = begin.clone();
        let flight = match flight_of(self.server, setup.clone()).await? {
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
        let write = match self.passenger.zip(self.ticket.as_ref()) {
            Some((passenger, ticket)) => {
                Write::BeginTrial { key, setup, at_ms, trial: passenger.trial(ticket) }
            }
            None => Write::Begin { key, setup, at_ms },
        };
        let made = self.server.writer().write(vec![write]).await?;
        let episode = made.into_iter().flatten().next();
        let episode =
            episode.ok_or_else(|| Hangup::cannot_write("the database gave the episode no number"))?;
        self.up(begin, episode, Follower::new(flight)).await
    }

    async fn go_on(self, begin: Begin, known: Episode) -> Result<(Option<InTheAir>, ToPage), Hangup> {
        let episode = known.id;
        match known.progress {
            Progress::Finished { ending } => {
                // The record is there and the event is not: the flight was ended otherwise than by its page.
                if let (Some(passenger), Some(ticket)) = (self.passenger, &self.ticket) {
                    passenger.begun(ticket, episode, &begin).await?;
                    passenger.ended(ticket, None, (episode, ending, known.ticks)).await?;
                }
                return Ok((None, ToPage::Finished { episode }));
            }
            Progress::Refused { reason } => return Ok((None, ToPage::Refused { reason })),
            Progress::InTheAir => {}
        }
        if serde_json::from_value::<Setup>(known.setup).ok().as_ref() != Some(&begin.setup) {
            let reason = "the flight of this key began with another setup; begin a new one".into();
            return Ok((None, ToPage::Refused { reason }));
        }
        let flight = match flight_of(self.server, begin.setup.clone()).await? {
            Ok(flight) => flight,
            Err(reason) => return Ok((None, ToPage::Refused { reason })),
        };
        let chunks = self.server.store().chunks(episode).await?;
        match self.server.compute(move || again(flight, &chunks)).await? {
            Ok(follower) => {
                tracing::info!(%episode, committed_tick = follower.ticks(), "flight goes on");
                self.up(begin, episode, follower).await
            }
            Err(why) => {
                let Self { server, passenger, ticket, .. } = self;
                let answer = refuse(server, passenger.zip(ticket.as_ref()), episode, why).await?;
                Ok((None, answer))
            }
        }
    }

    async fn up(
        self,
        begin: Begin,
        episode: EpisodeId,
        follower: Follower,
    ) -> Result<(Option<InTheAir>, ToPage), Hangup> {
        let Self { passenger, ticket, lease, .. } = self;
        let committed_tick = follower.ticks();
        if let (Some(passenger), Some(ticket)) = (passenger, &ticket) {
            passenger.begun(ticket, episode, &begin).await?;
            passenger.flies(episode, committed_tick);
        }
        let begun = InTheAir { episode, follower, lease, ticket };
        Ok((Some(begun), ToPage::Begun { episode, committed_tick }))
    }
}

impl InTheAir {
    /// Begins a flight, or goes on with it: what is stored under its key tells which. No flight, if it is over. In a
    /// study only the flight that is due may be flown.
    pub async fn begin(
        server: &Server,
        passenger: Option<&Passenger>,
        begin: Begin,
    ) -> Result<(Option<Self>, ToPage), Hangup> {
        let lease = timeout(LET_GO_WITHIN, server.leases().take(begin.key)).await;
        let lease = lease.map_err(|_| Hangup::away("another connection does not let go of this flight"))?;
        let ticket = match passenger {
            None => None,
            Some(passenger) => match passenger.gate(server, &begin).await? {
                Admission::Open(ticket) => Some(ticket),
                Admission::Flown(episode) => return Ok((None, ToPage::Finished { episode })),
                Admission::Shut(reason) => return Ok((None, ToPage::Refused { reason })),
            },
        };
        let gate = Gate { server, passenger, ticket, lease };
        match server.store().flight(begin.key).await? {
            None => gate.take_off(begin).await,
            Some(known) => gate.go_on(begin, known).await,
        }
    }

    /// The right to go on with it.
    pub fn lease(&self) -> &Lease {
        &self.lease
    }

    /// The page went on to another flight: this one can be taken up again, unless there is nothing of it.
    pub async fn leave(self, server: &Server, passenger: Option<&Passenger>) -> Result<(), Hangup> {
        let Self { episode, follower, lease, ticket } = self;
        tracing::info!(%episode, ticks = follower.ticks(), "flight left");
        // What a session's log names must stay.
        if follower.ticks() == 0 && ticket.is_none() {
            server.writer().write(vec![Write::Forget(episode)]).await?;
        }
        passenger.into_iter().for_each(Passenger::landed);
        drop(lease);
        Ok(())
    }

    /// Follows a piece of the log and stores what was new. No flight comes back if it is not believed.
    pub async fn follow(
        self,
        server: &Server,
        passenger: Option<&Passenger>,
        chunk: Chunk,
    ) -> Result<(Option<Self>, ToPage), Hangup> {
        let Self { episode, mut follower, lease, ticket } = self;
        let work = move || {
            let followed = follower.follow(&chunk);
            (follower, followed)
        };
        let (follower, followed) = server.compute(work).await?;
        match followed {
            Ok(new) => {
                if let Some(chunk) = new {
                    let shown = passenger.map(|_| FromPage::Chunk(chunk.clone()));
                    server.writer().write(vec![Write::Chunk { episode, chunk }]).await?;
                    if let (Some(passenger), Some(shown)) = (passenger, shown) {
                        passenger.flies(episode, follower.ticks());
                        passenger.show(episode, shown);
                    }
                }
                let committed_tick = follower.ticks();
                Ok((Some(Self { episode, follower, lease, ticket }), ToPage::Ack { committed_tick }))
            }
            Err(why @ Disbelief::Gap { .. }) => Err(Hangup::out_of_turn(why)),
            Err(why) => refuse(server, passenger.zip(ticket.as_ref()), episode, why)
                .await
                .map(|answer| (None, answer)),
        }
    }

    /// Follows the flight to its end and stores its record.
    pub async fn land(
        self,
        server: &Server,
        passenger: Option<&Passenger>,
        end: End,
    ) -> Result<ToPage, Hangup> {
        let Self { episode, follower, lease, ticket } = self;
        let study = passenger.zip(ticket.as_ref());
        let work = move || follower.land(end).map(|flown| (Record::new(&flown), flown));
        let (record, flown) = match server.compute(work).await? {
            Ok(landed) => landed,
            Err(why) => return refuse(server, study, episode, why).await,
        };
        let (ticks, ending) = (flown.ticks() as u32, flown.ending);
        let finish = Write::Finish { episode, record, at_ms: now_ms() };
        match study {
            Some((passenger, ticket)) => {
                passenger.ended(ticket, Some(finish), (episode, ending, ticks)).await?;
                passenger.show(episode, FromPage::End(end));
                passenger.landed();
            }
            None => drop(server.writer().write(vec![finish]).await?),
        }
        tracing::info!(%episode, ticks, ending = ending.word(), "flight ends");
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

async fn refuse(
    server: &Server,
    study: Option<(&Passenger, &Ticket)>,
    episode: EpisodeId,
    why: Disbelief,
) -> Result<ToPage, Hangup> {
    let reason = why.to_string();
    tracing::warn!(%episode, reason, "flight refused");
    let refuse = Write::Refuse { episode, reason: reason.clone(), at_ms: now_ms() };
    match study {
        Some((passenger, ticket)) => {
            passenger.refused(ticket, Some(refuse), (episode, reason.clone())).await?;
            passenger.landed();
        }
        None => drop(server.writer().write(vec![refuse]).await?),
    }
    Ok(ToPage::Refused { reason })
}
