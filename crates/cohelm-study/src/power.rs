//! How many people it takes to see an effect.
//!
//! A study is drawn many times with n participants each, the declared test is carried out, and the share of the draws in
//! which it finds the effect is the power. The effect is one that a researcher states, or the values of simulated
//! participants, drawn anew with replacement. Deterministic: the same question and seed give the same answer on every
//! machine.

use crate::analysis::Quantity;
use crate::dataset::Dataset;
use crate::figures::{Axis, Conditions, Curve, CurvePanel, Curves, Extent, Figure, FigureError, Heading};
use crate::report::{Align, Block, Document, Table};
use crate::statistics::{Paired, Undefined, mean, paired_t, standard_deviation, wilcoxon};
use crate::text::Text;
use crate::{apa, measures::Measure};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;

/// What is assumed of the people.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Assumption {
    /// A researcher's statement. Values are drawn from normal distributions.
    Stated {
        /// Mean difference between the two conditions, in the measure's unit.
        effect: f64,
        /// Standard deviation between participants within a condition, in the same unit.
        sd: f64,
        /// Correlation between a participant's two values, −1 to 1: 0.5 is usual for people measured twice; the higher, the
        /// fewer people it takes.
        correlation: f64,
    },
    /// The two values of each simulated participant; participants are drawn from these with replacement.
    Simulated {
        /// Under the first condition.
        first: Vec<f64>,
        /// Under the second.
        second: Vec<f64>,
    },
}

impl Assumption {
    /// What the participants of a data set show of a quantity in two conditions: for a dry run, simulated ones. Those with a
    /// gap are left out.
    pub fn of(dataset: &Dataset, quantity: &Quantity, first: usize, second: usize) -> Self {
        let value = |person: usize, condition: usize| quantity.value(dataset, person, condition);
        let pair = |person: usize| Some((value(person, first)?, value(person, second)?));
        let (first, second) = dataset.analysed().into_iter().filter_map(pair).unzip();
        Assumption::Simulated { first, second }
    }
}

/// Which test will be carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Test {
    /// Paired t test, two-sided.
    PairedT,
    /// Wilcoxon's signed-rank test, two-sided.
    Wilcoxon,
}

impl Test {
    /// Its name within a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Test::PairedT => "paired t test",
            Test::Wilcoxon => "Wilcoxon signed-rank test",
        }
    }
}

/// A question about power.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Question {
    /// What is assumed.
    pub assumption: Assumption,
    /// Which test will be carried out.
    pub test: Test,
    /// Level of significance of the test, usually 0.05.
    pub alpha: f64,
    /// The largest number of participants that is asked about, 4 to 500.
    pub most: usize,
    /// Studies drawn for each number of participants: 2000 fix a power of 80 % to ± 2 points.
    pub draws: usize,
    /// Seed of the generator (PCG64).
    pub seed: u64,
}

/// Fewest participants that are asked about: with fewer no test is worth its name.
pub const FEWEST: usize = 4;

/// Power at one number of participants.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// Participants.
    pub participants: usize,
    /// Share of the drawn studies in which the test found a difference in the assumed direction.
    pub power: f64,
    /// Lower end of its 95 % interval (Wilson), which shrinks with the number of draws.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Power over the number of participants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PowerCurve {
    /// What was asked.
    pub question: Question,
    /// The assumed effect in standard deviations of the difference, d_z; `None` if the differences do not vary.
    pub d_z: Option<f64>,
    /// From few participants to many.
    pub points: Vec<Point>,
}

/// Why a question has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PowerError {
    /// A number lies outside its range.
    #[error("{what} must be {expected}, and is {found}")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// What it must be.
        expected: &'static str,
        /// What it is.
        found: f64,
    },
    /// The simulated values are no pairs, or too few.
    #[error(transparent)]
    Values(#[from] Undefined),
}

impl Question {
    /// The question with the usual settings: paired t test at .05, up to 60 participants, 2000 draws.
    pub fn new(assumption: Assumption) -> Self {
        Question { assumption, test: Test::PairedT, alpha: 0.05, most: 60, draws: 2000, seed: 1 }
    }

    /// The answer.
    ///
    /// # Errors
    /// A number out of its range; simulated values that are no pairs, are fewer than four or do not differ.
    pub fn answer(&self) -> Result<PowerCurve, PowerError> {
        self.check()?;
        let population = Population::of(&self.assumption)?;
        let points = (FEWEST..=self.most).map(|n| self.at(n, &population)).collect();
        Ok(PowerCurve { question: self.clone(), d_z: population.d_z(), points })
    }

