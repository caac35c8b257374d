//! How long a tick of a plant elsewhere takes, from the action that leaves to the state that is there.
//!
//! `python3 examples/external-plant/plant.py --listen 5005 &`
//! `cargo run --release -p cohelm-external --example measure -- 127.0.0.1:5005`

use cohelm::plant::Plant;
use cohelm_external::{Address, External, TimeOut};
use std::time::{Duration, Instant};

/// Ticks that are measured: ten seconds at 50 Hz.
const TICKS: usize = 500;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let address: Address = std::env::args().nth(1).ok_or("say where the plant listens")?.parse()?;
    let mut plant = External::begin(&address, 1, TimeOut::default())?;
    let mut times = Vec::with_capacity(TICKS);
    for _ in 0..TICKS {
        std::thread::sleep(Duration::from_millis(20));
        let begun = Instant::now();
        if plant.step(None).ending.is_some() {
            break;
        }
        times.push(begun.elapsed().as_secs_f64() * 1000.0);
    }
    times.sort_by(f64::total_cmp);
    let at =
        |share: f64| times.get((share * (times.len() as f64 - 1.0)) as usize).copied().unwrap_or(f64::NAN);
    println!(
        "{} ticks: p50 {:.2} ms, p99 {:.2} ms, longest {:.2} ms",
        times.len(),
        at(0.5),
        at(0.99),
        at(1.0)
    );
    Ok(())
}
