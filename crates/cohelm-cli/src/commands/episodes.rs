//! `cohelm episodes`: what is stored.

use super::fly::open_existing;
use crate::numbers::whole;
use crate::output::{Format, table};
use crate::rig;
use anyhow::Result;
use clap::Args;
use cohelm_server::hangar::Hangar;
use cohelm_server::store::{Episode, Page, Progress, Store};
use cohelm_server::verify_episodes;
use std::path::PathBuf;
use std::process::ExitCode;

/// Lists stored episodes, newest first.
#[derive(Args)]
pub struct Episodes {
    /// Where flights are stored.
    #[arg(long, default_value = "cohelm.db", value_name = "FILE")]
    database: PathBuf,
    /// Most episodes to list.
    #[arg(long, default_value_t = 50, value_parser = whole::<u32>)]
    limit: u32,
    #[command(flatten)]
    format: Format,
}

impl Episodes {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let episodes = runtime.block_on(async {
            let store = open_existing(&self.database).await?;
            let episodes = store.episodes(Page::newest(self.limit)).await?;
            store.close().await;
            anyhow::Ok(episodes)
        })?;
        self.format.print(&episodes, |episodes| {
            let rows: Vec<Vec<String>> = episodes.iter().map(row).collect();
            table(&["episode", "plant", "rule", "pilot", "seed", "ticks", "time scale", "ending"], &rows)
        });
        Ok(ExitCode::SUCCESS)
    }
}

/// Flies stored episodes again.
#[derive(Args)]
pub struct VerifyEpisodes {
    /// Where flights are stored.
    #[arg(long, default_value = "cohelm.db", value_name = "FILE")]
    database: PathBuf,
    #[command(flatten)]
    format: Format,
}

impl VerifyEpisodes {
    /// Runs the command; fails if anything differs or cannot be read.
    pub fn run(self) -> Result<ExitCode> {
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        let report = runtime.block_on(async {
            let store = open_existing(&self.database).await?;
            let hangar = Hangar::new(rig::plants(), rig::models(&[])?, store.clone());
            let report = verify_episodes(&hangar).await?;
            store.close().await;
            anyhow::Ok(report)
        })?;
        self.format.print(&report, ToString::to_string);
        Ok(if report.holds() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}

fn row(episode: &Episode) -> Vec<String> {
    let ending = match &episode.progress {
        Progress::InTheAir => "under way".into(),
        Progress::Finished { ending } => ending.word().into(),
        Progress::Refused { .. } => "refused".into(),
    };
    vec![
        episode.id.0.to_string(),
        episode.plant.clone(),
        episode.rule.clone(),
        episode.pilot.clone(),
        episode.seed.to_string(),
        episode.ticks.to_string(),
        format!("{}×", episode.time_scale),
        ending,
    ]
}
