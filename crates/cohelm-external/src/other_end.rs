//! The other end of the socket, for a plant that is a [`Plant`]: a simulator in Rust, in a process of its own.
//!
//! ```no_run
//! use cohelm::point::Point;
//! let listener = std::net::TcpListener::bind("127.0.0.1:5005")?;
//! for stream in listener.incoming() {
//!     let ending = cohelm_external::other_end::answer(&mut Point::new(), "point", stream?)?;
//!     println!("episode: {ending:?}");
//! }
//! # Ok::<(), std::io::Error>(())
//! ```

use crate::words::{Begin, Hello, Moved, PROTOCOL, Ready};
use cohelm::action::{Action, ActionSpace};
use cohelm::plant::{Ending, Plant, Step, View};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::io::{self, BufRead, BufReader, Write};
use std::net::TcpStream;
use std::time::Duration;

/// What cohelm says.
#[derive(Deserialize)]
#[serde(untagged)]
enum Heard {
    Begin { begin: Begin },
    Tick { tick: u32, action: Option<Value> },
    End { end: Ending },
}

/// Flies one episode as it is told over a connection; gives how it ended, or `None` if the other side went away before
/// it began. If nothing is heard for the time-out that was agreed on, that is an error: nobody steers any more.
pub fn answer(plant: &mut dyn Plant, name: &str, stream: TcpStream) -> io::Result<Option<Ending>> {
    stream.set_nodelay(true)?;
    let mut out = stream.try_clone()?;
    let mut lines = BufReader::new(stream).lines();
    let (ticks_per_second, space) = (plant.ticks_per_second(), plant.space().clone());
    say(&mut out, &Hello { cohelm: PROTOCOL, name: name.into(), ticks_per_second, space })?;
    let Some(Heard::Begin { begin }) = hear(lines.next())? else { return Ok(None) };
    plant.reset(begin.seed);
    say(&mut out, &ready(plant))?;
    while let Some(heard) = hear(lines.next())? {
        let (tick, action) = match heard {
            Heard::End { end } => return Ok(Some(end)),
            Heard::Tick { tick, action } => (tick, action),
            Heard::Begin { .. } => return Err(wrong("a second beginning")),
        };
        out.set_read_timeout(Some(Duration::from_millis(begin.time_out_ms.max(1))))?;
        let step = plant.step(action.map(|action| action_of(plant.space(), &action)).transpose()?);
        say(&mut out, &moved(plant, tick, step))?;
        if step.ending.is_some() {
            return Ok(step.ending);
        }
    }
    Ok(Some(Ending::Abandoned))
}

fn say(out: &mut TcpStream, words: &impl Serialize) -> io::Result<()> {
    let line = serde_json::to_string(words).map_err(|error| wrong(&error.to_string()))?;
    out.write_all(format!("{line}\n").as_bytes())
}

fn hear(line: Option<io::Result<String>>) -> io::Result<Option<Heard>> {
    let Some(line) = line.transpose()? else { return Ok(None) };
    serde_json::from_str(&line).map(Some).map_err(|error| wrong(&error.to_string()))
}

fn wrong(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("cohelm does not keep to the protocol: {what}"))
}

/// An action is checked here, too: this end may be steered by another program.
fn action_of(space: &ActionSpace, said: &Value) -> io::Result<Action> {
    let command = || said.as_u64().and_then(|command| u8::try_from(command).ok()).map(Action::Command);
    let axes = |count: usize| {
        let values: Option<Vec<f32>> =
            said.as_array()?.iter().map(|value| value.as_f64().map(|x| x as f32)).collect();
        values.filter(|values| values.len() == count).map(|values| Action::axes(&values))
    };
    let action = match space {
        ActionSpace::Axes { names, .. } => axes(names.len()),
        _ => command(),
    };
    action
        .filter(|action| space.contains(*action))
        .ok_or_else(|| wrong(&format!("the plant has no action {said}")))
}

fn ready(plant: &dyn Plant) -> Ready {
    let View { state, position, switches, goals, .. } = plant.view();
    Ready {
        scene: plant.scene(),
        pilot_goal: goals.get(plant.pilot_goal()).map_or(0, |goal| goal.id),
        state: state.to_vec(),
        position,
        switches,
        goals: goals.to_vec(),
        poses: poses(plant),
    }
}

