//! The three moving bodies: what they are made of, where they are, how they move.

use std::sync::LazyLock;

use super::shape::Polygon;
use super::tuning::{BOX_LOOKAHEAD, BOX_MARGIN};
use super::vector::{Aabb, Rotation, Transform, Vec2, vec2};

/// Pixels that Gymnasium draws for one world unit; its constants are written in pixels.
pub const SCALE: f64 = 30.0;
/// Corners of the hull around its own position, counter-clockwise, in world units: what a page draws.
pub const HULL_OUTLINE: [[f64; 2]; 6] = [
    [17.0 / SCALE, -10.0 / SCALE],
    [17.0 / SCALE, 0.0],
    [14.0 / SCALE, 17.0 / SCALE],
    [-14.0 / SCALE, 17.0 / SCALE],
    [-17.0 / SCALE, 0.0],
    [-17.0 / SCALE, -10.0 / SCALE],
];
/// Corners of a leg around its own position, counter-clockwise, in world units.
pub const LEG_OUTLINE: [[f64; 2]; 4] = [
    [-2.0 / SCALE, -8.0 / SCALE],
    [2.0 / SCALE, -8.0 / SCALE],
    [2.0 / SCALE, 8.0 / SCALE],
    [-2.0 / SCALE, 8.0 / SCALE],
];
/// Distance of a leg's hinge from the leg's own position, sideways, world units.
pub(crate) const LEG_AWAY: f64 = 20.0 / SCALE;
/// The same upwards.
pub(crate) const LEG_DOWN: f64 = 18.0 / SCALE;
/// How far a leg is turned inwards when the craft is made; its hinge counts angles from there.
pub(crate) const LEG_START_RAD: f64 = 0.05;

/// Index of the hull among the bodies.
pub(crate) const HULL: usize = 0;
/// Indices of the legs, in the order in which Gymnasium makes them.
pub(crate) const LEGS: [usize; 2] = [1, 2];
/// Hull and legs.
pub(crate) const BODIES: usize = 3;

/// What never changes of a body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    pub shape: Polygon,
    pub friction: f32,
    pub inverse_mass: f32,
    pub inverse_inertia: f32,
    /// Centre of mass in the body's frame.
    pub local_center: Vec2,
}

static PARTS: LazyLock<[Part; BODIES]> = LazyLock::new(|| {
    let hull = Polygon::new(&HULL_OUTLINE.map(|[x, y]| vec2(x as f32, y as f32)));
    let [half_width, half_height] = LEG_OUTLINE[2];
    let leg = Polygon::rectangle(half_width as f32, half_height as f32);
    let leg = Part::new(leg, 1.0, 0.2);
    [Part::new(hull, 5.0, 0.1), leg.clone(), leg]
});

/// Hull, leg, leg.
pub(crate) fn parts() -> &'static [Part; BODIES] {
    &PARTS
}

impl Part {
    fn new(shape: Polygon, density: f32, friction: f32) -> Part {
        let data = shape.mass_data(density);
        let inverse_mass = 1.0 / data.mass;
        let local_center = inverse_mass * (data.mass * data.center);
        let inertia = data.inertia - data.mass * local_center.dot(local_center);
        Part { shape, friction, inverse_mass, inverse_inertia: 1.0 / inertia, local_center }
    }
}

/// The motion of a centre of mass over one step: from (c0, a0) at time `alpha0` of the step to (c, a) at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sweep {
    pub local_center: Vec2,
    pub c0: Vec2,
    pub c: Vec2,
    pub a0: f32,
    pub a: f32,
    pub alpha0: f32,
}

impl Sweep {
    /// Moves the beginning on to `alpha`. Box2D 2.3.0's formula: 2.3.1's has other bits.
    pub fn advance(&mut self, alpha: f32) {
        let beta = (alpha - self.alpha0) / (1.0 - self.alpha0);
        (self.c0, self.a0) = self.between(beta);
        self.alpha0 = alpha;
    }

    /// Position and angle at the share `beta` of what is left of the motion.
    fn between(&self, beta: f32) -> (Vec2, f32) {
        ((1.0 - beta) * self.c0 + beta * self.c, (1.0 - beta) * self.a0 + beta * self.a)
    }

    /// Where the body's frame is at the share `beta` of the motion.
    pub fn transform(&self, beta: f32) -> Transform {
        let (center, angle) = self.between(beta);
        Transform::about_center(center, Rotation::of(angle), self.local_center)
    }

    /// The same motion with the first angle in [0, 2π).
    pub fn normalized(mut self) -> Sweep {
        const TURN: f32 = 2.0 * std::f32::consts::PI;
        let turns = TURN * (self.a0 / TURN).floor();
        self.a0 -= turns;
        self.a -= turns;
        self
    }
}

