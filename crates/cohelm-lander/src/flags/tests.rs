//! Flights of the flag task, held to its rules.

use super::layout::Layout;
use super::state::{LEFT_ENGINE, MAIN_ENGINE, SPIN, TILT, VX, VY, X, Y};
use super::*;
use crate::craft::WORLD_WIDTH;
use crate::flags::surface::Surface;
use proptest::prelude::*;

const LEFT_ON: Action = Action::Command(0);
const MAIN_ON: Action = Action::Command(2);

fn lander(options: FlagOptions) -> FlagLander {
    FlagLander::new(options).expect("options of a test are valid")
}

/// Level ground at 3 with pads at 5, 10 and 15; the middle one is the pilot's.
fn level(options: FlagOptions, start: Start) -> FlagLander {
    let layout = Layout::new(&Surface::new(vec![[-2.0, 3.0], [22.0, 3.0]]), &[5.0, 10.0, 15.0], 1.5, 1);
    FlagLander::begin(options, Arc::new(options.actions.space()), layout, &start, 0)
}

/// Flies until the end with what `choose` says; the return and the ending.
fn fly(lander: &mut FlagLander, mut choose: impl FnMut(&mut FlagLander) -> Option<Action>) -> (f64, Ending) {
    let mut sum = 0.0;
    loop {
        let action = choose(lander);
        let step = lander.step(action);
        sum += step.reward;
        if let Some(ending) = step.ending {
            return (sum, ending);
        }
    }
}

fn with_actions(actions: ActionSet) -> FlagOptions {
    FlagOptions { actions, ..FlagOptions::default() }
}

