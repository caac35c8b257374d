//! Recorded flights that intent may be learnt from, and how many were left out for which reason.
//!
//! What nobody asked for teaches that silence means consent: such flights are left out before anything is learnt.

use crate::commands::fly::open_existing;
use crate::commands::study::data::{Source, is_archive};
use anyhow::{Context, Result};
use cohelm::arbitration::Rule;
use cohelm::plant::Ending;
use cohelm::registry::Task;
use cohelm::trajectory::Trajectory;
use cohelm_server::store::{Page, Progress, Store, unpack};
use cohelm_study::session::Session;
use serde_json::{Value, json};
use std::path::Path;

/// Why a flight teaches nothing of what its pilot wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LeftOut {
    /// The robot flew alone; whoever watched decided nothing.
    Robot,
    /// Nothing was asked from begin to end.
    Silent,
    /// It was broken off: whether the pilot still flew for the goal at the end, nobody knows.
    Abandoned,
}

impl LeftOut {
    const ALL: [Self; 3] = [Self::Robot, Self::Silent, Self::Abandoned];

    /// Why a flight is left out; `None` for one that is learnt from.
    fn why(flown: &Trajectory) -> Option<Self> {
        if matches!(flown.setup.rule, Rule::Robot) {
            Some(Self::Robot)
        } else if flown.asked.iter().all(Option::is_none) {
            Some(Self::Silent)
        } else if flown.ending == Ending::Abandoned {
            Some(Self::Abandoned)
        } else {
            None
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::Silent => "silent",
            Self::Abandoned => "abandoned",
        }
    }

    fn reason(self) -> &'static str {
        match self {
            Self::Robot => "the robot flew alone",
            Self::Silent => "nothing was ever asked",
            Self::Abandoned => "broken off",
        }
    }
}

/// Flights to learn from, each with whose it is.
#[derive(Default)]
pub struct Flown {
    /// Participant and flight, in the order of the files.
    pub flights: Vec<(String, Trajectory)>,
    left_out: Vec<LeftOut>,
}

impl Flown {
    /// Of all the files: databases, each one participant's, and archives of studies.
    pub fn read(files: &[std::path::PathBuf], task: &Task) -> Result<Self> {
        let mut all = Self::default();
        for file in files {
            let found = if is_archive(file)? {
                flights_of_study(file, task)?
            } else {
                flights_of_people(file, task)?
            };
            for (participant, flown) in found {
                all.take(participant, flown);
            }
        }
        Ok(all)
    }

    fn take(&mut self, participant: String, flown: Trajectory) {
        match LeftOut::why(&flown) {
            None => self.flights.push((participant, flown)),
            Some(why) => self.left_out.push(why),
        }
    }

    fn counts(&self) -> impl Iterator<Item = (LeftOut, usize)> {
        LeftOut::ALL.into_iter().map(|why| (why, self.left_out.iter().filter(|of| **of == why).count()))
    }

    /// How many were left out, by reason.
    pub fn left_out(&self) -> Value {
        self.counts()
            .map(|(why, count)| (why.word().to_owned(), json!(count)))
            .collect::<serde_json::Map<_, _>>()
            .into()
    }

    /// The same in words; empty if none was.
    pub fn left_out_text(&self) -> String {
        let some = self.counts().filter(|(_, count)| *count > 0);
        let parts: Vec<String> = some.map(|(why, count)| format!("{count} ({})", why.reason())).collect();
        if parts.is_empty() { String::new() } else { format!("left out: {}", parts.join(", ")) }
    }
}

