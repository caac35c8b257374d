//! The arm's specification.

use super::*;
use cohelm::human::{Person, Population, participant};
use cohelm::laws::check;
use cohelm::pilot::Pilot;
use cohelm::random::mix_seed;
use proptest::prelude::*;

const BOTH: [Steering; 2] = [Steering::Levers, Steering::Continuous];
const STILL: Option<Action> = None;

fn arm(actions: Steering) -> Arm {
    Arm::new(ArmOptions { actions, ..ArmOptions::default() }).expect("possible options")
}

/// The table of seed 0 with the hand at a place.
fn with_hand_at(hand: [f64; 2]) -> Arm {
    let mut arm = arm(Steering::Levers);
    arm.joints = Joints::reaching(hand);
    arm
}

/// How an episode ends in which the teacher reaches for the pilot's goal.
fn taught(arm: &mut Arm) -> Ending {
    loop {
        let action = arm.teacher(arm.wanted);
        if let Some(ending) = arm.step(action).ending {
            return ending;
        }
    }
}

#[test]
fn the_laws_of_plants_hold() {
    for actions in BOTH {
        check(&mut arm(actions), 0..10).unwrap();
    }
}

proptest! {
    #[test]
    fn reaching_is_the_inverse_of_where_the_hand_is(far in 0.1..0.99_f64, angle in 0.0..3.1_f64) {
        let place = [far * libm::cos(angle), far * libm::sin(angle)];
        prop_assert!(distance(Joints::reaching(place).hand_at(), place) < 1e-9);
    }

    /// The Jacobian against differences of where the hand is.
    #[test]
    fn the_hand_moves_as_the_joints_turn(shoulder in -0.9..3.0_f64, elbow in 0.15..2.8_f64) {
        let joints = Joints { shoulder, elbow, turning: [0.0; 2] };
        let turned = [Joints { shoulder: shoulder + 1e-6, ..joints }, Joints { elbow: elbow + 1e-6, ..joints }];
        for (column, turned) in turned.into_iter().enumerate() {
            for row in 0..2 {
                let difference = (turned.hand_at()[row] - joints.hand_at()[row]) / 1e-6;
                prop_assert!((joints.jacobian()[row][column] - difference).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn the_hand_goes_where_it_is_asked_to(command in 0_u8..9) {
        let mut arm = with_hand_at([0.0, 0.45]);
        let [x, y] = direction(Some(Action::Command(command)));
        (0..25).for_each(|_| { arm.step(Some(Action::Command(command))); });
        let moved = [arm.joints.hand_at()[0], arm.joints.hand_at()[1] - 0.45];
        let along = moved[0] * x + moved[1] * y;
        let across = moved[0] * y - moved[1] * x;
        let asked = f64::from(u8::from(command != 4));
        prop_assert!(along >= 0.08 * asked && across.abs() <= 0.02, "{} along, {} across", along, across);
    }

    #[test]
    fn what_is_seen_stays_within_its_units(seed in 0_u64..1000, command in 0_u8..9) {
        let mut arm = arm(Steering::Levers);
        arm.reset(seed);
        while arm.step(Some(Action::Command(command))).ending.is_none() {
            prop_assert!(arm.shown.iter().all(|value| value.abs() <= 2.5), "{:?}", arm.shown);
        }
    }

    #[test]
    fn cups_stand_apart_within_reach_and_away_from_the_start(seed in 0_u64..2000) {
        let mut arm = arm(Steering::Levers);
        arm.reset(seed);
        for (index, &cup) in arm.cups.iter().enumerate() {
            let far = distance(cup, [0.0; 2]);
            prop_assert!((CUPS_AT_M[0] - 1e-9..=CUPS_AT_M[1]).contains(&far));
            prop_assert!(arm.cups[..index].iter().all(|&other| distance(cup, other) >= CUPS_APART_M));
            prop_assert!(distance(cup, arm.joints.hand_at()) > 2.0 * TOUCH_M);
        }
    }
}

#[test]
fn a_slanting_direction_is_no_faster_than_a_straight_one() {
    for command in 0..9 {
        let [x, y] = direction(Some(Action::Command(command)));
        let length = libm::sqrt(x * x + y * y);
        assert!((length - f64::from(u8::from(command != 4))).abs() < 1e-12, "command {command}: {length}");
    }
    assert_eq!(direction(Some(Action::axes(&[0.3, -0.4]))), [f64::from(0.3_f32), f64::from(-0.4_f32)]);
}

#[test]
fn full_levers_and_full_axes_are_the_same() {
    let (mut levers, mut axes) = (arm(Steering::Levers), arm(Steering::Continuous));
    for tick in 0..60_u8 {
        let (away, aside) = (tick % 3, tick / 7 % 3);
        let full = [f32::from(aside) - 1.0, f32::from(away) - 1.0];
        let step = levers.step(Some(Action::Command(3 * away + aside)));
        assert_eq!(step, axes.step(Some(Action::axes(&full))));
        assert_eq!(levers.joints, axes.joints);
    }
}

#[test]
fn resting_at_a_cup_takes_it() {
    for (cup, expected) in [(2, Ending::Goal), (1, Ending::Elsewhere)] {
        let mut arm = arm(Steering::Levers);
        arm.wanted = 2;
        let [x, y] = arm.cups[cup];
        let near = 1.0 - 0.08 / distance([x, y], [0.0; 2]);
        arm.joints = Joints::reaching([near * x, near * y]);
        let endings: Vec<_> = (0..REST_TICKS).map(|_| arm.step(STILL).ending).collect();
        let (last, before) = endings.split_last().expect("some ticks");
        assert!(before.iter().all(Option::is_none), "{endings:?}");
        assert_eq!(*last, Some(expected));
    }
}

#[test]
fn running_into_a_cup_knocks_it_over() {
    let mut arm = arm(Steering::Levers);
    let cup = arm.cups[1];
    let far = distance(cup, [0.0; 2]);
    let (x, y) = (cup[0] / far, cup[1] / far);
    arm.joints = Joints::reaching([cup[0] - 0.25 * x, cup[1] - 0.25 * y]);
    arm.space = Steering::Continuous.space(["away", "aside"], ["still", "still"]);
    let towards = Action::axes(&[x as f32, y as f32]);
    let ending = (0..100).find_map(|_| arm.step(Some(towards)).ending);
    assert_eq!(ending, Some(Ending::Crash));
}

/// A hand so far before cup 2, which is the pilot's, on the way to it with this speed, m/s.
fn coming(far_m: f64, speed_mps: f64) -> Arm {
    let mut arm = arm(Steering::Levers);
    arm.wanted = 2;
    let cup = arm.cups[2];
    let away = distance(cup, [0.0; 2]);
    let along = [cup[0] / away, cup[1] / away];
    arm.joints = Joints::reaching([0, 1].map(|i| cup[i] - far_m * along[i]));
    arm.joints.turning = arm.joints.turns_for(along);
    let share = speed_mps / arm.speed();
    arm.joints.turning = arm.joints.turning.map(|turning| share * turning);
    arm
}

/// How many ticks it counts as resting after one at whose end it has this speed.
fn rested_at(speed_mps: f64) -> u32 {
    let mut before_mps = speed_mps;
    for _ in 0..20 {
        let mut arm = coming(0.08, before_mps);
        arm.advance();
        before_mps *= speed_mps / arm.speed();
    }
    let mut arm = coming(0.08, before_mps);
    arm.advance();
    assert!((arm.speed() / speed_mps - 1.0).abs() < 1e-9);
    arm.rested
}

/// Two hundredths on either side of each limit.
#[test]
fn a_cup_is_knocked_over_touched_and_taken_at_each_limit() {
    for (share, beyond) in [(0.98, false), (1.02, true)] {
        let ending = |far_m, speed_mps| coming(far_m, speed_mps).ending();
        let crash_if = |crashes: bool| crashes.then_some(Ending::Crash);
        assert_eq!(ending(0.9 * PALM_M, share * KNOCKS_MPS), crash_if(beyond), "speed {share}");
        assert_eq!(ending(share * PALM_M, 1.05 * KNOCKS_MPS), crash_if(!beyond), "palm {share}");
        assert_eq!(rested_at(share * RESTS_MPS), u32::from(!beyond), "resting {share}");
        let mut still = coming(share * TOUCH_M, 0.0);
        let taken = (0..2 * REST_TICKS).find_map(|_| still.step(STILL).ending);
        assert_eq!(taken, (!beyond).then_some(Ending::Goal), "touch {share}");
    }
}

#[test]
fn each_joint_has_its_stop_where_it_says() {
    let middle = Joints { shoulder: 1.0, elbow: 1.5, turning: [0.0; 2] };
    for (limits, joint) in [(ELBOW_RAD, 1), (SHOULDER_RAD, 0)] {
        for (limit, outwards) in [(limits[0], -1.0), (limits[1], 1.0)] {
            for (side, expected) in [(-1.0, None), (1.0, Some(Ending::OutOfBounds))] {
                let angle = limit + side * outwards * 0.02 * limit.abs();
                let mut arm = arm(Steering::Levers);
                arm.joints = match joint {
                    0 => Joints { shoulder: angle, ..middle },
                    _ => Joints { elbow: angle, ..middle },
                };
                assert_eq!(arm.ending(), expected, "joint {joint} at {angle}");
            }
        }
    }
}

#[test]
fn a_joint_at_its_stop_and_the_time_end_it() {
    let mut arm = with_hand_at([0.0, 0.45]);
    let down = Some(Action::Command(1));
    let ending = (0..300).find_map(|_| arm.step(down).ending);
    assert_eq!(ending, Some(Ending::OutOfBounds), "folded");
    let mut arm = Arm::new(ArmOptions { limit: 3, ..ArmOptions::default() }).expect("possible options");
    let endings: Vec<_> = (0..3).map(|_| arm.step(STILL).ending).collect();
    assert_eq!(endings, [None, None, Some(Ending::TimeLimit)]);
}

/// `docs/plants.md` names these numbers.
#[test]
fn the_teacher_takes_the_cup_wherever_it_starts() {
    for actions in BOTH {
        let mut arm = arm(actions);
        let taken = (0..300).filter(|&seed| {
            arm.reset(seed);
            taught(&mut arm) == Ending::Goal
        });
        let taken = taken.count();
        println!("{actions:?}: {taken} of 300");
        assert!(taken >= 291, "{actions:?}: {taken} of 300");
    }
}

#[test]
fn near_goal_starts_are_easy_at_first_and_wide_at_last() {
    let mut arm = arm(Steering::Levers);
    for difficulty in [0.0, 0.2, 1.0] {
        let taken = (0..50).filter(|&seed| {
            assert!(arm.reset_near_goal(seed, difficulty));
            taught(&mut arm) == Ending::Goal
        });
        let taken = taken.count();
        assert!(taken >= 47, "difficulty {difficulty}: {taken}");
    }
    assert!(!arm.reset_near_goal(0, f64::NAN));
}

#[test]
fn wrong_options_are_refused_with_a_reason() {
    let refusal = |options: &str| {
        let options = serde_json::from_str(options).expect("JSON");
        (entry().make)(&options).map(|_| ()).unwrap_err()
    };
    let message = refusal(r#"{"limit": 0}"#);
    assert!(message.contains("\"limit\" from 1 to 100000, got 0"), "{message}");
    assert!(refusal(r#"{"actions": "joystick"}"#).contains("`levers`"));
    assert!(refusal(r#"{"cups": 5}"#).contains("expected an object with some of actions"));
}

#[test]
fn every_set_that_is_offered_can_be_steered() {
    for set in entry().actions {
        let mut plant = (entry().make)(&set.options()).unwrap_or_else(|error| panic!("{error}"));
        let action = plant.teacher(0).expect("it has a teacher");
        assert!(plant.space().contains(action), "{}", set.label);
    }
}

/// Alone, an ordinary person takes the cup in 40 % of reaches: hard, and not hopeless.
#[test]
fn simulated_people_alone_take_some_cups() {
    let mut arm = arm(Steering::Levers);
    let mut taken = 0;
    for index in 0..10 {
        let person = Person { population: Population::Ordinary, seed: 2024, index };
        let mut pilot = participant(pilots::skill, arm.space(), person).expect("a participant");
        for episode in 0..10 {
            let seed = mix_seed(index, episode);
            arm.reset(seed);
            pilot.begin(seed);
            let ending = loop {
                let asked = pilot.ask(&arm.view(), arm.wanted);
                assert!(asked.is_none_or(|action| arm.space.contains(action)));
                if let Some(ending) = arm.step(asked).ending {
                    break ending;
                }
            };
            taken += u32::from(ending == Ending::Goal);
        }
    }
    assert!((20..=65).contains(&taken), "{taken} of 100");
}

/// Version 1 is these bits. They change only together with [`ARM_VERSION`], since records and models name it.
#[test]
fn the_bits_of_this_version() {
    let mut digest = 0_u64;
    for actions in BOTH {
        let mut arm = arm(actions);
        for seed in 0..5 {
            arm.reset(seed);
            while {
                let action = arm.teacher(arm.wanted);
                let step = arm.step(action);
                let bits = arm.shown.iter().map(|value| u64::from(value.to_bits()));
                digest = bits.chain([step.reward.to_bits()]).fold(digest, mix_seed);
                step.ending.is_none()
            } {}
        }
    }
    assert_eq!((ARM_VERSION, digest), (1, 10_059_235_475_807_180_967));
}
