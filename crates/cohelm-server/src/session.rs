//! One connection with a page: flights are followed, stored and acknowledged, one after the other.
//!
//! Generic over the two halves of the socket, so that channels test it. Each message is dealt with to its end before
//! the next is read: a page that sends faster than it is followed waits.

mod flight;
#[cfg(test)]
mod tests;

use crate::lease::Lease;
use crate::limits::{Bucket, OF_A_CONNECTION};
use crate::protocol::{FromPage, ProtocolError, ToPage, cut};
use crate::server::Server;
use crate::study::flights::{Farewell, Passenger};
use axum::extract::ws::{CloseFrame, Message};
use flight::InTheAir;
use futures_util::{Sink, SinkExt, Stream, StreamExt};
use std::convert::Infallible;
use std::fmt::Display;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::{Instant, Interval, interval, sleep, sleep_until, timeout};

/// How often a page is asked whether it is still there.
const PING_EVERY: Duration = Duration::from_secs(15);
/// A connection that was silent for so long is lost; pages answer pings by themselves.
const SILENCE: Duration = Duration::from_secs(45);
/// How long a page may take to accept a message: longer, and it is lost.
const SEND_WITHIN: Duration = Duration::from_secs(10);
/// How long a page may take to answer a close.
const CLOSE_WITHIN: Duration = Duration::from_secs(1);
/// Codes of our own: another tab goes on; nothing more is taken in from this participant.
const ANOTHER_TAB: u16 = 4001;
const OVER: u16 = 4003;
/// Most bytes of a close frame's reason (RFC 6455, section 5.5).
const MAX_CLOSE_REASON: usize = 123;

/// Why a connection ends: code (RFC 6455, section 7.4) and reason. Code 0: it is gone already.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Hangup {
    code: u16,
    reason: String,
}

impl Hangup {
    fn new(code: u16, reason: impl Display) -> Self {
        Self { code, reason: reason.to_string() }
    }

    fn gone(reason: impl Display) -> Self {
        Self::new(0, reason)
    }

    fn away(reason: impl Display) -> Self {
        Self::new(1001, reason)
    }

    fn out_of_turn(reason: impl Display) -> Self {
        Self::new(1002, reason)
    }

    fn cannot_write(reason: impl Display) -> Self {
        Self::new(1011, reason)
    }

    fn of(farewell: Farewell) -> Self {
        match farewell {
            Farewell::TakenOver => Self::new(ANOTHER_TAB, "the study goes on in another tab"),
            Farewell::Over => Self::new(OVER, "the study is over for this participant"),
        }
    }
}

impl From<ProtocolError> for Hangup {
    fn from(error: ProtocolError) -> Self {
        let code = if matches!(error, ProtocolError::TooLarge { .. }) { 1009 } else { 1002 };
        Self::new(code, error)
    }
}

/// Talks with a page until one of the two goes. A flight that is in the air then can be taken up again.
/// In a study, `passenger` is the participant who flies.
pub(crate) async fn converse<I, O, E>(
    server: &Server,
    passenger: Option<Passenger>,
    mut incoming: I,
    mut outgoing: O,
) where
    I: Stream<Item = Result<Message, E>> + Unpin,
    O: Sink<Message> + Unpin,
    E: Display,
{
    let mut session = Session::new(server, passenger);
    let Err(hangup) = session.talk(&mut incoming, &mut outgoing).await;
    tracing::info!(code = hangup.code, reason = hangup.reason, "connection ends");
    // Whoever waits to take the flight over need not wait for the farewell.
    drop(session);
    if hangup.code != 0 {
        say_farewell(hangup, incoming, outgoing).await;
    }
}

/// What happens to a session next.
enum Event<E> {
    Frame(Result<Message, E>),
    Gone,
    Silence,
    Ping,
    News(String),
    TakenOver,
    MustLeave(Farewell),
    Closing,
}

struct Session<'a> {
    server: &'a Server,
    passenger: Option<Passenger>,
    allowance: Bucket,
    flight: Option<InTheAir>,
    /// The last flight was refused: pieces of it may still be on their way.
    ignoring: bool,
    news: Option<watch::Receiver<String>>,
    heard: Instant,
    pings: Interval,
}

impl<'a> Session<'a> {
    fn new(server: &'a Server, passenger: Option<Passenger>) -> Self {
        let mut pings = interval(PING_EVERY);
        pings.reset();
        let news = server.news();
        let (allowance, heard) = (Bucket::new(OF_A_CONNECTION), Instant::now());
        Self { server, passenger, allowance, flight: None, ignoring: false, news, heard, pings }
    }

    /// Ends with a hangup, whatever happens.
    async fn talk<I, O, E>(&mut self, incoming: &mut I, outgoing: &mut O) -> Result<Infallible, Hangup>
    where
        I: Stream<Item = Result<Message, E>> + Unpin,
        O: Sink<Message> + Unpin,
        E: Display,
    {
        self.say(outgoing, ToPage::Welcome(self.server.welcome())).await?;
        loop {
            match self.next_event(incoming).await {
                Event::Frame(Ok(Message::Binary(bytes))) => {
                    self.heard = Instant::now();
                    // Whoever sends too fast waits, and the page's socket fills up behind it.
                    while let Err(wait) = self.allowance.take() {
                        sleep(wait).await;
                    }
                    if let Some(answer) = self.hear(&bytes).await? {
                        self.say(outgoing, answer).await?;
                    }
                }
                Event::Frame(Ok(Message::Ping(_) | Message::Pong(_))) => self.heard = Instant::now(),
                Event::Frame(Ok(Message::Text(_))) => return Err(Hangup::new(1003, "messages are binary")),
                Event::Frame(Ok(Message::Close(_))) => return Err(Hangup::gone("the page closed")),
                Event::Frame(Err(error)) => return Err(Hangup::out_of_turn(error)),
                Event::Gone => return Err(Hangup::gone("the connection broke")),
                Event::Silence => return Err(Hangup::away("nothing was heard from the page for too long")),
                Event::Ping => self.send(outgoing, Message::Ping(Default::default())).await?,
                Event::News(values) => {
                    if let Some(hash) = hash_bytes(&values) {
                        self.say(outgoing, ToPage::NewModel { hash }).await?;
                    }
                }
                Event::TakenOver => return Err(Hangup::away("another connection went on with this flight")),
                Event::MustLeave(farewell) => return Err(Hangup::of(farewell)),
                Event::Closing => return Err(Hangup::away("the server stops; connect again later")),
            }
        }
    }