    fn check(&self) -> Result<(), PowerError> {
        within("the level", "between 0 and 1", self.alpha, |alpha| alpha > 0.0 && alpha < 1.0)?;
        let most = self.most as f64;
        within("the largest number of participants", "4 to 500", most, |most| (4.0..=500.0).contains(&most))?;
        let draws = self.draws as f64;
        within("the number of draws", "100 to 1000000", draws, |draws| (100.0..=1e6).contains(&draws))?;
        let Assumption::Stated { effect, sd, correlation } = self.assumption else { return Ok(()) };
        within("the effect", "a finite number other than 0", effect, |effect| {
            effect.is_finite() && effect != 0.0
        })?;
        within("the standard deviation", "positive and finite", sd, |sd| sd.is_finite() && sd > 0.0)?;
        within("the correlation", "from −1 to less than 1", correlation, |r| (-1.0..1.0).contains(&r))
    }

    /// Each number of participants has draws of its own, so that a longer curve begins with the shorter one.
    fn at(&self, participants: usize, population: &Population) -> Point {
        let mut generator = Pcg64::seed_from_u64(mixed(self.seed, participants as u64));
        let found = (0..self.draws).filter(|_| {
            let differences: Vec<f64> = (0..participants).map(|_| population.draw(&mut generator)).collect();
            self.finds(differences, population.direction())
        });
        let found = found.count();
        let (low, high) = wilson(found, self.draws);
        Point { participants, power: found as f64 / self.draws as f64, low, high }
    }

    /// A difference in the wrong direction is no finding.
    fn finds(&self, differences: Vec<f64>, direction: f64) -> bool {
        let zeros = vec![0.0; differences.len()];
        let Ok(pairs) = Paired::new(&differences, &zeros) else { return false };
        match self.test {
            Test::PairedT => {
                paired_t(&pairs).is_ok_and(|t| t.p < self.alpha && t.mean_difference * direction > 0.0)
            }
            Test::Wilcoxon => wilcoxon(&pairs.snapped())
                .is_ok_and(|w| w.p < self.alpha && w.rank_biserial * direction > 0.0),
        }
    }
}

fn within(
    what: &'static str,
    expected: &'static str,
    found: f64,
    fits: impl Fn(f64) -> bool,
) -> Result<(), PowerError> {
    if fits(found) { Ok(()) } else { Err(PowerError::OutOfRange { what, expected, found }) }
}

