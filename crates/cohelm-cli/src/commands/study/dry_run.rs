//! `cohelm study dry-run`: simulated participants go through the real server, from consent to thanks.

use super::data::records_of;
use super::export::{export, report};
use super::run::lessons;
use super::shelf::Shelf;
use crate::numbers::whole;
use crate::output::{Format, table};
use crate::rig;
use anyhow::{Context, Result, bail};
use clap::Args;
use cohelm::flight::Flight;
use cohelm::human::{Person, Population};
use cohelm::random::mix_seed;
use cohelm::trajectory::Setup;
use cohelm_copilot::cockpit;
use cohelm_lab::study::dataset;
use cohelm_server::hosts::Hosts;
use cohelm_server::page::Assets;
use cohelm_server::secret::{SecretHash, Token};
use cohelm_server::store::{Store, open};
use cohelm_server::visit::{Aloft, Desk, Manner, Pace, TakeOff, Visited, Visitor};
use cohelm_server::{Parts, Server, StudyRun, bind, serve};
use cohelm_study::dataset::{Dataset, StudyRecords};
use cohelm_study::design::Design;
use cohelm_study::session::{Event, Status};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use std::ffi::OsString;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tokio::sync::oneshot;
use tokio::task::JoinSet;

/// How long the server, which is in the same process, may take for an answer.
const PATIENCE: Duration = Duration::from_secs(60);

/// Sends simulated participants through the real server, from consent to thanks. They are marked as simulated wherever
/// they are shown; what a questionnaire asks they leave unanswered. Their database is one of their own.
#[derive(Args)]
pub struct DryRun {
    /// The study's file.
    file: PathBuf,
    /// Simulated participants; as many as are planned unless given.
    #[arg(long, value_parser = whole::<usize>)]
    participants: Option<usize>,
    /// Fixes who they are and how they fly. The orders and seeds of the study are the server's to draw.
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    seed: u64,
    /// What kind of simulated people fly.
    #[arg(long, default_value = "ordinary")]
    population: Population,
    /// Where everything is stored: a file, made if it is not there, or postgres://…; nowhere for good unless given.
    #[arg(long, value_name = "FILE|URL")]
    database: Option<OsString>,
    /// A folder for the export and the report; neither is written unless given.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// More models, files or folders, beside the shipped ones.
    #[arg(long = "model", value_name = "PATH")]
    models: Vec<PathBuf>,
    #[command(flatten)]
    format: Format,
}

/// Who goes through a study, and how.
pub struct Crowd {
    /// How many.
    pub participants: usize,
    /// Fixes who they are.
    pub seed: u64,
    /// What kind of people.
    pub population: Population,
    /// Whether somebody looks on.
    pub shows_progress: bool,
}