    async fn next_event<I, E>(&mut self, incoming: &mut I) -> Event<E>
    where
        I: Stream<Item = Result<Message, E>> + Unpin,
    {
        tokio::select! {
            biased;
            () = self.server.closing().cancelled() => Event::Closing,
            () = taken_over(self.flight.as_ref().map(InTheAir::lease)) => Event::TakenOver,
            farewell = must_leave(self.passenger.as_mut()) => Event::MustLeave(farewell),
            frame = incoming.next() => frame.map_or(Event::Gone, Event::Frame),
            values = news(self.news.as_mut()), if self.flight.is_none() => Event::News(values),
            _ = self.pings.tick() => Event::Ping,
            () = sleep_until(self.heard + SILENCE) => Event::Silence,
        }
    }

    /// Deals with one message to its end; gives the answer, if there is one.
    async fn hear(&mut self, bytes: &[u8]) -> Result<Option<ToPage>, Hangup> {
        match (FromPage::from_bytes(bytes)?, self.flight.take()) {
            (FromPage::Begin(begin), before) => {
                if let Some(before) = before {
                    before.leave(self.server, self.passenger.as_ref()).await?;
                }
                let (flight, answer) = InTheAir::begin(self.server, self.passenger.as_ref(), begin).await?;
                (self.ignoring, self.flight) = (flight.is_none(), flight);
                Ok(Some(answer))
            }
            (FromPage::Chunk(chunk), Some(flight)) => {
                let (flight, answer) = flight.follow(self.server, self.passenger.as_ref(), chunk).await?;
                (self.ignoring, self.flight) = (flight.is_none(), flight);
                Ok(Some(answer))
            }
            (FromPage::End(end), Some(flight)) => {
                let answer = flight.land(self.server, self.passenger.as_ref(), end).await?;
                self.ignoring = matches!(answer, ToPage::Refused { .. });
                Ok(Some(answer))
            }
            (_, None) if self.ignoring => Ok(None),
            (_, None) => Err(Hangup::out_of_turn("a log of a flight that has not begun")),
        }
    }

    async fn say<O: Sink<Message> + Unpin>(&mut self, outgoing: &mut O, words: ToPage) -> Result<(), Hangup> {
        self.send(outgoing, Message::Binary(words.to_bytes().into())).await
    }

    async fn send<O: Sink<Message> + Unpin>(
        &mut self,
        outgoing: &mut O,
        message: Message,
    ) -> Result<(), Hangup> {
        tokio::select! {
            sent = timeout(SEND_WITHIN, outgoing.send(message)) => match sent {
                Ok(Ok(())) => Ok(()),
                Ok(Err(_)) => Err(Hangup::gone("the connection broke")),
                Err(_) => Err(Hangup::gone("the page takes no message")),
            },
            () = taken_over(self.flight.as_ref().map(InTheAir::lease)) => {
                Err(Hangup::away("another connection went on with this flight"))
            }
        }
    }
}

async fn must_leave(passenger: Option<&mut Passenger>) -> Farewell {
    match passenger {
        Some(passenger) => passenger.must_leave().await,
        None => std::future::pending().await,
    }
}

async fn taken_over(lease: Option<&Lease>) {
    match lease {
        Some(lease) => lease.taken_over().await,
        None => std::future::pending().await,
    }
}

/// The values that assist from now on, once they change.
async fn news(news: Option<&mut watch::Receiver<String>>) -> String {
    let Some(news) = news else { return std::future::pending().await };
    match news.changed().await {
        Ok(()) => news.borrow_and_update().clone(),
        Err(_) => std::future::pending().await,
    }
}

fn hash_bytes(hex: &str) -> Option<[u8; 32]> {
    let mut bytes = [0; 32];
    for (byte, digits) in bytes.iter_mut().zip(hex.as_bytes().chunks(2)) {
        *byte = u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?;
    }
    (hex.len() == 64).then_some(bytes)
}

/// Says why, and reads on for a moment: a socket that is closed with unread bytes loses what was said last.
async fn say_farewell<I, O, E>(hangup: Hangup, mut incoming: I, mut outgoing: O)
where
    I: Stream<Item = Result<Message, E>> + Unpin,
    O: Sink<Message> + Unpin,
{
    let reason = cut(&hangup.reason, MAX_CLOSE_REASON).into();
    let frame = CloseFrame { code: hangup.code, reason };
    let farewell = async {
        let _ = outgoing.send(Message::Close(Some(frame))).await;
        while let Some(Ok(_)) = incoming.next().await {}
    };
    let _ = timeout(CLOSE_WITHIN, farewell).await;
}
