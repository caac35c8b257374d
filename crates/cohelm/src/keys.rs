//! From keys and sticks to one request a tick.
//!
//! Knows no clock and no keyboard: controls are numbers, and an event takes effect at the tick before whose request it
//! is given. The log of these events, with the seed, is the truth of a flight.

use crate::action::{Action, ActionSpace};
use crate::pilot::Pilot;
use crate::plant::View;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Something a key can be bound to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Control {
    /// What it does, in the plant's words.
    pub name: String,
    /// Keys it is bound to unless the person chooses others, as `KeyboardEvent.code` names them.
    pub keys: Vec<String>,
}

/// No control is called so.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this is steered with a key for {missing:?}; there is none for {missing:?} among {known}")]
pub struct NoControl {
    /// What it is called.
    pub missing: String,
    /// The controls that there are.
    pub known: String,
}

/// The control of that name, or of the other name that it has on a continuous axis.
///
/// ```
/// use cohelm::keys::control_named;
/// use cohelm::plant::Plant;
/// use cohelm::point::Point;
/// assert_eq!(control_named(Point::new().space(), "right", "x +"), Ok(1));
/// ```
pub fn control_named(space: &ActionSpace, name: &str, on_axis: &str) -> Result<u8, NoControl> {
    let known = controls(space);
    let index = known.iter().position(|control| control.name == name || control.name == on_axis);
    index.map(|index| index as u8).ok_or_else(|| NoControl {
        missing: name.into(),
        known: known.iter().map(|control| control.name.as_str()).collect::<Vec<_>>().join(", "),
    })
}

/// What a person did to a control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// Pressed the control of that index.
    Down(u8),
    /// Released it.
    Up(u8),
    /// Moved the stick: each axis in −32767..=32767. Counts until moved again.
    Stick([i16; 4]),
    /// Everything was released, and nothing more is to come of it: the window lost its focus.
    ReleaseAll,
}

/// A change and when it took effect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeyEvent {
    /// The tick before whose request it came.
    pub tick: u32,
    /// What was done.
    pub change: Change,
    /// When the person did it by the page's clock, milliseconds since the episode began; decides nothing.
    pub at_ms: f32,
}

/// Part of a stick's travel within which it asks for nothing: larger forgives a worn stick, smaller feels more direct.
pub const STICK_DEAD_ZONE: f32 = 0.1;

/// A person at keys or a stick.
///
/// One command a tick. Switches: the newest held key repeats its *on*; every release queues one *off*, and a key tapped
/// between two ticks queues its *on* too, so that none is lost. Levers: each follows its newest held key. Single
/// commands: the newest held key. Axes: held keys add up to full deflection; a stick outside its dead zone wins.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyboard {
    space: ActionSpace,
    held: Vec<u8>,
    unseen: Vec<u8>,
    queue: VecDeque<u8>,
    stick: [i16; 4],
    presses: u32,
}

impl Keyboard {
    /// Nothing held.
    pub fn new(space: &ActionSpace) -> Self {
        Self {
            space: space.clone(),
            held: Vec::new(),
            unseen: Vec::new(),
            queue: VecDeque::new(),
            stick: [0; 4],
            presses: 0,
        }
    }

    /// Takes a change in. Controls that do not exist, a press of what is held and a release of what is not change
    /// nothing.
    pub fn change(&mut self, change: Change) {
        match change {
            Change::Down(control) => self.press(control),
            Change::Up(control) => self.release(control),
            Change::Stick(stick) => self.stick = stick,
            Change::ReleaseAll => {
                while let Some(&control) = self.held.last() {
                    self.release(control);
                }
                self.stick = [0; 4];
            }
        }
    }

    /// What is asked at this tick.
    pub fn next_request(&mut self) -> Option<Action> {
        let asked = match &self.space {
            ActionSpace::Switches { .. } => self.next_switch(),
            ActionSpace::Levers { .. } => self.levers(),
            ActionSpace::Single { .. } => self.newest().map(|control| Action::Command(control + 1)),
            ActionSpace::Axes { .. } => self.stick_or_keys(),
        };
        self.unseen.clear();
        asked
    }

    fn press(&mut self, control: u8) {
        if usize::from(control) < controls(&self.space).len() && !self.held.contains(&control) {
            self.held.push(control);
            self.unseen.push(control);
            self.presses += 1;
        }
    }

    fn release(&mut self, control: u8) {
        let Some(index) = self.held.iter().position(|&held| held == control) else { return };
        self.held.remove(index);
        if matches!(self.space, ActionSpace::Switches { .. }) {
            if self.unseen.contains(&control) {
                self.queue.push_back(2 * control);
            }
            self.queue.push_back(2 * control + 1);
        }
    }

