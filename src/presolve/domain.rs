//! Current bounds of all columns, with a trail to undo changes.

use crate::program::Program;

/// Bounds of all columns at a node. Changes are recorded, so that a node is left by undoing
/// exactly what was done inside it.
#[derive(Debug, Clone)]
pub struct Domain {
    lower: Vec<f64>,
    upper: Vec<f64>,
    trail: Vec<Change>,
}

#[derive(Debug, Clone, Copy)]
struct Change {
    column: usize,
    is_upper: bool,
    old: f64,
}

impl Domain {
    /// The bounds of a program.
    pub fn new(program: &Program) -> Self {
        Domain { lower: program.lower.clone(), upper: program.upper.clone(), trail: Vec::new() }
    }

    /// Lower bound of a column.
    pub fn lower(&self, column: usize) -> f64 {
        self.lower[column]
    }

    /// Upper bound of a column.
    pub fn upper(&self, column: usize) -> f64 {
        self.upper[column]
    }

    /// Whether a column has one value left.
    pub fn is_fixed(&self, column: usize) -> bool {
        self.lower[column] == self.upper[column]
    }

    /// Sets a lower bound, recording the old one.
    pub fn set_lower(&mut self, column: usize, value: f64) {
        let old = std::mem::replace(&mut self.lower[column], value);
        self.trail.push(Change { column, is_upper: false, old });
    }

    /// Sets an upper bound, recording the old one.
    pub fn set_upper(&mut self, column: usize, value: f64) {
        let old = std::mem::replace(&mut self.upper[column], value);
        self.trail.push(Change { column, is_upper: true, old });
    }

    /// Sets one bound, recording the old one.
    pub fn apply(&mut self, column: usize, is_upper: bool, value: f64) {
        if is_upper {
            self.set_upper(column, value);
        } else {
            self.set_lower(column, value);
        }
    }

    /// A mark to return to with [`undo_to`](Self::undo_to).
    pub fn mark(&self) -> usize {
        self.trail.len()
    }

    /// The columns changed since a mark, in the order of the changes, repeats included.
    pub fn changed_since(&self, mark: usize) -> impl Iterator<Item = usize> + '_ {
        self.trail[mark..].iter().map(|c| c.column)
    }

    /// Undoes all changes since the mark.
    pub fn undo_to(&mut self, mark: usize) {
        for change in self.trail.drain(mark..).rev() {
            if change.is_upper {
                self.upper[change.column] = change.old;
            } else {
                self.lower[change.column] = change.old;
            }
        }
    }
}
