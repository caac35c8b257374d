//! What every store must do for studies.

use super::flights::begin;
use crate::store::*;
use crate::testing::{Page as PageOfTests, flown, key, record, setup};

const ANNA: ParticipantId = ParticipantId(1);
const BEN: ParticipantId = ParticipantId(2);

fn study() -> Write {
    Write::Study { hash: "ab".repeat(32), name: "paper".into(), text: "title = \"A\"\n".into(), at_ms: 5 }
}

fn token(number: u8) -> TokenHash {
    TokenHash([number; 32])
}

fn participant(id: ParticipantId) -> Write {
    let (code, token) = (format!("code-{id}"), token(id.0 as u8));
    Write::Participant { id, study: "ab".repeat(32), code, token, at_ms: 6 }
}

fn event(participant: ParticipantId, expected_seq: u32, json: &str) -> Write {
    Write::Event { participant, expected_seq, event_json: json.into(), at_ms: 100 - i64::from(expected_seq) }
}

fn trial(participant: ParticipantId, number: u8) -> Write {
    let trial = Trial { participant, step: format!("block-1/flight-{number}") };
    Write::BeginTrial { key: key(number), setup: setup(number.into()), at_ms: 8, trial }
}

/// A study with Anna and Ben.
async fn study_of_two(store: &dyn Store) {
    store.commit(&[study(), participant(ANNA), participant(BEN)]).await.unwrap();
}

async fn log(store: &dyn Store, participant: ParticipantId) -> Vec<String> {
    store.events(participant, 0).await.unwrap().into_iter().map(|event| event.json).collect()
}

pub async fn a_study_is_kept_once_under_its_hash(store: &dyn Store) {
    assert_eq!(store.studies().await, Ok(vec![]));
    store.commit(&[study(), study()]).await.unwrap();
    let stored = store.study(&"ab".repeat(32)).await.unwrap().unwrap();
    assert_eq!(
        (stored.name.as_str(), stored.text.as_str(), stored.stored_at_ms),
        ("paper", "title = \"A\"\n", 5)
    );
    assert_eq!(store.studies().await, Ok(vec![stored]));
    assert_eq!(store.study("cd").await, Ok(None));
}

pub async fn participants_are_found_by_number_study_and_link(store: &dyn Store) {
    assert_eq!(store.free_participant_id().await, Ok(ANNA));
    study_of_two(store).await;
    assert_eq!(store.free_participant_id().await, Ok(ParticipantId(3)));
    let anna = store.participant(ANNA).await.unwrap().unwrap();
    assert_eq!((anna.code.as_str(), anna.created_at_ms, anna.last_seq), ("code-1", 6, 0));
    assert_eq!((anna.seen_at_ms, anna.withdrawn_at_ms), (None, None));
    let ben = store.participant_by_token(token(2)).await.unwrap().unwrap();
    assert_eq!(ben.id, BEN);
    assert_eq!(store.participants(&"ab".repeat(32)).await, Ok(vec![anna, ben]));
    assert_eq!(store.participants("cd").await, Ok(vec![]));
    assert_eq!(store.participant(ParticipantId(3)).await, Ok(None));
    assert_eq!(store.participant_by_token(token(3)).await, Ok(None));
}

pub async fn a_participant_needs_a_study_and_a_number_code_and_link_of_its_own(store: &dyn Store) {
    assert_eq!(store.commit(&[participant(ANNA)]).await, Err(StoreError::StudyNotStored));
    store.commit(&[study(), participant(ANNA)]).await.unwrap();
    let (hash, at_ms) = ("ab".repeat(32), 6);
    for (id, code, token) in [(ANNA, "new", token(9)), (BEN, "code-1", token(9)), (BEN, "new", token(1))] {
        let write = Write::Participant { id, study: hash.clone(), code: code.into(), token, at_ms };
        assert_eq!(store.commit(&[write]).await, Err(StoreError::ParticipantExists), "{id} {code}");
    }
    assert_eq!(store.participants(&hash).await.unwrap().len(), 1);
}

