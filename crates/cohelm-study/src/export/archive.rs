//! One file that holds a study: what was stored, and the tables made of it.

use super::ExportError;
use crate::dataset::{Dataset, ParticipantRecord, StudyRecords, TrialRecord};
use crate::design::Design;
use crate::session::Logged;
use cohelm::trajectory::{Trajectory, TrajectoryError};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::io::{Cursor, Read, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Version of the archive; whoever changes its meaning counts it up.
const FORMAT: u32 = 1;
/// Most bytes of one file in an archive: far above any, and little enough to be read into memory.
const LARGEST_FILE: u64 = 256 << 20;
/// Most bytes of all files together.
const LARGEST_ARCHIVE: u64 = 8 << 30;

/// Why bytes are no archive of a study.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// They are no zip file, or a damaged one.
    #[error("this is no archive of a study: {0}; `cohelm study export` writes one")]
    NotAnArchive(String),
    /// A file is missing.
    #[error("the archive has no file {0:?}; it was changed, or is no archive of a study")]
    Missing(String),
    /// A file is not what it should be.
    #[error("{file:?} in the archive cannot be read: {reason}")]
    Damaged {
        /// Which file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// A later version wrote it.
    #[error("the archive has format {0}, this program reads format {FORMAT}; use the version that wrote it")]
    Version(u32),
    /// A file is larger than any of ours.
    #[error("{file:?} in the archive is larger than {limit} bytes, which none of ours is")]
    TooLarge {
        /// Which file.
        file: String,
        /// How large it may be.
        limit: u64,
    },
}

/// What the other files are, in `versions.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Versions {
    archive: u32,
    program: String,
    written_by: String,
    design_sha256: String,
    participants: Vec<ParticipantEntry>,
    trials: Vec<TrialEntry>,
    models: Vec<String>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ParticipantEntry {
    id: i64,
    code: String,
    events: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TrialEntry {
    participant: i64,
    step: String,
    episode: i64,
    record: Option<String>,
    program: String,
}

/// The archive of a study: `design.toml`, `versions.json`, `events/`, `records/`, `models/` and the tables. `dataset` is the
/// one made of `records`. Equal records give equal bytes.
///
/// # Errors
/// A table that cannot be written; more than a zip file holds.
pub fn write_archive(records: &StudyRecords, dataset: &Dataset) -> Result<Vec<u8>, ExportError> {
    let failed = |error: &dyn std::fmt::Display| ExportError::Archive(error.to_string());
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    // The time of a file would be that of the export; the first moment that a zip file can name stands for none.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    for (name, bytes) in files(records, dataset)? {
        zip.start_file(name, options).map_err(|error| failed(&error))?;
        zip.write_all(&bytes).map_err(|error| failed(&error))?;
    }
    Ok(zip.finish().map_err(|error| failed(&error))?.into_inner())
}

fn files(records: &StudyRecords, dataset: &Dataset) -> Result<Vec<(String, Vec<u8>)>, ExportError> {
    let json = |error: serde_json::Error| ExportError::Archive(error.to_string());
    let versions = serde_json::to_vec_pretty(&versions(records)).map_err(json)?;
    let mut files = vec![
        ("versions.json".to_owned(), versions),
        ("design.toml".to_owned(), records.design.text.clone().into_bytes()),
    ];
    files.extend(super::tables(dataset)?);
    for participant in &records.participants {
        let mut lines = Vec::new();
        for logged in &participant.events {
            serde_json::to_writer(&mut lines, logged).map_err(json)?;
            lines.push(b'\n');
        }
        files.push((events_file(participant), lines));
    }
    for trial in &records.trials {
        files.extend(trial.record.clone().map(|bytes| (record_file(trial), bytes)));
    }
    files.extend(records.models.iter().map(|(hash, bytes)| (model_file(hash), bytes.clone())));
    Ok(files)
}

fn versions(records: &StudyRecords) -> Versions {
    let participant =
        |p: &ParticipantRecord| ParticipantEntry { id: p.id, code: p.code.clone(), events: events_file(p) };
    let trial = |t: &TrialRecord| TrialEntry {
        participant: t.participant,
        step: t.step.clone(),
        episode: t.episode,
        record: t.record.as_ref().map(|_| record_file(t)),
        program: t.program.clone(),
    };
    Versions {
        archive: FORMAT,
        program: records.program.clone(),
        written_by: format!("cohelm {}", env!("CARGO_PKG_VERSION")),
        design_sha256: records.design.hash(),
        participants: records.participants.iter().map(participant).collect(),
        trials: records.trials.iter().map(trial).collect(),
        models: records.models.iter().map(|(hash, _)| hash.clone()).collect(),
    }
}

fn events_file(participant: &ParticipantRecord) -> String {
    format!("events/{:06}.jsonl", participant.id)
}

fn record_file(trial: &TrialRecord) -> String {
    format!("records/{:06}.cohelm", trial.episode)
}

fn model_file(hash: &str) -> String {
    format!("models/{hash}.safetensors")
}

/// What was stored of a study, from its archive. The tables in it are not read: they follow from the rest.
///
/// # Errors
/// Bytes that are no archive, of a later version, incomplete, changed or too large.
pub fn read_archive(bytes: &[u8]) -> Result<StudyRecords, ArchiveError> {
    let mut reader = Reader::new(bytes)?;
    let versions: Versions = reader.json("versions.json")?;
    if versions.archive != FORMAT {
        return Err(ArchiveError::Version(versions.archive));
    }
    let design = design(&mut reader, &versions.design_sha256)?;
    let mut participants = Vec::new();
    for ParticipantEntry { id, code, events } in versions.participants {
        let events = reader.events(&events)?;
        participants.push(ParticipantRecord { id, code, events });
    }
    let mut trials = Vec::new();
    for TrialEntry { participant, step, episode, record, program } in versions.trials {
        let record = record.map(|file| reader.file(&file)).transpose()?;
        trials.push(TrialRecord { participant, step, episode, record, program });
    }
    let mut models = Vec::new();
    for hash in versions.models {
        let bytes = reader.file(&model_file(&hash))?;
        same_hash(&model_file(&hash), &bytes, &hash)?;
        models.push((hash, bytes));
    }
    Ok(StudyRecords { design, participants, trials, models, program: versions.program })
}

fn design(reader: &mut Reader<'_>, hash: &str) -> Result<Design, ArchiveError> {
    const FILE: &str = "design.toml";
    let bytes = reader.file(FILE)?;
    same_hash(FILE, &bytes, hash)?;
    let damaged = |reason: String| ArchiveError::Damaged { file: FILE.to_owned(), reason };
    let text = String::from_utf8(bytes).map_err(|error| damaged(error.to_string()))?;
    Design::from_toml(&text).map_err(|error| damaged(error.to_string()))
}

fn same_hash(file: &str, bytes: &[u8], expected: &str) -> Result<(), ArchiveError> {
    let found: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    if found == expected {
        return Ok(());
    }
    let reason = format!("its SHA-256 is {found}, and {expected} was expected; the file was changed");
    Err(ArchiveError::Damaged { file: file.to_owned(), reason })
}

/// Reads files by name, never more than is allowed, and writes nothing anywhere.
struct Reader<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    left: u64,
}

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8]) -> Result<Self, ArchiveError> {
        let zip = ZipArchive::new(Cursor::new(bytes))
            .map_err(|error| ArchiveError::NotAnArchive(error.to_string()))?;
        Ok(Self { zip, left: LARGEST_ARCHIVE })
    }

    fn file(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        let file = self.zip.by_name(name).map_err(|_| ArchiveError::Missing(name.to_owned()))?;
        let limit = LARGEST_FILE.min(self.left);
        let mut bytes = Vec::new();
        // What the archive says of a file's size may be a lie; what comes out of it is counted.
        let read = file.take(limit + 1).read_to_end(&mut bytes);
        read.map_err(|error| ArchiveError::Damaged { file: name.to_owned(), reason: error.to_string() })?;
        if bytes.len() as u64 > limit {
            return Err(ArchiveError::TooLarge { file: name.to_owned(), limit });
        }
        self.left -= bytes.len() as u64;
        Ok(bytes)
    }

    fn json<T: for<'de> Deserialize<'de>>(&mut self, name: &str) -> Result<T, ArchiveError> {
        let bytes = self.file(name)?;
        serde_json::from_slice(&bytes)
            .map_err(|error| ArchiveError::Damaged { file: name.to_owned(), reason: error.to_string() })
    }

    fn events(&mut self, name: &str) -> Result<Vec<Logged>, ArchiveError> {
        let bytes = self.file(name)?;
        let lines = bytes.split(|&byte| byte == b'\n').filter(|line| !line.is_empty());
        let read = |(i, line): (usize, &[u8])| {
            serde_json::from_slice(line).map_err(|error| ArchiveError::Damaged {
                file: name.to_owned(),
                reason: format!("line {}: {error}", i + 1),
            })
        };
        lines.enumerate().map(read).collect()
    }
}

