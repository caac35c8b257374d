//! The paper's Fig. 2 with our data.

use super::name;
use crate::results::Results;
use cohelm_study::figures::{Axis, ByParticipant, Colour, Conditions, Figure, FigureError, Heading, Panel};

/// One look for every condition, the same in all figures.
pub fn looks(results: &Results<'_>) -> Conditions {
    const COLOURS: [Colour; 8] = [
        Colour::GREY,
        Colour::ORANGE,
        Colour::BLUE,
        Colour::VERMILLION,
        Colour::SKY,
        Colour::PURPLE,
        Colour::GREEN,
        Colour::INK,
    ];
    let labels = results.conditions.iter().map(|condition| condition.label.as_str());
    Conditions::with_colours(labels.zip(COLOURS.into_iter().cycle()))
}

/// Fig. 2 (a): success and crash rates of every participant.
pub fn figure_2a(results: &Results<'_>, subtitle: &str) -> Result<Figure, FigureError> {
    let panels = [("success", "Success rate"), ("crash", "Crash rate")];
    let panels = panels.map(|(key, title)| (key, Axis::share(title)));
    by_participant(results, Heading::new("Success and crashes", subtitle), panels.into())
}

/// Fig. 2 (b): steps an episode.
pub fn figure_2b(results: &Results<'_>, subtitle: &str) -> Result<Figure, FigureError> {
    let panels = vec![("steps", Axis::amount("Steps per episode (20 ms each)"))];
    by_participant(results, Heading::new("How long an episode lasts", subtitle), panels)
}

/// Fig. 2 (c): inputs an episode, counted as ticks with a command and as key presses.
pub fn figure_2c(results: &Results<'_>, subtitle: &str) -> Result<Figure, FigureError> {
    let panels = vec![
        ("ticks_with_command", Axis::amount("Ticks with a command")),
        ("key_presses", Axis::amount("Key presses")),
    ];
    by_participant(results, Heading::new("Inputs per episode", subtitle), panels)
}

/// The paper's three modes, and MISC-R: four bars a participant, as in Fig. 2.
const SHOWN: [&str; 4] = [name::HIC, name::LASC, name::MISC, name::MISC_R];

fn by_participant(
    results: &Results<'_>,
    heading: Heading,
    panels: Vec<(&str, Axis)>,
) -> Result<Figure, FigureError> {
    let shown: Vec<usize> = SHOWN.iter().filter_map(|name| results.condition(name)).collect();
    let labels: Vec<&str> = shown.iter().map(|&index| results.conditions[index].label.as_str()).collect();
    let panel = |(key, axis)| Panel { axis, values: results.columns(key, &shown) };
    let figure = ByParticipant {
        heading,
        participants: (0..results.participants).map(Results::name_of).collect(),
        conditions: looks(results).only(&labels),
        panels: panels.into_iter().map(panel).collect(),
    };
    figure.figure()
}
