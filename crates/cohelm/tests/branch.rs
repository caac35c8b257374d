//! What if: the branch is the record up to its tick, the record's own rule gives the rest of it, and another rule or
//! pilot has the say from that tick on.

use cohelm::action::Action;
use cohelm::arbitration::Rule;
use cohelm::branch::{Branch, BranchError};
use cohelm::cockpit::{Cockpit, Silence};
use cohelm::flight::Flight;
use cohelm::intent::{Belief, Inference, IntentModel, KnownGoal};
use cohelm::keys::Change;
use cohelm::pilot::Silent;
use cohelm::plant::{Ending, Plant, View};
use cohelm::point::{self, Point};
use cohelm::registry::Task;
use cohelm::trajectory::{Setup, Trajectory};
use proptest::prelude::*;
use std::sync::{Arc, Mutex};

const SEED: u64 = 5;

fn wanted() -> usize {
    let mut point = Point::new();
    point.reset(SEED);
    point.pilot_goal()
}

fn cockpit(rule: Rule) -> Cockpit {
    let values = point::entry().values.unwrap();
    Cockpit::new(Box::new(KnownGoal(wanted())), values(), rule.arbiter(1.0).unwrap())
}

/// A flight under a rule: up, then right with the stick, then whatever comes. At most so many ticks.
fn flown(rule: Rule, most: u32) -> Trajectory {
    let setup = Setup {
        task: Task::new("point"),
        plant_version: 1,
        seed: SEED,
        rule,
        inference: Inference::Known,
        silence: Silence::Best,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: "person".into(),
    };
    let mut flight = Flight::new(setup, Box::new(Point::new()), cockpit(rule));
    for tick in 0..most {
        match tick {
            5 => flight.change(Change::Down(3), 100.0),
            40 => flight.change(Change::Up(3), 800.0),
            45 => flight.change(Change::Stick([20_000, -9_000, 0, 0]), 900.0),
            80 => flight.change(Change::ReleaseAll, 1600.0),
            _ => {}
        }
        if flight.tick().is_none() {
            break;
        }
    }
    flight.finish()
}

fn branch(record: &Trajectory, at: u32, rule: Rule) -> Result<Branch, BranchError> {
    let mut own = cockpit(record.setup.rule);
    Branch::new(record, at, Box::new(Point::new()), &mut own, cockpit(rule))
}

/// What is asked and carried out from the branch on, until it ends.
fn rest(branch: &mut Branch) -> Vec<(Option<Action>, Option<Action>)> {
    std::iter::from_fn(|| branch.tick().map(|tick| (tick.asked, tick.executed))).collect()
}

#[test]
fn under_its_own_rule_the_rest_of_a_record_comes_out_bit_for_bit() {
    for rule in Rule::USUAL {
        let record = flown(rule, u32::MAX);
        for at in [0, 1, 44, 60, record.ticks() as u32 - 1] {
            let mut branch = branch(&record, at, rule).unwrap();
            let recorded = record.asked.iter().copied().zip(record.executed.iter().copied());
            assert_eq!(
                rest(&mut branch),
                recorded.skip(at as usize).collect::<Vec<_>>(),
                "{rule:?} from {at}"
            );
            assert_eq!((branch.digests(), branch.ending()), (record.digests, Some(record.ending)));
        }
    }
}

#[test]
fn human_alone_lets_the_recorded_requests_through() {
    let record = flown(Rule::Robot, u32::MAX);
    let mut branch = branch(&record, 30, Rule::Hic).unwrap();
    let rest = rest(&mut branch);
    assert!(rest.iter().all(|(asked, executed)| asked == executed));
    assert_eq!(rest[0].0, record.asked[30]);
    assert_ne!(branch.digests(), record.digests);
}

/// Never sure of anything.
struct Unsure;

impl IntentModel for Unsure {
    fn begin(&mut self) {}

    fn infer(&mut self, view: &View<'_>, _asked: Option<Action>) -> Belief {
        Belief::unknown(view.goals.len(), 0)
    }
}

