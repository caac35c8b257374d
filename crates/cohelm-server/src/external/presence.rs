//! Whether somebody is at the page: what was heard from it, and what it has shown of what it was sent.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::Notify;

/// After how long without a word from the page, or with a tick that it has not shown, everything is let go of: shorter
/// flickers with the network, longer leaves a machine moving with nobody who sees it. The page says ten times a second that
/// it is there.
pub const LET_GO_AFTER: Duration = Duration::from_millis(300);
/// After how long the episode ends.
pub const END_AFTER: Duration = Duration::from_secs(2);
/// Most ticks that are sent and not yet shown: fewer halt the picture while a word is on its way, more hide how old it is.
const UNSHOWN: usize = 5;

/// Whether somebody is at the page.
#[derive(Clone)]
pub struct Presence(Arc<Shared>);

struct Shared {
    present: Mutex<Present>,
    /// The page has shown more.
    shows: Notify,
}

struct Present {
    heard: Instant,
    /// The newest tick that the page has shown.
    shown: Option<u32>,
    /// Ticks that were sent and not yet shown, the oldest first, and when they were sent.
    unshown: VecDeque<(u32, Instant)>,
    /// Why it is over, and whether that was the person's wish.
    over: Option<(String, bool)>,
}

impl Presence {
    /// Somebody is there now.
    pub fn new() -> Self {
        let present = Present { heard: Instant::now(), shown: None, unshown: VecDeque::new(), over: None };
        Self(Arc::new(Shared { present: Mutex::new(present), shows: Notify::new() }))
    }

    /// The flight begins; until here nobody had anything to say.
    pub fn begin(&self) {
        self.lock().heard = Instant::now();
    }

    /// Somebody is there, and has seen that tick.
    pub fn here(&self, shown: Option<u32>) {
        let mut present = self.lock();
        present.heard = Instant::now();
        if let Some(newest) = shown {
            present.shown = present.shown.max(shown);
            present.unshown.retain(|(tick, _)| *tick > newest);
        }
        drop(present);
        self.0.shows.notify_one();
    }

    /// A tick is sent to the page.
    pub fn sent(&self, tick: u32) {
        self.lock().unshown.push_back((tick, Instant::now()));
    }

    /// Waits until the page has shown all but a few of the ticks that it was sent.
    pub async fn keeps_up(&self) {
        while self.lock().unshown.len() >= UNSHOWN {
            self.0.shows.notified().await;
        }
    }

    /// True if the page has shown that tick or a later one.
    pub fn has_shown(&self, tick: u32) -> bool {
        self.lock().shown.is_some_and(|shown| shown >= tick)
    }

    /// The person ends the episode.
    pub fn stop(&self) {
        self.over("the person ended it", true);
    }

    /// The person was lost for good.
    pub fn lose(&self, why: &str) {
        self.over(why, false);
    }

    fn over(&self, why: &str, wished: bool) {
        self.lock().over.get_or_insert_with(|| (why.to_owned(), wished));
    }

    /// How long nothing was heard, or what was sent is not shown, whichever is longer; and which of them it is, in words
    /// that go before a time.
    pub fn silence(&self) -> (Duration, &'static str) {
        let present = self.lock();
        let lag = present.unshown.front().map_or(Duration::ZERO, |(_, sent)| sent.elapsed());
        let unheard = present.heard.elapsed();
        // Who says nothing shows nothing either; that is told only of a page that still speaks.
        let words = if unheard <= LET_GO_AFTER && lag > unheard {
            "the page has shown nothing new for"
        } else {
            "nothing was heard from the page for"
        };
        (unheard.max(lag), words)
    }

    /// Why it is over, if it is, and whether that was the person's wish.
    pub fn is_over(&self) -> Option<(String, bool)> {
        self.lock().over.clone()
    }

    fn lock(&self) -> MutexGuard<'_, Present> {
        // A panic elsewhere leaves a time a time.
        self.0.present.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread::sleep;
    use tokio::time::timeout;

    const A_WHILE: Duration = Duration::from_millis(250);

    #[test]
    fn who_speaks_but_shows_nothing_newer_is_silent() {
        let presence = Presence::new();
        presence.sent(0);
        presence.sent(1);
        presence.here(Some(0));
        sleep(A_WHILE);
        presence.here(Some(0));
        let (lasted, words) = presence.silence();
        assert!(lasted >= A_WHILE && words.contains("shown nothing new"), "tick 1 is not shown: {words}");
        presence.here(Some(1));
        assert!(presence.silence().0 < A_WHILE);
        assert!(presence.has_shown(1) && !presence.has_shown(2));
    }

    #[tokio::test]
    async fn a_few_ticks_may_be_on_their_way_and_no_more() {
        let presence = Presence::new();
        for tick in 0..UNSHOWN as u32 {
            timeout(A_WHILE, presence.keeps_up()).await.expect("there is room");
            presence.sent(tick);
        }
        timeout(A_WHILE, presence.keeps_up()).await.expect_err("there is none");
        presence.here(None);
        timeout(A_WHILE, presence.keeps_up()).await.expect_err("nothing more was shown");
        presence.here(Some(2));
        timeout(A_WHILE, presence.keeps_up()).await.expect("there is room again");
    }
}
