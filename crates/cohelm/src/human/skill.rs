//! What a plant has to say about how it is steered by hand.

/// What a trained person knows about steering one plant: what there is to attend to, what each key is for, and how far
/// off everything is.
///
/// A skill says what *should* be done about what was seen. That it is seen late and wrongly, that only one axis is
/// attended at a time, that fingers slip and trust grows, is the business of [`HumanPilot`](super::HumanPilot).
pub trait Skill: Send {
    /// The axes, keys and senses of the plant; the same at every call.
    fn plan(&self) -> &Plan;

    /// Fills in how far off each axis is, in dead bands of an average person (1 is where such a person would reach for
    /// a key), positive where the axis's `plus` key would help and negative where `minus` would.
    fn errors(&self, seen: &Seen<'_>, errors: &mut [f64]);
}

/// What a pilot takes to be the case: late, noisy, carried forward in its head.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The state vector, in the plant's normalised units.
    pub state: &'a [f64],
    /// Where the pilot's own goal is, in the units of goals' positions.
    pub goal: [f64; 2],
}

/// What a pilot of one plant attends to, presses and sees. A component that the state lacks is not seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What is attended to, one at a time.
    pub axes: Vec<Axis>,
    /// Components of the state that move smoothly, places and speeds: the pilot carries them forward to now.
    pub moving: Vec<usize>,
    /// Components of the state that are speeds judged by eye, and so misjudged.
    pub judged: Vec<usize>,
    /// For each control of the action space: the component of the state that is above 1/2 while the control can be seen
    /// working (a flame, a lamp). `None` if nothing shows it; missing at the end means `None`.
    pub shown: Vec<Option<usize>>,
}

/// Something to attend to, with at most one key for each direction. Controls are indices into
/// [`controls`](crate::keys::controls) of the plant's action space.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Its name, for people.
    pub name: &'static str,
    /// The control that corrects a positive error.
    pub plus: Option<u8>,
    /// The control that corrects a negative error.
    pub minus: Option<u8>,
    /// The key is let go once the error that it corrects has fallen below this, in the pilot's own dead bands. Near 1
    /// the key chatters; below 0 the pilot corrects beyond zero on purpose.
    pub release: f64,
    /// True for a key that a pilot lets go with its `drop_key` probability when attention leaves, as one forgets a
    /// throttle; otherwise the key stays as it is until attention comes back.
    pub droppable: bool,
}

impl Axis {
    /// The control that would correct an error of this sign.
    pub fn control(&self, error: f64) -> Option<u8> {
        if error > 0.0 { self.plus } else { self.minus }
    }

    /// True if `control` belongs to this axis.
    pub fn has(&self, control: u8) -> bool {
        self.plus == Some(control) || self.minus == Some(control)
    }

    /// How much of an error asks for a key to be moved, given the key of this axis that is down: an error that no key
    /// would correct can only be waited out, and does not draw attention.
    pub fn urgency(&self, error: f64, held: Option<u8>) -> f64 {
        let correctable = self.control(error).is_some();
        let made_worse = held.is_some() && held != self.control(error);
        if correctable || made_worse { error.abs() } else { 0.0 }
    }
}

impl Plan {
    /// The control that pushes against `control`, if there is one.
    pub(super) fn opposite(&self, control: u8) -> Option<u8> {
        let axis = self.axes.iter().find(|axis| axis.has(control))?;
        if axis.plus == Some(control) { axis.minus } else { axis.plus }
    }

    /// Whether a control can be seen working in a state; `None` if nothing shows it.
    pub(super) fn works(&self, control: u8, state: &[f32]) -> Option<bool> {
        let component = self.shown.get(usize::from(control)).copied().flatten()?;
        state.get(component).map(|&shown| shown > 0.5)
    }

    /// A control that the plan names though there are only so many.
    pub(super) fn missing_control(&self, controls: usize) -> Option<u8> {
        let mut named = self.axes.iter().flat_map(|axis| [axis.plus, axis.minus]).flatten();
        named.find(|&control| usize::from(control) >= controls)
    }
}
