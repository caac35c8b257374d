//! The craft against Box2D itself, where Gymnasium's task never goes: any ground, any start, all engines at once, on after a
//! crash, awake again after sleep, and fewer iterations.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;

use cohelm_lander::craft::{Controls, Craft, Dispersion, Engines, Ground, Motion, Settings, Start};
use flate2::read::GzDecoder;
use serde::Deserialize;

/// A line of `tests/data/craft.jsonl.gz`, as `tests/data/record_craft.py` wrote it.
#[derive(Deserialize)]
struct Flight {
    ground: Vec<[f64; 2]>,
    gravity: f64,
    iterations: [u32; 2],
    start: [f64; 6],
    controls: Vec<[f64; 7]>,
    notes: Vec<Note>,
}

#[derive(Debug, Deserialize, PartialEq)]
struct Note {
    tick: usize,
    bodies: [[f64; 6]; 3],
    contact: [bool; 3],
    awake: bool,
}

fn flights() -> Vec<Flight> {
    let path = std::env::var_os("CRAFT_RECORDING").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/craft.jsonl.gz")),
        PathBuf::from,
    );
    let lines = BufReader::new(GzDecoder::new(File::open(path).expect("a recording"))).lines();
    lines.map(|line| serde_json::from_str(&line.expect("a line")).expect("a flight")).collect()
}

fn place(flight: &Flight) -> Craft {
    let ground = Ground::polyline(&flight.ground).expect("a chain");
    let [x, y, vx, vy, push @ ..] = flight.start;
    let [velocity_iterations, position_iterations] = flight.iterations;
    let settings = Settings { gravity: flight.gravity, velocity_iterations, position_iterations };
    Craft::place(&ground, &Start { x, y, vx, vy, push }, settings)
}

fn controls([main, left, right, first, second, wind_force, wind_torque]: [f64; 7]) -> Controls {
    let dispersion = Dispersion::from_uniform([first, second]);
    Controls { engines: Engines { main, left, right }, dispersion, wind_force, wind_torque }
}

fn note(craft: &Craft, tick: usize) -> Note {
    let numbers = |motion: Motion| {
        let Motion { x, y, angle_rad, vx, vy, omega_rad_s } = motion;
        [x, y, angle_rad, vx, vy, omega_rad_s].map(f64::from)
    };
    let ([first, second], [first_touches, second_touches]) = (craft.legs(), craft.leg_contacts());
    Note {
        tick,
        bodies: [craft.hull(), first, second].map(numbers),
        contact: [craft.hull_touched(), first_touches, second_touches],
        awake: craft.awake(),
    }
}

#[test]
fn every_note_is_box2d_s() {
    let (mut notes, mut woken) = (0, 0);
    for (number, flight) in flights().iter().enumerate() {
        let mut craft = place(flight);
        let mut expected = flight.notes.iter();
        let stride = flight.notes.first().map_or(1, |note| note.tick);
        for (tick, now) in (1..).zip(&flight.controls) {
            let slept = !craft.awake();
            craft.tick(&controls(*now));
            woken += usize::from(slept && craft.awake());
            if tick % stride == 0 {
                assert_eq!(Some(&note(&craft, tick)), expected.next(), "flight {number}");
                notes += 1;
            }
        }
    }
    assert!(notes > 300 && woken > 3, "{notes} notes, woken {woken} times: too little was recorded");
}

/// Worlds go to threads, and snapshots into replay memories.
#[test]
fn a_craft_is_plain_data() {
    fn plain<T: Clone + Send + Sync + PartialEq + 'static>() {}
    plain::<Craft>();
    plain::<cohelm_lander::gymnasium::GymnasiumLander>();
}
