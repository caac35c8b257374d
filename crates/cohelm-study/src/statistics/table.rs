//! The table that every within-subject test reads: one value for each participant in each condition.

use super::{Undefined, is_usable};
use serde::Serialize;

/// Participants × conditions, complete and finite: what a table is not, its constructors refuse.
///
/// A value is usually a participant's mean of one measure over the episodes of one condition; its unit is the
/// measure's. Row and column order is the caller's and is kept in every result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    participants: Vec<String>,
    conditions: Vec<String>,
    /// One row a participant, one value a condition.
    rows: Vec<Vec<f64>>,
}

/// Why rows of numbers do not make a [`Table`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TableError {
    /// The number of names differs from the number of rows.
    #[error(
        "{participants} participants are named, but there are {rows} rows; give one row for each participant"
    )]
    Rows {
        /// Names given.
        participants: usize,
        /// Rows given.
        rows: usize,
    },
    /// A row has too few or too many values.
    #[error("the row of {participant:?} has {found} values where {expected} conditions are named")]
    Width {
        /// Whose row.
        participant: String,
        /// Number of conditions.
        expected: usize,
        /// Values in the row.
        found: usize,
    },
    /// A value is NaN, infinite or beyond [`super::LARGEST_VALUE`].
    #[error(
        "{participant:?} in {condition:?} has the value {value}, which is no usable number; leave the cell empty if it is missing"
    )]
    NotFinite {
        /// Whose value.
        participant: String,
        /// In which condition.
        condition: String,
        /// The value refused.
        value: f64,
    },
    /// The same name stands for two participants or two conditions.
    #[error("the name {0:?} is used twice; participants and conditions need names of their own")]
    Duplicate(String),
}

/// A table made by leaving out incomplete participants, with their names.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Listwise {
    /// The participants who have a value in every condition.
    pub table: Table,
    /// Those who lack one, and so take part in no within-subject test.
    pub left_out: Vec<String>,
}

impl Table {
    /// A table from complete rows, one for each participant, one value for each condition.
    ///
    /// # Errors
    /// Names and rows that do not match, duplicate names, values that are not finite.
    pub fn complete(
        participants: Vec<String>,
        conditions: Vec<String>,
        rows: Vec<Vec<f64>>,
    ) -> Result<Self, TableError> {
        let cells = rows.iter().map(|row| row.iter().copied().map(Some).collect()).collect();
        Self::listwise(participants, conditions, cells).map(|made| made.table)
    }

    /// A table from rows with missing cells: participants without a value in every condition are left out, and named.
    ///
    /// # Errors
    /// Names and rows that do not match, duplicate names, values that are not finite.
    pub fn listwise(
        participants: Vec<String>,
        conditions: Vec<String>,
        rows: Vec<Vec<Option<f64>>>,
    ) -> Result<Listwise, TableError> {
        check_names(&participants)?;
        check_names(&conditions)?;
        if participants.len() != rows.len() {
            return Err(TableError::Rows { participants: participants.len(), rows: rows.len() });
        }
        let mut made = Listwise {
            table: Table { participants: Vec::new(), conditions, rows: Vec::new() },
            left_out: Vec::new(),
        };
        for (participant, row) in participants.into_iter().zip(rows) {
            check_row(&participant, &made.table.conditions, &row)?;
            match row.into_iter().collect::<Option<Vec<f64>>>() {
                Some(row) => {
                    made.table.participants.push(participant);
                    made.table.rows.push(row);
                }
                None => made.left_out.push(participant),
            }
        }
        Ok(made)
    }

