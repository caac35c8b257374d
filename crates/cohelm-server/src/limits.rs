//! How often somebody may ask: token buckets. Knows no address of anybody: what is limited is a participant, a
//! connection, or everybody together.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use tokio::time::Instant;

/// How often: `per_s` in the long run, `burst` at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Requests a second, in the long run.
    pub per_s: f64,
    /// Requests at once after a pause.
    pub burst: f64,
}

/// Requests of one participant: a page sends one every few seconds; after a lost connection some at once. A script that
/// waits for each commit stays below it.
pub const OF_A_PARTICIPANT: Rate = Rate { per_s: 20.0, burst: 100.0 };
/// Messages on one connection: a page sends one a second while it flies.
pub const OF_A_CONNECTION: Rate = Rate { per_s: 50.0, burst: 200.0 };
/// People who come by a link of their own, all together. Guessing 128 bits is hopeless anyway; this keeps it from
/// costing much.
pub const OF_LINKS: Rate = Rate { per_s: 50.0, burst: 600.0 };
/// People who come by the open link, all together: a lecture hall at once, but no flood of rows.
pub const OF_JOINS: Rate = Rate { per_s: 5.0, burst: 300.0 };
/// Attempts at the researcher's secret, all together: each costs 20 ms and 19 MiB.
pub const OF_LOGINS: Rate = Rate { per_s: 0.2, burst: 10.0 };

/// Keys that one table of buckets remembers before it forgets those that are full again.
const MOST_KEYS: usize = 4096;

/// What is left of a rate.
#[derive(Clone, Debug)]
pub struct Bucket {
    rate: Rate,
    left: f64,
    at: Instant,
}

impl Bucket {
    /// A full one.
    pub fn new(rate: Rate) -> Self {
        Self { rate, left: rate.burst, at: Instant::now() }
    }

    /// Takes one, or says how long to wait for it.
    pub fn take(&mut self) -> Result<(), Duration> {
        self.fill();
        if self.left >= 1.0 {
            self.left -= 1.0;
            return Ok(());
        }
        Err(Duration::from_secs_f64((1.0 - self.left) / self.rate.per_s))
    }

    fn fill(&mut self) {
        let now = Instant::now();
        let since_s = now.saturating_duration_since(self.at).as_secs_f64();
        self.left = (self.left + since_s * self.rate.per_s).min(self.rate.burst);
        self.at = now;
    }
}

/// A bucket for each of many.
#[derive(Debug)]
pub struct Buckets<K> {
    rate: Rate,
    of: Mutex<HashMap<K, Bucket>>,
}

impl<K: Hash + Eq> Buckets<K> {
    /// Buckets that are all full.
    pub fn new(rate: Rate) -> Self {
        Self { rate, of: Mutex::default() }
    }

    /// Takes one of this one's, or says how long to wait for it.
    pub fn take(&self, key: K) -> Result<(), Duration> {
        // A panic elsewhere leaves the numbers as they were.
        let mut of = self.of.lock().unwrap_or_else(PoisonError::into_inner);
        if of.len() >= MOST_KEYS {
            of.retain(|_, bucket| {
                bucket.fill();
                bucket.left < bucket.rate.burst
            });
        }
        of.entry(key).or_insert_with(|| Bucket::new(self.rate)).take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::time::advance;

    const RATE: Rate = Rate { per_s: 2.0, burst: 3.0 };

    #[tokio::test(start_paused = true)]
    async fn a_burst_passes_then_one_at_a_time() {
        let mut bucket = Bucket::new(RATE);
        assert!((0..3).all(|_| bucket.take().is_ok()));
        assert_eq!(bucket.take(), Err(Duration::from_millis(500)));
        advance(Duration::from_millis(500)).await;
        assert_eq!((bucket.take(), bucket.take().is_err()), (Ok(()), true));
        advance(Duration::from_secs(3600)).await;
        assert_eq!(
            (0..10).filter(|_| bucket.take().is_ok()).count(),
            3,
            "a pause saves no more than a burst"
        );
    }

    #[tokio::test(start_paused = true)]
    async fn one_does_not_use_up_what_is_anothers_and_old_ones_are_forgotten() {
        let buckets = Buckets::new(RATE);
        assert!((0..3).all(|_| buckets.take(1).is_ok()) && buckets.take(1).is_err());
        assert!(buckets.take(2).is_ok());
        for key in 10..10 + MOST_KEYS {
            let _ = buckets.take(key);
        }
        advance(Duration::from_secs(60)).await;
        assert!(buckets.take(1).is_ok());
        assert!(buckets.of.lock().unwrap().len() < 10);
    }
}
