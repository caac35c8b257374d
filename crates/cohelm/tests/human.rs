//! What a simulated person does, each behaviour alone: a scripted world in, key presses and requests out.
//!
//! The world is two errors (one an axis, each with a key for either sign) and four lamps that show which switches are
//! on; the skill reads the errors off the state, so that a test says in one line what there is to react to.

use cohelm::action::{Action, ActionSpace, Lever, Push, Switch};
use cohelm::human::{
    Axis, HumanError, HumanPilot, Mood, NOISE_MEMORY, Plan, Population, Ranges, SHORTEST_DWELL_TICKS, Seen,
    Skill, Traits,
};
use cohelm::pilot::Pilot;
use cohelm::plant::{Goal, View};
use cohelm::random::Draws;
use proptest::prelude::*;
use std::sync::{Arc, Mutex};

/// State: two errors, a speed, and a lamp for each of the four switches.
const LAMPS: usize = 3;
type State = [f32; 7];

/// Errors are read off the state; what was seen is kept for the test to look at.
struct Reader {
    plan: Plan,
    seen: Arc<Mutex<Vec<f64>>>,
}

impl Skill for Reader {
    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn errors(&self, seen: &Seen<'_>, errors: &mut [f64]) {
        errors.copy_from_slice(&seen.state[..errors.len()]);
        *self.seen.lock().expect("no test panics while it holds this") = seen.state.to_vec();
    }
}

/// Keys 0 and 1 correct the first error, 2 and 3 the second, which may be dropped.
fn plan(axes: usize) -> Plan {
    let axis = |i: u8| Axis {
        name: "error",
        plus: Some(2 * i),
        minus: Some(2 * i + 1),
        release: 0.3,
        droppable: i == 1,
    };
    Plan {
        axes: (0..axes as u8).map(axis).collect(),
        moving: vec![0, 2],
        judged: vec![2],
        shown: (LAMPS..LAMPS + 4).map(Some).collect(),
    }
}

/// Nobody in particular: no slips, no moods, no prediction.
const PLAIN: Traits = Traits {
    delay_ticks: 10,
    dwell_ticks: 20.0,
    hold_ticks: 4,
    wrong_key: 0.0,
    speed_gain: 1.0,
    speed_noise: 0.0,
    dead_band: 1.0,
    drop_key: 0.5,
    prediction: 0.0,
    urgency: 0.5,
    resist: 0.0,
    trust: 0.0,
    insist_ticks: 0,
};

fn switches() -> ActionSpace {
    let switch = |i: u8| Switch { name: format!("{i}"), push: Push { axis: i / 2, forwards: i % 2 == 0 } };
    ActionSpace::Switches { switches: (0..4).map(switch).collect() }
}

/// A pilot in a world whose switches obey it, or do not.
struct Bench {
    pilot: HumanPilot,
    seen: Arc<Mutex<Vec<f64>>>,
    tick: u32,
    lamps: [f32; 4],
    obedient: bool,
}

impl Bench {
    fn new(traits: Traits, axes: usize) -> Self {
        Self::over(&switches(), traits, axes)
    }

    fn over(space: &ActionSpace, traits: Traits, axes: usize) -> Self {
        let seen = Arc::default();
        let skill = Reader { plan: plan(axes), seen: Arc::clone(&seen) };
        let mut pilot = HumanPilot::new(traits, Box::new(skill), space).expect("the traits are possible");
        pilot.begin(1);
        Self { pilot, seen, tick: 0, lamps: [0.0; 4], obedient: true }
    }

    /// One tick with these errors and this speed.
    fn tick(&mut self, [first, second, speed]: [f32; 3]) -> Option<Action> {
        let mut state: State = [first, second, speed, 0.0, 0.0, 0.0, 0.0];
        state[LAMPS..].copy_from_slice(&self.lamps);
        let goals = [Goal { id: 0, position: [0.0, 0.0] }];
        let view = View { tick: self.tick, state: &state, position: [0.0; 2], switches: 0, goals: &goals };
        let asked = self.pilot.ask(&view, 0);
        self.tick += 1;
        if let Some(command) = asked.and_then(|action| action.command()).filter(|_| self.obedient) {
            self.lamps[command / 2] = if command % 2 == 0 { 1.0 } else { 0.0 };
        }
        asked
    }

