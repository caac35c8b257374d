//! A small study on the point, from consent to thanks, and what becomes of its records.
//!
//! The participants are simulated and marked so; their items stay "not answered".

use super::dataset;
use cohelm::flight::Flight;
use cohelm::keys::Change;
use cohelm::point;
use cohelm::registry::Plants;
use cohelm::trajectory::{Setup, Trajectory};
use cohelm_copilot::{Models, cockpit};
use cohelm_study::analysis::Options;
use cohelm_study::dataset::{Dataset, LeftOut, ParticipantRecord, Progress, StudyRecords, TrialRecord};
use cohelm_study::design::schedule::{CellTally, assign};
use cohelm_study::design::timeline::setup;
use cohelm_study::design::{Design, Resolved, ResolvedModels};
use cohelm_study::export::{flights, read_archive, write_archive};
use cohelm_study::report::study_report;
use cohelm_study::session::{Event, Logged, Session};
use cohelm_study::statistics::bootstrap;
use serde_json::{Value, json};
use std::collections::BTreeMap;

const STUDY: &str = r#"
cohelm-study = 1
name = "small"
title = "A small study"
contact = "nobody"
planned-participants = 4
order = "latin-square"

[task]
plant = "point"

[[conditions]]
name = "alone"
rule = "hic"
inference = "nearest"
practice-episodes = 1
measured-episodes = 4

[[conditions]]
name = "helped"
rule = "tolerance"
alpha = 0.6
inference = "nearest"
practice-episodes = 1
measured-episodes = 4
questionnaires = ["nasa-tlx"]

[terrain]
seed = 4

[consent]
version = "1"
text = "Do you agree?"

[primary]
measure = "success"

[equivalence]
success = 0.1
"#;

fn plants() -> Plants {
    let mut plants = Plants::default();
    plants.register(point::entry());
    plants
}

/// Walks through a study and flies with keys drawn from a number.
struct Walker<'a> {
    design: &'a Design,
    events: Vec<Logged>,
    session: Session,
    trials: Vec<TrialRecord>,
    number: u64,
}

impl<'a> Walker<'a> {
    fn invited(design: &'a Design, number: u64, test: bool) -> Self {
        let event =
            Event::Invited { test, simulated: true, language: None, panel: BTreeMap::new(), note: None };
        let first = Logged { seq: 1, at_ms: 1_000, event };
        let session = Session::begin(design, &first).unwrap();
        Walker { design, events: vec![first], session, trials: Vec::new(), number }
    }

    fn push(&mut self, event: Event) {
        let seq = self.session.next_seq();
        let logged = Logged { seq, at_ms: 1_000 * i64::from(seq), event };
        self.session.push(self.design, &logged).unwrap();
        self.events.push(logged);
    }

    /// Goes through `steps` steps, or to the end.
    fn walk(&mut self, steps: usize) {
        for _ in 0..steps {
            let Some(step) = self.session.current().cloned() else { return };
            if step.flight().is_some() {
                self.fly(&step.id);
            }
            let telemetry = json!({ "late_ticks": 1, "key_to_tick_ms": { "median": 9.5 } });
            let data: Value = match step.id.as_str() {
                "consent" => json!({ "agreed": true }),
                _ if step.flight().is_some() => telemetry,
                _ => json!({}),
            };
            let events = self.session.accept(self.design, &step.id, &data).unwrap();
            if events.is_empty() {
                return;
            }
            events.into_iter().for_each(|event| self.push(event));
            if self.session.wants_assignment() {
                let given = assign(self.design, &[CellTally::default(); 2], self.number);
                let (cell, order, seed) = (given.cell, given.order, given.seed);
                self.push(Event::Assigned { cell, order, seed, design: self.design.hash() });
            }
        }
    }

    fn fly(&mut self, step: &str) {
        let place = *self.session.current().and_then(|step| step.flight()).unwrap();
        let resolved = Resolved {
            plant_version: point::entry().version,
            models: vec![ResolvedModels::default(); self.design.conditions.len()],
        };
        let setup = setup(self.design, self.session.assignment().unwrap(), &resolved, &place).unwrap();
        let flown = fly(setup, self.number + u64::from(place.number));
        let episode = 100 * self.number as i64 + self.trials.len() as i64 + 1;
        let (step, attempt) = (step.to_owned(), 1);
        let (ending, ticks) = (flown.ending, flown.ticks() as u32);
        self.push(Event::FlightBegun { step: step.clone(), attempt, episode, clock_offset_ms: None });
        self.push(Event::FlightEnded { step: step.clone(), attempt, episode, ending, ticks });
        self.trials.push(TrialRecord {
            participant: self.number as i64,
            step,
            episode,
            record: Some(flown.to_bytes()),
            program: "cohelm test".into(),
        });
    }
}

