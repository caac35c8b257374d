//! What the two kinds of database have in common: text with `$n` in it, values for those, and rows of cells.
//!
//! It is small so that everything above it is written once. A transaction that is dropped is taken back.

use super::StoreError;
use async_trait::async_trait;
use std::path::Path;

/// A value for a `$n`. What is absent has a type as well, since PostgreSQL wants to know it.
#[derive(Clone, Debug, PartialEq)]
pub enum Value<'a> {
    /// BIGINT.
    Number(Option<i64>),
    /// DOUBLE PRECISION.
    Real(f64),
    /// TEXT.
    Text(Option<&'a str>),
    /// BLOB or BYTEA.
    Bytes(Option<&'a [u8]>),
}

impl From<i64> for Value<'_> {
    fn from(value: i64) -> Self {
        Self::Number(Some(value))
    }
}

impl From<u32> for Value<'_> {
    fn from(value: u32) -> Self {
        Self::Number(Some(value.into()))
    }
}

impl<'a> From<&'a String> for Value<'a> {
    fn from(value: &'a String) -> Self {
        Self::Text(Some(value))
    }
}

impl<'a> From<&'a str> for Value<'a> {
    fn from(value: &'a str) -> Self {
        Self::Text(Some(value))
    }
}

impl<'a> From<&'a [u8]> for Value<'a> {
    fn from(value: &'a [u8]) -> Self {
        Self::Bytes(Some(value))
    }
}

impl Value<'_> {
    /// PostgreSQL stores no text with the character 0 in it; neither do we in SQLite, so that both do the same.
    pub fn refuse_zero(values: &[Self]) -> Result<(), StoreError> {
        let bad = |value: &&Self| matches!(value, Self::Text(Some(text)) if text.contains('\0'));
        match values.iter().find(bad) {
            Some(value) => {
                Err(StoreError::Value { what: "a text with the character 0", value: format!("{value:?}") })
            }
            None => Ok(()),
        }
    }
}

/// A value from the database.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// NULL.
    Nothing,
    /// A whole number.
    Number(i64),
    /// Any other number.
    Real(f64),
    /// Text.
    Text(String),
    /// Bytes.
    Bytes(Vec<u8>),
}

/// Cells in the order of the columns that were asked for; reading takes them from the front.
#[derive(Debug)]
pub struct Row(std::vec::IntoIter<Cell>);

impl Row {
    pub fn new(cells: Vec<Cell>) -> Self {
        Self(cells.into_iter())
    }

    /// Those that are left.
    pub fn cells(&self) -> &[Cell] {
        self.0.as_slice()
    }

    /// The next cell. `what` is its column, for the error.
    pub fn take<T: FromCell>(&mut self, what: &'static str) -> Result<T, StoreError> {
        let cell =
            self.0.next().ok_or_else(|| StoreError::Value { what, value: "it is not there".into() })?;
        T::from_cell(cell).map_err(|cell| StoreError::Value { what, value: format!("{cell:?}") })
    }

    /// The next cell, a whole number, as a narrower type.
    pub fn number<T: TryFrom<i64>>(&mut self, what: &'static str) -> Result<T, StoreError> {
        let value: i64 = self.take(what)?;
        T::try_from(value).map_err(|_| StoreError::Value { what, value: value.to_string() })
    }
}

/// What a cell can be read as; gives the cell back if it holds something else.
pub trait FromCell: Sized {
    fn from_cell(cell: Cell) -> Result<Self, Cell>;
}

impl FromCell for i64 {
    fn from_cell(cell: Cell) -> Result<Self, Cell> {
        if let Cell::Number(value) = cell { Ok(value) } else { Err(cell) }
    }
}

impl FromCell for f64 {
    fn from_cell(cell: Cell) -> Result<Self, Cell> {
        if let Cell::Real(value) = cell { Ok(value) } else { Err(cell) }
    }
}

impl FromCell for String {
    fn from_cell(cell: Cell) -> Result<Self, Cell> {
        if let Cell::Text(value) = cell { Ok(value) } else { Err(cell) }
    }
}

impl FromCell for Vec<u8> {
    fn from_cell(cell: Cell) -> Result<Self, Cell> {
        if let Cell::Bytes(value) = cell { Ok(value) } else { Err(cell) }
    }
}

impl<T: FromCell> FromCell for Option<T> {
    fn from_cell(cell: Cell) -> Result<Self, Cell> {
        if cell == Cell::Nothing { Ok(None) } else { T::from_cell(cell).map(Some) }
    }
}

/// A database that can be reached.
#[async_trait]
pub trait Driver: Send + Sync {
    /// Reads rows.
    async fn read(&self, sql: &'static str, values: &[Value<'_>]) -> Result<Vec<Row>, StoreError>;

    /// Begins to write. One writes at a time: this waits for whoever does, for a while.
    async fn begin(&self) -> Result<Box<dyn Transaction>, StoreError>;

    /// Begins to read what is there at this moment, whatever others write meanwhile.
    async fn snapshot(&self) -> Result<Box<dyn Transaction>, StoreError>;

    /// Takes care that nothing of what was deleted can be read from the files.
    async fn scrub(&self) -> Result<(), StoreError>;

    /// See [`Store::backup`](super::Store::backup); nothing is at `to`.
    async fn copy_into(&self, to: &Path) -> Result<(), StoreError>;

    /// Closes all connections.
    async fn close(&self);
}

/// How the largest number that was ever given to an episode is read, and set in an empty database.
#[derive(Clone, Copy, Debug)]
pub struct Numbering {
    /// Gives one row with the number, 0 if there was none.
    pub read: &'static str,
    /// `$1` is the number.
    pub write: &'static str,
}

/// Changes that come together or not at all.
#[async_trait]
pub trait Transaction: Send {
    /// Changes something; gives how many rows.
    async fn execute(&mut self, sql: &'static str, values: &[Value<'_>]) -> Result<u64, StoreError>;

    /// Reads rows, the changes so far included.
    async fn read(&mut self, sql: &'static str, values: &[Value<'_>]) -> Result<Vec<Row>, StoreError>;

    /// How this kind of database numbers episodes.
    fn numbering(&self) -> Numbering;

    /// Returns once the changes survive the loss of power.
    async fn commit(self: Box<Self>) -> Result<(), StoreError>;
}
