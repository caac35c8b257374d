//! Flights as steps of a session: which one may be flown now, and what its beginning, end or refusal means for the log.
//!
//! The end of a flight and the event that says so are one transaction: there is no moment at which one is stored and not
//! the other.

use super::hub::{Air, Flying, Here};
use super::people::{Live, condition_of};
use super::run::Study;
use crate::app::{Asking, OfStudy, Problem};
use crate::protocol::{Begin, FromPage};
use crate::secret::hex;
use crate::server::Server;
use crate::store::{Chunk, Episode, EpisodeId, FlightKey, ParticipantId, Progress, Trial, Write, unpack};
use axum::extract::{Path, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use cohelm::plant::Ending;
use cohelm::trajectory::{Setup, Trajectory, put_event};
use cohelm_study::design::timeline::setup;
use cohelm_study::session::{Event, Session};
use std::sync::Arc;
use tokio::sync::watch;

/// A participant on a connection.
pub(crate) struct Passenger {
    study: Arc<Study>,
    id: ParticipantId,
    tab: Option<String>,
    live: watch::Receiver<Live>,
    _here: Here,
}

/// Why a participant's connection ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Farewell {
    /// Another tab goes on.
    TakenOver,
    /// Nothing more is taken in from this participant.
    Over,
}

/// What a flight is of a session.
#[derive(Clone, Debug)]
pub(crate) struct Ticket {
    step: String,
    attempt: u32,
}

/// Whether a flight may begin, or go on.
pub(crate) enum Gate {
    /// It may.
    Open(Ticket),
    /// It is over and stored already.
    Flown(EpisodeId),
    /// It may not, and why.
    Shut(String),
}

impl Passenger {
    /// A participant connects from a tab.
    pub async fn board(study: &Arc<Study>, id: ParticipantId, tab: Option<String>) -> Result<Self, Problem> {
        let live_tab = study.people().meet(id).await?.session.live_tab().map(str::to_owned);
        let live = study.people().live(id);
        let tab = tab.or(live_tab);
        Ok(Self { study: study.clone(), id, tab, live, _here: study.hub().enter(id) })
    }

    /// Returns when the connection must end.
    pub async fn must_leave(&mut self) -> Farewell {
        let tab = self.tab.clone();
        let must = |live: &Live| live.over || live.tab != tab;
        let over = self.live.wait_for(must).await.map(|live| live.over);
        match over {
            Ok(true) => Farewell::Over,
            Ok(false) => Farewell::TakenOver,
            Err(_) => std::future::pending().await,
        }
    }

    /// Whether the flight of this key and setup may be flown now.
    pub async fn gate(&self, server: &Server, begin: &Begin) -> Result<Gate, Problem> {
        let met = self.study.people().meet(self.id).await?;
        let session = &met.session;
        let key = hex(&begin.key.0);
        if session.current_key().as_deref() != Some(&key) {
            return Ok(match self.flown(server, session, &key, begin.key).await? {
                Some(episode) => Gate::Flown(episode),
                None => {
                    Gate::Shut("this flight is not the one to be flown now; ask for the session again".into())
                }
            });
        }
        let Some((step, place)) = session.current().and_then(|step| Some((step, step.flight()?))) else {
            return Ok(Gate::Shut("no flight is to be flown now".into()));
        };
        let resolved = self.study.resolved(&met.edition, server.learning());
        let assignment = session.assignment().ok_or_else(|| Problem::not_found("no order was assigned"))?;
        let wanted = setup(&met.edition.design, assignment, &resolved, place);
        let learning = met.edition.design.conditions[place.condition].learning;
        let same = wanted.is_ok_and(|wanted| same_flight(&wanted, &begin.setup, learning));
        // A flight in the air goes on with the setup that it began with, whatever the program would choose now.
        let begun = session.flight(&step.id).is_some_and(|flight| flight.episode.is_some());
        if !same && !begun {
            return Ok(Gate::Shut(
                "the flight's setup is not the one of this step; ask for the session again".into(),
            ));
        }
        Ok(Gate::Open(Ticket { step: step.id.clone(), attempt: session.attempt(&step.id) }))
    }

    /// The episode of a flight of this session that is over.
    async fn flown(
        &self,
        server: &Server,
        session: &Session,
        key: &str,
        flight: FlightKey,
    ) -> Result<Option<EpisodeId>, Problem> {
        if session.step_of_key(key).is_none() {
            return Ok(None);
        }
        let row = server.store().flight(flight).await.map_err(|error| Problem::paused(&error))?;
        Ok(row.filter(|row| matches!(row.progress, Progress::Finished { .. })).map(|row| row.id))
    }

    /// What makes a flight part of the study.
    pub fn trial(&self, ticket: &Ticket) -> Trial {
        Trial { participant: self.id, step: ticket.step.clone() }
    }

    /// Notes the beginning in the log, unless it is there already.
    pub async fn begun(&self, ticket: &Ticket, episode: EpisodeId, begin: &Begin) -> Result<(), Problem> {
        let met = self.study.people().meet(self.id).await?;
        let known = met.session.flight(&ticket.step).and_then(|flight| flight.episode);
        if known != Some(episode.0) {
            let Ticket { step, attempt } = ticket.clone();
            let clock_offset_ms = self.study.clock(self.id);
            let event = Event::FlightBegun { step, attempt, episode: episode.0, clock_offset_ms };
            self.study.people().write(met, Vec::new(), vec![event]).await?;
        }
        let begin = Begin { key: FlightKey([0; 16]), ..begin.clone() };
        self.show(episode, FromPage::Begin(begin));
        Ok(())
    }

