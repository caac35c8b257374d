//! What is measured of an episode, in words: one definition for tables, reports and data dictionaries.
//!
//! Keys are the column names of every CSV file. A participant's value is the mean over that participant's episodes in a
//! condition, unless the definition says otherwise; episodes without a value are left out of the mean.

use crate::apa::{number, percent};
use crate::csv::{Cell, Csv};
use crate::text::{Text, capitalised};
use serde::Serialize;

/// In what a measure counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// One of a list of words.
    Word,
    /// Yes or no.
    Truth,
    /// A share of one, printed as percent.
    Share,
    /// A count; the word says of what.
    Count(&'static str),
    /// Times a second.
    PerSecond(&'static str),
    /// A number on a scale of its own.
    Number,
}

impl Unit {
    /// The unit as a data dictionary names it.
    pub fn word(self) -> &'static str {
        match self {
            Unit::Word => "word",
            Unit::Truth => "true or false",
            Unit::Share => "share of one",
            Unit::Count(of) | Unit::PerSecond(of) => of,
            Unit::Number => "number",
        }
    }
}

/// Which values a measure can take.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Range {
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// From 0 to 1.
    Unit,
    /// Zero or more.
    NotNegative,
    /// Any finite number.
    Any,
}

impl Range {
    /// The range as a data dictionary writes it.
    pub fn words(self) -> String {
        match self {
            Range::OneOf(words) => words.join(" | "),
            Range::Unit => "0 to 1".to_owned(),
            Range::NotNegative => "0 or more".to_owned(),
            Range::Any => "any".to_owned(),
        }
    }
}

/// The definition of one measure.
///
/// Those of episodes are fixed and listed here; the scores of a questionnaire come with a study's design.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measure<'a> {
    /// Column name.
    pub key: &'a str,
    /// Name in tables and figures, in lower case, as it stands within a sentence.
    pub name: &'a str,
    /// What is counted, exactly.
    pub meaning: &'a str,
    /// In what it counts.
    pub unit: Unit,
    /// Which values it can take.
    pub range: Range,
    /// When an episode has no value; empty if it always has one.
    pub missing_when: &'static str,
    /// Decimals of a mean in tables and sentences (of percent, for shares).
    pub decimals: usize,
}

impl Measure<'_> {
    /// A value or mean as tables and sentences print it: `85.5 %`, `238.2`.
    pub fn write(&self, value: f64) -> String {
        if self.unit == Unit::Share { percent(value, self.decimals) } else { number(value, self.decimals) }
    }

    /// A difference between values as a number, of shares in percentage points; [`Self::difference_unit`] goes behind.
    pub fn difference(&self, difference: f64) -> String {
        let factor = if self.unit == Unit::Share { 100.0 } else { 1.0 };
        number(factor * difference, self.decimals)
    }

    /// The end of an interval of differences. No two shares differ by more than 100 points: what a symmetrical interval
    /// says beyond is left off, as it is of the intervals of shares themselves.
    pub fn difference_end(&self, end: f64) -> String {
        self.difference(if self.unit == Unit::Share { end.clamp(-1.0, 1.0) } else { end })
    }

    /// What goes behind a difference, or an interval of differences: " points" for shares.
    pub fn difference_unit(&self) -> &'static str {
        if self.unit == Unit::Share { "\u{a0}points" } else { "" }
    }

    /// A difference with its unit.
    pub fn write_difference(&self, difference: f64) -> String {
        self.difference(difference) + self.difference_unit()
    }

    /// The name with a capital, for the beginning of a line.
    pub fn title(&self) -> String {
        capitalised(self.name)
    }
}

/// The words of the measure `ending`, which exclude one another.
pub const ENDINGS: [&str; 6] = ["goal", "elsewhere", "crash", "out-of-bounds", "time-limit", "abandoned"];

