//! The fingers on the keys: what is down, since when, and what may come up.

use super::perception::Moment;
use super::skill::Plan;
use super::traits::Traits;
use crate::action::{Action, ActionSpace};
use crate::keys::{Change, Keyboard, controls};
use crate::pilot::Pilot;
use crate::random::Draws;

/// A key that is down.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Finger {
    control: u8,
    held_ticks: u32,
    /// To be let go as soon as that is possible.
    leaving: bool,
    /// Hit by mistake.
    slipped: bool,
    /// The control was asked for, so that it should work from now on.
    asked: bool,
    /// It has been seen working.
    seen_working: bool,
}

/// The fingers of one pilot over a keyboard, which turns what is held into requests exactly as it does for a person.
#[derive(Clone, Debug)]
pub(super) struct Fingers {
    space: ActionSpace,
    controls: u8,
    keyboard: Keyboard,
    down: Vec<Finger>,
}

impl Fingers {
    pub(super) fn new(space: &ActionSpace) -> Self {
        let controls = controls(space).len() as u8;
        Self { space: space.clone(), controls, keyboard: Keyboard::new(space), down: Vec::new() }
    }

    pub(super) fn begin(&mut self) {
        self.keyboard = Keyboard::new(&self.space);
        self.down.clear();
    }

    pub(super) fn presses(&self) -> u32 {
        self.keyboard.key_presses()
    }

    /// The controls that are down, the longest held first.
    pub(super) fn held(&self) -> impl Iterator<Item = u8> + '_ {
        self.down.iter().map(|finger| finger.control)
    }

    /// The controls that are down, one bit each.
    pub(super) fn keys_down(&self) -> u64 {
        self.held().fold(0, |bits, control| bits | bit(control))
    }

    /// True while a finger is on its way up, or on a wrong key: the pilot presses nothing else meanwhile.
    pub(super) fn busy(&self) -> bool {
        self.down.iter().any(|finger| finger.slipped || finger.leaving)
    }

    /// True once a held key may come up: it was down for long enough, and a pilot that insists has seen it working or
    /// has lost patience.
    pub(super) fn may_release(&self, control: u8, traits: &Traits) -> bool {
        self.finger(control).is_some_and(|finger| finger.may_release(traits))
    }

    /// A key that wants to come up and may.
    pub(super) fn due(&self, traits: &Traits) -> Option<u8> {
        let due = |finger: &&Finger| (finger.leaving || finger.slipped) && finger.may_release(traits);
        self.down.iter().find(due).map(|finger| finger.control)
    }

    /// From now on a key wants to come up.
    pub(super) fn leave(&mut self, control: u8) {
        let finger = self.down.iter_mut().find(|finger| finger.control == control);
        finger.into_iter().for_each(|finger| finger.leaving = true);
    }

    /// Presses a key, or with the pilot's rate of slips one of the others that are up.
    pub(super) fn press(&mut self, wanted: u8, traits: &Traits, draws: &mut Draws) {
        let slips = draws.chance(traits.wrong_key);
        let up = |&control: &u8| control != wanted && self.finger(control).is_none();
        let others: Vec<u8> = (0..self.controls).filter(up).collect();
        let slipped = slips && !others.is_empty();
        let control = if slipped { others[draws.below(others.len())] } else { wanted };
        self.keyboard.change(Change::Down(control));
        self.down.push(Finger { slipped, ..Finger::on(control) });
    }

    /// Lets a key go.
    pub(super) fn release(&mut self, control: u8) {
        self.keyboard.change(Change::Up(control));
        self.down.retain(|finger| finger.control != control);
    }

    /// Looks whether what is down works.
    pub(super) fn watch(&mut self, moment: &Moment, plan: &Plan) {
        for finger in &mut self.down {
            finger.seen_working |= plan.works(finger.control, &moment.state) == Some(true);
        }
    }

    /// What the keys ask for now.
    pub(super) fn ask(&mut self) -> Option<Action> {
        let asked = self.keyboard.next_request();
        let stays = matches!(self.space, ActionSpace::Switches { .. });
        for finger in &mut self.down {
            finger.held_ticks += 1;
            let asked_now = asked.is_some_and(|asked| is_asked(&self.space, asked, finger.control.into()));
            finger.asked = asked_now || (stays && finger.asked);
        }
        asked
    }

    /// The controls that should be working by what was asked, one bit each.
    pub(super) fn expected(&self) -> u64 {
        self.down.iter().filter(|finger| finger.asked).fold(0, |bits, finger| bits | bit(finger.control))
    }

    fn finger(&self, control: u8) -> Option<&Finger> {
        self.down.iter().find(|finger| finger.control == control)
    }
}

impl Finger {
    fn on(control: u8) -> Self {
        Self { control, held_ticks: 0, leaving: false, slipped: false, asked: false, seen_working: false }
    }

    fn may_release(&self, traits: &Traits) -> bool {
        let held = self.held_ticks >= traits.hold_ticks.max(1);
        held && (self.slipped || self.seen_working || self.held_ticks >= traits.insist_ticks)
    }
}

/// True if an action sets a control working; with switches it then stays so.
fn is_asked(space: &ActionSpace, asked: Action, control: usize) -> bool {
    match space {
        ActionSpace::Switches { .. } => asked.command() == Some(2 * control),
        ActionSpace::Single { .. } => asked.command() == Some(control + 1),
        ActionSpace::Levers { levers } => {
            let positions = space.levers_of(asked.command().unwrap_or_default() as u8);
            let moved = levers.iter().zip(positions).flat_map(|(lever, at)| {
                let others = 0..lever.positions.len() as u8;
                others.filter(|&other| other != lever.neutral).map(move |other| other == at)
            });
            moved.into_iter().nth(control).unwrap_or(false)
        }
        ActionSpace::Axes { .. } => {
            let deflection = asked.axis(control / 2);
            if control % 2 == 0 { deflection < 0.0 } else { deflection > 0.0 }
        }
    }
}

/// True if a pilot that saw this moment saw a key disobeyed: it should have been working and was not, or its opposite
/// worked without being asked.
pub(super) fn conflict(moment: &Moment, plan: &Plan) -> bool {
    let expected = |control: &u8| moment.expected & bit(*control) != 0;
    let works = |control| plan.works(control, &moment.state);
    let opposed = |control| plan.opposite(control).filter(|opposite| !expected(opposite)).and_then(works);
    let disobeyed = |control| works(control) == Some(false) || opposed(control) == Some(true);
    (0..u64::BITS as u8).filter(expected).any(disobeyed)
}

fn bit(control: u8) -> u64 {
    1_u64.checked_shl(control.into()).unwrap_or(0)
}
