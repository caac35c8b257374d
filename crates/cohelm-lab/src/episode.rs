//! What is measured of one episode, from its ticks alone. [`cohelm_study::measures`] defines the words.

use cohelm::action::Action;
use cohelm::cockpit::Tick;
use cohelm::plant::{Ending, Plant};
use serde::Serialize;

/// One episode's measures: a row of the per-episode table.
///
/// Shares of interventions count ticks at which the pilot asked for something.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EpisodeMeasures {
    /// How it ended: exactly one event.
    pub ending: Ending,
    /// Ticks it lasted.
    pub steps: u32,
    /// Sum of the plant's rewards.
    pub reward: f64,
    /// Ticks at which the pilot asked for something: the paper's "inputs" of a held key that repeats.
    pub ticks_with_command: u32,
    /// Keys pressed.
    pub key_presses: u32,
    /// Ticks with a command a second of real time at time scale 1.
    pub commands_per_second: f64,
    /// Share of ticks with a command after which the plant was set differently than asked; `None` if nothing was.
    pub interventions: Option<f64>,
    /// How much of what was asked was replaced, the mean over ticks with a command; `None` if nothing was asked. With
    /// commands the same as `interventions`, on axes the distance as a share of the longest that there is.
    pub replaced: Option<f64>,
    /// Share of ticks with a command at which another label was carried out; `None` if nothing was asked.
    pub nominal_interventions: Option<f64>,
    /// Share of ticks with a command at which the opposite was carried out; `None` if nothing was asked.
    pub opposed: Option<f64>,
    /// Share of ticks at which the inferred goal was the pilot's own.
    pub goal_accuracy: f64,
    /// Whether the inferred goal was the pilot's own at the middle tick.
    pub goal_right_midway: bool,
    /// Whether it was at the last tick.
    pub goal_right_at_end: bool,
    /// Mean of c over all ticks.
    pub mean_confidence: f64,
    /// Ticks after which the plant was set differently than before: how restless it was made.
    pub switches: u32,
}

impl EpisodeMeasures {
    /// The number under a key of [`cohelm_study::measures`]; truths are 0 or 1, and the rates of a participant are 0 or 1
    /// for one episode. `None` if the episode has no value, or no measure has that key.
    pub fn value(&self, key: &str) -> Option<f64> {
        let ended = |ending| Some(f64::from(u8::from(self.ending == ending)));
        let truth = |truth: bool| Some(f64::from(u8::from(truth)));
        match key {
            "success" => ended(Ending::Goal),
            "crash" => ended(Ending::Crash),
            "elsewhere" => ended(Ending::Elsewhere),
            "out_of_bounds" => ended(Ending::OutOfBounds),
            "time_limit" => ended(Ending::TimeLimit),
            "steps" => Some(f64::from(self.steps)),
            "steps_of_successes" => (self.ending == Ending::Goal).then_some(f64::from(self.steps)),
            "reward" => Some(self.reward),
            "ticks_with_command" => Some(f64::from(self.ticks_with_command)),
            "key_presses" => Some(f64::from(self.key_presses)),
            "commands_per_second" => Some(self.commands_per_second),
            "interventions" => self.interventions,
            "replaced" => self.replaced,
            "nominal_interventions" => self.nominal_interventions,
            "opposed" => self.opposed,
            "goal_accuracy" => Some(self.goal_accuracy),
            "goal_right_midway" => truth(self.goal_right_midway),
            "goal_right_at_end" => truth(self.goal_right_at_end),
            "mean_confidence" => Some(self.mean_confidence),
            "switches" => Some(f64::from(self.switches)),
            _ => None,
        }
    }
}

/// Collects an episode's measures tick by tick.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    goals_right: Vec<bool>,
    asked: u32,
    effective: u32,
    replaced: f64,
    nominal: u32,
    opposed: u32,
    switches: u32,
    setting: Option<(u8, Option<Action>)>,
    reward: f64,
    confidence: f64,
    ending: Option<Ending>,
}

impl Tally {
    /// Takes one tick in; the plant is as the tick left it.
    pub fn note(&mut self, tick: &Tick<'_>, plant: &dyn Plant) {
        self.goals_right.push(tick.right);
        self.confidence += f64::from(tick.belief.confidence);
        self.reward += tick.step.reward;
        self.ending = tick.step.ending;
        let remembers = plant.space().switch_count() > 0;
        let setting = (plant.view().switches, if remembers { None } else { tick.executed });
        self.switches += u32::from(self.setting.is_some_and(|before| before != setting));
        self.setting = Some(setting);
        if let Some(intervention) = tick.intervention {
            self.asked += 1;
            self.effective += u32::from(intervention.effective);
            self.replaced += f64::from(intervention.replaced);
            self.nominal += u32::from(intervention.nominal);
            self.opposed += u32::from(intervention.opposed);
        }
    }

    /// The measures of the finished episode. `key_presses` and the plant's tick rate come from outside the ticks.
    pub fn finish(&self, key_presses: u32, ticks_per_second: f64) -> EpisodeMeasures {
        let steps = self.goals_right.len();
        let mean_of_asked = |sum: f64| (self.asked > 0).then(|| sum / f64::from(self.asked));
        let of_asked = |count: u32| mean_of_asked(f64::from(count));
        let of_steps = |sum: f64| if steps == 0 { 0.0 } else { sum / steps as f64 };
        EpisodeMeasures {
            ending: self.ending.unwrap_or(Ending::Abandoned),
            steps: steps as u32,
            reward: self.reward,
            ticks_with_command: self.asked,
            key_presses,
            commands_per_second: of_steps(f64::from(self.asked)) * ticks_per_second,
            interventions: of_asked(self.effective),
            replaced: mean_of_asked(self.replaced),
            nominal_interventions: of_asked(self.nominal),
            opposed: of_asked(self.opposed),
            goal_accuracy: of_steps(self.goals_right.iter().filter(|right| **right).count() as f64),
            goal_right_midway: self.goals_right.get(steps / 2).copied().unwrap_or(false),
            goal_right_at_end: self.goals_right.last().copied().unwrap_or(false),
            mean_confidence: of_steps(self.confidence),
            switches: self.switches,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohelm_study::measures::{OF_A_PARTICIPANT, OF_AN_EPISODE};

    #[test]
    fn every_defined_measure_has_a_value() {
        let nothing_asked = Tally::default().finish(0, 50.0);
        assert_eq!(nothing_asked.interventions, None);
        let asked =
            Tally { asked: 4, effective: 1, replaced: 0.5, ending: Some(Ending::Goal), ..Tally::default() }
                .finish(2, 50.0);
        assert_eq!((asked.interventions, asked.replaced), (Some(0.25), Some(0.125)));
        for measure in OF_AN_EPISODE.iter().chain(&OF_A_PARTICIPANT).filter(|measure| measure.key != "ending")
        {
            assert!(asked.value(measure.key).is_some(), "{} has no value", measure.key);
        }
    }
}