/// The measures of one episode, in the order of the columns.
pub const OF_AN_EPISODE: [Measure<'static>; 15] = [
    Measure {
        key: "ending",
        name: "ending",
        meaning: "How the episode ended; exactly one event. goal: at the pilot’s own goal. elsewhere: well-behaved, \
                  but not there. crash: crashed or otherwise broken. out-of-bounds: left the space it may be in. time-limit: \
                  none of these in time (a truncation). abandoned: stopped from outside (a truncation).",
        unit: Unit::Word,
        range: Range::OneOf(&ENDINGS),
        missing_when: "",
        decimals: 0,
    },
    Measure {
        key: "steps",
        name: "steps",
        meaning: "Ticks from the start to the ending.",
        unit: Unit::Count("ticks"),
        range: Range::NotNegative,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "reward",
        name: "reward",
        meaning: "Sum of the plant’s rewards for the pilot’s own goal, undiscounted.",
        unit: Unit::Number,
        range: Range::Any,
        missing_when: "",
        decimals: 2,
    },
    Measure {
        key: "ticks_with_command",
        name: "ticks with a command",
        meaning: "Ticks at which the pilot asked for something: a held key asks at every tick, a release asks once. The \
                  reading of the paper’s “inputs” that fits its numbers.",
        unit: Unit::Count("ticks"),
        range: Range::NotNegative,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "key_presses",
        name: "key presses",
        meaning: "Times a key went down; holding it does not count again.",
        unit: Unit::Count("presses"),
        range: Range::NotNegative,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "commands_per_second",
        name: "commands per second",
        meaning: "Ticks with a command divided by the simulated seconds of the episode: input that does not grow merely \
                  because the flight lasts longer.",
        unit: Unit::PerSecond("ticks per second"),
        range: Range::NotNegative,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "interventions",
        name: "interventions",
        meaning: "Share of the ticks with a command after which the plant was set differently than the asked command would \
                  have set it: interventions by effect.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "the pilot asked for nothing",
        decimals: 1,
    },
    Measure {
        key: "replaced",
        name: "replaced",
        meaning: "How much of what was asked was replaced by something else, the mean over the ticks with a command: with \
                  commands the same as interventions; on axes the distance of what was carried out from what was asked, as a \
                  share of the longest distance that there is, because there nearly every help changes something.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "the pilot asked for nothing",
        decimals: 1,
    },
    Measure {
        key: "nominal_interventions",
        name: "nominal interventions",
        meaning: "Share of the ticks with a command at which a command of another label was carried out, though perhaps \
                  with the same effect.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "the pilot asked for nothing",
        decimals: 1,
    },
    Measure {
        key: "opposed",
        name: "opposed commands",
        meaning: "Share of the ticks with a command at which the opposite was carried out (similarity −1).",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "the pilot asked for nothing",
        decimals: 1,
    },
    Measure {
        key: "goal_accuracy",
        name: "goal accuracy",
        meaning: "Share of the ticks at which the goal inferred as the most likely was the pilot’s own.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "goal_right_midway",
        name: "goal right midway",
        meaning: "Whether the inferred goal was the pilot’s own at the middle tick.",
        unit: Unit::Truth,
        range: Range::OneOf(&["true", "false"]),
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "goal_right_at_end",
        name: "goal right at the end",
        meaning: "Whether the inferred goal was the pilot’s own at the last tick.",
        unit: Unit::Truth,
        range: Range::OneOf(&["true", "false"]),
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "mean_confidence",
        name: "mean confidence",
        meaning: "Mean over the ticks of the confidence c that arbitration was given.",
        unit: Unit::Number,
        range: Range::Unit,
        missing_when: "",
        decimals: 2,
    },
    Measure {
        key: "switches",
        name: "switches",
        meaning: "Ticks that left the plant set differently than it was before: how restlessly it was steered, by whomever.",
        unit: Unit::Count("ticks"),
        range: Range::NotNegative,
        missing_when: "",
        decimals: 1,
    },
];

