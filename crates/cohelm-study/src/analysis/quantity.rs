//! What is compared between conditions: a measure of flights, or a score of a questionnaire.

use crate::dataset::Dataset;
use crate::figures::Axis;
use crate::measures::{self, Measure, Range, Unit};

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
        })
    }

    /// The score of a questionnaire.
    pub fn of_score(instrument: &str, scale: &str) -> Self {
        let name = if scale.is_empty() || scale == "overall" {
            instrument.to_owned()
        } else {
            format!("{instrument}: {scale}")
        };
        Quantity {
            key: format!("{instrument}/{scale}"),
            meaning: format!("Score {scale:?} of the questionnaire {instrument:?}."),
            name,
            unit: Unit::Number,
            range: Range::Any,
            decimals: 1,
            source: Source::Score { instrument: instrument.to_owned(), scale: scale.to_owned() },
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
        let mut scores: Vec<Quantity> = Vec::new();
        for score in dataset.scores.iter().filter(|score| score.condition.is_some()) {
            let quantity = Self::of_score(&score.instrument, &score.scale);
            if !scores.iter().any(|known| known.key == quantity.key) {
                scores.push(quantity);
            }
        }
        scores
    }

    /// The conditions in which a participant that is analysed has a value.
    pub fn conditions(&self, dataset: &Dataset) -> Vec<usize> {
        let people = dataset.analysed();
        let has = |condition: &usize| {
            people.iter().any(|&person| self.value(dataset, person, *condition).is_some())
        };
        (0..dataset.design.conditions.len()).filter(has).collect()
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
            (_, Source::Score { .. }) => Axis::free(title),
            _ => Axis::amount(title),
        }
    }
}
