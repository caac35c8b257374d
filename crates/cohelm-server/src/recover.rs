//! Flights that were interrupted: what is committed of their key logs becomes a record, abandoned at the last tick.

use crate::follow::{Disbelief, Follower};
use crate::hangar::{Hangar, HangarError};
use crate::store::{Episode, EpisodeId, Page, Progress, Record, StoreError, Write, now_ms};
use cohelm::trajectory::{Setup, Trajectory};
use std::time::Duration;

/// How long a page may stay away before its flight is taken for abandoned, counted from the flight's beginning:
/// shorter ends flights of people who only closed a lid, longer keeps lists untidy.
pub const PATIENCE: Duration = Duration::from_secs(24 * 3600);
/// Rows read at once.
const ROWS: u32 = 500;

/// Why an interrupted flight gives no record.
#[derive(Debug, thiserror::Error)]
pub enum RecoverError {
    /// There is no such episode, or it was not interrupted.
    #[error("episode {0} is no interrupted flight")]
    NotInterrupted(EpisodeId),
    /// Its setup is of another version.
    #[error("the setup of episode {0} cannot be read by this version")]
    Setup(EpisodeId),
    /// It cannot be flown here.
    #[error(transparent)]
    Hangar(#[from] HangarError),
    /// What is stored of it is not believed here: another version of the plant wrote it.
    #[error(transparent)]
    Disbelief(#[from] Disbelief),
    /// The database failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// The record of an interrupted flight up to its last committed tick; what is stored stays as it is.
pub async fn recover(hangar: &Hangar, id: EpisodeId) -> Result<Trajectory, RecoverError> {
    let row = hangar.store().episode(id).await?;
    let row = row.filter(|row| row.progress == Progress::InTheAir).ok_or(RecoverError::NotInterrupted(id))?;
    let setup: Setup = serde_json::from_value(row.setup).map_err(|_| RecoverError::Setup(id))?;
    let mut follower = Follower::new(hangar.begin(setup).await?);
    for chunk in hangar.store().chunks(id).await? {
        follower.follow(&chunk)?;
    }
    Ok(follower.abandon())
}

/// Ends the flights that began longer ago than this and were not taken up again: those that flew get their record,
/// those that never flew a tick go. Flights of a study stay, since its participants may come back whenever they like. Gives how many of each. What cannot be flown here any more stays as it is.
pub async fn end_interrupted(hangar: &Hangar, older_than: Duration) -> Result<(usize, usize), StoreError> {
    let began_before = now_ms().saturating_sub(i64::try_from(older_than.as_millis()).unwrap_or(i64::MAX));
    let (mut ended, mut forgotten) = (0, 0);
    let mut page = Page::newest(ROWS);
    loop {
        let rows = hangar.store().episodes(page).await?;
        let Some(last) = rows.last() else { return Ok((ended, forgotten)) };
        page.before = Some(last.id);
        let old = |row: &&Episode| {
            row.progress == Progress::InTheAir && row.started_at_ms < began_before && row.trial.is_none()
        };
        for row in rows.iter().filter(old) {
            match end(hangar, row).await {
                Ok(Write::Forget(_)) => forgotten += 1,
                Ok(_) => ended += 1,
                Err(RecoverError::Store(error)) => return Err(error),
                Err(error) => {
                    tracing::warn!(episode = %row.id, %error, "an interrupted flight stays as it is")
                }
            }
        }
    }
}

async fn end(hangar: &Hangar, row: &Episode) -> Result<Write, RecoverError> {
    let write = if row.ticks == 0 {
        Write::Forget(row.id)
    } else {
        let record = Record::new(&recover(hangar, row.id).await?);
        Write::Finish { episode: row.id, record, at_ms: now_ms() }
    };
    hangar.store().commit(std::slice::from_ref(&write)).await?;
    Ok(write)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Store;
    use crate::testing::{Disk, Page as PageOfTests, key, setup};
    use cohelm::plant::Ending;

    async fn interrupted(disk: &Disk, number: u8, ticks: u32, at_ms: i64) -> EpisodeId {
        let begin = Write::Begin { key: key(number), setup: setup(number.into()), at_ms };
        let episode = disk.store.commit(&[begin]).await.unwrap()[0].unwrap();
        let mut page = PageOfTests::new(setup(number.into()));
        for _ in 0..ticks / 25 {
            disk.store.commit(&[Write::Chunk { episode, chunk: page.fly(25) }]).await.unwrap();
        }
        episode
    }

    #[tokio::test]
    async fn what_is_committed_of_an_interrupted_flight_can_be_had() {
        let disk = Disk::new().await;
        let episode = interrupted(&disk, 1, 75, 0).await;
        let flown = recover(&disk.hangar(), episode).await.unwrap();
        let mut page = PageOfTests::new(setup(1));
        page.fly(75);
        assert_eq!(flown, page.trajectory());
        assert_eq!((flown.ticks(), flown.ending), (75, Ending::Abandoned));
        assert!(matches!(recover(&disk.hangar(), EpisodeId(9)).await, Err(RecoverError::NotInterrupted(_))));
    }

    #[tokio::test]
    async fn old_interrupted_flights_are_ended_and_young_ones_may_still_be_taken_up() {
        let disk = Disk::new().await;
        let old = interrupted(&disk, 1, 50, 0).await;
        let empty = interrupted(&disk, 2, 0, 0).await;
        let young = interrupted(&disk, 3, 50, now_ms()).await;
        assert_eq!(end_interrupted(&disk.hangar(), PATIENCE).await, Ok((1, 1)));
        let progress = async |id| disk.store.episode(id).await.unwrap().map(|row| row.progress);
        assert_eq!(progress(old).await, Some(Progress::Finished { ending: Ending::Abandoned }));
        assert_eq!(progress(empty).await, None);
        assert_eq!(progress(young).await, Some(Progress::InTheAir));
        assert_eq!(end_interrupted(&disk.hangar(), PATIENCE).await, Ok((0, 0)));
    }

    #[tokio::test]
    async fn a_flight_of_another_version_is_left_as_it_is() {
        let disk = Disk::new().await;
        let setup = Setup { plant_version: 99, ..setup(1) };
        let begin = Write::Begin { key: key(1), setup, at_ms: 0 };
        let episode = disk.store.commit(&[begin]).await.unwrap()[0].unwrap();
        let chunk = PageOfTests::new(crate::testing::setup(1)).fly(25);
        disk.store.commit(&[Write::Chunk { episode, chunk }]).await.unwrap();
        assert_eq!(end_interrupted(&disk.hangar(), PATIENCE).await, Ok((0, 0)));
        assert_eq!(disk.store.episode(episode).await.unwrap().unwrap().progress, Progress::InTheAir);
    }
}