fn fly(setup: Setup, number: u64) -> Trajectory {
    let plants = plants();
    let plant = plants.make(&setup.task).unwrap();
    let cockpit = cockpit(&setup, plant.as_ref(), &plants, &Models::default()).unwrap();
    let mut flight = Flight::new(setup, plant, cockpit);
    while flight.ending().is_none() {
        let tick = u64::from(flight.ticks());
        let control = ((number * 31 + tick / 40) % 4) as u8;
        match tick % 40 {
            0 => flight.change(Change::Down(control), tick as f32 * 20.0),
            30 => flight.change(Change::Up(control), tick as f32 * 20.0),
            _ => {}
        }
        flight.tick();
    }
    flight.finish()
}

fn records() -> StudyRecords {
    let design = Design::from_toml(STUDY).unwrap();
    let (mut participants, mut trials) = (Vec::new(), Vec::new());
    for number in 1..=6 {
        let mut walker = Walker::invited(&design, number, false);
        walker.walk(if number == 6 { 5 } else { 100 });
        if number == 5 {
            walker.push(Event::Excluded { reason: "=cmd|' /C calc'!A0".into(), by: "desk".into() });
        }
        let id = number as i64;
        participants.push(ParticipantRecord { id, code: format!("P{number}"), events: walker.events });
        trials.extend(walker.trials);
    }
    participants.push(ParticipantRecord { id: 7, code: "P7".into(), events: Vec::new() });
    StudyRecords { design, participants, trials, models: Vec::new(), program: "cohelm test".into() }
}

fn report(dataset: &Dataset) -> Vec<(String, Vec<u8>)> {
    let bootstrap = bootstrap::Options { resamples: 200, ..bootstrap::Options::default() };
    study_report(dataset, &Options { bootstrap }).files("report")
}

#[test]
fn everyone_is_where_they_came_to() {
    let records = records();
    let made = dataset(&records, &plants(), 1).unwrap();
    let left_out: Vec<Option<LeftOut>> = (0..made.participants.len()).map(|i| made.left_out(i)).collect();
    let expected = [
        None,
        None,
        None,
        None,
        Some(LeftOut::Excluded),
        Some(LeftOut::Unfinished),
        Some(LeftOut::Withdrawn),
    ];
    assert_eq!(left_out, expected);
    assert!(made.simulated());
    assert_eq!(made.participants[6].progress, Progress::Withdrawn);
    assert!(made.trials.iter().all(|trial| trial.counts && trial.measured.is_ok()), "every flight replays");
    assert_eq!(made.trials.iter().filter(|trial| trial.participant == 0).count(), 10);
    assert_eq!(made.flights(0, 1, false).count(), 4);
    assert_eq!(made.trials[0].telemetry["key_to_tick_ms_median"], 9.5);
    assert!(!made.answers.is_empty() && made.answers.iter().all(|answer| answer.value.is_null()));
    assert!(made.scores.iter().all(|score| score.score.is_none()), "no answer, no score");
}

#[test]
fn measures_of_a_replay_are_those_of_the_flight() {
    let records = records();
    let made = dataset(&records, &plants(), 2).unwrap();
    let trial = &made.trials[3];
    let record = records.trials.iter().find(|record| record.episode == trial.episode).unwrap();
    let flown = Trajectory::from_bytes(record.record.as_ref().unwrap()).unwrap();
    let measured = trial.measured.as_ref().unwrap();
    assert_eq!(measured.ending, flown.ending);
    assert_eq!(measured.values["steps"], flown.ticks() as f64);
    let commands = flown.asked.iter().flatten().count();
    assert_eq!(measured.values["ticks_with_command"], commands as f64);
    let downs = flown.keys.iter().filter(|event| matches!(event.change, Change::Down(_))).count();
    assert_eq!(measured.values["key_presses"], downs as f64);
}

