//! The tables of an export, ready for mixed models: long, a row an observation, identity first.

use super::{Column, Kind, Sheet};
use crate::analysis::Quantity;
use crate::csv::Cell;
use crate::dataset::{Answer, Dataset, LeftOut, Measured, Person, Progress, Trial};
use crate::measures::{self, Measure, OF_A_FLIGHT, OF_AN_EPISODE, PARTS, Range, Unit};
use serde_json::Value;

/// What the page tells of its own running, as columns of the flights: name, meaning, unit.
const TELEMETRY: [(&str, &str, &str); 13] = [
    ("late_ticks", "Ticks that were due for longer than a tick when they were flown.", "ticks"),
    ("frames", "Frames drawn.", "frames"),
    ("dropped_frames", "Frames that the display could have shown and the page did not draw.", "frames"),
    ("hidden_ms", "Time for which the tab was hidden during the flight.", "ms"),
    ("pauses", "Pauses by key, lost focus or hidden tab.", "times"),
    ("paused_ms", "Time of these pauses.", "ms"),
    ("away_ms", "Time from an interruption in the air until the flight went on.", "ms"),
    ("clock_offset_ms", "The server’s clock minus the page’s.", "ms"),
    ("clock_rtt_ms", "Way there and back of the exchange that told the offset.", "ms"),
    ("key_to_tick_ms_median", "From a key’s time stamp to the tick at which it acts: median.", "ms"),
    ("key_to_tick_ms_p95", "From a key’s time stamp to the tick at which it acts: 95th percentile.", "ms"),
    ("key_to_tick_ms_most", "From a key’s time stamp to the tick at which it acts: longest.", "ms"),
    ("refresh_hz", "Refresh rate of the display, as measured in the page.", "Hz"),
];

/// A column with a row's cell.
struct Field<Row> {
    column: Column,
    cell: Box<dyn Fn(&Row) -> Cell>,
}

fn field<Row>(column: Column, cell: impl Fn(&Row) -> Cell + 'static) -> Field<Row> {
    Field { column, cell: Box::new(cell) }
}

fn sheet<Row>(name: &'static str, fields: Vec<Field<Row>>, rows: impl Iterator<Item = Row>) -> Sheet {
    let rows = rows.map(|row| fields.iter().map(|field| (field.cell)(&row)).collect()).collect();
    Sheet { name, columns: fields.into_iter().map(|field| field.column).collect(), rows }
}

fn column(key: &str, kind: Kind, meaning: &str) -> Column {
    let range = match kind {
        Kind::Truth => "true | false",
        Kind::Integer => "whole numbers",
        Kind::Text | Kind::Number => "any",
    };
    Column {
        key: key.to_owned(),
        meaning: meaning.to_owned(),
        unit: String::new(),
        kind,
        range: range.to_owned(),
        missing_when: String::new(),
    }
}

impl Column {
    fn unit(self, unit: &str) -> Self {
        Column { unit: unit.to_owned(), ..self }
    }

    fn range(self, range: impl Into<String>) -> Self {
        Column { range: range.into(), ..self }
    }

    fn missing_when(self, when: &str) -> Self {
        Column { missing_when: when.to_owned(), ..self }
    }

    fn of(measure: &Measure<'_>, kind: Kind) -> Self {
        Column {
            key: measure.key.to_owned(),
            meaning: measure.meaning.to_owned(),
            unit: measure.unit.word().to_owned(),
            kind,
            range: measure.range.words(),
            missing_when: measure.missing_when.to_owned(),
        }
    }
}

/// A flight with whose it is.
struct Flight {
    who: Who,
    trial: Trial,
    condition: String,
}

/// What every table says of a participant.
#[derive(Clone)]
struct Who {
    code: String,
    simulated: bool,
    left_out: Option<LeftOut>,
}

impl Who {
    fn of(dataset: &Dataset, participant: usize) -> Self {
        let Person { code, simulated, .. } = &dataset.participants[participant];
        Who { code: code.clone(), simulated: *simulated, left_out: dataset.left_out(participant) }
    }
}

