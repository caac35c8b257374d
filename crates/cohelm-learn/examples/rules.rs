//! cargo run --release -p cohelm-learn --example rules -- VALUES.safetensors [INTENT.safetensors]
use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::flight::fly;
use cohelm::intent::Inference;
use cohelm::pilot::Pilot;
use cohelm::plant::Ending;
use cohelm::registry::{Plants, Task};
use cohelm::trajectory::Setup;
use cohelm_copilot::{Kind, Models, cockpit};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    let mut models = Models::new();
    for file in std::env::args().skip(1) {
        models.add(&std::fs::read(file)?)?;
    }
    let task: Task = models.iter().next().unwrap().card().task.clone();
    let plant = plants.make(&task)?;
    let hash = |kind| models.newest_for(kind, &task, plant.space()).map(|m| m.hash().to_string());
    let tolerance = |alpha| Rule::Tolerance { alpha };
    use Inference::*;
    let mut cases = vec![(Rule::Hic, Nearest), (Rule::Robot, Known)];
    for i in [Known, InverseDistance, Softmax, Calibrated] {
        if i != Known && hash(Kind::Intent).is_none() {
            continue;
        }
        cases.extend([
            (Rule::Lasc, i),
            (Rule::Misc, i),
            (Rule::MiscR { kappa: 0.7 }, i),
            (tolerance(0.4), i),
            (tolerance(0.2), i),
        ]);
    }
    if std::env::var("SHORT").is_ok() {
        cases = vec![(Rule::Robot, Known), (Rule::MiscR { kappa: 0.7 }, Known), (tolerance(0.4), Known)];
    }
    let n: usize = std::env::var("N").ok().and_then(|n| n.parse().ok()).unwrap_or(200);
    let first: u64 = std::env::var("FIRST").ok().and_then(|n| n.parse().ok()).unwrap_or(7_000_000);
    for (rule, inference) in cases {
        let results: Vec<(Ending, usize, f64, f64, f64, f64, f64)> = std::thread::scope(|s| {
            let hs: Vec<_> = (0..2)
                .map(|t| {
                    let (plants, models, task) = (&plants, &models, &task);
                    let values = hash(Kind::Values);
                    let intent = hash(Kind::Intent);
                    s.spawn(move || {
                        (t..n)
                            .step_by(2)
                            .map(|i| {
                                let mut plant = plants.make(task).unwrap();
                                let setup = Setup {
                                    task: task.clone(),
                                    plant_version: plants.entry(task).unwrap().version,
                                    seed: first + i as u64,
                                    rule,
                                    inference,
                                    silence: Silence::Best,
                                    time_scale: 1.0,
                                    values: values.clone(),
                                    intent: intent.clone(),
                                    pilot: "x".into(),
                                };
                                let mut cockpit = cockpit(&setup, plant.as_ref(), plants, models).unwrap();
                                let mut pilot = cohelm_lander::pilots::participant(
                                    plant.space(),
                                    cohelm::human::Population::Ordinary,
                                    2024,
                                    i as u64 % 10,
                                )
                                .unwrap();
                                pilot.begin(i as u64);
                                let (mut asked, mut nominal, mut opposed, mut effective, mut c) =
                                    (0.0, 0.0, 0.0, 0.0, 0.0);
                                let t = fly(setup, plant.as_mut(), &mut cockpit, &mut pilot, |tick, _| {
                                    c += tick.belief.confidence as f64;
                                    if let Some(v) = tick.intervention {
                                        asked += 1.0;
                                        nominal += v.nominal as u8 as f64;
                                        effective += v.effective as u8 as f64;
                                        opposed += v.opposed as u8 as f64;
                                    }
                                });
                                (
                                    t.ending,
                                    t.ticks(),
                                    asked,
                                    nominal / f64::max(asked, 1.0),
                                    effective / f64::max(asked, 1.0),
                                    opposed / f64::max(asked, 1.0),
                                    c / t.ticks() as f64,
                                )
                            })
                            .collect::<Vec<_>>()
                    })
                })
                .collect();
            hs.into_iter().flat_map(|h| h.join().unwrap()).collect()
        });
        let share = |e| results.iter().filter(|r| r.0 == e).count() as f64 / n as f64;
        let mean = |f: &dyn Fn(&(Ending, usize, f64, f64, f64, f64, f64)) -> f64| {
            results.iter().map(f).sum::<f64>() / n as f64
        };
        println!(
            "{:10} {:16} goal {:.3} crash {:.3} out {:.3} else {:.3} late {:.3} steps {:4.0} asked {:4.0} nominal {:.3} effective {:.3} opposed {:.3} c {:.2}",
            rule.word(),
            format!("{inference:?}"),
            share(Ending::Goal),
            share(Ending::Crash),
            share(Ending::OutOfBounds),
            share(Ending::Elsewhere),
            share(Ending::TimeLimit),
            mean(&|r| r.1 as f64),
            mean(&|r| r.2),
            mean(&|r| r.3),
            mean(&|r| r.4),
            mean(&|r| r.5),
            mean(&|r| r.6)
        );
    }
    Ok(())
}
