//! What may come from elsewhere: sizes within bounds, numbers that are finite, actions that can be pressed.

use super::{Described, MAX_MAGNITUDE, MAX_MOVABLE, MAX_STATE, Seen, TapeError};
use crate::action::ActionSpace;
use crate::intent::MAX_GOALS;
use crate::scene::{Part, Scene, Shape};
use std::fmt::Display;
use std::ops::RangeInclusive;

/// Longest name of anything, bytes.
const MAX_NAME: usize = 64;
/// Most parts that stand still.
const MAX_FIXED: usize = 256;
/// Most points of all outlines together.
const MAX_POINTS: usize = 20_000;
/// Largest magnitude of a coordinate to draw, world units.
const MAX_WORLD: f32 = 1e6;
/// Largest magnitude of a reward.
const MAX_REWARD: f64 = 1e6;
/// Most commands of a space: records keep two more numbers for themselves.
const MAX_COMMANDS: usize = 254;
/// Ticks a second: fewer are no control loop, more are beyond what keys and pages do.
const TICKS_PER_SECOND: RangeInclusive<f64> = 1.0..=200.0;

type Sound = Result<(), TapeError>;

pub(super) fn wrong(what: impl Display, expected: impl Display, found: impl Display) -> TapeError {
    TapeError::Bounds { what: what.to_string(), expected: expected.to_string(), found: found.to_string() }
}

/// The description of a plant.
pub(super) fn description(about: &Described) -> Sound {
    name("name", &about.name)?;
    rate(about.ticks_per_second)?;
    space(&about.space)?;
    scene(&about.scene)
}

/// A rate at which a plant can be driven.
pub(super) fn rate(ticks_per_second: f64) -> Sound {
    if TICKS_PER_SECOND.contains(&ticks_per_second) {
        return Ok(());
    }
    Err(wrong("ticks_per_second", "1 to 200", ticks_per_second))
}

/// What was seen of a plant of that description.
pub(super) fn seen(about: &Described, seen: &Seen) -> Sound {
    count("the state", "numbers", seen.state.len(), 1..=MAX_STATE)?;
    seen.state.iter().try_for_each(|&x| within("a number of the state", x, MAX_MAGNITUDE))?;
    seen.position.iter().try_for_each(|&x| within("the position", x, MAX_MAGNITUDE))?;
    let bits = about.space.switch_count();
    if u32::from(seen.switches) >> bits != 0 {
        return Err(wrong("switches", format!("{bits} bits"), seen.switches));
    }
    count("goals", "goals", seen.goals.len(), 1..=MAX_GOALS)?;
    for (i, goal) in seen.goals.iter().enumerate() {
        goal.position.iter().try_for_each(|&x| within("a goal's position", x, MAX_MAGNITUDE))?;
        if seen.goals[..i].iter().any(|other| other.id == goal.id) {
            return Err(wrong("the ids of goals", "different", format!("{} twice", goal.id)));
        }
    }
    if !seen.goals.iter().any(|goal| goal.id == about.pilot_goal) {
        let ids: Vec<u32> = seen.goals.iter().map(|goal| goal.id).collect();
        return Err(wrong("pilot_goal", format!("the id of a goal, one of {ids:?}"), about.pilot_goal));
    }
    let movable = about.scene.movable.len();
    count("poses", "poses, one a movable part", seen.poses.len(), movable..=movable)?;
    for pose in &seen.poses {
        [pose.x, pose.y, pose.angle_rad].into_iter().try_for_each(|x| within("a pose", x, MAX_WORLD))?;
        if !(0.0..=1.0).contains(&pose.strength) {
            return Err(wrong("a pose's strength", "0 to 1", pose.strength));
        }
    }
    if seen.reward.is_finite() && seen.reward.abs() <= MAX_REWARD {
        return Ok(());
    }
    Err(wrong("the reward", "a finite number of at most 1000000 either way", seen.reward))
}

