//! A program with more rows.

use faer::sparse::{SparseColMat, SparseRowMat, Triplet};

use super::Program;

/// A row to add to a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Columns, increasing, and their coefficients, not zero.
    pub terms: Vec<(usize, f64)>,
    /// Lower limit.
    pub lower: f64,
    /// Upper limit.
    pub upper: f64,
    /// The column that must be fixed before relaxations take the row, if any.
    pub switch: Option<usize>,
}

impl Program {
    /// The same program with rows appended; unchanged where the matrices cannot be allocated.
    #[must_use]
    pub fn with_rows(&self, rows: &[Row]) -> Program {
        let mut program = self.clone();
        let (m, n) = (self.row_count(), self.column_count());
        let mut entries = Vec::new();
        for i in 0..m {
            let (columns, values) = self.row(i);
            entries.extend(columns.iter().zip(values).map(|(&j, &a)| Triplet::new(i, j, a)));
        }
        for (i, row) in rows.iter().enumerate() {
            entries.extend(row.terms.iter().map(|&(j, a)| Triplet::new(m + i, j, a)));
        }
        let m = m + rows.len();
        let (by_row, by_column) = (
            SparseRowMat::try_new_from_triplets(m, n, &entries),
            SparseColMat::try_new_from_triplets(m, n, &entries),
        );
        if let (Ok(by_row), Ok(by_column)) = (by_row, by_column) {
            (program.rows, program.columns) = (by_row, by_column);
            program.row_lower.extend(rows.iter().map(|row| row.lower));
            program.row_upper.extend(rows.iter().map(|row| row.upper));
            program.switch.extend(rows.iter().map(|row| row.switch));
        }
        program
    }
}