#[test]
fn an_archive_gives_the_same_report_in_another_folder_byte_for_byte() {
    let records = records();
    let made = dataset(&records, &plants(), 1).unwrap();
    let archive = write_archive(&records, &made).unwrap();
    assert!(archive == write_archive(&records, &made).unwrap(), "equal records, equal bytes");
    let read = read_archive(&archive).unwrap();
    let again = dataset(&read, &plants(), 3).unwrap();
    assert!(
        archive == write_archive(&read, &again).unwrap(),
        "an archive of what was read is the same archive"
    );
    let (first, second) = (report(&made), report(&again));
    assert_eq!(first.len(), second.len());
    for (a, b) in first.iter().zip(&second) {
        assert!(a == b, "{} differs", a.0);
    }
    let html = String::from_utf8(first[0].1.clone()).unwrap();
    assert!(html.contains("every participant is simulated"), "simulated participants are called so");
    assert!(html.contains("simulated participants have no opinions"));
}

#[test]
fn a_changed_record_or_model_is_told_and_not_measured() {
    let mut records = records();
    let trial = records.trials.iter_mut().find(|trial| trial.step.contains("flight")).unwrap();
    let mut flown = Trajectory::from_bytes(trial.record.as_ref().unwrap()).unwrap();
    flown.keys.truncate(flown.keys.len() / 2);
    trial.record = Some(flown.to_bytes());
    let episode = trial.episode;
    let made = dataset(&records, &plants(), 1).unwrap();
    let of_it = made.trials.iter().find(|trial| trial.episode == episode).unwrap();
    assert!(of_it.measured.as_ref().unwrap_err().contains("other bits"));
    let markdown = study_report(&made, &Options::default()).markdown();
    assert!(markdown.contains("Not measured, 1:"), "the report says so");
    records.models.push(("0".repeat(64), b"no model".to_vec()));
    assert!(dataset(&records, &plants(), 1).unwrap_err().to_string().contains("cannot be read"));
}

#[test]
fn a_changed_archive_is_refused() {
    let records = records();
    let made = dataset(&records, &plants(), 1).unwrap();
    let archive = write_archive(&records, &made).unwrap();
    assert!(read_archive(b"PK but no archive").unwrap_err().to_string().contains("no archive of a study"));
    assert!(read_archive(&archive[..archive.len() / 2]).is_err());
    let mut wrong = records.clone();
    wrong.design.text.push('\n');
    let mut bytes = write_archive(&wrong, &made).unwrap();
    // The hash that versions.json names is that of the text, so a design that fits it is accepted …
    assert!(read_archive(&bytes).is_ok());
    // … and one bit anywhere in the middle is not.
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    let read = read_archive(&bytes);
    assert!(
        read.is_err() || read.is_ok_and(|read| read.design == wrong.design),
        "either told, or in a table that is not read"
    );
}

#[test]
fn formulas_are_defused_in_csv_and_numbers_untouched() {
    let records = records();
    let made = dataset(&records, &plants(), 1).unwrap();
    let participants = cohelm_study::export::participants(&made).csv().to_string();
    assert!(participants.contains("'=cmd|' /C calc'!A0 (by desk)"), "{participants}");
    let trials = cohelm_study::export::trials(&made);
    let negative = trials.csv().to_string().lines().any(|line| line.contains(",-"));
    let has_negative = trials
        .rows
        .iter()
        .flatten()
        .any(|cell| matches!(cell, cohelm_study::csv::Cell::Number(n) if *n < 0.0));
    assert_eq!(negative, has_negative, "a negative number keeps its sign and gets no apostrophe");
}

#[test]
fn flights_to_train_from_come_without_the_excluded() {
    let records = records();
    let made = dataset(&records, &plants(), 1).unwrap();
    let flights = flights(&write_archive(&records, &made).unwrap()).unwrap();
    let fit = records.trials.iter().filter(|trial| trial.participant != 5).count();
    assert_eq!(flights.trajectories.len(), fit);
}

#[test]
fn every_table_is_in_the_dictionary_and_rows_are_as_wide_as_their_heads() {
    let made = dataset(&records(), &plants(), 1).unwrap();
    let sheets = [
        cohelm_study::export::trials(&made),
        cohelm_study::export::participants(&made),
        cohelm_study::export::answers(&made),
    ];
    let dictionary = cohelm_study::export::dictionary(&sheets);
    assert_eq!(dictionary.rows.len(), sheets.iter().map(|sheet| sheet.columns.len()).sum::<usize>());
    for sheet in &sheets {
        assert!(sheet.rows.iter().all(|row| row.len() == sheet.columns.len()), "{}", sheet.name);
        assert!(sheet.columns.iter().all(|column| !column.meaning.is_empty()), "{}", sheet.name);
        assert!(sheet.parquet().is_ok());
    }
}
