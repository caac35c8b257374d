//! The drone's specification.

use super::*;
use cohelm::human::{Person, Population, participant};
use cohelm::laws::check;
use cohelm::pilot::Pilot;
use cohelm::random::mix_seed;
use proptest::prelude::*;

const BOTH: [Steering; 2] = [Steering::Levers, Steering::Continuous];
const HOVER: Option<Action> = None;

fn drone(actions: Steering) -> Drone {
    Drone::new(DroneOptions { actions, ..DroneOptions::default() }).expect("possible options")
}

/// In still air, at rest in the middle of the air over the pads of seed 0.
fn calm() -> Drone {
    let mut drone =
        Drone::new(DroneOptions { wind: 0.0, ..DroneOptions::default() }).expect("possible options");
    drone.motion = Motion { x: WIDTH_M / 2.0, y: 8.0, ..Motion::default() };
    drone
}

fn command(lift: u8, roll: u8) -> Option<Action> {
    Some(Action::Command(3 * lift + roll))
}

/// How an episode ends that the teacher flies to the pilot's goal.
fn taught(drone: &mut Drone) -> Ending {
    loop {
        let action = drone.teacher(drone.wanted);
        if let Some(ending) = drone.step(action).ending {
            return ending;
        }
    }
}

#[test]
fn the_laws_of_plants_hold() {
    for actions in BOTH {
        check(&mut drone(actions), 0..10).unwrap();
    }
}

#[test]
fn it_hovers_when_nothing_is_asked_and_the_air_is_still() {
    let mut drone = calm();
    let before = drone.motion;
    (0..200).for_each(|_| {
        drone.step(HOVER);
    });
    assert_eq!(drone.motion, before);
}

#[test]
fn full_lift_climbs_with_half_the_weight_and_none_falls_so() {
    for (lift, expected) in [(2, LIFT_SHARE * GRAVITY), (0, -LIFT_SHARE * GRAVITY)] {
        let mut drone = calm();
        drone.step(command(lift, 1));
        assert!((drone.motion.vy / TICK_S - expected).abs() < 1e-9, "{}", drone.motion.vy / TICK_S);
    }
}

#[test]
fn roll_to_the_right_tilts_clockwise_and_then_goes_right() {
    let mut drone = calm();
    (0..20).for_each(|_| {
        drone.step(command(1, 2));
    });
    assert!(drone.motion.tilt < 0.0 && drone.motion.vx > 0.0, "{:?}", drone.motion);
}

#[test]
fn full_levers_and_full_axes_are_the_same() {
    let (mut levers, mut axes) = (drone(Steering::Levers), drone(Steering::Continuous));
    for tick in 0..60_u8 {
        let (lift, roll) = (tick % 3, tick / 7 % 3);
        let full = [f32::from(roll) - 1.0, f32::from(lift) - 1.0];
        assert_eq!(levers.step(command(lift, roll)), axes.step(Some(Action::axes(&full))));
        assert_eq!(levers.motion, axes.motion);
    }
}

#[test]
fn gusts_have_the_strength_and_the_memory_that_they_should() {
    let (mut of, mut sum, mut squares, mut products) = (0.0, 0.0, 0.0, 0.0);
    let mut drone = drone(Steering::Levers);
    for seed in 0..40 {
        drone.reset(seed);
        (0..75).for_each(|_| drone.advance());
        for _ in 0..500 {
            let before = drone.gust_mps2;
            drone.advance();
            of += 1.0;
            sum += drone.gust_mps2;
            squares += drone.gust_mps2 * drone.gust_mps2;
            products += drone.gust_mps2 * before;
        }
    }
    let (mean, deviation, memory): (f64, f64, f64) = (sum / of, f64::sqrt(squares / of), products / squares);
    assert!(mean.abs() < 0.08, "mean {mean}");
    assert!((deviation / GUST_MPS2 - 1.0).abs() < 0.1, "standard deviation {deviation}");
    assert!((memory - (1.0 - TICK_S / GUST_S)).abs() < 0.005, "from tick to tick {memory}");
}

