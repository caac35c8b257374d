//! What every store must do, whatever database lies behind it. Each test gets an empty store.

mod flights;
mod studies;

use super::postgres::tests::EmptyDatabase;
use crate::testing::Disk;

/// Runs each of the tests on each kind of database.
macro_rules! on_every_database {
    ($($module:ident: $($test:ident),+;)+) => {
        mod sqlite {
            $($(#[tokio::test]
            async fn $test() {
                let disk = super::Disk::new().await;
                super::$module::$test(disk.store.as_ref()).await;
            })+)+
        }
        mod postgres {
            $($(#[tokio::test]
            #[ignore = "needs a server: tools/postgres-for-tests cargo test -p cohelm-server postgres -- --include-ignored"]
            async fn $test() {
                let database = super::EmptyDatabase::new().await;
                super::$module::$test(&database.store).await;
                database.remove().await;
            })+)+
        }
    };
}

on_every_database! {
    flights:
        an_empty_store_is_empty,
        an_episode_grows_by_pieces_and_ends_as_a_record,
        pieces_must_follow_each_other,
        nothing_is_added_to_what_is_over,
        a_refused_episode_keeps_its_pieces_and_the_reason,
        a_batch_is_carried_out_wholly_or_not_at_all,
        a_flight_key_is_used_once,
        an_episode_needs_its_models,
        numbers_are_never_given_twice,
        lists_are_newest_first_and_come_in_parts,
        whole_episodes_are_stored_at_once,
        extreme_numbers_come_back;
    studies:
        a_study_is_kept_once_under_its_hash,
        participants_are_found_by_number_study_and_link,
        a_participant_needs_a_study_and_a_number_code_and_link_of_its_own,
        a_new_link_voids_the_old_one,
        events_are_numbered_from_one_without_a_gap,
        of_two_who_append_at_once_one_is_told_to_read_again,
        a_flight_and_the_event_of_its_end_come_together_or_not_at_all,
        trials_are_the_flights_of_one_participant,
        who_withdraws_leaves_a_tombstone_and_nothing_else,
        pages_are_seen_and_settings_remembered,
        texts_come_back_as_they_were_and_one_that_cannot_is_its_own_fault;
}
