//! Pieces that fit are followed to the same record; pieces that do not are told apart.

use super::*;
use crate::testing::{Page, flight, flown, setup};
use cohelm::keys::Change;
use proptest::prelude::*;

fn follower(seed: u64) -> Follower {
    Follower::new(flight(setup(seed)))
}

#[test]
fn a_flight_is_followed_piece_by_piece_to_the_same_record() {
    let (mut page, mut follower) = (Page::new(setup(4)), follower(4));
    while !page.ended() {
        let chunk = page.fly(50);
        assert_eq!(follower.follow(&chunk), Ok(Some(chunk)));
    }
    assert_eq!(follower.land(page.end()), Ok(flown(4)));
}

#[test]
fn a_piece_that_comes_twice_changes_nothing_and_an_overlap_is_flown_once() {
    let (mut page, mut follower) = (Page::new(setup(4)), follower(4));
    let first = page.fly(50);
    follower.follow(&first).unwrap();
    assert_eq!(follower.follow(&first), Ok(None));
    page.fly(30);
    let overlapping = page.piece_since(20);
    let new = follower.follow(&overlapping).unwrap().unwrap();
    assert_eq!((new.from_tick, new.to_tick), (50, 80));
    assert_eq!(new.events, page.piece_since(50).events);
}

#[test]
fn a_missing_piece_is_a_gap_after_which_the_log_may_be_sent_again() {
    let (mut page, mut follower) = (Page::new(setup(4)), follower(4));
    let first = page.fly(50);
    let second = page.fly(50);
    assert_eq!(follower.follow(&second), Err(Disbelief::Gap { from_tick: 50, flown: 0 }));
    assert!(follower.follow(&first).is_ok() && follower.follow(&second).is_ok());
}

/// What a follower says to one piece that was changed.
fn said_to(change: impl FnOnce(&mut Chunk)) -> Result<Option<Chunk>, Disbelief> {
    let mut chunk = Page::new(setup(4)).fly(60);
    change(&mut chunk);
    follower(4).follow(&chunk)
}

#[test]
fn each_way_of_not_fitting_has_its_own_words() {
    let event = |tick| {
        let mut bytes = Vec::new();
        put_event(&mut bytes, &KeyEvent { tick, change: Change::Down(0), at_ms: 0.0 });
        bytes
    };
    assert_eq!(said_to(|chunk| chunk.digests.plant ^= 1), Err(Disbelief::Plant { tick: 60 }));
    assert_eq!(said_to(|chunk| chunk.digests.decisions ^= 1), Err(Disbelief::Decisions { tick: 60 }));
    assert_eq!(said_to(|chunk| chunk.events.clear()), Err(Disbelief::Plant { tick: 60 }));
    assert!(matches!(said_to(|chunk| chunk.to_tick = 0), Err(Disbelief::Span { .. })));
    assert!(matches!(said_to(|chunk| chunk.to_tick = 3_001), Err(Disbelief::Span { .. })));
    assert!(matches!(said_to(|chunk| chunk.to_tick = 3_000), Err(Disbelief::Over { .. })));
    assert!(matches!(said_to(|chunk| chunk.events.truncate(3)), Err(Disbelief::Events(_))));
    let late = said_to(|chunk| chunk.events.extend(event(60)));
    assert_eq!(late, Err(Disbelief::Misplaced { tick: 60, from_tick: 0, to_tick: 60 }));
    let unordered = said_to(|chunk| chunk.events.extend(event(1)));
    assert_eq!(unordered, Err(Disbelief::Misplaced { tick: 1, from_tick: 0, to_tick: 60 }));
}

#[test]
fn an_end_that_differs_is_not_believed() {
    let land = |ticks, change: fn(&mut End)| {
        let (mut page, mut follower) = (Page::new(setup(4)), follower(4));
        follower.follow(&page.fly(ticks)).unwrap();
        let mut end = page.end();
        change(&mut end);
        follower.land(end).map(|flown| flown.ending)
    };
    assert_eq!(land(60, |_| {}), Ok(Ending::Abandoned));
    assert_eq!(land(60, |end| end.ticks += 1), Err(Disbelief::Length { said: 61, flown: 60 }));
    let unfinished = Disbelief::Ending { said: Ending::Goal, found: None };
    assert_eq!(land(60, |end| end.ending = Ending::Goal), Err(unfinished));
    let ending = flown(4).ending;
    let abandoned = Disbelief::Ending { said: Ending::Abandoned, found: Some(ending) };
    assert_eq!(land(2_000, |end| end.ending = Ending::Abandoned), Err(abandoned));
    assert!(matches!(land(2_000, |end| end.digests.plant += 1), Err(Disbelief::Plant { .. })));
}

#[test]
fn a_log_cannot_hold_more_events_than_an_episode() {
    let mut follower = follower(4);
    let mut events = Vec::new();
    for _ in 0..=MAX_EVENTS {
        put_event(&mut events, &KeyEvent { tick: 0, change: Change::Down(0), at_ms: 0.0 });
    }
    let chunk = Chunk { from_tick: 0, to_tick: 1, digests: Default::default(), events };
    assert!(matches!(follower.follow(&chunk), Err(Disbelief::Events(_) | Disbelief::TooManyEvents)));
}

proptest! {
    /// However the log is cut into pieces, what is stored of it is the same flight.
    #[test]
    fn any_cut_gives_the_same_record(cuts in prop::collection::vec((1_u32..200, 0_u32..60), 1..12)) {
            let (mut page, mut follower) = (Page::new(setup(9)), follower(9));
            let mut stored = Vec::new();
            let mut cuts = cuts.into_iter().chain(std::iter::repeat((100, 0)));
            while !page.ended() {
                let (ticks, again) = cuts.next().unwrap();
                let from_tick = page.fly(ticks).from_tick.saturating_sub(again);
                stored.extend(follower.follow(&page.piece_since(from_tick)).unwrap());
            }
            assert_eq!(follower.land(page.end()), Ok(flown(9)));
            let mut again = self::follower(9);
            stored.iter().for_each(|chunk| assert_eq!(again.follow(chunk), Ok(Some(chunk.clone()))));
            assert_eq!(again.land(page.end()), Ok(flown(9)));
    }
}
