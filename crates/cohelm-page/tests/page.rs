//! The page as safe Rust: it flies as the loop itself does, shows any moment of a record, and refuses what is wrong.

use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::flight::Flight;
use cohelm::intent::Inference;
use cohelm::keys::Change;
use cohelm::registry::{PlantEntry, Plants, Task};
use cohelm::report::TickReport;
use cohelm::trajectory::{Setup, Trajectory, read_events};
use cohelm_copilot::Models;
use cohelm_page::branching::Hands;
use cohelm_page::fleet::{Crew, plants};
use cohelm_page::page::{Page, PageError};
use proptest::prelude::*;

fn setup(rule: Rule) -> Setup {
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
        pilot: "person".into(),
    }
}

fn bytes(setup: &Setup) -> Vec<u8> {
    serde_json::to_vec(setup).unwrap()
}

fn begun(setup: &Setup) -> Page {
    let mut page = Page::new();
    page.begin(&bytes(setup)).unwrap();
    page
}

const KEYS: [(u32, Change); 5] = [
    (0, Change::Down(3)),
    (20, Change::Up(3)),
    (25, Change::Stick([20_000, -9_000, 0, 0])),
    (40, Change::ReleaseAll),
    (60, Change::Down(0)),
];

/// Flies 100 ticks under [`KEYS`].
fn flown(setup: &Setup) -> (Vec<u8>, Vec<TickReport>) {
    let mut page = begun(setup);
    let mut reports = Vec::new();
    for tick in 0..100 {
        for (_, change) in KEYS.iter().filter(|(at, _)| *at == tick) {
            page.change(*change, tick as f32 * 20.0).unwrap();
        }
        reports.extend(page.tick().unwrap());
    }
    (page.finish().unwrap(), reports)
}

#[test]
fn the_page_flies_as_the_loop_does() {
    for rule in [Rule::Hic, Rule::Robot, Rule::Lasc, Rule::Misc, Rule::Tolerance { alpha: 0.4 }] {
        let crew = Crew::of(&setup(rule), &plants(), &Models::new()).unwrap();
        let mut flight = Flight::new(setup(rule), crew.plant, crew.cockpit);
        for tick in 0..100 {
            for (_, change) in KEYS.iter().filter(|(at, _)| *at == tick) {
                flight.change(*change, tick as f32 * 20.0);
            }
            flight.tick();
        }
        assert_eq!(flown(&setup(rule)).0, flight.finish().to_bytes(), "{rule:?}");
    }
}

#[test]
fn the_key_log_can_be_taken_piece_by_piece() {
    let mut page = begun(&setup(Rule::Hic));
    page.change(Change::Down(1), 1.0).unwrap();
    page.change(Change::Up(1), 2.0).unwrap();
    let taken = page.events_from(0).unwrap();
    page.change(Change::ReleaseAll, 3.0).unwrap();
    let all = [taken, page.events_from(2).unwrap()].concat();
    assert_eq!(read_events(&all).unwrap(), Trajectory::from_bytes(&page.finish().unwrap()).unwrap().keys);
}

#[test]
fn any_moment_of_a_record_is_shown_as_it_was_flown() {
    let (record, reports) = flown(&setup(Rule::Misc));
    let mut page = Page::new();
    assert_eq!(page.watch(&record).unwrap().ticks, Some(reports.len() as u32));
    for ticks in [40, 3, 41, 100, 1, 5000] {
        let shown = page.seek(ticks).unwrap().unwrap();
        let flown = &reports[(ticks as usize).min(reports.len()) - 1];
        assert_eq!(serde_json::to_string(&shown).unwrap(), serde_json::to_string(flown).unwrap());
    }
    assert!(page.seek(0).unwrap().is_none());
}

#[test]
fn a_record_that_was_tampered_with_is_shown_to_differ() {
    let (record, _) = flown(&setup(Rule::Misc));
    let mut trajectory = Trajectory::from_bytes(&record).unwrap();
    trajectory.executed[9] = None;
    let mut page = Page::new();
    page.watch(&trajectory.to_bytes()).unwrap();
    assert!(!page.seek(9).unwrap().unwrap().differs && page.seek(10).unwrap().unwrap().differs);
    assert!(
        !page.replay(&trajectory.to_bytes()).unwrap().identical && page.replay(&record).unwrap().identical
    );
}

