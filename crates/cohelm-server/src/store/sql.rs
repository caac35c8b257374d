//! The store itself, over either kind of database.

use super::batch::Batch;
use super::driver::{Driver, Row, Value};
use super::{
    Chunk, Episode, EpisodeId, FlightKey, Page, Participant, ParticipantId, Store, StoreError, StoredEvent,
    StoredModel, StoredStudy, Studies, TokenHash, Write, backup, queries, rows,
};
use async_trait::async_trait;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// A database, whatever drives it.
#[derive(Debug)]
pub struct SqlStore<D> {
    pub(super) driver: D,
    /// What was deleted when somebody withdrew may still be readable in the files. True at first as well: the last
    /// program may have been killed before it had seen to that.
    to_scrub: AtomicBool,
}

impl<D: Driver> SqlStore<D> {
    pub(super) fn new(driver: D) -> Self {
        Self { driver, to_scrub: AtomicBool::new(true) }
    }

    async fn all<T>(
        &self,
        sql: &'static str,
        values: &[Value<'_>],
        read: Read<T>,
    ) -> Result<Vec<T>, StoreError> {
        self.driver.read(sql, values).await?.into_iter().map(read).collect()
    }

    async fn one<T>(
        &self,
        sql: &'static str,
        values: &[Value<'_>],
        read: Read<T>,
    ) -> Result<Option<T>, StoreError> {
        self.driver.read(sql, values).await?.into_iter().next().map(read).transpose()
    }

    /// What was deleted is deleted; only bytes of it may be left, so that a failure here is no failure of the commit.
    async fn scrub_if_needed(&self) {
        if !self.to_scrub.swap(false, Ordering::AcqRel) {
            return;
        }
        if let Err(error) = self.scrub().await {
            tracing::warn!(%error, "the bytes of a withdrawn participant are not overwritten yet; tried again later");
            self.to_scrub.store(true, Ordering::Release);
        }
    }

    async fn scrub(&self) -> Result<(), StoreError> {
        match self.driver.read(queries::ANY_WITHDRAWN, &[]).await?.is_empty() {
            true => Ok(()),
            false => self.driver.scrub().await,
        }
    }
}

/// How a row becomes what was asked for.
type Read<T> = fn(Row) -> Result<T, StoreError>;

#[async_trait]
impl<D: Driver> Store for SqlStore<D> {
    async fn commit(&self, writes: &[Write]) -> Result<Vec<Option<EpisodeId>>, StoreError> {
        if writes.is_empty() {
            return Ok(Vec::new());
        }
        let mut batch = Batch(self.driver.begin().await?);
        let mut made = Vec::with_capacity(writes.len());
        for write in writes {
            made.push(batch.carry_out(write).await?);
        }
        batch.0.commit().await?;
        if writes.iter().any(|write| matches!(write, Write::Withdraw { .. })) {
            self.to_scrub.store(true, Ordering::Release);
        }
        self.scrub_if_needed().await;
        Ok(made)
    }

    async fn episodes(&self, page: Page) -> Result<Vec<Episode>, StoreError> {
        let before = page.before.map_or(i64::MAX, |id| id.0);
        self.all(queries::EPISODES_BEFORE, &[before.into(), page.limit.into()], rows::episode).await
    }

    async fn episode(&self, id: EpisodeId) -> Result<Option<Episode>, StoreError> {
        self.one(queries::EPISODE, &[id.0.into()], rows::episode).await
    }

    async fn flight(&self, key: FlightKey) -> Result<Option<Episode>, StoreError> {
        self.one(queries::EPISODE_OF_KEY, &[key.0.as_slice().into()], rows::episode).await
    }

    async fn record(&self, id: EpisodeId) -> Result<Option<Vec<u8>>, StoreError> {
        self.one(queries::RECORD, &[id.0.into()], |mut row| row.take("bytes")).await
    }

    async fn chunks(&self, id: EpisodeId) -> Result<Vec<Chunk>, StoreError> {
        self.all(queries::CHUNKS, &[id.0.into()], rows::chunk).await
    }

    async fn models(&self) -> Result<Vec<StoredModel>, StoreError> {
        self.all(queries::MODELS, &[], rows::model).await
    }

    async fn model(&self, hash: &str) -> Result<Option<Vec<u8>>, StoreError> {
        self.one(queries::MODEL, &[hash.into()], |mut row| row.take("bytes")).await
    }

    async fn check(&self) -> Result<(), StoreError> {
        self.driver.read(queries::CHECK, &[]).await.map(drop)
    }

    async fn backup(&self, to: &Path) -> Result<(), StoreError> {
        backup::write_new(&self.driver, to).await
    }

    async fn close(&self) {
        self.scrub_if_needed().await;
        self.driver.close().await;
    }
}

#[async_trait]
impl<D: Driver> Studies for SqlStore<D> {
    async fn studies(&self) -> Result<Vec<StoredStudy>, StoreError> {
        self.all(queries::STUDIES, &[], rows::study).await
    }

    async fn study(&self, hash: &str) -> Result<Option<StoredStudy>, StoreError> {
        self.one(queries::STUDY, &[hash.into()], rows::study).await
    }

    async fn participants(&self, study: &str) -> Result<Vec<Participant>, StoreError> {
        self.all(queries::PARTICIPANTS, &[study.into()], rows::participant).await
    }

    async fn participant(&self, id: ParticipantId) -> Result<Option<Participant>, StoreError> {
        self.one(queries::PARTICIPANT, &[id.0.into()], rows::participant).await
    }

    async fn participant_by_token(&self, token: TokenHash) -> Result<Option<Participant>, StoreError> {
        self.one(queries::PARTICIPANT_OF_TOKEN, &[token.0.as_slice().into()], rows::participant).await
    }

    async fn free_participant_id(&self) -> Result<ParticipantId, StoreError> {
        let largest = self.one(queries::LARGEST_PARTICIPANT, &[], |mut row| row.take::<i64>("id")).await?;
        Ok(ParticipantId(largest.unwrap_or(0) + 1))
    }

    async fn events(
        &self,
        participant: ParticipantId,
        after_seq: u32,
    ) -> Result<Vec<StoredEvent>, StoreError> {
        self.all(queries::EVENTS, &[participant.0.into(), after_seq.into()], rows::event).await
    }

    async fn trials(&self, participant: ParticipantId) -> Result<Vec<Episode>, StoreError> {
        self.all(queries::TRIALS, &[participant.0.into()], rows::episode).await
    }

    async fn setting(&self, name: &str) -> Result<Option<String>, StoreError> {
        self.one(queries::SETTING, &[name.into()], |mut row| row.take("value")).await
    }
}
