//! Every stored episode flown again: the plant from what was carried out, the decisions from what was asked, the
//! requests from the keys. All three must give the same bits.

#[cfg(test)]
mod tests;

use crate::hangar::{Hangar, HangarError};
use crate::store::{Episode, EpisodeId, Page, Progress, StoreError, unpack};
use cohelm::flight::{Replay, replay};
use cohelm::registry::Plants;
use cohelm::tape;
use cohelm::trajectory::{FORMAT_VERSION, TAPED_FORMAT_VERSION, Trajectory, TrajectoryError};
use cohelm_copilot::{CockpitError, Models};
use futures_util::{StreamExt, TryStreamExt, stream};
use serde::Serialize;
use std::fmt;
use std::num::NonZeroUsize;
use std::thread::available_parallelism;

/// Rows read at once.
const ROWS: u32 = 500;

/// What flying one episode again showed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "verdict", rename_all = "kebab-case")]
pub enum Verdict {
    /// Every bit is the same.
    Identical,
    /// The plant was elsewhere, so nothing flies it again: its recorded states are whole, and from them the decisions and
    /// the requests come out the same.
    AsRecorded,
    /// Something differs.
    Different {
        /// What.
        what: String,
    },
    /// Another version of plant or format wrote it: it can be viewed where that version runs, and is not replayed here.
    OtherVersion {
        /// Which.
        version: String,
    },
    /// The plant went the same way, but a model that decided is not to be had, so the decisions were not checked.
    ModelMissing {
        /// Which.
        model: String,
    },
    /// The record cannot be read.
    Unreadable {
        /// Why.
        reason: String,
    },
}

/// What was found about all episodes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Report {
    /// Finished episodes.
    pub finished: usize,
    /// Those of which every bit is the same.
    pub identical: usize,
    /// Those of plants that were elsewhere, whose decisions and requests are identical from the recorded states.
    pub as_recorded: usize,
    /// Those in the air or interrupted, which have no record yet.
    pub in_the_air: usize,
    /// Those that were refused when they were flown.
    pub refused: usize,
    /// Every finished episode that is neither, and why; in the order of their numbers.
    pub others: Vec<(EpisodeId, Verdict)>,
}

impl Report {
    /// True if nothing differs and everything can be read.
    pub fn holds(&self) -> bool {
        !self.others.iter().any(|(_, v)| matches!(v, Verdict::Different { .. } | Verdict::Unreadable { .. }))
    }

    fn count(&self, alike: fn(&Verdict) -> bool) -> usize {
        self.others.iter().filter(|(_, verdict)| alike(verdict)).count()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "finished episodes      {:>8}", self.finished)?;
        writeln!(f, "  identical            {:>8}", self.identical)?;
        writeln!(f, "  from recorded states {:>8}", self.as_recorded)?;
        writeln!(f, "  different            {:>8}", self.count(|v| matches!(v, Verdict::Different { .. })))?;
        writeln!(
            f,
            "  of another version   {:>8}",
            self.count(|v| matches!(v, Verdict::OtherVersion { .. }))
        )?;
        writeln!(
            f,
            "  a model is missing   {:>8}",
            self.count(|v| matches!(v, Verdict::ModelMissing { .. }))
        )?;
        writeln!(f, "  unreadable           {:>8}", self.count(|v| matches!(v, Verdict::Unreadable { .. })))?;
        writeln!(f, "in the air, interrupted{:>8}", self.in_the_air)?;
        writeln!(f, "refused when flown     {:>8}", self.refused)?;
        for (id, verdict) in &self.others {
            writeln!(f, "episode {id}: {verdict}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Identical => write!(f, "identical"),
            Self::AsRecorded => {
                write!(f, "decided identically from the recorded states of a plant elsewhere")
            }
            Self::Different { what } => write!(f, "different: {what}"),
            Self::OtherVersion { version } => write!(f, "of another version: {version}"),
            Self::ModelMissing { model } => {
                write!(f, "the plant is identical, decisions were not checked: {model}")
            }
            Self::Unreadable { reason } => write!(f, "unreadable: {reason}"),
        }
    }
}

/// Flies every finished episode of the hangar's database again, on all cores; the report is the same for any number.
pub async fn verify_episodes(hangar: &Hangar) -> Result<Report, StoreError> {
    let mut report = Report::default();
    let mut page = Page::newest(ROWS);
    loop {
        let rows = hangar.store().episodes(page).await?;
        let Some(last) = rows.last() else { break };
        page.before = Some(last.id);
        let finished = rows.into_iter().filter(|row| report.note(row));
        let cores = available_parallelism().map_or(1, NonZeroUsize::get);
        let verdicts = stream::iter(finished.collect::<Vec<_>>()).map(|row| verify_episode(hangar, row));
        let verdicts: Vec<_> = verdicts.buffered(cores).try_collect().await?;
        for (id, verdict) in verdicts {
            match verdict {
                Verdict::Identical => report.identical += 1,
                Verdict::AsRecorded => report.as_recorded += 1,
                other => report.others.push((id, other)),
            }
        }
    }
    report.others.sort_by_key(|(id, _)| *id);
    Ok(report)
}

