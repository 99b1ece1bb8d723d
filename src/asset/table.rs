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
    let mut reader = reader(bytes, separator);
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
    // For each column how many of its numbers turned out to be texts.
    let mut turned = vec![0; columns.len()];
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| problem(&error))? {
        if (rows + 1) * columns.len() > MAX_CELLS {
            return Err(format!("it has more than {MAX_CELLS} cells"));
        }
        for ((column, turned), cell) in columns.iter_mut().zip(&mut turned).zip(&record) {
            if column.push(cell) {
                *turned = rows;
            }
        }
        rows += 1;
    }
    restore(bytes, separator, &mut columns, &turned);
    columns.iter_mut().for_each(Column::finish);
    for column in &columns {
        if column.unit.is_some() && matches!(column.cells, Cells::Texts(_)) {
            return Err(format!("the column `{}` has a unit, and cells that are no numbers", column.name));
        }
    }
    Ok(Table { columns, rows })
}

fn reader(bytes: &[u8], separator: u8) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().delimiter(separator).comment(Some(b'#')).from_reader(bytes)
}

/// Reads the first cells once more of those columns that turned to texts behind them: as texts they are what is
/// written, such as `007` or `1.50`. `turned` is how many there are.
fn restore(bytes: &[u8], separator: u8, columns: &mut [Column], turned: &[usize]) {
    let most = turned.iter().copied().max().unwrap_or(0);
    let mut first: Vec<Vec<SmolStr>> = turned.iter().map(|_| vec![]).collect();
    for record in reader(bytes, separator).records().take(most).flatten() {
        for ((texts, turned), cell) in first.iter_mut().zip(turned).zip(&record) {
            if texts.len() < *turned {
                texts.push(cell.trim().into());
            }
        }
    }
    for (column, mut first) in columns.iter_mut().zip(first) {
        if let Cells::Texts(texts) = &mut column.cells {
            first.append(texts);
            *texts = first;
        }
    }
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
    /// Adds a cell, without white space around it. What is no number makes the whole column texts: whether it did,
    /// and the texts of the cells before it are still to be read.
    fn push(&mut self, cell: &str) -> bool {
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
                    self.cells = Cells::Texts(vec![cell.trim().into()]);
                    return true;
                }
            },
        }
        false
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
    fn texts_that_look_like_numbers_keep_their_form() {
        let table = read(b"id,n\n007,1\n 1.50,2\n\nx,3\n").unwrap();
        assert_eq!(table.columns[0].cells, Cells::Texts(vec!["007".into(), "1.50".into(), "x".into()]));
        assert_eq!(table.columns[1].cells, Cells::Numbers { values: vec![1.0, 2.0, 3.0], whole: true });
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
