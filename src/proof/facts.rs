//! Facts: the rows of a program, and those that a proof has derived from them.

use crate::program::Program;

/// Linear rows `lower <= terms <= upper`, numbered as in the log.
#[derive(Debug, Default)]
pub(super) struct Facts {
    start: Vec<usize>,
    column: Vec<u32>,
    value: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// By column, the facts that it is in.
    of_column: Vec<Vec<u32>>,
}

impl Facts {
    /// The rows of a program.
    pub(super) fn new(program: &Program) -> Self {
        let of_column = vec![Vec::new(); program.column_count()];
        let mut facts = Facts { start: vec![0], of_column, ..Facts::default() };
        for row in 0..program.row_count() {
            let (columns, values) = program.row(row);
            let limits = [program.row_lower[row], program.row_upper[row]];
            facts.push(columns.iter().copied().zip(values.iter().copied()), limits);
        }
        facts
    }

    /// Adds a fact, and returns its number.
    pub(super) fn push(
        &mut self,
        terms: impl Iterator<Item = (usize, f64)>,
        [lower, upper]: [f64; 2],
    ) -> usize {
        let number = self.len();
        for (column, value) in terms.filter(|(_, value)| *value != 0.0) {
            self.column.push(column as u32);
            self.value.push(value);
            self.of_column[column].push(number as u32);
        }
        self.start.push(self.column.len());
        self.lower.push(lower);
        self.upper.push(upper);
        number
    }

    pub(super) fn len(&self) -> usize {
        self.lower.len()
    }

    /// Columns and coefficients of a fact.
    pub(super) fn terms(&self, fact: usize) -> impl ExactSizeIterator<Item = (usize, f64)> + '_ {
        let range = self.start[fact]..self.start[fact + 1];
        let columns = self.column[range.clone()].iter().map(|&j| j as usize);
        columns.zip(self.value[range].iter().copied())
    }

    /// Its limits.
    pub(super) fn limits(&self, fact: usize) -> [f64; 2] {
        [self.lower[fact], self.upper[fact]]
    }

    /// Gives a fact other limits.
    pub(super) fn set_limits(&mut self, fact: usize, [lower, upper]: [f64; 2]) {
        (self.lower[fact], self.upper[fact]) = (lower, upper);
    }

    /// The facts that a column is in.
    pub(super) fn of_column(&self, column: usize) -> &[u32] {
        &self.of_column[column]
    }
}
