//! Who flies the conditions in which order: cells of orders, filled by who finished.

use super::{Design, Order};
use crate::session::{Session, Status};
use serde::{Deserialize, Serialize};

/// The order that one participant was given, and what everything random about their session is drawn from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Assignment {
    /// Index into [`cells`].
    pub cell: usize,
    /// The conditions in the order flown, as indices into [`Design::conditions`].
    pub order: Vec<usize>,
    /// At most 2⁵³; nobody but the server knows it before the session is over.
    pub seed: u64,
}

/// How full a cell is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellTally {
    /// Participants who finished and count.
    pub finished: usize,
    /// Participants who are at it and were seen lately, see [`tallies`].
    pub in_progress: usize,
}

/// The orders that are balanced against each other. Under [`Order::Random`] there is one cell, since orders are drawn.
pub fn cells(design: &Design) -> Vec<Vec<usize>> {
    let conditions = design.conditions.len();
    match design.order {
        Order::LatinSquare => latin_square(conditions),
        Order::Williams => williams(conditions),
        Order::Random | Order::Fixed => vec![(0..conditions).collect()],
    }
}

/// The cell for the next participant: the one with the fewest who finished or are at it; of equals the one with the
/// fewest who finished; of equals again one drawn from the seed.
///
/// Somebody who is at it is expected to finish, otherwise twenty people who come at once would all get the order that
/// nobody has finished yet. Who stays away longer than [`Design::drop_out_after_minutes`] is expected no more, and the
/// place is given to somebody else: in the end cells are filled by who finished.
pub fn next_cell(design: &Design, tallies: &[CellTally], seed: u64) -> usize {
    let cells = cells(design).len();
    let fullness = |cell: usize| {
        let tally = tallies.get(cell).copied().unwrap_or_default();
        (tally.finished + tally.in_progress, tally.finished)
    };
    let emptiest = (0..cells).map(fullness).min().unwrap_or_default();
    let candidates: Vec<usize> = (0..cells).filter(|&cell| fullness(cell) == emptiest).collect();
    candidates[(draw(seed, "cell", 0) % candidates.len() as u64) as usize]
}

/// The order for the next participant. `entropy` is fresh randomness from the operating system.
pub fn assign(design: &Design, tallies: &[CellTally], entropy: u64) -> Assignment {
    let seed = entropy & ((1 << 53) - 1);
    let cell = next_cell(design, tallies, seed);
    let order = match design.order {
        Order::Random => shuffled(design.conditions.len(), seed),
        _ => cells(design).swap_remove(cell),
    };
    Assignment { cell, order, seed }
}

/// How full each cell is. `people` are all sessions of the design, each with the time it was last heard of. Test
/// participants, the excluded and the withdrawn never count. Simulated participants count only among their own kind, and
/// people only among people.
pub fn tallies<'a>(
    design: &Design,
    people: impl IntoIterator<Item = (&'a Session, i64)>,
    now_ms: i64,
    simulated: bool,
) -> Vec<CellTally> {
    let mut tallies = vec![CellTally::default(); cells(design).len()];
    let patience_ms = i64::from(design.drop_out_after_minutes) * 60_000;
    for (session, last_seen_ms) in people {
        let counts = !session.is_test() && session.is_simulated() == simulated;
        let Some(tally) =
            session.assignment().and_then(|given| tallies.get_mut(given.cell)).filter(|_| counts)
        else {
            continue;
        };
        match session.status() {
            Status::Completed => tally.finished += 1,
            Status::UnderWay if now_ms - last_seen_ms < patience_ms => tally.in_progress += 1,
            _ => {}
        }
    }
    tallies
}

/// Each condition once at each place.
fn latin_square(conditions: usize) -> Vec<Vec<usize>> {
    (0..conditions).map(|row| (0..conditions).map(|place| (row + place) % conditions).collect()).collect()
}

/// Williams (1949): 0, 1, n−1, 2, n−2, … and the same shifted; for an odd number of conditions also each of these
/// backwards. Every condition then follows every other one equally often.
fn williams(conditions: usize) -> Vec<Vec<usize>> {
    let first: Vec<usize> =
        (0..conditions)
            .map(|place| {
                if place % 2 == 1 { place.div_ceil(2) } else { (conditions - place / 2) % conditions.max(1) }
            })
            .collect();
    let shifted =
        |by: usize| first.iter().map(|&condition| (condition + by) % conditions).collect::<Vec<_>>();
    let mut rows: Vec<Vec<usize>> = (0..conditions).map(shifted).collect();
    if conditions % 2 == 1 && conditions > 1 {
        let backwards: Vec<Vec<usize>> = rows.iter().map(|row| row.iter().rev().copied().collect()).collect();
        rows.extend(backwards);
    }
    rows
}

/// Fisher and Yates, each draw from the seed.
fn shuffled(conditions: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..conditions).collect();
    for last in (1..conditions).rev() {
        order.swap(last, (draw(seed, "order", last as u64) % (last as u64 + 1)) as usize);
    }
    order
}

/// 64 bits that a seed, a purpose and a number fix.
pub(crate) fn draw(seed: u64, purpose: &str, number: u64) -> u64 {
    use sha2::{Digest, Sha256};
    let digest = Sha256::new()
        .chain_update(b"cohelm study ")
        .chain_update(purpose.as_bytes())
        .chain_update([0])
        .chain_update(seed.to_le_bytes())
        .chain_update(number.to_le_bytes())
        .finalize();
    u64::from_le_bytes(std::array::from_fn(|byte| digest[byte]))
}

#[cfg(test)]
mod tests;
