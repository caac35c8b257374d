//! Which of the design's rules of exclusion a session breaks.

use super::{FlightState, Session};
use crate::design::timeline::FlightPlace;
use crate::design::{Design, RightAnswer};
use cohelm::arbitration::Rule;
use serde::Serialize;
use serde_json::Value;

/// A rule that a session breaks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Breach {
    /// The rule's key in the study's file.
    pub rule: &'static str,
    /// What was found.
    pub found: f64,
    /// What was allowed.
    pub allowed: f64,
}

impl Breach {
    /// In words, for tables and reports.
    pub fn words(&self) -> String {
        let Self { rule, found, allowed } = self;
        format!("{rule}: {found:.3}, allowed {allowed:.3}")
    }
}

impl Session {
    /// The rules of exclusion that the session breaks, in the order of the file's reference. Nobody is excluded by this
    /// itself: analyses leave them out and say so.
    pub fn breaches(&self, design: &Design) -> Vec<Breach> {
        let rules = &design.exclusion;
        let flights = self.measured_flights();
        let quiz_failed = design.quiz.as_ref().is_some_and(|quiz| self.quiz_missed() >= quiz.attempts);
        let flown_by_hand = |place: &FlightPlace| design.conditions[place.condition].rule != Rule::Robot;
        let by_hand: Vec<_> = flights.iter().filter(|(place, _)| flown_by_hand(place)).copied().collect();
        let interrupted = flights.iter().filter(|(_, flight)| flight.interruptions > 0).count();
        let found = [
            breach(
                "failed-checks-over",
                rules.failed_checks_over.map(f64::from),
                self.failed_checks(design) as f64,
            ),
            breach("late-ticks-over", rules.late_ticks_over, late_share(&flights)),
            breach(
                "inattentive-flights-over",
                rules.inattentive_flights_over,
                share(&flights, |flight| is_inattentive(design, flight)),
            ),
            breach(
                "interrupted-flights-over",
                rules.interrupted_flights_over.map(f64::from),
                interrupted as f64,
            ),
            breach(
                "silent-flights-over",
                rules.silent_flights_over,
                share(&by_hand, |flight| {
                    flight.telemetry.as_ref().is_some_and(|seen| seen.presses == Some(0))
                }),
            ),
            breach("failed-quiz", rules.failed_quiz.then_some(0.0), f64::from(u8::from(quiz_failed))),
        ];
        found.into_iter().flatten().collect()
    }

    fn measured_flights(&self) -> Vec<(&FlightPlace, &FlightState)> {
        let measured = self.steps().iter().filter_map(|step| Some((step, step.flight()?)));
        measured
            .filter(|(_, place)| !place.practice)
            .filter_map(|(step, place)| Some((place, self.flight(&step.id)?)))
            .filter(|(_, flight)| flight.ended.is_some())
            .collect()
    }

    /// Attention checks that were answered otherwise than asked for; one that was not answered is failed too, unless the
    /// participant is simulated.
    pub fn failed_checks(&self, design: &Design) -> usize {
        let failed = |step: &crate::design::timeline::Step, answers: &Value| {
            let name = step.id.rsplit('/').next().unwrap_or_default();
            let here = design.attention.checks.iter().filter(|check| check.questionnaire == name);
            here.filter(|check| !is_right(&check.right, answers.get(&check.item.id))).count()
        };
        if self.is_simulated() {
            0
        } else {
            self.answered().map(|(step, done)| failed(step, &done.data)).sum()
        }
    }
}

fn breach(rule: &'static str, allowed: Option<f64>, found: f64) -> Option<Breach> {
    allowed.filter(|allowed| found > *allowed).map(|allowed| Breach { rule, found, allowed })
}

fn is_right(right: &RightAnswer, answer: Option<&Value>) -> bool {
    match (right, answer) {
        (RightAnswer::Number(right), Some(answer)) => answer.as_f64() == Some(*right),
        (RightAnswer::Value(right), Some(answer)) => answer.as_str() == Some(right),
        (_, None) => false,
    }
}

fn is_inattentive(design: &Design, flight: &FlightState) -> bool {
    let hidden_ms = flight.telemetry.as_ref().and_then(|seen| seen.hidden_ms).unwrap_or(0.0);
    design.attention.hidden_at_most_s.is_some_and(|most_s| hidden_ms > 1000.0 * most_s)
}

/// 0 if there is no flight: nothing was found.
fn share(flights: &[(&FlightPlace, &FlightState)], holds: impl Fn(&FlightState) -> bool) -> f64 {
    let count = flights.iter().filter(|(_, flight)| holds(flight)).count();
    count as f64 / flights.len().max(1) as f64
}

fn late_share(flights: &[(&FlightPlace, &FlightState)]) -> f64 {
    let late: u64 =
        flights.iter().filter_map(|(_, flight)| flight.telemetry.as_ref()?.late_ticks).map(u64::from).sum();
    let ticks: u64 =
        flights.iter().filter_map(|(_, flight)| flight.ended).map(|(_, ticks)| u64::from(ticks)).sum();
    late as f64 / ticks.max(1) as f64
}
