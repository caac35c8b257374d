//! Simulated people at the lander's keys: what they know about flying it.
//!
//! How people are (slow, distracted, mistaken) is [`cohelm::human`]'s; here is only what a person who has practised
//! tries to do: lean against drift towards the goal, and brake the descent.
//!
//! ```
//! use cohelm::human::{Person, Population, participant};
//! use cohelm::{pilot::Pilot, plant::Plant};
//! use cohelm_lander::flags::{FlagLander, FlagOptions};
//! use cohelm_lander::pilots;
//!
//! let mut lander = FlagLander::new(FlagOptions::default())?;
//! lander.reset(7);
//! let third = Person { population: Population::Ordinary, seed: 2024, index: 2 };
//! let mut third = participant(pilots::skill, lander.space(), third)?;
//! third.begin(7);
//! let asked = third.ask(&lander.view(), lander.pilot_goal());
//! assert_eq!(asked, None, "nobody reacts within a tick");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::flags::state::{LEFT_ENGINE, MAIN_ENGINE, RIGHT_ENGINE, SPIN, TILT, VX, VY, X, Y};
use cohelm::action::ActionSpace;
use cohelm::human::{Axis, Plan, Seen, Skill};
use cohelm::keys::{NoControl, control_named, controls};
use cohelm::random::Draws;
use serde::{Deserialize, Serialize};

/// Tilt (rad) that an average person wants for a unit of distance from the goal.
const TILT_PER_DISTANCE: f64 = 0.5;
/// The most tilt (rad) a person wants: more feels like falling over.
const LARGEST_TILT: f64 = 0.45;
/// An average person's dead band of the tilt, rad.
const TILT_DEAD_BAND: f64 = 0.10;
/// Part of the dead band at which a side key is let go.
const TILT_RELEASE: f64 = 0.3;
/// Descent wanted at the goal's height, in the state's units of velocity (7.5 units/s).
const DESCENT_AT_GOAL: f64 = 0.08;
/// Further descent wanted for a unit of height above the goal.
const DESCENT_PER_HEIGHT: f64 = 0.35;
/// An average person's dead band of the descent, in the state's units of velocity.
const DESCENT_DEAD_BAND: f64 = 0.04;
/// The main key is let go once the descent is slower than wanted by this part of the dead band.
const DESCENT_RELEASE: f64 = -0.5;

/// How one person flies: the part of a participant that is the lander's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Technique {
    /// Factor on the tilt wanted against distance and drift, 0.7 to 1.4. Low: drifts past the flags; high: swings.
    pub lean: f64,
    /// Tilt (rad) that a unit of spin (2.5 rad/s) counts for, 0 to 0.8. At 0 the spin is not felt, and tilt overshoots.
    pub spin_sense: f64,
    /// Factor on the descent wanted, 0.8 to 1.4. Low: hangs about; high: comes down too fast to brake.
    pub descent: f64,
}

impl Technique {
    /// One person's, uniform in the ranges named at the fields.
    pub fn draw(draws: &mut Draws) -> Self {
        Self {
            lean: draws.uniform(0.7, 1.4),
            spin_sense: draws.uniform(0.0, 0.8),
            descent: draws.uniform(0.8, 1.4),
        }
    }
}

/// The lander's skill: two axes, lateral (left and right keys) and vertical (main key).
#[derive(Clone, Debug, PartialEq)]
pub struct Flying {
    technique: Technique,
    plan: Plan,
}

impl Flying {
    /// The skill at the keys of one of the lander's action sets.
    pub fn new(technique: Technique, space: &ActionSpace) -> Result<Self, NoControl> {
        let key = |name, on_axis| control_named(space, name, on_axis);
        let (left, main, right) = (key("left", "side −")?, key("main", "main +")?, key("right", "side +")?);
        let lateral = Axis {
            name: "lateral",
            plus: Some(left),
            minus: Some(right),
            release: TILT_RELEASE,
            droppable: false,
        };
        let vertical = Axis {
            name: "vertical",
            plus: Some(main),
            minus: None,
            release: DESCENT_RELEASE,
            droppable: true,
        };
        let mut shown = vec![None; controls(space).len()];
        for (control, flame) in [(left, LEFT_ENGINE), (main, MAIN_ENGINE), (right, RIGHT_ENGINE)] {
            shown[usize::from(control)] = Some(flame);
        }
        let (moving, judged) = (vec![X, Y, VX, VY, TILT, SPIN], vec![VX, VY]);
        Ok(Self { technique, plan: Plan { axes: vec![lateral, vertical], moving, judged, shown } })
    }

    /// By how much the tilt should be turned further to the left, rad: positive calls for the left engine.
    fn lateral_error(&self, state: &[f64], goal: [f64; 2]) -> f64 {
        let Technique { lean, spin_sense, .. } = self.technique;
        let wanted = lean * (TILT_PER_DISTANCE * (state[X] - goal[0]) + state[VX]);
        wanted.clamp(-LARGEST_TILT, LARGEST_TILT) - state[TILT] - spin_sense * state[SPIN]
    }