impl DryRun {
    /// Runs the command; fails if anybody did not get through.
    pub fn run(self) -> Result<ExitCode> {
        let shelf = Shelf::new(&self.models)?;
        let (design, _) = shelf.design(&self.file)?;
        let crowd = Crowd {
            participants: self.participants.unwrap_or(design.planned_participants as usize),
            seed: self.seed,
            population: self.population,
            shows_progress: self.format.shows_progress(),
        };
        let begun = Instant::now();
        let (visited, records) = crowd.walk(&design, shelf, self.database.clone())?;
        let took_s = begun.elapsed().as_secs_f64();
        let data = dataset(&records, &rig::plants(), 0)?;
        let mut files = Vec::new();
        if let Some(out) = &self.out {
            files.extend(export(&records, &data, out)?);
            files.extend(report(&data, out)?);
        }
        let through = visited.iter().filter(|visited| visited.status == Status::Completed).count();
        let summary = json!({
            "simulated": true, "study": design.name, "participants": visited.len(), "completed": through,
            "flights": visited.iter().map(|visited| visited.flights).sum::<u32>(), "took_s": took_s,
            "conditions": endings(&data), "folder": self.out, "files": files,
        });
        self.format.print(&summary, |summary| self.text(summary));
        Ok(if through == visited.len() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    fn text(&self, summary: &Value) -> String {
        let share =
            |value: &Value| value.as_f64().map_or("–".into(), |share| format!("{:.1} %", 100.0 * share));
        let rows: Vec<Vec<String>> = summary["conditions"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|row| {
                let name = row["condition"].as_str().unwrap_or_default().to_owned();
                let of = ["success", "crash", "elsewhere", "out_of_bounds", "time_limit"]
                    .map(|key| share(&row[key]));
                [vec![name, row["flights"].to_string()], of.to_vec()].concat()
            })
            .collect();
        let head = ["measured flights", "n", "goal", "crash", "elsewhere", "out", "time"];
        let written =
            self.out.as_ref().map_or(String::new(), |out| format!("\nwritten to {}", out.display()));
        format!(
            "The participants are simulated: nobody took part, and no question was answered.\n\n\
             {} of {} went from consent to thanks; {} flights in {:.1} s\n\n{}{written}",
            summary["completed"],
            summary["participants"],
            summary["flights"],
            summary["took_s"].as_f64().unwrap_or_default(),
            table(&head, &rows)
        )
    }
}

impl Crowd {
    /// Sends everybody through the study; gives how each visit ended and everything that is stored of them.
    pub fn walk(
        &self,
        design: &Design,
        shelf: Shelf,
        database: Option<OsString>,
    ) -> Result<(Vec<Visited>, StudyRecords)> {
        if self.participants == 0 {
            bail!("at least one participant is needed");
        }
        let folder = TempDir::new().context("cannot make a folder for the database")?;
        let database = database.unwrap_or_else(|| folder.path().join("dry-run.db").into());
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        runtime.block_on(async {
            let store = open(&database).await?;
            nobody_else(store.as_ref(), design).await?;
            let visited = self.visit(design, shelf, store.clone()).await;
            let records = records_of(store.as_ref(), Some(&design.hash())).await;
            store.close().await;
            Ok((visited?, records?))
        })
    }

    async fn visit(&self, design: &Design, shelf: Shelf, store: Arc<dyn Store>) -> Result<Vec<Visited>> {
        let listener = bind(SocketAddr::from(([127, 0, 0, 1], 0))).await?;
        let (address, secret) = (listener.local_addr()?, Token::draw()?);
        let shelf = Arc::new(shelf);
        let study = StudyRun {
            design: design.clone(),
            secret: SecretHash::of(secret.text())?,
            address: format!("http://{address}"),
        };
        let parts = Parts {
            lessons: lessons(design, &shelf, store.as_ref()).await?,
            store,
            plants: shelf.plants.clone(),
            models: shelf.models.clone(),
            hosts: Hosts::loopback(),
            assets: Assets::embedded(),
            study: Some(study),
        };
        let server = Server::start(parts).await?;
        let (stop, stopped) = oneshot::channel::<()>();
        let serving = tokio::spawn(serve(listener, server, async { drop(stopped.await) }));
        let visited = self.all(address, secret.text(), &shelf).await;
        // A server that has ended already hears nothing.
        let _ = stop.send(());
        serving.await??;
        visited
    }

    async fn all(&self, address: SocketAddr, secret: &str, shelf: &Arc<Shelf>) -> Result<Vec<Visited>> {
        let mut desk = Desk::open(address, secret).await?;
        let mut visits = JoinSet::new();
        for number in 0..self.participants {
            let (path, manner) = (desk.invite_simulated().await?, self.manner(shelf.clone(), number as u64));
            visits.spawn(async move { Visitor::join(address, &path, manner).await?.walk().await });
        }
        let bar = self.bar();
        let mut visited = Vec::new();
        while let Some(ended) = visits.join_next().await {
            visited.push(ended??);
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(visited)
    }

    fn manner(&self, shelf: Arc<Shelf>, number: u64) -> Manner {
        Manner {
            take_off: take_off(shelf, self.population, self.seed, number),
            pace: Pace::AsFastAsPossible,
            patience: PATIENCE,
            witness: Arc::new(|_, _| {}),
        }
    }

    fn bar(&self) -> ProgressBar {
        if !self.shows_progress {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::new(self.participants as u64);
        let style = ProgressStyle::with_template("simulated participants {wide_bar} {pos} of {len}");
        bar.set_style(style.expect("the template is fixed"));
        bar
    }
}

/// How participant `number` takes off: the same person for the same seed and number, whatever is flown.
pub fn take_off(shelf: Arc<Shelf>, population: Population, seed: u64, number: u64) -> Arc<TakeOff> {
    let who = Person { population, seed, index: number };
    Arc::new(move |setup: Setup| {
        let plant = shelf.plants.make(&setup.task).map_err(|error| error.to_string())?;
        let person = rig::simulated_person(&shelf.plants, &setup.task, plant.as_ref(), who)?;
        let made = cockpit(&setup, plant.as_ref(), &shelf.plants, &shelf.models);
        let pilot_seed = mix_seed(mix_seed(seed, number), setup.seed);
        let flight = Flight::new(setup, plant, made.map_err(|error| error.to_string())?);
        Aloft::new(flight, person, pilot_seed).map_err(|error| error.to_string())
    })
}

/// Simulated participants have a database of their own: nobody is to sort them out from among people later.
async fn nobody_else(store: &dyn Store, design: &Design) -> Result<()> {
    for participant in store.participants(&design.hash()).await? {
        let first = store.events(participant.id, 0).await?.into_iter().next();
        let first = first.and_then(|event| serde_json::from_str::<Event>(&event.json).ok());
        if !matches!(first, Some(Event::Invited { simulated: true, .. })) {
            bail!("people take part in this study in that database; name another with --database, or none");
        }
    }
    Ok(())
}

/// How the measured flights of each condition ended.
fn endings(data: &Dataset) -> Vec<Value> {
    let of = |(index, condition): (usize, &cohelm_study::design::Condition)| {
        let flights =
            data.trials.iter().filter(|trial| trial.counts && !trial.practice && trial.condition == index);
        let measured: Vec<_> = flights.filter_map(|trial| trial.measured.as_ref().ok()).collect();
        let share = |key: &str| {
            let sum: f64 = measured.iter().filter_map(|flight| flight.values.get(key)).sum();
            (!measured.is_empty()).then(|| sum / measured.len() as f64)
        };
        json!({
            "condition": condition.name, "flights": measured.len(), "success": share("success"),
            "crash": share("crash"), "elsewhere": share("elsewhere"), "out_of_bounds": share("out_of_bounds"),
            "time_limit": share("time_limit"),
        })
    };
    data.design.conditions.iter().enumerate().map(of).collect()
}
