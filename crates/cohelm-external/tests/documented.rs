//! What docs/external-plants.md shows is what is said.

use cohelm::action::Action;
use cohelm::plant::Ending;
use cohelm::tape::{Described, Tape};
use cohelm_external::words::{Begin, Hello, Moved, Ready, begin, end, read, tick};

/// The line of JSON below a mark.
fn shown(mark: &str) -> String {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/external-plants.md");
    let text = std::fs::read_to_string(page).unwrap();
    let (_, after) =
        text.split_once(&format!("<!-- {mark} -->\n```json\n")).expect("the mark stands in the page");
    after.lines().next().unwrap().to_owned()
}

fn same<T: serde::Serialize + serde::de::DeserializeOwned>(mark: &str) -> T {
    let message: T = read(&shown(mark)).unwrap();
    assert_eq!(serde_json::to_string(&message).unwrap(), shown(mark));
    message
}

#[test]
fn the_examples_are_what_is_said_and_go_together() {
    let hello: Hello = same("hello");
    let ready: Ready = same("ready");
    let moved: Moved = same("moved");
    assert_eq!(begin(Begin { seed: 7, time_out_ms: 270 }), shown("begin"));
    assert_eq!(tick(0, Some(Action::axes(&[0.25])), 1), shown("tick"));
    assert_eq!(end(Ending::Abandoned), shown("end"));
    let (scene, pilot_goal, first) = ready.seen();
    let Hello { name, ticks_per_second, space, .. } = hello;
    let goals = first.goals.clone();
    let about = Described { name, ticks_per_second, space, scene, pilot_goal };
    let mut tape = Tape::new(about, first).unwrap();
    tape.push(moved.seen(&goals)).unwrap();
}
