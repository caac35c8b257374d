//! The report of a comparison: tables, the figure, and what loses where, computed.

use super::curve::{Against, Curve, Margin};
use super::stand::{REPLACED, SUCCESS, Stand};
use super::{CompareError, Compared, Comparison, Entered, MEASURES, SETTINGS, WEIGHT_OF_REPLACED};
use cohelm::human::Population;
use cohelm_study::csv::{Cell, Csv};
use cohelm_study::export::{Column, Kind, Sheet};
use cohelm_study::figures::{
    Axis, Behind, Better, Colour, Conditions, Figure, Heading, ParetoPoint, ParetoScatter,
};
use cohelm_study::measures::{Measure, measure};
use cohelm_study::report::{Align, Block, Document, Table};
use cohelm_study::statistics::Undefined;
use cohelm_study::statistics::bootstrap::Bootstrapped;
use cohelm_study::text::Text;

/// What the report says of its own making.
#[derive(Clone, Debug)]
pub struct Making {
    /// The command that makes it again.
    pub command: String,
    /// Version of the program.
    pub program: String,
}

/// Rules whose losses are said, by word.
const JUDGED: [&str; 3] = ["misc", "misc-r", "misc-h"];

/// The whole report.
pub fn document(
    all: &[Compared],
    comparison: &Comparison<'_>,
    making: &Making,
) -> Result<Document, CompareError> {
    let mut document = Document::new("Every rule on the same bench");
    document.lead = Text::from(
        "Rules of arbitration on the same values, inference, simulated people and seeds, each tuned on the same episodes; \
         success against how much of what was asked was replaced, with the line of constant tolerances behind.",
    );
    document.facts = facts(comparison, making);
    document.push(Block::warning(
        "The pilots are simulated",
        "No person flew here. They show what follows from delays, divided attention, wrong keys, resistance and trust, not \
         what people do.",
    ));
    document.push(Block::paragraph(how(comparison)));
    for compared in all {
        on_bench(compared, &mut document)?;
    }
    document.push(Block::heading("What is measured"));
    document.push(Block::measures(MEASURES.map(defined)));
    document.push(Block::heading("Again"));
    document.push(Block::Code(making.command.clone()));
    Ok(document)
}

fn facts(comparison: &Comparison<'_>, making: &Making) -> Vec<(String, String)> {
    let (draws, budget) = (&comparison.draws, comparison.budget);
    let kinds = |kinds: &[Population]| kinds.iter().map(|kind| kind.word()).collect::<Vec<_>>().join(", ");
    [
        ("Program", making.program.clone()),
        ("Tuned on", format!("{} (seed {})", kinds(&draws.tuning.populations), draws.tuning.seed)),
        ("Held out", format!("{} (seed {})", kinds(&draws.held_out.populations), draws.held_out.seed)),
        (
            "Flown",
            format!(
                "{} people of each kind, {} each under every rule",
                budget.participants,
                episodes(budget.episodes)
            ),
        ),
    ]
    .map(|(name, value)| (name.to_string(), value))
    .to_vec()
}

fn how(comparison: &Comparison<'_>) -> String {
    format!(
        "Every rule may try at most {SETTINGS} settings, {} a person each; it enters with the one that has the highest \
         success − {WEIGHT_OF_REPLACED} · replaced. Rules that ask for no more than the goal share the head of the inference with \
         which the robot alone does best; for rules that ask how sure the co-pilot is, the head is a setting. The table is flown \
         by other kinds of people on other seeds, the same for every rule down to the chance in the pilot’s hands. Intervals are \
         95 % bootstrap intervals that draw people anew within each kind.",
        episodes(comparison.budget.tuning_episodes)
    )
}

fn episodes(count: usize) -> String {
    if count == 1 { "1 episode".into() } else { format!("{count} episodes") }
}

fn on_bench(compared: &Compared, document: &mut Document) -> Result<(), CompareError> {
    let name = &compared.bench.name;
    document.push(Block::heading(name.clone()));
    document.push(Block::Table(main_table(compared)?));
    document.push(Block::Table(every_kind(compared)));
    document.push(Block::figure(
        figure(compared)?,
        "Success of the people held out against how much of what they asked was replaced. The grey line joins constant tolerances; the dashed steps \
         join what no rule beats on both.",
        format!("figures/{name}"),
    ));
    document.push(Block::subheading(format!("Where minimal intervention loses on {name}")));
    document.push(Block::List(compared.verdicts()?.into_iter().map(Text::from).collect()));
    document.push(Block::Table(by_kind(compared)?));
    Ok(())
}