/// Every finished flight of a person on the task's plant in a database. Those of a study are left out: whose they are, and
/// whether a program flew them, is known where its archive is made.
fn flights_of_people(file: &Path, task: &Task) -> Result<Vec<(String, Trajectory)>> {
    let participant = file.display().to_string();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let store = open_existing(file).await?;
        let mut flights = Vec::new();
        let mut page = Page::newest(500);
        loop {
            let episodes = store.episodes(page).await?;
            let Some(last) = episodes.last() else { break };
            page.before = Some(last.id);
            for episode in episodes {
                let wanted =
                    episode.pilot == "person" && episode.plant == task.plant && episode.trial.is_none();
                if !(wanted && matches!(episode.progress, Progress::Finished { .. })) {
                    continue;
                }
                if let Some(packed) = store.record(episode.id).await? {
                    flights.push((participant.clone(), Trajectory::from_bytes(&unpack(&packed)?)?));
                }
            }
        }
        store.close().await;
        Ok(flights)
    })
}

/// Every finished flight of a study's participants on the task's plant, each with whose it is. Trial runs of the
/// researchers and participants who are excluded teach nothing; neither do simulated ones, unless nobody else took part.
fn flights_of_study(archive: &Path, task: &Task) -> Result<Vec<(String, Trajectory)>> {
    let records = Source { from: archive.as_os_str(), study: None }.records()?;
    let (mut people, mut simulated) = (Vec::new(), Vec::new());
    for participant in &records.participants {
        let Ok(session) = Session::fold(&records.design, &participant.events) else { continue };
        if session.is_test() || session.excluded().is_some() {
            continue;
        }
        let name = format!("{}/{}", records.design.name, participant.code);
        let group = if session.is_simulated() { &mut simulated } else { &mut people };
        for trial in records.trials.iter().filter(|trial| trial.participant == participant.id) {
            let Some(bytes) = &trial.record else { continue };
            let flown = Trajectory::from_bytes(bytes)
                .with_context(|| format!("episode {} of {}", trial.episode, archive.display()))?;
            if flown.setup.task.plant == task.plant {
                group.push((name.clone(), flown));
            }
        }
    }
    if people.is_empty() && !simulated.is_empty() {
        eprintln!("cohelm: nobody took part in {}: its participants are simulated", archive.display());
        return Ok(simulated);
    }
    Ok(people)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohelm::action::Action;
    use cohelm::cockpit::Silence;
    use cohelm::intent::Inference;
    use cohelm::trajectory::{Digests, Setup};

    fn flown(rule: Rule, asked: Option<Action>, ending: Ending) -> Trajectory {
        let setup = Setup {
            task: Task::new("flag-lander"),
            plant_version: 1,
            seed: 1,
            rule,
            inference: Inference::Nearest,
            silence: Silence::default(),
            time_scale: 1.0,
            values: None,
            intent: None,
            pilot: "person".into(),
        };
        let asked = vec![None, asked, None];
        let executed = asked.clone();
        Trajectory { setup, asked, executed, keys: vec![], ending, digests: Digests::default(), tape: None }
    }

    #[test]
    fn only_what_a_pilot_asked_for_to_the_end_is_learnt_from() {
        let command = Some(Action::Command(1));
        let mut all = Flown::default();
        for flight in [
            flown(Rule::Misc, command, Ending::Goal),
            flown(Rule::Hic, command, Ending::Crash),
            flown(Rule::Robot, command, Ending::Goal),
            flown(Rule::Robot, None, Ending::Goal),
            flown(Rule::Misc, None, Ending::Goal),
            flown(Rule::Misc, command, Ending::Abandoned),
        ] {
            all.take("A".into(), flight);
        }
        let kept: Vec<Rule> = all.flights.iter().map(|(_, flown)| flown.setup.rule).collect();
        assert_eq!(kept, [Rule::Misc, Rule::Hic]);
        assert_eq!(all.left_out(), json!({ "robot": 2, "silent": 1, "abandoned": 1 }));
        assert_eq!(
            all.left_out_text(),
            "left out: 2 (the robot flew alone), 1 (nothing was ever asked), 1 (broken off)"
        );
    }

    #[test]
    fn nothing_is_said_where_nothing_was_left_out() {
        assert_eq!(Flown::default().left_out_text(), "");
    }
}