/// Columns that every table begins with.
fn identity<Row: 'static>(who: fn(&Row) -> &Who) -> Vec<Field<Row>> {
    vec![
        field(column("participant", Kind::Text, "The participant’s code."), move |row: &Row| {
            Cell::from(who(row).code.as_str())
        }),
        field(
            column("simulated", Kind::Truth, "Whether the participant is simulated: a program, no person."),
            move |row: &Row| Cell::from(who(row).simulated),
        ),
        field(
            column("analysed", Kind::Truth, "Whether the participant is in the analyses of the report."),
            move |row: &Row| Cell::from(who(row).left_out.is_none()),
        ),
    ]
}

/// A row a flight that was begun, practice included.
pub fn trials(dataset: &Dataset) -> Sheet {
    let mut fields = identity(|flight: &Flight| &flight.who);
    fields.extend(place_fields());
    fields.extend(OF_AN_EPISODE.iter().chain(&OF_A_FLIGHT).map(measure_field));
    fields.extend((0..PARTS).map(part_field));
    fields.extend(TELEMETRY.iter().map(telemetry_field));
    let rows = dataset.trials.iter().map(|trial| Flight {
        who: Who::of(dataset, trial.participant),
        condition: dataset.design.conditions[trial.condition].name.clone(),
        trial: trial.clone(),
    });
    sheet("trials", fields, rows)
}

fn place_fields() -> Vec<Field<Flight>> {
    let not_flown = "the flight was not finished";
    vec![
        field(
            column("condition", Kind::Text, "The condition, as the design names it.")
                .range("names of the design"),
            |f: &Flight| Cell::from(f.condition.as_str()),
        ),
        field(
            column("block", Kind::Integer, "Place of the condition in the order flown, from 1.")
                .range("1 or more"),
            |f: &Flight| Cell::from(f.trial.block),
        ),
        field(
            column("practice", Kind::Truth, "Whether it was a practice flight, which is in no analysis."),
            |f: &Flight| Cell::from(f.trial.practice),
        ),
        field(
            column(
                "number",
                Kind::Integer,
                "Number among the practice or the measured flights of the condition.",
            )
            .range("1 or more"),
            |f: &Flight| Cell::from(f.trial.number),
        ),
        field(
            column("attempt", Kind::Integer, "Which attempt at this flight.").range("1 or more"),
            |f: &Flight| Cell::from(f.trial.attempt),
        ),
        field(
            column("counts", Kind::Truth, "Whether it is the attempt that counts: the last, and finished."),
            |f: &Flight| Cell::from(f.trial.counts),
        ),
        field(
            column("episode", Kind::Integer, "Number in the store, and of the record in the archive.")
                .range("1 or more"),
            |f: &Flight| Cell::from(f.trial.episode),
        ),
        field(
            column(
                "seed",
                Kind::Integer,
                "Seed of terrain, goal and start: equal seeds, equal flights to fly.",
            )
            .range("0 to 2^53")
            .missing_when(not_flown),
            |f: &Flight| f.trial.seed.map_or(Cell::Empty, |seed| Cell::Integer(seed as i64)),
        ),
        field(
            column("interrupted", Kind::Integer, "Times the flight was interrupted in the air and resumed.")
                .unit("times")
                .range("0 or more"),
            |f: &Flight| Cell::from(f.trial.interruptions),
        ),
        field(
            column(
                "not_measured",
                Kind::Text,
                "Why nothing was measured: the flight was not finished, or its record does not replay.",
            )
            .missing_when("the flight was measured"),
            |f: &Flight| f.trial.measured.as_ref().err().map_or(Cell::Empty, |why| Cell::from(why.as_str())),
        ),
    ]
}

fn measure_field(measure: &'static Measure<'static>) -> Field<Flight> {
    let kind = match (measure.unit, measure.key) {
        (Unit::Word, _) => Kind::Text,
        (Unit::Truth, _) => Kind::Truth,
        (Unit::Count("ticks" | "presses" | "times"), _) => Kind::Integer,
        _ => Kind::Number,
    };
    let missing = match measure.missing_when {
        "" => "nothing was measured".to_owned(),
        when => format!("nothing was measured, or {when}"),
    };
    field(Column::of(measure, kind).missing_when(&missing), move |flight: &Flight| {
        let Ok(measured) = &flight.trial.measured else { return Cell::Empty };
        measure_cell(measured, measure.key, kind)
    })
}

