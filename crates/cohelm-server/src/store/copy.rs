//! Everything from one database into another, table by table, whatever kinds they are.

use super::driver::{Cell, Driver, Transaction, Value};
use super::{SqliteStore, StoreError};
use std::path::Path;
use std::sync::LazyLock;

/// Rows read at once: more need more memory (a model has some 100 KiB), fewer need more time.
const ROWS: i64 = 200;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Number,
    Real,
    Text,
    Bytes,
}

/// How a part of a table is read, how a row of it is written, and what its columns hold.
struct Table {
    read: String,
    write: String,
    kinds: Vec<Kind>,
}

impl Table {
    fn new(name: &str, key: &str, columns: &[(&str, Kind)]) -> Self {
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        let names = names.join(", ");
        let places: Vec<String> = (1..=columns.len()).map(|place| format!("${place}")).collect();
        Self {
            read: format!("SELECT {names} FROM {name} ORDER BY {key} LIMIT $1 OFFSET $2"),
            write: format!("INSERT INTO {name} ({names}) VALUES ({})", places.join(", ")),
            kinds: columns.iter().map(|(_, kind)| *kind).collect(),
        }
    }
}

/// Every table, those that others refer to first. A test holds it to the schema.
static TABLES: LazyLock<Vec<Table>> = LazyLock::new(|| {
    use Kind::{Bytes, Number, Real, Text};
    vec![
        Table::new(
            "models",
            "hash",
            &[
                ("hash", Text),
                ("origin", Text),
                ("kind", Text),
                ("name", Text),
                ("plant", Text),
                ("card", Text),
                ("bytes", Bytes),
                ("stored_at_ms", Number),
                ("kept_at_ms", Number),
            ],
        ),
        Table::new(
            "studies",
            "hash",
            &[("hash", Text), ("name", Text), ("text", Text), ("stored_at_ms", Number)],
        ),
        Table::new(
            "participants",
            "id",
            &[
                ("id", Number),
                ("study", Text),
                ("code", Text),
                ("token_hash", Bytes),
                ("created_at_ms", Number),
                ("seen_at_ms", Number),
                ("last_seq", Number),
                ("withdrawn_at_ms", Number),
            ],
        ),
        Table::new(
            "events",
            "participant, seq",
            &[("participant", Number), ("seq", Number), ("at_ms", Number), ("event", Text)],
        ),
        Table::new(
            "episodes",
            "id",
            &[
                ("id", Number),
                ("flight_key", Bytes),
                ("plant", Text),
                ("plant_version", Number),
                ("format", Number),
                ("program", Text),
                ("rule", Text),
                ("seed", Number),
                ("pilot", Text),
                ("time_scale", Real),
                ("values_model", Text),
                ("intent_model", Text),
                ("setup", Text),
                ("started_at_ms", Number),
                ("ended_at_ms", Number),
                ("ticks", Number),
                ("ending", Text),
                ("refused", Text),
                ("participant", Number),
                ("step", Text),
            ],
        ),
        Table::new("records", "episode", &[("episode", Number), ("bytes", Bytes)]),
        Table::new(
            "chunks",
            "episode, from_tick",
            &[
                ("episode", Number),
                ("from_tick", Number),
                ("to_tick", Number),
                ("plant_digest", Number),
                ("decisions_digest", Number),
                ("events", Bytes),
            ],
        ),
        Table::new("settings", "name", &[("name", Text), ("value", Text)]),
    ]
});

/// Makes a new SQLite file of what a transaction sees.
pub async fn into_new_file(mut from: Box<dyn Transaction>, to: &Path) -> Result<(), StoreError> {
    let new = SqliteStore::open(to).await?;
    let mut writing = new.driver.begin().await?;
    let copied = everything(from.as_mut(), writing.as_mut()).await;
    let committed = match copied {
        Ok(()) => writing.commit().await,
        Err(error) => Err(error),
    };
    new.close().await;
    committed
}

/// Copies every row of every table, and goes on numbering episodes where the original did: numbers of those that are
/// gone are not given again.
async fn everything(from: &mut dyn Transaction, to: &mut dyn Transaction) -> Result<(), StoreError> {
    let largest = from.read(from.numbering().read, &[]).await?;
    for mut row in largest {
        let number: i64 = row.take("the largest number of an episode")?;
        to.read(to.numbering().write, &[number.into()]).await?;
    }
    for table in TABLES.iter() {
        copy_table(table, from, to).await?;
    }
    Ok(())
}

async fn copy_table(
    table: &'static Table,
    from: &mut dyn Transaction,
    to: &mut dyn Transaction,
) -> Result<(), StoreError> {
    for part in 0.. {
        let rows = from.read(&table.read, &[ROWS.into(), (part * ROWS).into()]).await?;
        for row in &rows {
            let values: Vec<Value<'_>> =
                row.cells().iter().zip(&table.kinds).map(|(cell, kind)| value(cell, *kind)).collect();
            to.execute(&table.write, &values).await?;
        }
        if (rows.len() as i64) < ROWS {
            break;
        }
    }
    Ok(())
}

fn value(cell: &Cell, kind: Kind) -> Value<'_> {
    match (cell, kind) {
        (Cell::Number(number), _) => (*number).into(),
        (Cell::Real(number), _) => Value::Real(*number),
        (Cell::Text(text), _) => text.into(),
        (Cell::Bytes(bytes), _) => bytes.as_slice().into(),
        (Cell::Nothing, Kind::Number | Kind::Real) => Value::Number(None),
        (Cell::Nothing, Kind::Text) => Value::Text(None),
        (Cell::Nothing, Kind::Bytes) => Value::Bytes(None),
    }
}

/// Copies all of one database into another that is empty.
pub async fn into_empty(from: &dyn Driver, to: &dyn Driver, name: &str) -> Result<(), StoreError> {
    let mut reading = from.snapshot().await?;
    let mut writing = to.begin().await?;
    for table in TABLES.iter() {
        if !writing.read(&table.read, &[1_i64.into(), 0_i64.into()]).await?.is_empty() {
            return Err(StoreError::NotEmpty { database: name.into() });
        }
    }
    everything(reading.as_mut(), writing.as_mut()).await?;
    writing.commit().await
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Disk;

    #[tokio::test]
    async fn every_column_of_every_table_is_copied() {
        let disk = Disk::new().await;
        let sql = "SELECT t.name || '.' || c.name FROM sqlite_master t, pragma_table_info(t.name) c \
            WHERE t.type = 'table' AND t.name NOT LIKE 'sqlite_%' AND t.name NOT LIKE '_sqlx_%' ORDER BY 1";
        let rows = disk.store.driver.read(sql, &[]).await.unwrap();
        let stored: Vec<String> = rows.into_iter().map(|mut row| row.take("name").unwrap()).collect();
        let mut copied: Vec<String> = TABLES
            .iter()
            .flat_map(|table| {
                let (columns, rest) = table.read["SELECT ".len()..].split_once(" FROM ").unwrap();
                let name = rest.split(' ').next().unwrap();
                columns.split(", ").map(move |column| format!("{name}.{column}"))
            })
            .collect();
        copied.sort();
        assert_eq!(copied, stored);
    }
}
