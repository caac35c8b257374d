//! What a step costs when worlds are stepped together: `cargo run --release -p cohelm-lander --example together`.
//!
//! Random flights in many short slices; the fastest slice and the median are printed, in microseconds a step of one world. On a
//! machine that others use too, the fastest slice is what they did not disturb.

use std::time::Instant;

use cohelm_lander::bench::{random_flights, random_flights_together};

const SLICES: usize = 100;
const STEPS: u32 = 12_800;

fn main() {
    println!("worlds  fastest  median");
    for worlds in [1, 8, 16, 32, 64, 256] {
        let mut times: Vec<_> = (0..SLICES).map(|slice| microseconds(worlds, slice as u64)).collect();
        times.sort_by(f64::total_cmp);
        println!("{worlds:6} {:8.2} {:7.2}", times[0], times[SLICES / 2]);
    }
}

fn microseconds(worlds: usize, seed: u64) -> f64 {
    let begun = Instant::now();
    std::hint::black_box(if worlds == 1 {
        random_flights(STEPS, seed)
    } else {
        random_flights_together(worlds, STEPS, seed)
    });
    begun.elapsed().as_secs_f64() * 1e6 / f64::from(STEPS)
}
