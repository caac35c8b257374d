//! One connection a flight: a second one takes it over, once the first has finished what it was doing.

use crate::store::FlightKey;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::OwnedMutexGuard;
use tokio_util::sync::CancellationToken;

/// Who holds which flight.
#[derive(Clone, Default)]
pub struct Leases {
    holders: Arc<Mutex<HashMap<FlightKey, Holder>>>,
}

#[derive(Clone)]
struct Holder {
    taken_over: CancellationToken,
    gate: Arc<tokio::sync::Mutex<()>>,
}

/// The right to go on with a flight, until it is dropped.
pub struct Lease {
    key: FlightKey,
    leases: Leases,
    taken_over: CancellationToken,
    _gate: OwnedMutexGuard<()>,
}

impl Leases {
    /// Takes the flight; asks whoever holds it to let go, and waits for that.
    pub async fn take(&self, key: FlightKey) -> Lease {
        loop {
            let (holder, held) = self.holder_or_new(key);
            let Some(gate) = held else {
                holder.taken_over.cancel();
                // Only to wait: the map decides who is next.
                drop(holder.gate.lock_owned().await);
                continue;
            };
            return Lease { key, leases: self.clone(), taken_over: holder.taken_over, _gate: gate };
        }
    }

    /// The holder of a flight; if there was none a new one, with its gate held.
    fn holder_or_new(&self, key: FlightKey) -> (Holder, Option<OwnedMutexGuard<()>>) {
        let mut holders = self.lock();
        if let Some(holder) = holders.get(&key) {
            return (holder.clone(), None);
        }
        let holder = Holder { taken_over: CancellationToken::new(), gate: Arc::default() };
        let gate = holder.gate.clone().try_lock_owned().ok();
        holders.insert(key, holder.clone());
        (holder, gate)
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<FlightKey, Holder>> {
        // A panic elsewhere leaves the map a map.
        self.holders.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Lease {
    /// Returns when another connection wants the flight.
    pub async fn taken_over(&self) {
        self.taken_over.cancelled().await;
    }
}

impl Drop for Lease {
    fn drop(&mut self) {
        // Before the gate opens, so that whoever waits finds the place free.
        self.leases.lock().remove(&self.key);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::key;
    use std::time::Duration;
    use tokio::time::timeout;

    #[tokio::test]
    async fn a_second_taker_waits_until_the_first_lets_go() {
        let leases = Leases::default();
        let first = leases.take(key(1)).await;
        let second = tokio::spawn({
            let leases = leases.clone();
            async move { leases.take(key(1)).await }
        });
        timeout(Duration::from_secs(5), first.taken_over()).await.expect("the first is asked to let go");
        assert!(!second.is_finished());
        drop(first);
        drop(timeout(Duration::from_secs(5), second).await.expect("the second gets it").unwrap());
        assert!(leases.lock().is_empty());
    }

    #[tokio::test]
    async fn flights_do_not_wait_for_each_other_and_a_crowd_is_served() {
        let leases = Leases::default();
        let _other = leases.take(key(2)).await;
        let takers: Vec<_> = (0..20)
            .map(|_| {
                let leases = leases.clone();
                tokio::spawn(async move { leases.take(key(1)).await.taken_over.is_cancelled() })
            })
            .collect();
        for taker in takers {
            timeout(Duration::from_secs(5), taker).await.expect("each gets its turn").unwrap();
        }
        assert_eq!(leases.lock().len(), 1);
    }
}