/// A moving body. Its transform always belongs to the end of its sweep.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Body {
    pub sweep: Sweep,
    pub place: Transform,
    pub velocity: Vec2,
    pub omega: f32,
    /// Gathered until the next step, then forgotten.
    pub force: Vec2,
    /// See `force`.
    pub torque: f32,
    pub awake: bool,
    /// How long it has been still, seconds.
    pub still_s: f32,
    /// Box of the broad phase, wider than the shape so that it seldom changes.
    pub wide_box: Aabb,
    /// Whether that box has changed since the last search for contacts.
    pub box_moved: bool,
}

impl Body {
    /// At rest, its frame at (x, y).
    pub fn at(part: &Part, x: f64, y: f64, angle_rad: f64) -> Body {
        let angle = angle_rad as f32;
        let place = Transform { origin: vec2(x as f32, y as f32), rotation: Rotation::of(angle) };
        let center = place.apply(part.local_center);
        Body {
            sweep: Sweep {
                local_center: part.local_center,
                c0: center,
                c: center,
                a0: angle,
                a: angle,
                alpha0: 0.0,
            },
            place,
            velocity: Vec2::ZERO,
            omega: 0.0,
            force: Vec2::ZERO,
            torque: 0.0,
            awake: true,
            still_s: 0.0,
            wide_box: part.shape.aabb(place).widened(BOX_MARGIN),
            box_moved: true,
        }
    }

    /// Waking starts the count of stillness anew; a body that is awake is left as it is.
    pub fn wake(&mut self) {
        if !self.awake {
            self.awake = true;
            self.still_s = 0.0;
        }
    }

    pub fn put_to_sleep(&mut self) {
        self.awake = false;
        self.still_s = 0.0;
        self.velocity = Vec2::ZERO;
        self.omega = 0.0;
        self.force = Vec2::ZERO;
        self.torque = 0.0;
    }

    /// Changes the velocity at once by an impulse that acts at `point` (world frame); wakes the body.
    pub fn push(&mut self, part: &Part, impulse: Vec2, point: Vec2) {
        self.wake();
        self.velocity += part.inverse_mass * impulse;
        self.omega += part.inverse_inertia * (point - self.sweep.c).cross(impulse);
    }

    /// Puts the transform where the sweep ends.
    pub fn settle(&mut self) {
        self.place =
            Transform::about_center(self.sweep.c, Rotation::of(self.sweep.a), self.sweep.local_center);
    }

    /// Goes back along the sweep to `alpha` and makes that its end.
    pub fn rewind(&mut self, alpha: f32) {
        self.sweep.advance(alpha);
        self.sweep.c = self.sweep.c0;
        self.sweep.a = self.sweep.a0;
        self.settle();
    }

    /// Widens the broad phase's box if the shape has left it anywhere along the sweep, which began with this rotation.
    pub fn refresh_box(&mut self, part: &Part, before: Rotation) {
        let sweep = &self.sweep;
        let before = Transform::about_center(sweep.c0, before, sweep.local_center);
        let swept = part.shape.aabb(before).joined(part.shape.aabb(self.place));
        if self.wide_box.contains(swept) {
            return;
        }
        self.wide_box =
            stretched(swept.widened(BOX_MARGIN), BOX_LOOKAHEAD * (self.place.origin - before.origin));
        self.box_moved = true;
    }
}

/// The box, longer by `ahead` on the sides that it points to.
fn stretched(mut wide: Aabb, ahead: Vec2) -> Aabb {
    let side = |v: f32| if v < 0.0 { (v, 0.0) } else { (0.0, v) };
    let ((left, right), (down, up)) = (side(ahead.x), side(ahead.y));
    wide.lower += vec2(left, down);
    wide.upper += vec2(right, up);
    wide
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `body.massData`, `shape.centroid` and `shape.normals` of pybox2d 2.3.10 for Gymnasium's lander and legs. Box2D reports
    /// the inertia about the body's origin, so it is put together again from the one about the centre of mass.
    #[test]
    fn masses_are_those_of_box2d() {
        let wide = |v: Vec2| [f64::from(v.x), f64::from(v.y)];
        let [hull, leg, _] = parts();
        let data = hull.shape.mass_data(5.0);
        let shift = data.mass * hull.local_center.dot(hull.local_center);
        assert_eq!(f64::from(data.mass), 4.816666603088379);
        assert_eq!(f64::from((data.inertia - shift) + shift), 0.8333148956298828);
        assert_eq!(wide(hull.local_center), [0.0, 0.10130719095468521]);
        assert_eq!(wide(hull.shape.centroid), [3.867083098185731e-09, 0.10130717605352402]);
        assert_eq!(wide(hull.shape.normals()[1]), [0.9847835898399353, 0.17378532886505127]);
        assert_eq!(wide(hull.shape.normals()[3]), [-0.9847835898399353, 0.17378532886505127]);
        let data = leg.shape.mass_data(1.0);
        assert_eq!(f64::from(data.mass), 0.07111112028360367);
        assert_eq!(f64::from(data.inertia), 0.0017909470479935408);
        assert_eq!(leg.local_center, Vec2::ZERO);
    }
}
