//! One participant, from link to thanks.

use super::http::{Answer, Http};
use super::session::{Place, answer, telemetry};
use super::{Aloft, Line, Planned, VisitError};
use crate::follow::MAX_CHUNK_TICKS;
use crate::protocol::{FromPage, ToPage};
use crate::store::{EpisodeId, FlightKey};
use cohelm::plant::Ending;
use cohelm::trajectory::{MAX_TICKS, Setup};
use cohelm_study::design::timeline::{ShownContent, ShownFlight};
use cohelm_study::session::Status;
use hyper::StatusCode;
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::time::sleep;

/// How long to wait before the server is looked for again.
const LOOK_AGAIN: Duration = Duration::from_millis(100);

/// Puts a simulated person into a flight of this setup.
pub type TakeOff = dyn Fn(Setup) -> Result<Aloft, String> + Send + Sync;

/// Notes what the server says is stored.
pub type Witness = dyn Fn(&str, Heard) + Send + Sync;

/// How fast a visitor flies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As fast as both sides can: for dry runs.
    AsFastAsPossible,
    /// As a person does, on an absolute schedule, a piece of the log a second.
    RealTime,
}

/// How a visitor visits.
#[derive(Clone)]
pub struct Manner {
    /// Who flies.
    pub take_off: Arc<TakeOff>,
    /// How fast.
    pub pace: Pace,
    /// How long the server may be away before the visit is given up.
    pub patience: Duration,
    /// Is told what the server says is stored, and of whom: the participant's code comes first.
    pub witness: Arc<Witness>,
}

/// Something that the server has said is stored for good.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// An answer to a step, or what ends it.
    Step {
        /// Which step.
        id: String,
    },
    /// So many ticks of an episode.
    Ack {
        /// Which episode.
        episode: EpisodeId,
        /// How many ticks.
        ticks: u32,
    },
    /// All of it.
    Finished {
        /// Which episode.
        episode: EpisodeId,
        /// How it ended.
        ending: Ending,
        /// After how many ticks.
        ticks: u32,
    },
    /// The connection was lost, and the flight taken up again.
    Resumed {
        /// Which episode.
        episode: EpisodeId,
        /// The tick from which the server wanted more.
        from_tick: u32,
    },
}

/// How a visit ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Visited {
    /// What people call the participant.
    pub code: String,
    /// Where the participant stands.
    pub status: Status,
    /// Flights flown.
    pub flights: u32,
}

/// A simulated participant.
pub struct Visitor {
    address: SocketAddr,
    http: Http,
    tab: String,
    manner: Manner,
    line: Option<Line>,
    code: String,
    flights: u32,
}

impl Visitor {
    /// Follows a participant's link, given as its path, such as `/p/TOKEN`.
    pub async fn join(address: SocketAddr, path: &str, manner: Manner) -> Result<Self, VisitError> {
        let (http, tab) = (Http::new(address), "simulated".to_owned());
        let mut visitor = Self { address, http, tab, manner, line: None, code: String::new(), flights: 0 };
        let entered = visitor.ask(path, None).await?;
        if entered.location.is_none() {
            entered.expect("following the link")?;
        }
        Ok(visitor)
    }

    /// Goes through all steps that are left.
    pub async fn walk(&mut self) -> Result<Visited, VisitError> {
        let opening = json!({ "tab": self.tab, "client": { "simulated": true } });
        let mut place = self.post("/api/session/open", &opening, "opening the session").await?;
        if !place.participant.simulated {
            return Err(VisitError::NotSimulated(place.participant.code));
        }
        self.code.clone_from(&place.participant.code);
        loop {
            let step = match place.steps.into_iter().next() {
                Some(step) if !matches!(step.content, ShownContent::Thanks { .. }) => step,
                _ => {
                    let (code, status) = (place.participant.code, place.status);
                    return Ok(Visited { code, status, flights: self.flights });
                }
            };
            let begun = Instant::now();
            let data = match &step.content {
                ShownContent::Flight(flight) => self.fly(flight).await?,
                other => answer(other),
            };
            let body =
                json!({ "tab": self.tab, "data": data, "page_ms": begun.elapsed().as_secs_f64() * 1e3 });
            let path = format!("/api/session/steps/{}", step.id);
            place = self.post(&path, &body, &step.id).await?;
            self.note(Heard::Step { id: step.id });
        }
    }

    fn note(&self, heard: Heard) {
        (self.manner.witness)(&self.code, heard);
    }

    async fn post(&mut self, path: &str, body: &Value, what: &str) -> Result<Place, VisitError> {
        Place::read(self.ask(path, Some(body)).await?.expect(what)?)
    }