fn measure_cell(measured: &Measured, key: &str, kind: Kind) -> Cell {
    let value = measured.values.get(key).copied();
    match kind {
        Kind::Text => Cell::from(measured.ending.word()),
        Kind::Truth => value.map_or(Cell::Empty, |value| Cell::from(value > 0.5)),
        Kind::Integer => value.map_or(Cell::Empty, |value| Cell::Integer(value as i64)),
        Kind::Number => Cell::from(value),
    }
}

/// Authority in one part of the flight.
fn part_field(part: usize) -> Field<Flight> {
    let (from, to) = (part * 100 / PARTS, (part + 1) * 100 / PARTS);
    let meaning = format!(
        "Authority between {from} % and {to} % of the flight: share of the commands that took effect as asked."
    );
    let described = column(&format!("authority_{:02}", part + 1), Kind::Number, &meaning)
        .unit(Unit::Share.word())
        .range(Range::Unit.words())
        .missing_when("nothing was measured, or the pilot asked for nothing in that part");
    field(described, move |flight: &Flight| {
        let part = flight.trial.measured.as_ref().ok().and_then(|measured| measured.parts.get(part));
        Cell::from(part.filter(|p| p.commands > 0).map(|p| f64::from(p.as_asked) / f64::from(p.commands)))
    })
}

fn telemetry_field(&(key, meaning, unit): &'static (&str, &str, &str)) -> Field<Flight> {
    let described = column(&format!("page_{key}"), Kind::Number, meaning)
        .unit(unit)
        .missing_when("the page did not tell, or the attempt does not count");
    field(described, move |flight: &Flight| Cell::from(flight.trial.telemetry.get(key).copied()))
}

/// A participant in a condition, or without one if no order was assigned.
struct InCondition {
    who: Who,
    person: Person,
    condition: Option<String>,
    block: Option<usize>,
    cell: Option<String>,
    flights: usize,
    values: Vec<Option<f64>>,
}

/// A row a participant and condition, ready for mixed models; a participant without any flight has one row.
pub fn participants(dataset: &Dataset) -> Sheet {
    let mut fields = identity(|row: &InCondition| &row.who);
    fields.extend(person_fields());
    let quantities = quantities(dataset);
    for (i, (described, ..)) in quantities.iter().enumerate() {
        fields.push(field(described.clone(), move |row: &InCondition| {
            Cell::from(row.values.get(i).copied().flatten())
        }));
    }
    let rows = (0..dataset.participants.len()).flat_map(|participant| {
        let order = &dataset.participants[participant].order;
        let places: Vec<Option<usize>> =
            if order.is_empty() { vec![None] } else { (0..order.len()).map(Some).collect() };
        places.into_iter().map(move |place| (participant, place)).collect::<Vec<_>>()
    });
    let rows: Vec<InCondition> = rows.map(|at| in_condition(dataset, &quantities, at)).collect();
    sheet("participants", fields, rows.into_iter())
}

/// Columns of a participant's values, and what each is.
fn quantities(dataset: &Dataset) -> Vec<(Column, Quantity, bool)> {
    let of_flights = measures::all().filter_map(|measure| {
        let described = Column::of(measure, Kind::Number);
        let meaning = format!("Mean over the measured flights: {}", measure.meaning);
        let unit = if measure.unit == Unit::Truth { Unit::Share.word() } else { measure.unit.word() };
        let range = if measure.unit == Unit::Truth { Range::Unit } else { measure.range };
        let pooled = measure.key == "calibration_error";
        let meaning = if pooled { measure.meaning.to_owned() } else { meaning };
        let described = Column { meaning, ..described }.unit(unit).range(range.words());
        let missing = match measure.missing_when {
            "" => "no flight was measured".to_owned(),
            when => format!("no flight was measured, or in every one {when}"),
        };
        Some((described.missing_when(&missing), Quantity::of_flights(measure.key)?))
    });
    let of_conditions = Quantity::scores(dataset).into_iter().map(|quantity| score_column(quantity, false));
    let at_the_end = Quantity::end_scores(dataset).into_iter().map(|quantity| score_column(quantity, true));
    let of_flights = of_flights.map(|(column, quantity)| (column, quantity, false));
    of_flights.chain(of_conditions).chain(at_the_end).collect()
}