#[test]
fn replaying_does_not_disturb_what_is_shown() {
    let (record, _) = flown(&setup(Rule::Misc));
    let mut page = begun(&setup(Rule::Misc));
    page.tick().unwrap();
    let before = page.digests().unwrap();
    page.replay(&record).unwrap();
    assert_eq!((before.ticks, &before), (1, &page.digests().unwrap()));
}

#[test]
fn a_flight_that_ended_stays_ended() {
    let mut page = begun(&setup(Rule::Robot));
    let ended = std::iter::from_fn(|| page.tick().unwrap()).last().unwrap();
    assert_eq!(ended.ending, Some(cohelm::plant::Ending::Goal));
    assert!(page.tick().unwrap().is_none());
}

#[test]
fn the_opening_marks_the_pilots_own_goal() {
    let mut page = Page::new();
    let opening = page.begin(&bytes(&setup(Rule::Robot))).unwrap();
    let reached = std::iter::from_fn(|| page.tick().unwrap()).last().unwrap();
    let own = opening.goals.iter().find(|goal| Some(goal.id) == opening.pilot_goal).unwrap();
    let [at] = reached.poses[..] else { panic!("the point has one part") };
    assert!((at.x - own.position[0]).hypot(at.y - own.position[1]) < 0.1);
}

#[test]
fn what_is_wrong_is_refused_with_a_reason() {
    let refused = |change: fn(&mut Setup)| {
        let mut setup = setup(Rule::Misc);
        change(&mut setup);
        Page::new().begin(&bytes(&setup)).unwrap_err().to_string()
    };
    assert!(refused(|s| s.plant_version = 9).contains("this program has version 1"));
    assert!(refused(|s| s.seed = u64::MAX).contains("seed"));
    assert!(refused(|s| s.task = Task::new("kite")).contains("there are: flag-lander, gymnasium-lander, "));
    assert!(refused(|s| s.task = Task::new("point").with("wind", 3)).contains("no options"));
    assert!(refused(|s| s.rule = Rule::Tolerance { alpha: 2.0 }).contains("[0, 1]"));
    assert!(refused(|s| s.inference = Inference::Softmax).contains("intent model"));
    assert!(refused(|s| s.rule = Rule::MiscR { kappa: 0.7 }).contains("median range"));
    assert!(Page::new().begin(b"{").unwrap_err().to_string().contains("setup"));
    assert!(matches!(Page::new().tick(), Err(PageError::NoFlight)));
    assert!(matches!(Page::new().finish(), Err(PageError::NoFlight)));
    assert!(matches!(begun(&setup(Rule::Hic)).seek(1), Err(PageError::NoRecord)));
    assert!(matches!(begun(&setup(Rule::Hic)).change(Change::ReleaseAll, f32::NAN), Err(PageError::Time(_))));
}

#[test]
fn a_record_with_an_action_of_another_plant_is_refused() {
    let mut trajectory = Trajectory::from_bytes(&flown(&setup(Rule::Hic)).0).unwrap();
    trajectory.asked[7] = Some(cohelm::action::Action::Command(3));
    let error = Page::new().watch(&trajectory.to_bytes()).unwrap_err();
    assert!(matches!(error, PageError::Action { .. }), "{error}");
}

proptest! {
    /// Fuzz-like: whatever the bytes, the page answers or refuses, and goes on.
    #[test]
    fn damaged_bytes_are_answered(position in 0_usize..4000, value: u8, cut in 0_usize..64) {
        let (mut record, _) = flown(&setup(Rule::Misc));
        let position = position % record.len();
        record[position] = value;
        record.truncate(record.len() - cut);
        let mut page = Page::new();
        if page.watch(&record).is_ok() {
            prop_assert!(page.seek(3).is_ok());
        }
        let _ = page.replay(&record);
        prop_assert!(page.begin(&record).is_err());
        let mut setup = bytes(&setup(Rule::Misc));
        let position = position % setup.len();
        setup[position] = value;
        let _ = page.begin(&setup);
        prop_assert!(page.begin(&bytes(&self::setup(Rule::Hic))).is_ok());
    }
}

