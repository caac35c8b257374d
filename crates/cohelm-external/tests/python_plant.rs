//! The example in Python, flown: to its goal, killed in mid-flight, stopped in mid-flight.
#![cfg(unix)]

use cohelm::action::Action;
use cohelm::arbitration::{HumanAlone, Rule};
use cohelm::cockpit::{Cockpit, Silence};
use cohelm::flight::{Flight, replay};
use cohelm::intent::Inference;
use cohelm::keys::Change;
use cohelm::plant::{Ending, Plant};
use cohelm::registry::Plants;
use cohelm::tape;
use cohelm::trajectory::{Setup, Trajectory};
use cohelm_external::{External, TimeOut};
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};
use support::python::Python;

mod support {
    pub mod python;
}

/// Long enough for a test that is about something else, on a machine that is busy.
fn patient() -> TimeOut {
    TimeOut::of_ms(2000).unwrap()
}

fn signal(python: &Python, signal: &str) {
    let sent = Command::new("kill").args([signal, &python.child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// An episode that a person flies alone.
fn flight(python: &Python, seed: u64) -> Flight {
    let plant = External::begin(&python.address, seed, patient()).unwrap();
    let setup = Setup {
        task: tape::task(plant.name()),
        plant_version: tape::VERSION,
        seed,
        rule: Rule::Hic,
        inference: Inference::Nearest,
        silence: Silence::Nothing,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: "person".into(),
    };
    let cockpit = Cockpit::unassisted(&plant, Box::new(HumanAlone)).with_silence(Silence::Nothing);
    Flight::new(setup, Box::new(plant), cockpit)
}

/// Moves the stick towards the goal, braking in time.
fn steer(flight: &mut Flight) {
    let view = flight.plant().view();
    let goal = view.goals[flight.plant().pilot_goal()].position[0];
    let push = (4.0 * (goal - view.state[0]) - 4.0 * view.state[1]).clamp(-1.0, 1.0);
    let at_ms = 20.0 * flight.ticks() as f32;
    flight.change(Change::Stick([(32767.0 * push) as i16, 0, 0, 0]), at_ms);
}

fn lost(flight: Flight) -> String {
    let record = flight.finish();
    assert_eq!(record.ending, Ending::Abandoned);
    record.tape.unwrap().lost().expect("a reason").to_owned()
}

#[test]
fn a_person_flies_it_to_the_goal_and_the_record_is_checked_from_its_states() {
    let python = Python::start();
    for seed in [1, 2] {
        let mut flight = flight(&python, seed);
        while flight.ending().is_none() {
            steer(&mut flight);
            flight.tick();
        }
        let record = flight.finish();
        assert_eq!((record.ending, record.tape.as_ref().unwrap().lost()), (Ending::Goal, None));
        let read = Trajectory::from_bytes(&record.to_bytes()).unwrap();
        let (mut plant, _) = read.plant(&Plants::default()).unwrap();
        let mut cockpit =
            Cockpit::unassisted(plant.as_ref(), Box::new(HumanAlone)).with_silence(Silence::Nothing);
        let seen = replay(&read, plant.as_mut(), Some(&mut cockpit));
        assert!(seen.identical() && seen.requests_identical == Some(true), "{seen:?}");
    }
}

#[test]
fn killed_in_mid_flight_it_ends_the_episode_and_nothing_else() {
    let mut python = Python::start();
    let mut flight = flight(&python, 1);
    (0..10).for_each(|_| assert!(flight.tick().unwrap().step.ending.is_none()));
    python.child.kill().unwrap();
    python.child.wait().unwrap();
    assert_eq!(flight.tick().unwrap().step.ending, Some(Ending::Abandoned));
    assert!(flight.tick().is_none());
    assert_eq!(lost(flight), "it closed the connection");
    assert!(External::begin(&python.address, 1, TimeOut::default()).is_err());
}

#[test]
fn stopped_in_mid_flight_it_ends_the_episode_after_the_time_out() {
    let python = Python::start();
    let mut flight = flight(&python, 1);
    (0..10).for_each(|_| assert!(flight.tick().unwrap().step.ending.is_none()));
    signal(&python, "-STOP");
    let begun = Instant::now();
    let ending = flight.tick().unwrap().step.ending;
    signal(&python, "-CONT");
    assert_eq!(ending, Some(Ending::Abandoned));
    assert!(begun.elapsed() >= patient().duration());
    assert_eq!(lost(flight), "nothing was heard from it for 2000 ms");
}

#[test]
fn it_stops_by_itself_when_cohelm_falls_silent() {
    let python = Python::start();
    let mut plant = External::begin(&python.address, 1, TimeOut::of_ms(500).unwrap()).unwrap();
    assert!(plant.step(Some(Action::axes(&[1.0]))).ending.is_none());
    sleep(Duration::from_millis(1500));
    assert_eq!(plant.step(None).ending, Some(Ending::Abandoned));
}

#[test]
fn at_two_ticks_a_second_it_waits_for_the_next_and_stops_when_that_stays_away() {
    let python = Python::start_with(&["--ticks-per-second", "2"]);
    let mut plant = External::begin(&python.address, 1, TimeOut::of_ms(1000).unwrap()).unwrap();
    assert_eq!(plant.ticks_per_second(), 2.0);
    for _ in 0..3 {
        assert_eq!(plant.step(Some(Action::axes(&[0.1]))).ending, None);
        sleep(Duration::from_millis(500));
    }
    sleep(Duration::from_millis(2500));
    assert_eq!(plant.step(None).ending, Some(Ending::Abandoned));
}

/// The example hears a line of somebody who is not cohelm; it must be there for the next episode.
#[test]
fn no_line_ends_the_example() {
    let python = Python::start();
    let begin = r#"{"begin":{"seed":1,"time_out_ms":100}}"#;
    let (deep, huge) = ("[".repeat(100_000), "9".repeat(400));
    let endless = r#"{"begin":{"seed":1,"time_out_ms":1e300}}"#;
    let push = format!(r#"{{"tick":0,"action":[{huge}]}}"#);
    let openings =
        ["", "x", "[]", "7", "{}", r#"{"begin":3}"#, r#"{"begin":{"seed":1}}"#, "\u{fffd}\u{0}", &deep];
    let ticks = [
        "x",
        "7",
        "{}",
        r#"{"tick":0}"#,
        r#"{"tick":0,"action":[]}"#,
        r#"{"tick":0,"action":["up"]}"#,
        &push,
    ];
    let openings = openings.map(|line| vec![line]).into_iter().chain([vec![endless, ticks[0]]]);
    for lines in openings.chain(ticks.map(|line| vec![begin, line])) {
        let mut stream = TcpStream::connect(python.address.to_string()).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        let mut heard = BufReader::new(stream.try_clone().unwrap()).lines();
        for line in &lines {
            heard.next().expect("it speaks first").unwrap();
            writeln!(stream, "{line}").unwrap();
        }
        assert!(heard.next().is_none_or(|line| line.is_err()), "a line is answered");
        External::begin(&python.address, 1, patient()).expect("it is there for the next");
    }
}

/// Run by Python itself: whatever ends an episode, the cart has stopped afterwards.
#[test]
fn whatever_ends_an_episode_the_cart_stops() {
    let script = r#"
import plant, socket, json
BEGIN = json.dumps({"begin": {"seed": 1, "time_out_ms": 100}})
GO = json.dumps({"tick": 0, "action": [1.0]})
for last in ["x", "{}", "7", json.dumps({"tick": 1, "action": "up"}), "", None]:
    near, far = socket.socketpair()
    far.sendall("\n".join([BEGIN, GO, ""]).encode())
    if last is not None:
        far.sendall(last.encode() + b"\n")
    cart = plant.Cart()
    said = plant.serve(near, cart)
    assert said.startswith("lost"), said
    assert cart.ticks >= 1 and cart.push == 0.0, (last, cart.push)
"#;
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/external-plant");
    let mut python = Command::new("python3");
    let told = python.args(["-B", "-c", script]).env("PYTHONPATH", folder).output().unwrap();
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
}

#[test]
fn a_stranger_who_says_nothing_does_not_keep_others_out_for_ever() {
    let python = Python::start();
    let stranger = TcpStream::connect(python.address.to_string()).unwrap();
    let begun = Instant::now();
    while External::begin(&python.address, 1, TimeOut::default()).is_err() {
        assert!(begun.elapsed() < Duration::from_secs(20), "the stranger is still in the way");
    }
    drop(stranger);
}
