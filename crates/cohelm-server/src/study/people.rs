//! The participants at hand. What is true of one is the fold of its event log; this keeps the last fold in memory, so
//! that not every request reads the log again, and writes to the log.
//!
//! What is at hand is put aside during a write and taken up again only once the write is known to have happened:
//! otherwise the log is read anew.

use super::designs::{Designs, Edition};
use super::hub::{Hub, Marker};
use crate::app::Problem;
use crate::hangar::Hangar;
use crate::secret::Token;
use crate::store::{EpisodeId, Participant, ParticipantId, StoreError, TokenHash, Write, Writer, now_ms};
use axum::http::StatusCode;
use cohelm_study::design::Condition;
use cohelm_study::session::{Event, FoldError, Logged, Session, Status};
use std::collections::HashMap;
use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::{OwnedMutexGuard, watch};

/// All participants of the studies in the database.
pub struct People {
    hangar: Arc<Hangar>,
    writer: Writer,
    hub: Arc<Hub>,
    designs: Designs,
    at_hand: Mutex<HashMap<ParticipantId, Person>>,
    tokens: Mutex<HashMap<[u8; 32], ParticipantId>>,
}

/// One participant: whoever deals with one waits for whoever does so already.
#[derive(Clone, Default)]
struct Person {
    known: Arc<tokio::sync::Mutex<Option<Known>>>,
    board: Arc<Board>,
}

/// What others may read of a participant without meeting them.
#[derive(Default)]
struct Board {
    live: watch::Sender<Live>,
    seen: Mutex<Option<Seen>>,
}

/// A participant as last seen.
#[derive(Clone)]
pub struct Seen {
    /// The row.
    pub row: Participant,
    /// The study's file that the participant began with.
    pub edition: Arc<Edition>,
    /// What follows from the log.
    pub session: Arc<Session>,
}

/// Which page of a participant may talk.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Live {
    /// The tab that opened the session last.
    pub tab: Option<String>,
    /// True once nothing more is taken in: excluded or withdrawn.
    pub over: bool,
}

/// What is known of one: the row, the log, and what follows from it.
pub struct Known {
    /// The row.
    pub row: Participant,
    /// The study's file that the participant began with.
    pub edition: Arc<Edition>,
    /// The log.
    pub log: Vec<Logged>,
    /// What follows from it.
    pub session: Arc<Session>,
}

impl Known {
    fn live(&self) -> Live {
        let over = matches!(self.session.status(), Status::Excluded | Status::Withdrawn);
        Live { tab: self.session.live_tab().map(str::to_owned), over }
    }

    fn seen(&self) -> Seen {
        Seen { row: self.row.clone(), edition: self.edition.clone(), session: self.session.clone() }
    }
}

/// The condition to which a step belongs.
pub fn condition_of<'a>(edition: &'a Edition, session: &Session, step: &str) -> Option<&'a Condition> {
    let order = &session.assignment()?.order;
    let step = session.steps().iter().find(|known| known.id == step)?;
    edition.design.conditions.get(*order.get(step.block()?.checked_sub(1)?)?)
}

impl Board {
    fn publish(&self, known: &Known) {
        let next = known.live();
        self.live.send_if_modified(|now| {
            let changed = *now != next;
            *now = next;
            changed
        });
        *lock(&self.seen) = Some(known.seen());
    }
}

/// One participant, with nobody else dealing with it meanwhile.
pub struct Meeting {
    /// Holds the participant but during a write.
    place: OwnedMutexGuard<Option<Known>>,
    board: Arc<Board>,
}

impl Deref for Meeting {
    type Target = Known;

    fn deref(&self) -> &Known {
        self.place.as_ref().expect("whoever is met is known: a write that fails ends the meeting")
    }
}

impl People {
    /// Those of a database, by whatever version of the file.
    pub fn new(hangar: Arc<Hangar>, writer: Writer, hub: Arc<Hub>) -> Self {
        let (designs, at_hand, tokens) = Default::default();
        Self { hangar, writer, hub, designs, at_hand, tokens }
    }

    /// The versions of the file.
    pub fn designs(&self) -> &Designs {
        &self.designs
    }

    /// Whose token that is.
    pub async fn of_token(&self, token: &Token) -> Result<Option<ParticipantId>, Problem> {
        let hash = token.hash();
        if let Some(&known) = lock(&self.tokens).get(&hash) {
            return Ok(Some(known));
        }
        let row = self.hangar.store().participant_by_token(TokenHash(hash)).await;
        let found = row.map_err(|error| Problem::paused(&error))?.map(|row| row.id);
        if let Some(id) = found {
            lock(&self.tokens).insert(hash, id);
        }
        Ok(found)
    }

    /// Forgets whose tokens are whose: some have become void.
    pub fn forget_tokens(&self) {
        lock(&self.tokens).clear();
    }

    /// Word of which page of a participant may talk.
    pub fn live(&self, id: ParticipantId) -> watch::Receiver<Live> {
        self.person(id).board.live.subscribe()
    }

    /// Meets one, once nobody else does.
    pub async fn meet(&self, id: ParticipantId) -> Result<Meeting, Problem> {
        let person = self.person(id);
        let mut place = person.known.lock_owned().await;
        let known = match place.take() {
            Some(known) => known,
            None => self.read(id).await?,
        };
        person.board.publish(&known);
        *place = Some(known);
        Ok(Meeting { place, board: person.board })
    }

