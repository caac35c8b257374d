//! The tables of a sweep as Parquet, with the types that their columns have.

use super::SweepError;
use cohelm_study::csv::{Cell, Csv};
use cohelm_study::export::{Column, Kind, Sheet};

/// A table as Parquet; what the columns mean is in the dictionary beside it.
pub(super) fn parquet(name: &'static str, table: &Csv) -> Result<Vec<u8>, SweepError> {
    let column = |(index, key): (usize, &String)| Column {
        key: key.clone(),
        meaning: String::new(),
        unit: String::new(),
        kind: kind(table.rows().iter().map(|row| &row[index])),
        range: String::new(),
        missing_when: String::new(),
    };
    let columns = table.columns().iter().enumerate().map(column).collect();
    Ok(Sheet { name, columns, rows: table.rows().to_vec() }.parquet()?)
}

/// Text if there is any, whole numbers if there is nothing else, numbers otherwise.
fn kind<'a>(cells: impl Iterator<Item = &'a Cell> + Clone) -> Kind {
    let any = |is: fn(&Cell) -> bool| cells.clone().any(is);
    if any(|cell| matches!(cell, Cell::Text(_))) {
        Kind::Text
    } else if any(|cell| matches!(cell, Cell::Number(_))) {
        Kind::Number
    } else {
        Kind::Integer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_the_types_of_their_cells() {
        let text = [Cell::Empty, Cell::from("a")];
        assert_eq!(kind(text.iter()), Kind::Text);
        assert_eq!(kind([Cell::from(1_u32), Cell::from(0.5)].iter()), Kind::Number);
        assert_eq!(kind([Cell::from(1_u32), Cell::Empty].iter()), Kind::Integer);
    }

    #[test]
    fn a_table_is_written() {
        let mut table = Csv::new(["job", "steps"]);
        table.push([Cell::from("a"), Cell::from(3_u32)]);
        assert!(parquet("jobs", &table).unwrap().starts_with(b"PAR1"));
    }
}
