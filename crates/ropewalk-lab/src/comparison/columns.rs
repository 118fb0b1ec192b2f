//! Rows as CSV: each column's name beside what stands in it.

use std::io::{self, Write};

/// A column: its name, and its cell of a row.
pub(crate) type Column<R> = (&'static str, fn(&R) -> String);

/// Writes the rows, a heading first.
pub(crate) fn write_columns<R>(columns: &[Column<R>], rows: &[R], writer: impl Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(columns.iter().map(|(name, _)| name))?;
    for row in rows {
        csv.write_record(columns.iter().map(|(_, cell)| cell(row)))?;
    }
    csv.flush()
}

/// What is not there is an empty cell.
pub(crate) fn maybe(value: Option<impl ToString>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_below_their_names() {
        let columns: [Column<Option<u32>>; 2] = [("it, whole", |row| maybe(*row)), ("same", |_| "\"".into())];
        let mut bytes = Vec::new();
        write_columns(&columns, &[Some(3), None], &mut bytes).unwrap();
        assert_eq!(String::from_utf8(bytes).unwrap(), "\"it, whole\",same\n3,\"\"\"\"\n,\"\"\"\"\n");
    }
}
