//! `cohelm`: the only crate that prints. Each command is a module; this file is the list of them.
#![forbid(unsafe_code)]

mod commands;
mod live;
mod numbers;
mod output;
mod rig;
mod server_process;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::process::ExitCode;

/// Shared control of a person and a co-pilot: fly it, train it, reproduce the paper, replay every tick.
#[derive(Parser)]
#[command(name = "cohelm", version, max_term_width = 110, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Serve the page in which a person flies with the co-pilot.
    Fly(commands::fly::Fly),
    /// Train a co-pilot from nothing: values, then intent.
    Train(commands::train::Train),
    /// Fly fresh episodes with the goal known and count how they end.
    Evaluate(commands::evaluate::Evaluate),
    /// Compare inferences of the goal: right goals, calibration, and what comes of a changed mind.
    Intents(commands::intents::Intents),
    /// Reproduce the paper's experiment with simulated pilots.
    Reproduce(commands::reproduce::Reproduce),
    /// Compare every rule of arbitration on the same plants, people and seeds.
    Compare(commands::compare::Compare),
    /// Check, try, run and report a study with people.
    #[command(subcommand)]
    Study(commands::study::Study),
    /// Run many small experiments: a grid of flights or trainings, here or on a Ray cluster.
    #[command(subcommand)]
    Sweep(commands::sweep::Sweep),
    /// List the stored episodes.
    Episodes(commands::episodes::Episodes),
    /// Hold something against what was recorded elsewhere.
    #[command(subcommand)]
    Verify(commands::verify::Verify),
    /// Measure speed on this machine.
    #[command(subcommand)]
    Bench(commands::bench::Bench),
}

fn main() -> ExitCode {
    let matches = numbers::with_negative_numbers(Cli::command()).get_matches();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let outcome = match cli.command {
        Command::Fly(fly) => fly.run(),
        Command::Train(train) => train.run(),
        Command::Evaluate(evaluate) => evaluate.run(),
        Command::Intents(intents) => intents.run(),
        Command::Reproduce(reproduce) => reproduce.run(),
        Command::Compare(compare) => compare.run(),
        Command::Study(study) => study.run(),
        Command::Sweep(sweep) => sweep.run(),
        Command::Episodes(episodes) => episodes.run(),
        Command::Verify(verify) => verify.run(),
        Command::Bench(bench) => bench.run(),
    };
    match outcome {
        Ok(code) => code,
        Err(error) => {
            eprintln!("cohelm: {}", reasons(&error));
            ExitCode::FAILURE
        }
    }
}

/// What went wrong, from the outside in, in one line. A cause that the line tells already is not told again.
fn reasons(error: &anyhow::Error) -> String {
    let mut line = String::new();
    for reason in error.chain().map(ToString::to_string) {
        if !line.contains(&reason) {
            line = if line.is_empty() { reason } else { format!("{line}: {reason}") };
        }
    }
    line
}
