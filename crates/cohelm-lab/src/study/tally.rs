//! What only a study measures of a flight, collected tick by tick. [`cohelm_study::measures`] defines the words.

use crate::episode::{EpisodeMeasures, Tally};
use cohelm::action::Action;
use cohelm::cockpit::Tick;
use cohelm::plant::Plant;
use cohelm_study::dataset::{Class, Measured, Part};
use cohelm_study::measures::{ANSWER_TICKS, CLASSES, OF_A_FLIGHT, OF_A_PARTICIPANT, OF_AN_EPISODE, PARTS};
use std::collections::BTreeMap;

/// One tick, as far as parts and classes need it.
#[derive(Clone, Copy, Debug)]
struct Moment {
    commanded: bool,
    as_asked: bool,
    goal_right: bool,
    confidence: f64,
}

/// Something that happened a while ago.
#[derive(Clone, Copy, Debug)]
struct Past {
    tick: u32,
    action: Action,
}

/// Collects the measures of a flight of a study.
#[derive(Clone, Debug, Default)]
pub struct FlightTally {
    episode: Tally,
    moments: Vec<Moment>,
    answers: Answers,
    wrong: WrongInterventions,
}

impl FlightTally {
    /// Takes one tick in; the plant is as the tick left it.
    pub fn note(&mut self, tick: &Tick<'_>, plant: &dyn Plant) {
        self.episode.note(tick, plant);
        let effective = tick.intervention.is_some_and(|intervention| intervention.effective);
        let moment = Moment {
            commanded: tick.asked.is_some(),
            as_asked: tick.asked.is_some() && !effective,
            goal_right: tick.right,
            confidence: f64::from(tick.belief.confidence),
        };
        self.moments.push(moment);
        self.answers.note(tick, effective, plant);
        self.wrong.note(tick.tick, &moment, effective);
    }

    /// The measures of the finished flight.
    pub fn finish(self, key_presses: u32, ticks_per_second: f64) -> Measured {
        let episode = self.episode.finish(key_presses, ticks_per_second);
        let mut values = of_the_episode(&episode);
        values.extend(of_the_flight(&self.moments, &self.answers, &self.wrong, ticks_per_second));
        Measured {
            ending: episode.ending,
            values,
            parts: parts(&self.moments),
            classes: classes(&self.moments),
        }
    }
}

fn of_the_episode(episode: &EpisodeMeasures) -> BTreeMap<&'static str, f64> {
    let measures = OF_A_PARTICIPANT.iter().chain(&OF_AN_EPISODE);
    measures.filter_map(|measure| Some((measure.key, episode.value(measure.key)?))).collect()
}

fn of_the_flight(
    moments: &[Moment],
    answers: &Answers,
    wrong: &WrongInterventions,
    ticks_per_second: f64,
) -> impl Iterator<Item = (&'static str, f64)> {
    let commands = moments.iter().filter(|moment| moment.commanded).count();
    let as_asked = moments.iter().filter(|moment| moment.as_asked).count();
    let of_commands = move |count: usize| (commands > 0).then(|| count as f64 / commands as f64);
    let corrected = wrong.corrected_ticks.len();
    let ticks_to_correct: u32 = wrong.corrected_ticks.iter().sum();
    let when_wrong = moments.iter().filter(|moment| !moment.goal_right).map(|moment| moment.confidence);
    let value = move |key: &str, means: [Option<f64>; 2]| match key {
        "seconds" => Some(moments.len() as f64 / ticks_per_second),
        "authority" => of_commands(as_asked),
        "reversals" => Some(f64::from(answers.reversals)),
        "repeats" => Some(f64::from(answers.repeats)),
        "wrong_interventions" => of_commands(wrong.ticks),
        "time_to_correct" => {
            (corrected > 0).then(|| f64::from(ticks_to_correct) / corrected as f64 / ticks_per_second)
        }
        "uncorrected" => Some(f64::from(u8::from(wrong.since.is_some()))),
        "brier" => means[0],
        "confidence_when_wrong" => means[1],
        _ => None,
    };
    let means = [mean(moments.iter().map(squared_error)), mean(when_wrong)];
    OF_A_FLIGHT.iter().filter_map(move |measure| Some((measure.key, value(measure.key, means)?)))
}