    /// The newest control that is held, or was tapped since the last request.
    fn newest(&self) -> Option<u8> {
        self.unseen.last().or(self.held.last()).copied()
    }

    fn next_switch(&mut self) -> Option<Action> {
        let command = self.queue.pop_front().or_else(|| {
            let newest = *self.held.last()?;
            Some(2 * newest)
        })?;
        Some(Action::Command(command))
    }

    fn levers(&self) -> Option<Action> {
        let ActionSpace::Levers { levers } = &self.space else { return None };
        let newest_first: Vec<u8> = self.unseen.iter().rev().chain(self.held.iter().rev()).copied().collect();
        let positions = lever_controls(&self.space);
        let mut index = 0;
        for (i, lever) in levers.iter().enumerate() {
            let mine = |control: &u8| positions.get(usize::from(*control)).filter(|(lever, _)| *lever == i);
            let position =
                newest_first.iter().find_map(mine).map_or(lever.neutral, |(_, position)| *position);
            index = index * lever.positions.len() + usize::from(position);
        }
        (!newest_first.is_empty()).then_some(Action::Command(index as u8))
    }

    fn stick_or_keys(&self) -> Option<Action> {
        let ActionSpace::Axes { low, high, .. } = &self.space else { return None };
        let deflect = |i: usize, part: f32| if part < 0.0 { -part * low[i] } else { part * high[i] };
        let parts = self.stick.map(|raw| (f32::from(raw) / 32767.0).clamp(-1.0, 1.0));
        let moved = parts.iter().take(low.len()).any(|part| libm::fabsf(*part) > STICK_DEAD_ZONE);
        let mut axes = [0.0; 4];
        if moved {
            (0..low.len()).for_each(|i| axes[i] = deflect(i, parts[i]));
        } else {
            let mut sums = [0.0_f32; 4];
            for &control in self.held.iter().chain(self.unseen.iter().filter(|c| !self.held.contains(c))) {
                sums[usize::from(control / 2)] += if control % 2 == 0 { -1.0 } else { 1.0 };
            }
            if self.held.is_empty() && self.unseen.is_empty() {
                return None;
            }
            (0..low.len()).for_each(|i| axes[i] = deflect(i, sums[i]));
        }
        Some(Action::Axes(axes))
    }
}

impl Pilot for Keyboard {
    fn begin(&mut self, _seed: u64) {
        *self = Self::new(&self.space);
    }

    fn ask(&mut self, _view: &View<'_>, _goal: usize) -> Option<Action> {
        self.next_request()
    }

    fn key_presses(&self) -> u32 {
        self.presses
    }
}

/// What a person can press in a space: every switch; every position of a lever but the neutral one; every single
/// command but the one that does nothing; each axis backwards and forwards. A key moves one control, the first that it
/// would be usual for; a control that is left with none has the digit of its number.
pub fn controls(space: &ActionSpace) -> Vec<Control> {
    let names: Vec<String> = match space {
        ActionSpace::Switches { switches } => switches.iter().map(|switch| switch.name.clone()).collect(),
        ActionSpace::Levers { levers } => {
            let name = |&(lever, position): &(usize, u8)| {
                let position = &levers[lever].positions[usize::from(position)];
                if position == "on" { levers[lever].name.clone() } else { position.clone() }
            };
            lever_controls(space).iter().map(name).collect()
        }
        ActionSpace::Single { names, .. } => names.iter().skip(1).cloned().collect(),
        ActionSpace::Axes { names, .. } => {
            names.iter().flat_map(|n| [format!("{n} −"), format!("{n} +")]).collect()
        }
    };
    let mut taken: Vec<String> = Vec::new();
    let bound = names.into_iter().enumerate().map(|(index, name)| {
        let mut keys = usual_keys(&name, index);
        keys.retain(|key| !taken.contains(key));
        // Two names may mean the same keys; whatever control comes later would be out of reach.
        if keys.is_empty() {
            keys.push(digit(index));
        }
        taken.extend_from_slice(&keys);
        Control { keys, name }
    });
    bound.collect()
}

fn lever_controls(space: &ActionSpace) -> Vec<(usize, u8)> {
    let ActionSpace::Levers { levers } = space else { return Vec::new() };
    let positions = levers.iter().enumerate().flat_map(|(i, lever)| {
        let positions = 0..lever.positions.len() as u8;
        positions.filter(|&position| position != lever.neutral).map(move |position| (i, position))
    });
    positions.collect()
}