    /// The command asked for at each tick of a script.
    fn commands(&mut self, ticks: usize, script: impl Fn(usize) -> [f32; 3]) -> Vec<Option<usize>> {
        (0..ticks).map(|t| self.tick(script(t)).and_then(|action| action.command())).collect()
    }

    /// At every press: the key, and the axis that was attended then.
    fn presses(&mut self, ticks: usize, script: impl Fn(usize) -> [f32; 3]) -> Vec<(usize, usize)> {
        let mut presses = Vec::new();
        for t in 0..ticks {
            let before = self.pilot.key_presses();
            let asked = self.tick(script(t));
            if self.pilot.key_presses() > before {
                let command = asked.and_then(|action| action.command()).expect("a new press asks at once");
                presses.push((command / 2, self.pilot.attended()));
            }
        }
        presses
    }
}

const STILL: [f32; 3] = [0.0; 3];

#[test]
fn an_event_is_answered_exactly_one_reaction_delay_later() {
    for delay_ticks in [0, 1, 8, 15] {
        let mut bench = Bench::new(Traits { delay_ticks, ..PLAIN }, 1);
        let commands = bench.commands(60, |t| if t < 30 { STILL } else { [5.0, 0.0, 0.0] });
        let answer = commands.iter().position(Option::is_some);
        assert_eq!(answer, Some(30 + delay_ticks as usize));
        assert_eq!(commands[30 + delay_ticks as usize], Some(0));
    }
}

#[test]
fn nothing_is_answered_before_a_reaction_delay_has_passed() {
    let commands = Bench::new(PLAIN, 1).commands(20, |_| [5.0, 0.0, 0.0]);
    assert_eq!(commands.iter().position(Option::is_some), Some(10));
}

#[test]
fn a_key_is_held_at_least_so_long_and_its_release_is_asked_for_once() {
    let flash = |t| if t == 0 { [5.0, 0.0, 0.0] } else { STILL };
    let commands = Bench::new(PLAIN, 1).commands(20, flash);
    let mut expected = vec![None; 20];
    expected[10..14].fill(Some(0));
    expected[14] = Some(1);
    assert_eq!(commands, expected);
}

#[test]
fn errors_within_the_dead_band_are_left_alone() {
    let pressed = |error: f32, dead_band| {
        !Bench::new(Traits { dead_band, ..PLAIN }, 1).presses(100, |_| [error, 0.0, 0.0]).is_empty()
    };
    assert!(!pressed(0.99, 1.0) && pressed(1.01, 1.0));
    assert!(!pressed(1.4, 1.5) && pressed(0.9, 0.8));
}

#[test]
fn the_sign_of_the_error_chooses_the_key_and_the_key_outlives_the_dead_band() {
    let presses =
        Bench::new(PLAIN, 1).presses(100, |t| if t < 50 { [2.0, 0.0, 0.0] } else { [-2.0, 0.0, 0.0] });
    assert_eq!(presses, [(0, 0), (1, 0)]);
    let mut bench = Bench::new(PLAIN, 1);
    let commands = bench.commands(100, |t| [if t < 30 { 2.0 } else { 0.5 }, 0.0, 0.0]);
    assert!(commands[10..].iter().all(|&command| command == Some(0)), "0.5 is above the release at 0.3");
}