fn squared_error(moment: &Moment) -> f64 {
    let off = moment.confidence - f64::from(u8::from(moment.goal_right));
    off * off
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// Equal parts of the flight: tick i of n lies in part ⌊i · PARTS / n⌋, so a flight shorter than that leaves some empty.
fn parts(moments: &[Moment]) -> Vec<Part> {
    let mut parts = vec![Part::default(); PARTS];
    for (i, moment) in moments.iter().enumerate() {
        let part = &mut parts[i * PARTS / moments.len()];
        part.ticks += 1;
        part.commands += u32::from(moment.commanded);
        part.as_asked += u32::from(moment.as_asked);
        part.goal_right += u32::from(moment.goal_right);
        part.confidence += moment.confidence;
    }
    parts
}

/// Equal classes of the confidence; c = 1 lies in the last.
fn classes(moments: &[Moment]) -> Vec<Class> {
    let mut classes = vec![Class::default(); CLASSES];
    for moment in moments {
        let class = &mut classes[((moment.confidence * CLASSES as f64) as usize).min(CLASSES - 1)];
        class.ticks += 1;
        class.goal_right += u32::from(moment.goal_right);
        class.confidence += moment.confidence;
    }
    classes
}

/// What the pilot answers to what the co-pilot does.
#[derive(Clone, Debug, Default)]
struct Answers {
    before: Option<Action>,
    replaced: Vec<Past>,
    of_its_own: Vec<Past>,
    reversals: u32,
    repeats: u32,
}

impl Answers {
    fn note(&mut self, tick: &Tick<'_>, effective: bool, plant: &dyn Plant) {
        let recent = |past: &Past| tick.tick - past.tick <= ANSWER_TICKS;
        self.replaced.retain(recent);
        self.of_its_own.retain(recent);
        if let Some(asked) = tick.asked.filter(|_| tick.asked != self.before) {
            let opposed = |past: &Past| opposes(past.action, asked, plant);
            self.reversals += u32::from(self.of_its_own.iter().any(opposed));
            self.repeats += u32::from(self.replaced.iter().any(|past| past.action == asked));
        }
        self.before = tick.asked;
        let past = |action| Past { tick: tick.tick, action };
        if effective {
            self.replaced.extend(tick.asked.map(past));
        }
        if effective || tick.asked.is_none() {
            self.of_its_own.extend(tick.executed.map(past));
        }
    }
}

/// As an intervention is called opposed: similarity −1, and for axes more against than along.
fn opposes(action: Action, asked: Action, plant: &dyn Plant) -> bool {
    match (action, asked) {
        (Action::Axes(a), Action::Axes(b)) => a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>() < 0.0,
        _ => plant.similarity(action, asked) <= -1.0,
    }
}

/// Interventions while the co-pilot was wrong about the goal, and how long they lasted.
#[derive(Clone, Debug, Default)]
struct WrongInterventions {
    ticks: usize,
    since: Option<u32>,
    corrected_ticks: Vec<u32>,
}

impl WrongInterventions {
    fn note(&mut self, tick: u32, moment: &Moment, effective: bool) {
        let wrong = effective && !moment.goal_right;
        self.ticks += usize::from(wrong);
        match self.since {
            None if wrong => self.since = Some(tick),
            Some(since) if moment.goal_right || moment.as_asked => {
                self.corrected_ticks.push(tick - since);
                self.since = None;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohelm::cockpit::Intervention;
    use cohelm::intent::Belief;
    use cohelm::plant::{Ending, Step};
    use cohelm::point::Point;
    use cohelm::value::ActionValues;

    const ALONG: Action = Action::Axes([1.0, 0.0, 0.0, 0.0]);
    const AGAINST: Action = Action::Axes([-1.0, 0.0, 0.0, 0.0]);

    /// One tick in a few letters: asked, executed, whether the goal was right, c.
    type Said = (Option<Action>, Option<Action>, bool, f32);

    fn measured(ticks: &[Said]) -> Measured {
        let plant = Point::new();
        let own = plant.pilot_goal();
        let values = ActionValues::equal(vec![ALONG, AGAINST]).unwrap();
        let mut tally = FlightTally::default();
        for (i, &(asked, executed, right, confidence)) in ticks.iter().enumerate() {
            let goal = if right { own } else { 1 - own };
            let mut belief = Belief::certain(2, goal);
            belief.confidence = confidence;
            let replaced = asked.is_some() && asked != executed;
            let intervention = asked.map(|_| Intervention { effective: replaced, ..Intervention::default() });
            let ending = (i + 1 == ticks.len()).then_some(Ending::Goal);
            let step = Step { reward: 0.0, ending };
            let (tick, allowed) = (i as u32, &[][..]);
            tally.note(
                &Tick { tick, asked, belief, right, values: &values, allowed, executed, intervention, step },
                &plant,
            );
        }
        tally.finish(0, 50.0)
    }

    #[test]
    fn going_against_what_the_copilot_did_of_its_own_accord_is_a_reversal() {
        let alone = (None, Some(ALONG), true, 1.0);
        let back = (Some(AGAINST), Some(AGAINST), true, 1.0);
        assert_eq!(measured(&[alone, back, back, back]).values["reversals"], 1.0, "holding is no second one");
        let with_it = (Some(ALONG), Some(ALONG), true, 1.0);
        assert_eq!(measured(&[alone, with_it]).values["reversals"], 0.0);
        assert_eq!(
            measured(&[with_it, back]).values["reversals"],
            0.0,
            "the co-pilot did nothing of its own"
        );
        let nothing = (None, None, true, 1.0);
        let late: Vec<Said> = [alone].into_iter().chain([nothing; 26]).chain([back]).collect();
        assert_eq!(measured(&late).values["reversals"], 0.0, "more than 25 ticks later");
    }

    #[test]
    fn asking_again_for_what_was_replaced_is_a_repeat() {
        let replaced = (Some(ALONG), Some(AGAINST), true, 1.0);
        let nothing = (None, None, true, 1.0);
        let held = measured(&[replaced, replaced, replaced]);
        assert_eq!(held.values["repeats"], 0.0);
        assert_eq!(measured(&[replaced, nothing, replaced]).values["repeats"], 1.0);
    }

    #[test]
    fn a_wrong_intervention_lasts_until_the_goal_is_right_or_the_pilot_gets_through() {
        let wrong = (Some(ALONG), Some(AGAINST), false, 0.9);
        let silent = (None, Some(AGAINST), false, 0.9);
        let through = (Some(ALONG), Some(ALONG), false, 0.9);
        let right = (Some(ALONG), Some(AGAINST), true, 0.9);
        let flown = measured(&[wrong, silent, through, wrong, right, wrong]);
        // Two ticks and one tick at 50 a second; the last is cut short by the ending.
        assert!((flown.values["time_to_correct"] - 0.03).abs() < 1e-12);
        assert_eq!(flown.values["uncorrected"], 1.0);
        assert_eq!(flown.values["wrong_interventions"], 3.0 / 5.0);
        assert_eq!(flown.values["authority"], 1.0 / 5.0);
        assert!(!measured(&[right]).values.contains_key("time_to_correct"));
    }

    #[test]
    fn calibration_is_what_its_definition_says_by_hand() {
        let flown = measured(&[
            (None, None, true, 0.75),
            (None, None, false, 0.25),
            (None, None, true, 1.0),
            (None, None, false, 1.0),
        ]);
        assert!((flown.values["brier"] - (0.0625 + 0.0625 + 0.0 + 1.0) / 4.0).abs() < 1e-12);
        assert!((flown.values["confidence_when_wrong"] - 0.625).abs() < 1e-12);
        assert_eq!((flown.classes[7].ticks, flown.classes[7].goal_right), (1, 1));
        assert_eq!((flown.classes[9].ticks, flown.classes[9].goal_right), (2, 1));
    }

    #[test]
    fn parts_share_the_ticks_evenly_and_every_defined_measure_can_have_a_value() {
        let wrong = (Some(ALONG), Some(AGAINST), false, 0.5);
        let through = (Some(ALONG), Some(ALONG), true, 0.5);
        let flown = measured(&[wrong, through].repeat(50));
        assert!(flown.parts.iter().all(|part| part.ticks == 5));
        assert_eq!(flown.parts.iter().map(|part| part.as_asked).sum::<u32>(), 50);
        for measure in OF_AN_EPISODE.iter().chain(&OF_A_FLIGHT).filter(|measure| measure.key != "ending") {
            assert!(flown.values.contains_key(measure.key), "{} has no value", measure.key);
        }
    }
}
