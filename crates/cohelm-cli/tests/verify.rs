//! `cohelm verify` finds what differs, says where, and fails.

mod program;

use flate2::read::GzDecoder;
use program::{Ran, file, folder, in_project, run};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};

/// The first flights of the recorded ones, one line each.
fn recorded(count: usize) -> Vec<Value> {
    let path = in_project("crates/cohelm-lander/tests/data/gymnasium_flights.jsonl.gz");
    let lines = BufReader::new(GzDecoder::new(fs::File::open(path).unwrap())).lines();
    lines.take(count).map(|line| serde_json::from_str(&line.unwrap()).unwrap()).collect()
}

fn verify(kind: &str, bytes: &str) -> (Ran, Value) {
    let folder = folder();
    file(&folder, "recording", bytes.as_bytes());
    let ran = run(folder.path(), ["verify", kind, "recording"]);
    let json = run(folder.path(), ["verify", kind, "recording", "--json"]);
    assert_eq!((ran.code, &ran.stderr), (json.code, &json.stderr));
    (ran, serde_json::from_str(&json.stdout).unwrap())
}

fn flights(flights: &[Value]) -> (Ran, Value) {
    verify("flights", &flights.iter().map(|flight| format!("{flight}\n")).collect::<String>())
}

/// The next number after one, as a float of 32 bits.
fn next_up(number: &Value) -> Value {
    Value::from(f64::from((number.as_f64().unwrap() as f32).next_up()))
}

#[test]
fn recorded_flights_are_flown_again_to_the_last_bit() {
    let (ran, json) = flights(&recorded(3));
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    assert!(ran.stdout.contains("3 flights") && ran.stdout.contains("3 identical"), "{}", ran.stdout);
    assert_eq!(json["all_agree"], true);
    assert_eq!(json["files"][0]["report"]["first_difference"], Value::Null);
}

#[test]
fn one_bit_of_one_observation_is_found_and_named() {
    let mut changed = recorded(3);
    let number = &mut changed[1]["observations"][17][4];
    *number = next_up(number);
    let (ran, json) = flights(&changed);
    assert_eq!(ran.code, Some(1));
    assert!(ran.stdout.contains("2 identical") && ran.stdout.contains("first difference"), "{}", ran.stdout);
    let report = &json["files"][0]["report"];
    assert_eq!((&report["flights"], &report["identical"]), (&Value::from(3), &Value::from(2)));
    let first = report["first_difference"].as_str().unwrap();
    assert!(first.contains("17"), "{first}");
}

#[test]
fn one_bit_of_one_reward_is_found() {
    let mut changed = recorded(2);
    let reward = changed[0]["rewards"][5].as_f64().unwrap();
    changed[0]["rewards"][5] = Value::from(reward.next_down());
    let (ran, json) = flights(&changed);
    assert_eq!((ran.code, &json["files"][0]["report"]["identical"]), (Some(1), &Value::from(1)));
}

#[test]
fn a_statistic_that_is_off_by_more_than_a_millionth_is_found_and_named() {
    let path = in_project("crates/cohelm-study/tests/data/statistics.json");
    let good: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    for (factor, code) in [(1.0, 0), (1.0 + 1e-9, 0), (1.0 + 1e-5, 1)] {
        let mut changed = good.clone();
        let number = &mut changed["cases"][1]["rm"]["F"];
        *number = Value::from(number.as_f64().unwrap() * factor);
        let (ran, json) = verify("statistics", &changed.to_string());
        assert_eq!((ran.code, &json["all_agree"]), (Some(code), &Value::from(code == 0)), "{}", ran.stdout);
        assert!(code == 0 || ran.stdout.contains("case 1, rm.F"), "{}", ran.stdout);
        let first = &json["files"][0]["report"]["first_difference"];
        assert!(code == 0 || first["ours"].is_f64(), "{first}");
    }
}
