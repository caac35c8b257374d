//! All jobs on this machine, one a thread.

use super::SweepError;
use super::description::Planned;
use super::folder::{Folder, Ran};
use super::run::{Lab, run_job};
use std::num::NonZeroUsize;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Runs jobs with `threads` workers (0: one a core), keeps each as it finishes, and tells where it ran. The first failure
/// stops the rest; what has finished stays.
pub fn run_locally(
    planned: &[&Planned],
    folder: &Folder,
    lab: &Lab<'_>,
    threads: usize,
    tell: &(dyn Fn(&Ran) + Sync),
) -> Result<(), SweepError> {
    let cores = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let threads = if threads == 0 { cores } else { threads }.min(planned.len().max(1));
    let (next, failure) = (AtomicUsize::new(0), Mutex::new(None));
    let work = |worker: usize| {
        while let Some(one) = planned.get(next.fetch_add(1, Ordering::Relaxed)) {
            match run(one, folder, lab, worker) {
                Ok(ran) => tell(&ran),
                Err(error) => {
                    next.store(planned.len(), Ordering::Relaxed);
                    failure.lock().unwrap_or_else(|broken| broken.into_inner()).get_or_insert(error);
                }
            }
        }
    };
    thread::scope(|scope| {
        for worker in 0..threads {
            scope.spawn(move || work(worker));
        }
    });
    failure.into_inner().unwrap_or_else(|broken| broken.into_inner()).map_or(Ok(()), Err)
}

fn run(planned: &Planned, folder: &Folder, lab: &Lab<'_>, worker: usize) -> Result<Ran, SweepError> {
    let (begun, begun_ms) = (Instant::now(), now_ms());
    let done = run_job(&planned.job, lab)?;
    let ran = Ran {
        hash: planned.hash.clone(),
        executor: "local".into(),
        node: "this machine".into(),
        worker: format!("thread {}", worker + 1),
        begun_ms,
        seconds: begun.elapsed().as_secs_f64(),
        attempt: 1,
    };
    folder.keep(&done, &ran)?;
    Ok(ran)
}

fn now_ms() -> i64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_millis() as i64)
}