    /// Asks until the server is there: whatever is asked here may come twice.
    async fn ask(&mut self, path: &str, body: Option<&Value>) -> Result<Answer, VisitError> {
        let given_up = Instant::now() + self.manner.patience;
        loop {
            let asked = match body {
                Some(body) => self.http.post(path, body).await,
                None => self.http.get(path).await,
            };
            let absent = match &asked {
                Ok(answer) => answer.status == StatusCode::SERVICE_UNAVAILABLE,
                Err(error) => error.is_absence(),
            };
            if !absent || Instant::now() >= given_up {
                return asked;
            }
            sleep(LOOK_AGAIN).await;
        }
    }

    /// Flies the flight of a step, whatever becomes of the connection; gives the telemetry.
    async fn fly(&mut self, step: &ShownFlight) -> Result<Value, VisitError> {
        let flight = self.plan(step).await?;
        if step.flown.is_some() {
            return Ok(telemetry(&flight));
        }
        let begun = Instant::now();
        let mut given_up = begun + self.manner.patience;
        loop {
            match self.deliver(&flight, begun).await {
                Ok(()) => break,
                Err(error) if error.is_absence() && Instant::now() < given_up => {
                    self.line = None;
                    sleep(LOOK_AGAIN).await;
                }
                Err(error) => return Err(error),
            }
            given_up = Instant::now() + self.manner.patience;
        }
        self.flights += 1;
        Ok(telemetry(&flight))
    }

    async fn plan(&self, step: &ShownFlight) -> Result<Planned, VisitError> {
        let key = flight_key(&step.flight_key)
            .ok_or_else(|| VisitError::Unclear(format!("{:?} is no flight's key", step.flight_key)))?;
        let piece = match self.manner.pace {
            Pace::AsFastAsPossible => MAX_CHUNK_TICKS,
            Pace::RealTime => super::planned::PIECE_TICKS,
        };
        let (take_off, setup) = (self.manner.take_off.clone(), step.setup.clone());
        let flown = tokio::task::spawn_blocking(move || {
            take_off(setup).map(|aloft| Planned::cut(aloft, key, MAX_TICKS as u32, piece))
        });
        let flown = flown.await.map_err(|error| VisitError::Gone(error.to_string()))?;
        flown.map_err(VisitError::TakeOff)
    }

    /// Sends what the server does not have yet, each piece when it is due, and the end.
    async fn deliver(&mut self, flight: &Planned, begun: Instant) -> Result<(), VisitError> {
        let again = self.line.is_none();
        let line = match &mut self.line {
            Some(line) => line,
            none => none.insert(Line::connect(self.address, self.http.cookies().as_deref()).await?),
        };
        let note = |heard| (self.manner.witness)(&self.code, heard);
        line.say(&flight.begin(begun.elapsed())).await?;
        let (episode, committed) = match line.answer().await? {
            ToPage::Begun { episode, committed_tick } => (episode, committed_tick),
            ToPage::Finished { episode } => {
                note(finished(flight, episode));
                return Ok(());
            }
            ToPage::Refused { reason } => return Err(VisitError::Refused(reason)),
            said => return Err(VisitError::OutOfTurn { expected: "the flight's beginning".into(), said }),
        };
        if again && committed > 0 {
            note(Heard::Resumed { episode, from_tick: committed });
        }
        for piece in flight.pieces.iter().filter(|piece| piece.to_tick > committed) {
            if self.manner.pace == Pace::RealTime {
                tokio::time::sleep_until((begun + flight.after(piece.to_tick)).into()).await;
            }
            line.say(&FromPage::Chunk(piece.clone())).await?;
            match line.answer().await? {
                ToPage::Ack { committed_tick } if committed_tick == piece.to_tick => {
                    note(Heard::Ack { episode, ticks: committed_tick });
                }
                ToPage::Refused { reason } => return Err(VisitError::Refused(reason)),
                said => {
                    let expected = format!("the acknowledgement of {} ticks", piece.to_tick);
                    return Err(VisitError::OutOfTurn { expected, said });
                }
            }
        }
        line.say(&FromPage::End(flight.end)).await?;
        match line.answer().await? {
            ToPage::Finished { episode } => {
                note(finished(flight, episode));
                Ok(())
            }
            ToPage::Refused { reason } => Err(VisitError::Refused(reason)),
            said => Err(VisitError::OutOfTurn { expected: "the flight's end".into(), said }),
        }
    }
}

fn finished(flight: &Planned, episode: EpisodeId) -> Heard {
    let (ending, ticks) = (flight.end.ending, flight.end.ticks);
    Heard::Finished { episode, ending, ticks }
}

/// The key of 32 hexadecimal digits.
fn flight_key(text: &str) -> Option<FlightKey> {
    let mut key = [0; 16];
    for (byte, digits) in key.iter_mut().zip(text.as_bytes().chunks(2)) {
        *byte = u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?;
    }
    (text.len() == 32).then_some(FlightKey(key))
}