pub async fn a_new_link_voids_the_old_one(store: &dyn Store) {
    study_of_two(store).await;
    store.commit(&[Write::Link { participant: ANNA, token: Some(token(7)) }]).await.unwrap();
    assert_eq!(store.participant_by_token(token(1)).await, Ok(None));
    assert_eq!(store.participant_by_token(token(7)).await.unwrap().unwrap().id, ANNA);
    let taken = Write::Link { participant: BEN, token: Some(token(7)) };
    assert_eq!(store.commit(&[taken]).await, Err(StoreError::ParticipantExists));
    store.commit(&[Write::Link { participant: ANNA, token: None }]).await.unwrap();
    assert_eq!(store.participant_by_token(token(7)).await, Ok(None));
}

pub async fn events_are_numbered_from_one_without_a_gap(store: &dyn Store) {
    study_of_two(store).await;
    store.commit(&[event(ANNA, 1, "a"), event(ANNA, 2, "b"), event(BEN, 1, "x")]).await.unwrap();
    store.commit(&[event(ANNA, 3, "c")]).await.unwrap();
    assert_eq!(
        (log(store, ANNA).await, log(store, BEN).await),
        (vec!["a".into(), "b".into(), "c".into()], vec!["x".into()])
    );
    let later = store.events(ANNA, 2).await.unwrap();
    // The clock went back from event to event: nothing depends on the order of times.
    assert_eq!(later, [StoredEvent { seq: 3, at_ms: 97, json: "c".into() }]);
    let anna = store.participant(ANNA).await.unwrap().unwrap();
    assert_eq!((anna.last_seq, anna.seen_at_ms), (3, Some(97)));
    for wrong in [0, 1, 3, 5] {
        let refused = store.commit(&[event(ANNA, wrong, "z")]).await;
        assert_eq!(refused, Err(StoreError::OutOfStep { participant: ANNA, expected: wrong, last: 3 }));
    }
    assert_eq!(log(store, ANNA).await.len(), 3);
}

pub async fn of_two_who_append_at_once_one_is_told_to_read_again(store: &dyn Store) {
    study_of_two(store).await;
    for seq in 1..=20 {
        let (ours, theirs) = ([event(ANNA, seq, "ours")], [event(ANNA, seq, "theirs")]);
        let (ours, theirs) = tokio::join!(store.commit(&ours), store.commit(&theirs));
        assert!(ours.is_ok() != theirs.is_ok(), "{ours:?} {theirs:?}");
        let refused = ours.and(theirs).unwrap_err();
        assert_eq!(refused, StoreError::OutOfStep { participant: ANNA, expected: seq, last: seq });
    }
    assert_eq!(log(store, ANNA).await.len(), 20);
}

pub async fn a_flight_and_the_event_of_its_end_come_together_or_not_at_all(store: &dyn Store) {
    study_of_two(store).await;
    let episode = store.commit(&[trial(ANNA, 3), event(ANNA, 1, "begun")]).await.unwrap()[0].unwrap();
    let finish = Write::Finish { episode, record: record(3), at_ms: 9 };
    assert!(store.commit(&[finish.clone(), event(ANNA, 7, "ended")]).await.is_err());
    assert_eq!(store.episode(episode).await.unwrap().unwrap().progress, Progress::InTheAir);
    assert_eq!(store.record(episode).await, Ok(None));
    store.commit(&[finish, event(ANNA, 2, "ended")]).await.unwrap();
    assert_eq!(unpack(&store.record(episode).await.unwrap().unwrap()).unwrap(), flown(3).to_bytes());
    assert_eq!(log(store, ANNA).await, ["begun", "ended"]);
}

pub async fn trials_are_the_flights_of_one_participant(store: &dyn Store) {
    study_of_two(store).await;
    let outside = begin(store, 9).await;
    store.commit(&[trial(ANNA, 1), trial(BEN, 2), trial(ANNA, 3)]).await.unwrap();
    let trials = store.trials(ANNA).await.unwrap();
    let steps: Vec<_> = trials.iter().map(|row| row.trial.clone().unwrap()).collect();
    let of_anna = |step: &str| Trial { participant: ANNA, step: step.into() };
    assert_eq!(steps, [of_anna("block-1/flight-1"), of_anna("block-1/flight-3")]);
    assert_eq!(store.episode(outside).await.unwrap().unwrap().trial, None);
    let nobody = store.commit(&[trial(ParticipantId(77), 4)]).await;
    assert_eq!(nobody, Err(StoreError::NoParticipant(ParticipantId(77))));
}