#[test]
fn only_keys_of_the_attended_axis_are_pressed() {
    for seed in 0..20 {
        let traits = Traits { wrong_key: 0.0, ..Population::Ordinary.ranges().draw(&mut Draws::new(seed)) };
        let mut bench = Bench::new(traits, 2);
        let wave = |t: usize| [4.0, -4.0, 0.0].map(|x: f32| if t % 40 < 20 { x } else { -x });
        let presses = bench.presses(2000, wave);
        assert!(presses.len() > 40);
        assert!(presses.iter().all(|&(key, attended)| key / 2 == attended), "seed {seed}: {presses:?}");
        assert!([0, 1].iter().all(|axis| presses.iter().any(|(_, attended)| attended == axis)));
    }
}

#[test]
fn attention_stays_as_long_as_the_dwell_says() {
    let mut bench = Bench::new(Traits { urgency: 0.0, dwell_ticks: 30.0, ..PLAIN }, 2);
    let (mut stays, mut since, mut attended) = (Vec::new(), 0, None);
    for t in 0..200_000 {
        bench.tick(STILL);
        if Some(bench.pilot.attended()) != attended {
            stays.push(t - since);
            (since, attended) = (t, Some(bench.pilot.attended()));
        }
    }
    let stays = &stays[2..];
    let mean = stays.iter().sum::<usize>() as f64 / stays.len() as f64;
    assert!((mean - 30.5).abs() < 0.5, "half fixed, half exponential, rounded up to whole ticks: {mean}");
    assert!(stays.iter().all(|&stay| stay >= 15 && stay as f64 >= SHORTEST_DWELL_TICKS));
}

#[test]
fn urgency_is_how_often_attention_goes_to_the_worst_axis() {
    let share = |urgency| {
        let mut bench = Bench::new(Traits { urgency, ..PLAIN }, 2);
        let on_second = (0..50_000).filter(|_| {
            bench.tick([0.1, 3.0, 0.0]);
            bench.pilot.attended() == 1
        });
        on_second.count() as f64 / 50_000.0
    };
    assert!((share(0.0) - 0.5).abs() < 0.02);
    assert!(share(1.0) > 0.99);
}

#[test]
fn a_droppable_key_is_dropped_at_the_pilots_rate_and_others_stay_down() {
    let kept = |axis: usize, drop_key| {
        let error = if axis == 0 { [3.0, 0.0, 0.0] } else { [0.0, 3.0, 0.0] };
        let mut bench = Bench::new(Traits { drop_key, urgency: 0.0, ..PLAIN }, 2);
        let (mut switches, mut kept) = (0, 0);
        let mut attended = bench.pilot.attended();
        for _ in 0..50_000 {
            bench.tick(error);
            let left = attended == axis && bench.pilot.attended() != axis;
            attended = bench.pilot.attended();
            if left {
                (0..6).for_each(|_| _ = bench.tick(error));
                switches += 1;
                kept += usize::from(bench.lamps[2 * axis] == 1.0);
            }
        }
        kept as f64 / switches as f64
    };
    assert_eq!(kept(0, 0.3), 1.0);
    assert!((kept(1, 0.3) - 0.7).abs() < 0.05, "{}", kept(1, 0.3));
}

#[test]
fn slips_come_at_the_pilots_rate_hit_any_other_key_and_do_not_last() {
    let mut bench = Bench::new(Traits { wrong_key: 0.3, ..PLAIN }, 1);
    let blink = |t: usize| if t % 20 < 10 { [3.0, 0.0, 0.0] } else { STILL };
    let presses = bench.presses(60_000, blink);
    let slips: Vec<usize> = presses.iter().map(|(key, _)| *key).filter(|&key| key != 0).collect();
    let rate = slips.len() as f64 / presses.len() as f64;
    assert!((rate - 0.3).abs() < 0.02, "{rate}");
    for key in 1..4 {
        let share = slips.iter().filter(|&&slip| slip == key).count() as f64 / slips.len() as f64;
        assert!((share - 1.0 / 3.0).abs() < 0.05, "key {key}: {share}");
    }
    bench.commands(30, |_| STILL);
    assert_eq!(bench.lamps, [0.0; 4], "a wrong key does not stay down");
}

