//! Many independent jobs on all cores, with results in the order of the jobs whatever finished first.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs `job` on 0..jobs with `threads` workers (0: as many as there are cores); each worker makes its own `tools` once
/// and keeps them for all its jobs.
pub fn run<Tools, Result: Send>(
    jobs: usize,
    threads: usize,
    tools: impl Fn() -> Tools + Sync,
    job: impl Fn(&mut Tools, usize) -> Result + Sync,
) -> Vec<Result> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Result>>> = (0..jobs).map(|_| Mutex::new(None)).collect();
    let work = || {
        let mut tools = tools();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(slot) = results.get(index) else { break };
            let result = job(&mut tools, index);
            *slot.lock().expect("a slot is locked once, by the worker that drew its index") = Some(result);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..workers(threads).min(jobs.max(1)) {
            scope.spawn(work);
        }
        work();
    });
    let taken = results.into_iter().map(|slot| slot.into_inner().expect("no worker panicked while holding it"));
    taken.map(|result| result.expect("every index was drawn")).collect()
}

/// How many threads a request for `threads` means.
pub fn workers(threads: usize) -> usize {
    if threads > 0 { threads } else { std::thread::available_parallelism().map_or(1, usize::from) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stand_in_the_order_of_the_jobs_for_any_number_of_threads() {
        let squares = |threads| run(50, threads, || 0, |_, index| index * index);
        let expected: Vec<usize> = (0..50).map(|i| i * i).collect();
        for threads in [0, 1, 3, 64] {
            assert_eq!(squares(threads), expected);
        }
        assert!(run(0, 4, || (), |(), index| index).is_empty());
    }
}
