//! Plants that do not keep to the protocol: refused before an episode, an ending in it.

use cohelm::plant::{Ending, Plant};
use cohelm_external::line::Line;
use cohelm_external::{Address, External, TimeOut};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::thread;
use std::time::{Duration, Instant};

fn hello() -> Value {
    json!({ "cohelm": 1, "name": "bad", "ticks_per_second": 50,
        "space": { "kind": "single", "names": ["wait", "go"], "pushes": [null, null] } })
}

fn seen() -> Value {
    json!({ "state": [0.0], "position": [0.0, 0.0], "poses": [{ "x": 0, "y": 0, "angle_rad": 0, "strength": 1 }] })
}

fn ready() -> Value {
    drawn(json!({ "kind": "disc", "center": [0, 0], "radius": 1 }), [1, 1])
}

/// The same with another shape for its body, and another scale.
fn drawn(shape: Value, scale: [i32; 2]) -> Value {
    let body = json!({ "role": "body", "shapes": [shape] });
    let scene =
        json!({ "bounds": [-1, -1, 1, 1], "fixed": [], "movable": [body], "origin": [0, 0], "scale": scale });
    let goals = json!([{ "id": 4, "position": [1.0, 0.0] }]);
    with(seen(), &[("pilot_goal", json!(4)), ("goals", goals), ("scene", scene)])
}

fn disc(radius: f64) -> Value {
    json!({ "kind": "disc", "center": [0, 0], "radius": radius })
}

/// A shape without a single point.
fn outline(kind: &str) -> Value {
    json!({ "kind": kind, "points": [] })
}

fn with(mut message: Value, fields: &[(&str, Value)]) -> Value {
    fields.iter().for_each(|(name, value)| message[*name] = value.clone());
    message
}

/// A plant that says these lines, one after each that it hears but the first, and then hangs up.
fn plant(lines: Vec<String>) -> Address {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string().parse().unwrap();
    thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut heard = BufReader::new(stream.try_clone().unwrap()).lines();
        for (index, line) in lines.iter().enumerate() {
            if index > 0 && heard.next().is_none() {
                return;
            }
            let _ = stream.write_all(line.as_bytes()).and_then(|()| stream.write_all(b"\n"));
        }
        let _ = heard.next();
    });
    address
}

fn begin(hello: &Value, ready: &Value) -> Result<External, String> {
    let address = plant(vec![hello.to_string(), ready.to_string()]);
    External::begin(&address, 1, TimeOut::default()).map_err(|error| error.to_string())
}

/// Why the plant is lost when it answers the first tick with this.
fn lost_by(answer: String) -> String {
    let address = plant(vec![hello().to_string(), ready().to_string(), answer]);
    let mut plant = External::begin(&address, 1, TimeOut::default()).unwrap();
    let step = plant.step(None);
    assert_eq!((step.ending, step.reward), (Some(Ending::Abandoned), 0.0));
    assert_eq!(plant.view().state, [0.0], "it stays where it was seen last");
    assert_eq!(plant.step(None).ending, Some(Ending::Abandoned), "a tick more harms nothing");
    plant.tape().unwrap().lost().unwrap().to_owned()
}

#[test]
fn what_cannot_be_flown_is_refused_before_the_episode() {
    assert!(begin(&hello(), &ready()).is_ok());
    let cases = [
        (with(hello(), &[("cohelm", json!(2))]), ready(), "speaks version 2 of the protocol, here it is 1"),
        (
            with(hello(), &[("ticks_per_second", json!(0))]),
            ready(),
            "ticks_per_second must be 1 to 200, got 0",
        ),
        (with(hello(), &[("name", json!(""))]), ready(), "name must be 1 to 64 bytes"),
        (with(hello(), &[("space", json!({ "kind": "wheel" }))]), ready(), "unknown variant `wheel`"),
        (with(hello(), &[("nmae", json!("x"))]), ready(), "unknown field `nmae`"),
        (
            hello(),
            with(ready(), &[("pilot_goal", json!(9))]),
            "pilot_goal must be the id of a goal, one of [4], got 9",
        ),
        (hello(), with(ready(), &[("state", json!([1e9]))]), "a number of the state must be a finite number"),
        (hello(), drawn(disc(-1.0), [1, 1]), "a disc's radius must be 0 to 1000000, got -1"),
        (hello(), drawn(disc(1e9), [1, 1]), "a disc's radius must be 0 to 1000000, got 1000000000"),
        (hello(), drawn(disc(1.0), [1, 0]), "the scene's scale must be other than 0, got 0"),
        (hello(), drawn(outline("line"), [1, 1]), "an outline of the scene must be 1 to 20000 points, got 0"),
        (
            hello(),
            drawn(outline("polygon"), [1, 1]),
            "an outline of the scene must be 1 to 20000 points, got 0",
        ),
        (hello(), json!({ "error": "the brake is on" }), "the plant says: the brake is on"),
    ];
    for (hello, ready, expected) in cases {
        let said = begin(&hello, &ready).err().expect("a refusal");
        assert!(said.contains(expected), "{said:?} does not say {expected:?}");
    }
}

