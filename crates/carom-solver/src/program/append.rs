//! Appending columns and rows to a program.

use std::sync::OnceLock;

use faer::sparse::{SparseColMat, SparseRowMat, Triplet};

use super::Program;

/// Terms and limits of a row.
pub(crate) type Addition = (Vec<(usize, f64)>, [f64; 2]);

impl Program {
    /// Adds integral columns within `0..=upper` without a cost, and rows with their limits;
    /// nothing, and an unfinished program, where the matrices cannot be allocated.
    pub(crate) fn append(&mut self, upper: &[f64], rows: &[Addition]) -> Option<()> {
        let old = self.column_count();
        self.append_continuous(upper, rows)?;
        self.integral[old..].fill(true);
        self.integers.extend(old..old + upper.len());
        Some(())
    }

    /// Adds continuous columns within `0..=upper` without a cost, and rows, as
    /// [`append`](Self::append).
    pub(crate) fn append_continuous(&mut self, upper: &[f64], rows: &[Addition]) -> Option<()> {
        let (old, count) = (self.column_count(), upper.len());
        let (m, n) = (self.row_count() + rows.len(), old + count);
        let mut entries = Vec::new();
        for row in 0..self.row_count() {
            let (columns, values) = self.row(row);
            entries.extend(columns.iter().zip(values).map(|(&j, &a)| Triplet::new(row, j, a)));
        }
        for (k, (terms, _)) in rows.iter().enumerate() {
            let row = self.row_count() + k;
            entries.extend(terms.iter().map(|&(j, a)| Triplet::new(row, j, a)));
        }
        let products = self.quadratic_entries().map(|(i, j, p)| Triplet::new(i, j, p));
        let products: Vec<_> = products.collect();
        self.rows = SparseRowMat::try_new_from_triplets(m, n, &entries).ok()?;
        self.columns = SparseColMat::try_new_from_triplets(m, n, &entries).ok()?;
        self.quadratic = SparseColMat::try_new_from_triplets(n, n, &products).ok()?;
        self.row_lower.extend(rows.iter().map(|(_, limits)| limits[0]));
        self.row_upper.extend(rows.iter().map(|(_, limits)| limits[1]));
        self.linear.resize(n, 0.0);
        self.lower.resize(n, 0.0);
        self.upper.extend(upper);
        self.integral.resize(n, false);
        self.step.resize(n, None);
        self.squared = OnceLock::new();
        self.extend_steepness();
        Some(())
    }

    /// Replaces the rows: row, column and coefficient of each term, and the limits of each row.
    /// Returns `None` if they cannot be allocated.
    pub(crate) fn replace_rows(
        &mut self,
        terms: impl Iterator<Item = (usize, usize, f64)>,
        limits: &[[f64; 2]],
    ) -> Option<()> {
        let (m, n) = (limits.len(), self.column_count());
        let mut entries = Vec::with_capacity(self.rows.compute_nnz());
        entries.extend(terms.map(|(row, j, a)| Triplet::new(row, j, a)));
        self.rows = SparseRowMat::try_new_from_triplets(m, n, &entries).ok()?;
        self.columns = SparseColMat::try_new_from_triplets(m, n, &entries).ok()?;
        self.squared = OnceLock::new();
        self.row_lower = limits.iter().map(|limits| limits[0]).collect();
        self.row_upper = limits.iter().map(|limits| limits[1]).collect();
        Some(())
    }

    /// Writes the objective in another way: one linear coefficient a column, the entries of the
    /// symmetric matrix, of which equal places are added up, and the offset. The constant of the
    /// model stays, because gaps are relative to what remains without it. `None` if the matrix
    /// cannot be allocated.
    pub(crate) fn rewrite_objective(
        &mut self,
        linear: Vec<f64>,
        products: &[(usize, usize, f64)],
        offset: f64,
    ) -> Option<()> {
        let n = self.column_count();
        let entries: Vec<_> = products.iter().map(|&(i, j, p)| Triplet::new(i, j, p)).collect();
        self.quadratic = SparseColMat::try_new_from_triplets(n, n, &entries).ok()?;
        (self.linear, self.offset) = (linear, offset);
        (self.steepness, self.squared) = (OnceLock::new(), OnceLock::new());
        Some(())
    }
}