    /// A table of means: each cell is the mean of the values given for its participant and condition, by index; cells
    /// without a value are missing, and values of unknown participants or conditions are not looked at.
    ///
    /// # Errors
    /// Duplicate names, values that are not finite.
    pub fn of_means(
        participants: Vec<String>,
        conditions: Vec<String>,
        values: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Result<Listwise, TableError> {
        let mut sums = vec![vec![(0.0, 0_u32); conditions.len()]; participants.len()];
        for (participant, condition, value) in values {
            if let Some(cell) = sums.get_mut(participant).and_then(|row| row.get_mut(condition)) {
                *cell = (cell.0 + value, cell.1 + 1);
            }
        }
        let mean = |(sum, count): (f64, u32)| (count > 0).then(|| sum / f64::from(count));
        let rows = sums.into_iter().map(|row| row.into_iter().map(mean).collect()).collect();
        Self::listwise(participants, conditions, rows)
    }

    /// Names of the participants, in row order.
    pub fn participants(&self) -> &[String] {
        &self.participants
    }

    /// Names of the conditions, in column order.
    pub fn conditions(&self) -> &[String] {
        &self.conditions
    }

    /// The rows: one a participant, one value a condition.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    /// The values of one condition, in participants' order; `None` if no condition has that index.
    pub fn column(&self, condition: usize) -> Option<Vec<f64>> {
        (condition < self.conditions.len()).then(|| self.rows.iter().map(|row| row[condition]).collect())
    }

    /// All columns, in order.
    pub fn columns(&self) -> Vec<Vec<f64>> {
        (0..self.conditions.len()).filter_map(|condition| self.column(condition)).collect()
    }

    /// The index of a condition's name.
    pub fn condition(&self, name: &str) -> Option<usize> {
        self.conditions.iter().position(|c| c == name)
    }

    /// Two conditions of every participant, by index.
    ///
    /// # Errors
    /// [`Undefined::NoSuchCondition`] if there is no such column.
    pub fn pair(&self, a: usize, b: usize) -> Result<Paired, Undefined> {
        let column = |i: usize| {
            self.column(i).ok_or_else(|| Undefined::NoSuchCondition { condition: format!("number {i}") })
        };
        Paired::new(&column(a)?, &column(b)?)
    }

    /// Two conditions of every participant, by name.
    ///
    /// # Errors
    /// [`Undefined::NoSuchCondition`] if a name is unknown.
    pub fn pair_named(&self, a: &str, b: &str) -> Result<Paired, Undefined> {
        let index = |name: &str| {
            self.condition(name).ok_or_else(|| Undefined::NoSuchCondition { condition: name.to_owned() })
        };
        self.pair(index(a)?, index(b)?)
    }
}

fn check_names(names: &[String]) -> Result<(), TableError> {
    let mut sorted: Vec<&String> = names.iter().collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|two| two[0] == two[1]) {
        Some(two) => Err(TableError::Duplicate(two[0].clone())),
        None => Ok(()),
    }
}

fn check_row(participant: &str, conditions: &[String], row: &[Option<f64>]) -> Result<(), TableError> {
    if row.len() != conditions.len() {
        return Err(TableError::Width {
            participant: participant.to_owned(),
            expected: conditions.len(),
            found: row.len(),
        });
    }
    for (condition, value) in conditions.iter().zip(row) {
        if let Some(value) = value.filter(|&v| !is_usable(v)) {
            return Err(TableError::NotFinite {
                participant: participant.to_owned(),
                condition: condition.clone(),
                value,
            });
        }
    }
    Ok(())
}

/// The same participants measured twice: two columns of equal length, all finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Paired {
    a: Vec<f64>,
    b: Vec<f64>,
}

impl Paired {
    /// Pairs `a[i]` with `b[i]`.
    ///
    /// # Errors
    /// [`Undefined::Unpaired`] if the lengths differ, [`Undefined::NotFinite`] if a value is NaN or infinite.
    pub fn new(a: &[f64], b: &[f64]) -> Result<Self, Undefined> {
        if a.len() != b.len() {
            return Err(Undefined::Unpaired { a: a.len(), b: b.len() });
        }
        if a.iter().chain(b).any(|&v| !is_usable(v)) {
            return Err(Undefined::NotFinite);
        }
        Ok(Paired { a: a.to_vec(), b: b.to_vec() })
    }

