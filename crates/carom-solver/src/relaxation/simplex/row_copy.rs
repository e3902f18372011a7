//! The matrix by rows, for pivot rows: of each row, the columns that may enter come first.

use super::program::LinearProgram;

/// The matrix by rows.
#[derive(Debug, Default)]
pub(super) struct RowCopy {
    start: Vec<u32>,
    /// By row, the end of the columns that may enter.
    end: Vec<u32>,
    index: Vec<u32>,
    value: Vec<f64>,
}

impl RowCopy {
    /// The rows, with these columns first.
    pub(super) fn new(program: &LinearProgram, may_enter: impl Fn(usize) -> bool) -> Self {
        let rows = &program.rows;
        let mut copy = RowCopy {
            start: rows.start.iter().map(|&k| k as u32).collect(),
            end: Vec::with_capacity(rows.len()),
            index: Vec::with_capacity(rows.index.len()),
            value: Vec::with_capacity(rows.index.len()),
        };
        for i in 0..rows.len() {
            for first in [true, false] {
                let (index, value) = rows.vector(i);
                for (&j, &a) in index.iter().zip(value).filter(|e| may_enter(*e.0) == first) {
                    copy.index.push(j as u32);
                    copy.value.push(a);
                }
                if first {
                    copy.end.push(copy.index.len() as u32);
                }
            }
        }
        copy
    }

    /// The columns of a row that may enter, with their entries.
    pub(super) fn entering(&self, row: usize) -> (&[u32], &[f64]) {
        let range = self.start[row] as usize..self.end[row] as usize;
        (&self.index[range.clone()], &self.value[range])
    }

    /// Notes that a column may enter from now on, or may not.
    pub(super) fn move_column(&mut self, program: &LinearProgram, column: usize, may_enter: bool) {
        for &row in program.columns.vector(column).0 {
            let [start, end, stop] =
                [self.start[row], self.end[row], self.start[row + 1]].map(|k| k as usize);
            let (range, target) = if may_enter { (end..stop, end) } else { (start..end, end - 1) };
            let Some(at) = self.index[range.clone()].iter().position(|&j| j as usize == column)
            else {
                continue;
            };
            let at = range.start + at;
            self.index.swap(at, target);
            self.value.swap(at, target);
            self.end[row] = (if may_enter { end + 1 } else { end - 1 }) as u32;
        }
    }
}