/// The first touch of a drone that moves so, its feet a hair over the pad of that index.
fn touch(pad: usize, aside_m: f64, motion: Motion) -> Option<Ending> {
    let mut drone = calm();
    drone.wanted = 1;
    let [x, y] = drone.pads[pad];
    drone.motion = Motion { x: x + aside_m, y: y - FEET_M[0][1] + 0.001, ..motion };
    (0..20).find_map(|_| drone.step(HOVER).ending)
}

#[test]
fn landing_is_gentle_straight_upright_and_on_the_pilots_pad() {
    let gently = Motion { vy: -0.8, ..Motion::default() };
    for (pad, aside_m, motion, expected) in [
        (1, 0.0, gently, Ending::Goal),
        (1, 0.6, gently, Ending::Goal),
        (0, 0.0, gently, Ending::Elsewhere),
        (2, -0.6, gently, Ending::Elsewhere),
        (1, 0.0, Motion { vy: -1.6, ..gently }, Ending::Crash),
        (1, 0.0, Motion { vx: 1.2, ..gently }, Ending::Crash),
        (1, 0.0, Motion { tilt: 0.35, ..gently }, Ending::Crash),
        (1, 0.8, gently, Ending::Crash),
    ] {
        assert_eq!(touch(pad, aside_m, motion), Some(expected), "pad {pad}, {aside_m} m aside, {motion:?}");
    }
}

/// Two hundredths on either side of each limit.
#[test]
fn a_landing_turns_into_a_crash_at_each_limit() {
    let gently = Motion { vy: -0.8, ..Motion::default() };
    for (share, expected) in [(0.98, Ending::Goal), (1.02, Ending::Crash)] {
        // A tick of drag lies between what is set here and the touch.
        let (vy, vx) = (share * GENTLE_MPS / (1.0 - TICK_S * DRAG_PER_S), share * STRAIGHT_MPS);
        let mut ways = vec![(0.0, Motion { vy: -vy, ..gently })];
        for side in [-1.0, 1.0] {
            ways.push((0.0, Motion { vx: side * vx / (1.0 - TICK_S * DRAG_PER_S), ..gently }));
            ways.push((0.0, Motion { tilt: side * share * UPRIGHT_RAD, ..gently }));
            ways.push((side * share * (PAD_HALF_WIDTH_M - FEET_M[1][0]), gently));
        }
        for (aside_m, motion) in ways {
            assert_eq!(touch(1, aside_m, motion), Some(expected), "{aside_m} m aside, {motion:?}");
        }
    }
}

#[test]
fn the_ground_and_the_edges_end_it_where_they_are() {
    let margin = 0.02;
    let (low, high, left, right) = (-FEET_M[0][1], HEIGHT_M, 0.0, WIDTH_M);
    for (x, y, inwards, ending) in [
        (2.0, low, [0.0, margin], Ending::Crash),
        (2.0, high, [0.0, -margin], Ending::OutOfBounds),
        (left, 8.0, [margin, 0.0], Ending::OutOfBounds),
        (right, 8.0, [-margin, 0.0], Ending::OutOfBounds),
    ] {
        for (side, expected) in [(1.0, None), (-1.0, Some(ending))] {
            let mut drone = calm();
            drone.pads = [[6.0, 3.0], [9.0, 3.0], [12.0, 3.0]];
            drone.motion = Motion { x: x + side * inwards[0], y: y + side * inwards[1], ..Motion::default() };
            assert_eq!(drone.step(HOVER).ending, expected, "{:?}", drone.motion);
        }
    }
}

/// A foot that much below a pad's surface came from the side.
#[test]
fn a_foot_deep_below_the_surface_hit_the_pillar() {
    for (share, expected) in [(0.98, Ending::Goal), (1.02, Ending::Crash)] {
        let mut drone = calm();
        drone.wanted = 1;
        let [x, y] = drone.pads[1];
        drone.motion = Motion { x, y: y - FEET_M[0][1] - share * FROM_ABOVE_M, ..Motion::default() };
        assert_eq!(drone.step(HOVER).ending, Some(expected), "{share} of the depth");
    }
}