fn main_table(compared: &Compared) -> Result<Table, Undefined> {
    let heads = MEASURES.map(|key| (Text::from(defined(key).title()), Align::Right));
    let row = |entered: &Entered| -> Result<Vec<Text>, Undefined> {
        let cells = entered.held_out.estimates()?.into_iter().zip(MEASURES);
        let cells = cells.map(|(estimate, key)| Text::from(with_interval(&estimate, defined(key))));
        let margin = compared.curve.margin(&entered.held_out)?;
        Ok([setting_text(&entered.held_out)].into_iter().chain(cells).chain([margin_text(&margin)]).collect())
    };
    Ok(Table {
        caption: Text::from(format!("{}: people held out from tuning.", compared.bench.name)),
        columns: [(Text::from("Rule, as tuned"), Align::Left)]
            .into_iter()
            .chain(heads)
            .chain([(Text::from("Success above the tolerances’ line"), Align::Right)])
            .collect(),
        rows: compared.entered.iter().map(row).collect::<Result<_, _>>()?,
        notes: vec![Text::from(
            "What was replaced, interventions and opposed commands are means over the ticks with a command; who is left alone has none.",
        )],
    })
}

/// Every rule, kind by kind.
fn every_kind(compared: &Compared) -> Table {
    let kinds = kinds(&compared.curve.stands);
    let row = |entered: &Entered| {
        let cell = |&kind: &Population| {
            let stand = entered.held_out.among(&[kind]);
            Text::from(format!("{:.2} at {:.2}", stand.mean("success"), stand.mean("replaced")))
        };
        [Text::from(entered.word())].into_iter().chain(kinds.iter().map(cell)).collect()
    };
    let heads = kinds.iter().map(|kind| (Text::from(kind.word()), Align::Right));
    Table {
        caption: Text::from(format!("{}: success at how much was replaced, by kind.", compared.bench.name)),
        columns: [(Text::from("Rule"), Align::Left)].into_iter().chain(heads).collect(),
        rows: compared.entered.iter().map(row).collect(),
        notes: vec![Text::from("With intervals, and every other measure: rules-by-kind.csv.")],
    }
}

/// The rules that are judged against the line, kind by kind: those held out, then those that tuning saw.
fn by_kind(compared: &Compared) -> Result<Table, Undefined> {
    let judged = || compared.entered.iter().filter(|entered| JUDGED.contains(&entered.word()));
    let mut rows = Vec::new();
    for (seen, curve) in [(false, &compared.curve), (true, &compared.curve_of_seen)] {
        let flown = |entered: &'_ Entered| if seen { entered.seen.clone() } else { entered.held_out.clone() };
        for kind in kinds(&curve.stands) {
            let curve = curve.among(&[kind]);
            let margin = |entered: &Entered| {
                let stand = flown(entered).among(&[kind]);
                let margin = curve.margin(&stand)?;
                let (success, replaced) = (stand.mean("success"), stand.mean("replaced"));
                Ok(Text::from(format!("{success:.2} at {replaced:.2}: {}", signed(&margin))))
            };
            let cells = judged().map(margin).collect::<Result<Vec<_>, Undefined>>()?;
            let name = format!("{kind}{}", if seen { " (kind seen in tuning)" } else { "" });
            rows.push([Text::from(name)].into_iter().chain(cells).collect());
        }
    }
    let heads = judged().map(|entered| (Text::from(entered.word()), Align::Right));
    Ok(Table {
        caption: Text::from(format!(
            "{}: success at how much was replaced, and above (+) or below (−) the line of the same people.",
            compared.bench.name
        )),
        columns: [(Text::from("People"), Align::Left)].into_iter().chain(heads).collect(),
        rows,
        notes: vec![],
    })
}

fn kinds(stands: &[Stand]) -> Vec<Population> {
    let mut kinds: Vec<Population> =
        stands.iter().take(1).flat_map(|stand| stand.units.iter().map(|unit| unit.population)).collect();
    kinds.dedup();
    kinds
}

