//! Flights recorded from Gymnasium, flown again: every bit must agree.
#![cfg(feature = "recording")]

use std::fs::File;
use std::path::Path;

use cohelm_lander::recording::{Report, verify};

fn data(name: &str) -> File {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    File::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn assert_identical(report: &Report, flights: usize) {
    let difference = report.first_difference.as_ref().map(ToString::to_string).unwrap_or_default();
    assert_eq!((report.flights, report.identical), (flights, flights), "first difference: {difference}");
}

/// Recorded by `tests/data/record_gymnasium.py gymnasium_flights.jsonl.gz 0 12`.
#[test]
fn all_recorded_flights_are_identical() {
    let report = verify(data("gymnasium_flights.jsonl.gz")).expect("a recording");
    assert_identical(&report, 96);
}
