//! What is compared between conditions: a measure of flights, or a score of a questionnaire.

use crate::dataset::{Dataset, Score};
use crate::design::{Condition, Design};
use crate::figures::Axis;
use crate::measures::{self, Measure, Range, Unit};
use crate::questionnaires;
use cohelm::arbitration::Rule;
use cohelm::intent::Inference;

/// Measures of what the co-pilot does to commands.
const INTERVENTIONS: [&str; 9] = [
    "interventions",
    "nominal_interventions",
    "opposed",
    "authority",
    "reversals",
    "repeats",
    "wrong_interventions",
    "time_to_correct",
    "uncorrected",
];
/// Measures of what the co-pilot believes.
const BELIEFS: [&str; 8] = [
    "goal_accuracy",
    "goal_right_midway",
    "goal_right_at_end",
    "mean_confidence",
    "brier",
    "calibration_error",
    "confidence_when_wrong",
    "wrong_interventions",
];

/// Something with one value a participant and condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Column name, or `questionnaire/score`.
    pub key: String,
    /// Name in lower case.
    pub name: String,
    /// What it is.
    pub meaning: String,
    /// In what it counts.
    pub unit: Unit,
    /// Which values it can have.
    pub range: Range,
    /// Decimals in tables.
    pub decimals: usize,
    /// Where its values come from.
    pub source: Source,
    /// For a score, the lowest and the highest value it can have.
    pub limits: Option<(f64, f64)>,
}

/// Where a quantity's values come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// Measured of flights.
    Flights,
    /// Answered.
    Score {
        /// The questionnaire.
        instrument: String,
        /// The score.
        scale: String,
    },
}

impl Quantity {
    /// The measure of flights of that key.
    pub fn of_flights(key: &str) -> Option<Self> {
        let measure = measures::measure(key).filter(|measure| measure.unit != Unit::Word)?;
        Some(Quantity {
            key: measure.key.to_owned(),
            name: measure.name.to_owned(),
            meaning: measure.meaning.to_owned(),
            // A mean of truths is a share.
            unit: if measure.unit == Unit::Truth { Unit::Share } else { measure.unit },
            range: measure.range,
            decimals: measure.decimals,
            source: Source::Flights,
            limits: None,
        })
    }

    /// The score of a questionnaire.
    pub fn of_score(design: &Design, instrument: &str, scale: &str) -> Self {
        let name = match scale {
            "" | "overall" => format!("score {instrument}"),
            _ => format!("score {instrument}: {scale}"),
        };
        Quantity {
            key: format!("{instrument}/{scale}"),
            meaning: format!("Score {scale:?} of the questionnaire {instrument:?}."),
            name,
            unit: Unit::Number,
            range: Range::Any,
            decimals: 1,
            source: Source::Score { instrument: instrument.to_owned(), scale: scale.to_owned() },
            limits: questionnaires::find(design, instrument).and_then(|found| found.range(scale)),
        }
    }

    /// The quantity of a name in a design: a measure's key, or `questionnaire/score`.
    pub fn named(dataset: &Dataset, name: &str) -> Result<Self, String> {
        if let Some(quantity) = Self::of_flights(name) {
            return Ok(quantity);
        }
        let known = Self::scores(dataset);
        known.iter().find(|quantity| quantity.key == name).cloned().ok_or_else(|| {
            let scores: Vec<&str> = known.iter().map(|quantity| quantity.key.as_str()).collect();
            let scores = if scores.is_empty() { "none".to_owned() } else { scores.join(", ") };
            format!("there is no measure {name:?}, and no such score among those that were asked for after a condition: {scores}")
        })
    }

    /// Every score that was asked for after a condition, in the order of the data.
    pub fn scores(dataset: &Dataset) -> Vec<Self> {
        Self::scores_where(dataset, |score| score.condition.is_some())
    }

    /// Every score that was asked for at the end, about all conditions together.
    pub fn end_scores(dataset: &Dataset) -> Vec<Self> {
        Self::scores_where(dataset, |score| score.condition.is_none())
    }

    fn scores_where(dataset: &Dataset, wanted: impl Fn(&Score) -> bool) -> Vec<Self> {
        let mut scores: Vec<Quantity> = Vec::new();
        for score in dataset.scores.iter().filter(|score| wanted(score)) {
            let quantity = Self::of_score(&dataset.design, &score.instrument, &score.scale);
            if !scores.iter().any(|known| known.key == quantity.key) {
                scores.push(quantity);
            }
        }
        scores
    }

    /// A participant's score at the end; `None` for a measure of flights.
    pub fn value_at_the_end(&self, dataset: &Dataset, participant: usize) -> Option<f64> {
        match &self.source {
            Source::Flights => None,
            Source::Score { instrument, scale } => dataset.score(participant, None, instrument, scale),
        }
    }

    /// The conditions that can be compared: those in which a participant that is analysed has a value that is not so by
    /// construction.
    pub fn conditions(&self, dataset: &Dataset) -> Vec<usize> {
        let people = dataset.analysed();
        let has = |&c: &usize| people.iter().any(|&person| self.value(dataset, person, c).is_some());
        let given = |&c: &usize| self.is_given(&dataset.design.conditions[c]);
        (0..dataset.design.conditions.len()).filter(|c| has(c) && !given(c)).collect()
    }

    /// Whether the rule or the inference of a condition fixes the value, whatever the pilot does: nobody intervenes under
    /// human alone, and a goal that is told is always right. To compare with such a condition would test an axiom.
    pub fn is_given(&self, condition: &Condition) -> bool {
        let key = self.key.as_str();
        let of_help = INTERVENTIONS.contains(&key) && condition.rule == Rule::Hic;
        let of_knowing = BELIEFS.contains(&key) && condition.inference == Inference::Known;
        self.source == Source::Flights && (of_help || of_knowing)
    }

    /// A participant's value in a condition.
    pub fn value(&self, dataset: &Dataset, participant: usize, condition: usize) -> Option<f64> {
        match &self.source {
            Source::Flights => dataset.value(&self.key, participant, condition),
            Source::Score { instrument, scale } => {
                dataset.score(participant, Some(condition), instrument, scale)
            }
        }
    }

    /// The definition, as tables and sentences use it.
    pub fn measure(&self) -> Measure<'_> {
        Measure {
            key: &self.key,
            name: &self.name,
            meaning: &self.meaning,
            unit: self.unit,
            range: self.range,
            missing_when: "",
            decimals: self.decimals,
        }
    }

    /// The axis of a figure.
    pub fn axis(&self) -> Axis {
        let title = match self.unit {
            Unit::Count(of) if of != "ticks" && !self.name.contains(of) => {
                format!("{} ({of})", self.measure().title())
            }
            _ => self.measure().title(),
        };
        match (self.unit, &self.source) {
            (Unit::Share, _) => Axis::share(title),
            (_, Source::Score { .. }) if self.limits.is_none_or(|(least, _)| least != 0.0) => {
                Axis::free(title)
            }
            _ => Axis::amount(title),
        }
    }
}
