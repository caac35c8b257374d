//! A sweep over the lander with the shipped models, small.

use super::*;
use cohelm::action::ActionSpace;
use cohelm::registry::{Plants, Task};
use cohelm_copilot::{Kind, Models, shipped};
use std::collections::BTreeSet;
use std::path::Path;

const SMALL: &str = r#"
cohelm-sweep = 1
title = "Small"

[fly]
plant = "flag-lander"
rules = ["hic", "misc", { rule = "misc-r", kappa = 0.5 }]
heads = ["inverse-distance", "softmax"]
pilots = ["ordinary", "slow"]
seeds = { first = 1, count = 2 }
episodes = 2
"#;

struct World {
    plants: Plants,
    models: Models,
}

impl World {
    fn new() -> Self {
        let mut plants = Plants::default();
        cohelm_lander::register(&mut plants);
        Self { plants, models: shipped::models().0 }
    }

    fn lab(&self) -> Lab<'_> {
        Lab { plants: &self.plants, models: &self.models }
    }

    fn plan(&self, text: &str) -> Result<Vec<Planned>, SweepError> {
        let description = Description::from_toml(text)?;
        let shelf = Shelf::new(self.models.clone(), &description, Path::new("."))?;
        let choose =
            |kind: Kind, word: &str, task: &Task, space: &ActionSpace| shelf.choose(kind, word, task, space);
        description.jobs(&self.lab(), &choose)
    }

    fn run(&self, planned: &[Planned], path: &Path, threads: usize) -> usize {
        let folder = Folder::new(path).unwrap();
        folder.plan(SMALL, planned, &[]).unwrap();
        let open = folder.open_jobs(planned);
        run_locally(&open, &folder, &self.lab(), threads, &|_| {}).unwrap();
        open.len()
    }
}

fn outcomes(path: &Path, planned: &[Planned]) -> Vec<Vec<u8>> {
    let name = |planned: &Planned| path.join(format!("done/{}.json", planned.hash));
    planned.iter().map(|planned| std::fs::read(name(planned)).unwrap()).collect()
}

#[test]
fn the_grid_is_every_choice_once() {
    let planned = World::new().plan(SMALL).unwrap();
    // Two rules under two heads, and the human alone under one: five conditions, two kinds of pilots, two seeds.
    assert_eq!(planned.len(), 5 * 2 * 2);
    let hashes: BTreeSet<&String> = planned.iter().map(|planned| &planned.hash).collect();
    assert_eq!(hashes.len(), planned.len());
    let conditions: BTreeSet<&str> = planned.iter().map(|planned| planned.condition.as_str()).collect();
    let expected = [
        "hic",
        "misc, inverse-distance",
        "misc, softmax",
        "misc-r 0.5, inverse-distance",
        "misc-r 0.5, softmax",
    ];
    assert_eq!(conditions, BTreeSet::from(expected));
    assert!(planned.iter().any(|planned| planned.stratum == "slow"));
}

#[test]
fn a_job_is_named_by_everything_it_depends_on() {
    let one = World::new().plan(SMALL).unwrap().remove(0).job;
    let name = one.hash().unwrap();
    let read: Job = serde_json::from_str(&serde_json::to_string(&one).unwrap()).unwrap();
    assert_eq!(read.hash().unwrap(), name);
    let mut of_another_plant = one.clone();
    of_another_plant.code.plant += 1;
    assert_ne!(of_another_plant.hash().unwrap(), name);
    let mut of_another_build = one.clone();
    of_another_build.code.sources.replace_range(..1, "x");
    assert_ne!(of_another_build.hash().unwrap(), name);
    let Work::Fly(mut flights) = one.work.clone() else { panic!("it flies") };
    flights.values = Some("another model".into());
    assert_ne!(Job { work: Work::Fly(flights), ..one }.hash().unwrap(), name);
}

#[test]
fn threads_and_interruptions_change_no_byte_and_nothing_runs_twice() {
    let (world, scratch) = (World::new(), tempfile::tempdir().unwrap());
    let planned = world.plan(SMALL).unwrap();
    let backwards: Vec<Planned> = planned.iter().rev().cloned().collect();
    let [one, three] = ["one", "three"].map(|name| scratch.path().join(name));
    assert_eq!(world.run(&planned, &one, 1), planned.len());
    assert_eq!(world.run(&backwards, &three, 3), planned.len());
    let flown = outcomes(&one, &planned);
    assert_eq!(flown, outcomes(&three, &planned));
    assert_eq!(flown.iter().collect::<BTreeSet<_>>().len(), planned.len());
    std::fs::remove_file(one.join(format!("done/{}.json", planned[3].hash))).unwrap();
    assert_eq!(world.run(&planned, &one, 2), 1);
    assert_eq!(flown, outcomes(&one, &planned));
    assert_eq!(world.run(&planned, &one, 2), 0);
}

