//! What every store must do for flights and models.

use crate::store::*;
use crate::testing::{Page as PageOfTests, flown, key, record, setup};
use cohelm::plant::Ending;
use cohelm::trajectory::{Trajectory, read_events};

pub async fn begin(store: &dyn Store, number: u8) -> EpisodeId {
    let write = Write::Begin { key: key(number), setup: setup(number.into()), at_ms: 1_000 };
    store.commit(&[write]).await.unwrap()[0].unwrap()
}

pub async fn an_empty_store_is_empty(store: &dyn Store) {
    assert_eq!(store.episodes(Page::newest(10)).await, Ok(vec![]));
    assert_eq!(store.models().await, Ok(vec![]));
    assert_eq!(store.episode(EpisodeId(1)).await, Ok(None));
    assert_eq!(store.flight(key(1)).await, Ok(None));
    assert_eq!(store.record(EpisodeId(1)).await, Ok(None));
    assert_eq!(store.model("none").await, Ok(None));
    assert_eq!(store.commit(&[]).await, Ok(vec![]));
    assert_eq!(store.check().await, Ok(()));
}

pub async fn an_episode_grows_by_pieces_and_ends_as_a_record(store: &dyn Store) {
    let episode = begin(store, 7).await;
    let mut page = PageOfTests::new(setup(7));
    let pieces = [page.fly(50), page.fly(50)];
    for chunk in pieces.clone() {
        store.commit(&[Write::Chunk { episode, chunk }]).await.unwrap();
    }
    let row = store.flight(key(7)).await.unwrap().unwrap();
    assert_eq!((row.id, row.ticks, row.progress, row.ended_at_ms), (episode, 100, Progress::InTheAir, None));
    assert_eq!(store.chunks(episode).await.unwrap(), pieces);
    assert!(!read_events(&pieces[0].events).unwrap().is_empty());

    let record = record(7);
    store.commit(&[Write::Finish { episode, record: record.clone(), at_ms: 9_000 }]).await.unwrap();
    let row = store.episode(episode).await.unwrap().unwrap();
    assert_eq!(row.progress, Progress::Finished { ending: record.ending });
    assert_eq!((row.ticks, row.started_at_ms, row.ended_at_ms), (record.ticks, 1_000, Some(9_000)));
    assert_eq!((row.plant.as_str(), row.rule.as_str(), row.seed), ("point", "tolerance", 7));
    assert_eq!(serde_json::from_value::<Setup>(row.setup).unwrap(), setup(7));
    assert_eq!(store.chunks(episode).await.unwrap(), []);
    let bytes = unpack(&store.record(episode).await.unwrap().unwrap()).unwrap();
    assert_eq!(Trajectory::from_bytes(&bytes).unwrap(), flown(7));
}

pub async fn pieces_must_follow_each_other(store: &dyn Store) {
    let episode = begin(store, 1).await;
    let mut page = PageOfTests::new(setup(1));
    let (first, second) = (page.fly(10), page.fly(10));
    let misplaced = StoreError::Misplaced { episode, what: "a piece of its key log" };
    let gap = store.commit(&[Write::Chunk { episode, chunk: second }]).await;
    assert_eq!(gap, Err(misplaced.clone()));
    let write = Write::Chunk { episode, chunk: first };
    assert!(store.commit(std::slice::from_ref(&write)).await.is_ok());
    assert_eq!(store.commit(&[write]).await, Err(misplaced));
}

pub async fn nothing_is_added_to_what_is_over(store: &dyn Store) {
    let episode = begin(store, 1).await;
    let finish = Write::Finish { episode, record: record(1), at_ms: 5 };
    store.commit(std::slice::from_ref(&finish)).await.unwrap();
    let chunk = PageOfTests::new(setup(1)).fly(10);
    for write in [
        finish,
        Write::Chunk { episode, chunk },
        Write::Refuse { episode, reason: "late".into(), at_ms: 6 },
        Write::Forget(episode),
    ] {
        let refused = store.commit(&[write]).await;
        assert!(matches!(refused, Err(StoreError::Misplaced { .. })), "{refused:?}");
    }
    assert!(store.record(episode).await.unwrap().is_some());
}

