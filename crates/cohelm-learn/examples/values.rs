//! cargo run --release -p cohelm-learn --example values -- SEED THREADS [PLANT] [OPTIONS AS JSON] [EPISODES]
use cohelm::plant::Plant;
use cohelm::registry::{Plants, Task};
use cohelm_learn::{IntentOptions, Job, ValueOptions, evaluate, train_intent, train_values};
use std::ops::ControlFlow;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let arg = |i: usize, usual: &str| args.get(i).cloned().unwrap_or_else(|| usual.into());
    let mut plants = Plants::default();
    cohelm_lander::register(&mut plants);
    let task: Task = serde_json::from_str(&arg(3, r#"{"plant":"flag-lander"}"#))?;
    let seed: u64 = arg(1, "0").parse()?;
    let options = arg(4, "{}");
    let options: ValueOptions = ValueOptions::preset(&options).or_else(|_| serde_json::from_str(&options))?;
    let job = Job {
        plants: &plants,
        task: &task,
        seed,
        threads: arg(2, "2").parse()?,
        name: "trial",
        variant: None,
        checkpoints: None,
    };
    let begun = Instant::now();
    let mut next = 0;
    let pilots = |plant: &dyn Plant, number: u64| {
        cohelm_lander::pilots::participant(plant.space(), cohelm::human::Population::Ordinary, 1, number)
            .map(|p| Box::new(p) as Box<dyn cohelm::pilot::Pilot>)
            .map_err(|e| e.to_string())
    };
    let trained = train_values(&job, &options, Some(&pilots), &mut |p| {
        if p.done >= next {
            next = p.done + p.total / 15;
            let numbers: Vec<String> = p.numbers.iter().map(|(n, v)| format!("{n} {v:.3}")).collect();
            eprintln!("{:7} {:5.1}s {}", p.done, begun.elapsed().as_secs_f64(), numbers.join(", "));
        }
        ControlFlow::Continue(())
    })?;
    let took = begun.elapsed();
    eprintln!("{:#?}", trained.profile);
    let test = evaluate(&job, &trained.model, 1, arg(5, "300").parse()?)?;
    println!(
        "seed {seed} wall {:.1}s range {:?} validation {:.3} test {:.3} {:?}",
        took.as_secs_f64(),
        trained.model.card().median_range,
        trained.validation.landed,
        test.landed,
        test
    );
    if let Ok(out) = std::env::var("OUT") {
        std::fs::write(format!("{out}.values.safetensors"), trained.model.bytes())?;
    }
    let Ok(intent) = std::env::var("INTENT") else { return Ok(()) };
    let options: IntentOptions = serde_json::from_str(&intent)?;
    let begun = Instant::now();
    let intent = train_intent(&job, &trained.model, &options, &pilots, &mut |p| {
        let numbers: Vec<String> = p.numbers.iter().map(|(n, v)| format!("{n} {v:.4}")).collect();
        eprintln!(
            "{} {}/{} {:5.1}s {}",
            p.stage,
            p.done,
            p.total,
            begun.elapsed().as_secs_f64(),
            numbers.join(", ")
        );
        ControlFlow::Continue(())
    })?;
    if let Ok(out) = std::env::var("OUT") {
        std::fs::write(format!("{out}.intent.safetensors"), intent.model.bytes())?;
    }
    println!("{:#?} {} bytes", intent.profile, intent.model.bytes().len());
    for closed in &intent.closed_loop {
        println!("{closed:?}");
    }
    for head in &intent.scores {
        println!("{:?}", head.head);
        for s in std::iter::once(&head.all).chain(&head.by_time) {
            println!(
                "{:4}.. n {:6} acc {:.3} c {:.3} ece {:.3} nll {:.3}",
                s.from, s.ticks, s.accuracy, s.confidence, s.calibration_error, s.surprise
            );
        }
    }
    Ok(())
}
