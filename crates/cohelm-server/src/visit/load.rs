//! Many participants at once, each on an absolute schedule: how long the server lets them wait.
//!
//! Flights are flown before the clock starts, since in a study the pages fly them on machines of their own; what is sent
//! when is what pages would send. A wait is counted from the moment at which the flight was where a piece of its log
//! ends, not from when the piece was sent: a sender that falls behind makes its waits longer, never shorter.

use super::{Line, Planned, VisitError};
use crate::protocol::{FromPage, ToPage};
use futures_util::future::try_join_all;
use std::collections::VecDeque;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::time::{Instant, sleep_until, timeout_at};

/// How long after the last message was due the last answer may come.
const PATIENCE: Duration = Duration::from_secs(60);
/// Connections that are opened at once.
const OPENING: usize = 50;

/// What the server has to answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Begun,
    Ack(u32),
    Finished,
}

/// Something that a page says, and when.
#[derive(Debug, PartialEq)]
struct Cue {
    at: Duration,
    words: FromPage,
    answer: Answer,
}

/// What one participant sends: flights one after the other, without a pause.
fn cues(begin: Duration, flights: Vec<Planned>) -> VecDeque<Cue> {
    let mut cues = VecDeque::new();
    let mut begin = begin;
    for flight in flights {
        cues.push_back(Cue { at: begin, words: flight.begin(Duration::ZERO), answer: Answer::Begun });
        for piece in &flight.pieces {
            let (at, answer) = (begin + flight.after(piece.to_tick), Answer::Ack(piece.to_tick));
            cues.push_back(Cue { at, words: FromPage::Chunk(piece.clone()), answer });
        }
        begin += flight.after(flight.ticks());
        cues.push_back(Cue { at: begin, words: FromPage::End(flight.end), answer: Answer::Finished });
    }
    cues
}

/// How long participants waited, milliseconds, in no order.
#[derive(Clone, Debug, Default)]
pub struct Waits {
    /// From where a flight was when a piece of its log ended, to the acknowledgement of the piece.
    pub pieces_ms: Vec<f64>,
    /// From the end of a flight to the word that its record is stored.
    pub ends_ms: Vec<f64>,
    /// By how much this side was late in sending: part of the waits, and not the server's doing.
    pub late_ms: Vec<f64>,
}

impl Waits {
    fn note(&mut self, answer: Answer, wait: Duration) {
        let wait_ms = wait.as_secs_f64() * 1e3;
        match answer {
            Answer::Begun => {}
            Answer::Ack(_) => self.pieces_ms.push(wait_ms),
            Answer::Finished => self.ends_ms.push(wait_ms),
        }
    }

    fn add(&mut self, other: Self) {
        self.pieces_ms.extend(other.pieces_ms);
        self.ends_ms.extend(other.ends_ms);
        self.late_ms.extend(other.late_ms);
    }
}

/// Connects so many pages, some at a time.
pub async fn connect(address: SocketAddr, pages: usize) -> Result<Vec<Line>, VisitError> {
    let mut lines = Vec::with_capacity(pages);
    while lines.len() < pages {
        let next = OPENING.min(pages - lines.len());
        lines.extend(try_join_all((0..next).map(|_| Line::connect(address, None))).await?);
    }
    Ok(lines)
}

/// Flies everything; `rotas` holds for each line when it begins and what it flies. Ends with the last answer, or with the
/// first thing that goes wrong.
pub async fn fly(lines: Vec<Line>, rotas: Vec<(Duration, Vec<Planned>)>) -> Result<Waits, VisitError> {
    let start = Instant::now() + Duration::from_millis(200);
    let pages = lines.into_iter().zip(rotas).map(|(line, (begin, flights))| {
        let page = tokio::spawn(page(line, cues(begin, flights), start));
        async { page.await.map_err(|error| VisitError::Gone(error.to_string()))? }
    });
    let mut all = Waits::default();
    try_join_all(pages).await?.into_iter().for_each(|waits| all.add(waits));
    Ok(all)
}

