//! `cohelm reproduce`: the paper's experiment with simulated pilots, from flights to report.

use super::fly::open;
use crate::numbers::whole;
use crate::output::{Format, in_folder, table};
use crate::rig;
use anyhow::{Context, Result, bail};
use clap::Args;
use cohelm::human::{Person, Population};
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::{Kind, Model, Models};
use cohelm_lab::experiment::{Experiment, Flown, Rig};
use cohelm_lab::reproduce::sensitivity::{self, Variation};
use cohelm_lab::reproduce::{Setting, Trained, claims, conditions, document};
use cohelm_lab::results::{Results, participant_keys};
use cohelm_server::store::{Origin, Record, Store, Write, now_ms};
use cohelm_study::measures::{self, measure};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Reproduces the paper's experiment with simulated pilots, and writes a folder: report, figures, tables, every episode.
#[derive(Args)]
pub struct Reproduce {
    /// Fixes participants and episodes.
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    seed: u64,
    /// Simulated participants (the paper: 10 people).
    #[arg(long, default_value_t = 10, value_parser = whole::<usize>)]
    participants: usize,
    /// Episodes of each participant in each condition (the paper gives no count).
    #[arg(long, default_value_t = 40, value_parser = whole::<usize>)]
    episodes: usize,
    /// Actions: switches (the paper's), main-side or continuous; gymnasium too with models of your own.
    #[arg(long, default_value = "switches")]
    actions: String,
    /// Another value or intent model than the shipped one; may be given again.
    #[arg(long = "model", value_name = "FILE")]
    models: Vec<PathBuf>,
    /// What kind of simulated people fly.
    #[arg(long, default_value = "ordinary")]
    population: Population,
    /// Repeat it over pilot populations, actions, endings and robots.
    #[arg(long)]
    sensitivity: bool,
    /// The folder to write; made anew.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Threads, which change nothing but the time; 0 for one a core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>)]
    threads: usize,
    #[command(flatten)]
    format: Format,
}

/// A plant with the models and people that fly it.
struct Crew {
    task: Task,
    values: Model,
    intent: Model,
    population: Population,
}

impl Reproduce {
    /// Runs the command.
    pub fn run(self) -> Result<ExitCode> {
        if self.participants == 0 || self.episodes == 0 {
            bail!("an experiment needs at least one participant and one episode");
        }
        let (plants, models) = (rig::plants(), rig::models(&self.models)?);
        let out = self.out.clone().unwrap_or_else(|| format!("reproduce-{}", self.seed).into());
        in_folder(&out, || {
            if self.sensitivity {
                self.vary(&plants, &models, &out)
            } else {
                self.reproduce(&plants, &models, &out)
            }
        })
    }

    fn reproduce(&self, plants: &Plants, models: &Models, out: &Path) -> Result<ExitCode> {
        let begun = Instant::now();
        let task = Task::new("flag-lander").with("actions", self.actions.as_str());
        let crew = self.crew(plants, models, task)?;
        let experiment = self.experiment(&crew, self.episodes);
        let flown = fly(&experiment, &crew, plants, models, self.threads)?;
        let took_s = begun.elapsed().as_secs_f64();
        let results =
            Results { conditions: &experiment.conditions, participants: self.participants, flown: &flown };
        let trained = Trained { values: crew.values.card(), intent: crew.intent.card() };
        let setting =
            Setting { experiment: &experiment, trained, command: self.command(), program: program() };
        write_tables(&results, out)?;
        for (name, bytes) in document(&results, &setting)?.files("report") {
            write(&out.join(name), &bytes)?;
        }
        store_all(&flown, &crew, &out.join("episodes.db"))?;
        let judged = claims(&results, trained);
        let verdict = |row: &cohelm_study::report::VerdictRow| json!({ "claim": row.claim.to_string(), "paper": row.paper.to_string(), "judgement": row.judgement });
        let summary = json!({
            "simulated_pilots": true, "experiment": experiment, "flying_s": took_s, "folder": out,
            "means": means(&results), "claims": judged.iter().map(verdict).collect::<Vec<_>>(),
        });
        write(&out.join("result.json"), (serde_json::to_string_pretty(&summary)? + "\n").as_bytes())?;
        self.format.print(&summary, |_| {
            let rows = judged.iter().map(|row| vec![row.claim.to_string(), row.judgement.verdict.words()]);
            format!(
                "The pilots are simulated: no person flew here.\n\n{}\n\n{}\n\n{} episodes flown in {took_s:.1} s; report: {}",
                means_text(&results),
                rows.map(|row| format!("{}\n    {}", row[0], row[1])).collect::<Vec<_>>().join("\n"),
                flown.len(),
                out.join("report.html").display()
            )
        });
        Ok(ExitCode::SUCCESS)
    }

