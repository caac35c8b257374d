//! `cohelm verify kills`: a server killed at random moments while simulated participants fly, and what it acknowledged
//! held against what its database has.

mod ledger;

use super::study::dry_run::take_off;
use super::study::shelf::Shelf;
use crate::numbers::whole;
use crate::output::Format;
use crate::server_process::ServerProcess;
use anyhow::{Context, Result, bail};
use clap::Args;
use cohelm::human::Population;
use cohelm::random::Draws;
use cohelm_server::hangar::Hangar;
use cohelm_server::secret::Token;
use cohelm_server::store::open_existing;
use cohelm_server::verify_episodes;
use cohelm_server::visit::{Desk, Manner, Pace, VisitError, Visited, Visitor};
use cohelm_study::design::Design;
use cohelm_study::session::Status;
use ledger::{Counts, Ledger};
use serde::Serialize;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tempfile::TempDir;
use tokio::task::{JoinSet, block_in_place};
use tokio::time::sleep;

/// What is flown.
const STUDY: &str = include_str!("kills/kills.toml");
/// How long participants look for a server that is away: far longer than it takes to start one.
const PATIENCE: Duration = Duration::from_secs(60);
/// A server lives for a time between these after it is ready, and is away for one between the others, seconds.
const LIVES_S: [f64; 2] = [0.3, 3.5];
const AWAY_S: [f64; 2] = [0.0, 0.7];
/// Seconds that the shortest visit takes: so many participants are invited that none of the lanes runs empty.
const SHORTEST_VISIT_S: f64 = 15.0;

/// Kills a server of this program (SIGKILL) at random moments while simulated participants fly a short study in real time,
/// and starts it again. Participants note every acknowledgement; after each kill all of them are looked for in the
/// database. In the end everybody must have come through, and every flight is flown again.
#[derive(Args)]
pub struct Kills {
    /// How often it is killed.
    #[arg(long, default_value_t = 5, value_parser = whole::<usize>)]
    rounds: usize,
    /// How many fly at once; whoever is through is followed by the next, until the last round is over.
    #[arg(long, default_value_t = 12, value_parser = whole::<usize>)]
    participants: usize,
    /// Fixes participants and the moments of the kills.
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    seed: u64,
    #[command(flatten)]
    format: Format,
}

/// What was seen.
#[derive(Serialize)]
struct Report {
    simulated_pilots: bool,
    seed: u64,
    rounds: usize,
    acknowledged: Counts,
    /// What was acknowledged and is not in the database, or is there by half; in words.
    lost: Vec<String>,
    participants: usize,
    completed: usize,
    episodes: usize,
    identical: usize,
    holds: bool,
}

/// A server that is started again and again on one database and one port.
struct Phoenix {
    folder: TempDir,
    address: SocketAddr,
    secret: Token,
}