/// A score's column, the quantity, and whether it was asked at the end.
fn score_column(quantity: Quantity, at_the_end: bool) -> (Column, Quantity, bool) {
    let (suffix, when) =
        if at_the_end { ("_at_end", " Asked at the end; the same in every row.") } else { ("", "") };
    let key = quantity.key.replace(['/', '-', ' '], "_") + suffix;
    let range = quantity.limits.map_or("any".to_owned(), |(least, most)| format!("{least} to {most}"));
    let meaning = format!("{}{when}", quantity.meaning);
    let described = column(&key, Kind::Number, &meaning).unit("points").range(range);
    (described.missing_when("it was not asked, or not all of its items were answered"), quantity, at_the_end)
}

fn in_condition(
    dataset: &Dataset,
    quantities: &[(Column, Quantity, bool)],
    (participant, place): (usize, Option<usize>),
) -> InCondition {
    let person = dataset.participants[participant].clone();
    let condition = place.map(|place| person.order[place]);
    let value = |quantity: &Quantity, at_the_end: bool| {
        if at_the_end {
            return quantity.value_at_the_end(dataset, participant);
        }
        quantity.value(dataset, participant, condition?)
    };
    let names: Vec<&str> = person.order.iter().map(|&c| dataset.design.conditions[c].name.as_str()).collect();
    InCondition {
        who: Who::of(dataset, participant),
        condition: condition.map(|c| dataset.design.conditions[c].name.clone()),
        block: place.map(|place| place + 1),
        cell: (!names.is_empty()).then(|| names.join(" ")),
        flights: condition.map_or(0, |c| dataset.flights(participant, c, false).count()),
        values: quantities.iter().map(|(_, quantity, at_the_end)| value(quantity, *at_the_end)).collect(),
        person,
    }
}

fn person_fields() -> Vec<Field<InCondition>> {
    let text = |value: Option<&str>| value.map_or(Cell::Empty, Cell::from);
    let reasons =
        [LeftOut::Test, LeftOut::Simulated, LeftOut::NeverBegan, LeftOut::Declined, LeftOut::Withdrawn]
            .into_iter()
            .chain([LeftOut::Excluded, LeftOut::Unfinished])
            .map(LeftOut::word)
            .collect::<Vec<_>>();
    vec![
        field(
            column("left_out", Kind::Text, "Why the participant is in no analysis.")
                .range(reasons.join(" | "))
                .missing_when("the participant is analysed"),
            move |row: &InCondition| text(row.who.left_out.map(LeftOut::word)),
        ),
        field(
            column("excluded_because", Kind::Text, "The reason of an exclusion, in words.")
                .missing_when("not excluded"),
            move |row: &InCondition| text(row.person.excluded.as_deref()),
        ),
        field(
            column("progress", Kind::Text, "How far the participant came.")
                .range(Progress::WORDS.join(" | ")),
            |row: &InCondition| Cell::from(row.person.progress.word()),
        ),
        field(
            column("test", Kind::Truth, "Whether it was a trial run by the researchers."),
            |row: &InCondition| Cell::from(row.person.test),
        ),
        field(
            column("language", Kind::Text, "Language that the participant read.")
                .missing_when("nobody opened the page"),
            move |row: &InCondition| text(row.person.language.as_deref()),
        ),
        field(
            column("minutes", Kind::Number, "From consent to the end, breaks and absences included.")
                .unit("min")
                .range("0 or more")
                .missing_when("no consent was given"),
            |row: &InCondition| Cell::from(row.person.minutes),
        ),
        field(
            column("order", Kind::Text, "The conditions in the order flown.")
                .missing_when("no order was assigned"),
            move |row: &InCondition| text(row.cell.as_deref()),
        ),
        field(
            column("condition", Kind::Text, "The condition of this row.")
                .missing_when("no order was assigned"),
            move |row: &InCondition| text(row.condition.as_deref()),
        ),
        field(
            column("block", Kind::Integer, "Place of the condition in the order flown, from 1.")
                .range("1 or more")
                .missing_when("no order was assigned"),
            |row: &InCondition| row.block.map_or(Cell::Empty, Cell::from),
        ),
        field(
            column("flights", Kind::Integer, "Measured flights of the condition that count.")
                .unit("flights")
                .range("0 or more"),
            |row: &InCondition| Cell::from(row.flights),
        ),
    ]
}

