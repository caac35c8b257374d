//! The lander's plants as a program gets them: by name, with options, behind the trait.

use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Ending, Plant};
use cohelm::random::Draws;
use cohelm::registry::{Plants, Task};
use cohelm::scene::Role;
use cohelm_lander::flags::FLAG_LANDER_VERSION;
use cohelm_lander::gymnasium::{self, GymnasiumLander, GymnasiumOptions};
use cohelm_lander::gymnasium_plant::GYMNASIUM_LANDER_VERSION;

fn make(task: Task) -> Box<dyn Plant> {
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    plants.make(&task).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(task: Task) -> String {
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    plants.make(&task).err().map(|error| error.to_string()).expect("must be refused")
}

fn gymnasium_lander() -> Task {
    Task::new("gymnasium-lander")
}

/// Flies the teacher's way; the return and the ending.
fn taught(plant: &mut dyn Plant) -> (f64, Ending) {
    let mut sum = 0.0;
    loop {
        let action = plant.teacher(plant.pilot_goal());
        let step = plant.step(action);
        sum += step.reward;
        if let Some(ending) = step.ending {
            return (sum, ending);
        }
    }
}

#[test]
fn both_plants_are_made_by_name() {
    assert_eq!(make(Task::new("flag-lander")).view().goals.len(), 3);
    assert_eq!(make(gymnasium_lander()).view().goals.len(), 1);
}

#[test]
fn every_action_set_can_be_asked_for() {
    for (name, commands) in [("switches", 6), ("main-side", 6), ("gymnasium", 4), ("continuous", 0)] {
        let plant = make(Task::new("flag-lander").with("actions", name));
        assert_eq!(plant.space().commands(), commands, "{name}");
        assert_eq!(plant.mirror().map_or(0, |mirror| mirror.commands.len()), commands, "{name}");
    }
}

#[test]
fn wrong_options_are_refused_with_a_reason() {
    let message = refusal(Task::new("flag-lander").with("actions", "joystick"));
    assert!(message.contains("flag-lander") && message.contains("`main-side`"), "{message}");
    let message = refusal(gymnasium_lander().with("gravity", -13.0));
    assert!(message.contains("gravity is -13") && message.contains("between -12 and 0"), "{message}");
    let message = refusal(gymnasium_lander().with("limit", 2000));
    assert!(message.contains("from 1 to 1000") && message.contains("2000"), "{message}");
    let message = refusal(gymnasium_lander().with("wind", true));
    assert!(message.contains("`enable_wind`"), "{message}");
}

#[test]
fn the_plain_task_flies_gymnasiums_flights_bit_for_bit() {
    for continuous in [false, true] {
        for wind in [false, true] {
            let task = gymnasium_lander().with("continuous", continuous).with("enable_wind", wind);
            let options = GymnasiumOptions { enable_wind: wind, ..GymnasiumOptions::default() };
            let mut own = GymnasiumLander::new(options).expect("valid options");
            same_flight(make(task).as_mut(), &mut own, continuous);
        }
    }
}

fn same_flight(plant: &mut dyn Plant, own: &mut GymnasiumLander, continuous: bool) {
    let mut draws = Draws::new(9);
    plant.reset(11);
    assert_eq!(plant.view().state, own.reset(11));
    loop {
        let command = draws.below(4);
        let axes = [draws.uniform(-1.0, 1.0) as f32, draws.uniform(-1.0, 1.0) as f32];
        let (action, same) = if continuous {
            (Action::axes(&axes), gymnasium::Action::Throttles(axes))
        } else {
            (Action::Command(command as u8), gymnasium::Action::DISCRETE[command])
        };
        let (step, outcome) = (plant.step(Some(action)), own.step(same));
        assert_eq!((plant.view().state, step.reward), (&outcome.observation[..], outcome.reward));
        assert_eq!(step.ending.is_some(), outcome.ending.is_some());
        if step.ending.is_some() {
            return;
        }
    }
}

#[test]
fn resting_between_the_flags_is_the_goal_and_beside_them_elsewhere() {
    let mut plant = make(gymnasium_lander());
    let mut endings = Vec::new();
    for seed in 0..200 {
        plant.reset_near_goal(seed, f64::from(u8::from(seed >= 20)) * 0.3);
        let (sum, ending) = taught(plant.as_mut());
        let beside = plant.view().position[0].abs() > 0.2;
        if matches!(ending, Ending::Goal | Ending::Elsewhere) {
            assert_eq!(ending == Ending::Elsewhere, beside, "seed {seed}");
            assert!(sum > 50.0, "both are paid: {sum}");
        }
        endings.push(ending);
    }
    assert!(endings[..20].iter().all(|ending| *ending == Ending::Goal), "difficulty 0: {endings:?}");
    assert!(endings.contains(&Ending::Elsewhere));
}

#[test]
fn the_teacher_solves_gymnasiums_task() {
    let mut plant = make(gymnasium_lander());
    let flights = (0..50).map(|seed| {
        plant.reset(seed);
        taught(plant.as_mut())
    });
    let flights: Vec<(f64, Ending)> = flights.collect();
    let mean = flights.iter().map(|(sum, _)| sum).sum::<f64>() / 50.0;
    let landed = flights.iter().filter(|(_, ending)| *ending == Ending::Goal).count();
    println!("{landed} of 50, mean return {mean}");
    assert!(landed >= 45 && mean > 200.0, "{landed} of 50, mean return {mean}");
}

#[test]
fn a_shorter_limit_cuts_off() {
    let mut plant = make(gymnasium_lander().with("limit", 20));
    plant.reset(1);
    let endings: Vec<Option<Ending>> = (0..20).map(|_| plant.step(None).ending).collect();
    assert!(endings[..19].iter().all(Option::is_none));
    assert_eq!(endings[19], Some(Ending::TimeLimit));
}

#[test]
fn a_snapshot_goes_on_with_the_same_bits() {
    for task in [Task::new("flag-lander"), gymnasium_lander().with("enable_wind", true)] {
        let mut plant = make(task);
        plant.reset(5);
        (0..30).for_each(|_| {
            plant.step(Some(Action::Command(2)));
        });
        let mut copy = plant.snapshot().expect("both can");
        for command in [0, 1, 2, 3, 0, 3].repeat(10) {
            assert_eq!(plant.step(Some(Action::Command(command))), copy.step(Some(Action::Command(command))));
            assert_eq!(plant.view().state, copy.view().state);
        }
    }
}

/// FNV-1a over the bits of all states and rewards of twenty short flights, half of them from near the goal.
fn digest(task: Task) -> u64 {
    let mut plant = make(task);
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut take = |bits: u64| hash = (hash ^ bits).wrapping_mul(0x0100_0000_01b3);
    for seed in 0..20 {
        if seed % 2 == 0 {
            plant.reset(seed)
        } else {
            assert!(plant.reset_near_goal(seed, 0.4))
        }
        let mut draws = Draws::new(seed);
        for _ in 0..60 {
            let command = draws.below(plant.space().commands().max(1)) as u8;
            let axes = [draws.uniform(-1.0, 1.0) as f32, draws.uniform(-1.0, 1.0) as f32];
            let drawn =
                if plant.space().commands() == 0 { Action::axes(&axes) } else { Action::Command(command) };
            let taught = draws.chance(0.5).then(|| plant.teacher(plant.pilot_goal())).flatten();
            let step = plant.step(Some(taught.unwrap_or(drawn)));
            plant.view().state.iter().for_each(|value| take(value.to_bits().into()));
            take(step.reward.to_bits());
        }
    }
    hash
}

// A change here means that records of earlier flights no longer replay: raise the plant's version with it. The digests
// were taken on x86-64; they must be the same everywhere.
#[test]
fn the_bits_of_a_version_stay() {
    let flag = |actions: &str| digest(Task::new("flag-lander").with("actions", actions));
    assert_eq!((FLAG_LANDER_VERSION, GYMNASIUM_LANDER_VERSION), (1, 1));
    assert_eq!(
        [
            flag("switches"),
            flag("main-side"),
            flag("gymnasium"),
            flag("continuous"),
            digest(gymnasium_lander())
        ],
        [
            6145367465407548608,
            4912536522879401432,
            8672300612637085946,
            8474155034330219349,
            1042273986620653037
        ],
    );
}

#[test]
fn the_plain_tasks_scene_has_its_pad_under_its_goal() {
    let plant = make(gymnasium_lander());
    let scene = plant.scene();
    assert_eq!(scene.fixed.iter().filter(|part| part.role == Role::Goal).count(), 1);
    let mut poses = Vec::new();
    plant.poses(&mut poses);
    assert_eq!(poses.len(), scene.movable.len());
    assert_eq!(scene.origin[0], 10.0);
    let is_axes = |space: &ActionSpace| matches!(space, ActionSpace::Axes { .. });
    assert!(is_axes(make(gymnasium_lander().with("continuous", true)).space()) && !is_axes(plant.space()));
}