pub async fn who_withdraws_leaves_a_tombstone_and_nothing_else(store: &dyn Store) {
    study_of_two(store).await;
    let mut page = PageOfTests::new(setup(1));
    let flights = store.commit(&[trial(ANNA, 1), trial(ANNA, 2), trial(BEN, 3)]).await.unwrap();
    let [Some(in_the_air), Some(finished), Some(of_ben)] = flights[..] else { panic!("{flights:?}") };
    let finish = |episode, seed| Write::Finish { episode, record: record(seed), at_ms: 9 };
    let piece = Write::Chunk { episode: in_the_air, chunk: page.fly(50) };
    let told = [event(ANNA, 1, "a"), event(ANNA, 2, "b"), event(BEN, 1, "x")];
    store
        .commit(&[vec![piece, finish(finished, 2), finish(of_ben, 3)], told.to_vec()].concat())
        .await
        .unwrap();

    let withdraw = Write::Withdraw { participant: ANNA, left: vec!["withdrawn".into()], at_ms: 50 };
    store.commit(std::slice::from_ref(&withdraw)).await.unwrap();
    let tombstone = store.participant(ANNA).await.unwrap().unwrap();
    assert_eq!((tombstone.code.as_str(), tombstone.created_at_ms), ("code-1", 6));
    assert_eq!((tombstone.withdrawn_at_ms, tombstone.seen_at_ms, tombstone.last_seq), (Some(50), None, 1));
    assert_eq!(
        store.events(ANNA, 0).await.unwrap(),
        [StoredEvent { seq: 1, at_ms: 50, json: "withdrawn".into() }]
    );
    assert_eq!(store.trials(ANNA).await, Ok(vec![]));
    assert_eq!(store.participant_by_token(token(1)).await, Ok(None));
    for episode in [in_the_air, finished] {
        assert_eq!(store.episode(episode).await, Ok(None));
        assert_eq!(store.record(episode).await, Ok(None));
        assert_eq!(store.chunks(episode).await, Ok(vec![]));
    }
    // Nothing is added to a tombstone, and its number and code are never another's.
    let link = Write::Link { participant: ANNA, token: Some(token(8)) };
    for late in
        [withdraw, trial(ANNA, 5), event(ANNA, 2, "late"), Write::Seen { participant: ANNA, at_ms: 1 }, link]
    {
        assert_eq!(store.commit(&[late]).await, Err(StoreError::Withdrawn(ANNA)));
    }
    let late = store.commit(&[Write::Chunk { episode: in_the_air, chunk: page.fly(50) }]).await;
    assert!(matches!(late, Err(StoreError::Misplaced { .. })), "{late:?}");
    assert_eq!(store.free_participant_id().await, Ok(ParticipantId(3)));
    assert_eq!(store.commit(&[participant(ANNA)]).await, Err(StoreError::ParticipantExists));
    // Ben has lost nothing.
    assert_eq!((log(store, BEN).await, store.trials(BEN).await.unwrap().len()), (vec!["x".into()], 1));
    assert!(store.record(of_ben).await.unwrap().is_some());
}

pub async fn pages_are_seen_and_settings_remembered(store: &dyn Store) {
    study_of_two(store).await;
    store.commit(&[Write::Seen { participant: BEN, at_ms: 70 }]).await.unwrap();
    // The clock was set back.
    store.commit(&[Write::Seen { participant: BEN, at_ms: -3 }]).await.unwrap();
    assert_eq!(store.participant(BEN).await.unwrap().unwrap().seen_at_ms, Some(-3));
    assert_eq!(store.setting("secret").await, Ok(None));
    for value in ["one", "two"] {
        let set = Write::Setting { name: "secret".into(), value: value.into() };
        store.commit(&[set]).await.unwrap();
    }
    assert_eq!(store.setting("secret").await, Ok(Some("two".into())));
}

pub async fn texts_come_back_as_they_were_and_one_that_cannot_is_its_own_fault(store: &dyn Store) {
    study_of_two(store).await;
    let json = r#"{"text":"Grüße, 你好 🛸 ' \" \\ \u0000 =1+1"}"#;
    store.commit(&[event(ANNA, 1, json)]).await.unwrap();
    assert_eq!(log(store, ANNA).await, [json]);
    let refused = store.commit(&[event(ANNA, 2, "a\0b")]).await.unwrap_err();
    assert!(matches!(refused, StoreError::Value { .. }) && refused.is_about_one_write(), "{refused:?}");
}
