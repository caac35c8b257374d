//! `cargo run --release -p cohelm-lab --example tune_evidence`
//!
//! Chooses how much what is asked says about the goal ([`Evidence`]), on the pilots that intent learns from and no others:
//! they fly the flag task alone and under minimal intervention, with a steady mind and with one that changes, and every
//! combination of a grid looks on. Printed are the combinations by their mean surprise (−ln p) at the pilot's own goal,
//! alone and multiplied with the calibrated network's belief.

use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::human::{Person, Population};
use cohelm::intent::{Evidence, Head, Inference, IntentModel, ValueIntent};
use cohelm::pilot::Pilot;
use cohelm::plant::Plant;
use cohelm::random::mix_seed;
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::{MAX_SEED, Setup};
use cohelm_copilot::intent::NetworkIntent;
use cohelm_copilot::values::NetworkValues;
use cohelm_copilot::{Kind, Model, Network, cockpit, shipped};
use std::error::Error;

/// The draw of the pilots that intent learns from.
const TRAINING_PILOTS: u64 = 0x7261_696e;
const FLIGHTS: u64 = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    let mut grid = Vec::new();
    for rationality in [0.3, 1.0, 2.0, 4.0] {
        for weight in [0.1, 0.3, 1.0] {
            for change in [0.001, 0.005] {
                grid.push(Evidence { rationality, weight, change });
            }
        }
    }
    let mut sums = vec![[0.0; 2]; grid.len()];
    let mut ticks = 0;
    for task in [Task::new("flag-lander"), Task::new("flag-lander").with("changes_mind", vec![40, 120])] {
        for rule in [Rule::Hic, Rule::Misc] {
            for episode in 0..FLIGHTS {
                ticks += watch(&plants, &task, rule, episode, &grid, &mut sums)?;
            }
        }
    }
    let mut rows: Vec<(&Evidence, [f64; 2])> =
        grid.iter().zip(sums.iter().map(|sum| sum.map(|sum| sum / ticks as f64))).collect();
    rows.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    println!("{ticks} ticks; ln 3 = 1.099\n   β  weight  change  surprise  with the network");
    for (Evidence { rationality, weight, change }, [alone, product]) in rows {
        println!("{rationality:4.1}  {weight:6.2}  {change:6.3}  {alone:8.3}  {product:8.3}");
    }
    Ok(())
}

/// Flies one episode while all combinations look on; adds their surprise and returns the ticks.
fn watch(
    plants: &Plants,
    task: &Task,
    rule: Rule,
    episode: u64,
    grid: &[Evidence],
    sums: &mut [[f64; 2]],
) -> Result<usize, Box<dyn Error>> {
    let seed = mix_seed(TRAINING_PILOTS, episode) % MAX_SEED;
    let (models, _) = shipped::models();
    let mut plant = plants.make(task)?;
    plant.reset(seed);
    let usual = |kind| models.newest_for(kind, task, plant.space()).ok_or("the shipped models are needed");
    let (values, intent) = (usual(Kind::Values)?, usual(Kind::Intent)?);
    let setup = Setup {
        task: task.clone(),
        plant_version: plants.entry(task)?.version,
        seed,
        rule,
        inference: Inference::Calibrated,
        silence: Silence::Best,
        time_scale: 1.0,
        values: Some(values.hash().into()),
        intent: Some(intent.hash().into()),
        pilot: "simulated person".into(),
    };
    let mut cockpit = cockpit(&setup, plant.as_ref(), plants, &models)?;
    let person = Person { population: Population::Ordinary, seed: TRAINING_PILOTS, index: episode };
    let mut pilot = plants.entry(task)?.participant(plant.space(), person)?;
    pilot.begin(seed);
    cockpit.begin();
    let made = grid.iter().map(|&evidence| by_values(values, plant.as_ref(), evidence));
    let mut lookers = made.collect::<Result<Vec<_>, _>>()?;
    let mut network = network(intent)?;
    for ticks in 1.. {
        let before = plant.snapshot().ok_or("the lander can be copied")?;
        let tick = cockpit.tick(plant.as_mut(), &mut pilot);
        let (view, own) = (before.view(), before.pilot_goal());
        let of_network = network.infer(&view, tick.asked);
        for (looker, sum) in lookers.iter_mut().zip(sums.iter_mut()) {
            let belief = looker.infer(&view, tick.asked);
            let p = belief.probabilities();
            let product = |goal: usize| f64::from(p[goal] * of_network.probabilities()[goal]);
            let all: f64 = (0..p.len()).map(product).sum();
            sum[0] -= f64::from(p[own]).max(1e-9).ln();
            sum[1] -= (product(own) / all).max(1e-9).ln();
        }
        if tick.step.ending.is_some() {
            return Ok(ticks);
        }
    }
    Ok(0)
}

fn by_values(model: &Model, plant: &dyn Plant, evidence: Evidence) -> Result<ValueIntent, Box<dyn Error>> {
    let Network::Values(network) = model.network() else { return Err("values are needed".into()) };
    let values = NetworkValues::new(model.card(), network.clone()).ok_or("commands are needed")?;
    let range = model.card().median_range.unwrap_or(f64::NAN);
    Ok(ValueIntent::new(Box::new(values), plant.space(), range, evidence)?)
}

fn network(model: &Model) -> Result<NetworkIntent, Box<dyn Error>> {
    let Network::Intent(networks) = model.network() else { return Err("intent is needed".into()) };
    let intent = NetworkIntent::new(model.card(), networks.clone(), Head::Calibrated);
    Ok(intent.ok_or("commands are needed")?)
}