    fn experiment(&self, crew: &Crew, episodes: usize) -> Experiment {
        Experiment {
            task: crew.task.clone(),
            values: Some(crew.values.hash().into()),
            intent: Some(crew.intent.hash().into()),
            seed: self.seed,
            participants: self.participants,
            episodes,
            conditions: conditions(),
            pilot: format!("simulated {}", crew.population),
        }
    }

    /// The usual models for a task, or those named on the command line.
    fn crew(&self, plants: &Plants, models: &Models, task: Task) -> Result<Crew> {
        let plant = plants.make(&task)?;
        let pick = |kind| -> Result<Model> {
            for file in &self.models {
                let model = rig::model(file)?;
                if model.card().kind == kind {
                    return Ok(model);
                }
            }
            Ok(rig::model_for(models, kind, &task, plant.space())?.clone())
        };
        let (values, intent) = (pick(Kind::Values)?, pick(Kind::Intent)?);
        Ok(Crew { values, intent, population: self.population, task })
    }

    fn command(&self) -> String {
        let mut command = format!(
            "cohelm reproduce --seed {} --participants {} --episodes {} --actions {} --population {}",
            self.seed, self.participants, self.episodes, self.actions, self.population
        );
        for model in &self.models {
            command += &format!(" --model {}", model.display());
        }
        command
    }
}

fn program() -> String {
    format!("cohelm {}", env!("CARGO_PKG_VERSION"))
}

/// Flies an experiment with the simulated people of a crew.
fn fly(
    experiment: &Experiment,
    crew: &Crew,
    plants: &Plants,
    models: &Models,
    threads: usize,
) -> Result<Vec<Flown>> {
    let population = crew.population;
    let pilots = |plant: &dyn Plant, seed: u64, index: usize| -> Result<Box<dyn Pilot>, String> {
        rig::simulated_person(
            plants,
            &experiment.task,
            plant,
            Person { population, seed, index: index as u64 },
        )
    };
    let mut models = models.clone();
    models.add_model(crew.values.clone());
    models.add_model(crew.intent.clone());
    let rig = Rig { plants, models: &models, pilots: &pilots, threads };
    Ok(experiment.run(&rig)?)
}

/// Measures of the table on the terminal.
const SHOWN: [&str; 7] =
    ["success", "crash", "elsewhere", "steps", "ticks_with_command", "key_presses", "nominal_interventions"];

fn means_text(results: &Results<'_>) -> String {
    let rows: Vec<Vec<String>> = results
        .conditions
        .iter()
        .enumerate()
        .map(|(index, condition)| {
            let cell = |key: &&str| {
                let written =
                    results.mean(key, index).zip(measure(key)).map(|(mean, measure)| measure.write(mean));
                written.unwrap_or_else(|| "–".into())
            };
            std::iter::once(condition.label.clone()).chain(SHOWN.iter().map(cell)).collect()
        })
        .collect();
    let titles: Vec<String> = SHOWN.iter().filter_map(|key| Some(measure(key)?.name.to_string())).collect();
    let head: Vec<&str> =
        std::iter::once("mean over participants").chain(titles.iter().map(String::as_str)).collect();
    table(&head, &rows)
}

