//! Orders are balanced, and cells are filled by who finishes.

use super::*;
use crate::session::{Event, Logged};
use proptest::prelude::*;
use std::collections::BTreeMap;

fn design(order: &str, conditions: usize) -> Design {
    let mut text = format!(
        "cohelm-study = 1\nname = \"s\"\ntitle = \"S\"\ncontact = \"c\"\nplanned-participants = 12\norder = \"{order}\"\n\
         [task]\nplant = \"point\"\n[terrain]\nseed = 1\n[consent]\nversion = \"1\"\ntext = \"t\"\n[primary]\nmeasure = \"success\"\n"
    );
    for index in 0..conditions {
        text += &format!("[[conditions]]\nname = \"c{index}\"\nrule = \"hic\"\nmeasured-episodes = 1\n");
    }
    Design::from_toml(&text).unwrap_or_else(|error| panic!("{error}"))
}

fn is_balanced_by_place(cells: &[Vec<usize>], conditions: usize) -> bool {
    let at = |place: usize, condition: usize| cells.iter().filter(|cell| cell[place] == condition).count();
    (0..conditions)
        .all(|place| (0..conditions).all(|condition| at(place, condition) == cells.len() / conditions))
}

/// How often each condition comes right after each other one.
fn successions(cells: &[Vec<usize>]) -> BTreeMap<(usize, usize), usize> {
    let mut counted = BTreeMap::new();
    for pair in cells.iter().flat_map(|cell| cell.windows(2)) {
        *counted.entry((pair[0], pair[1])).or_insert(0) += 1;
    }
    counted
}

#[test]
fn a_latin_square_has_each_condition_once_at_each_place() {
    for conditions in 1..=8 {
        let cells = cells(&design("latin-square", conditions));
        assert_eq!(cells.len(), conditions);
        assert!(is_balanced_by_place(&cells, conditions), "{conditions}");
    }
}

#[test]
fn a_williams_square_balances_what_follows_what() {
    for conditions in 1..=9 {
        let cells = cells(&design("williams", conditions));
        let rows = if conditions % 2 == 0 || conditions == 1 { conditions } else { 2 * conditions };
        assert_eq!(cells.len(), rows);
        assert!(is_balanced_by_place(&cells, conditions), "{conditions}");
        let counted = successions(&cells);
        assert_eq!(counted.len(), conditions * (conditions - 1), "every pair occurs");
        assert!(counted.values().all(|&times| times == rows / conditions), "{conditions}: {counted:?}");
    }
}

/// The square for four of Williams (1949), rows in the order in which it is usually printed: 0 1 3 2, 1 2 0 3, …
#[test]
fn the_square_of_four_is_williamss() {
    assert_eq!(cells(&design("williams", 4)), [[0, 1, 3, 2], [1, 2, 0, 3], [2, 3, 1, 0], [3, 0, 2, 1]]);
}

#[test]
fn fixed_is_the_files_order_and_random_is_drawn_from_the_seed() {
    assert_eq!(assign(&design("fixed", 3), &[], 99).order, [0, 1, 2]);
    let random = design("random", 4);
    let drawn: BTreeMap<Vec<usize>, usize> = (0..2400).fold(BTreeMap::new(), |mut counted, entropy| {
        *counted.entry(assign(&random, &[], entropy).order).or_insert(0) += 1;
        counted
    });
    assert_eq!(drawn.len(), 24, "every order occurs");
    // Each is expected 100 times with a standard deviation of 9.8; five of them either way is no chance.
    assert!(drawn.values().all(|times| (51..150).contains(times)), "{drawn:?}");
}