impl Compared {
    /// What the numbers say of each judged rule: against the line, and which rules beat it.
    ///
    /// # Errors
    /// Fewer than two people.
    pub fn verdicts(&self) -> Result<Vec<String>, Undefined> {
        let judged = self.entered.iter().filter(|entered| JUDGED.contains(&entered.word()));
        judged.map(|entered| verdict(entered, self)).collect()
    }

    /// How a rule stands against the line of constant tolerances, among the people held out.
    ///
    /// # Errors
    /// Fewer than two people.
    pub fn margin(&self, entered: &Entered) -> Result<Margin, Undefined> {
        self.curve.margin(&entered.held_out)
    }
}

fn verdict(entered: &Entered, compared: &Compared) -> Result<String, Undefined> {
    let margin = compared.curve.margin(&entered.held_out)?;
    let rivals = compared.entered.iter().filter(|other| other.word() != entered.word());
    let mut beaten_by = Vec::new();
    for rival in rivals {
        if beats(&rival.held_out, &entered.held_out)? {
            let (success, replaced) = (rival.held_out.mean("success"), rival.held_out.mean("replaced"));
            beaten_by.push(format!("{} ({success:.2} at {replaced:.2})", rival.word()));
        }
    }
    let worst = worst_kind(entered, &compared.curve)?;
    let (success, replaced) = (entered.held_out.mean("success"), entered.held_out.mean("replaced"));
    Ok(format!(
        "{}: success {success:.2} at {replaced:.2} replaced, {} ({}). {} Among the kinds of people held out it does \
         worst with {}: {}.",
        entered.word(),
        margin.against().words(),
        signed(&margin),
        match beaten_by.is_empty() {
            true => "No rule beats it on one of the two without losing on the other.".to_string(),
            false => format!("It loses to {}.", beaten_by.join(", ")),
        },
        worst.0,
        signed(&worst.1),
    ))
}

/// True if a stand is at least as good on success and on how much it replaces, and on one of them so that the interval of the
/// difference leaves out nothing.
fn beats(stand: &Stand, other: &Stand) -> Result<bool, Undefined> {
    let more = stand.mean("success") - other.mean("success");
    let fewer = other.mean("replaced") - stand.mean("replaced");
    if more < 0.0 || fewer < 0.0 {
        return Ok(false);
    }
    let surely_more = stand.more_than(other, SUCCESS)?.low > 0.0;
    let surely_fewer = other.more_than(stand, REPLACED)?.low > 0.0;
    Ok(surely_more || surely_fewer)
}

fn worst_kind(entered: &Entered, curve: &Curve) -> Result<(Population, Margin), Undefined> {
    let margin = |kind| Ok((kind, curve.among(&[kind]).margin(&entered.held_out.among(&[kind]))?));
    let margins = kinds(&curve.stands).into_iter().map(margin).collect::<Result<Vec<_>, Undefined>>()?;
    let worst = margins.into_iter().min_by(|a, b| a.1.success.total_cmp(&b.1.success));
    Ok(worst.expect("a draw has populations"))
}

fn figure(compared: &Compared) -> Result<Figure, CompareError> {
    const COLOURS: [Colour; 6] =
        [Colour::SKY, Colour::ORANGE, Colour::PURPLE, Colour::INK, Colour::VERMILLION, Colour::BLUE];
    let words = compared.entered.iter().map(Entered::word);
    let mut points = Vec::new();
    for (condition, entered) in compared.entered.iter().enumerate() {
        let estimates = entered.held_out.estimates()?;
        let (x, y) = (&estimates[REPLACED], &estimates[SUCCESS]);
        points.push(ParetoPoint {
            label: entered.word().into(),
            condition,
            at: (x.estimate, y.estimate),
            intervals: (Some(x.interval), Some(y.interval)),
        });
    }
    let scatter = ParetoScatter {
        heading: Heading::new("What help costs", compared.bench.name.clone()),
        x: (Axis::share("How much of what was asked was replaced").from_zero(), Better::Lower),
        y: (Axis::share("Success rate"), Better::Higher),
        conditions: Conditions::with_colours(words.zip(COLOURS.into_iter().cycle())),
        points,
        behind: Some(Behind {
            name: "constant tolerances, α from 0 to 1".into(),
            line: compared.curve.line(),
        }),
    };
    Ok(scatter.figure()?)
}

