//! `cohelm bench serve`: how long a server lets people wait while hundreds fly at once.

use crate::commands::evaluate::threads;
use crate::commands::fly::open_existing;
use crate::numbers::whole;
use crate::output::{Format, table};
use crate::rig;
use crate::server_process::{ServerProcess, Usage, own_usage};
use anyhow::{Context, Result, bail};
use clap::Args;
use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::flight::Flight;
use cohelm::human::{Person, Population};
use cohelm::intent::Inference;
use cohelm::plant::Plant;
use cohelm::random::mix_seed;
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::{MAX_SEED, Setup};
use cohelm_copilot::{Kind, Models, cockpit};
use cohelm_lab::parallel;
use cohelm_server::hangar::Hangar;
use cohelm_server::store::FlightKey;
use cohelm_server::verify_episodes;
use cohelm_server::visit::load::{Waits, connect, fly};
use cohelm_server::visit::{Aloft, Planned};
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The plant that is flown.
const PLANT: &str = "flag-lander";
/// Participants come from a draw of their own.
const PARTICIPANTS: u64 = 0x6c6f_6164;

/// Starts a server of this program on a new database, lets simulated participants fly against it in real time, each on a
/// connection of its own, and flies every stored episode again. Fails if one differs, or if the waits exceed the bound.
#[derive(Args)]
pub struct Serve {
    /// How many fly at once, one flight after the other without a pause.
    #[arg(long, default_value_t = 500, value_parser = whole::<usize>)]
    participants: usize,
    /// For how long.
    #[arg(long, default_value_t = 20, value_parser = whole::<u32>)]
    seconds: u32,
    /// How long 99 % of the waits from the end of a second of flight to its acknowledgement may last.
    #[arg(long, default_value_t = 200.0, value_name = "MS")]
    bound: f64,
    /// Fixes participants and flights.
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    seed: u64,
    #[command(flatten)]
    format: Format,
}

/// What was measured.
#[derive(Serialize)]
struct Report {
    simulated_pilots: bool,
    participants: usize,
    seconds: u32,
    cores: usize,
    flights: usize,
    ticks: u64,
    /// From the end of a second of flight to its acknowledgement.
    lag_ms: Spread,
    /// From the end of a flight to the word that its record is stored.
    end_ms: Spread,
    /// By how much the measuring side was late in sending; part of the above.
    sender_late_ms: Spread,
    bound_ms: f64,
    server: Option<Cost>,
    /// Processors that the measuring side kept busy, on average.
    sender_cores: Option<f64>,
    episodes_stored: usize,
    episodes_identical: usize,
    holds: bool,
}

/// The distribution of waits, milliseconds.
#[derive(Serialize)]
struct Spread {
    count: usize,
    p50: f64,
    p99: f64,
    max: f64,
}

/// What the participants cost the server.
#[derive(Serialize)]
struct Cost {
    /// Memory before anybody was connected, MiB.
    memory_before_mib: f64,
    /// The most while they flew, MiB.
    memory_peak_mib: f64,
    /// What each added to it, KiB.
    memory_per_participant_kib: f64,
    /// Processors that it kept busy, on average.
    cores: f64,
}