/// A wish that a record be flown on under a rule, with these hands (JSON).
fn wish(at: u32, rule: Rule, pilot: serde_json::Value) -> Vec<u8> {
    let wish = serde_json::json!({
        "at": at, "rule": rule, "inference": "known", "values": null, "intent": null, "pilot": pilot,
    });
    serde_json::to_vec(&wish).unwrap()
}

fn recorded() -> serde_json::Value {
    serde_json::json!({ "pilot": "recorded" })
}

/// A page that watches the flight of [`KEYS`] under a rule, and the record.
fn watching(rule: Rule) -> (Page, Vec<u8>) {
    let (record, _) = flown(&setup(rule));
    let mut page = Page::new();
    page.watch(&record).unwrap();
    (page, record)
}

#[test]
fn a_branch_under_the_recorded_rule_is_the_record() {
    let (record, reports) = flown(&setup(Rule::Misc));
    let mut page = Page::new();
    page.watch(&record).unwrap();
    page.seek(70).unwrap();
    let opening = page.branch(&wish(30, Rule::Misc, recorded())).unwrap();
    assert_eq!(opening.poses, reports[29].poses);
    for flown in &reports[30..] {
        let branched = page.tick().unwrap().unwrap();
        assert_eq!(serde_json::to_string(&branched).unwrap(), serde_json::to_string(flown).unwrap());
    }
    let Trajectory { digests, .. } = Trajectory::from_bytes(&record).unwrap();
    let branched = page.digests().unwrap();
    assert_eq!((branched.ticks, branched.plant), (100, format!("{:016x}", digests.plant)));
    assert_eq!(branched.decisions, format!("{:016x}", digests.decisions));
}

#[test]
fn a_branch_can_be_left_for_another_and_shows_its_own_rule() {
    let (mut page, _) = watching(Rule::Misc);
    page.branch(&wish(30, Rule::Robot, recorded())).unwrap();
    page.tick().unwrap();
    let opening = page.branch(&wish(10, Rule::Hic, recorded())).unwrap();
    assert_eq!(opening.setup.rule, Rule::Hic);
    let tick = page.tick().unwrap().unwrap();
    assert_eq!((tick.tick, tick.executed == tick.asked, tick.threshold), (10, true, None));
}

#[test]
fn whom_nobody_taught_the_keys_is_not_offered_and_is_refused() {
    let (_, record) = watching(Rule::Misc);
    let mut plants = Plants::default();
    plants.register(PlantEntry { skill: None, ..cohelm::point::entry() });
    let mut page = Page::with_plants(plants);
    page.watch(&record).unwrap();
    assert_eq!(page.pilots().unwrap(), [Hands::Recorded, Hands::Nobody, Hands::Greedy]);
    let person = serde_json::json!({ "pilot": "person", "population": "ordinary", "person": 0 });
    let error = page.branch(&wish(30, Rule::Misc, person)).unwrap_err().to_string();
    assert!(error.contains("has no simulated people"), "{error}");
    assert!(page.seek(40).unwrap().is_some(), "the record is still watched");
}

#[test]
fn who_follows_the_values_gets_there_alone() {
    let (mut page, _) = watching(Rule::Hic);
    page.branch(&wish(30, Rule::Hic, serde_json::json!({ "pilot": "greedy" }))).unwrap();
    let last = std::iter::from_fn(|| page.tick().unwrap()).last().unwrap();
    assert_eq!(last.ending, Some(cohelm::plant::Ending::Goal));
}

#[test]
fn a_wish_that_cannot_be_met_says_why() {
    let refused = |wish: &[u8]| watching(Rule::Misc).0.branch(wish).unwrap_err().to_string();
    assert!(refused(&wish(101, Rule::Hic, recorded())).contains("has 100 ticks"));
    assert!(refused(&wish(9, Rule::Tolerance { alpha: 7.0 }, recorded())).contains("7"));
    assert!(refused(b"{}").contains("missing field"));
    let other = serde_json::json!({ "pilot": "autopilot" });
    assert!(refused(&wish(9, Rule::Hic, other)).contains("autopilot"));
    assert!(matches!(Page::new().branch(&wish(9, Rule::Hic, recorded())), Err(PageError::NoRecord)));
    assert!(matches!(begun(&setup(Rule::Hic)).pilots(), Err(PageError::NoRecord)));
}