#[test]
fn those_who_are_at_it_share_the_cells_and_those_who_left_do_not() {
    let design = design("latin-square", 3);
    let tally = |finished, in_progress| CellTally { finished, in_progress };
    assert_eq!(next_cell(&design, &[tally(1, 0), tally(1, 0), tally(0, 0)], 5), 2);
    assert_eq!(
        next_cell(&design, &[tally(0, 1), tally(0, 1), tally(0, 0)], 5),
        2,
        "of equals, who is at it counts"
    );
    assert_eq!(
        next_cell(&design, &[tally(1, 0), tally(0, 1), tally(1, 0)], 5),
        1,
        "finished is surer than at it"
    );
    assert_eq!(
        next_cell(&design, &[tally(2, 0), tally(0, 9), tally(2, 0)], 5) % 2,
        0,
        "nine of them will hardly all fail"
    );
}

fn log(design: &Design, test: bool, simulated: bool, cell: usize, more: Vec<Event>) -> Session {
    let order = cells(design)[cell].clone();
    let begin = vec![
        Event::Invited { test, simulated, language: None, panel: BTreeMap::new(), note: None },
        Event::StepDone { step: "consent".into(), data: serde_json::json!({"agreed": true}), page_ms: None },
        Event::Assigned { cell, order, seed: 1, design: design.hash() },
    ];
    let events = begin.into_iter().chain(more).enumerate();
    let log: Vec<Logged> =
        events.map(|(index, event)| Logged { seq: index as u32 + 1, at_ms: 0, event }).collect();
    Session::fold(design, &log).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn test_excluded_withdrawn_and_simulated_participants_hold_no_place_among_people() {
    let design = design("latin-square", 2);
    let by = || "desk".to_owned();
    let people = [
        log(&design, false, false, 0, vec![]),
        log(&design, true, false, 1, vec![]),
        log(&design, false, true, 1, vec![]),
        log(&design, false, false, 1, vec![Event::Excluded { reason: "asleep".into(), by: by() }]),
        log(&design, false, false, 1, vec![Event::Withdrawn { by: by() }]),
    ];
    let seen = |at_ms: i64| people.iter().map(move |session| (session, at_ms));
    let at_it = |in_progress| CellTally { finished: 0, in_progress };
    assert_eq!(tallies(&design, seen(0), 60_000, false), [at_it(1), at_it(0)]);
    assert_eq!(
        tallies(&design, seen(0), 60_000, true),
        [at_it(0), at_it(1)],
        "bots are balanced among themselves"
    );
    let much_later = 60_000 * i64::from(design.drop_out_after_minutes);
    assert_eq!(
        tallies(&design, seen(0), much_later, false),
        [at_it(0), at_it(0)],
        "who is away so long left"
    );
}

proptest! {
    /// However many leave, and whoever they are: when as many have finished as fill the cells, no cell has more than one
    /// finisher more than another.
    #[test]
    fn drop_outs_are_replaced_in_their_cell(leaves in prop::collection::vec(any::<bool>(), 0..40), entropy: u64) {
        let design = design("williams", 3);
        let mut finished = vec![CellTally::default(); 6];
        for (index, leaves) in leaves.iter().enumerate() {
            let cell = next_cell(&design, &finished, entropy.wrapping_add(index as u64));
            finished[cell].finished += usize::from(!leaves);
        }
        let counts: Vec<usize> = finished.iter().map(|tally| tally.finished).collect();
        prop_assert!(counts.iter().max().unwrap() - counts.iter().min().unwrap() <= 1, "{counts:?}");
    }

    #[test]
    fn an_assignment_is_a_permutation_and_its_seed_fits_every_language(entropy: u64, conditions in 1usize..7) {
        for order in ["latin-square", "williams", "random", "fixed"] {
            let design = design(order, conditions);
            let given = assign(&design, &[], entropy);
            let mut sorted = given.order.clone();
            sorted.sort_unstable();
            prop_assert!(sorted.into_iter().eq(0..conditions));
            prop_assert!(given.cell < cells(&design).len());
            prop_assert!(given.seed <= cohelm::trajectory::MAX_SEED);
            prop_assert_eq!(assign(&design, &[], entropy), given);
        }
    }
}