impl Serve {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        if self.participants == 0 || self.seconds == 0 {
            bail!("at least one participant must fly for at least one second");
        }
        if self.bound.is_nan() || self.bound <= 0.0 {
            bail!("the bound must be a positive number of milliseconds, got {}", self.bound);
        }
        let folder = TempDir::new().context("cannot make a folder for the database")?;
        let database = folder.path().join("flights.db");
        let rotas = self.plan()?;
        let (flights, ticks) = totals(&rotas);
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        let mut server = start(&database)?;
        let (waits, server_cost, sender_cores) = runtime.block_on(self.measure(&server, rotas))?;
        server.kill();
        let verified = runtime.block_on(verify(&database))?;
        let (lag_ms, cores) = (spread(waits.pieces_ms), threads(0).get());
        let all_identical = verified.identical == flights && verified.finished == flights;
        let report = Report {
            simulated_pilots: true,
            participants: self.participants,
            seconds: self.seconds,
            cores,
            flights,
            ticks,
            holds: all_identical && lag_ms.p99 < self.bound,
            lag_ms,
            end_ms: spread(waits.ends_ms),
            sender_late_ms: spread(waits.late_ms),
            bound_ms: self.bound,
            server: server_cost,
            sender_cores,
            episodes_stored: verified.finished,
            episodes_identical: verified.identical,
        };
        self.format.print(&report, text);
        Ok(if report.holds { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    /// What every participant flies, and when it begins: spread over a second, as people are.
    fn plan(&self) -> Result<Vec<(Duration, Vec<Planned>)>> {
        let (plants, models) = (rig::plants(), rig::models(&[])?);
        let crew = Crew::new(&plants, &models, self.seed)?;
        let rotas = parallel::run(self.participants, 0, |number| crew.rota(number, self.seconds));
        let part = 1.0 / self.participants as f64;
        let begin = |number: usize| Duration::from_secs_f64(number as f64 * part);
        rotas.into_iter().enumerate().map(|(number, rota)| Ok((begin(number), rota?))).collect()
    }

    async fn measure(
        &self,
        server: &ServerProcess,
        rotas: Vec<(Duration, Vec<Planned>)>,
    ) -> Result<(Waits, Option<Cost>, Option<f64>)> {
        let before = server.usage();
        let lines = connect(server.address, self.participants).await?;
        let (server_begin, own_begin, begun) = (server.usage(), own_usage(), Instant::now());
        let waits = fly(lines, rotas).await?;
        let took_s = begun.elapsed().as_secs_f64();
        let busy = |begin: Option<Usage>, end: Option<Usage>| Some((end?.cpu_s - begin?.cpu_s) / took_s);
        let after = server.usage();
        let cost = before.zip(after).zip(busy(server_begin, after)).map(|((before, after), cores)| Cost {
            memory_before_mib: before.memory_kib / 1024.0,
            memory_peak_mib: after.peak_kib / 1024.0,
            memory_per_participant_kib: (after.peak_kib - before.memory_kib) / self.participants as f64,
            cores,
        });
        Ok((waits, cost, busy(own_begin, own_usage())))
    }
}

/// The task and who flies it.
struct Crew<'a> {
    plants: &'a Plants,
    models: &'a Models,
    setup: Setup,
    ticks_per_second: f64,
}

impl<'a> Crew<'a> {
    fn new(plants: &'a Plants, models: &'a Models, seed: u64) -> Result<Self> {
        let task = Task::new(PLANT);
        let plant = plants.make(&task)?;
        let hash = |kind| -> Result<Option<String>> {
            Ok(Some(rig::model_for(models, kind, &task, plant.space())?.hash().into()))
        };
        let setup = Setup {
            plant_version: plants.entry(&task)?.version,
            seed,
            rule: Rule::Misc,
            inference: Inference::InverseDistance,
            silence: Silence::Best,
            time_scale: 1.0,
            values: hash(Kind::Values)?,
            intent: hash(Kind::Intent)?,
            pilot: "simulated person".into(),
            task,
        };
        Ok(Self { plants, models, setup, ticks_per_second: plant.ticks_per_second() })
    }

    /// Flights that fill so many seconds; the last is given up where they end.
    fn rota(&self, number: usize, seconds: u32) -> Result<Vec<Planned>> {
        let mut left = (f64::from(seconds) * self.ticks_per_second) as u32;
        let mut flights = Vec::new();
        while left > 0 {
            let flown = self.flight(number as u64, flights.len() as u64, left)?;
            left -= flown.ticks().min(left);
            flights.push(flown);
        }
        Ok(flights)
    }

    fn flight(&self, number: u64, flight: u64, most_ticks: u32) -> Result<Planned> {
        let seed = mix_seed(mix_seed(self.setup.seed, number), flight) % MAX_SEED;
        let setup = Setup { seed, ..self.setup.clone() };
        let plant = self.plants.make(&setup.task)?;
        let person = self.person(plant.as_ref(), number)?;
        let cockpit = cockpit(&setup, plant.as_ref(), self.plants, self.models)?;
        let aloft = Aloft::new(Flight::new(setup, plant, cockpit), person, seed)?;
        let mut key = [0; 16];
        key[..8].copy_from_slice(&number.to_le_bytes());
        key[8..].copy_from_slice(&flight.to_le_bytes());
        Ok(Planned::fly(aloft, FlightKey(key), most_ticks))
    }

