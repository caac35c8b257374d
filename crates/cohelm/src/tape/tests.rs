use super::*;
use crate::arbitration::HumanAlone;
use crate::cockpit::{Cockpit, Silence};
use crate::flight::{Flight, replay};
use crate::keys;
use crate::trajectory::{Setup, Trajectory};
use crate::{arbitration::Rule, intent::Inference, point::Point};

/// The point as if it were elsewhere: after each tick it is asked what it is like.
struct Elsewhere {
    point: Point,
    seen: Taped,
}

fn look(point: &Point, step: Step) -> Seen {
    let View { state, position, switches, goals, .. } = point.view();
    let mut poses = Vec::new();
    point.poses(&mut poses);
    let Step { reward, ending } = step;
    Seen { state: state.to_vec(), position, switches, goals: goals.to_vec(), poses, reward, ending }
}

fn about(point: &Point) -> Described {
    Described {
        name: "point".into(),
        ticks_per_second: 50.0,
        space: point.space().clone(),
        scene: point.scene(),
        pilot_goal: point.view().goals[point.pilot_goal()].id,
    }
}

fn first(point: &Point) -> Seen {
    look(point, Step { reward: 0.0, ending: None })
}

impl Elsewhere {
    fn new(seed: u64) -> Self {
        let mut point = Point::new();
        point.reset(seed);
        let seen = Taped::new(Tape::new(about(&point), first(&point)).unwrap());
        Self { point, seen }
    }
}

impl Plant for Elsewhere {
    fn reset(&mut self, _seed: u64) {}

    fn step(&mut self, executed: Option<Action>) -> Step {
        let step = self.point.step(executed);
        self.seen.grow(Ok(look(&self.point, step)))
    }

    fn view(&self) -> View<'_> {
        self.seen.view()
    }

    fn pilot_goal(&self) -> usize {
        self.seen.pilot_goal()
    }

    fn space(&self) -> &ActionSpace {
        self.seen.space()
    }

    fn scene(&self) -> Scene {
        self.seen.scene()
    }

    fn poses(&self, poses: &mut Vec<Pose>) {
        self.seen.poses(poses);
    }

    fn tape(&self) -> Option<&Tape> {
        Some(self.seen.tape())
    }
}

fn alone(plant: &dyn Plant) -> Cockpit {
    Cockpit::unassisted(plant, Box::new(HumanAlone)).with_silence(Silence::Nothing)
}

fn flown() -> Trajectory {
    let setup = Setup {
        task: task("point"),
        plant_version: VERSION,
        seed: 5,
        rule: Rule::Hic,
        inference: Inference::Nearest,
        silence: Silence::Nothing,
        time_scale: 1.0,
        values: None,
        intent: None,
        pilot: "person".into(),
    };
    let plant = Box::new(Elsewhere::new(5));
    let cockpit = alone(plant.as_ref());
    let mut flight = Flight::new(setup, plant, cockpit);
    for tick in 0..40 {
        if tick == 7 {
            flight.change(keys::Change::Down(3), 140.0);
        }
        flight.tick();
    }
    flight.finish()
}

#[test]
fn a_record_with_a_tape_survives_its_bytes_and_its_decisions_are_checked_from_it() {
    let record = flown();
    assert_eq!(record.tape.as_ref().unwrap().seen().len(), 41);
    let bytes = record.to_bytes();
    assert_eq!((bytes[4], Trajectory::from_bytes(&bytes).as_ref()), (2, Ok(&record)));
    let (mut plant, _) = record.plant(&Plants::default()).unwrap();
    let mut cockpit = alone(plant.as_ref());
    let seen = replay(&record, plant.as_mut(), Some(&mut cockpit));
    assert!(seen.identical() && seen.decisions_identical == Some(true), "{seen:?}");
}

#[test]
fn a_tape_that_was_changed_or_cut_off_is_told() {
    let mut bytes = flown().to_bytes();
    assert!(Trajectory::from_bytes(&bytes[..bytes.len() - 1]).is_err());
    let last_state = bytes.len() - 100;
    bytes[last_state] ^= 1;
    if let Ok(record) = Trajectory::from_bytes(&bytes) {
        let (mut plant, _) = record.plant(&Plants::default()).unwrap();
        assert!(!replay(&record, plant.as_mut(), None).plant_identical);
    }
}

#[test]
fn a_lost_plant_stays_where_it_was_seen_last_and_ends_the_episode() {
    let mut plant = Elsewhere::new(1);
    plant.step(None);
    let before = plant.seen.tape().last().clone();
    let step = plant.seen.grow(Err("nothing was heard for 200 ms".into()));
    assert_eq!(step.ending, Some(Ending::Abandoned));
    assert_eq!(plant.view().state, before.state);
    assert_eq!(plant.seen.tape().lost(), Some("nothing was heard for 200 ms"));
    let mut again = Taped::new(plant.seen.tape().clone());
    assert_eq!([again.step(None).ending, again.step(None).ending], [None, Some(Ending::Abandoned)]);
}

#[test]
fn a_tape_tells_how_many_ticks_it_still_holds() {
    let mut plant = Elsewhere::new(1);
    let room = plant.seen.tape().room();
    plant.step(None);
    assert_eq!(plant.seen.tape().room(), room - 1);
    let bytes = bytes::size_of(plant.seen.tape().last());
    assert!((MAX_TAPE - bytes * (room + 1)) < bytes, "{room} ticks of {bytes} bytes fill it");
}

type Change<'a> = &'a dyn Fn(&mut Described, &mut Seen);

#[test]
fn what_cannot_be_flown_is_refused_at_the_door() {
    let point = Point::new();
    let refused = |change: Change<'_>| {
        let (mut about, mut seen) = (about(&point), first(&point));
        change(&mut about, &mut seen);
        Tape::new(about, seen).unwrap_err().to_string()
    };
    let axes =
        |low: f32, high: f32| ActionSpace::Axes { names: vec!["x".into()], low: vec![low], high: vec![high] };
    let cases: [(&str, Change<'_>); 11] = [
        ("a number of the state must be a finite number of at most 1000", &|_, seen| {
            seen.state[1] = f32::NAN
        }),
        ("the position must be a finite", &|_, seen| seen.position[0] = 1e9),
        ("the state must be 1 to 64 numbers, got 65", &|_, seen| seen.state = vec![0.0; 65]),
        ("goals must be 1 to 8 goals, got 0", &|_, seen| seen.goals.clear()),
        ("the ids of goals must be different", &|_, seen| seen.goals[1].id = seen.goals[0].id),
        ("poses must be 1 poses, one a movable part, got 0", &|_, seen| seen.poses.clear()),
        ("switches must be 0 bits, got 3", &|_, seen| seen.switches = 3),
        ("the reward must be", &|_, seen| seen.reward = f64::INFINITY),
        ("pilot_goal must be the id of a goal, one of [0, 1], got 9", &|about, _| about.pilot_goal = 9),
        ("ticks_per_second must be 1 to 200, got 0", &|about, _| about.ticks_per_second = 0.0),
        ("an axis must be from at most 0 to at least 0, got 1 to 2", &|about, _| {
            about.space = axes(1.0, 2.0)
        }),
    ];
    for (expected, change) in cases {
        let said = refused(change);
        assert!(said.starts_with(expected), "{said:?} does not begin with {expected:?}");
    }
}