#[test]
fn minimal_intervention_without_confidence_allows_everything() {
    let record = flown(Rule::Robot, u32::MAX);
    let values = point::entry().values.unwrap();
    let unsure = Cockpit::new(Box::new(Unsure), values(), Rule::Misc.arbiter(1.0).unwrap());
    let mut own = cockpit(Rule::Robot);
    let mut branch = Branch::new(&record, 30, Box::new(Point::new()), &mut own, unsure).unwrap();
    while let Some(tick) = branch.tick() {
        assert!(tick.allowed.iter().all(|&allowed| allowed), "at c = 0 everything is allowed");
    }
}

#[test]
fn after_the_last_recorded_request_nobody_asks() {
    let record = flown(Rule::Misc, 60);
    assert_eq!(record.ending, Ending::Abandoned);
    let mut branch = branch(&record, 60, Rule::Robot).unwrap();
    assert!(rest(&mut branch).iter().all(|(asked, _)| asked.is_none()));
    assert_eq!(branch.ending(), Some(Ending::Goal));
}

/// Ticks, and what was asked at each.
type Shown = Vec<(u32, Option<Action>)>;

/// Remembers what it was shown.
struct Witness(Arc<Mutex<Shown>>);

impl IntentModel for Witness {
    fn begin(&mut self) {
        self.0.lock().unwrap().clear();
    }

    fn infer(&mut self, view: &View<'_>, asked: Option<Action>) -> Belief {
        self.0.lock().unwrap().push((view.tick, asked));
        Belief::certain(view.goals.len(), 0)
    }
}

#[test]
fn the_other_co_pilot_has_seen_every_tick_before_once() {
    let record = flown(Rule::Hic, u32::MAX);
    let seen = Arc::new(Mutex::new(vec![(7, None)]));
    let values = point::entry().values.unwrap();
    let other = Cockpit::new(Box::new(Witness(seen.clone())), values(), Rule::Misc.arbiter(1.0).unwrap());
    Branch::new(&record, 50, Box::new(Point::new()), &mut cockpit(Rule::Hic), other).unwrap();
    let shown: Vec<_> = (0..50).map(|tick| (tick, record.asked[tick as usize])).collect();
    assert_eq!(*seen.lock().unwrap(), shown);
}

#[test]
fn a_pilot_that_takes_over_is_asked_from_that_tick_on() {
    let record = flown(Rule::Hic, u32::MAX);
    let mut branch = branch(&record, 20, Rule::Hic).unwrap().flown_by(Box::new(Silent));
    assert_eq!(branch.ticks(), 20);
    assert_eq!(rest(&mut branch)[0].0, None, "the key that was held counts no more");
}

#[test]
fn what_cannot_be_flown_on_is_refused_with_a_reason() {
    let record = flown(Rule::Misc, u32::MAX);
    let ticks = record.ticks();
    let refused = |record: &Trajectory, at| branch(record, at, Rule::Hic).err().unwrap();
    assert_eq!(refused(&record, ticks as u32 + 1), BranchError::Beyond { at: ticks as u32 + 1, ticks });
    let over = BranchError::Over { at: ticks as u32, ending: record.ending };
    assert_eq!(refused(&record, ticks as u32), over);
    let mut other = record.clone();
    other.executed[9] = None;
    assert_eq!(refused(&other, 30), BranchError::Strayed { tick: 9 });
    assert!(branch(&other, 9, Rule::Hic).is_ok(), "up to there it is the same flight");
}

proptest! {
    /// Whatever rule goes on from wherever: the branch ends, and what lies before it is the record.
    #[test]
    fn any_rule_goes_on_from_any_tick(own in 0..Rule::USUAL.len(), other in 0..Rule::USUAL.len(), part in 0.0..1.0_f64) {
        let record = flown(Rule::USUAL[own], u32::MAX);
        let at = (part * record.ticks() as f64) as u32;
        let mut branch = branch(&record, at, Rule::USUAL[other]).unwrap();
        prop_assert_eq!(branch.ticks(), at);
        let rest = rest(&mut branch);
        prop_assert!(branch.ending().is_some());
        prop_assert_eq!(branch.ticks() as usize, at as usize + rest.len());
    }
}
