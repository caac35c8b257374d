//! Carrying out what [`Write`] asks for, within one transaction.

use super::driver::{Transaction, Value};
use super::{
    Chunk, EpisodeId, FlightKey, ParticipantId, Record, StoreError, TokenHash, Trial, Write, queries, rows,
};
use cohelm::plant::Ending;
use cohelm::trajectory::Setup;

/// A transaction under way; dropping it takes everything back.
pub struct Batch(pub Box<dyn Transaction>);

/// An episode as it is first written.
struct NewEpisode<'a> {
    key: Option<FlightKey>,
    setup: &'a Setup,
    at_ms: i64,
    ended: Option<(Ending, u32)>,
    trial: Option<&'a Trial>,
}

impl Batch {
    /// Carries out one change; gives the episode that it made.
    pub async fn carry_out(&mut self, write: &Write) -> Result<Option<EpisodeId>, StoreError> {
        match write {
            Write::Begin { key, setup, at_ms } => {
                let new = NewEpisode { key: Some(*key), setup, at_ms: *at_ms, ended: None, trial: None };
                return self.add_episode(new).await.map(Some);
            }
            Write::BeginTrial { key, setup, at_ms, trial } => {
                self.seen(trial.participant, *at_ms).await?;
                let new =
                    NewEpisode { key: Some(*key), setup, at_ms: *at_ms, ended: None, trial: Some(trial) };
                return self.add_episode(new).await.map(Some);
            }
            Write::Episode { record, at_ms } => return self.add_whole(record, *at_ms).await.map(Some),
            Write::Chunk { episode, chunk } => self.add_chunk(*episode, chunk).await?,
            Write::Finish { episode, record, at_ms } => self.finish(*episode, record, *at_ms).await?,
            Write::Refuse { episode, reason, at_ms } => {
                let values = [episode.0.into(), reason.into(), (*at_ms).into()];
                self.change_episode(queries::REFUSE, &values, (*episode, "a refusal")).await?;
            }
            Write::Forget(episode) => {
                self.change_episode(queries::FORGET, &[episode.0.into()], (*episode, "being forgotten"))
                    .await?;
            }
            other => self.carry_out_beside_flights(other).await?,
        }
        Ok(None)
    }

    /// Everything that concerns no single flight.
    async fn carry_out_beside_flights(&mut self, write: &Write) -> Result<(), StoreError> {
        match write {
            Write::Model { .. } => self.add_model(write).await,
            Write::Keep { plant, hash, at_ms } => self.keep(plant, hash.as_deref(), *at_ms).await,
            Write::Study { hash, name, text, at_ms } => {
                let values = [hash.into(), name.into(), text.into(), (*at_ms).into()];
                self.execute(queries::ADD_STUDY, &values).await.map(drop)
            }
            Write::Participant { id, study, code, token, at_ms } => {
                self.refuse_unknown_study(study).await?;
                let token: Value<'_> = token.0.as_slice().into();
                let values = [id.0.into(), study.into(), code.into(), token, (*at_ms).into()];
                self.execute(queries::ADD_PARTICIPANT, &values).await.map(drop)
            }
            Write::Link { participant, token } => self.link(*participant, token.as_ref()).await,
            Write::Seen { participant, at_ms } => self.seen(*participant, *at_ms).await,
            Write::Event { participant, expected_seq, event_json, at_ms } => {
                self.advance_log(*participant, *expected_seq, *at_ms).await?;
                self.add_event(*participant, *expected_seq, event_json, *at_ms).await
            }
            Write::Withdraw { participant, left, at_ms } => self.withdraw(*participant, left, *at_ms).await,
            Write::Setting { name, value } => {
                self.execute(queries::SET, &[name.into(), value.into()]).await.map(drop)
            }
            Write::Begin { .. }
            | Write::BeginTrial { .. }
            | Write::Episode { .. }
            | Write::Chunk { .. }
            | Write::Finish { .. }
            | Write::Refuse { .. }
            | Write::Forget(_) => unreachable!("carry_out does these"),
        }
    }

    async fn execute(&mut self, sql: &'static str, values: &[Value<'_>]) -> Result<u64, StoreError> {
        Value::refuse_zero(values)?;
        self.0.execute(sql, values).await
    }
}

