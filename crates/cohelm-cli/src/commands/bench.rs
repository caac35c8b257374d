//! `cohelm bench`: speed on this machine, with what it is compared with beside it.

mod axes;
mod serve;

use crate::numbers::whole;
use crate::output::{Format, table};
use anyhow::{Context, Result, bail};
use clap::{Args, Subcommand};
use cohelm_lander::bench::{RandomFlights, random_flights, random_flights_together};
use cohelm_nn::bench::{Timings, measure};
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

/// Worlds that `bench lander` steps at once.
const WORLDS: usize = 64;

/// What to measure.
#[derive(Subcommand)]
pub enum Bench {
    /// Steps a second of the lander on one core, one world and 64 at once: random actions, resets included; Gymnasium's beside it.
    Lander(Lander),
    /// A training step of each network beside the machine's floor, and a decision of the control loop.
    Nets(Nets),
    /// How long a server lets people wait while hundreds of them fly at once, and what each costs it.
    Serve(serve::Serve),
}

/// Options of `bench lander`.
#[derive(Args)]
pub struct Lander {
    /// A Python that has `gymnasium[box2d]==1.4.0`; without it only ours is measured.
    #[arg(long, value_name = "PYTHON")]
    gymnasium: Option<PathBuf>,
    /// Interleaved runs of each, of which the median is taken.
    #[arg(long, default_value_t = 5, value_parser = whole::<usize>)]
    runs: usize,
    /// Steps a run.
    #[arg(long, default_value_t = 100_000, value_parser = whole::<u32>)]
    steps: u32,
    #[command(flatten)]
    format: Format,
}

/// Options of `bench nets`.
#[derive(Args)]
pub struct Nets {
    /// Runs of each, of which the median is taken.
    #[arg(long, default_value_t = 30, value_parser = whole::<usize>)]
    runs: usize,
    #[command(flatten)]
    format: Format,
}

impl Bench {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        match self {
            Self::Lander(lander) => lander.run(),
            Self::Nets(nets) => nets.run(),
            Self::Serve(serve) => serve.run(),
        }
    }
}

impl Lander {
    fn run(self) -> Result<ExitCode> {
        if self.runs == 0 || self.steps == 0 {
            bail!("at least one run of one step is needed");
        }
        let (mut ours, mut together, mut theirs) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..self.runs {
            ours.push(rate(self.steps, random_flights));
            together.push(rate(self.steps, |steps, seed| random_flights_together(WORLDS, steps, seed)));
            if let Some(python) = &self.gymnasium {
                theirs.push(gymnasium_rate(python, self.steps)?);
            }
        }
        let theirs = (!theirs.is_empty()).then(|| median(&mut theirs));
        let times = |rate: f64| theirs.map(|theirs| rate / theirs);
        let (ours, together) = (median(&mut ours), median(&mut together));
        let report = json!({
            "steps": self.steps, "runs": self.runs, "cohelm_steps_per_s": ours,
            "cohelm_together_steps_per_s": together, "gymnasium_steps_per_s": theirs, "ratio": times(ours),
            "together_ratio": times(together),
        });
        self.format.print(&report, |_| {
            let row = |name: &str, rate: f64| {
                vec![name.into(), format!("{rate:.0}"), times(rate).map_or("–".into(), |times| format!("{times:.2}"))]
            };
            let mut rows = vec![row("cohelm", ours), row(&format!("cohelm, {WORLDS} worlds at once"), together)];
            rows.extend(theirs.map(|theirs| row("gymnasium 1.4.0", theirs)));
            let heading = format!(
                "LunarLander-v3, one core, random actions, resets included; median of {} interleaved runs of {} steps",
                self.runs, self.steps
            );
            format!("{heading}\n\n{}", table(&["", "steps a second", "times"], &rows))
        });
        Ok(ExitCode::SUCCESS)
    }
}

/// Steps a second of our lander, given how to fly so many with a seed.
fn rate(steps: u32, fly: impl Fn(u32, u64) -> RandomFlights) -> f64 {
    let begun = Instant::now();
    std::hint::black_box(fly(steps, 0));
    f64::from(steps) / begun.elapsed().as_secs_f64()
}

/// Steps a second of Gymnasium, measured by the script that is part of this program.
fn gymnasium_rate(python: &Path, steps: u32) -> Result<f64> {
    let script = include_str!("../../../cohelm-lander/bench/gymnasium_rate.py");
    let mut child = Command::new(python)
        .args(["-", &steps.to_string()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot run {}", python.display()))?;
    // A Python that ends before it has read the script says why on its standard error.
    let _ = child.stdin.take().context("the script could not be handed over")?.write_all(script.as_bytes());
    let output = child.wait_with_output()?;
    if !output.status.success() {
        let told = String::from_utf8_lossy(&output.stderr);
        let reason = told.trim_end().lines().last().unwrap_or("it does not say why");
        bail!(
            "{} cannot fly Gymnasium's lander ({reason}); it needs gymnasium[box2d]==1.4.0",
            python.display()
        );
    }
    let report: serde_json::Value =
        serde_json::from_slice(&output.stdout).context("the script printed no JSON")?;
    report["steps_per_s"].as_f64().context("the script printed no rate")
}

fn median(rates: &mut [f64]) -> f64 {
    rates.sort_by(f64::total_cmp);
    rates[rates.len() / 2]
}

impl Nets {
    fn run(self) -> Result<ExitCode> {
        if self.runs == 0 {
            bail!("at least one run is needed");
        }
        let mut measured = measure(self.runs);
        measured.timings.push(axes::decision(self.runs)?);
        let timing = |timing: &cohelm_nn::bench::Timing| {
            json!({
                "name": timing.name, "median_us": timing.median_us, "best_us": timing.best_us,
                "floor_us": timing.floor_us, "times_floor": timing.floor_us.map(|floor| timing.median_us / floor),
            })
        };
        let timings: Vec<_> = measured.timings.iter().map(timing).collect();
        let report = json!({ "kernel": measured.kernel, "gflops": measured.gflops, "timings": timings });
        self.format.print(&report, |_| nets_text(&measured));
        Ok(ExitCode::SUCCESS)
    }
}

fn nets_text(measured: &Timings) -> String {
    let rows: Vec<Vec<String>> = measured
        .timings
        .iter()
        .map(|timing| {
            let floor = timing.floor_us.map_or("–".into(), |floor| format!("{floor:.1}"));
            let times =
                timing.floor_us.map_or("–".into(), |floor| format!("{:.2}", timing.median_us / floor));
            vec![
                timing.name.into(),
                format!("{:.2}", timing.median_us),
                format!("{:.2}", timing.best_us),
                floor,
                times,
            ]
        })
        .collect();
    let heading = format!("one core, kernel {}, floor at {:.0} GFLOP/s", measured.kernel, measured.gflops);
    format!("{heading}\n\n{}", table(&["", "median µs", "best µs", "floor µs", "times floor"], &rows))
}