fn usual_keys(name: &str, index: usize) -> Vec<String> {
    let keys: &[&str] = match name {
        "left" | "x −" | "side −" => &["ArrowLeft", "KeyA"],
        "right" | "x +" | "side +" => &["ArrowRight", "KeyD"],
        "main" | "up" | "y +" | "main +" => &["ArrowUp", "KeyW", "Space"],
        "down" | "y −" | "main −" => &["ArrowDown", "KeyS"],
        _ => return vec![digit(index)],
    };
    keys.iter().map(|key| key.to_string()).collect()
}

fn digit(index: usize) -> String {
    format!("Digit{}", index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::{Lever, Push, Switch};
    use Change::{Down, ReleaseAll, Up};

    fn engines() -> ActionSpace {
        let switch = |name: &str, axis, forwards| Switch { name: name.into(), push: Push { axis, forwards } };
        ActionSpace::Switches { switches: vec![switch("left", 0, false), switch("main", 1, true)] }
    }

    /// What is asked at each tick, given the changes before it.
    fn asked(space: &ActionSpace, ticks: &[&[Change]]) -> Vec<Option<usize>> {
        let mut keyboard = Keyboard::new(space);
        let request = |changes: &&[Change]| {
            changes.iter().for_each(|&change| keyboard.change(change));
            keyboard.next_request().and_then(|action| action.command())
        };
        ticks.iter().map(request).collect()
    }

    #[test]
    fn the_newest_held_key_repeats_its_on() {
        let requests = asked(&engines(), &[&[Down(0)], &[], &[Down(1)], &[], &[Up(1)], &[]]);
        assert_eq!(requests, [Some(0), Some(0), Some(2), Some(2), Some(3), Some(0)]);
    }

    #[test]
    fn a_release_of_one_key_does_not_silence_another_that_is_held() {
        let requests = asked(&engines(), &[&[Down(0), Down(1)], &[Up(1)], &[]]);
        assert_eq!(requests, [Some(2), Some(3), Some(0)]);
    }

    #[test]
    fn every_release_is_asked_for_even_when_all_come_at_once() {
        let requests = asked(&engines(), &[&[Down(0), Down(1)], &[ReleaseAll], &[], &[]]);
        assert_eq!(requests, [Some(2), Some(3), Some(1), None]);
    }

    #[test]
    fn a_tap_between_two_ticks_switches_on_and_off_again() {
        assert_eq!(asked(&engines(), &[&[Down(0), Up(0)], &[], &[]]), [Some(0), Some(1), None]);
    }

    #[test]
    fn repeats_and_unknown_controls_change_nothing() {
        let requests = asked(&engines(), &[&[Down(0), Down(0)], &[Up(7), Down(9)], &[Up(0), Up(0)], &[]]);
        assert_eq!(requests, [Some(0), Some(0), Some(1), None]);
    }

    #[test]
    fn levers_are_held_together() {
        let lever = |name: &str, positions: &[&str], neutral| Lever {
            name: name.into(),
            positions: positions.iter().map(|p| p.to_string()).collect(),
            neutral,
        };
        let space = ActionSpace::Levers {
            levers: vec![lever("main", &["off", "on"], 0), lever("side", &["left", "none", "right"], 1)],
        };
        let names: Vec<String> = controls(&space).into_iter().map(|control| control.name).collect();
        assert_eq!(names, ["main", "left", "right"]);
        let requests = asked(&space, &[&[Down(0)], &[Down(1)], &[Down(2)], &[Up(0), Up(2)], &[Up(1)]]);
        assert_eq!(requests, [Some(4), Some(3), Some(5), Some(0), None]);
    }

    #[test]
    fn a_key_moves_one_control_and_every_control_has_a_key() {
        let names = ["x", "y", "side", "main"].map(String::from).to_vec();
        let space = ActionSpace::Axes { names, low: vec![-1.0; 4], high: vec![1.0; 4] };
        let first: Vec<String> =
            controls(&space).into_iter().map(|mut control| control.keys.remove(0)).collect();
        let digits = ["Digit5", "Digit6", "Digit7", "Digit8"];
        assert_eq!(first, [["ArrowLeft", "ArrowRight", "ArrowDown", "ArrowUp"], digits].concat());
    }

    #[test]
    fn a_stick_in_its_dead_zone_asks_for_nothing() {
        let space = ActionSpace::Axes { names: vec!["x".into()], low: vec![-2.0], high: vec![1.0] };
        let mut keyboard = Keyboard::new(&space);
        keyboard.change(Change::Stick([3000, 0, 0, 0]));
        assert_eq!(keyboard.next_request(), None);
        keyboard.change(Change::Stick([-32767, 0, 0, 0]));
        assert_eq!(keyboard.next_request(), Some(Action::axes(&[-2.0])));
        keyboard.change(ReleaseAll);
        keyboard.change(Down(1));
        assert_eq!(keyboard.next_request(), Some(Action::axes(&[1.0])));
    }
}
