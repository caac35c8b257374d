//! The inside of eight recorded flights: where a solver leaves the path is seen in the legs before the hull.
#![cfg(feature = "recording")]

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use cohelm_lander::craft::{Craft, Motion};
use cohelm_lander::gymnasium::{Action, GymnasiumLander, GymnasiumOptions};
use flate2::read::GzDecoder;
use serde::Deserialize;

/// A line of `tests/data/gymnasium_bodies.jsonl.gz`, as `tests/data/record_bodies.py` wrote it.
#[derive(Deserialize)]
struct Flight {
    seed: u64,
    wind: bool,
    actions: Vec<serde_json::Value>,
    bodies: Vec<[[f64; 6]; 3]>,
    contact: Vec<[bool; 3]>,
}

fn action(value: &serde_json::Value) -> Action {
    if let Some(index) = value.as_u64() {
        return Action::DISCRETE[index as usize];
    }
    let pair: [f64; 2] = serde_json::from_value(value.clone()).expect("a pair");
    Action::Throttles(pair.map(|throttle| throttle as f32))
}

fn numbers(motion: Motion) -> [f64; 6] {
    let Motion { x, y, angle_rad, vx, vy, omega_rad_s } = motion;
    [x, y, angle_rad, vx, vy, omega_rad_s].map(f64::from)
}

fn compare(flight: &Flight, step: usize, craft: &Craft) {
    let [first_leg, second_leg] = craft.legs();
    let [first_touches, second_touches] = craft.leg_contacts();
    let case = format!("seed {}, wind {}, step {step}", flight.seed, flight.wind);
    for (name, motion, recorded) in
        [("hull", craft.hull(), 0), ("first leg", first_leg, 1), ("second leg", second_leg, 2)]
    {
        let recorded = flight.bodies[step][recorded];
        assert_eq!(
            numbers(motion).map(f64::to_bits),
            recorded.map(f64::to_bits),
            "{case}, {name}: {recorded:?}, not {motion:?}"
        );
    }
    assert_eq!([craft.hull_touched(), first_touches, second_touches], flight.contact[step], "{case}");
}

#[test]
fn hull_and_legs_are_where_box2d_has_them() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/gymnasium_bodies.jsonl.gz");
    let lines = BufReader::new(GzDecoder::new(File::open(path).expect("recorded bodies"))).lines();
    let mut flights = 0;
    for line in lines {
        let flight: Flight = serde_json::from_str(&line.expect("a line")).expect("an episode");
        let options = GymnasiumOptions { enable_wind: flight.wind, ..GymnasiumOptions::default() };
        let mut lander = GymnasiumLander::new(options).expect("usual options");
        lander.reset(flight.seed);
        compare(&flight, 0, lander.craft());
        for (step, value) in (1..).zip(&flight.actions) {
            lander.step(action(value));
            compare(&flight, step, lander.craft());
        }
        flights += 1;
    }
    assert_eq!(flights, 8);
}
