//! A study's records, from a database or an archive, and what they give when they are flown again.

use anyhow::{Context, Result, bail};
use cohelm_server::store::{Episode, ParticipantId, Store, StoredStudy, open_existing, unpack};
use cohelm_study::dataset::{ParticipantRecord, StudyRecords, TrialRecord};
use cohelm_study::design::Design;
use cohelm_study::export::read_archive;
use cohelm_study::session::Logged;
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::Path;

/// The bytes that a zip file begins with.
const ZIP: [u8; 4] = *b"PK\x03\x04";

/// What a study's records are read from.
pub struct Source<'a> {
    /// A database, or an archive that `export` wrote.
    pub from: &'a OsStr,
    /// Which study of the database: its name, or the beginning of its file's hash; the only one unless given.
    pub study: Option<&'a str>,
}

impl Source<'_> {
    /// The records.
    pub fn records(&self) -> Result<StudyRecords> {
        let path = Path::new(self.from);
        if is_archive(path)? {
            let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
            let records = read_archive(&bytes).with_context(|| path.display().to_string())?;
            return self.the_one_meant(records).with_context(|| path.display().to_string());
        }
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        runtime.block_on(async {
            let store = open_existing(self.from).await?;
            let records = records_of(store.as_ref(), self.study).await;
            store.close().await;
            records
        })
    }
}

impl Source<'_> {
    /// An archive holds one study: the one that is meant, or an error.
    fn the_one_meant(&self, records: StudyRecords) -> Result<StudyRecords> {
        let (name, hash) = (&records.design.name, records.design.hash());
        match self.study {
            Some(meant) if !is_called(meant, name, &hash) => {
                bail!("there is no study {meant:?} in the archive; there is: {name} ({})", &hash[..12])
            }
            _ => Ok(records),
        }
    }
}

/// Whether a study is meant, by its name or by the beginning of its file's hash.
fn is_called(meant: &str, name: &str, hash: &str) -> bool {
    name == meant || (meant.len() >= 4 && hash.starts_with(meant))
}

/// True for a file that begins as archives do; what is no file at all is a database's name.
pub fn is_archive(path: &Path) -> Result<bool> {
    use std::io::Read;
    let Ok(mut file) = std::fs::File::open(path) else { return Ok(false) };
    let mut begin = [0; 4];
    Ok(path.is_file() && file.read_exact(&mut begin).is_ok() && begin == ZIP)
}

/// The records of a study in a database.
pub async fn records_of(store: &dyn Store, study: Option<&str>) -> Result<StudyRecords> {
    let stored = choose(store.studies().await?, study)?;
    let design = Design::from_toml(&stored.text)
        .with_context(|| format!("the stored file of the study {}", stored.name))?;
    let mut records = StudyRecords {
        design,
        participants: Vec::new(),
        trials: Vec::new(),
        models: Vec::new(),
        program: format!("cohelm {}", env!("CARGO_PKG_VERSION")),
    };
    let mut hashes = BTreeSet::new();
    for participant in store.participants(&stored.hash).await? {
        let events = events_of(store, participant.id).await?;
        records.participants.push(ParticipantRecord { id: participant.id.0, code: participant.code, events });
        for flight in store.trials(participant.id).await? {
            hashes.extend(flight.values.iter().chain(&flight.intent).cloned());
            records.trials.extend(trial_of(store, flight).await?);
        }
    }
    for hash in hashes {
        let bytes = store.model(&hash).await?;
        let bytes = bytes.with_context(|| format!("the model {hash} is not in the database"))?;
        records.models.push((hash, bytes));
    }
    Ok(records)
}

/// The study that is meant; of several versions of one file each is a study of its own.
fn choose(studies: Vec<StoredStudy>, meant: Option<&str>) -> Result<StoredStudy> {
    let is_meant = |study: &StoredStudy| meant.is_none_or(|meant| is_called(meant, &study.name, &study.hash));
    let known: Vec<String> =
        studies.iter().map(|study| format!("{} ({})", study.name, &study.hash[..12])).collect();
    let mut found: Vec<StoredStudy> = studies.into_iter().filter(is_meant).collect();
    match (found.len(), meant) {
        (1, _) => Ok(found.remove(0)),
        (0, None) => bail!("no study was ever run on this database; `cohelm study run` does that"),
        (0, Some(meant)) => bail!("there is no study {meant:?} here; there are: {}", known.join(", ")),
        _ => bail!(
            "several studies, or versions of one, are here: {}; choose one with --study, by name or hash",
            known.join(", ")
        ),
    }
}

async fn events_of(store: &dyn Store, participant: ParticipantId) -> Result<Vec<Logged>> {
    let stored = store.events(participant, 0).await?;
    let read = |event: cohelm_server::store::StoredEvent| -> Result<Logged> {
        let what = serde_json::from_str(&event.json)
            .with_context(|| format!("event {} of participant {participant} cannot be read", event.seq))?;
        Ok(Logged { seq: event.seq, at_ms: event.at_ms, event: what })
    };
    stored.into_iter().map(read).collect()
}

async fn trial_of(store: &dyn Store, flight: Episode) -> Result<Option<TrialRecord>> {
    let Some(trial) = flight.trial else { return Ok(None) };
    let packed = store.record(flight.id).await?;
    let record = packed.map(|packed| unpack(&packed)).transpose()?;
    let (participant, episode) = (trial.participant.0, flight.id.0);
    Ok(Some(TrialRecord { participant, step: trial.step, episode, record, program: flight.program }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::OsStr;

    fn of_archive(study: Option<&str>) -> Result<StudyRecords> {
        let text = include_str!("../../../../../studies/pilot.toml");
        let records = StudyRecords {
            design: Design::from_toml(text).expect("shipped with the project"),
            participants: vec![],
            trials: vec![],
            models: vec![],
            program: String::new(),
        };
        Source { from: OsStr::new("pilot.zip"), study }.the_one_meant(records)
    }

    #[test]
    fn an_archive_is_no_other_study_than_its_own() {
        let hash = of_archive(None).expect("nothing else is meant").design.hash();
        assert!(of_archive(Some("pilot")).is_ok() && of_archive(Some(&hash[..8])).is_ok());
        let refused = of_archive(Some("nope")).expect_err("there is no such study").to_string();
        assert_eq!(
            refused,
            format!("there is no study \"nope\" in the archive; there is: pilot ({})", &hash[..12])
        );
    }
}