impl Kills {
    /// Runs the command; fails if anything was lost or anybody stuck.
    pub fn run(self) -> Result<ExitCode> {
        if self.rounds == 0 || self.participants == 0 {
            bail!("at least one round with one participant is needed");
        }
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        let report = runtime.block_on(self.measure())?;
        self.format.print(&report, text);
        Ok(if report.holds { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    async fn measure(&self) -> Result<Report> {
        let phoenix = Phoenix::new()?;
        let study = Design::from_toml(STUDY)?.hash();
        let (ledger, over) = (Arc::new(Ledger::default()), Arc::new(AtomicBool::new(false)));
        let server = phoenix.start()?;
        let links = self.invite(&phoenix).await?;
        let lanes = self.lanes(&phoenix, links, &ledger, &over)?;
        let (mut draws, mut server, mut lost) = (Draws::new(self.seed), server, Vec::new());
        for round in 1..=self.rounds {
            sleep(Duration::from_secs_f64(draws.uniform(LIVES_S[0], LIVES_S[1]))).await;
            block_in_place(|| server.kill());
            let losses = phoenix.hold_against(&ledger, &study).await?;
            lost.extend(losses.into_iter().map(|loss| format!("round {round}: {loss}")));
            sleep(Duration::from_secs_f64(draws.uniform(AWAY_S[0], AWAY_S[1]))).await;
            server = block_in_place(|| phoenix.start())?;
            if self.format.shows_progress() {
                eprintln!("round {round} of {}: {} lost", self.rounds, lost.len());
            }
        }
        over.store(true, Ordering::Relaxed);
        let visited = ended(lanes).await?;
        server.kill();
        lost.extend(phoenix.hold_against(&ledger, &study).await?);
        let verified = phoenix.verify().await?;
        let completed = visited.iter().filter(|visited| visited.status == Status::Completed).count();
        let well = verified.identical == verified.finished && verified.refused == 0;
        Ok(Report {
            simulated_pilots: true,
            seed: self.seed,
            rounds: self.rounds,
            acknowledged: ledger.counts(),
            holds: lost.is_empty() && completed == visited.len() && well,
            lost,
            participants: visited.len(),
            completed,
            episodes: verified.finished,
            identical: verified.identical,
        })
    }

    /// For each lane the links of those who fly in it one after the other.
    async fn invite(&self, phoenix: &Phoenix) -> Result<Vec<Vec<String>>> {
        let longest_s = self.rounds as f64 * (LIVES_S[1] + AWAY_S[1] + 1.0);
        let each = (longest_s / SHORTEST_VISIT_S).ceil() as usize + 1;
        let mut desk = Desk::open(phoenix.address, phoenix.secret.text()).await?;
        let mut lanes = Vec::new();
        for _ in 0..self.participants {
            let mut links = Vec::new();
            for _ in 0..each {
                links.push(desk.invite_simulated().await?);
            }
            lanes.push(links);
        }
        Ok(lanes)
    }

    /// Sets everybody going.
    fn lanes(
        &self,
        phoenix: &Phoenix,
        links: Vec<Vec<String>>,
        ledger: &Arc<Ledger>,
        over: &Arc<AtomicBool>,
    ) -> Result<JoinSet<Result<Vec<Visited>, VisitError>>> {
        let shelf = Arc::new(Shelf::new(&[])?);
        let mut lanes = JoinSet::new();
        for (number, links) in links.into_iter().enumerate() {
            let ledger = ledger.clone();
            let manner = Manner {
                take_off: take_off(shelf.clone(), Population::Ordinary, self.seed, number as u64),
                pace: Pace::RealTime,
                patience: PATIENCE,
                witness: Arc::new(move |participant, heard| ledger.note(participant, heard)),
            };
            lanes.spawn(lane(phoenix.address, links, manner, over.clone()));
        }
        Ok(lanes)
    }
}

/// One after the other goes through the study, until it is over; whoever has begun comes to the end.
async fn lane(
    address: SocketAddr,
    links: Vec<String>,
    manner: Manner,
    over: Arc<AtomicBool>,
) -> Result<Vec<Visited>, VisitError> {
    let mut visited = Vec::new();
    for link in links {
        visited.push(Visitor::join(address, &link, manner.clone()).await?.walk().await?);
        if over.load(Ordering::Relaxed) {
            break;
        }
    }
    Ok(visited)
}

async fn ended(mut lanes: JoinSet<Result<Vec<Visited>, VisitError>>) -> Result<Vec<Visited>> {
    let mut visited = Vec::new();
    while let Some(lane) = lanes.join_next().await {
        visited.extend(lane??);
    }
    Ok(visited)
}

impl Phoenix {
    fn new() -> Result<Self> {
        let folder = TempDir::new().context("cannot make a folder for the database")?;
        // Free a moment ago; nobody else is likely to take it before the server does.
        let address = TcpListener::bind(("127.0.0.1", 0))?.local_addr()?;
        let phoenix = Self { folder, address, secret: Token::draw()? };
        std::fs::write(phoenix.file("kills.toml"), STUDY)?;
        std::fs::write(phoenix.file("secret"), phoenix.secret.text())?;
        Ok(phoenix)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn start(&self) -> Result<ServerProcess> {
        let (study, database, secret) = (self.file("kills.toml"), self.file("kills.db"), self.file("secret"));
        ServerProcess::start([
            "study".as_ref(),
            "run".as_ref(),
            study.as_os_str(),
            "--port".as_ref(),
            self.address.port().to_string().as_ref(),
            "--database".as_ref(),
            database.as_os_str(),
            "--secret-file".as_ref(),
            secret.as_os_str(),
        ])
    }

    async fn hold_against(&self, ledger: &Ledger, study: &str) -> Result<Vec<String>> {
        let store = open_existing(self.file("kills.db")).await?;
        let losses = ledger.hold_against(store.as_ref(), study).await;
        store.close().await;
        losses
    }

    async fn verify(&self) -> Result<cohelm_server::verify::Report> {
        let store = open_existing(self.file("kills.db")).await?;
        let shelf = Shelf::new(&[])?;
        let report = verify_episodes(&Hangar::new(shelf.plants, shelf.models, store.clone())).await?;
        store.close().await;
        Ok(report)
    }
}

fn text(report: &Report) -> String {
    let Report { seed, rounds, acknowledged, lost, participants, completed, episodes, identical, .. } =
        report;
    let losses = lost.iter().map(|loss| format!("\n  {loss}")).collect::<String>();
    let verdict = if report.holds { "holds" } else { "DOES NOT HOLD" };
    format!(
        "{rounds} kills (seed {seed}) while simulated participants flew in real time\n\
         acknowledged: {} pieces of key logs, {} flights, {} steps; {} flights taken up again in the air\n\
         lost or stored by half: {}{losses}\n\
         {completed} of {participants} participants who began came through\n\
         {episodes} flights stored and flown again, {identical} identical\n\
         {verdict}",
        acknowledged.pieces,
        acknowledged.flights,
        acknowledged.steps,
        acknowledged.resumed,
        lost.len()
    )
}