fn bits(lander: &FlagLander) -> Vec<u32> {
    lander.view().state.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn a_craft_put_down_on_the_goal_has_landed_there() {
    let (reward, ending) = fly(&mut level(FlagOptions::default(), Start::at(10.0, 3.75)), |_| None);
    assert_eq!(ending, Ending::Goal);
    assert!(reward > 2.5, "{reward}");
}

#[test]
fn a_craft_put_down_on_another_pad_or_beside_the_goal_has_landed_elsewhere() {
    for x in [5.0, 12.2] {
        let (reward, ending) = fly(&mut level(FlagOptions::default(), Start::at(x, 3.75)), |_| None);
        assert_eq!(ending, Ending::Elsewhere);
        assert!(reward < -0.5, "{reward}");
    }
}

#[test]
fn landing_elsewhere_may_go_on_and_costs_nothing_then() {
    let options = FlagOptions { elsewhere: Elsewhere::Continue, limit: 100, ..FlagOptions::default() };
    let mut flight = level(options, Start::at(5.0, 3.75));
    let (reward, ending) = fly(&mut flight, |_| None);
    assert_eq!((ending, flight.tick), (Ending::TimeLimit, 100));
    assert!(reward > -0.5, "{reward}");
}

#[test]
fn falling_is_a_crash() {
    let (reward, ending) = fly(&mut level(FlagOptions::default(), Start::at(10.0, 12.0)), |_| None);
    assert_eq!(ending, Ending::Crash);
    assert!(reward < 0.0, "{reward}");
}

#[test]
fn leaving_to_a_side_or_upwards_is_out_of_bounds() {
    for (vx, vy) in [(9.0, 6.0), (-9.0, 6.0), (0.0, 14.0)] {
        let start = Start { vx, vy, ..Start::at(10.0, 10.0) };
        let mut flight = level(FlagOptions::default(), start);
        assert_eq!(fly(&mut flight, |_| None).1, Ending::OutOfBounds);
        let [x, y] = flight.view().position;
        assert!(x.abs() >= 1.0 || y > 2.0, "{x} {y}");
    }
}

#[test]
fn hovering_over_the_goal_until_the_time_is_up_is_no_success() {
    let options = FlagOptions { limit: 300, ..with_actions(ActionSet::MainSide) };
    let mut flight = level(options, Start::at(10.0, 7.0));
    let (reward, ending) = fly(&mut flight, |flight| {
        let sinks_too_fast = flight.state[VY] < 0.4 - flight.state[Y];
        let main = if sinks_too_fast { Burning::MAIN } else { Burning::NONE };
        let upright = teacher::wanted(&flight.state, [0.0, 0.4]);
        let side = [Burning::LEFT, Burning::RIGHT].into_iter().find(|&side| upright.contains(side));
        Some(ActionSet::MainSide.towards(main.with(side.unwrap_or_default()), Burning::NONE))
    });
    let [x, y] = flight.view().position;
    assert!(x.abs() < 0.15 && y > 0.2, "still over the pad: {x} {y}");
    assert_eq!((ending, flight.tick), (Ending::TimeLimit, 300));
    assert!(reward < 0.5, "{reward}");
}

#[test]
fn the_seed_fixes_terrain_goal_and_start_whatever_else_is_flown() {
    let (mut a, mut b) = (lander(FlagOptions::default()), lander(FlagOptions::default()));
    for seed in 0..20 {
        a.reset(seed);
        b.reset(seed + 1);
        b.step(Some(MAIN_ON));
        b.reset(seed);
        assert_eq!((&a.layout, a.pilot_goal(), bits(&a)), (&b.layout, b.pilot_goal(), bits(&b)));
        a.reset(seed + 1);
        assert_ne!(bits(&a), bits(&b));
    }
}

#[test]
fn engines_push_and_roll_to_the_side_they_are_named_after() {
    let after = |action: Action| {
        let mut flight = level(FlagOptions::default(), Start::at(10.0, 10.0));
        (0..5).for_each(|_| {
            flight.advance(Some(action), Dispersion::NONE);
        });
        flight.state
    };
    let (left, main, right) = (after(LEFT_ON), after(MAIN_ON), after(Action::Command(4)));
    assert!(left[VX] < 0.0 && left[TILT] > 0.0 && left[SPIN] > 0.0, "{left:?}");
    assert!(right[VX] > 0.0 && right[TILT] < 0.0 && right[SPIN] < 0.0, "{right:?}");
    assert!(main[VY] > 0.0 && main[VX].abs() < 0.01, "{main:?}");
}

// The prototype measured: main engine +0.15 units/s a tick net of gravity, one side engine 0.085 rad/s a tick.
#[test]
fn engines_are_as_strong_as_in_the_prototype() {
    let mut flight = level(FlagOptions::default(), Start::at(10.0, 10.0));
    let change_of = |flight: &mut FlagLander, action| {
        let before = flight.craft.hull();
        flight.advance(Some(action), Dispersion::NONE);
        let after = flight.craft.hull();
        (after.vy - before.vy, after.omega_rad_s - before.omega_rad_s)
    };
    (0..5).for_each(|_| {
        change_of(&mut flight, Action::Command(3));
    });
    let (climb, _) = change_of(&mut flight, MAIN_ON);
    assert!((climb - 0.15).abs() < 0.03, "{climb}");
    change_of(&mut flight, Action::Command(3));
    let (_, spin) = change_of(&mut flight, LEFT_ON);
    assert!((spin - 0.085).abs() < 0.02, "{spin}");
}

#[test]
fn an_engine_stays_on_when_its_key_is_released_and_others_follow() {
    let mut flight = level(FlagOptions::default(), Start::at(10.0, 10.0));
    for (executed, switches) in [
        (None, 0b000),
        (Some(LEFT_ON), 0b001),
        (None, 0b001),
        (Some(MAIN_ON), 0b011),
        (Some(MAIN_ON), 0b011),
        (None, 0b011),
        (Some(Action::Command(1)), 0b010),
    ] {
        flight.step(executed);
        assert_eq!(flight.view().switches, switches);
        assert_eq!(flight.view().state[LEFT_ENGINE], f32::from(switches & 1));
        assert_eq!(flight.view().state[MAIN_ENGINE], f32::from(switches >> 1));
    }
}

#[test]
fn the_teacher_lands_at_the_goal() {
    let mut flight = lander(FlagOptions::default());
    let mut ticks = 0;
    let landed = (0..60).filter(|seed| {
        flight.reset(1000 + seed);
        let goal = flight.pilot_goal();
        let (_, ending) = fly(&mut flight, |flight| flight.teacher(goal));
        ticks += flight.tick;
        ending == Ending::Goal
    });
    let landed = landed.count();
    println!("teacher: {landed} of 60, {} ticks on average", ticks / 60);
    assert!(landed >= 57, "{landed} of 60");
}

#[test]
fn the_teacher_flies_to_whatever_goal_it_is_told() {
    let mut flight = lander(FlagOptions { elsewhere: Elsewhere::End, ..FlagOptions::default() });
    let lands_there = |seed: &u64| {
        flight.reset(*seed);
        let other = (flight.pilot_goal() + 1) % PADS;
        fly(&mut flight, |flight| flight.teacher(other)).1 == Ending::Elsewhere
    };
    assert!((0..20).filter(lands_there).count() >= 19);
    assert_eq!(flight.teacher(PADS), None);
}

#[test]
fn a_mirrored_flight_is_the_mirror_image_of_the_flight() {
    for (set, commands) in [
        (ActionSet::Switches, [2, 0, 3, 1, 4, 2, 5, 0]),
        (ActionSet::MainSide, [3, 0, 5, 1, 4, 2, 4, 3]),
        (ActionSet::Gymnasium, [2, 1, 2, 3, 2, 0, 2, 1]),
    ] {
        mirror_flight(set, &commands);
    }
}

/// Both fly from mirrored starts over mirrored ground, with mirrored commands and scatter, until one touches the ground:
/// contacts are solved one after the other, and that order has no mirror image.
fn mirror_flight(set: ActionSet, commands: &[u8]) {
    let terrain = |right: bool| {
        let heights = [2.0, 3.5, 3.0, 4.0, 2.5];
        let height = |i: usize| heights[if right { i } else { 4 - i }];
        Surface::new((0..5).map(|i| [5.0 * i as f64, height(i)]).collect())
    };
    let options = with_actions(set);
    let begin = |terrain: Surface, centres: [f64; 3], goal, start| {
        let layout = Layout::new(&terrain, &centres, 1.5, goal);
        FlagLander::begin(options, Arc::new(options.actions.space()), layout, &start, 0)
    };
    let start = Start { vx: 1.5, vy: 0.5, ..Start::at(8.0, 8.0) };
    let mirrored_start = Start { x: WORLD_WIDTH - start.x, vx: -start.vx, ..start };
    let mut flight = begin(terrain(true), [4.0, 9.0, 17.0], 0, start);
    let mut image = begin(terrain(false), [3.0, 11.0, 16.0], 2, mirrored_start);
    let mirror = image.mirror().expect("a set with commands has a mirror");
    let mut draws = Draws::new(5);
    let mut ticks = 0;
    while flight.craft.legs_touching() == [false; 2] && ticks < 200 {
        let command = commands[ticks / 4 % commands.len()];
        let scatter = [draws.uniform(-1.0, 1.0), draws.uniform(-1.0, 1.0)];
        let reward = flight.advance(Some(Action::Command(command)), Dispersion::from_uniform(scatter)).reward;
        let command = Action::Command(mirror.commands[usize::from(command)]);
        let image_reward =
            image.advance(Some(command), Dispersion::from_uniform([scatter[0], -scatter[1]])).reward;
        for (i, &(from, sign)) in mirror.state.iter().enumerate() {
            let (is, expected) = (image.shown[i], sign * flight.shown[from]);
            assert!(
                (is - expected).abs() < 1e-3,
                "{set:?}, tick {ticks}, component {i}: {is}, not {expected}"
            );
        }
        assert!((reward - image_reward).abs() < 1e-3, "{set:?}, tick {ticks}: {reward} and {image_reward}");
        ticks += 1;
    }
    assert!(ticks > 80, "{set:?}: a flight, not a fall: {ticks}");
}

#[test]
fn easy_starts_keep_terrain_and_goal_of_the_seed_and_begin_at_the_goal() {
    let (mut easy, mut usual) = (lander(FlagOptions::default()), lander(FlagOptions::default()));
    for seed in 0..30 {
        usual.reset(seed);
        assert!(easy.reset_near_goal(seed, 0.0));
        assert_eq!(easy.layout, usual.layout);
        let distance = |flight: &FlagLander| {
            let [x, y] = flight.view().goals[flight.pilot_goal()].position.map(f64::from);
            ((flight.state[X] - x).powi(2) + (flight.state[Y] - y).powi(2)).sqrt()
        };
        assert!(distance(&easy) < 0.05 && distance(&usual) > 0.5, "{} {}", distance(&easy), distance(&usual));
        assert_eq!(fly(&mut easy, |_| None).1, Ending::Goal, "difficulty 0 only has to wait");
    }
    assert!(!easy.reset_near_goal(0, f64::NAN));
}

#[test]
fn no_start_near_a_goal_is_over_before_it_began() {
    let mut flight = lander(FlagOptions::default());
    for seed in 0..400 {
        flight.reset_near_goal(seed, (seed % 20 + 1) as f64 / 20.0);
        assert!(!flight.craft.hull_touched() && flight.craft.legs_touching() == [false; 2], "seed {seed}");
    }
}

#[test]
fn the_scene_has_one_marked_part_for_every_goal_and_a_pose_for_every_movable_part() {
    let mut flight = lander(FlagOptions::default());
    flight.reset(3);
    let scene = flight.scene();
    let marked: Vec<u32> = scene.fixed.iter().filter_map(|part| part.goal).collect();
    assert_eq!(marked, [0, 1, 2]);
    let mut poses = Vec::new();
    flight.poses(&mut poses);
    assert_eq!(poses.len(), scene.movable.len());
    let world = |i: usize| scene.origin[i] + scene.scale[i] * flight.view().position[i];
    let hull = scene.movable.iter().position(|part| part.role == cohelm::scene::Role::Body).expect("a body");
    assert!((world(0) - poses[hull].x).abs() < 1e-4 && (world(1) - poses[hull].y).abs() < 1e-4);
    for (goal, pad) in flight.view().goals.iter().zip(&flight.layout.pads) {
        let at = [0, 1].map(|i| f64::from(scene.origin[i] + scene.scale[i] * goal.position[i]));
        assert!((at[0] - pad[0]).abs() < 1e-4 && (at[1] - pad[1] - 0.6).abs() < 1e-4);
    }
}

#[test]
fn flames_show_what_burns() {
    let mut flight = level(FlagOptions::default(), Start::at(10.0, 10.0));
    let mut poses = Vec::new();
    let mut strengths = |flight: &FlagLander| {
        flight.poses(&mut poses);
        [poses[0].strength, poses[1].strength, poses[2].strength]
    };
    assert_eq!(strengths(&flight), [0.0; 3]);
    flight.step(Some(LEFT_ON));
    assert_eq!(strengths(&flight), [0.0, 1.0, 0.0]);
    flight.step(Some(MAIN_ON));
    assert_eq!(strengths(&flight), [1.0, 1.0, 0.0]);
}

fn any_set() -> impl Strategy<Value = ActionSet> {
    prop_oneof![
        Just(ActionSet::Switches),
        Just(ActionSet::MainSide),
        Just(ActionSet::Gymnasium),
        Just(ActionSet::Continuous)
    ]
}

/// An action of the set, or none, from a random number.
fn action_of(set: ActionSet, number: u16) -> Option<Action> {
    let [high, low] = number.to_be_bytes();
    let commands = set.space().commands();
    let axis = |byte: u8| f32::from(byte) / 127.5 - 1.0;
    (number % 7 != 0).then(|| match set {
        ActionSet::Continuous => Action::axes(&[axis(high), axis(low)]),
        _ => Action::Command(high % commands as u8),
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn equal_seeds_and_actions_give_equal_bits_also_from_a_snapshot(
        set in any_set(),
        seed in any::<u64>(),
        near in any::<bool>(),
        numbers in prop::collection::vec(any::<u16>(), 1..200),
        cut in any::<prop::sample::Index>(),
    ) {
        let flight = || {
            let mut flight = lander(with_actions(set));
            if near { flight.reset_near_goal(seed, 0.3); } else { flight.reset(seed); }
            flight
        };
        let (mut first, mut second) = (flight(), flight());
        let mut third = None;
        let cut = cut.index(numbers.len());
        for (tick, &number) in numbers.iter().enumerate() {
            if tick == cut {
                third = first.snapshot();
            }
            let action = action_of(set, number);
            let step = first.step(action);
            prop_assert!(step.reward.is_finite());
            prop_assert_eq!(second.step(action), step);
            prop_assert_eq!(bits(&second), bits(&first));
            if let Some(third) = &mut third {
                prop_assert_eq!(third.step(action), step);
                prop_assert_eq!(third.view().state, first.view().state);
            }
        }
    }

    #[test]
    fn everything_that_is_seen_is_finite_and_goals_stay_sorted(seed in any::<u64>(), difficulty in 0.0..1.0) {
        let mut flight = lander(FlagOptions::default());
        flight.reset_near_goal(seed, difficulty);
        let view = flight.view();
        prop_assert!(view.state.iter().all(|value| value.is_finite()));
        prop_assert!(view.goals.windows(2).all(|pair| pair[0].position[0] < pair[1].position[0]));
        prop_assert!(view.goals.iter().all(|goal| goal.position.iter().all(|p| p.is_finite())));
    }
}

fn changing() -> FlagOptions {
    FlagOptions {
        pads: 4,
        appears_at: Some(30),
        vanishes_at: Some(60),
        changes_mind: Some([20, 90]),
        ..FlagOptions::default()
    }
}

#[test]
fn goals_come_and_go_and_are_seen_while_they_are_there() {
    let mut flight = lander(changing());
    for seed in 0..20 {
        flight.reset(seed);
        let wishes = flight.wishes();
        let scene = flight.scene();
        let passing: Vec<u32> = scene.movable.iter().filter_map(|part| part.goal).collect();
        let mut poses = Vec::new();
        for tick in 0..75 {
            let ids: Vec<u32> = flight.view().goals.iter().map(|goal| goal.id).collect();
            assert_eq!(ids.len(), if (30..60).contains(&tick) { 4 } else { 3 });
            let wish = wishes.iter().rev().find(|wish| wish.from <= tick).expect("one from the beginning");
            assert_eq!(ids[flight.pilot_goal()], wish.goal);
            flight.poses(&mut poses);
            assert_eq!(poses.len(), scene.movable.len());
            let shown = &poses[poses.len() - passing.len()..];
            for (id, pose) in passing.iter().zip(shown) {
                assert_eq!(pose.strength > 0.0, ids.contains(id), "tick {tick}");
            }
            if flight.step(None).ending.is_some() {
                break;
            }
        }
    }
}

#[test]
fn success_is_judged_on_the_goal_at_the_end() {
    let options = FlagOptions { changes_mind: Some([1, 1]), ..FlagOptions::default() };
    let mut flight = level(options, Start::at(10.0, 3.75));
    assert_eq!(flight.pilot_goal(), 1);
    let (reward, ending) = fly(&mut flight, |_| None);
    assert_eq!(ending, Ending::Elsewhere, "it stands where the pilot wanted to be at first");
    assert!((-1.2..-0.5).contains(&reward), "a changed mind is no loss by itself: {reward}");
}