fn moved(plant: &dyn Plant, tick: u32, Step { reward, ending }: Step) -> Moved {
    let View { state, position, switches, goals, .. } = plant.view();
    let (state, goals) = (state.to_vec(), Some(goals.to_vec()));
    Moved { tick, state, position, switches, goals, poses: poses(plant), reward, ending }
}

fn poses(plant: &dyn Plant) -> Vec<cohelm::scene::Pose> {
    let mut poses = Vec::new();
    plant.poses(&mut poses);
    poses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Address, External, TimeOut};
    use cohelm::point::Point;
    use std::net::TcpListener;
    use std::thread;

    type Ended = thread::JoinHandle<io::Result<Option<Ending>>>;

    /// A point elsewhere, for one episode.
    fn elsewhere() -> (Address, Ended) {
        run(Point::new())
    }

    fn run(mut plant: impl Plant + 'static) -> (Address, Ended) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string().parse().unwrap();
        (address, thread::spawn(move || answer(&mut plant, "point", listener.accept()?.0)))
    }

    /// The point, driven twice a second.
    struct Slow(Point);

    impl Plant for Slow {
        fn reset(&mut self, seed: u64) {
            self.0.reset(seed);
        }

        fn step(&mut self, executed: Option<Action>) -> Step {
            self.0.step(executed)
        }

        fn view(&self) -> View<'_> {
            self.0.view()
        }

        fn pilot_goal(&self) -> usize {
            self.0.pilot_goal()
        }

        fn space(&self) -> &ActionSpace {
            self.0.space()
        }

        fn ticks_per_second(&self) -> f64 {
            2.0
        }

        fn scene(&self) -> cohelm::scene::Scene {
            self.0.scene()
        }

        fn poses(&self, poses: &mut Vec<cohelm::scene::Pose>) {
            self.0.poses(poses);
        }
    }

    #[test]
    fn a_plant_elsewhere_goes_the_same_way_as_one_that_is_here() {
        let (address, other) = elsewhere();
        let mut far = External::begin(&address, 5, TimeOut::default()).unwrap();
        let mut near = Point::new();
        near.reset(5);
        for tick in 0_u16..200 {
            let push = (f32::from(tick) * 0.7).sin();
            let action = (tick % 5 > 0).then(|| Action::axes(&[0.3 * push, 0.2]));
            let step = near.step(action);
            assert_eq!((far.step(action), far.view().state), (step, near.view().state));
            assert_eq!(far.view().goals, near.view().goals);
            if step.ending.is_some() {
                break;
            }
        }
        drop(far);
        assert!(other.join().unwrap().unwrap().is_some());
    }

    #[test]
    fn a_slow_plant_waits_for_its_next_tick_and_no_longer() {
        let (address, other) = run(Slow(Point::new()));
        let mut far = External::begin(&address, 5, TimeOut::default()).unwrap();
        for _ in 0..3 {
            assert_eq!(far.step(None).ending, None);
            thread::sleep(Duration::from_millis(500));
        }
        thread::sleep(Duration::from_millis(600));
        assert_eq!(far.step(None).ending, Some(Ending::Abandoned));
        assert!(other.join().unwrap().is_err(), "more than 750 ms passed without a tick");
    }

    #[test]
    fn it_is_told_the_end_and_refuses_what_the_plant_cannot_do() {
        let (address, other) = elsewhere();
        let mut far = External::begin(&address, 5, TimeOut::default()).unwrap();
        far.step(None);
        far.end(Ending::Abandoned);
        assert_eq!(other.join().unwrap().unwrap(), Some(Ending::Abandoned));
        let space = Point::new().space().clone();
        let wrong = [
            "[2.0, 0.0]",
            "[0.0, 0.0, 1.0]",
            "[0.5]",
            "[]",
            "[\"x\", 0.5]",
            "[\"x\", 0.5, 0.5]",
            "[null, 0.5]",
            "3",
            "\"up\"",
        ];
        for said in wrong {
            assert!(action_of(&space, &serde_json::from_str(said).unwrap()).is_err(), "{said}");
        }
    }
}