impl Entered {
    /// The rule's word.
    pub fn word(&self) -> &'static str {
        self.held_out.setting.rule.word()
    }
}

fn setting_text(stand: &Stand) -> Text {
    let parameters = stand.setting.rule.parameters().into_iter();
    let parameters = parameters.map(|(name, value)| format!(" {name} {value}")).collect::<String>();
    Text::new().strong(stand.setting.rule.word()).plain(format!("{parameters}, {}", confidence(stand)))
}

fn confidence(stand: &Stand) -> &'static str {
    stand.setting.inference.word()
}

fn with_interval(estimate: &Bootstrapped, measure: &Measure<'_>) -> String {
    let [at, low, high] =
        [estimate.estimate, estimate.interval.low, estimate.interval.high].map(|value| measure.write(value));
    format!("{at} [{low}, {high}]")
}

fn margin_text(margin: &Margin) -> Text {
    let text = signed(margin);
    if margin.against() == Against::On { Text::from(text) } else { Text::new().strong(text) }
}

fn signed(margin: &Margin) -> String {
    format!("{:+.3} [{:+.3}, {:+.3}]", margin.success, margin.interval.low, margin.interval.high)
}

fn defined(key: &str) -> &'static Measure<'static> {
    measure(key).expect("the table names defined measures")
}

/// Every table and the whole as JSON, with the names of their files.
pub fn files(all: &[Compared]) -> Result<Vec<(String, Vec<u8>)>, CompareError> {
    let mut files = Vec::new();
    let (rules, by_kind) = rules(all)?;
    let tables =
        [("rules", rules), ("rules-by-kind", by_kind), ("tuning", tuning(all)), ("people", people(all))];
    for (name, csv) in tables {
        files.push((format!("{name}.csv"), csv.to_string().into_bytes()));
        files.push((format!("{name}.parquet"), parquet(name, &csv)?));
    }
    Ok(files)
}

/// A row a bench, rule and measure: over all kinds of people, and kind by kind.
fn rules(all: &[Compared]) -> Result<(Csv, Csv), CompareError> {
    let identity = ["bench", "people", "population", "rule", "parameters", "confidence", "measure"];
    let table = || Csv::new(identity.into_iter().chain(["mean", "low", "high"]));
    let (mut together, mut by_kind) = (table(), table());
    for compared in all {
        let entered = |seen: bool| {
            let stands = compared.entered.iter();
            stands.map(move |entered| if seen { &entered.seen } else { &entered.held_out })
        };
        for (people, seen, curve) in
            [("held-out", false, &compared.curve), ("seen", true, &compared.curve_of_seen)]
        {
            for stand in entered(seen).chain(&curve.stands) {
                let words = |population| [&compared.bench.name, people, population].map(Cell::from);
                rows_of(&mut together, words("all"), stand, curve)?;
                for kind in kinds(&curve.stands) {
                    let (stand, curve) = (stand.among(&[kind]), curve.among(&[kind]));
                    rows_of(&mut by_kind, words(kind.word()), &stand, &curve)?;
                }
            }
        }
    }
    Ok((together, by_kind))
}

/// A row a measure of a stand, and one for how far above the line it stands.
fn rows_of(csv: &mut Csv, words: [Cell; 3], stand: &Stand, curve: &Curve) -> Result<(), Undefined> {
    let margin = curve.margin(stand)?;
    let margin = ("above_the_line", margin.success, margin.interval);
    let estimates = MEASURES.into_iter().zip(stand.estimates()?);
    let estimates = estimates.map(|(measure, of)| (measure, of.estimate, of.interval));
    for (measure, mean, interval) in estimates.chain([margin]) {
        let setting =
            [stand.setting.rule.word(), &parameters(stand), confidence(stand), measure].map(Cell::from);
        let numbers = [mean, interval.low, interval.high].map(Cell::from);
        csv.push(words.clone().into_iter().chain(setting).chain(numbers));
    }
    Ok(())
}

/// A row a setting that tuning tried.
fn tuning(all: &[Compared]) -> Csv {
    let mut csv =
        Csv::new(["bench", "rule", "parameters", "confidence", "success", "replaced", "score", "entered"]);
    for compared in all {
        for entered in &compared.entered {
            for tried in &entered.tried {
                let stand = Stand { setting: tried.setting, units: Vec::new() };
                let words = [
                    compared.bench.name.clone(),
                    tried.setting.rule.word().into(),
                    parameters(&stand),
                    confidence(&stand).into(),
                ];
                let numbers = [tried.success, tried.replaced, tried.score].map(Cell::from);
                let chosen = Cell::from(tried.setting == entered.held_out.setting);
                csv.push(words.map(Cell::from).into_iter().chain(numbers).chain([chosen]));
            }
        }
    }
    csv
}

