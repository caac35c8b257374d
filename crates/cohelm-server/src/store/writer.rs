//! One task that writes: what many sockets have to write becomes few transactions.

use super::{EpisodeId, Store, StoreError, Write};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, oneshot};
use tokio::time::{Instant, sleep_until};

/// Least time between the beginnings of two transactions: shorter acknowledges sooner, longer lets more sockets share
/// one wait for the disk. After a pause longer than this a write is committed at once.
pub const COMMIT_EVERY: Duration = Duration::from_millis(100);
/// Most jobs in one transaction.
const MOST_JOBS: usize = 1024;
/// Jobs that may wait before whoever writes has to wait as well.
const QUEUE: usize = 4096;

/// What one write gave, or why it was not carried out.
type Written = Result<Vec<Option<EpisodeId>>, StoreError>;

struct Job {
    writes: Vec<Write>,
    done: oneshot::Sender<Written>,
}

/// The way to the task; cheap to clone. The task ends when the last of them is gone.
#[derive(Clone)]
pub struct Writer {
    jobs: mpsc::Sender<Job>,
}

impl Writer {
    /// Starts the task. Needs a Tokio runtime.
    pub fn start(store: Arc<dyn Store>) -> Self {
        let (jobs, queue) = mpsc::channel(QUEUE);
        tokio::spawn(run(store, queue));
        Self { jobs }
    }

    /// Writes all of it or none, after everything that was written earlier through this writer, and returns once it
    /// survives the loss of power. Gives what [`Store::commit`] gives.
    ///
    /// Dropping the future does not take the write back.
    pub async fn write(&self, writes: Vec<Write>) -> Result<Vec<Option<EpisodeId>>, StoreError> {
        let (done, committed) = oneshot::channel();
        self.jobs.send(Job { writes, done }).await.map_err(|_| StoreError::Stopping)?;
        committed.await.map_err(|_| StoreError::Stopping)?
    }

    /// Returns once everything that was handed in is committed or has failed.
    pub async fn flush(&self) {
        // An empty write cannot fail but by the task having stopped, when there is nothing left to wait for.
        let _ = self.write(Vec::new()).await;
    }
}

async fn run(store: Arc<dyn Store>, mut queue: mpsc::Receiver<Job>) {
    let mut next_commit = Instant::now();
    let mut jobs = Vec::new();
    while let Some(first) = queue.recv().await {
        jobs.push(first);
        sleep_until(next_commit).await;
        next_commit = Instant::now() + COMMIT_EVERY;
        while jobs.len() < MOST_JOBS {
            let Ok(job) = queue.try_recv() else { break };
            jobs.push(job);
        }
        commit(store.as_ref(), std::mem::take(&mut jobs)).await;
    }
}

/// Commits all jobs together. If one of them was at fault each is tried alone, so that it spoils no other.
async fn commit(store: &dyn Store, jobs: Vec<Job>) {
    let together: Vec<Write> = jobs.iter().flat_map(|job| job.writes.iter().cloned()).collect();
    match store.commit(&together).await {
        Ok(ids) => {
            let mut ids = ids.into_iter();
            for job in jobs {
                let own = ids.by_ref().take(job.writes.len()).collect();
                tell(job.done, Ok(own));
            }
        }
        Err(error) if jobs.len() > 1 && error.is_about_one_write() => {
            for job in jobs {
                let alone = store.commit(&job.writes).await;
                tell(job.done, alone);
            }
        }
        Err(error) => jobs.into_iter().for_each(|job| tell(job.done, Err(error.clone()))),
    }
}

fn tell(done: oneshot::Sender<Written>, written: Written) {
    if let Err(error) = &written {
        tracing::warn!(%error, "a write failed");
    }
    // Whoever asked may have gone; what was committed stays committed.
    let _ = done.send(written);
}