/// The measures of a participant in a condition that are no plain mean of an episode's measure.
pub const OF_A_PARTICIPANT: [Measure<'static>; 6] = [
    Measure {
        key: "success",
        name: "success rate",
        meaning: "Share of the episodes that ended at the pilot’s own goal.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "crash",
        name: "crash rate",
        meaning: "Share of the episodes that ended in a crash.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "elsewhere",
        name: "rate of ending elsewhere",
        meaning: "Share of the episodes that ended well-behaved, but not at the pilot’s own goal.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "out_of_bounds",
        name: "rate of leaving the space",
        meaning: "Share of the episodes that left the space.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "time_limit",
        name: "rate of running out of time",
        meaning: "Share of the episodes that reached the time limit.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "steps_of_successes",
        name: "steps of successful episodes",
        meaning: "Mean number of steps over the episodes that ended at the pilot’s own goal: a mode that crashes early does \
                  not look fast.",
        unit: Unit::Count("ticks"),
        range: Range::NotNegative,
        missing_when: "no episode ended at the goal",
        decimals: 1,
    },
];

/// Ticks within which a new request counts as an answer to what the co-pilot did: half a second at 50 Hz, the time that
/// people need to see a change and to act on it, with some to spare.
pub const ANSWER_TICKS: u32 = 25;

/// Equal parts into which a flight is cut for authority over time.
pub const PARTS: usize = 20;

/// Equal classes of the confidence for its calibration.
pub const CLASSES: usize = 10;

/// What is measured of an episode in a study besides [`OF_AN_EPISODE`].
pub const OF_A_FLIGHT: [Measure<'static>; 9] = [
    Measure {
        key: "seconds",
        name: "seconds of flight",
        meaning: "Simulated seconds from the start to the ending: steps divided by the plant’s ticks a second. At a time scale \
                  below 1 the pilot’s clock showed more.",
        unit: Unit::Count("seconds"),
        range: Range::NotNegative,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "authority",
        name: "pilot’s authority",
        meaning: "Share of the ticks with a command after which the plant was set as the asked command would have set it: one \
                  minus interventions. Over the flight: the same within each of 20 equal parts of it.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "the pilot asked for nothing",
        decimals: 1,
    },
    Measure {
        key: "reversals",
        name: "reversals",
        meaning: "Times the pilot went against the co-pilot: a request differs from that of the tick before, and is the opposite \
                  (as in opposed commands) of what the co-pilot carried out of its own accord within the last 25 ticks. Of its own accord: \
                  nothing was asked, or what was asked was replaced in effect. The release of a switch’s key asks for its off.",
        unit: Unit::Count("times"),
        range: Range::NotNegative,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "repeats",
        name: "repeats",
        meaning: "Times the pilot insisted: a request differs from that of the tick before, and is the same as one that was replaced \
                  in effect within the last 25 ticks.",
        unit: Unit::Count("times"),
        range: Range::NotNegative,
        missing_when: "",
        decimals: 1,
    },
    Measure {
        key: "wrong_interventions",
        name: "wrong interventions",
        meaning: "Share of the ticks with a command that was replaced in effect while the inferred goal was not the pilot’s own.",
        unit: Unit::Share,
        range: Range::Unit,
        missing_when: "the pilot asked for nothing",
        decimals: 1,
    },
    Measure {
        key: "time_to_correct",
        name: "time to correct",
        meaning: "Mean time, in simulated seconds, from the first tick of a wrong intervention to the first later tick at which the \
                  inferred goal was the pilot’s own or a command of the pilot took effect as asked. Wrong interventions that the ending \
                  cut short are left out and counted as uncorrected.",
        unit: Unit::Count("seconds"),
        range: Range::NotNegative,
        missing_when: "no wrong intervention was corrected",
        decimals: 2,
    },
    Measure {
        key: "uncorrected",
        name: "uncorrected wrong interventions",
        meaning: "Wrong interventions that had not been corrected when the episode ended: 0 or 1.",
        unit: Unit::Count("times"),
        range: Range::NotNegative,
        missing_when: "",
        decimals: 2,
    },
    Measure {
        key: "brier",
        name: "Brier score of the confidence",
        meaning: "Mean over the ticks of (c − 1)² where the inferred goal was the pilot’s own, and of c² where it was not: 0 is best, \
                  and always saying ½ gives 0.25. The confidence is taken for the probability of being right, which that of Eq. 1 does \
                  not claim to be.",
        unit: Unit::Number,
        range: Range::Unit,
        missing_when: "the episode had no tick",
        decimals: 3,
    },
    Measure {
        key: "confidence_when_wrong",
        name: "confidence when wrong",
        meaning: "Mean of c over the ticks at which the inferred goal was not the pilot’s own.",
        unit: Unit::Number,
        range: Range::Unit,
        missing_when: "the inferred goal was right at every tick",
        decimals: 2,
    },
];