/// A row a person and rule.
fn people(all: &[Compared]) -> Csv {
    let identity = ["bench", "people", "population", "participant", "rule", "parameters"];
    let mut csv = Csv::new(identity.into_iter().chain(MEASURES));
    for compared in all {
        let entered = |seen: bool| {
            let stands = compared.entered.iter();
            stands.map(move |entered| if seen { &entered.seen } else { &entered.held_out })
        };
        let held_out = entered(false).chain(&compared.curve.stands).map(|stand| ("held-out", stand));
        let seen = entered(true).chain(&compared.curve_of_seen.stands).map(|stand| ("seen", stand));
        for (people, stand) in held_out.chain(seen) {
            for unit in &stand.units {
                let identity = [
                    Cell::from(compared.bench.name.as_str()),
                    Cell::from(people),
                    Cell::from(unit.population.word()),
                    Cell::from(unit.participant + 1),
                    Cell::from(stand.setting.rule.word()),
                    Cell::from(parameters(stand)),
                ];
                csv.push(identity.into_iter().chain(unit.means.map(Cell::from)));
            }
        }
    }
    csv
}

fn parameters(stand: &Stand) -> String {
    let parameters = stand.setting.rule.parameters().into_iter();
    parameters.map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(" ")
}

/// A table as Parquet: text, or numbers.
fn parquet(name: &'static str, table: &Csv) -> Result<Vec<u8>, CompareError> {
    let column = |(index, key): (usize, &String)| {
        let cell = table.rows().first().map(|row| &row[index]);
        let kind = match cell {
            Some(Cell::Text(_)) => Kind::Text,
            Some(Cell::Integer(_)) => Kind::Integer,
            _ => Kind::Number,
        };
        let [meaning, unit, range, missing_when] = [const { String::new() }; 4];
        Column { key: key.clone(), meaning, unit, kind, range, missing_when }
    };
    let columns = table.columns().iter().enumerate().map(column).collect();
    Ok(Sheet { name, columns, rows: table.rows().to_vec() }.parquet()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::stand::Unit;
    use crate::compare::{Setting, contenders};
    use cohelm::intent::Head;

    /// Four people of each of two kinds, with success and what was replaced.
    fn stand(numbers: [(f64, f64); 4]) -> Stand {
        let setting: Setting = contenders(Head::Softmax)[0][0];
        let unit = |population, (participant, &(success, replaced)): (usize, &(f64, f64))| {
            let mut means = [0.0; MEASURES.len()];
            (means[SUCCESS], means[REPLACED]) = (success, replaced);
            Unit { population, participant, means }
        };
        let of = |population| numbers.iter().enumerate().map(move |each| unit(population, each));
        Stand { setting, units: of(Population::Skilled).chain(of(Population::Slow)).collect() }
    }

    #[test]
    fn who_is_as_good_on_both_and_surely_better_on_one_beats() {
        let base = stand([(0.4, 0.5), (0.5, 0.6), (0.6, 0.4), (0.5, 0.5)]);
        let better = stand([(0.5, 0.5), (0.6, 0.6), (0.7, 0.4), (0.6, 0.5)]);
        let spared = stand([(0.4, 0.4), (0.5, 0.5), (0.6, 0.3), (0.5, 0.4)]);
        let dearer = stand([(0.5, 0.6), (0.6, 0.7), (0.7, 0.5), (0.6, 0.6)]);
        let lucky = stand([(0.9, 0.5), (0.0, 0.6), (0.7, 0.4), (0.6, 0.5)]);
        let beats = |one, other| beats(one, other).unwrap();
        assert!(beats(&better, &base) && beats(&spared, &base));
        assert!(!beats(&base, &better) && !beats(&base, &spared) && !beats(&base, &base));
        assert!(!beats(&dearer, &base) && !beats(&base, &dearer), "more success for more");
        assert!(!beats(&lucky, &base), "better by chance only");
    }
}
