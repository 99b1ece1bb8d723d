//! Tables that lanes look rows up in.

use super::MOST;

/// Rows of four numbers.
#[derive(Clone, Debug, Default)]
pub struct Table {
    pub(super) rows: Vec<[f32; 4]>,
    /// Its columns too, if there are so few rows that a register holds each.
    pub(super) columns: Option<Box<[[f32; MOST]; 4]>>,
}

impl Table {
    /// The table of these rows.
    pub fn new(rows: Vec<[f32; 4]>) -> Table {
        let columns = (rows.len() <= MOST).then(|| {
            let mut columns = Box::new([[0.0; MOST]; 4]);
            for (at, row) in rows.iter().enumerate() {
                for (column, value) in columns.iter_mut().zip(row) {
                    column[at] = *value;
                }
            }
            columns
        });
        Table { rows, columns }
    }

    /// The rows.
    pub fn rows(&self) -> &[[f32; 4]] {
        &self.rows
    }
}