#[test]
fn whatever_it_answers_a_tick_with_the_worst_is_an_ending() {
    let moved = |fields: &[(&str, Value)]| with(with(seen(), &[("tick", json!(0))]), fields).to_string();
    let nan = moved(&[]).replace("[0.0]", "[NaN]");
    let cases = [
        (nan, "its line is no JSON"),
        (moved(&[("state", json!([1e30]))]), "a number of the state must be a finite number of at most 1000"),
        (moved(&[("state", json!([0.0, 0.0]))]), "the state must be 1 numbers as before, got 2"),
        (moved(&[("tick", json!(7))]), "it answers tick 7, but tick 0 was asked"),
        (moved(&[("goals", json!([]))]), "goals must be 1 to 8 goals, got 0"),
        (moved(&[("ending", json!("explosion"))]), "unknown variant `explosion`"),
        (moved(&[("poses", json!([]))]), "poses must be 1 poses"),
        (json!({ "error": "emergency stop" }).to_string(), "it says: emergency stop"),
        ("x".repeat(70_000), "its line has more than 65536 bytes"),
        (format!("{}\n{}", moved(&[]), moved(&[])), "it spoke out of turn"),
        ("\u{1b}[31mhello".into(), "its line is no JSON"),
    ];
    for (answer, expected) in cases {
        let said = lost_by(answer);
        assert!(said.contains(expected), "{said:?} does not say {expected:?}");
    }
}

#[test]
fn nobody_there_is_told_before_the_episode() {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let said = External::begin(&port.to_string().parse().unwrap(), 1, TimeOut::default()).err().unwrap();
    assert!(said.to_string().ends_with("start it first"), "{said}");
}

/// Filled up as the kernel lets it: whoever connects next waits until somebody is taken in, and nobody is.
#[cfg(unix)]
#[test]
fn a_stopped_plant_whose_waiting_line_is_full_is_told_in_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.sock");
    let listener = socket2::Socket::new(socket2::Domain::UNIX, socket2::Type::STREAM, None).unwrap();
    listener.bind(&socket2::SockAddr::unix(&path).unwrap()).unwrap();
    listener.listen(1).unwrap();
    let address: Address = format!("unix:{}", path.display()).parse().unwrap();
    let within = Duration::from_millis(200);
    let begun = Instant::now();
    let mut waiting = Vec::new();
    let error = loop {
        match Line::connect(&address, within) {
            Ok(line) => waiting.push(line),
            Err(error) => break error,
        }
        assert!(waiting.len() < 100, "the line is never full");
    };
    assert_eq!(error.kind(), std::io::ErrorKind::TimedOut, "{error}");
    assert!((within..20 * within).contains(&begun.elapsed()), "{:?}", begun.elapsed());
}

#[cfg(unix)]
#[test]
fn a_unix_socket_is_as_good() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.sock");
    let listener = std::os::unix::net::UnixListener::bind(&path).unwrap();
    thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut heard = BufReader::new(stream.try_clone().unwrap()).lines();
        let _ = writeln!(stream, "{}", hello());
        assert_eq!(heard.next().unwrap().unwrap(), r#"{"begin":{"seed":3,"time_out_ms":270}}"#);
        let _ = writeln!(stream, "{}", ready());
        assert_eq!(heard.next().unwrap().unwrap(), r#"{"action":1,"tick":0}"#);
        let _ = writeln!(stream, "{}", with(seen(), &[("tick", json!(0)), ("ending", json!("goal"))]));
        let _ = heard.next();
    });
    let address = format!("unix:{}", path.display()).parse().unwrap();
    let mut plant = External::begin(&address, 3, TimeOut::default()).unwrap();
    assert_eq!(plant.step(Some(cohelm::action::Action::Command(1))).ending, Some(Ending::Goal));
}