    /// By how much the craft sinks too fast, in the state's units of velocity.
    fn vertical_error(&self, state: &[f64], goal: [f64; 2]) -> f64 {
        let height = (state[Y] - goal[1]).max(0.0);
        -self.technique.descent * (DESCENT_AT_GOAL + DESCENT_PER_HEIGHT * height) - state[VY]
    }
}

impl Skill for Flying {
    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn errors(&self, seen: &Seen<'_>, errors: &mut [f64]) {
        errors[0] = self.lateral_error(seen.state, seen.goal) / TILT_DEAD_BAND;
        errors[1] = self.vertical_error(seen.state, seen.goal) / DESCENT_DEAD_BAND;
    }
}

/// One person's skill at the keys of one of the lander's action sets: what the lander's entries name.
pub fn skill(space: &ActionSpace, draws: &mut Draws) -> Result<Box<dyn Skill>, String> {
    let flying = Flying::new(Technique::draw(draws), space).map_err(|error| error.to_string())?;
    Ok(Box::new(flying))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flags::state::STATE_LENGTH;
    use crate::flags::{ActionSet, FlagLander, FlagOptions};
    use cohelm::plant::Plant;
    use cohelm::point::Point;

    const PLAIN: Technique = Technique { lean: 1.0, spin_sense: 0.5, descent: 1.0 };

    fn space(actions: ActionSet) -> ActionSpace {
        let options = FlagOptions { actions, ..FlagOptions::default() };
        FlagLander::new(options).expect("the defaults are possible").space().clone()
    }

    /// Errors of a state that is zero but for these components, with the goal at the origin: lateral, vertical.
    fn errors(technique: Technique, components: &[(usize, f64)]) -> [f64; 2] {
        let mut state = [0.0; STATE_LENGTH];
        components.iter().for_each(|&(index, value)| state[index] = value);
        let mut errors = [0.0; 2];
        let flying = Flying::new(technique, &space(ActionSet::Switches)).expect("the lander's own keys");
        flying.errors(&Seen { state: &state, goal: [0.0, 0.0] }, &mut errors);
        errors
    }

    fn assert_close(got: f64, expected: f64) {
        assert!((got - expected).abs() < 1e-12, "{got} instead of {expected}");
    }

    #[test]
    fn a_person_right_of_the_goal_or_drifting_right_leans_left() {
        assert_close(errors(PLAIN, &[(X, 0.2)])[0], 1.0);
        assert_close(errors(PLAIN, &[(VX, 0.2)])[0], 2.0);
        assert_close(errors(Technique { lean: 1.4, ..PLAIN }, &[(X, -0.2)])[0], -1.4);
        assert_close(errors(PLAIN, &[(X, 0.9), (VX, 0.9)])[0], 4.5);
    }

    #[test]
    fn a_tilt_or_a_spin_to_the_left_calls_for_the_right_key() {
        assert_close(errors(PLAIN, &[(TILT, 0.3)])[0], -3.0);
        assert_close(errors(PLAIN, &[(SPIN, 0.4)])[0], -2.0);
        assert_close(errors(Technique { spin_sense: 0.0, ..PLAIN }, &[(SPIN, 0.4)])[0], 0.0);
    }

    #[test]
    fn sinking_faster_than_wanted_calls_for_the_main_key() {
        assert_close(errors(PLAIN, &[(VY, -0.2)])[1], 3.0);
        assert_close(errors(PLAIN, &[(Y, 1.0), (VY, -0.43)])[1], 0.0);
        assert_close(errors(PLAIN, &[(Y, -1.0)])[1], -2.0);
        assert_close(errors(Technique { descent: 1.25, ..PLAIN }, &[(VY, -0.1)])[1], 0.0);
    }

    #[test]
    fn keys_and_flames_belong_together_in_every_action_set() {
        for actions in [ActionSet::Switches, ActionSet::MainSide, ActionSet::Gymnasium, ActionSet::Continuous]
        {
            let space = space(actions);
            let plan = Flying::new(PLAIN, &space).expect("the lander's own keys").plan;
            let (known, vertical) = (controls(&space), &plan.axes[1]);
            let lit = |control: Option<u8>| control.and_then(|control| plan.shown[usize::from(control)]);
            assert_eq!(lit(plan.axes[0].plus), Some(LEFT_ENGINE), "{actions:?}");
            assert_eq!(lit(plan.axes[0].minus), Some(RIGHT_ENGINE), "{actions:?}");
            assert_eq!(lit(vertical.plus), Some(MAIN_ENGINE), "{actions:?}");
            let main = vertical.plus.map(|control| known[usize::from(control)].name.clone());
            assert!(main.is_some_and(|name| name.starts_with("main")), "{actions:?}");
        }
    }

    #[test]
    fn a_plant_without_the_landers_keys_is_refused_by_name() {
        let error = skill(Point::new().space(), &mut Draws::new(1)).map(|_| ()).unwrap_err();
        assert!(error.contains("none for \"left\" among x −, x +"), "{error}");
    }

    #[test]
    fn techniques_lie_in_their_ranges() {
        for index in 0..1000 {
            let Technique { lean, spin_sense, descent } = Technique::draw(&mut Draws::new(index));
            assert!((0.7..1.4).contains(&lean) && (0.0..0.8).contains(&spin_sense));
            assert!((0.8..1.4).contains(&descent));
        }
    }
}