    fn person(&self, plant: &dyn Plant, number: u64) -> Result<Box<dyn cohelm::pilot::Pilot>> {
        let seed = mix_seed(self.setup.seed, PARTICIPANTS);
        let who = Person { population: Population::Ordinary, seed, index: number };
        rig::simulated_person(self.plants, &self.setup.task, plant, who).map_err(anyhow::Error::msg)
    }
}

fn totals(rotas: &[(Duration, Vec<Planned>)]) -> (usize, u64) {
    let flights = || rotas.iter().flat_map(|(_, flights)| flights);
    (flights().count(), flights().map(|flight| u64::from(flight.ticks())).sum())
}

fn start(database: &Path) -> Result<ServerProcess> {
    let database = database.as_os_str();
    ServerProcess::start(["fly".as_ref(), "--port".as_ref(), "0".as_ref(), "--database".as_ref(), database])
}

async fn verify(database: &Path) -> Result<cohelm_server::verify::Report> {
    let store = open_existing(database).await?;
    let report = verify_episodes(&Hangar::new(rig::plants(), rig::models(&[])?, store.clone())).await?;
    store.close().await;
    Ok(report)
}

fn spread(mut waits_ms: Vec<f64>) -> Spread {
    waits_ms.sort_by(f64::total_cmp);
    // The smallest wait that so large a part of all does not exceed.
    let at = |part: f64| {
        let rank = (part * waits_ms.len() as f64).ceil() as usize;
        waits_ms.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
    };
    Spread { count: waits_ms.len(), p50: at(0.5), p99: at(0.99), max: at(1.0) }
}

fn text(report: &Report) -> String {
    let row = |name: &str, spread: &Spread| -> Vec<String> {
        let times = [spread.p50, spread.p99, spread.max].map(|ms| format!("{ms:.1}"));
        [vec![name.into(), spread.count.to_string()], times.to_vec()].concat()
    };
    let rows = [
        row("a second of flight → acknowledged", &report.lag_ms),
        row("end of a flight → stored", &report.end_ms),
        row("of these, the measuring side's own delay", &report.sender_late_ms),
    ];
    let waits = table(&["waits, ms", "n", "p50", "p99", "max"], &rows);
    let cost = report.server.as_ref().map_or("memory and processors: not measured here".into(), |cost| {
        format!(
            "server: {:.0} KiB a participant ({:.0} MiB before, {:.0} MiB at most), {:.2} of {} cores",
            cost.memory_per_participant_kib,
            cost.memory_before_mib,
            cost.memory_peak_mib,
            cost.cores,
            report.cores
        )
    });
    let sender = report.sender_cores.map_or(String::new(), |cores| format!("; measuring side {cores:.2}"));
    let verdict = if report.holds { "holds" } else { "DOES NOT HOLD" };
    format!(
        "{} simulated participants flew for {} s at once: {} flights, {} ticks\n\n{waits}\n\n{cost}{sender}\n\
         {} of {} flights stored and flown again, {} identical\nbound: p99 < {:.0} ms and every flight identical: {verdict}",
        report.participants,
        report.seconds,
        report.flights,
        report.ticks,
        report.episodes_stored,
        report.flights,
        report.episodes_identical,
        report.bound_ms
    )
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn a_percentile_is_the_smallest_value_that_so_many_do_not_exceed() {
        let of = |waits: &[f64]| {
            let spread = spread(waits.to_vec());
            [spread.p50, spread.p99, spread.max]
        };
        assert_eq!(of(&[3.0]), [3.0; 3]);
        assert_eq!(of(&[4.0, 1.0, 3.0, 2.0]), [2.0, 4.0, 4.0]);
        let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(of(&hundred), [50.0, 99.0, 100.0]);
    }
}