#[test]
fn the_report_has_every_condition_and_says_what_is_missing() {
    let (world, scratch) = (World::new(), tempfile::tempdir().unwrap());
    let planned = world.plan(SMALL).unwrap();
    world.run(&planned[2..], scratch.path(), 0);
    let folder = Folder::open(scratch.path()).unwrap();
    folder.plan(SMALL, &planned, &[]).unwrap();
    let finished = Finished::all(&folder).unwrap();
    assert_eq!(finished.len(), planned.len() - 2);
    let text = document("Small", &finished, planned.len()).unwrap().markdown();
    assert!(text.contains("18 of 20 jobs have finished"), "{text}");
    assert!(text.contains("misc-r 0.5, softmax"));
    assert!(text.contains(&format!("sources {}", planned[0].job.code.sources)));
    assert_eq!(by_episode(&finished).rows().len(), 2 * finished.len());
    assert_eq!(by_job(&finished).rows().len(), finished.len());
    assert_eq!(where_it_ran(&finished).rows().len(), finished.len());
    for name in write_report(&folder).unwrap() {
        assert!(scratch.path().join(&name).metadata().unwrap().len() > 0, "{name}");
    }
    let meant: Vec<String> = dictionary().rows().iter().map(|row| format!("{:?}", row[0])).collect();
    for column in by_episode(&finished).columns() {
        assert!(meant.contains(&format!("Text({column:?})")), "{column} is not in the dictionary");
    }
}

#[test]
fn a_training_is_a_job_too() {
    let text = r#"
cohelm-sweep = 1
title = "Trainings"
[train]
plant = "flag-lander"
changes = { steps = 2000, warm_up = 500, validations = 1, validation_episodes = 4 }
vary = { hidden = [[8], [8, 8]] }
seeds = [0]
episodes = 4
"#;
    let (world, scratch) = (World::new(), tempfile::tempdir().unwrap());
    let planned = world.plan(text).unwrap();
    assert_eq!(planned.len(), 2);
    world.run(&planned, scratch.path(), 0);
    let folder = Folder::open(scratch.path()).unwrap();
    for finished in Finished::all(&folder).unwrap() {
        let model = finished.outcome["model"].as_str().unwrap();
        assert!(scratch.path().join(format!("models/{model}.safetensors")).is_file());
        assert!(finished.value("landed").is_some());
    }
}

#[test]
fn a_worker_with_other_code_refuses() {
    let world = World::new();
    let mut job = world.plan(SMALL).unwrap().remove(0).job;
    job.code.cohelm = "0.0.9".into();
    let refused = run_job(&job, &world.lab()).unwrap_err().to_string();
    assert!(refused.contains("cohelm 0.0.9") && refused.contains("same sources"), "{refused}");
}

/// What [`Folder::plan`] calls finished is of these sources: what another build left in the folder is not taken for it.
#[test]
fn what_another_build_finished_runs_again() {
    let (world, scratch) = (World::new(), tempfile::tempdir().unwrap());
    let planned = world.plan(SMALL).unwrap();
    let first = &planned[..1];
    assert_eq!((world.run(first, scratch.path(), 1), world.run(first, scratch.path(), 1)), (1, 0));
    let mut job = first[0].job.clone();
    job.code.sources = "0123456789abcdef".into();
    let of_another_build = Planned { hash: job.hash().unwrap(), job, ..first[0].clone() };
    let folder = Folder::open(scratch.path()).unwrap();
    folder.plan(SMALL, std::slice::from_ref(&of_another_build), &[]).unwrap();
    assert_eq!(folder.open_jobs(std::slice::from_ref(&of_another_build)).len(), 1);
    let refused = run_job(&of_another_build.job, &world.lab()).unwrap_err().to_string();
    assert!(refused.contains("sources 0123456789abcdef"), "{refused}");
}

#[test]
fn wrong_descriptions_are_refused_in_words() {
    let world = World::new();
    for (from, to, words) in [
        ("cohelm-sweep = 1", "cohelm-sweep = 2", "reads format 1, got 2"),
        ("\"hic\"", "\"hci\"", "no rule is called \"hci\""),
        ("episodes = 2", "episodes = 0", "at least one is needed"),
        ("count = 2", "count = 0", "at least one is needed"),
        ("flag-lander", "drone", "no plant is called"),
        ("kappa = 0.5", "kappa = -1.0", "κ must be"),
        ("\"slow\"", "\"snail\"", "snail"),
        ("episodes = 2", "episodes = 2\nepisode = 2", "unknown field"),
        ("episodes = 2", "episodes = 2\nvary = { wings = [1] }", "wings"),
        ("count = 2", "count = 2000000", "at most 1000000 jobs"),
        ("episodes = 2", "episodes = 2\nvalues = [\"best\"]", "write \"shipped\""),
        ("episodes = 2", "episodes = 2\nvalues = [\"none.safetensors\"]", "none.safetensors"),
    ] {
        let said = world.plan(&SMALL.replace(from, to)).unwrap_err().to_string();
        assert!(said.contains(words), "{to}: {said}");
    }
}
