//! The loop of shared control, and its words.
//!
//! > The **pilot** asks for an action; the co-pilot infers the pilot's **intent**, estimates the **value** of every
//! > action for it, and **arbitration** decides which action reaches the **plant**.
//!
//! | module | the noun it explains |
//! |---|---|
//! | [`plant`] | what is steered: its state, goals, endings and optional capabilities |
//! | [`action`] | one action, and the sets of actions a plant may take |
//! | [`pilot`] | who asks: a person at keys, or a model of one |
//! | [`human`] | a person, simulated, over the skill that a plant supplies |
//! | [`impaired`] | pilots that know every value, made to lag or stray |
//! | [`keys`] | from keys and sticks to one request a tick |
//! | [`intent`] | which goal the pilot wants, and how sure that is |
//! | [`value`] | what every action is worth for that goal |
//! | [`arbitration`] | the rules that choose the action to carry out |
//! | [`cockpit`] | the five together: one [`cockpit::Cockpit::tick`] |
//! | [`flight`] | an episode flown by keys, as the page flies it and the server follows it |
//! | [`trajectory`] | the record of an episode, its bytes and its digest |
//! | [`branch`] | what if: a recorded episode, flown on under another cockpit |
//! | [`steering`] | a plane's two directions, by levers or by axes |
//! | [`tape`] | what was seen of a plant that is elsewhere, in place of its physics |
//! | [`scene`] | what a plant looks like, for whoever draws it |
//! | [`registry`] | plants by name |
//! | [`report`] | an opening and one report a tick, for whoever shows a flight |
//! | [`random`] | draws from a seed |
//! | [`laws`] | what every plant must keep, for the tests of whoever writes one |
//! | [`point`] | the smallest plant: a point and two goals |
//!
//! This crate does no input or output, knows no clock, no network and no lander, and draws no random number from a
//! seed that it was not handed. Nothing fails inside a tick: what could be wrong is refused where it is made.
#![forbid(unsafe_code)]

pub mod action;
mod ahead;
pub mod arbitration;
pub mod branch;
pub mod cockpit;
pub mod flight;
pub mod human;
pub mod impaired;
pub mod intent;
pub mod keys;
pub mod laws;
pub mod pilot;
pub mod plant;
pub mod point;
pub mod random;
pub mod registry;
pub mod report;
pub mod scene;
pub mod steering;
pub mod tape;
pub mod trajectory;
pub mod value;