#[test]
fn ground_pillars_and_the_edges_of_the_world_end_it() {
    let at = |x: f64, y: f64, vx: f64, vy: f64| {
        let mut drone = calm();
        drone.pads = [[4.0, 3.0], [8.0, 3.0], [12.0, 3.0]];
        drone.motion = Motion { x, y, vx, vy, ..Motion::default() };
        (0..100).find_map(|_| drone.step(HOVER).ending)
    };
    assert_eq!(at(6.0, 0.4, 0.0, -0.5), Some(Ending::Crash), "the ground is no pad");
    assert_eq!(at(6.0, 1.5, 1.5, 0.0), Some(Ending::Crash), "the side of a pillar");
    assert_eq!(at(0.5, 8.0, -2.0, 0.0), Some(Ending::OutOfBounds));
    assert_eq!(at(8.0, 11.5, 0.0, 2.0), Some(Ending::OutOfBounds));
    let short = DroneOptions { limit: 3, ..DroneOptions::default() };
    let mut drone = Drone::new(short).expect("possible options");
    let endings: Vec<_> = (0..3).map(|_| drone.step(HOVER).ending).collect();
    assert_eq!(endings, [None, None, Some(Ending::TimeLimit)]);
}

/// `docs/plants.md` names these numbers.
#[test]
fn the_teacher_lands_wherever_it_starts() {
    for actions in BOTH {
        let mut drone = drone(actions);
        let landed = (0..300).filter(|&seed| {
            drone.reset(seed);
            taught(&mut drone) == Ending::Goal
        });
        let landed = landed.count();
        println!("{actions:?}: {landed} of 300");
        assert!(landed >= 291, "{actions:?}: {landed} of 300");
    }
}

#[test]
fn near_goal_starts_are_easy_at_first_and_wide_at_last() {
    let mut drone = drone(Steering::Levers);
    for difficulty in [0.0, 0.2, 1.0] {
        let landed = (0..50).filter(|&seed| {
            assert!(drone.reset_near_goal(seed, difficulty));
            taught(&mut drone) == Ending::Goal
        });
        assert!(landed.count() >= 48, "difficulty {difficulty}");
    }
    assert!(!drone.reset_near_goal(0, f64::NAN));
}

/// The twin of a drone in still air, mirrored left to right.
fn mirrored(drone: &Drone) -> Drone {
    let mut twin = drone.clone();
    let Motion { x, vx, tilt, spin, .. } = drone.motion;
    twin.motion = Motion { x: WIDTH_M - x, vx: -vx, tilt: -tilt, spin: -spin, ..drone.motion };
    twin.pads = drone.pads.map(|[x, y]| [WIDTH_M - x, y]);
    twin.thrust = [-drone.thrust[0], drone.thrust[1]];
    for (goal, pad) in twin.goals.iter_mut().zip(twin.pads) {
        goal.position = position([pad[0], pad[1] - FEET_M[0][1]]);
    }
    twin.observe();
    twin
}

proptest! {
    #[test]
    fn the_mirror_turns_a_flight_into_another_as_true(seed in 0_u64..1000, steps in prop::collection::vec(0_u8..9, 1..80)) {
        let mut drone = Drone::new(DroneOptions { wind: 0.0, ..DroneOptions::default() }).expect("possible options");
        drone.reset(seed);
        let mirror = drone.mirror().expect("it has one");
        let mut twin = mirrored(&drone);
        for command in steps {
            let step = drone.step(Some(Action::Command(command)));
            let other = twin.step(Some(Action::Command(mirror.commands[usize::from(command)])));
            prop_assert_eq!(step.ending, other.ending);
            prop_assert!((step.reward - other.reward).abs() < 1e-5);
            for (place, &(from, sign)) in mirror.state.iter().enumerate() {
                let (found, expected) = (twin.shown[place], sign * drone.shown[from]);
                prop_assert!((found - expected).abs() < 1e-4, "component {}: {} and {}", place, found, expected);
            }
            if step.ending.is_some() {
                break;
            }
        }
    }

    #[test]
    fn what_is_seen_stays_within_its_units_even_when_it_tumbles(seed in 0_u64..1000, lift in 0_u8..3) {
        let mut drone = drone(Steering::Levers);
        drone.reset(seed);
        while drone.step(command(lift, (seed % 3) as u8)).ending.is_none() {
            prop_assert!(drone.shown.iter().all(|value| value.abs() <= 8.0), "{:?}", drone.shown);
        }
    }
}