/// Flights.
impl Batch {
    async fn add_episode(&mut self, new: NewEpisode<'_>) -> Result<EpisodeId, StoreError> {
        let NewEpisode { key, setup, at_ms, ended, trial } = new;
        let setup_json = json("a setup", setup)?;
        let seed = i64::try_from(setup.seed)
            .map_err(|_| StoreError::Value { what: "seed", value: setup.seed.to_string() })?;
        let values = [
            Value::Bytes(key.as_ref().map(|key| key.0.as_slice())),
            (&setup.task.plant).into(),
            setup.plant_version.into(),
            i64::from(setup.format()).into(),
            env!("CARGO_PKG_VERSION").into(),
            setup.rule.word().into(),
            seed.into(),
            (&setup.pilot).into(),
            Value::Real(setup.time_scale),
            Value::Text(setup.values.as_deref()),
            Value::Text(setup.intent.as_deref()),
            (&setup_json).into(),
            at_ms.into(),
            Value::Number(ended.map(|_| at_ms)),
            ended.map_or(0, |(_, ticks)| ticks).into(),
            Value::Text(ended.map(|(ending, _)| ending.word())),
            Value::Number(trial.map(|trial| trial.participant.0)),
            Value::Text(trial.map(|trial| trial.step.as_str())),
        ];
        Value::refuse_zero(&values)?;
        let made = self.0.read(queries::ADD_EPISODE, &values).await?;
        let mut row =
            made.into_iter().next().ok_or(StoreError::Value { what: "id", value: "none".into() })?;
        row.take("id").map(EpisodeId)
    }

    async fn add_whole(&mut self, record: &Record, at_ms: i64) -> Result<EpisodeId, StoreError> {
        let ended = Some((record.ending, record.ticks));
        let new = NewEpisode { key: None, setup: &record.setup, at_ms, ended, trial: None };
        let id = self.add_episode(new).await?;
        self.add_record(id, record).await?;
        Ok(id)
    }

    async fn add_chunk(&mut self, episode: EpisodeId, chunk: &Chunk) -> Result<(), StoreError> {
        let place = [episode.0.into(), chunk.from_tick.into(), chunk.to_tick.into()];
        self.change_episode(queries::ADVANCE, &place, (episode, "a piece of its key log")).await?;
        let [episode, from, to] = place;
        let (plant, decisions) = (chunk.digests.plant as i64, chunk.digests.decisions as i64);
        let values = [episode, from, to, plant.into(), decisions.into(), chunk.events.as_slice().into()];
        self.execute(queries::ADD_CHUNK, &values).await.map(drop)
    }

    async fn finish(&mut self, episode: EpisodeId, record: &Record, at_ms: i64) -> Result<(), StoreError> {
        let values = [episode.0.into(), record.ending.word().into(), record.ticks.into(), at_ms.into()];
        self.change_episode(queries::FINISH, &values, (episode, "its end")).await?;
        self.add_record(episode, record).await?;
        self.execute(queries::DROP_CHUNKS, &[episode.0.into()]).await.map(drop)
    }

    async fn add_record(&mut self, episode: EpisodeId, record: &Record) -> Result<(), StoreError> {
        let values = [episode.0.into(), record.packed.as_slice().into()];
        self.execute(queries::ADD_RECORD, &values).await.map(drop)
    }

