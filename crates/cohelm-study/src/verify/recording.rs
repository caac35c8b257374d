//! `cohelm verify statistics`: every number of a recording made with pingouin and SciPy, computed again from its table.
//!
//! The format is that of `tests/data/record_statistics.py`: `cases`, each with a complete `table` and what the outside
//! libraries say of it. Whatever number a case holds is looked up by its path among ours; none is skipped in silence.

use super::lenient_json::without_non_finite;
use crate::statistics::{
    Paired, RepeatedMeasures, Table, TableError, Undefined, effect_sizes, friedman, holm, interquartile_mean,
    one_way, paired_t, repeated_measures, tost, wilcoxon,
};
use serde::{Serialize, Serializer};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Read;

/// Largest relative distance that counts as the same number.
const RELATIVE: f64 = 1e-6;
/// A statistic or effect size that is zero by symmetry comes out as rounding noise in one of the libraries; p values,
/// which may be tiny and right, get no such allowance.
const NOISE: f64 = 1e-10;
/// Far above any study; keeps a hostile file from asking for a covariance matrix of gigabytes.
const MOST_CONDITIONS: usize = 64;

/// What came of comparing one recording.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Report {
    /// Tables in the file.
    pub cases: usize,
    /// Numbers compared.
    pub values: usize,
    /// Those within 1e-6 relative of the recorded ones.
    pub within: usize,
    /// Largest relative distance met (among those beyond rounding noise).
    pub largest_relative: f64,
    /// Values that the recording itself holds as NaN or infinite; not compared.
    pub undefined_in_recording: usize,
    /// Recorded names that this version does not compute, each once; their values are not compared.
    pub unknown: Vec<String>,
    /// The first number that is not the same.
    pub first_difference: Option<Difference>,
}

/// A number that is not as recorded. As JSON, `ours` is a number, or the sentence that says why there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Index of the case in the file, from 0.
    pub case: usize,
    /// Path of the number within the case, as `pairs[2].w_p`.
    pub name: String,
    /// The recorded number.
    pub recorded: f64,
    /// Ours, or why there is none.
    #[serde(serialize_with = "number_or_reason")]
    pub ours: Result<f64, Undefined>,
}

fn number_or_reason<S: Serializer>(ours: &Result<f64, Undefined>, to: S) -> Result<S::Ok, S::Error> {
    match ours {
        Ok(number) => to.serialize_f64(*number),
        Err(why) => to.collect_str(why),
    }
}

/// Why a file could not be compared.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// The file cannot be read.
    #[error("the recording cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// It is no JSON.
    #[error("the recording is not JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// It is JSON, but no recording of statistics.
    #[error(
        "this is no recording of statistics: expected an object with a non-empty list `cases`, as record_statistics.py writes it"
    )]
    NotARecording,
    /// A case lacks something or holds something else.
    #[error("case {case}: {problem}")]
    Case {
        /// Index of the case, from 0.
        case: usize,
        /// What is wrong with it.
        problem: String,
    },
}

impl Report {
    /// Whether every number compared is the recorded one.
    pub fn all_within(&self) -> bool {
        self.within == self.values
    }

    fn compare(&mut self, case: usize, name: String, recorded: f64, ours: Result<f64, Undefined>) {
        self.values += 1;
        let relative = match &ours {
            Ok(ours) => relative_distance(&name, *ours, recorded),
            // Of a determinant that vanishes, the recording holds what rounding left of it.
            Err(Undefined::SingularCovariance) if recorded.abs() < NOISE => 0.0,
            Err(_) => f64::INFINITY,
        };
        if ours.is_ok() {
            self.largest_relative = self.largest_relative.max(relative);
        }
        if relative <= RELATIVE {
            self.within += 1;
        } else if self.first_difference.is_none() {
            self.first_difference = Some(Difference { case, name, recorded, ours });
        }
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} cases, {} values compared, {} within 1e-6 (largest relative distance {:.1e})",
            self.cases, self.values, self.within, self.largest_relative
        )?;
        if self.undefined_in_recording > 0 {
            write!(f, "\n{} recorded as NaN or infinite, not compared", self.undefined_in_recording)?;
        }
        if !self.unknown.is_empty() {
            write!(f, "\nnot computed by this version and not compared: {}", self.unknown.join(", "))?;
        }
        if let Some(first) = &self.first_difference {
            write!(
                f,
                "\nfirst difference: case {}, {}: recorded {}, ",
                first.case, first.name, first.recorded
            )?;
            match &first.ours {
                Ok(ours) => write!(f, "ours {ours}")?,
                Err(why) => write!(f, "ours undefined: {why}")?,
            }
        }
        Ok(())
    }
}

fn relative_distance(name: &str, ours: f64, recorded: f64) -> f64 {
    let distance = (ours - recorded).abs();
    if distance == 0.0 || (distance <= NOISE && !is_p_value(name)) {
        return 0.0;
    }
    distance / recorded.abs()
}