/// The measures of a participant in a condition that need all ticks of it together.
pub const OF_ALL_TICKS: [Measure<'static>; 1] = [Measure {
    key: "calibration_error",
    name: "calibration error",
    meaning: "Expected calibration error over all ticks of a participant in a condition: the ticks are put into ten equal classes of \
              the confidence c; the mean over the classes, weighted by their ticks, of the distance between mean c and the share of \
              ticks at which the inferred goal was the pilot’s own.",
    unit: Unit::Number,
    range: Range::Unit,
    missing_when: "no episode had a tick",
    decimals: 3,
}];

/// Every measure there is, in the order of the columns: rates, then what an episode has, then what only studies measure.
pub fn all() -> impl Iterator<Item = &'static Measure<'static>> {
    OF_A_PARTICIPANT.iter().chain(&OF_AN_EPISODE).chain(&OF_A_FLIGHT).chain(&OF_ALL_TICKS)
}

/// The definition under a key, of an episode or of a participant.
pub fn measure(key: &str) -> Option<&'static Measure<'static>> {
    all().find(|measure| measure.key == key)
}

/// A data dictionary: what every column means, in what unit, of which type and range, and when it is empty.
pub fn dictionary(measures: &[Measure<'_>]) -> Csv {
    let mut csv = Csv::new(["column", "meaning", "unit", "range", "empty_when"]);
    for measure in measures {
        csv.push([
            Cell::from(measure.key),
            Cell::from(measure.meaning),
            Cell::from(measure.unit.word()),
            Cell::from(measure.range.words()),
            Cell::from(measure.missing_when),
        ]);
    }
    csv
}

/// The definition as a report prints it.
pub fn definition(measure: &Measure<'_>) -> Text {
    let missing = match measure.missing_when {
        "" => String::new(),
        when => format!(" No value when {when}."),
    };
    Text::from(format!("{}{missing} Unit: {}. Column ", measure.meaning, measure.unit.word()))
        .code(measure.key)
        .plain(".")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_unique_and_are_column_names() {
        let keys: Vec<&str> = all().map(|m| m.key).collect();
        for (i, key) in keys.iter().enumerate() {
            assert!(!keys[..i].contains(key), "{key} twice");
            assert!(key.bytes().all(|b| b.is_ascii_lowercase() || b == b'_'), "{key}");
        }
    }

    #[test]
    fn definitions_are_sentences_and_ranges_fit_units() {
        for m in all() {
            assert!(m.meaning.ends_with('.') && m.meaning.starts_with(char::is_uppercase), "{}", m.key);
            assert_eq!(m.unit == Unit::Share, m.range == Range::Unit && m.unit != Unit::Number, "{}", m.key);
            assert!(!definition(m).to_string().contains("  "), "{}", m.key);
        }
    }

    #[test]
    fn the_dictionary_has_a_row_a_measure() {
        let csv = dictionary(&OF_AN_EPISODE);
        assert_eq!(csv.rows().len(), OF_AN_EPISODE.len());
        assert!(csv.to_string().contains("goal | elsewhere | crash"));
    }

    #[test]
    fn values_are_written_in_their_unit() {
        let success = measure("success").unwrap();
        assert_eq!(success.write(0.855), "85.5\u{202f}%");
        assert_eq!(success.write_difference(-0.015), "−1.5\u{a0}points");
        assert_eq!(measure("steps").unwrap().write(238.25), "238.2");
        assert_eq!(measure("interventions").unwrap().title(), "Interventions");
        assert!(measure("unheard of").is_none());
    }
}
