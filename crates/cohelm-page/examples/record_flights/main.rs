//! `cargo run -p cohelm-page --example record_flights -- FOLDER` flies some flights natively, by random keys, and writes
//! for each what was done (NAME.json) and the record that came of it (NAME.chlm). `tools/page-parity` does the same
//! with the built page and demands the same bytes. Flights of a plant's teacher, which land and come to rest, are
//! written as records only, for the page to replay.

mod demonstrations;
mod random_models;

use cohelm::arbitration::{DEFAULT_KAPPA, Rule};
use cohelm::cockpit::Silence;
use cohelm::intent::Inference;
use cohelm::keys::Change;
use cohelm::random::Draws;
use cohelm::registry::Task;
use cohelm::trajectory::Setup;
use cohelm_copilot::Model;
use cohelm_page::fleet::plants;
use cohelm_page::page::Page;
use demonstrations::demonstration;
use random_models::random_models;
use serde::Serialize;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

type Outcome<T> = Result<T, Box<dyn Error>>;

const FLIGHTS_EACH: u64 = 2;
/// Long enough for most flights to end by themselves; the others are recorded as abandoned, which must be exact too.
const MOST_TICKS: u32 = 400;
const RULES: [Rule; 6] = [
    Rule::Hic,
    Rule::Robot,
    Rule::Lasc,
    Rule::Misc,
    Rule::Tolerance { alpha: 0.4 },
    Rule::MiscR { kappa: DEFAULT_KAPPA },
];
const WITHOUT_NETWORK: [Inference; 2] = [Inference::Known, Inference::Nearest];
const WITH_NETWORK: [Inference; 3] = [Inference::InverseDistance, Inference::Softmax, Inference::Calibrated];

/// What was done: calls of the page, in their order.
#[derive(Serialize)]
struct Script {
    models: Vec<String>,
    setup: Setup,
    ticks: u32,
    events: Vec<Event>,
}

#[derive(Serialize)]
struct Event {
    tick: u32,
    change: Change,
    at_ms: f32,
}

fn main() -> Outcome<()> {
    let folder = std::env::args_os().nth(1).ok_or("name a folder to write the flights to")?;
    let folder = PathBuf::from(folder);
    fs::create_dir_all(&folder)?;
    for (name, task) in tasks() {
        record(&folder, name, &task)?;
        for seed in 0..FLIGHTS_EACH {
            if let Some(record) = demonstration(&plants(), &task, seed)? {
                fs::write(folder.join(format!("{name}.teacher.{seed}.chlm")), record)?;
            }
        }
    }
    Ok(())
}

fn tasks() -> Vec<(&'static str, Task)> {
    let lander = |actions: &str| Task::new("flag-lander").with("actions", actions);
    vec![
        ("point", Task::new("point")),
        ("lander-switches", lander("switches")),
        ("lander-main-side", lander("main-side")),
        ("lander-gymnasium", lander("gymnasium")),
        ("lander-continuous", lander("continuous")),
        ("drone-levers", Task::new("drone")),
        ("drone-continuous", Task::new("drone").with("actions", "continuous")),
        ("arm-levers", Task::new("arm")),
        ("arm-continuous", Task::new("arm").with("actions", "continuous")),
        ("gymnasium", Task::new("gymnasium-lander")),
        ("gymnasium-wind", Task::new("gymnasium-lander").with("continuous", true).with("enable_wind", true)),
    ]
}

/// Records a task under every rule and inference that it can be flown with.
fn record(folder: &Path, name: &str, task: &Task) -> Outcome<()> {
    let plants = plants();
    let version = plants.entry(task)?.version;
    let mut plant = plants.make(task)?;
    plant.reset(0);
    let models = random_models(task, version, plant.as_ref())?;
    for model in models.iter().flatten() {
        fs::write(folder.join(file_name(name, model)), model.bytes())?;
    }
    let inferences = WITHOUT_NETWORK.iter().chain(if models.is_some() { &WITH_NETWORK[..] } else { &[] });
    for &inference in inferences {
        for rule in RULES.into_iter().filter(|rule| models.is_some() || !matches!(rule, Rule::MiscR { .. })) {
            for seed in 0..FLIGHTS_EACH {
                let hash = |which: usize| models.as_ref().map(|models| models[which].hash().to_string());
                let setup = Setup {
                    task: task.clone(),
                    plant_version: version,
                    seed,
                    rule,
                    inference,
                    silence: if seed % 2 == 0 { Silence::Best } else { Silence::Nothing },
                    time_scale: 1.0,
                    values: hash(0),
                    intent: inference.head().and_then(|_| hash(1)),
                    pilot: "person".into(),
                };
                let models = models.iter().flatten();
                let files = models.clone().map(|model| file_name(name, model)).collect();
                let (script, record) = fly(setup, models, files)?;
                let inference = serde_json::to_value(inference)?;
                let name =
                    format!("{name}.{}.{}.{seed}", rule.word(), inference.as_str().unwrap_or_default());
                fs::write(folder.join(format!("{name}.json")), serde_json::to_vec(&script)?)?;
                fs::write(folder.join(format!("{name}.chlm")), record)?;
            }
        }
    }
    Ok(())
}

fn file_name(name: &str, model: &Model) -> String {
    format!("{name}.{}.safetensors", model.card().kind.word())
}

fn fly<'a>(
    setup: Setup,
    models: impl Iterator<Item = &'a Model>,
    files: Vec<String>,
) -> Outcome<(Script, Vec<u8>)> {
    let mut page = Page::new();
    for model in models {
        page.add_model(model.bytes())?;
    }
    let controls = page.begin(&serde_json::to_vec(&setup)?)?.controls.len();
    let mut draws = Draws::fork(setup.seed, 1);
    let mut script = Script { models: files, setup, ticks: 0, events: Vec::new() };
    while script.ticks < MOST_TICKS {
        while draws.chance(0.15) {
            let at_ms = 20.0 * script.ticks as f32 + draws.uniform(-20.0, 0.0) as f32;
            let event = Event { tick: script.ticks, change: any_change(&mut draws, controls), at_ms };
            page.change(event.change, event.at_ms)?;
            script.events.push(event);
        }
        if page.tick()?.is_none() {
            break;
        }
        script.ticks += 1;
    }
    Ok((script, page.finish()?))
}

/// Presses and releases of what there is and of what there is not, the stick, and a window that loses its focus.
fn any_change(draws: &mut Draws, controls: usize) -> Change {
    let control = draws.below(controls + 1) as u8;
    match draws.below(20) {
        0..10 => Change::Down(control),
        10..17 => Change::Up(control),
        17 => Change::ReleaseAll,
        _ => Change::Stick([0; 4].map(|_: i32| draws.uniform(-32767.0, 32767.0) as i16)),
    }
}