fn is_p_value(name: &str) -> bool {
    let last = name.rsplit('.').next().unwrap_or(name);
    last == "p" || last.starts_with("p_") || last.ends_with("_p") || last.starts_with("holm")
}

/// Computes every number of a recording again and compares.
///
/// Where a number does not exist for us but the recording holds its limit, the limit is compared: p = 0 for a difference
/// that is the same in everybody, and Mauchly's w = p = 0 for a singular covariance.
///
/// # Errors
/// Unreadable or malformed files, and files without a single case.
pub fn statistics(mut reader: impl Read) -> Result<Report, VerifyError> {
    let mut text = Vec::new();
    reader.read_to_end(&mut text)?;
    let file: Value = serde_json::from_slice(&without_non_finite(&text))?;
    let cases = file.get("cases").and_then(Value::as_array).filter(|cases| !cases.is_empty());
    let mut report = Report::default();
    for (index, case) in cases.ok_or(VerifyError::NotARecording)?.iter().enumerate() {
        compare_case(&mut report, index, case)
            .map_err(|problem| VerifyError::Case { case: index, problem })?;
    }
    Ok(report)
}

fn compare_case(report: &mut Report, index: usize, case: &Value) -> Result<(), String> {
    let mut ours = Computed::of(case)?.0;
    let mut recorded = BTreeMap::new();
    flatten(case, String::new(), &mut recorded);
    for input in ["table", "tost_bound"] {
        recorded.retain(|name, _| !(name == input || name.starts_with(&format!("{input}["))));
    }
    report.cases += 1;
    for (name, recorded) in recorded {
        match (ours.remove(&name), recorded) {
            (None, _) => add_unknown(&mut report.unknown, &name),
            (Some(_), None) => report.undefined_in_recording += 1,
            (Some(ours), Some(recorded)) => report.compare(index, name, recorded, ours),
        }
    }
    match ours.keys().next() {
        Some(missing) => Err(format!("`{missing}` is missing")),
        None => Ok(()),
    }
}

fn add_unknown(unknown: &mut Vec<String>, name: &str) {
    let without_index: String = name.split('[').map(|part| part.rsplit(']').next().unwrap_or(part)).collect();
    if !unknown.contains(&without_index) {
        unknown.push(without_index);
    }
}

/// Every number of a JSON value under its path; `None` for null. Text and truth values are no numbers and are left out.
fn flatten(value: &Value, path: String, into: &mut BTreeMap<String, Option<f64>>) {
    match value {
        Value::Null => drop(into.insert(path, None)),
        Value::Number(number) => drop(into.insert(path, number.as_f64())),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| flatten(item, format!("{path}[{i}]"), into));
        }
        Value::Object(fields) => {
            let dot = if path.is_empty() { "" } else { "." };
            fields.iter().for_each(|(name, field)| flatten(field, format!("{path}{dot}{name}"), into));
        }
        Value::Bool(_) | Value::String(_) => {}
    }
}

/// Our numbers of one case, under the recording's names.
struct Computed(BTreeMap<String, Result<f64, Undefined>>);

impl Computed {
    fn of(case: &Value) -> Result<Self, String> {
        let table = table(case)?;
        let bound =
            case.get("tost_bound").and_then(Value::as_f64).ok_or("`tost_bound` is missing or no number")?;
        let mut computed = Computed(BTreeMap::new());
        computed.one_way(&table);
        computed.repeated_measures(&table);
        if table.conditions().len() > 2 {
            computed.friedman(&table);
        }
        computed.pairs(&table, case, bound)?;
        for (i, column) in table.columns().iter().enumerate() {
            computed.put(format!("iqm[{i}]"), interquartile_mean(column));
        }
        Ok(computed)
    }

    fn put(&mut self, name: impl Into<String>, value: Result<f64, Undefined>) {
        self.0.insert(name.into(), value);
    }

    fn one_way(&mut self, table: &Table) {
        let result = one_way(table);
        let part = |of: fn(&crate::statistics::OneWay) -> f64| result.as_ref().map(of).map_err(Clone::clone);
        let (rows, columns) = (table.rows().len() as f64, table.conditions().len() as f64);
        self.put("one_way.F", part(|r| r.f));
        self.put("one_way.p", p_or_limit(part(|r| r.p)));
        self.put("one_way.df_between", Ok(columns - 1.0));
        self.put("one_way.df_within", Ok(columns * (rows - 1.0)));
    }

