//! What to think about before a study is run. Nothing of it is forbidden: there are reasons for each.

use super::super::check::texts;
use super::super::{Condition, Design, Order, PlantFacts, schedule};
use crate::questionnaires;
use cohelm::arbitration::Rule;
use cohelm::intent::Inference;

pub(super) fn cautions(design: &Design, facts: Option<&PlantFacts>, minutes: f64) -> Vec<String> {
    let found = [
        uneven(design),
        fixed(design),
        too_short(design, minutes),
        long(minutes),
        no_practice(design),
        told(design),
        scores_that_differ(design),
        untranslated(design),
        slow_limit(design, facts),
        regret_on_axes(design, facts),
    ];
    found.into_iter().flatten().collect()
}

fn uneven(design: &Design) -> Option<String> {
    let (planned, cells) = (design.planned_participants as usize, schedule::cells(design).len());
    let next = planned.div_ceil(cells) * cells;
    (planned % cells != 0).then(|| {
        format!("{planned} participants do not fill {cells} orders equally; {next} would, and the orders then balance out.")
    })
}

fn fixed(design: &Design) -> Option<String> {
    (design.order == Order::Fixed && design.conditions.len() > 1).then(|| {
        "Everyone flies the same order: what is due to practice or fatigue cannot be told from what is due to the \
         conditions."
            .to_owned()
    })
}

fn too_short(design: &Design, minutes: f64) -> Option<String> {
    let told = design.consent.minutes.filter(|told| *told < 0.8 * minutes)?;
    Some(format!("Participants are told {told} minutes; the estimate is {minutes:.0}."))
}

fn long(minutes: f64) -> Option<String> {
    (minutes > 90.0)
        .then(|| format!("{minutes:.0} minutes are long for one sitting; think of breaks, or fewer flights."))
}

fn no_practice(design: &Design) -> Option<String> {
    let without = design.conditions.iter().filter(|condition| condition.practice_episodes == 0);
    let names: Vec<&str> = without.map(|condition| condition.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!("No practice in: {}. Their first measured flights will show learning.", names.join(", "))
    })
}

fn told(design: &Design) -> Option<String> {
    let told = |condition: &&Condition| {
        condition.inference == Inference::Known && !matches!(condition.rule, Rule::Hic | Rule::Robot)
    };
    let names: Vec<&str> =
        design.conditions.iter().filter(told).map(|condition| condition.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!("In {} the co-pilot is told the goal, which no real one is; results say nothing about inferring it.", names.join(", "))
    })
}

/// A score that only some conditions ask for can be compared among these only.
fn scores_that_differ(design: &Design) -> Option<String> {
    let asks = |condition: &Condition, name: &str| condition.questionnaires.iter().any(|own| own == name);
    let partly = |name: &&str| {
        let asking = design.conditions.iter().filter(|condition| asks(condition, name)).count();
        asking > 0 && asking < design.conditions.len()
    };
    let own = design.questionnaires.iter().map(|own| own.name.as_str());
    let all = questionnaires::built_in().iter().map(|known| known.name.as_str()).chain(own);
    let names: Vec<&str> = all.filter(partly).collect();
    (!names.is_empty())
        .then(|| format!("Asked after some conditions only, and compared among these: {}.", names.join(", ")))
}

fn untranslated(design: &Design) -> Option<String> {
    let texts = texts(design);
    let missing = |language: &String| texts.iter().filter(|(_, words)| !words.speaks(language)).count();
    let counted =
        design.languages.iter().map(|language| (language, missing(language))).filter(|(_, count)| *count > 0);
    let found: Vec<String> =
        counted.map(|(language, count)| format!("{language} ({})", super::count(count, "text"))).collect();
    (!found.is_empty()).then(|| {
        format!("Not translated, and read in {} instead: {}.", design.first_language(), found.join(", "))
    })
}

/// The largest κ of MISC-R that is usual on axes; there 0.2 does what 0.7 to 1 does with commands (`docs/continuous.md`).
const MOST_KAPPA_ON_AXES: f64 = 0.5;
/// For MISC-H, which holds on longer: κ before an intervention, and κ · `release` after one
/// (`docs/measured/compare/tuning.csv`).
const MOST_HELD_KAPPA_ON_AXES: (f64, f64) = (1.0, 0.3);

fn regret_on_axes(design: &Design, facts: Option<&PlantFacts>) -> Option<String> {
    if !facts?.axes {
        return None;
    }
    let lenient = |condition: &Condition| match condition.rule {
        Rule::MiscR { kappa } if kappa > MOST_KAPPA_ON_AXES => {
            Some(format!("κ = {kappa} ({}; try 0.2, usual are 0.1 to 0.5)", condition.name))
        }
        Rule::MiscH { kappa, release }
            if kappa > MOST_HELD_KAPPA_ON_AXES.0 || kappa * release > MOST_HELD_KAPPA_ON_AXES.1 =>
        {
            Some(format!("κ = {kappa}, release = {release} ({}; try 1 and 0.25)", condition.name))
        }
        _ => None,
    };
    let found: Vec<String> = design.conditions.iter().filter_map(lenient).collect();
    (!found.is_empty())
        .then(|| format!("On axes nearly everything is let through with {}.", found.join(", ")))
}

fn slow_limit(design: &Design, facts: Option<&PlantFacts>) -> Option<String> {
    let facts = facts?;
    let longest_s = f64::from(facts.limit_ticks?) / facts.ticks_per_second / design.task.time_scale;
    let flights: u32 = design
        .conditions
        .iter()
        .map(|condition| condition.practice_episodes + condition.measured_episodes)
        .sum();
    let more = f64::from(flights) * (longest_s - design.timing.flight_s) / 60.0;
    (more > 20.0).then(|| {
        format!("If every flight lasted to its limit, a participant would need {more:.0} minutes more.")
    })
}
