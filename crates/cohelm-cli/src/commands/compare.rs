//! `cohelm compare`: every rule on the same bench, tuned on the same episodes, told on people held out from tuning.

use super::reproduce::write;
use crate::numbers::whole;
use crate::output::{Format, table};
use crate::rig;
use anyhow::{Context, Result, bail};
use clap::Args;
use cohelm_lab::compare::{
    Bench, Budget, CompareError, Compared, Comparison, HeldOut, Making, document, files,
};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Compares every rule of arbitration on every plant that has simulated people and models: each tuned by at most nine settings
/// on the same episodes, told on kinds of people and seeds that tuning never saw. Writes a folder: report, figures, tables.
#[derive(Args)]
pub struct Compare {
    /// Simulated people of each kind.
    #[arg(long, default_value_t = 5, value_parser = whole::<usize>)]
    participants: usize,
    /// Episodes of each under every rule that is told.
    #[arg(long, default_value_t = 6, value_parser = whole::<usize>)]
    episodes: usize,
    /// Episodes of each under every setting that tuning tries.
    #[arg(long, default_value_t = 3, value_parser = whole::<usize>)]
    tuning_episodes: usize,
    /// Only benches whose name begins so, such as flag-lander; may be given again.
    #[arg(long = "bench", value_name = "NAME")]
    benches: Vec<String>,
    /// Another value or intent model than the shipped ones; may be given again.
    #[arg(long = "model", value_name = "FILE")]
    models: Vec<PathBuf>,
    /// The folder to write into.
    #[arg(long, value_name = "FOLDER", default_value = "compare")]
    out: PathBuf,
    /// Threads, which change nothing but the time; 0 for one a core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>)]
    threads: usize,
    #[command(flatten)]
    format: Format,
}

impl Compare {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        let begun = Instant::now();
        let (plants, models) = (rig::plants(), rig::models(&self.models)?);
        let budget = self.budget()?;
        let comparison = Comparison {
            plants: &plants,
            models: &models,
            draws: HeldOut::committed(),
            budget,
            threads: self.threads,
        };
        let mut all = Vec::new();
        let chosen = self.chosen(Bench::all(&plants, &models))?;
        if self.format.shows_progress() {
            eprintln!(
                "{} benches; the folder is written at the end, Ctrl-C before leaves nothing",
                chosen.len()
            );
        }
        for bench in chosen {
            all.push(comparison.run(&bench)?);
            if self.format.shows_progress() {
                eprintln!("{:5.1} s  {}", begun.elapsed().as_secs_f64(), bench.name);
            }
        }
        self.write_folder(&all, &comparison, &self.out)?;
        let took_s = begun.elapsed().as_secs_f64();
        let summary = json!({
            "simulated_pilots": true, "took_s": took_s, "folder": self.out, "draws": comparison.draws, "budget": budget,
            "benches": all.iter().map(told).collect::<Result<Vec<_>>>()?,
        });
        self.format.print(&summary, |_| {
            let benches: Vec<String> = all.iter().map(text).collect();
            let report = self.out.join("compare.html");
            format!(
                "The pilots are simulated: no person flew here.\n\n{}\n\n{took_s:.1} s; report: {}",
                benches.join("\n\n"),
                report.display()
            )
        });
        Ok(ExitCode::SUCCESS)
    }

    fn budget(&self) -> Result<Budget> {
        let Self { participants, episodes, tuning_episodes, .. } = *self;
        let least = [
            ("--participants", participants, 2),
            ("--episodes", episodes, 1),
            ("--tuning-episodes", tuning_episodes, 1),
        ];
        for (option, got, least) in least {
            if got < least {
                bail!(
                    "{option} must be at least {least}, got {got}: a comparison needs at least two people of each kind, \
                     and one episode each"
                );
            }
        }
        Ok(Budget { participants, episodes, tuning_episodes })
    }

    fn chosen(&self, mut benches: Vec<Bench>) -> Result<Vec<Bench>> {
        let known: Vec<String> = benches.iter().map(|bench| bench.name.clone()).collect();
        let wanted = |bench: &Bench| self.benches.iter().any(|start| bench.name.starts_with(start.as_str()));
        benches.retain(|bench| self.benches.is_empty() || wanted(bench));
        if known.is_empty() {
            return Err(CompareError::NoBench.into());
        }
        if benches.is_empty() {
            bail!("no bench begins with {:?}; there are: {}", self.benches.join(", "), known.join(", "));
        }
        Ok(benches)
    }

    fn write_folder(&self, all: &[Compared], comparison: &Comparison<'_>, out: &Path) -> Result<()> {
        std::fs::create_dir_all(out).with_context(|| format!("cannot make the folder {}", out.display()))?;
        let program = format!("cohelm {}", env!("CARGO_PKG_VERSION"));
        let making = Making { command: self.command(), program };
        let report = document(all, comparison, &making)?.files("compare");
        for (name, bytes) in report.into_iter().chain(files(all)?) {
            write(&out.join(name), &bytes)?;
        }
        let whole = serde_json::to_string_pretty(&all)? + "\n";
        write(&out.join("compare.json"), whole.as_bytes())
    }

    fn command(&self) -> String {
        let mut command = format!(
            "cohelm compare --participants {} --episodes {} --tuning-episodes {}",
            self.participants, self.episodes, self.tuning_episodes
        );
        for bench in &self.benches {
            command += &format!(" --bench {bench}");
        }
        for model in &self.models {
            command += &format!(" --model {}", model.display());
        }
        command
    }
}

/// What of a bench the terminal and the summary tell: rule, parameters, success, interventions, above the line.
fn told(compared: &Compared) -> Result<serde_json::Value> {
    let rules = compared.entered.iter().map(|entered| -> Result<serde_json::Value> {
        let stand = &entered.held_out;
        let margin = compared.margin(entered)?;
        Ok(json!({
            "setting": stand.setting, "success": stand.mean("success"), "crash": stand.mean("crash"),
            "replaced": stand.mean("replaced"), "interventions": stand.mean("interventions"), "opposed": stand.mean("opposed"),
            "above_the_line": margin, "against_the_line": margin.against(),
        }))
    });
    Ok(json!({
        "bench": compared.bench.name, "rules": rules.collect::<Result<Vec<_>>>()?, "line": compared.curve.line(),
        "verdicts": compared.verdicts()?,
    }))
}

fn text(compared: &Compared) -> String {
    let rows: Vec<Vec<String>> = compared
        .entered
        .iter()
        .map(|entered| {
            let mean = |key: &str| format!("{:.3}", entered.held_out.mean(key));
            let margin = compared.margin(entered).map_or("–".into(), |margin| {
                let (low, high) = (margin.interval.low, margin.interval.high);
                format!("{:+.3} [{low:+.3}, {high:+.3}]", margin.success)
            });
            let numbers = ["success", "crash", "steps", "replaced", "opposed"].map(mean);
            std::iter::once(entered.held_out.setting.rule.to_string())
                .chain(numbers)
                .chain([margin])
                .collect()
        })
        .collect();
    let head = ["rule, as tuned", "success", "crash", "steps", "replaced", "opposed", "above the line"];
    let verdicts = compared.verdicts().unwrap_or_default();
    format!("{}\n\n{}\n\n{}", compared.bench.name, table(&head, &rows), verdicts.join("\n"))
}