    /// For a change that fits exactly one episode, or nothing that is stored.
    async fn change_episode(
        &mut self,
        sql: &'static str,
        values: &[Value<'_>],
        (episode, what): (EpisodeId, &'static str),
    ) -> Result<(), StoreError> {
        match self.execute(sql, values).await? {
            1 => Ok(()),
            _ => Err(StoreError::Misplaced { episode, what }),
        }
    }
}

/// Models.
impl Batch {
    async fn add_model(&mut self, write: &Write) -> Result<(), StoreError> {
        let Write::Model { model, origin, at_ms } = write else { return Ok(()) };
        let card = model.card();
        let card_json = json("a card", card)?;
        let values = [
            model.hash().into(),
            origin.word().into(),
            card.kind.word().into(),
            (&card.name).into(),
            (&card.task.plant).into(),
            (&card_json).into(),
            model.bytes().into(),
            (*at_ms).into(),
        ];
        self.execute(queries::ADD_MODEL, &values).await.map(drop)
    }

    async fn keep(&mut self, plant: &str, hash: Option<&str>, at_ms: i64) -> Result<(), StoreError> {
        self.execute(queries::KEEP_NONE, &[plant.into()]).await?;
        let Some(hash) = hash else { return Ok(()) };
        self.execute(queries::KEEP, &[hash.into(), at_ms.into()]).await.map(drop)
    }
}

/// Participants.
impl Batch {
    async fn refuse_unknown_study(&mut self, hash: &str) -> Result<(), StoreError> {
        match self.0.read(queries::STUDY, &[hash.into()]).await?.len() {
            0 => Err(StoreError::StudyNotStored),
            _ => Ok(()),
        }
    }

    async fn link(&mut self, id: ParticipantId, token: Option<&TokenHash>) -> Result<(), StoreError> {
        let token = Value::Bytes(token.map(|token| token.0.as_slice()));
        self.change_participant(queries::LINK, &[id.0.into(), token], id).await
    }

    /// Holds the participant's row until the transaction ends, so that nobody withdraws meanwhile.
    async fn seen(&mut self, id: ParticipantId, at_ms: i64) -> Result<(), StoreError> {
        self.change_participant(queries::SEEN, &[id.0.into(), at_ms.into()], id).await
    }

    async fn advance_log(&mut self, id: ParticipantId, seq: u32, at_ms: i64) -> Result<(), StoreError> {
        let values = [id.0.into(), seq.into(), at_ms.into()];
        if self.execute(queries::ADVANCE_LOG, &values).await? == 1 {
            return Ok(());
        }
        let last = self.refuse_unless_taking_part(id).await?;
        Err(StoreError::OutOfStep { participant: id, expected: seq, last })
    }

    async fn add_event(
        &mut self,
        id: ParticipantId,
        seq: u32,
        json: &str,
        at_ms: i64,
    ) -> Result<(), StoreError> {
        let values = [id.0.into(), seq.into(), at_ms.into(), json.into()];
        self.execute(queries::ADD_EVENT, &values).await.map(drop)
    }

    async fn withdraw(&mut self, id: ParticipantId, left: &[String], at_ms: i64) -> Result<(), StoreError> {
        let values = [id.0.into(), (left.len() as i64).into(), at_ms.into()];
        self.change_participant(queries::WITHDRAW, &values, id).await?;
        // Records and pieces go with their episodes.
        for sql in [queries::DROP_TRIALS, queries::DROP_EVENTS] {
            self.execute(sql, &[id.0.into()]).await?;
        }
        for (seq, json) in (1..).zip(left) {
            self.add_event(id, seq, json, at_ms).await?;
        }
        Ok(())
    }

    /// For a change of one participant who has not withdrawn.
    async fn change_participant(
        &mut self,
        sql: &'static str,
        values: &[Value<'_>],
        id: ParticipantId,
    ) -> Result<(), StoreError> {
        match self.execute(sql, values).await? {
            1 => Ok(()),
            _ => Err(match self.refuse_unless_taking_part(id).await {
                Err(error) => error,
                Ok(_) => StoreError::NoParticipant(id),
            }),
        }
    }

    /// The number of the participant's newest event; an error if there is no such participant any more.
    async fn refuse_unless_taking_part(&mut self, id: ParticipantId) -> Result<u32, StoreError> {
        let found = self.0.read(queries::PARTICIPANT, &[id.0.into()]).await?;
        let row = found.into_iter().next().ok_or(StoreError::NoParticipant(id))?;
        let participant = rows::participant(row)?;
        match participant.withdrawn_at_ms {
            Some(_) => Err(StoreError::Withdrawn(id)),
            None => Ok(participant.last_seq),
        }
    }
}

fn json(what: &'static str, value: &impl serde::Serialize) -> Result<String, StoreError> {
    serde_json::to_string(value).map_err(|error| StoreError::Value { what, value: error.to_string() })
}