#[test]
fn a_speed_is_misjudged_by_the_gain_and_by_slow_noise() {
    let mut bench = Bench::new(Traits { speed_gain: 0.5, speed_noise: 0.2, ..PLAIN }, 1);
    let errors: Vec<f64> = (0..100_000)
        .map(|_| {
            bench.tick([0.0, 0.0, 2.0]);
            bench.seen.lock().expect("not poisoned").get(2).map_or(0.0, |speed| speed / (0.5 * 2.0) - 1.0)
        })
        .skip(20)
        .collect();
    let n = errors.len() as f64;
    let variance = errors.iter().map(|e| e * e).sum::<f64>() / n;
    let lagged = errors.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / n;
    assert!((variance.sqrt() - 0.2).abs() < 0.01, "{}", variance.sqrt());
    assert!((lagged / variance - NOISE_MEMORY).abs() < 0.005, "{}", lagged / variance);
}

#[test]
fn prediction_carries_places_and_speeds_forward_at_the_rate_last_seen() {
    for (prediction, place, speed) in
        [(0.0, 4.0, 8.0), (0.5, 4.0 + 5.0 * 0.25, 8.0 + 5.0 * 0.5), (1.0, 6.5, 13.0)]
    {
        let mut bench = Bench::new(Traits { prediction, ..PLAIN }, 1);
        bench.commands(17 + 10, |t| [0.25 * t as f32, 0.0, 0.5 * t as f32]);
        let seen = bench.seen.lock().expect("not poisoned");
        assert_eq!((seen[0], seen[2]), (place, speed), "seen: tick 16, and the one before");
    }
}

#[test]
fn a_plant_that_obeys_frustrates_nobody() {
    for seed in 0..20 {
        let mut draws = Draws::new(seed);
        for population in Population::ALL {
            let mut bench = Bench::new(population.ranges().draw(&mut draws), 2);
            let wave = |t: usize| [4.0, -4.0, 0.0].map(|x: f32| if t % 50 < 20 { x } else { -x });
            for t in 0..1500 {
                bench.tick(wave(t));
                assert_eq!(bench.pilot.mood().frustration, 0.0, "{population} {seed} at {t}");
            }
        }
    }
}

#[test]
fn a_key_that_does_nothing_frustrates_after_the_delay_and_is_hit_again_by_those_who_resist() {
    let presses = |resist| {
        let mut bench = Bench::new(Traits { resist, ..PLAIN }, 1);
        bench.obedient = false;
        bench.commands(10 + 11, |_| [3.0, 0.0, 0.0]);
        assert_eq!(
            bench.pilot.mood().frustration,
            0.0,
            "pressed at tick 10, seen to do nothing from tick 21"
        );
        bench.tick([3.0, 0.0, 0.0]);
        assert_eq!(bench.pilot.mood().frustration, 0.04);
        bench.commands(1000, |_| [3.0, 0.0, 0.0]);
        bench.pilot.key_presses()
    };
    assert_eq!(presses(0.0), 1);
    assert!((40..200).contains(&presses(1.0)), "{}", presses(1.0));
}

#[test]
fn an_opposite_lamp_is_a_conflict_too() {
    let mut bench = Bench::new(PLAIN, 1);
    bench.commands(15, |_| [3.0, 0.0, 0.0]);
    bench.lamps[1] = 1.0;
    bench.commands(11, |_| [3.0, 0.0, 0.0]);
    assert_eq!(bench.pilot.mood().frustration, 0.04);
}

#[test]
fn trust_grows_in_a_calm_flight_and_widens_the_dead_band() {
    let pressed_at = |trust| {
        let mut bench = Bench::new(Traits { trust, ..PLAIN }, 1);
        bench.commands(111, |_| STILL);
        assert!((bench.pilot.mood().trust - 1.0).abs() < 1e-9, "101 ticks after the first that was seen");
        (1..200).find(|tenths| !bench.presses(12, |_| [*tenths as f32 / 10.0, 0.0, 0.0]).is_empty())
    };
    assert_eq!(pressed_at(0.0), Some(11));
    assert!(pressed_at(1.0) > Some(25));
}