#[test]
fn axes_are_mirrored_as_the_levers_are() {
    let mirror = drone(Steering::Continuous).mirror().expect("it has one");
    assert_eq!((mirror.axes, mirror.commands), (vec![(0, -1.0), (1, 1.0)], vec![]));
    let mirror = drone(Steering::Levers).mirror().expect("it has one");
    assert_eq!(mirror.commands, [2, 1, 0, 5, 4, 3, 8, 7, 6]);
}

#[test]
fn wrong_options_are_refused_with_a_reason() {
    let refusal = |options: &str| {
        let options = serde_json::from_str(options).expect("JSON");
        (entry().make)(&options).map(|_| ()).unwrap_err()
    };
    let message = refusal(r#"{"wind": 9}"#);
    assert!(message.contains("\"wind\" from 0 to 5, got 9"), "{message}");
    assert!(refusal(r#"{"limit": 0}"#).contains("\"limit\" from 1 to 100000, got 0"));
    assert!(refusal(r#"{"actions": "joystick"}"#).contains("`levers`"));
    assert!(refusal(r#"{"gusts": 1}"#).contains("expected an object with some of actions"));
}

#[test]
fn every_set_that_is_offered_can_be_flown() {
    for set in entry().actions {
        let mut plant = (entry().make)(&set.options()).unwrap_or_else(|error| panic!("{error}"));
        let action = plant.teacher(0).expect("it has a teacher");
        assert!(plant.space().contains(action), "{}", set.label);
    }
}

/// Alone, an ordinary person lands 2 % of flights: about as hopeless as the paper's lander, and what help is for.
#[test]
fn simulated_people_alone_seldom_land() {
    let mut drone = drone(Steering::Levers);
    let (mut landed, mut lost) = (0, 0);
    for index in 0..10 {
        let person = Person { population: Population::Ordinary, seed: 2024, index };
        let mut pilot = participant(pilots::skill, drone.space(), person).expect("a participant");
        for episode in 0..10 {
            let seed = mix_seed(index, episode);
            drone.reset(seed);
            pilot.begin(seed);
            let ending = loop {
                let asked = pilot.ask(&drone.view(), drone.wanted);
                assert!(asked.is_none_or(|action| drone.space.contains(action)));
                if let Some(ending) = drone.step(asked).ending {
                    break ending;
                }
            };
            landed += u32::from(ending == Ending::Goal);
            lost += u32::from(matches!(ending, Ending::Crash | Ending::OutOfBounds));
        }
    }
    assert!(landed <= 15 && lost >= 80, "landed {landed}, lost {lost} of 100");
}

/// Version 1 is these bits. They change only together with [`DRONE_VERSION`], since records and models name it.
#[test]
fn the_bits_of_this_version() {
    let mut digest = 0_u64;
    for actions in BOTH {
        let mut drone = drone(actions);
        for seed in 0..5 {
            drone.reset(seed);
            while {
                let action = drone.teacher(drone.wanted);
                let step = drone.step(action);
                let bits = drone.shown.iter().map(|value| u64::from(value.to_bits()));
                digest = bits.chain([step.reward.to_bits()]).fold(digest, mix_seed);
                step.ending.is_none()
            } {}
        }
    }
    assert_eq!((DRONE_VERSION, digest), (1, 4_345_334_164_130_077_585));
}