/// The flights of a study with the models they name: what an intent model can be trained from.
#[derive(Debug, Clone)]
pub struct Flights {
    /// Every finished flight of participants who are neither tests nor excluded, practice included.
    pub trajectories: Vec<Trajectory>,
    /// The models they name: hash, file.
    pub models: Vec<(String, Vec<u8>)>,
}

/// The flights in an archive, to train from.
///
/// # Errors
/// As [`read_archive`]; a record that is damaged.
pub fn flights(bytes: &[u8]) -> Result<Flights, ArchiveError> {
    let records = read_archive(bytes)?;
    let unfit: Vec<i64> = records
        .participants
        .iter()
        .filter(|p| !fit_to_learn_from(&records.design, p))
        .map(|p| p.id)
        .collect();
    let mut trajectories = Vec::new();
    for trial in records.trials.iter().filter(|trial| !unfit.contains(&trial.participant)) {
        let Some(bytes) = &trial.record else { continue };
        let damaged = |error: TrajectoryError| ArchiveError::Damaged {
            file: record_file(trial),
            reason: error.to_string(),
        };
        trajectories.push(Trajectory::from_bytes(bytes).map_err(damaged)?);
    }
    Ok(Flights { trajectories, models: records.models })
}

fn fit_to_learn_from(design: &Design, participant: &ParticipantRecord) -> bool {
    let session = crate::session::Session::fold(design, &participant.events);
    session.is_ok_and(|session| !session.is_test() && session.excluded().is_none())
}
