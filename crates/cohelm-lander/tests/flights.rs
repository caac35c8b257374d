//! Flights recorded from Gymnasium, flown again: every bit must agree; and what `verify` says about files that are not right.
#![cfg(feature = "recording")]

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

use cohelm_lander::gymnasium::{Action, GymnasiumLander, GymnasiumOptions};
use cohelm_lander::recording::{Place, RecordingError, Report, verify};
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use proptest::prelude::*;

fn data(name: &str) -> File {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    File::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn assert_identical(report: &Report, flights: usize) {
    let difference = report.first_difference.as_ref().map(ToString::to_string).unwrap_or_default();
    assert_eq!((report.flights, report.identical), (flights, flights), "first difference: {difference}");
    assert!(report.all_identical());
}

/// Recorded by `tests/data/record_gymnasium.py gymnasium_flights.jsonl.gz 0 12`.
#[test]
fn flights_of_all_four_tasks_are_identical() {
    let report = verify(data("gymnasium_flights.jsonl.gz")).expect("a recording");
    assert_identical(&report, 96);
}

/// Recorded by `tests/data/record_varied.py varied_flights.jsonl.gz 7000 3 drop rest slope hop spin slam noisy`.
#[test]
fn resting_sliding_hopping_and_hitting_hard_are_identical() {
    let report = verify(data("varied_flights.jsonl.gz")).expect("a recording");
    assert_identical(&report, 21);
}

/// The shortest recorded flight, as text.
fn short_flight() -> String {
    let mut text = String::new();
    GzDecoder::new(data("varied_flights.jsonl.gz")).read_to_string(&mut text).expect("text");
    text.lines().min_by_key(|line| line.len()).expect("a line").to_owned()
}

/// The same flight after a change.
fn edited(edit: impl Fn(&mut serde_json::Value)) -> String {
    let mut flight = serde_json::from_str(&short_flight()).expect("JSON");
    edit(&mut flight);
    flight.to_string()
}

/// Flips the last bit of a number.
fn bump(value: &mut serde_json::Value) {
    let number = value.as_f64().expect("a number");
    *value = f64::from_bits(number.to_bits() ^ 1).into();
}

#[test]
fn one_wrong_bit_is_found_where_it_is() {
    type Case = (fn(&mut serde_json::Value), usize, Place);
    let cases: [Case; 8] = [
        (|flight| bump(&mut flight["terrain"][4]), 0, Place::Terrain(4)),
        (|flight| bump(&mut flight["observations"][0][1]), 0, Place::Observation(1)),
        (|flight| bump(&mut flight["observations"][17][3]), 17, Place::Observation(3)),
        (|flight| bump(&mut flight["rewards"][29]), 30, Place::Reward),
        (|flight| flight["terminated"] = false.into(), 55, Place::Terminated),
        (|flight| flight["truncated"] = true.into(), 55, Place::Truncated),
        (|flight| flight["gravity"] = (-20.0).into(), 0, Place::Options),
        (|flight| flight["wind_power"] = 1e6.into(), 0, Place::Observation(0)),
    ];
    for (edit, step, place) in cases {
        let report = verify(edited(edit).as_bytes()).expect("a recording");
        assert_eq!((report.flights, report.identical, report.all_identical()), (1, 0, false));
        let difference = report.first_difference.expect("a difference");
        assert_eq!((difference.flight, difference.step, difference.place), (1, step, place));
    }
}

#[test]
fn the_first_difference_is_that_of_the_first_flight_that_differs() {
    let good = short_flight();
    let bad = edited(|flight| bump(&mut flight["rewards"][3]));
    let worse = edited(|flight| bump(&mut flight["terrain"][0]));
    let report = verify([good.as_str(), &bad, &worse, &good].join("\n").as_bytes()).expect("a recording");
    assert_eq!((report.flights, report.identical, report.steps), (4, 2, 220));
    let difference = report.first_difference.expect("a difference").to_string();
    let shown = "flight 2 (seed 7002), step 4, reward: recorded ";
    assert!(difference.starts_with(shown), "{difference}");
}

fn refusal(bytes: &[u8]) -> String {
    verify(bytes).expect_err("no recording").to_string()
}

#[test]
fn what_is_no_recording_is_refused_with_the_line_and_a_reason() {
    let good = short_flight();
    let cases: [(String, &str); 10] = [
        (String::new(), "there is no episode in the file"),
        ("seed,x,y\n".into(), "line 1 is not an episode in JSON: "),
        (
            format!("{good}\n{}", &good[..good.len() / 2]),
            "line 2 is not an episode in JSON: EOF while parsing",
        ),
        (edited(|flight| flight["seed"] = (-1).into()), "line 1 is not an episode in JSON: invalid value"),
        (edited(|flight| flight["actions"][0] = 4.into()), "line 1: action 4 is none of 0, 1, 2, 3"),
        (
            edited(|flight| flight["continuous"] = true.into()),
            "line 1: action 0 is not a pair, though continuous is true",
        ),
        (
            edited(|flight| flight["rewards"] = serde_json::json!([])),
            "line 1: 55 actions need 56 observations and 55 rewards",
        ),
        (
            edited(|flight| flight["terrain"] = serde_json::json!([1.0])),
            "line 1 is not an episode in JSON: invalid length 1",
        ),
        (
            good.replacen("\"rewards\":[", "\"rewards\":[NaN,", 1),
            "line 1 is not an episode in JSON: expected value",
        ),
        (" ".repeat(5 << 20), "line 1 is longer than 4194304 bytes"),
    ];
    for (text, reason) in cases {
        let said = refusal(text.as_bytes());
        assert!(said.starts_with(reason), "{said}");
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).expect("written to memory");
    encoder.finish().expect("written to memory")
}

#[test]
fn a_gzip_file_cut_short_or_damaged_is_refused() {
    let whole = gzip(short_flight().as_bytes());
    assert!(verify(&whole[..]).expect("a recording").all_identical());
    assert!(matches!(verify(&whole[..whole.len() / 2]), Err(RecordingError::Read { line: 1, .. })));
    let mut damaged = whole.clone();
    let at = damaged.len() - 6;
    damaged[at] ^= 0xff;
    assert!(refusal(&damaged).contains("is the file complete"), "the checksum is wrong");
    assert!(
        refusal(&gzip(&[b' '; 5 << 20])).contains("longer than"),
        "a small file that unpacks to a long line"
    );
}

fn action() -> impl Strategy<Value = Action> {
    let throttle = -1.2..1.2_f32;
    prop_oneof![
        proptest::sample::select(&Action::DISCRETE[..]),
        [throttle.clone(), throttle].prop_map(Action::Throttles)
    ]
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), zipped: bool) {
        let file = if zipped { gzip(&bytes) } else { bytes };
        prop_assert!(verify(&file[..]).is_err());
    }

    #[test]
    fn a_damaged_line_is_refused_or_differs_or_says_the_same(at: prop::sample::Index, byte: u8) {
        let mut text = short_flight().into_bytes();
        let at = at.index(text.len());
        text[at] = byte;
        if let Ok(report) = verify(&text[..]) {
            prop_assert_eq!(report.first_difference.is_none(), report.all_identical());
        }
    }

    #[test]
    fn going_on_from_a_clone_gives_the_same_bits(
        seed: u64,
        enable_wind: bool,
        before in prop::collection::vec(action(), 0..200),
        after in prop::collection::vec(action(), 1..100),
    ) {
        let options = GymnasiumOptions { enable_wind, ..GymnasiumOptions::default() };
        let mut lander = GymnasiumLander::new(options).expect("usual options");
        lander.reset(seed);
        for action in before {
            lander.step(action);
        }
        let mut copy = lander.clone();
        let bits = |lander: &mut GymnasiumLander| -> Vec<_> {
            after.iter().map(|action| lander.step(*action)).map(|outcome| {
                (outcome.observation.map(f32::to_bits), outcome.reward.to_bits(), outcome.ending)
            }).collect()
        };
        prop_assert_eq!(bits(&mut copy), bits(&mut lander));
        prop_assert_eq!(copy, lander);
    }
}