#[test]
fn the_dead_band_follows_the_mood_but_never_closes() {
    let traits = Traits { dead_band: 2.0, trust: 0.5, resist: 1.0, ..PLAIN };
    let band = |trust, frustration| Mood { trust, frustration }.dead_band(&traits);
    assert_eq!([band(0.0, 0.0), band(1.0, 0.0), band(0.0, 1.0)], [2.0, 4.0, 1.2]);
    let furious = Traits { resist: 3.0, ..traits };
    assert_eq!(Mood { trust: 0.0, frustration: 1.0 }.dead_band(&furious), 1.0);
}

#[test]
fn those_who_insist_hold_a_key_until_they_have_seen_it_work_or_lost_patience() {
    let held = |obedient| {
        let mut bench = Bench::new(Traits { insist_ticks: 75, ..PLAIN }, 1);
        bench.obedient = obedient;
        let commands = bench.commands(200, |t| if t < 5 { [3.0, 0.0, 0.0] } else { STILL });
        commands.iter().filter(|&&command| command == Some(0)).count()
    };
    assert_eq!(held(true), 11, "lit one tick after the press, seen ten ticks later");
    assert_eq!(held(false), 75);
}

#[test]
fn the_same_seed_asks_the_same_and_another_does_not() {
    let flight = |seed| {
        let mut bench = Bench::new(Population::Ordinary.ranges().draw(&mut Draws::new(3)), 2);
        bench.pilot.begin(seed);
        bench.commands(1000, |t| if t % 50 < 25 { [2.0, 2.0, 1.0] } else { [-2.0, 0.0, 1.0] })
    };
    assert_eq!(flight(5), flight(5));
    assert_ne!(flight(5), flight(6));
}

#[test]
fn beginning_again_forgets_everything() {
    let script = |t: usize| if t % 50 < 25 { [2.0, 2.0, 1.0] } else { [-2.0, 0.0, 1.0] };
    let mut bench = Bench::new(Population::Fighters.ranges().draw(&mut Draws::new(3)), 2);
    let fresh = bench.commands(500, script);
    bench.pilot.begin(1);
    bench.lamps = [0.0; 4];
    assert_eq!(bench.commands(500, script), fresh);
}

#[test]
fn levers_are_worked_by_the_same_person() {
    let lever = |name: &str| Lever {
        name: name.into(),
        positions: ["back", "rest", "ahead"].map(String::from).into(),
        neutral: 1,
    };
    let space = ActionSpace::Levers { levers: vec![lever("first"), lever("second")] };
    let mut bench = Bench::over(&space, Traits { drop_key: 0.0, urgency: 0.0, ..PLAIN }, 2);
    let asked = bench.commands(300, |_| [2.0, -2.0, 0.0]);
    assert_eq!(
        asked.last(),
        Some(&Some(2)),
        "the first lever is back and stays, the second is ahead: 0 · 3 + 2"
    );
    assert_eq!(bench.pilot.key_presses(), 2);
}

#[test]
fn people_are_drawn_from_their_ranges_and_fill_them() {
    let drawn: Vec<Traits> = (0..4000).map(|i| Ranges::ORDINARY.draw(&mut Draws::fork(2024, i))).collect();
    for delay_ticks in 8..=15 {
        let share = drawn.iter().filter(|traits| traits.delay_ticks == delay_ticks).count() as f64 / 4000.0;
        assert!((share - 1.0 / 8.0).abs() < 0.02, "{delay_ticks}: {share}");
    }
    let filled = |name: &str, of: fn(&Traits) -> f64, [low, high]: [f64; 2]| {
        let (least, most) = drawn.iter().map(of).fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
        let slack = 0.01 * (high - low);
        assert!(least >= low && least < low + slack && most <= high && most > high - slack, "{name}");
    };
    filled("dwell", |t| t.dwell_ticks, [15.0, 50.0]);
    filled("wrong key", |t| t.wrong_key, [0.01, 0.06]);
    filled("speed gain", |t| t.speed_gain, [0.4, 1.0]);
    filled("dead band", |t| t.dead_band, [0.8, 1.5]);
    filled("drop key", |t| t.drop_key, [0.2, 0.7]);
    filled("prediction", |t| t.prediction, [0.2, 0.8]);
    filled("urgency", |t| t.urgency, [0.3, 0.9]);
    filled("resist", |t| t.resist, [0.3, 1.0]);
    filled("trust", |t| t.trust, [0.3, 1.0]);
}