    fn repeated_measures(&mut self, table: &Table) {
        let result = repeated_measures(table);
        let part = |of: fn(&RepeatedMeasures) -> f64| result.as_ref().map(of).map_err(Clone::clone);
        let (rows, columns) = (table.rows().len() as f64, table.conditions().len() as f64);
        self.put("rm.F", part(|r| r.f));
        self.put("rm.p", p_or_limit(part(|r| r.p)));
        self.put("rm.df_effect", Ok(columns - 1.0));
        self.put("rm.df_error", Ok((columns - 1.0) * (rows - 1.0)));
        self.put("rm.ges", part(|r| r.generalised_eta2));
        self.put("rm.partial_eta2", part(|r| r.partial_eta2));
        let sphericity = match &result {
            Ok(RepeatedMeasures { sphericity: None, .. }) => return,
            Ok(RepeatedMeasures { sphericity: Some(sphericity), .. }) => Ok(sphericity),
            Err(_) if columns < 3.0 => return,
            Err(why) => Err(why.clone()),
        };
        let mauchly = sphericity.clone().and_then(|s| s.mauchly.clone());
        self.put("rm.epsilon", sphericity.clone().map(|s| s.epsilon));
        self.put("rm.p_gg", sphericity.map(|s| s.p_corrected));
        self.put("rm.mauchly_w", mauchly.clone().map(|m| m.w));
        self.put("rm.mauchly_p", mauchly.map(|m| m.p));
    }

    fn friedman(&mut self, table: &Table) {
        let result = friedman(table);
        self.put("friedman.chi2", result.clone().map(|r| r.chi2));
        self.put("friedman.p", result.map(|r| r.p));
    }

    fn pairs(&mut self, table: &Table, case: &Value, bound: f64) -> Result<(), String> {
        let pairs = case.get("pairs").and_then(Value::as_array).ok_or("`pairs` is missing or no list")?;
        let mut p_values = Vec::new();
        for (i, pair) in pairs.iter().enumerate() {
            let column = |key: &str| {
                let index = pair
                    .get(key)
                    .and_then(Value::as_u64)
                    .ok_or(format!("`pairs[{i}].{key}` is no column"))?;
                usize::try_from(index).map_err(|e| e.to_string())
            };
            let (a, b) = (column("a")?, column("b")?);
            let paired = table.pair(a, b).map_err(|e| format!("pairs[{i}]: {e}"))?;
            self.put(format!("pairs[{i}].a"), Ok(a as f64));
            self.put(format!("pairs[{i}].b"), Ok(b as f64));
            p_values.push(self.pair(i, &paired, bound));
        }
        for (i, adjusted) in holm(&p_values).into_iter().enumerate() {
            self.put(format!("holm[{i}]"), adjusted.ok_or(Undefined::NoDifference));
        }
        Ok(())
    }

    /// One pair's numbers; returns the p value of its t test for Holm's adjustment.
    fn pair(&mut self, i: usize, pair: &Paired, bound: f64) -> Option<f64> {
        let (t, w) = (paired_t(pair), wilcoxon(pair));
        let p = p_or_limit(t.clone().map(|t| t.p));
        self.put(format!("pairs[{i}].t"), t.map(|t| t.t));
        self.put(format!("pairs[{i}].p"), p.clone());
        self.put(format!("pairs[{i}].df"), Ok(pair.len() as f64 - 1.0));
        self.put(format!("pairs[{i}].w"), w.clone().map(|w| w.w));
        self.put(format!("pairs[{i}].w_p"), w.map(|w| w.p));
        self.put(format!("pairs[{i}].cohen_d"), effect_sizes(pair).map(|e| e.d_av));
        self.put(format!("pairs[{i}].tost_p"), tost_or_limit(pair, bound));
        p.ok()
    }
}

/// The limit of a p value as the variation against which it is judged vanishes.
fn p_or_limit(p: Result<f64, Undefined>) -> Result<f64, Undefined> {
    match p {
        Err(Undefined::NoErrorVariation) => Ok(0.0),
        other => other,
    }
}

/// A constant difference lies within the bounds or it does not.
fn tost_or_limit(pair: &Paired, bound: f64) -> Result<f64, Undefined> {
    match tost(pair, bound) {
        Err(Undefined::NoErrorVariation | Undefined::NoDifference) => {
            let within = pair.differences().iter().all(|d| d.abs() < bound);
            Ok(if within { 0.0 } else { 1.0 })
        }
        other => other.map(|t| t.p),
    }
}

fn table(case: &Value) -> Result<Table, String> {
    let rows = case.get("table").and_then(Value::as_array).ok_or("`table` is missing or no list of rows")?;
    let rows: Vec<Vec<f64>> = rows.iter().enumerate().map(|(i, r)| row(i, r)).collect::<Result<_, _>>()?;
    let conditions = rows.first().map_or(0, Vec::len);
    if conditions > MOST_CONDITIONS {
        return Err(format!("the table has {conditions} columns; at most {MOST_CONDITIONS} are compared"));
    }
    let names = |what: &str, count: usize| (0..count).map(|i| format!("{what} {i}")).collect();
    let (participants, conditions) = (names("row", rows.len()), names("column", conditions));
    Table::complete(participants, conditions, rows).map_err(|e: TableError| format!("`table`: {e}"))
}

fn row(index: usize, row: &Value) -> Result<Vec<f64>, String> {
    let cells = row.as_array().ok_or(format!("`table[{index}]` is no list of numbers"))?;
    cells
        .iter()
        .enumerate()
        .map(|(i, cell)| cell.as_f64().ok_or(format!("`table[{index}][{i}]` is no finite number")))
        .collect()
}