impl Report {
    /// Counts a row; true if it has a record to fly again.
    fn note(&mut self, row: &Episode) -> bool {
        match row.progress {
            Progress::Finished { .. } => self.finished += 1,
            Progress::InTheAir => self.in_the_air += 1,
            Progress::Refused { .. } => self.refused += 1,
        }
        matches!(row.progress, Progress::Finished { .. })
    }
}

/// Flies one finished episode again.
pub async fn verify_episode(hangar: &Hangar, row: Episode) -> Result<(EpisodeId, Verdict), StoreError> {
    let id = row.id;
    let Some(packed) = hangar.store().record(id).await? else {
        return Ok((id, Verdict::Unreadable { reason: "its record is missing".into() }));
    };
    let plants = hangar.plants().clone();
    let opened =
        tokio::task::spawn_blocking(move || open(&row, &packed, &plants).map(|flown| (flown, plants)));
    let (flown, plants) = match opened.await {
        Ok(Ok(opened)) => opened,
        Ok(Err(verdict)) => return Ok((id, verdict)),
        Err(panic) => return Ok((id, Verdict::Unreadable { reason: panic.to_string() })),
    };
    let models = match hangar.models_of(&flown.setup).await {
        Ok(models) => models,
        Err(HangarError::Store(error)) => return Err(error),
        // A model that cannot be read any more is as good as missing: the cockpit will say which.
        Err(_) => Models::new(),
    };
    let verdict = tokio::task::spawn_blocking(move || fly_again(&flown, &plants, &models)).await;
    Ok((id, verdict.unwrap_or_else(|panic| Verdict::Unreadable { reason: panic.to_string() })))
}

/// The trajectory of a record, if this version can replay it.
fn open(row: &Episode, packed: &[u8], plants: &Plants) -> Result<Trajectory, Verdict> {
    let unreadable = |reason: String| Verdict::Unreadable { reason };
    let other_version = |version: String| Verdict::OtherVersion { version };
    if ![FORMAT_VERSION, TAPED_FORMAT_VERSION].contains(&row.format) {
        return Err(other_version(format!("format {}, here {FORMAT_VERSION}", row.format)));
    }
    let elsewhere = tape::plants();
    let plants = if row.plant == tape::PLANT { &elsewhere } else { plants };
    let here = plants.entries().iter().find(|entry| entry.name == row.plant).map(|entry| entry.version);
    if here != Some(row.plant_version) {
        let here = here.map_or("there is none".into(), |version| format!("it is {version}"));
        return Err(other_version(format!("{} {}, here {here}", row.plant, row.plant_version)));
    }
    let bytes = unpack(packed).map_err(|error| unreadable(error.to_string()))?;
    let flown = Trajectory::from_bytes(&bytes).map_err(|error| match error {
        TrajectoryError::Version(version) => {
            other_version(format!("format {version}, here {FORMAT_VERSION}"))
        }
        error => unreadable(error.to_string()),
    })?;
    let same_setup = serde_json::to_value(&flown.setup).is_ok_and(|setup| setup == row.setup);
    let same_end = row.progress == Progress::Finished { ending: flown.ending };
    if !same_setup || !same_end || row.ticks as usize != flown.ticks() {
        return Err(Verdict::Different { what: "the list says otherwise than the record".into() });
    }
    Ok(flown)
}

fn fly_again(flown: &Trajectory, plants: &Plants, models: &Models) -> Verdict {
    let unreadable = |reason: String| Verdict::Unreadable { reason };
    let (mut plant, plants) = match flown.plant(plants) {
        Ok(made) => made,
        Err(error) => return unreadable(error.to_string()),
    };
    let (mut cockpit, missing) = match cohelm_copilot::cockpit(&flown.setup, plant.as_ref(), &plants, models)
    {
        Ok(cockpit) => (Some(cockpit), None),
        Err(error @ CockpitError::NoModel { .. }) => (None, Some(error.to_string())),
        Err(error) => return unreadable(error.to_string()),
    };
    let seen = replay(flown, plant.as_mut(), cockpit.as_mut());
    match (seen.identical(), missing) {
        (false, _) => Verdict::Different { what: differences(&seen) },
        (true, Some(model)) => Verdict::ModelMissing { model },
        (true, None) if flown.tape.is_some() => Verdict::AsRecorded,
        (true, None) => Verdict::Identical,
    }
}

fn differences(seen: &Replay) -> String {
    let parts = [
        (!seen.plant_identical).then_some("the plant's states, rewards or ending"),
        (seen.decisions_identical == Some(false)).then_some("the decisions"),
        (seen.requests_identical == Some(false)).then_some("the requests that the keys give"),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}