#[test]
fn populations_differ_only_in_what_they_are_named_for() {
    let person = |population: Population| population.ranges().draw(&mut Draws::new(9));
    let ordinary = person(Population::Ordinary);
    let fighter = person(Population::Fighters);
    assert_eq!(Traits { resist: ordinary.resist, ..fighter }, ordinary);
    assert!((2.0..=3.0).contains(&fighter.resist));
    let slow = person(Population::Slow);
    assert_eq!(Traits { delay_ticks: ordinary.delay_ticks, ..slow }, ordinary);
    for population in Population::ALL {
        (0..100).for_each(|i| {
            population.ranges().draw(&mut Draws::new(i)).check().expect("a population of possible people")
        });
    }
}

#[test]
fn populations_have_names_and_an_unknown_one_is_told_them() {
    for population in Population::ALL {
        assert_eq!(population.to_string().parse(), Ok(population));
        let json = serde_json::to_string(&population).expect("a word");
        assert_eq!(json, format!("\"{population}\""));
    }
    let error = "people".parse::<Population>().unwrap_err().to_string();
    assert!(Population::ALL.iter().all(|population| error.contains(population.word())), "{error}");
}

#[test]
fn impossible_people_and_skills_for_other_keys_are_refused() {
    let refused = |traits: Traits, space: &ActionSpace| {
        let skill = Reader { plan: plan(2), seen: Arc::default() };
        HumanPilot::new(traits, Box::new(skill), space)
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default()
    };
    let mut wrong = Traits { wrong_key: 1.5, ..PLAIN };
    assert_eq!(refused(wrong, &switches()), "a pilot's wrong_key is 1.5; expected a number from 0 to 1");
    wrong = Traits { dead_band: f64::NAN, ..PLAIN };
    assert!(refused(wrong, &switches()).contains("dead_band is NaN"));
    wrong = Traits { delay_ticks: 5000, ..PLAIN };
    assert!(refused(wrong, &switches()).contains("at most 1000 ticks"));
    let two = ActionSpace::Axes { names: vec!["x".into()], low: vec![-1.0], high: vec![1.0] };
    assert!(refused(PLAIN, &two).contains("uses control 2"));
    let none = Reader { plan: plan(0), seen: Arc::default() };
    assert!(matches!(HumanPilot::new(PLAIN, Box::new(none), &switches()), Err(HumanError::NoAxes)));
}

proptest! {
    /// Whoever it is and whatever happens: requests belong to the space, and moods stay moods.
    #[test]
    fn nobody_ever_asks_for_what_there_is_not(
        seed in any::<u64>(),
        person in any::<u64>(),
        population in 0..Population::ALL.len(),
        script in prop::collection::vec([-20.0_f32..20.0, -20.0..20.0, -2.0..2.0], 1..60),
        obedient in any::<bool>(),
    ) {
        let traits = Population::ALL[population].ranges().draw(&mut Draws::new(person));
        let mut bench = Bench::new(traits, 2);
        bench.obedient = obedient;
        bench.pilot.begin(seed);
        for t in 0..600 {
            let asked = bench.tick(script[t / 10 % script.len()]);
            prop_assert!(asked.is_none_or(|action| switches().contains(action)));
            let Mood { trust, frustration } = bench.pilot.mood();
            prop_assert!((0.0..=1.0).contains(&trust) && (0.0..=1.0).contains(&frustration));
        }
    }
}