    /// Where the flight stands.
    pub fn flies(&self, episode: EpisodeId, ticks: u32) {
        self.study.hub().note_flight(self.id, Some(Flying { episode, ticks }));
    }

    /// What was just believed of it.
    pub fn show(&self, episode: EpisodeId, words: FromPage) {
        self.study.hub().show(Air { participant: self.id, episode, words: Arc::new(words) });
    }

    /// No flight is in the air any more.
    pub fn landed(&self) {
        self.study.hub().note_flight(self.id, None);
    }

    /// Stores the end of a flight together with the event that says so.
    pub async fn ended(
        &self,
        ticket: &Ticket,
        finish: Option<Write>,
        flown: (EpisodeId, Ending, u32),
    ) -> Result<(), Problem> {
        let ((episode, ending, ticks), Ticket { step, attempt }) = (flown, ticket.clone());
        let event = Event::FlightEnded { step, attempt, episode: episode.0, ending, ticks };
        self.write(finish, event).await
    }

    /// Stores that a flight is not believed, together with the event that says so: the step's next attempt is due.
    pub async fn refused(
        &self,
        ticket: &Ticket,
        refuse: Option<Write>,
        flown: (EpisodeId, String),
    ) -> Result<(), Problem> {
        let ((episode, reason), Ticket { step, attempt }) = (flown, ticket.clone());
        let event = Event::FlightRefused { step, attempt, episode: episode.0, reason };
        self.write(refuse, event).await
    }

    async fn write(&self, other: Option<Write>, event: Event) -> Result<(), Problem> {
        let met = self.study.people().meet(self.id).await?;
        self.study.people().write(met, other.into_iter().collect(), vec![event]).await?;
        Ok(())
    }
}

impl Drop for Passenger {
    fn drop(&mut self) {
        self.landed();
    }
}

/// The values of a condition that learns may have changed since the page asked.
fn same_flight(wanted: &Setup, said: &Setup, learning: bool) -> bool {
    let mut wanted = wanted.clone();
    if learning {
        wanted.values.clone_from(&said.values);
    }
    wanted == *said
}

/// Ticks that are committed of the flight that is due.
pub(super) async fn committed_ticks(server: &Server, session: &Session) -> Result<u32, Problem> {
    let Some(key) = session.current_key().as_deref().and_then(read_key) else { return Ok(0) };
    let row = server.store().flight(key).await.map_err(|error| Problem::paused(&error))?;
    Ok(row.map_or(0, |row| row.ticks))
}

/// The key of 32 hexadecimal digits.
fn read_key(text: &str) -> Option<FlightKey> {
    let mut key = [0; 16];
    let digits = text.len() == 32 && text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
    for (byte, pair) in key.iter_mut().zip(text.as_bytes().chunks(2)) {
        *byte = u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?;
    }
    digits.then_some(FlightKey(key))
}

/// What is committed of a flight of the participant's: setup and key log, for a page that lost its own.
pub async fn committed(
    State(server): State<Server>,
    OfStudy(study): OfStudy,
    Asking(id): Asking,
    Path(key): Path<String>,
) -> Result<Response, Problem> {
    study.let_ask(id).map_err(Problem::too_often)?;
    let none = || Problem::not_found("nothing is committed of a flight of this key");
    let met = study.people().meet(id).await?;
    met.session.step_of_key(&key).ok_or_else(none)?;
    drop(met);
    let paused = |error| Problem::paused(&error);
    let row = server.store().flight(read_key(&key).ok_or_else(none)?).await.map_err(paused)?;
    let row = row.filter(|row| row.ticks > 0).ok_or_else(none)?;
    let (ticks, events) = log_of(&server, &row).await?;
    let setup = row.setup.to_string();
    let mut bytes = (setup.len() as u32).to_le_bytes().to_vec();
    bytes.extend_from_slice(setup.as_bytes());
    bytes.extend_from_slice(&ticks.to_le_bytes());
    bytes.extend_from_slice(&events);
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response())
}

/// Ticks and key events of an episode, from its pieces or its record.
async fn log_of(server: &Server, row: &Episode) -> Result<(u32, Vec<u8>), Problem> {
    let paused = |error| Problem::paused(&error);
    if let Some(packed) = server.store().record(row.id).await.map_err(paused)? {
        let flown = Trajectory::from_bytes(&unpack(&packed)?).map_err(crate::store::StoreError::from)?;
        let mut events = Vec::new();
        flown.keys.iter().for_each(|event| put_event(&mut events, event));
        return Ok((flown.ticks() as u32, events));
    }
    let chunks: Vec<Chunk> = server.store().chunks(row.id).await.map_err(paused)?;
    let ticks = chunks.last().map_or(0, |chunk| chunk.to_tick);
    Ok((ticks, chunks.into_iter().flat_map(|chunk| chunk.events).collect()))
}

/// The name of the condition of a step, for lists.
pub(super) fn condition_name(seen: &super::people::Seen, step: &str) -> Option<String> {
    condition_of(&seen.edition, &seen.session, step).map(|condition| condition.name.clone())
}