/// Splits one seed into many (SplitMix64's finaliser).
fn mixed(seed: u64, index: u64) -> u64 {
    let mut z = seed.wrapping_add((index + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Where differences are drawn from.
enum Population {
    Normal { mean: f64, sd: f64 },
    Given(Vec<f64>),
}

impl Population {
    fn of(assumption: &Assumption) -> Result<Self, PowerError> {
        Ok(match assumption {
            // The difference of two normal values with one standard deviation and that correlation.
            Assumption::Stated { effect, sd, correlation } => {
                Population::Normal { mean: *effect, sd: sd * (2.0 * (1.0 - correlation)).sqrt() }
            }
            Assumption::Simulated { first, second } => {
                let pairs = Paired::new(first, second)?;
                paired_t(&pairs)?;
                if pairs.len() < FEWEST {
                    return Err(PowerError::Values(Undefined::TooFew {
                        what: "power from simulated participants",
                        of: "participants",
                        needed: FEWEST,
                        found: pairs.len(),
                    }));
                }
                Population::Given(pairs.differences())
            }
        })
    }

    fn d_z(&self) -> Option<f64> {
        match self {
            Population::Normal { mean, sd } => Some(mean / sd),
            Population::Given(differences) => {
                let sd = standard_deviation(differences).ok().filter(|sd| *sd > 0.0)?;
                Some(mean(differences).ok()? / sd)
            }
        }
    }

    fn direction(&self) -> f64 {
        match self {
            Population::Normal { mean, .. } => mean.signum(),
            Population::Given(differences) => mean(differences).unwrap_or(0.0).signum(),
        }
    }

    fn draw(&self, generator: &mut Pcg64) -> f64 {
        match self {
            Population::Normal { mean, sd } => mean + sd * normal(generator),
            Population::Given(differences) => {
                let index = (unit(generator) * differences.len() as f64) as usize;
                differences[index.min(differences.len() - 1)]
            }
        }
    }
}

/// A number in [0, 1) of 53 random bits.
fn unit(generator: &mut Pcg64) -> f64 {
    (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// A standard normal number (Box and Muller).
fn normal(generator: &mut Pcg64) -> f64 {
    let radius = (-2.0 * libm::log(1.0 - unit(generator))).sqrt();
    radius * libm::cos(2.0 * std::f64::consts::PI * unit(generator))
}

/// Wilson's 95 % interval of a share.
fn wilson(found: usize, of: usize) -> (f64, f64) {
    const Z: f64 = 1.959_963_984_540_054;
    let (n, share) = (of as f64, found as f64 / of as f64);
    let centre = share + Z * Z / (2.0 * n);
    let half = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    let whole = 1.0 + Z * Z / n;
    (((centre - half) / whole).max(0.0), ((centre + half) / whole).min(1.0))
}

impl PowerCurve {
    /// The smallest number of participants from which on the power is never below `target` again; `None` if the curve
    /// does not get that far.
    pub fn smallest(&self, target: f64) -> Option<usize> {
        let enough = self.points.iter().rev().take_while(|point| point.power >= target);
        enough.last().map(|point| point.participants)
    }

    fn smallest_in_words(&self, target: f64) -> String {
        self.smallest(target).map_or_else(|| format!("more than {}", self.question.most), |n| n.to_string())
    }
}

/// A measure with its curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Answered<'a> {
    /// The measure.
    pub measure: Measure<'a>,
    /// The two conditions, first − second.
    pub conditions: (String, String),
    /// The curve.
    pub curve: PowerCurve,
}

/// The curves as one figure, a panel a measure.
///
/// # Errors
/// No curve.
pub fn figure(answers: &[Answered<'_>]) -> Result<Figure, FigureError> {
    // Of more points than get marks, since a target is no measurement.
    const POINTS: usize = 16;
    let line = |target: f64, answer: &Answered<'_>| {
        let at = |i: usize| (answer.curve.question.most as f64 * i as f64 / POINTS as f64, target);
        Curve { condition: 1, points: (0..=POINTS).map(at).collect(), band: Vec::new() }
    };
    let panel = |answer: &Answered<'_>| {
        let points = &answer.curve.points;
        let curve = Curve {
            condition: 0,
            points: points.iter().map(|p| (p.participants as f64, p.power)).collect(),
            band: points.iter().map(|p| (p.low, p.high)).collect(),
        };
        CurvePanel {
            title: answer.measure.title(),
            curves: vec![curve, line(0.8, answer), line(0.9, answer)],
        }
    };
    let curves = Curves {
        heading: Heading::new(
            "How many people it takes",
            "Share of drawn studies in which the test finds the assumed effect. Band: 95 % interval of the drawing.",
        ),
        x: Axis { extent: Extent::FromZero, ..Axis::amount("Participants") },
        y: Axis::share("Power"),
        conditions: Conditions::with_colours([
            ("power", crate::figures::Colour::BLUE),
            ("80 % and 90 %", crate::figures::Colour::GREY),
        ]),
        panels: answers.iter().map(panel).collect(),
    };
    curves.figure()
}

/// A report of the answers: what was assumed, how many people it takes, the curves.
///
/// # Errors
/// No answer.
pub fn document(title: &str, answers: &[Answered<'_>]) -> Result<Document, FigureError> {
    let mut document = Document::new(title);
    document.lead =
        Text::from("How many people it takes to see an effect, under what is assumed of them below.");
    if answers.iter().any(|a| matches!(a.curve.question.assumption, Assumption::Simulated { .. })) {
        document.push(Block::warning(
            "Simulated participants are not people",
            "Effect and spread below are those of simulated pilots. They differ among one another as their makers chose, \
             learn nothing, get neither tired nor annoyed, and may respond to a co-pilot as nobody does. Take the number for an \
             order of magnitude, and plan with an effect that you would not want to miss.",
        ));
    }
    document.push(Block::Table(needed(answers)));
    document.push(Block::figure(figure(answers)?, "Power over the number of participants.", "figures/power"));
    document.push(Block::heading("How it was computed"));
    for answer in answers {
        document.push(Block::paragraph(method(answer)));
    }
    Ok(document)
}

fn needed(answers: &[Answered<'_>]) -> Table {
    let heads = ["Measure", "Effect", "Spread (SD)", "Correlation", "d_z", "80\u{202f}%", "90\u{202f}%"];
    let align = |i: usize| if i == 0 { Align::Left } else { Align::Right };
    let head = |(i, head): (usize, &str)| {
        let text = if head == "d_z" { Text::new().em("d").lowered("z") } else { Text::from(head) };
        (text, align(i))
    };
    let row = |answer: &Answered<'_>| {
        let (effect, spread, correlation) = assumed(&answer.curve.question.assumption);
        let dash = || "–".to_owned();
        [
            answer.measure.title(),
            effect.map_or_else(dash, |effect| answer.measure.write_difference(effect)),
            spread.map_or_else(dash, |spread| answer.measure.write_difference(spread)),
            correlation.map_or_else(dash, |r| apa::fraction(r, 2)),
            answer.curve.d_z.map_or_else(dash, |d| apa::number(d, 2)),
            answer.curve.smallest_in_words(0.8),
            answer.curve.smallest_in_words(0.9),
        ]
        .map(Text::from)
        .to_vec()
    };
    Table {
        caption: Text::from("Participants needed for a power of 80\u{202f}% and 90\u{202f}%."),
        columns: heads.into_iter().enumerate().map(head).collect(),
        rows: answers.iter().map(row).collect(),
        notes: vec![Text::from(
            "Participants after exclusions: invite more by the share that you expect to lose, and round up to whole \
             counterbalancing cells.",
        )],
    }
}

/// Mean difference, spread between participants and correlation of an assumption.
fn assumed(assumption: &Assumption) -> (Option<f64>, Option<f64>, Option<f64>) {
    match assumption {
        Assumption::Stated { effect, sd, correlation } => (Some(*effect), Some(*sd), Some(*correlation)),
        Assumption::Simulated { first, second } => {
            let effect = mean(first).ok().zip(mean(second).ok()).map(|(a, b)| a - b);
            let spread = standard_deviation(first)
                .ok()
                .zip(standard_deviation(second).ok())
                .map(|(a, b)| ((a * a + b * b) / 2.0).sqrt());
            (effect, spread, correlation(first, second))
        }
    }
}

fn correlation(first: &[f64], second: &[f64]) -> Option<f64> {
    let (a, b) = (mean(first).ok()?, mean(second).ok()?);
    let (sd_a, sd_b) = (standard_deviation(first).ok()?, standard_deviation(second).ok()?);
    let products: f64 = first.iter().zip(second).map(|(x, y)| (x - a) * (y - b)).sum();
    let spread = sd_a * sd_b * (first.len() as f64 - 1.0);
    (spread > 0.0).then(|| products / spread)
}

fn method(answer: &Answered<'_>) -> Text {
    let Question { test, alpha, draws, seed, .. } = &answer.curve.question;
    let (first, second) = &answer.conditions;
    let from = match &answer.curve.question.assumption {
        Assumption::Stated { .. } => {
            "normal distributions with the stated effect, spread and correlation".to_owned()
        }
        Assumption::Simulated { first, .. } => {
            format!("the values of {} simulated participants, with replacement", first.len())
        }
    };
    Text::new().strong(format!("{}, {first} − {second}.", answer.measure.title())).plain(format!(
        " For each number of participants {draws} studies were drawn from {from}, and a two-sided {} at α{}was carried out in \
         each; a difference in the other direction does not count as found. Seed {seed}.",
        test.name(),
        format_args!(" = {} ", apa::fraction(*alpha, 2).trim_end_matches('0')),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::measure;

    fn stated(effect: f64, sd: f64, correlation: f64) -> Question {
        let assumption = Assumption::Stated { effect, sd, correlation };
        Question { draws: 4000, most: 40, ..Question::new(assumption) }
    }

    fn power_at(curve: &PowerCurve, n: usize) -> f64 {
        curve.points.iter().find(|point| point.participants == n).unwrap().power
    }

    // SciPy: c = t.ppf(.975, n - 1); 1 - nct.cdf(c, n - 1, d * sqrt(n)) is .5645 for d = .5, n = 20; .8078 for d = .5,
    // n = 34 (.7954 for 33); .6162 for d = .8, n = 10.
    // The sd of differences is sd · sqrt(2 (1 − r)), so r = .5 makes d_z = effect / sd.
    #[test]
    fn paired_t_has_the_power_of_the_noncentral_t() {
        let medium = stated(0.5, 1.0, 0.5).answer().unwrap();
        assert!((medium.d_z.unwrap() - 0.5).abs() < 1e-12);
        assert!((power_at(&medium, 20) - 0.5645).abs() < 0.025, "{}", power_at(&medium, 20));
        assert!((power_at(&medium, 34) - 0.8078).abs() < 0.025, "{}", power_at(&medium, 34));
        assert!((medium.smallest(0.8).unwrap() as i64 - 34).abs() <= 2);
        assert_eq!(medium.smallest(0.99), None);
        let large = stated(-0.8, 1.0, 0.5).answer().unwrap();
        assert!((power_at(&large, 10) - 0.6162).abs() < 0.025, "{}", power_at(&large, 10));
    }

    #[test]
    fn without_an_effect_in_the_values_the_error_keeps_its_level() {
        let values: Vec<f64> = (0..20).map(f64::from).collect();
        let almost: Vec<f64> =
            values.iter().enumerate().map(|(i, v)| v + if i % 2 == 0 { 1.0 } else { -1.001 }).collect();
        let assumption = Assumption::Simulated { first: values, second: almost };
        let curve = Question { draws: 2000, most: 20, ..Question::new(assumption) }.answer().unwrap();
        // One direction of a two-sided test at .05.
        assert!(power_at(&curve, 20) < 0.05, "{}", power_at(&curve, 20));
    }

    #[test]
    fn the_same_question_has_the_same_answer_and_more_participants_change_no_fewer() {
        let short = stated(0.4, 1.0, 0.3).answer().unwrap();
        assert_eq!(short, stated(0.4, 1.0, 0.3).answer().unwrap());
        let long = Question { most: 45, ..stated(0.4, 1.0, 0.3) }.answer().unwrap();
        assert_eq!(short.points[..], long.points[..short.points.len()]);
    }

    #[test]
    fn wilcoxon_sees_what_the_t_test_sees_a_little_later() {
        let question = Question { draws: 1000, most: 24, ..stated(0.8, 1.0, 0.5) };
        let t = question.answer().unwrap();
        let w = Question { test: Test::Wilcoxon, ..question }.answer().unwrap();
        assert!((power_at(&t, 20) - power_at(&w, 20)).abs() < 0.06);
    }

    #[test]
    fn questions_without_an_answer_get_a_sentence() {
        let why = |question: Question| question.answer().unwrap_err().to_string();
        assert!(why(stated(0.0, 1.0, 0.5)).contains("the effect must be a finite number other than 0"));
        assert!(why(stated(1.0, -1.0, 0.5)).contains("standard deviation must be positive"));
        assert!(why(stated(1.0, 1.0, 1.0)).contains("the correlation must be"));
        let same = Assumption::Simulated { first: vec![1.0; 9], second: vec![1.0; 9] };
        assert!(why(Question::new(same)).contains("the same value in every participant"));
        let few = Assumption::Simulated { first: vec![1.0, 2.0], second: vec![1.0, 2.5] };
        assert!(why(Question::new(few)).contains("at least 4 participants"));
    }

    #[test]
    fn wilsons_interval_as_published() {
        // statsmodels 0.14: proportion_confint(8, 10, method="wilson") = (0.4901625, 0.9433178).
        let (low, high) = wilson(8, 10);
        assert!((low - 0.490_162_5).abs() < 1e-6 && (high - 0.943_317_8).abs() < 1e-6, "{low} {high}");
    }

    #[test]
    fn the_report_warns_that_bots_are_not_people() {
        let first: Vec<f64> = (0..10).map(|i| 0.7 + 0.01 * f64::from(i)).collect();
        let second: Vec<f64> = (0..10).map(|i| 0.6 + 0.02 * f64::from(i % 5)).collect();
        let curve =
            Question { draws: 200, most: 20, ..Question::new(Assumption::Simulated { first, second }) };
        let measure = *measure("success").unwrap();
        let conditions = ("misc".to_owned(), "lasc".to_owned());
        let answers = [Answered { measure, conditions, curve: curve.answer().unwrap() }];
        let markdown = document("Power", &answers).unwrap().markdown();
        assert!(markdown.contains("Simulated participants are not people"), "{markdown}");
        assert!(markdown.contains("Success rate") && markdown.contains("Seed 1"));
    }
}