/// An answer with whose it is.
struct Given {
    who: Who,
    answer: Answer,
    condition: Option<String>,
}

/// A row an answer: forms, quizzes and questionnaires.
pub fn answers(dataset: &Dataset) -> Sheet {
    let mut fields = identity(|given: &Given| &given.who);
    fields.extend([
        field(column("step", Kind::Text, "The step in which it was asked."), |given: &Given| {
            Cell::from(given.answer.step.as_str())
        }),
        field(
            column("condition", Kind::Text, "The condition it was asked about.")
                .missing_when("it was about none"),
            |given: &Given| given.condition.as_deref().map_or(Cell::Empty, Cell::from),
        ),
        field(column("item", Kind::Text, "The item."), |given: &Given| {
            Cell::from(given.answer.item.as_str())
        }),
        field(
            column(
                "number",
                Kind::Number,
                "The answer as a number, as it was given: reversed items are not turned round.",
            )
            .missing_when("it was not answered, or not with a number"),
            |given: &Given| Cell::from(given.answer.value.as_f64()),
        ),
        field(
            column("text", Kind::Text, "The answer as text; of several choices as a JSON list.")
                .missing_when("it was not answered, or with a number"),
            |given: &Given| text_of(&given.answer.value),
        ),
    ]);
    let rows = dataset.answers.iter().map(|answer| Given {
        who: Who::of(dataset, answer.participant),
        condition: answer.condition.map(|c| dataset.design.conditions[c].name.clone()),
        answer: answer.clone(),
    });
    sheet("answers", fields, rows)
}

fn text_of(value: &Value) -> Cell {
    match value {
        Value::Null | Value::Number(_) => Cell::Empty,
        Value::String(text) => Cell::from(text.as_str()),
        other => Cell::from(other.to_string()),
    }
}

/// What every column of the tables means: unit, type, range, when it is empty.
pub fn dictionary(sheets: &[Sheet]) -> Sheet {
    let keys = ["table", "column", "meaning", "type", "unit", "range", "empty_when"];
    let meanings =
        ["The table.", "The column.", "What it means.", "Type.", "Unit.", "Values.", "When a cell is empty."];
    let columns = keys.iter().zip(meanings).map(|(key, meaning)| column(key, Kind::Text, meaning)).collect();
    let rows = sheets.iter().flat_map(|sheet| {
        sheet.columns.iter().map(|c| {
            let cells = [sheet.name, &c.key, &c.meaning, c.kind.word(), &c.unit, &c.range, &c.missing_when];
            cells
                .into_iter()
                .map(|text| if text.is_empty() { Cell::Empty } else { Cell::from(text) })
                .collect()
        })
    });
    Sheet { name: "dictionary", columns, rows: rows.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::ENDINGS;

    #[test]
    fn endings_and_parts_are_described_as_they_are_written() {
        let ending = measure_field(&OF_AN_EPISODE[0]).column;
        assert_eq!((ending.kind, ending.range), (Kind::Text, ENDINGS.join(" | ")));
        let last = part_field(PARTS - 1).column;
        assert_eq!(last.key, "authority_20");
        assert!(last.meaning.contains("between 95 % and 100 %"));
    }
}
