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
use cohelm_external::{Address, External, TimeOut};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// The example as a process; killed when it is dropped.
struct Python {
    child: Child,
    address: Address,
}

impl Python {
    fn start() -> Self {
        let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/external-plant/plant.py");
        let started = Command::new("python3").args([example, "--listen", "0"]).stdout(Stdio::piped()).spawn();
        let mut child = started.expect("this test flies the example plant and needs python3 on the PATH");
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("the cart listens at ").expect("an address").parse().unwrap();
        Self { child, address }
    }

    fn signal(&self, signal: &str) {
        let sent = Command::new("kill").args([signal, &self.child.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }

    /// An episode that a person flies alone.
    fn flight(&self, seed: u64) -> Flight {
        let plant = External::begin(&self.address, seed, TimeOut::default()).unwrap();
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
}

impl Drop for Python {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
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
        let mut flight = python.flight(seed);
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
    let mut flight = python.flight(1);
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
    let mut flight = python.flight(1);
    (0..10).for_each(|_| assert!(flight.tick().unwrap().step.ending.is_none()));
    python.signal("-STOP");
    let begun = std::time::Instant::now();
    let ending = flight.tick().unwrap().step.ending;
    python.signal("-CONT");
    assert_eq!(ending, Some(Ending::Abandoned));
    assert!(begun.elapsed() >= TimeOut::default().duration());
    assert_eq!(lost(flight), "nothing was heard from it for 250 ms");
}

#[test]
fn it_stops_by_itself_when_cohelm_falls_silent() {
    let python = Python::start();
    let mut plant = External::begin(&python.address, 1, TimeOut::of_ms(50).unwrap()).unwrap();
    assert!(plant.step(Some(Action::axes(&[1.0]))).ending.is_none());
    std::thread::sleep(std::time::Duration::from_millis(400));
    assert_eq!(plant.step(None).ending, Some(Ending::Abandoned));
}
