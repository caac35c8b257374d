//! `cargo run --release -p cohelm-lander --example participants [POPULATION] [SEED] [EPISODES]`
//!
//! Ten simulated participants fly the flag task alone (HIC); one row each and one for all. `POPULATION` is one of the
//! names of `cohelm::human::Population`, or `all` for one row a population.

use cohelm::arbitration::HumanAlone;
use cohelm::cockpit::Cockpit;
use cohelm::human::{Person, Population, participant};
use cohelm::pilot::Pilot;
use cohelm::plant::{Ending, Plant};
use cohelm::random::mix_seed;
use cohelm_lander::flags::{FlagLander, FlagOptions};
use cohelm_lander::pilots::skill;
use std::error::Error;
use std::ops::AddAssign;

/// Participants of a study.
const PARTICIPANTS: u64 = 10;

/// Sums over flights.
#[derive(Clone, Copy, Default)]
struct Tally {
    flights: u32,
    endings: [u32; Ending::ALL.len()],
    ticks: u32,
    asked: u32,
    presses: u32,
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.flights += other.flights;
        self.endings.iter_mut().zip(other.endings).for_each(|(sum, n)| *sum += n);
        self.ticks += other.ticks;
        self.asked += other.asked;
        self.presses += other.presses;
    }
}

fn fly(lander: &mut FlagLander, cockpit: &mut Cockpit, pilot: &mut dyn Pilot, seed: u64) -> Tally {
    lander.reset(seed);
    pilot.begin(seed);
    let mut tally = Tally { flights: 1, ..Tally::default() };
    loop {
        let tick = cockpit.tick(lander, pilot);
        tally.ticks += 1;
        tally.asked += u32::from(tick.asked.is_some());
        if let Some(ending) = tick.step.ending {
            tally.presses = pilot.key_presses();
            Ending::ALL.iter().zip(&mut tally.endings).for_each(|(of, n)| *n = u32::from(*of == ending));
            return tally;
        }
    }
}

fn study(population: Population, seed: u64, episodes: u64) -> Result<Vec<Tally>, Box<dyn Error>> {
    let mut lander = FlagLander::new(FlagOptions::default())?;
    let mut cockpit = Cockpit::unassisted(&lander, Box::new(HumanAlone));
    let mut one = |index| -> Result<Tally, Box<dyn Error>> {
        let mut pilot = participant(skill, lander.space(), Person { population, seed, index })?;
        let mut sum = Tally::default();
        for episode in 0..episodes {
            sum += fly(&mut lander, &mut cockpit, &mut pilot, mix_seed(mix_seed(seed, index), episode));
        }
        Ok(sum)
    };
    (0..PARTICIPANTS).map(&mut one).collect()
}

fn row(name: &str, tally: &Tally) {
    let n = f64::from(tally.flights);
    let share = |ending: Ending| {
        let index = Ending::ALL.iter().position(|of| *of == ending).unwrap_or_default();
        f64::from(tally.endings[index]) / n
    };
    println!(
        "| {name:18} | {:.3} | {:.3} | {:.3} | {:.3} | {:5.1} | {:6.1} | {:8.2} |",
        share(Ending::Crash),
        share(Ending::OutOfBounds),
        share(Ending::Goal),
        share(Ending::Elsewhere),
        f64::from(tally.ticks) / n,
        f64::from(tally.asked) / n,
        f64::from(tally.presses) / n,
    );
}

fn all(tallies: &[Tally]) -> Tally {
    let mut sum = Tally::default();
    tallies.iter().for_each(|tally| sum += *tally);
    sum
}

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, usual| given.get(i).map_or(Ok(usual), |text| text.parse::<u64>());
    let (seed, episodes) = (number(1, 2024)?, number(2, 40)?);
    println!("| who                | crash | out   | goal  | elsew | ticks | asked  | presses  |");
    println!("|---|---|---|---|---|---|---|---|");
    let population = given.first().map_or("ordinary", String::as_str);
    if population == "all" {
        for population in Population::ALL {
            row(population.word(), &all(&study(population, seed, episodes)?));
        }
        return Ok(());
    }
    let tallies = study(population.parse()?, seed, episodes)?;
    tallies.iter().enumerate().for_each(|(index, tally)| row(&format!("participant {}", index + 1), tally));
    row("all", &all(&tallies));
    Ok(())
}
