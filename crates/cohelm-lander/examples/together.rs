//! What a step costs when worlds are stepped together: `cargo run --release -p cohelm-lander --example together`.
//!
//! Random flights, five interleaved runs; printed is the median, in microseconds of processor time a step of one world.
//! Processor time, as Linux counts it, hardly changes when other programs use the machine too; elsewhere it is the clock.

use std::fs::read_to_string;
use std::sync::LazyLock;
use std::time::Instant;

use cohelm_lander::bench::{random_flights, random_flights_together};

const RUNS: u64 = 5;
const STEPS: u32 = 102_400;
const WORLDS: [usize; 6] = [1, 8, 16, 32, 64, 256];

fn main() {
    let mut times: [Vec<f64>; WORLDS.len()] = Default::default();
    for run in 0..RUNS {
        for (times, worlds) in times.iter_mut().zip(WORLDS) {
            times.push(microseconds(worlds, run));
        }
    }
    println!("worlds  µs a step");
    for (mut times, worlds) in times.into_iter().zip(WORLDS) {
        times.sort_by(f64::total_cmp);
        println!("{worlds:6} {:10.2}", times[times.len() / 2]);
    }
}

fn microseconds(worlds: usize, seed: u64) -> f64 {
    let begun = seconds();
    std::hint::black_box(if worlds == 1 {
        random_flights(STEPS, seed)
    } else {
        random_flights_together(worlds, STEPS, seed)
    });
    (seconds() - begun) * 1e6 / f64::from(STEPS)
}

fn seconds() -> f64 {
    static BEGUN: LazyLock<Instant> = LazyLock::new(Instant::now);
    let spent = read_to_string("/proc/self/schedstat").ok();
    let spent = spent.and_then(|spent| spent.split(' ').next()?.parse::<f64>().ok());
    spent.map_or_else(|| BEGUN.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}
