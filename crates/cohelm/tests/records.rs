//! A flight by keys becomes a record; the record becomes bytes, comes back, and replays bit for bit.

use cohelm::action::Action;
use cohelm::arbitration::Rule;
use cohelm::cockpit::{Cockpit, Silence};
use cohelm::flight::{Flight, fly, replay};
use cohelm::intent::{Inference, KnownGoal};
use cohelm::keys::Change;
use cohelm::pilot::Silent;
use cohelm::plant::{Ending, Plant};
use cohelm::point;
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::{Setup, Trajectory, TrajectoryError};
use proptest::prelude::*;

fn setup(rule: Rule, pilot: &str) -> Setup {
    Setup {
        task: Task::new("point"),
        plant_version: 1,
        seed: 5,
        rule,
        inference: Inference::Known,
        silence: Silence::Best,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: pilot.into(),
    }
}

fn point() -> Box<dyn Plant> {
    let mut plants = Plants::default();
    plants.register(point::entry());
    plants.make(&Task::new("point")).unwrap()
}

fn cockpit(rule: Rule, goal: usize) -> Cockpit {
    let values = point::entry().values.unwrap();
    Cockpit::new(Box::new(KnownGoal(goal)), values(), rule.arbiter(1.0).unwrap())
}

fn wanted() -> usize {
    let mut plant = point();
    plant.reset(5);
    plant.pilot_goal()
}

fn flown_by_keys(rule: Rule) -> Trajectory {
    let mut flight = Flight::new(setup(rule, "person"), point(), cockpit(rule, wanted()));
    flight.change(Change::Down(3), 12.5);
    for tick in 0.. {
        match tick {
            20 => flight.change(Change::Up(3), 400.0),
            25 => flight.change(Change::Stick([20_000, -9_000, 0, 0]), 500.0),
            40 => flight.change(Change::ReleaseAll, 800.0),
            _ => {}
        }
        if flight.tick().is_none() {
            break;
        }
    }
    flight.finish()
}

#[test]
fn the_robot_alone_reaches_the_goal_of_the_point() {
    let (mut plant, mut cockpit) = (point(), cockpit(Rule::Robot, wanted()));
    let flown = fly(setup(Rule::Robot, "silent"), plant.as_mut(), &mut cockpit, &mut Silent, |_, _| {});
    assert_eq!(flown.ending, Ending::Goal);
}

#[test]
fn a_flight_by_keys_replays_bit_for_bit_under_every_rule() {
    for rule in Rule::USUAL {
        let flown = flown_by_keys(rule);
        let seen = replay(&flown, point().as_mut(), Some(&mut cockpit(rule, wanted())));
        assert!(seen.identical() && seen.requests_identical == Some(true), "{rule:?}: {seen:?}");
    }
}

#[test]
fn a_replay_notices_one_changed_action_key_or_request() {
    let flown = flown_by_keys(Rule::Misc);
    let changed = |change: fn(&mut Trajectory)| {
        let mut other = flown.clone();
        change(&mut other);
        replay(&other, point().as_mut(), Some(&mut cockpit(Rule::Misc, wanted())))
    };
    assert!(!changed(|t| t.executed[3] = None).plant_identical);
    assert_eq!(changed(|t| t.asked[3] = None).decisions_identical, Some(false));
    assert_eq!(changed(|t| t.keys[0].tick = 2).requests_identical, Some(false));
    assert!(!changed(|t| t.ending = Ending::Crash).plant_identical);
    assert!(!changed(|t| t.executed[3] = Some(Action::Command(200))).plant_identical);
    assert!(!changed(|t| t.asked[3] = Some(Action::axes(&[1e9]))).plant_identical);
}

#[test]
fn bytes_come_back_as_they_were() {
    let flown = flown_by_keys(Rule::Misc);
    assert_eq!(Trajectory::from_bytes(&flown.to_bytes()), Ok(flown));
}

#[test]
fn foreign_cut_off_and_newer_bytes_are_told_apart() {
    let bytes = flown_by_keys(Rule::Hic).to_bytes();
    assert_eq!(Trajectory::from_bytes(b"PNG\x01...."), Err(TrajectoryError::Foreign));
    assert!(matches!(Trajectory::from_bytes(&bytes[..bytes.len() - 3]), Err(TrajectoryError::CutOff { .. })));
    let newer: Vec<u8> = bytes.iter().enumerate().map(|(i, &b)| if i == 4 { 9 } else { b }).collect();
    assert_eq!(Trajectory::from_bytes(&newer), Err(TrajectoryError::Version(9)));
    let longer = [bytes.as_slice(), b"!"].concat();
    assert_eq!(Trajectory::from_bytes(&longer), Err(TrajectoryError::TooLong(1)));
}

proptest! {
    /// Fuzz-like: whatever is done to the bytes, reading them gives a trajectory or an error, never a panic.
    #[test]
    fn damaged_bytes_never_panic(position in 0_usize..4000, value: u8, cut in 0_usize..4000) {
        let mut bytes = flown_by_keys(Rule::Misc).to_bytes();
        let position = position % bytes.len();
        bytes[position] = value;
        bytes.truncate(bytes.len().saturating_sub(cut % 64));
        if let Ok(read) = Trajectory::from_bytes(&bytes) {
            prop_assert!(Trajectory::from_bytes(&read.to_bytes()).is_ok());
        }
    }
}