pub async fn a_refused_episode_keeps_its_pieces_and_the_reason(store: &dyn Store) {
    let episode = begin(store, 1).await;
    let chunk = PageOfTests::new(setup(1)).fly(10);
    store.commit(&[Write::Chunk { episode, chunk: chunk.clone() }]).await.unwrap();
    store.commit(&[Write::Refuse { episode, reason: "other bits".into(), at_ms: 6 }]).await.unwrap();
    let row = store.episode(episode).await.unwrap().unwrap();
    assert_eq!(row.progress, Progress::Refused { reason: "other bits".into() });
    assert_eq!(store.chunks(episode).await.unwrap(), [chunk]);
}

pub async fn a_batch_is_carried_out_wholly_or_not_at_all(store: &dyn Store) {
    let good = Write::Begin { key: key(1), setup: setup(1), at_ms: 1 };
    let bad = Write::Forget(EpisodeId(99));
    assert!(store.commit(&[good.clone(), bad]).await.is_err());
    assert_eq!(store.flight(key(1)).await, Ok(None));
    assert!(store.commit(&[good]).await.is_ok());
}

pub async fn a_flight_key_is_used_once(store: &dyn Store) {
    begin(store, 1).await;
    let again = Write::Begin { key: key(1), setup: setup(2), at_ms: 1 };
    assert_eq!(store.commit(&[again]).await, Err(StoreError::KeyInUse));
}

pub async fn an_episode_needs_its_models(store: &dyn Store) {
    let setup = Setup { values: Some("ab".repeat(32)), ..setup(1) };
    let begin = Write::Begin { key: key(1), setup, at_ms: 1 };
    assert_eq!(store.commit(&[begin]).await, Err(StoreError::ModelNotStored));
}

pub async fn numbers_are_never_given_twice(store: &dyn Store) {
    let first = begin(store, 1).await;
    store.commit(&[Write::Forget(first)]).await.unwrap();
    assert_eq!(store.flight(key(1)).await, Ok(None));
    assert!(begin(store, 1).await > first);
}

pub async fn lists_are_newest_first_and_come_in_parts(store: &dyn Store) {
    let mut ids = Vec::new();
    for number in 0..5 {
        ids.push(begin(store, number).await);
    }
    let part = |before, limit| async move {
        let rows = store.episodes(Page { before, limit }).await.unwrap();
        rows.into_iter().map(|row| row.id).collect::<Vec<_>>()
    };
    assert_eq!(part(None, 2).await, [ids[4], ids[3]]);
    assert_eq!(part(Some(ids[3]), 2).await, [ids[2], ids[1]]);
    assert_eq!(part(Some(ids[1]), 2).await, [ids[0]]);
    assert_eq!(part(Some(ids[0]), 2).await, []);
}

pub async fn whole_episodes_are_stored_at_once(store: &dyn Store) {
    let write = Write::Episode { record: record(3), at_ms: 77 };
    let made = store.commit(&[write.clone(), write]).await.unwrap();
    let ids: Vec<EpisodeId> = made.into_iter().flatten().collect();
    assert_eq!(ids.len(), 2);
    let row = store.episode(ids[1]).await.unwrap().unwrap();
    assert_eq!((row.started_at_ms, row.ended_at_ms), (77, Some(77)));
    assert!(matches!(row.progress, Progress::Finished { ending } if ending != Ending::Abandoned));
}

pub async fn extreme_numbers_come_back(store: &dyn Store) {
    let mut largest = setup(cohelm::trajectory::MAX_SEED);
    largest.time_scale = 0.1;
    let begin = Write::Begin { key: key(255), setup: largest.clone(), at_ms: i64::MAX };
    let episode = store.commit(&[begin]).await.unwrap()[0].unwrap();
    let row = store.episode(episode).await.unwrap().unwrap();
    assert_eq!((row.seed, row.time_scale, row.started_at_ms), (largest.seed, 0.1, i64::MAX));
    let digests = Digests { plant: u64::MAX, decisions: 1 << 63 };
    let chunk = Chunk { from_tick: 0, to_tick: 3, digests, events: vec![] };
    store.commit(&[Write::Chunk { episode, chunk: chunk.clone() }]).await.unwrap();
    assert_eq!(store.chunks(episode).await.unwrap(), [chunk]);
}
