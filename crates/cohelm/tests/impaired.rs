//! Pilots that know every value, and what lagging and straying make of them.

use cohelm::action::{Action, ActionSpace};
use cohelm::arbitration::HumanAlone;
use cohelm::cockpit::Cockpit;
use cohelm::impaired::{Greedy, Laggy, Noisy, NotAProbability};
use cohelm::pilot::{Pilot, Silent};
use cohelm::plant::{Ending, Plant, View};
use cohelm::point::{self, Point};

/// Asks for 0, 1, 2, … in turn.
struct Counter(u8);

impl Pilot for Counter {
    fn begin(&mut self, _seed: u64) {
        self.0 = 0;
    }

    fn ask(&mut self, _view: &View<'_>, _goal: usize) -> Option<Action> {
        self.0 = self.0.wrapping_add(1);
        Some(Action::Command(self.0 - 1))
    }
}

fn requests(pilot: &mut dyn Pilot, ticks: usize) -> Vec<Option<Action>> {
    let point = Point::new();
    pilot.begin(4);
    (0..ticks).map(|_| pilot.ask(&point.view(), 0)).collect()
}

fn commands() -> ActionSpace {
    ActionSpace::Single { names: ["nothing", "a", "b", "c"].map(String::from).into(), pushes: vec![None; 4] }
}

fn greedy() -> Box<dyn Pilot> {
    Box::new(Greedy::new(point::entry().values.expect("the point has values made by hand")()))
}

fn ending(pilot: &mut dyn Pilot, seed: u64) -> Ending {
    let mut point = Point::new();
    let mut cockpit = Cockpit::unassisted(&point, Box::new(HumanAlone));
    point.reset(seed);
    pilot.begin(seed);
    loop {
        if let Some(ending) = cockpit.tick(&mut point, pilot).step.ending {
            return ending;
        }
    }
}

#[test]
fn a_greedy_pilot_flies_to_its_own_goal() {
    assert!((0..20).all(|seed| ending(&mut *greedy(), seed) == Ending::Goal));
}

#[test]
fn a_laggy_pilot_repeats_itself_at_its_rate_and_otherwise_asks_what_is_fresh() {
    let mut laggy = Laggy::new(Box::new(Counter(0)), 0.85).expect("a probability");
    let asked = requests(&mut laggy, 200);
    assert_eq!(asked[0], Some(Action::Command(0)), "at first there is nothing to repeat");
    let fresh =
        asked.iter().enumerate().filter(|(t, asked)| **asked == Some(Action::Command(*t as u8))).count();
    let repeats = asked.windows(2).filter(|pair| pair[0] == pair[1]).count();
    assert_eq!(fresh + repeats, 200);
    assert!((repeats as f64 / 199.0 - 0.85).abs() < 0.08, "{repeats}");
}

#[test]
fn silence_is_repeated_like_anything_else() {
    let mut laggy = Laggy::new(Box::new(Silent), 0.5).expect("a probability");
    assert!(requests(&mut laggy, 50).iter().all(Option::is_none));
}

#[test]
fn a_noisy_pilot_strays_at_its_rate_to_every_command_alike() {
    let mut noisy = Noisy::new(Box::new(Silent), 0.3, &commands()).expect("a probability");
    let asked = requests(&mut noisy, 10_000);
    for command in 0..4 {
        let share = asked.iter().filter(|asked| **asked == Some(Action::Command(command))).count() as f64;
        assert!((share / 10_000.0 - 0.3 / 4.0).abs() < 0.01, "{command}: {share}");
    }
}

#[test]
fn on_axes_a_noisy_pilot_stays_within_bounds() {
    let point = Point::new();
    let mut noisy = Noisy::new(Box::new(Silent), 1.0, point.space()).expect("a probability");
    let asked = requests(&mut noisy, 1000);
    assert!(asked.iter().all(|asked| asked.is_some_and(|action| point.space().contains(action))));
    assert!(asked.iter().flatten().any(|action| action.axis(0) < -0.9 && action.axis(2) == 0.0));
}

#[test]
fn at_probability_0_both_are_the_pilot_underneath_and_the_same_seed_asks_the_same() {
    let plain = requests(&mut Counter(0), 100);
    assert_eq!(requests(&mut Laggy::new(Box::new(Counter(0)), 0.0).unwrap(), 100), plain);
    assert_eq!(requests(&mut Noisy::new(Box::new(Counter(0)), 0.0, &commands()).unwrap(), 100), plain);
    let mut both =
        Noisy::new(Box::new(Laggy::new(Box::new(Counter(0)), 0.5).unwrap()), 0.5, &commands()).unwrap();
    assert_eq!(requests(&mut both, 100), requests(&mut both, 100));
}

#[test]
fn a_lag_that_nobody_corrects_costs_flights() {
    let goals = |p| {
        let flies = |seed: &u64| ending(&mut Laggy::new(greedy(), p).unwrap(), *seed) == Ending::Goal;
        (0..40).filter(flies).count()
    };
    assert!(goals(0.98) < goals(0.5), "{} and {}", goals(0.98), goals(0.5));
}

#[test]
fn what_is_no_probability_is_refused() {
    for p in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(Laggy::new(Box::new(Silent), p), Err(NotAProbability(_))));
        assert!(Noisy::new(Box::new(Silent), p, &commands()).is_err());
    }
}