/// A space whose actions can all be pressed, carried out and recorded.
fn space(space: &ActionSpace) -> Sound {
    match space {
        ActionSpace::Switches { switches } => {
            count("space", "switches", switches.len(), 1..=8)?;
            names(switches.iter().map(|switch| &switch.name))
        }
        ActionSpace::Levers { levers } => {
            count("space", "levers", levers.len(), 1..=8)?;
            for lever in levers {
                count("a lever", "positions", lever.positions.len(), 1..=MAX_COMMANDS)?;
                names(lever.positions.iter())?;
                if usize::from(lever.neutral) >= lever.positions.len() {
                    return Err(wrong(
                        "a lever's neutral",
                        "the index of one of its positions",
                        lever.neutral,
                    ));
                }
            }
            let commands =
                levers.iter().try_fold(1_usize, |product, lever| product.checked_mul(lever.positions.len()));
            count("space", "composed commands", commands.unwrap_or(usize::MAX), 1..=MAX_COMMANDS)?;
            names(levers.iter().map(|lever| &lever.name))
        }
        ActionSpace::Single { names: called, pushes } => {
            count("space", "commands", called.len(), 1..=MAX_COMMANDS)?;
            count("space", "pushes, one a command", pushes.len(), called.len()..=called.len())?;
            names(called.iter())
        }
        ActionSpace::Axes { names: called, low, high } => {
            let axes = called.len();
            count("space", "axes", axes, 1..=4)?;
            count("space", "lowest values, one an axis", low.len(), axes..=axes)?;
            count("space", "highest values, one an axis", high.len(), axes..=axes)?;
            for (&low, &high) in low.iter().zip(high) {
                [low, high].into_iter().try_for_each(|x| within("the end of an axis", x, MAX_MAGNITUDE))?;
                if !(low <= 0.0 && 0.0 <= high && low < high) {
                    return Err(wrong("an axis", "from at most 0 to at least 0", format!("{low} to {high}")));
                }
            }
            names(called.iter())
        }
    }
}

fn scene(scene: &Scene) -> Sound {
    let Scene { bounds: [left, bottom, right, top], fixed, movable, origin, scale } = scene;
    for &x in [left, bottom, right, top].into_iter().chain(origin).chain(scale) {
        within("a number of the scene", x, MAX_WORLD)?;
    }
    if !(left < right && bottom < top) {
        let found = format!("[{left}, {bottom}, {right}, {top}]");
        return Err(wrong(
            "the scene's bounds",
            "[left, bottom, right, top] with left < right and bottom < top",
            found,
        ));
    }
    count("the scene", "fixed parts", fixed.len(), 0..=MAX_FIXED)?;
    count("the scene", "movable parts", movable.len(), 1..=MAX_MOVABLE)?;
    let shapes = || fixed.iter().chain(movable).flat_map(|part: &Part| &part.shapes);
    count("the scene", "points", shapes().map(|shape| points(shape).len()).sum(), 0..=MAX_POINTS)?;
    if let Some(none) = scale.iter().find(|part| **part == 0.0) {
        return Err(wrong("the scene's scale", "other than 0", none));
    }
    for shape in shapes() {
        count("an outline of the scene", "points", points(shape).len(), 1..=MAX_POINTS)?;
        points(shape).iter().flatten().try_for_each(|&x| within("a point of the scene", x, MAX_WORLD))?;
        if let Shape::Disc { radius, .. } = shape {
            // The page draws each disc as an arc, and one of a negative radius is an error in every picture.
            if !(0.0..=MAX_WORLD).contains(radius) {
                return Err(wrong("a disc's radius", format!("0 to {MAX_WORLD}"), radius));
            }
        }
    }
    Ok(())
}

fn points(shape: &Shape) -> &[[f32; 2]] {
    match shape {
        Shape::Polygon { points } | Shape::Line { points } => points,
        Shape::Disc { center, .. } => std::slice::from_ref(center),
    }
}

fn name(what: &str, text: &str) -> Sound {
    if text.is_empty() || text.len() > MAX_NAME || text.chars().any(char::is_control) {
        let found = format!("{:?}", text.chars().take(MAX_NAME).collect::<String>());
        return Err(wrong(what, format!("1 to {MAX_NAME} bytes of text"), found));
    }
    Ok(())
}

fn names<'a>(mut called: impl Iterator<Item = &'a String>) -> Sound {
    called.try_for_each(|text| name("a name in the space", text))
}

fn within(what: &str, value: f32, most: f32) -> Sound {
    if value.is_finite() && value.abs() <= most {
        return Ok(());
    }
    Err(wrong(what, format!("a finite number of at most {most} either way"), value))
}

fn count(what: &str, unit: &str, found: usize, allowed: RangeInclusive<usize>) -> Sound {
    if allowed.contains(&found) {
        return Ok(());
    }
    let (least, most) = (allowed.start(), allowed.end());
    let expected =
        if least == most { format!("{least} {unit}") } else { format!("{least} to {most} {unit}") };
    Err(wrong(what, expected, found))
}