/// Mean over participants of every measure in every condition.
fn means(results: &Results<'_>) -> serde_json::Value {
    let of = |index: usize| -> serde_json::Map<String, serde_json::Value> {
        participant_keys().map(|key| (key.to_string(), json!(results.mean(key, index)))).collect()
    };
    let conditions = results.conditions.iter().enumerate();
    conditions
        .map(|(index, condition)| (condition.name.clone(), json!(of(index))))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

fn write_tables(results: &Results<'_>, out: &Path) -> Result<()> {
    write(&out.join("episodes.csv"), results.episodes_csv().to_string().as_bytes())?;
    write(&out.join("participants.csv"), results.participants_csv().to_string().as_bytes())?;
    let all: Vec<measures::Measure> =
        measures::OF_A_PARTICIPANT.iter().chain(&measures::OF_AN_EPISODE).copied().collect();
    write(&out.join("dictionary.csv"), measures::dictionary(&all).to_string().as_bytes())
}

/// Writes a file, and the folders that it lies in if they are not there.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    }
    std::fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

/// Stores every episode, so that they can be watched in the page and verified like any other.
fn store_all(flown: &[Flown], crew: &Crew, database: &Path) -> Result<()> {
    for suffix in ["", "-wal", "-shm"] {
        let _ = std::fs::remove_file(PathBuf::from(format!("{}{suffix}", database.display())));
    }
    let at_ms = now_ms();
    let models = [&crew.values, &crew.intent];
    let models = models.map(|model| Write::Model { model: model.clone(), origin: Origin::Shipped, at_ms });
    let episodes = flown.iter().map(|flown| Write::Episode { record: Record::new(&flown.trajectory), at_ms });
    let writes: Vec<Write> = models.into_iter().chain(episodes).collect();
    tokio::runtime::Builder::new_current_thread().enable_all().build()?.block_on(async {
        let store = open(database).await?;
        store.commit(&writes).await?;
        store.close().await;
        Ok(())
    })
}

/// Share of the episodes that a variation flies, of those the reproduction does.
const VARIED_SHARE: usize = 2;

impl Reproduce {
    fn vary(&self, plants: &Plants, models: &Models, out: &Path) -> Result<ExitCode> {
        let begun = Instant::now();
        let episodes = (self.episodes / VARIED_SHARE).max(1);
        let mut variations = Vec::new();
        for (name, crew) in self.crews(plants, models)? {
            let experiment = self.experiment(&crew, episodes);
            let flown = fly(&experiment, &crew, plants, models, self.threads)?;
            let results = Results {
                conditions: &experiment.conditions,
                participants: self.participants,
                flown: &flown,
            };
            let trained = Trained { values: crew.values.card(), intent: crew.intent.card() };
            variations.push(Variation::of(&name, &results, trained));
            if self.format.shows_progress() {
                eprintln!("{:5.1} s  {name}", begun.elapsed().as_secs_f64());
            }
        }
        for (name, bytes) in
            sensitivity::document(&variations, self.participants, episodes).files("sensitivity")
        {
            write(&out.join(name), &bytes)?;
        }
        write(&out.join("sensitivity.csv"), sensitivity::csv(&variations).to_string().as_bytes())?;
        let took_s = begun.elapsed().as_secs_f64();
        let summary =
            json!({ "simulated_pilots": true, "took_s": took_s, "folder": out, "variations": variations });
        self.format.print(&summary, |_| {
            let lines = variations.iter().map(|variation| {
                let verdicts =
                    variation.verdicts.iter().map(|(claim, verdict)| format!("    {verdict}: {claim}"));
                format!("{}\n{}", variation.name, verdicts.collect::<Vec<_>>().join("\n"))
            });
            let lines = lines.collect::<Vec<_>>().join("\n");
            let report = out.join("sensitivity.html");
            format!("The pilots are simulated.\n\n{lines}\n\n{took_s:.1} s; report: {}", report.display())
        });
        Ok(ExitCode::SUCCESS)
    }

    /// Every circumstance: the usual one first.
    fn crews(&self, plants: &Plants, models: &Models) -> Result<Vec<(String, Crew)>> {
        let task = |actions: &str| Task::new("flag-lander").with("actions", actions);
        let mut crews = Vec::new();
        for population in Population::ALL {
            let crew = self.crew(plants, models, task("switches"))?;
            crews.push((format!("pilots: {population}"), Crew { population, ..crew }));
        }
        crews.push(("actions: main × side".into(), self.crew(plants, models, task("main-side"))?));
        let going_on = task("switches").with("elsewhere", "continue");
        crews.push(("landing elsewhere does not end it".into(), self.crew(plants, models, going_on)?));
        for (variant, name) in [
            ("second", "another robot, of another seed"),
            ("paper", "the hovering robot of the paper preset"),
            ("sees-asked", "values that see the command"),
        ] {
            let usual = self.crew(plants, models, task("switches"))?;
            let of_variant = |model: &&Model| model.card().variant.as_deref() == Some(variant);
            let find =
                |kind| models.iter().filter(of_variant).find(|model| model.card().kind == kind).cloned();
            let values = find(Kind::Values).with_context(|| {
                format!("the shipped value model of variant {variant:?} is missing; `cohelm train --ship` makes it")
            })?;
            let intent = find(Kind::Intent).unwrap_or(usual.intent);
            crews.push((name.into(), Crew { values, intent, ..usual }));
        }
        Ok(crews)
    }
}
