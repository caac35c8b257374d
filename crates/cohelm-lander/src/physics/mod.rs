//! The rigid bodies of the lander: Box2D 2.3.0's arithmetic for one scene, written anew.
//!
//! The methods are Erin Catto's, as in his engine Box2D (2.3.0, zlib licence): sequential impulses with warm starting, a block
//! solver for two-point contacts, separating axes and clipping for contact points, conservative advancement for times of
//! impact. What the scene does not need is absent: moving grounds, sensors, bullets, bouncing, damping, several islands,
//! collisions among bodies. Same operations in the same order, so same bits.

mod angle;
pub(crate) mod body;
mod contact;
mod contact_row;
mod continuous;
mod distance;
pub(crate) mod ground;
mod hinge;
mod hinge_row;
mod impact;
mod island;
mod lanes;
mod manifold;
#[cfg(feature = "lanes")]
mod packed;
mod position;
mod relax;
mod shape;
#[cfg(feature = "lanes")]
pub(crate) mod together;
mod tuning;
pub(crate) mod vector;
pub(crate) mod world;