    /// Adds events to the log of whom one meets, in one transaction after `others`, and goes on meeting. Gives the
    /// episodes that the others made.
    pub async fn write(
        &self,
        mut meeting: Meeting,
        others: Vec<Write>,
        events: Vec<Event>,
    ) -> Result<(Meeting, Vec<Option<EpisodeId>>), Problem> {
        if others.is_empty() && events.is_empty() {
            return Ok((meeting, Vec::new()));
        }
        let (at_ms, first) = (now_ms(), meeting.session.next_seq());
        let new = events.into_iter().zip(first..).map(|(event, seq)| Logged { seq, at_ms, event });
        let new: Vec<Logged> = new.collect();
        // Folded before it is written: a log that cannot be folded would lock the participant out for ever.
        let session = after(&meeting, &new);
        let session = session.map_err(|error| Problem::new(StatusCode::CONFLICT, error.to_string()))?;
        let Some(mut known) = meeting.place.take() else { return Err(interrupted()) };
        let mut writes = others;
        writes.extend(new.iter().map(|logged| as_write(known.row.id, logged)));
        let made = self.writer.write(writes).await.map_err(|error| Problem::paused(&error))?;
        (known.row.last_seq, known.row.seen_at_ms) = (session.next_seq() - 1, Some(at_ms));
        known.session = Arc::new(session);
        new.iter().for_each(|logged| self.hub.mark(marker(&known, logged)));
        known.log.extend(new);
        meeting.board.publish(&known);
        self.hub.tell(known.row.id);
        *meeting.place = Some(known);
        Ok((meeting, made))
    }

    /// Writes what leaves nothing of what is at hand true, such as a withdrawal.
    pub async fn overwrite(&self, mut meeting: Meeting, writes: Vec<Write>) -> Result<(), Problem> {
        let Some(known) = meeting.place.take() else { return Err(interrupted()) };
        self.writer.write(writes).await.map_err(|error| Problem::paused(&error))?;
        meeting.board.live.send_replace(Live { tab: None, over: true });
        *lock(&meeting.board.seen) = None;
        self.hub.tell(known.row.id);
        Ok(())
    }

    /// All who were made for a version of the file, as last seen, in the order of their numbers.
    pub async fn all(&self, study: &str) -> Result<Vec<Seen>, Problem> {
        let rows = self.hangar.store().participants(study).await.map_err(|error| Problem::paused(&error))?;
        let mut all = Vec::with_capacity(rows.len());
        for row in rows {
            all.push(self.seen(row).await?);
        }
        Ok(all)
    }

    async fn seen(&self, row: Participant) -> Result<Seen, Problem> {
        let board = self.person(row.id).board;
        let at_hand = lock(&board.seen).clone().filter(|seen| seen.row.last_seq == row.last_seq);
        if let Some(seen) = at_hand {
            return Ok(Seen { row, ..seen });
        }
        Ok(self.meet(row.id).await?.seen())
    }

    fn person(&self, id: ParticipantId) -> Person {
        lock(&self.at_hand).entry(id).or_default().clone()
    }

    async fn read(&self, id: ParticipantId) -> Result<Known, Problem> {
        let store = self.hangar.store();
        let paused = |error: StoreError| Problem::paused(&error);
        let row = store.participant(id).await.map_err(paused)?;
        let row = row.ok_or_else(|| Problem::not_found("there is no participant of this number"))?;
        let edition = self.designs.of(&row.study, &self.hangar).await.map_err(unusable)?;
        let mut log = Vec::with_capacity(row.last_seq as usize);
        for stored in store.events(id, 0).await.map_err(paused)? {
            let event = serde_json::from_str(&stored.json).map_err(unusable)?;
            log.push(Logged { seq: stored.seq, at_ms: stored.at_ms, event });
        }
        let session = Arc::new(Session::fold(&edition.design, &log).map_err(unusable)?);
        Ok(Known { row, edition, log, session })
    }
}

/// Where new events would leave somebody.
fn after(known: &Known, new: &[Logged]) -> Result<Session, FoldError> {
    let mut session = known.session.as_ref().clone();
    new.iter().try_for_each(|logged| session.push(&known.edition.design, logged))?;
    Ok(session)
}

/// What is stored of the participant cannot be used by this version; somebody has to look at it.
fn unusable(error: impl std::fmt::Display) -> Problem {
    tracing::error!(%error, "a participant's log cannot be used");
    Problem::new(StatusCode::INTERNAL_SERVER_ERROR, error.to_string())
}

fn interrupted() -> Problem {
    Problem::new(StatusCode::SERVICE_UNAVAILABLE, "a write was interrupted; try again")
}

fn as_write(participant: ParticipantId, logged: &Logged) -> Write {
    Write::Event {
        participant,
        expected_seq: logged.seq,
        event_json: serde_json::to_string(&logged.event)
            .expect("an event of strings and numbers has a JSON form"),
        at_ms: logged.at_ms,
    }
}

fn marker(known: &Known, logged: &Logged) -> Marker {
    let event = &logged.event;
    let step = event.step();
    let (episode, tick, clock_offset_ms) = match event {
        Event::FlightBegun { episode, clock_offset_ms, .. } => (Some(*episode), Some(0), *clock_offset_ms),
        Event::FlightEnded { episode, ticks, .. } => (Some(*episode), Some(*ticks), None),
        Event::FlightInterrupted { tick, .. } | Event::FlightResumed { tick, .. } => {
            (None, Some(*tick), None)
        }
        Event::FlightRefused { episode, .. } => (Some(*episode), None, None),
        _ => (None, None, None),
    };
    Marker {
        t_server_ms: logged.at_ms,
        participant: known.row.code.clone(),
        event: event.word().into(),
        step: step.map(str::to_owned),
        condition: step
            .and_then(|step| condition_of(&known.edition, &known.session, step))
            .map(|of| of.name.clone()),
        episode,
        tick,
        clock_offset_ms,
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic elsewhere leaves what is inside as it was.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
