//! Many of Gymnasium's landers in one call: the physics of several at once in vector registers.
//!
//! Every world has the bits that it has alone; which worlds are stepped together changes nothing but the time it takes.
//!
//! ```
//! use cohelm_lander::gymnasium::{Action, GymnasiumLander, Order};
//! use cohelm_lander::together::tick;
//!
//! let mut worlds = vec![GymnasiumLander::usual(); 16];
//! let mut alone = worlds[5].clone();
//! let mut outcomes = tick(&mut worlds, &[Some(Order::Step(Action::Main)); 16]);
//! assert_eq!(outcomes.remove(5), Some(alone.step(Action::Main)));
//! ```

use crate::craft::Craft;
use crate::gymnasium::{GymnasiumLander, Order, Outcome};

/// Worlds that fill the widest vector registers: as many or a multiple in one call take the least time each.
pub const WORLDS: usize = 32;

/// One tick of every world that has an order; the others stand still. What a reset brings has no reward and no ending.
///
/// # Panics
/// If there are not as many orders as worlds.
pub fn tick(worlds: &mut [GymnasiumLander], orders: &[Option<Order>]) -> Vec<Option<Outcome>> {
    assert_eq!(worlds.len(), orders.len(), "one order a world");
    for (world, order) in worlds.iter_mut().zip(orders) {
        order.iter().for_each(|order| world.begin_tick(*order));
    }
    let flying = worlds.iter_mut().zip(orders).filter(|(_, order)| order.is_some());
    Craft::coast_together(flying.map(|(world, _)| world.craft_mut()));
    worlds.iter_mut().zip(orders).map(|(world, order)| order.map(|order| world.end_tick(order))).collect()
}
