//! The constants of Box2D 2.3.0 that the lander's scene meets, in metres, seconds, radians. Parity fixes each of them:
//! they are gathered here to be read, not to be tuned.

/// Overlap and joint error that is left alone, so that resting contacts do not flicker. Less would jitter, more would sink visibly.
pub(crate) const LINEAR_SLOP: f32 = 0.005;
/// The same for angles: 2°.
pub(crate) const ANGULAR_SLOP: f32 = 2.0 / 180.0 * std::f32::consts::PI;
/// Skin around every polygon and edge: contact begins before shapes overlap.
pub(crate) const SKIN: f32 = 2.0 * LINEAR_SLOP;
/// How much wider the broad phase's boxes are than the shapes: more means fewer updates and more idle pairs.
pub(crate) const BOX_MARGIN: f32 = 0.1;
/// The broad phase's boxes reach this many displacements ahead.
pub(crate) const BOX_LOOKAHEAD: f32 = 2.0;
/// Largest position correction in one iteration: keeps deep overlaps from exploding.
pub(crate) const MAX_LINEAR_CORRECTION: f32 = 0.2;
/// The same for angles: 8°.
pub(crate) const MAX_ANGULAR_CORRECTION: f32 = 8.0 / 180.0 * std::f32::consts::PI;
/// Largest shift of a body in one step.
pub(crate) const MAX_TRANSLATION: f32 = 2.0;
/// Largest turn of a body in one step.
pub(crate) const MAX_ROTATION: f32 = 0.5 * std::f32::consts::PI;
/// Share of the overlap removed in one position iteration.
pub(crate) const BAUMGARTE: f32 = 0.2;
/// The same after a time of impact.
pub(crate) const TOI_BAUMGARTE: f32 = 0.75;
/// Times of impact that one contact may have in a step.
pub(crate) const MAX_SUB_STEPS: u8 = 8;
/// Position iterations after a time of impact.
pub(crate) const TOI_POSITION_ITERATIONS: u32 = 20;
/// A body must be still for this long before it sleeps.
pub(crate) const TIME_TO_SLEEP_S: f32 = 0.5;
/// Slower than this counts as still, units/s.
pub(crate) const SLEEP_SPEED: f32 = 0.01;
/// Turning slower than this counts as still, rad/s.
pub(crate) const SLEEP_SPIN: f32 = 2.0 / 180.0 * std::f32::consts::PI;
/// Two contact points whose equations are worse conditioned than this are solved as one.
pub(crate) const MAX_CONDITION_NUMBER: f32 = 1000.0;
/// Corners a polygon may have in the reference (pybox2d's build; stock Box2D has 8). It bounds one loop of the time of impact.
pub(crate) const MAX_POLYGON_CORNERS: u32 = 16;
