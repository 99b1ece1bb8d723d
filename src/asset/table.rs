//! Tables of numbers and texts: comma-separated values with a head.
//!
//! The head names the columns, each with its unit in brackets where it has one: `x [mm]`, `radius (m)`. A column
//! whose every cell is a number holds numbers, any other texts.

use crate::units::{self, Unit};
use smol_str::SmolStr;

/// The most cells of a table.
pub const MAX_CELLS: usize = 20_000_000;

/// A table, column by column.
#[derive(Debug, PartialEq)]
pub struct Table {
    /// The columns, all of one length.
    pub columns: Vec<Column>,
    /// How many rows there are.
    pub rows: usize,
}

/// One column.
#[derive(Debug, PartialEq)]
pub struct Column {
    /// What the head calls it: letters, digits and `_`.
    pub name: SmolStr,
    /// The unit that the head gives its numbers.
    pub unit: Option<Unit>,
    /// What it holds.
    pub cells: Cells,
}

/// The cells of a column.
#[derive(Debug, PartialEq)]
pub enum Cells {
    /// Numbers, in base units.
    Numbers {
        /// By row.
        values: Vec<f64>,
        /// Whether all are whole.
        whole: bool,
    },
    /// Texts, by row.
    Texts(Vec<SmolStr>),
}

/// Reads a table. The error says what is wrong with it, and where.
pub fn read(bytes: &[u8]) -> Result<Table, String> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let separator = separator(bytes);
    let mut reader = csv::ReaderBuilder::new().delimiter(separator).comment(Some(b'#')).from_reader(bytes);
    let heads = reader.headers().map_err(|error| problem(&error))?.clone();
    if heads.is_empty() {
        return Err("it is empty".into());
    }
    let mut columns = heads.iter().map(head).collect::<Result<Vec<Column>, String>>()?;
    for (index, column) in columns.iter().enumerate() {
        if columns[..index].iter().any(|other| other.name == column.name) {
            return Err(format!("two columns are called `{}`", column.name));
        }
    }
    let mut rows = 0;
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| problem(&error))? {
        rows += 1;
        if rows * columns.len() > MAX_CELLS {
            return Err(format!("it has more than {MAX_CELLS} cells"));
        }
        for (column, cell) in columns.iter_mut().zip(&record) {
            column.push(cell);
        }
    }
    columns.iter_mut().for_each(Column::finish);
    for column in &columns {
        if column.unit.is_some() && matches!(column.cells, Cells::Texts(_)) {
            return Err(format!("the column `{}` has a unit, and cells that are no numbers", column.name));
        }
    }
    Ok(Table { columns, rows })
}

/// What stands between the cells: the first of these in the first line.
fn separator(bytes: &[u8]) -> u8 {
    let line = bytes.split(|&byte| byte == b'\n').find(|line| !line.starts_with(b"#")).unwrap_or(bytes);
    *line.iter().find(|byte| b",;\t".contains(byte)).unwrap_or(&b',')
}

fn problem(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, |pos| pos.line());
            format!("line {line} has {len} cells, the head has {expected_len}")
        }
        csv::ErrorKind::Utf8 { pos, .. } => {
            let line = pos.as_ref().map_or(0, |pos| pos.line());
            format!("line {line} is not UTF-8 text")
        }
        _ => "it cannot be read".into(),
    }
}

/// `x`, `x [mm]` or `x (mm)`.
fn head(text: &str) -> Result<Column, String> {
    let (name, unit) = match text.find(['[', '(']) {
        Some(at) => {
            let unit = text[at + 1..].trim_end().trim_end_matches([']', ')']).trim();
            let found = units::parse_unit(unit).map_err(|part| format!("`{part}` in its head is no unit"))?;
            (text[..at].trim(), Some(found))
        }
        None => (text.trim(), None),
    };
    let word = |c: char| if c.is_alphanumeric() || c == '_' { c } else { '_' };
    let name: String = name.chars().map(word).collect();
    if name.is_empty() {
        return Err("a column has no name".into());
    }
    Ok(Column { name: name.into(), unit, cells: Cells::Numbers { values: vec![], whole: true } })
}

impl Column {
    /// Adds a cell, without white space around it. What is no number makes the whole column texts.
    fn push(&mut self, cell: &str) {
        match &mut self.cells {
            Cells::Texts(texts) => texts.push(cell.trim().into()),
            // Most have no white space to be found: the reader's own trimming would copy every record.
            Cells::Numbers { values, whole } => match cell.parse().or_else(|_| cell.trim().parse::<f64>()) {
                Ok(value) if value.is_finite() => {
                    // Rounding takes time, and one fraction says all.
                    *whole = *whole && value == value.trunc() && value.abs() < 9e15;
                    values.push(value);
                }
                _ => {
                    // Numbers before it are texts as well, written as short as they can be.
                    let mut texts: Vec<SmolStr> =
                        values.iter().map(|value| value.to_string().into()).collect();
                    texts.push(cell.trim().into());
                    self.cells = Cells::Texts(texts);
                }
            },
        }
    }

    /// Brings its numbers to base units.
    fn finish(&mut self) {
        if let (Cells::Numbers { values, .. }, Some(unit)) = (&mut self.cells, self.unit) {
            values.iter_mut().for_each(|value| *value *= unit.factor);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_types_and_units() {
        let table = read(b"# from a survey\nx [mm];n;name\n1.5;2;a\n-3;4;\"b;c\"\n").unwrap();
        assert_eq!(table.rows, 2);
        assert_eq!(table.columns[0].cells, Cells::Numbers { values: vec![1.5e-3, -3e-3], whole: false });
        assert_eq!(table.columns[1].cells, Cells::Numbers { values: vec![2.0, 4.0], whole: true });
        assert_eq!(table.columns[2].cells, Cells::Texts(vec!["a".into(), "b;c".into()]));
        assert_eq!(table.columns[0].unit.map(|unit| unit.factor), Some(1e-3));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        assert_eq!(read(b"a,b\n1\n"), Err("line 2 has 1 cells, the head has 2".into()));
        assert_eq!(read(b""), Err("it is empty".into()));
        assert_eq!(read(b"a [parsec]\n1"), Err("`parsec` in its head is no unit".into()));
        assert_eq!(read(b"a,a\n1,2"), Err("two columns are called `a`".into()));
        assert_eq!(read(b"a [m]\nx"), Err("the column `a` has a unit, and cells that are no numbers".into()));
        assert!(read(b"a\n\xff").is_err());
    }
}