    /// Number of participants.
    pub fn len(&self) -> usize {
        self.a.len()
    }

    /// Whether there is no participant at all.
    pub fn is_empty(&self) -> bool {
        self.a.is_empty()
    }

    /// The first condition's values.
    pub fn a(&self) -> &[f64] {
        &self.a
    }

    /// The second condition's values.
    pub fn b(&self) -> &[f64] {
        &self.b
    }

    /// The differences against zero, those that agree up to rounding made equal.
    ///
    /// 34/40 − 32/40 and 36/40 − 34/40 differ in the last digit of an `f64`, yet a test that ranks differences must see a tie.
    #[must_use]
    pub fn snapped(&self) -> Paired {
        let magnitude = self.a.iter().chain(&self.b).fold(0.0_f64, |m, v| m.max(v.abs()));
        let grain = 1e-12 * magnitude;
        let snap = |d: f64| if grain > 0.0 { (d / grain).round() * grain } else { 0.0 };
        Paired { a: self.differences().into_iter().map(snap).collect(), b: vec![0.0; self.a.len()] }
    }

    /// `a − b` of every participant.
    pub fn differences(&self) -> Vec<f64> {
        self.a.iter().zip(&self.b).map(|(a, b)| a - b).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|&n| n.to_owned()).collect()
    }

    #[test]
    fn incomplete_participants_are_left_out_by_name() {
        let rows = vec![vec![Some(1.0), Some(2.0)], vec![Some(1.0), None], vec![Some(3.0), Some(4.0)]];
        let made = Table::listwise(names(&["ann", "bob", "cy"]), names(&["HIC", "MISC"]), rows).unwrap();
        assert_eq!(made.left_out, ["bob"]);
        assert_eq!(made.table.participants(), ["ann", "cy"]);
        assert_eq!(made.table.column(1), Some(vec![2.0, 4.0]));
        assert_eq!(made.table.column(2), None);
    }

    #[test]
    fn means_of_episodes_leave_unflown_cells_missing() {
        let values = [(0, 0, 1.0), (0, 0, 2.0), (0, 1, 5.0), (1, 0, 9.0), (7, 0, 1.0)];
        let made = Table::of_means(names(&["ann", "bob"]), names(&["HIC", "MISC"]), values).unwrap();
        assert_eq!((made.table.rows(), made.left_out), (&[vec![1.5, 5.0]][..], names(&["bob"])));
        assert!(Table::of_means(names(&["ann"]), names(&["HIC"]), [(0, 0, f64::NAN)]).is_err());
    }

    #[test]
    fn wrong_tables_are_refused_with_a_reason() {
        let error = |participants: &[&str], rows: Vec<Vec<f64>>| {
            Table::complete(names(participants), names(&["HIC", "MISC"]), rows).unwrap_err().to_string()
        };
        assert!(error(&["ann"], vec![]).contains("1 participants are named, but there are 0 rows"));
        assert!(error(&["ann"], vec![vec![1.0]]).contains("has 1 values where 2 conditions"));
        assert!(error(&["ann"], vec![vec![1.0, f64::NAN]]).contains("\"ann\" in \"MISC\" has the value NaN"));
        assert!(error(&["ann", "ann"], vec![vec![1.0, 2.0]; 2]).contains("used twice"));
    }

    #[test]
    fn unknown_conditions_and_unpaired_columns_are_named() {
        let table = Table::complete(names(&["ann"]), names(&["HIC", "MISC"]), vec![vec![1.0, 2.0]]).unwrap();
        assert_eq!(table.pair_named("MISC", "HIC").unwrap().differences(), [1.0]);
        assert!(table.pair_named("MISC", "LASC").unwrap_err().to_string().contains("LASC"));
        assert!(Paired::new(&[1.0], &[]).is_err());
        assert!(Paired::new(&[1.0], &[f64::INFINITY]).is_err());
    }
}