/// One page: says each thing when it is due, whatever has been answered by then.
async fn page(mut line: Line, mut cues: VecDeque<Cue>, start: Instant) -> Result<Waits, VisitError> {
    let mut waits = Waits::default();
    let mut awaited = VecDeque::new();
    let last = cues.back().map_or(start, |cue| start + cue.at);
    while !(cues.is_empty() && awaited.is_empty()) {
        let next = cues.front().map(|cue| start + cue.at);
        tokio::select! {
            biased;
            () = sleep_until(next.unwrap_or(last)), if next.is_some() => {
                let Some(cue) = cues.pop_front() else { continue };
                let due = start + cue.at;
                waits.late_ms.push(due.elapsed().as_secs_f64() * 1e3);
                line.say(&cue.words).await?;
                awaited.push_back((cue.answer, due));
            }
            said = timeout_at(last + PATIENCE, line.listen()) => {
                let said = said.map_err(|_| VisitError::Silence(PATIENCE))??;
                if let Some((answer, due)) = answered(&mut awaited, said)? {
                    waits.note(answer, due.elapsed());
                }
            }
        }
    }
    Ok(waits)
}

/// What was answered, and when it was due; an error if anything else was said.
fn answered(
    awaited: &mut VecDeque<(Answer, Instant)>,
    said: ToPage,
) -> Result<Option<(Answer, Instant)>, VisitError> {
    let answer = match said {
        ToPage::NewModel { .. } => return Ok(None),
        ToPage::Refused { reason } => return Err(VisitError::Refused(reason)),
        ToPage::Begun { .. } => Some(Answer::Begun),
        ToPage::Ack { committed_tick } => Some(Answer::Ack(committed_tick)),
        ToPage::Finished { .. } => Some(Answer::Finished),
        ToPage::Welcome(_) => None,
    };
    let next = awaited.pop_front();
    if next.map(|(due, _)| due) == answer {
        return Ok(next);
    }
    let expected = next.map_or("nothing".into(), |(due, _)| format!("{due:?}"));
    Err(VisitError::OutOfTurn { expected, said })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::Assets;
    use crate::store::{Page, Progress, Store};
    use crate::testing::{Disk, flight, key, setup};
    use crate::visit::Aloft;
    use crate::visit::testing::{Running, person};

    fn planned(number: u8, most_ticks: u32) -> Planned {
        let aloft = Aloft::new(flight(setup(number.into())), person(number.into()), 0).unwrap();
        Planned::fly(aloft, key(number), most_ticks)
    }

    #[test]
    fn pieces_are_due_where_the_flight_is_then() {
        let (first, second) = (planned(1, 120), planned(2, 10));
        assert_eq!((first.ticks(), second.ticks()), (120, 10));
        let cues = cues(Duration::from_millis(100), vec![first, second]);
        let told: Vec<_> = cues.iter().map(|cue| (cue.at.as_millis(), cue.answer)).collect();
        use Answer::{Ack, Begun, Finished};
        let first = [(100, Begun), (1100, Ack(50)), (2100, Ack(100)), (2500, Ack(120)), (2500, Finished)];
        assert_eq!(told[..5], first);
        assert_eq!(told[5..], [(2500, Begun), (2700, Ack(10)), (2700, Finished)]);
    }

    #[tokio::test]
    async fn every_flight_of_a_load_is_stored() {
        let disk = Disk::new().await;
        let running = Running::new(disk.server_with(None, Assets::of(&[])).await).await;
        let lines = connect(running.address, 3).await.unwrap();
        let rota = |line: u8| (Duration::ZERO, vec![planned(line * 2, 10), planned(line * 2 + 1, 30)]);
        let waits = fly(lines, (0..3).map(rota).collect()).await.unwrap();
        assert_eq!((waits.pieces_ms.len(), waits.ends_ms.len(), waits.late_ms.len()), (6, 6, 18));
        let stored = disk.store.episodes(Page::newest(9)).await.unwrap();
        assert_eq!(stored.len(), 6);
        assert!(stored.iter().all(|row| matches!(row.progress, Progress::Finished { .. })));
    }

    #[tokio::test]
    async fn a_flight_that_is_not_believed_ends_the_load() {
        let disk = Disk::new().await;
        let running = Running::new(disk.server_with(None, Assets::of(&[])).await).await;
        let mut flight = planned(1, 10);
        flight.pieces[0].digests.plant ^= 1;
        let lines = connect(running.address, 1).await.unwrap();
        let outcome = fly(lines, vec![(Duration::ZERO, vec![flight])]).await;
        assert!(matches!(outcome, Err(VisitError::Refused(_))), "{outcome:?}");
    }
}
