//! Many independent jobs on all cores, with results in the order of the jobs whatever finished first.

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

/// Runs `job` on 0..jobs with `threads` workers; 0 for as many as there are cores.
pub fn run<Outcome: Send>(
    jobs: usize,
    threads: usize,
    job: impl Fn(usize) -> Outcome + Sync + Send,
) -> Vec<Outcome> {
    let work = || (0..jobs).into_par_iter().map(&job).collect();
    match ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(work),
        // A machine that gives no threads still has the one that asks.
        Err(_) => (0..jobs).map(&job).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::run;

    #[test]
    fn results_stand_in_the_order_of_the_jobs_for_any_number_of_threads() {
        let expected: Vec<usize> = (0..50).map(|i| i * i).collect();
        for threads in [0, 1, 3, 16] {
            assert_eq!(run(50, threads, |index| index * index), expected);
        }
        assert!(run(0, 4, |index| index).is_empty());
    }
}
